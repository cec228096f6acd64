//! Lines of equal specific consumption on an engine's map.

use super::contour::{Grid, LineLabels};
use crate::charts::engine::{
    Item, Label, Panel, Point, Rect, Shape, Stroke, Style, number, range, stroke,
};
use cvtcycle_model::drive::FuelMap;

/// kg/J in g/kWh.
const G_KWH: f64 = 3.6e9;

/// Contour of equal consumption; drawn on a wider one in the colour of the paper.
pub(crate) const ISO: Stroke = stroke("#555555", 1.0, &[]);
/// Halo that keeps a line visible on every colour.
const HALO: Stroke = stroke("#ffffff", 2.6, &[]);

/// Adds the contours of equal consumption below full load. Returns their labels, separate and clear of `cells` where possible.
pub(crate) fn iso_lines(
    panel: &mut Panel,
    map: &FuelMap,
    full_load: &[Point],
    cells: Vec<Rect>,
) -> Vec<Label> {
    let rpm: Vec<f64> = full_load.iter().map(|p| p.0).collect();
    let values = extended(map);
    let grid = Grid {
        x: &rpm,
        y: &map.torque_nm,
        values: &values,
    };
    let mut labels = LineLabels::new(panel.rect, 11.0, cells);
    let mut items = Vec::new();
    for level in levels(map) {
        let mut longest: Vec<Point> = Vec::new();
        for line in grid.lines(level) {
            let seen = line.iter().filter(|p| below(full_load, **p));
            let pixels: Vec<Point> = seen.map(|p| panel.pixel(*p)).collect();
            if pixels.len() > longest.len() {
                longest = pixels;
            }
            items.extend([HALO, ISO].map(|stroke| Item {
                shape: Shape::Line(line.clone()),
                style: Style::line(stroke),
            }));
        }
        labels.place(number(level, 1.0), &longest);
    }
    let below = Shape::Within(Some(outline(full_load)), items);
    panel.add(below, Style::default());
    labels.labels(panel)
}

/// The area below the full-load line.
fn outline(full_load: &[Point]) -> Vec<Point> {
    let finite = |p: &Point| p.0.is_finite() && p.1.is_finite();
    let mut outline: Vec<Point> = full_load.iter().copied().filter(finite).collect();
    if let Some((first, last)) = full_load.first().zip(full_load.last()) {
        outline.insert(0, (first.0, f64::NEG_INFINITY));
        outline.push((last.0, f64::NEG_INFINITY));
    }
    outline
}

/// Tests that a point lies below the full-load line.
fn below(full_load: &[Point], (x, y): Point) -> bool {
    full_load.windows(2).any(|pair| {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        x >= x0 && x <= x1 && y <= y0 + (y1 - y0) * (x - x0) / (x1 - x0).max(1e-9)
    })
}

/// Fills the map above full load from below, so that contours reach the full-load line instead of ending in steps one cell before it. The excess
/// is clipped.
fn extended(map: &FuelMap) -> Vec<Vec<f64>> {
    let mut values = map.bsfc_kg_j.clone();
    for column in &mut values {
        for value in column.iter_mut() {
            *value *= G_KWH;
        }
        for j in 2..column.len().min(map.torque_nm.len()) {
            if !column[j].is_finite() {
                let [t0, t1, t2] = [j - 2, j - 1, j].map(|j| map.torque_nm[j]);
                let slope = (column[j - 1] - column[j - 2]) / (t1 - t0);
                column[j] = column[j - 1] + slope * (t2 - t1);
            }
        }
    }
    values
}

/// Round levels, denser where the map is flat: around the best point.
fn levels(map: &FuelMap) -> Vec<f64> {
    let all = map.bsfc_kg_j.iter().flatten().map(|value| value * G_KWH);
    let Some((best, worst)) = range(all.filter(|x| *x > 0.0)) else {
        return Vec::new();
    };
    let level = |factor: f64| {
        let step = if factor < 1.15 { 5.0 } else { 10.0 };
        (best * factor / step).ceil() * step
    };
    let levels = [1.015, 1.05, 1.1, 1.2, 1.35, 1.6, 2.0, 3.0].map(level);
    let mut levels: Vec<f64> = levels.into_iter().filter(|level| *level < worst).collect();
    levels.dedup();
    levels
}
