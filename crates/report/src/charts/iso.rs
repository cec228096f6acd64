//! Lines of equal specific consumption on an engine's map.
use super::axis::{number, range};
use super::contour::Grid;
use super::figure::{Anchor, Figure, INK, Path, Rect, text_width};
use super::operating::{ISO, RECT, RPM};
use super::panel::Panel;
use super::style::Stroke;
use cvtcycle_model::drive::FuelMap;

/// kg/J in g/kWh.
const G_KWH: f64 = 3.6e9;

/// Size of the labels, pixels.
const TEXT: f64 = 11.0;
/// Under a line, so that it is seen on every colour.
const HALO: Stroke = Stroke {
    colour: "#ffffff",
    width: 2.6,
    dash: &[],
};

/// Draws the lines of equal consumption; returns where their labels go: apart from each other and
/// clear of the places `taken` where that can be had.
pub(super) fn iso_lines(
    figure: &mut Figure,
    panel: &Panel,
    map: &FuelMap,
    full_load: &[(f64, f64)],
    taken: &[Rect],
) -> Vec<(f64, f64, String)> {
    let rpm: Vec<f64> = map.speed_rad_s.iter().map(|w| w * RPM).collect();
    let values = carried_on(map);
    let grid = Grid {
        x: &rpm,
        y: &map.torque_nm,
        values: &values,
    };
    clip_below(figure, panel, full_load);
    figure.raw("<g clip-path=\"url(#below-full-load)\">");
    let mut labels: Vec<(f64, f64, String)> = Vec::new();
    for level in levels(map) {
        let text = number(level, 1.0);
        let mut longest: Vec<(f64, f64)> = Vec::new();
        for line in grid.lines(level) {
            panel.line_any(figure, &line, HALO);
            panel.line_any(figure, &line, ISO);
            let pixels: Vec<_> = line
                .iter()
                .filter(|p| below(full_load, **p))
                .map(|p| (panel.px(p.0), panel.py(p.1)))
                .collect();
            if pixels.len() > longest.len() {
                longest = pixels;
            }
        }
        let place = label_place(&longest, &labels, taken);
        labels.extend(place.map(|(x, y)| (x, y, text)));
    }
    figure.close();
    labels
}

/// The place on a line for its label.
fn label_place(
    line: &[(f64, f64)],
    labels: &[(f64, f64, String)],
    taken: &[Rect],
) -> Option<(f64, f64)> {
    let inside = |x: f64, y: f64| {
        x > RECT.left + 16.0 && x < RECT.right - 16.0 && y > RECT.top + 8.0 && y < RECT.bottom - 8.0
    };
    let apart = |x: f64, y: f64| {
        labels
            .iter()
            .all(|(u, v, _)| (x - u).abs() > 34.0 || (y - v).abs() > 15.0)
    };
    let clear = |x: f64, y: f64| {
        taken.iter().all(|r| {
            x + 14.0 < r.left || x - 14.0 > r.right || y + 8.0 < r.top || y - 8.0 > r.bottom
        })
    };
    // From the middle of the line outwards.
    let places: Vec<(f64, f64)> = [50, 60, 40, 70, 30, 80, 20, 90, 10, 65, 35, 75, 25]
        .iter()
        .filter_map(|percent| line.get(percent * line.len() / 100).copied())
        .filter(|&(x, y)| inside(x, y) && apart(x, y))
        .collect();
    places
        .iter()
        .find(|&&(x, y)| clear(x, y))
        .or(places.first())
        .copied()
}

/// Labels on white, so that they can be read on lines and cells.
pub(super) fn label(figure: &mut Figure, labels: Vec<(f64, f64, String)>) {
    for (x, y, text) in labels {
        let half = 0.5 * text_width(&text, TEXT) + 1.0;
        let rect = Rect {
            left: x - half,
            right: x + half,
            top: y - 7.0,
            bottom: y + 7.0,
        };
        figure.rect(rect, "fill=\"#ffffff\" fill-opacity=\"0.85\"");
        figure.text(
            (x, y + 4.0),
            TEXT,
            Anchor::Middle,
            "class=\"iso\"",
            INK,
            &text,
        );
    }
}

/// Whether a point lies below the full-load line.
fn below(full_load: &[(f64, f64)], (x, y): (f64, f64)) -> bool {
    full_load.windows(2).any(|pair| {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        x >= x0 && x <= x1 && y <= y0 + (y1 - y0) * (x - x0) / (x1 - x0).max(1e-9)
    })
}

/// The map with the holes above full load filled from below: lines then reach the full-load line
/// instead of ending in steps one cell before it. What is drawn above it is cut off.
fn carried_on(map: &FuelMap) -> Vec<Vec<f64>> {
    let mut values = map.bsfc_kg_j.clone();
    for column in &mut values {
        for value in column.iter_mut() {
            *value *= G_KWH;
        }
        for j in 2..column.len() {
            if !column[j].is_finite() {
                let (t0, t1, t2) = (
                    map.torque_nm.get(j - 2),
                    map.torque_nm.get(j - 1),
                    map.torque_nm.get(j),
                );
                if let (Some(t0), Some(t1), Some(t2)) = (t0, t1, t2) {
                    let slope = (column[j - 1] - column[j - 2]) / (t1 - t0);
                    column[j] = column[j - 1] + slope * (t2 - t1);
                }
            }
        }
    }
    values
}

/// Round levels that lie closer where the map is flat: around the best point.
fn levels(map: &FuelMap) -> Vec<f64> {
    let all = map
        .bsfc_kg_j
        .iter()
        .flatten()
        .map(|value| value * G_KWH)
        .filter(|x| *x > 0.0);
    let Some((best, worst)) = range(all) else {
        return Vec::new();
    };
    let mut levels: Vec<f64> = [1.015, 1.05, 1.1, 1.2, 1.35, 1.6, 2.0, 3.0]
        .iter()
        .map(|factor| {
            let step = if *factor < 1.15 { 5.0 } else { 10.0 };
            (best * factor / step).ceil() * step
        })
        .filter(|level| *level < worst)
        .collect();
    levels.dedup();
    levels
}

fn clip_below(figure: &mut Figure, panel: &Panel, full_load: &[(f64, f64)]) {
    let mut path = Path::default();
    let ends = full_load.first().zip(full_load.last());
    if let Some((first, last)) = ends {
        path.move_to(panel.px(first.0), RECT.bottom);
        for (x, y) in full_load
            .iter()
            .filter(|p| p.0.is_finite() && p.1.is_finite())
        {
            path.line_to(panel.px(*x), panel.py(*y));
        }
        path.line_to(panel.px(last.0), RECT.bottom);
        path.close();
    }
    figure.define(&format!(
        "<clipPath id=\"below-full-load\"><path d=\"{}\"/></clipPath>\n",
        path.finish()
    ));
}
