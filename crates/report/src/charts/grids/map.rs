//! A quantity over two axes: filled bands of equal value with labelled lines between them, one panel or several next to each other.

use super::contour::{Grid, LineLabels};
use crate::charts::engine::{
    Axis, BELOW, Chart, INK, Item, LEFT, Label, PLOT_LEFT, Panel, Point, Rect, Shape, Stroke,
    Style, WIDTH, at, free, grid, number, ramp, range, round_step, stroke,
};
use crate::charts::picture::PictureTable;

/// A picture of one quantity over two axes.
#[derive(Clone, Debug)]
pub(crate) struct MapFigure<'a> {
    /// Title.
    pub title: &'a str,
    /// Subject.
    pub subject: &'a str,
    /// Title of the colour bar, with the unit.
    pub value: &'a str,
    /// Title and values of the horizontal axis, ascending.
    pub x: (&'a str, &'a [f64]),
    /// Title and values of the vertical axis, ascending.
    pub y: (&'a str, &'a [f64]),
    /// Panels: constant quantities of each, and the values by x, then by y.
    pub panels: Vec<(String, Vec<Vec<f64>>)>,
}

/// Heights of panels by the number of their columns, and room between columns in addition to the axis, pixels.
const TALL: [f64; 3] = [420.0, 220.0, 180.0];
const GAP: f64 = 12.0;
const TOP: f64 = 58.0;
/// Room above a panel for its title, pixels.
const ABOVE: f64 = 24.0;
/// Height of the colour bar of several panels, pixels: keeps the labels of its bands separate.
const BAR: f64 = 202.0;
/// Room right of the panels for the colour bar, pixels.
const STRIP: f64 = 110.0;
/// Height of the stripes that make up the filled bands, pixels.
const STRIPE: f64 = 1.5;
/// Sampling distance along a stripe, pixels.
const LOOK: f64 = 1.0;
/// Maximum number of bands of the colour bar.
const BANDS: f64 = 12.0;
const LINE: Stroke = stroke(INK, 0.8, &[]);

/// Bands common to all panels.
struct Scale {
    step: f64,
    first: f64,
    count: usize,
}

/// Step between contours from `low` to `high`: few wide bands where a quantity hardly changes.
fn step(low: f64, high: f64, count: f64) -> f64 {
    round_step(((high - low) / count).max(0.02 * high.abs()).max(1e-9))
}

impl Scale {
    fn new(low: f64, high: f64) -> Self {
        let step = step(low, high, BANDS);
        let first = (low / step + 1e-9).floor();
        let count = ((high / step - 1e-9).ceil() - first).max(1.0) as usize;
        Scale { step, first, count }
    }

    fn level(&self, k: usize) -> f64 {
        (self.first + k as f64) * self.step + 0.0
    }

    fn band(&self, value: f64) -> Option<usize> {
        let band = (value / self.step - self.first).floor().max(0.0) as usize;
        value.is_finite().then_some(band.min(self.count - 1))
    }

    fn style(&self, band: usize) -> Style {
        // Large values are dark, as in cells of time and fuel.
        Style::colour(&ramp(1.0 - (band as f64 + 0.5) / self.count as f64))
    }
}

/// Draws the picture. The panel stays white where values are not finite.
pub(crate) fn map_figure(figure: &MapFigure) -> String {
    let several = figure.panels.len() > 1;
    let (columns, size, pitch) = panels_left_of(STRIP, figure.panels.len());
    let titled = several || figure.panels.iter().any(|(title, _)| !title.is_empty());
    let top = TOP + if titled { ABOVE } else { 0.0 };
    let place = grid((PLOT_LEFT, top), size, pitch, columns);
    let found = range(figure.panels.iter().flat_map(|p| &p.1).flatten().copied());
    let (low, high) = found.unwrap_or((0.0, 1.0));
    let scale = Scale::new(low, high);
    let axis = |(title, values): (&str, &[f64]), ticks| {
        Axis::exact(title, values[0], values[values.len() - 1], ticks)
    };
    let ticks = if several { (4, 5) } else { (8, 8) };
    let panel = |(k, (title, values)): (usize, &(String, Vec<Vec<f64>>))| {
        let (x, y) = (axis(figure.x, ticks.0), axis(figure.y, ticks.1));
        let mut panel = Panel::new(place(k), x, y)
            .heading(title)
            .no_data(found.is_none());
        panel.items = bands(&panel, figure, values, &scale);
        add_lines(&mut panel, figure, values, &scale);
        panel
    };
    let edge = place(columns - 1).right;
    let tall = if several { BAR } else { size.1 - 18.0 };
    let bar = Rect::new(edge + 20.0, top + 18.0, 20.0, tall);
    let span = number(low, (high - low) / 100.0) + " to " + &number(high, (high - low) / 100.0);
    Chart::new(figure.title, figure.subject, PLOT_LEFT)
        .lead(format!("{} from {span}", figure.value))
        .width(edge + STRIP)
        .panels(figure.panels.iter().enumerate().map(panel))
        .panels([colour_bar(&scale, figure.value, bar)])
        .picture(PictureTable::default())
        .svg
}

/// Number of columns, panel size and pitch that fill the width of a picture, except a strip on the right.
pub(crate) fn panels_left_of(strip: f64, panels: usize) -> (usize, Point, Point) {
    let columns = match panels {
        0 | 1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let n = columns as f64;
    let between = (n - 1.0) * (LEFT + GAP);
    let size = ((WIDTH - PLOT_LEFT - strip - between) / n, TALL[columns - 1]);
    let pitch = (size.0 + LEFT + GAP, size.1 + ABOVE + BELOW + 8.0);
    (columns, size, pitch)
}

/// Interpolates bilinearly between the grid's points; NaN next to a missing one.
fn interpolated(figure: &MapFigure, values: &[Vec<f64>], x: f64, y: f64) -> f64 {
    let cell = |axis: &[f64], v: f64| {
        let i = axis.partition_point(|a| *a <= v).clamp(1, axis.len() - 1) - 1;
        (i, ((v - axis[i]) / (axis[i + 1] - axis[i])).clamp(0.0, 1.0))
    };
    let ((i, s), (j, t)) = (cell(figure.x.1, x), cell(figure.y.1, y));
    let side = |column: &[f64]| column[j] * (1.0 - t) + column[j + 1] * t;
    side(&values[i]) * (1.0 - s) + side(&values[i + 1]) * s
}

/// Stripes in the colours of the bands, each as long as its band.
fn bands(panel: &Panel, figure: &MapFigure, values: &[Vec<f64>], scale: &Scale) -> Vec<Item> {
    let rect = panel.rect;
    let value = |axis: &Axis, share: f64| axis.low + share * (axis.high - axis.low);
    let count = (rect.width() / LOOK).round() as usize;
    let x_at = |i: f64| value(&panel.x, i * LOOK / rect.width());
    let y_at = |y: f64| value(&panel.y, (rect.bottom - y) / rect.height());
    let mut stripes: Vec<Vec<Vec<Point>>> = vec![Vec::new(); scale.count];
    for j in 0..(rect.height() / STRIPE).ceil() as usize {
        let top = rect.top + j as f64 * STRIPE;
        let low = (top + STRIPE).min(rect.bottom);
        let middle = y_at(0.5 * (top + low));
        let band_at =
            |i: usize| scale.band(interpolated(figure, values, x_at(i as f64 + 0.5), middle));
        let mut from = 0;
        while from < count {
            let band = band_at(from);
            let to = (from + 1..count)
                .find(|i| band_at(*i) != band)
                .unwrap_or(count);
            if let Some(band) = band {
                let (x0, x1, y0, y1) = (x_at(from as f64), x_at(to as f64), y_at(top), y_at(low));
                stripes[band].push(vec![(x0, y0), (x1, y0), (x1, y1), (x0, y1)]);
            }
            from = to;
        }
    }
    let item = |(band, stripes): (usize, Vec<Vec<Point>>)| Item {
        shape: Shape::Area(stripes),
        // Anti-aliasing would show seams between neighbouring stripes.
        style: scale.style(band).crisp().class("band"),
    };
    stripes.into_iter().enumerate().map(item).collect()
}

/// Adds contours between the bands; finer ones in a panel whose values span few bands.
fn add_lines(panel: &mut Panel, figure: &MapFigure, values: &[Vec<f64>], scale: &Scale) {
    let Some((low, high)) = range(values.iter().flatten().copied()) else {
        return;
    };
    let step = step(low, high, 6.0).min(scale.step);
    let (x, y) = (figure.x.1, figure.y.1);
    let grid = Grid { x, y, values };
    let mut labels = LineLabels::new(panel.rect, 10.0, Vec::new());
    for k in (low / step).ceil() as i64..=(high / step).floor() as i64 {
        let level = k as f64 * step;
        let mut longest: Vec<Point> = Vec::new();
        for line in grid.lines(level) {
            let pixels: Vec<Point> = line.iter().map(|p| panel.pixel(*p)).collect();
            let pixels = dense(&pixels);
            if pixels.len() > longest.len() {
                longest = pixels;
            }
            panel.add(Shape::Line(line), Style::line(LINE));
        }
        labels.place(number(level, step), &longest);
    }
    for label in labels.labels(panel) {
        panel.label(label);
    }
}

/// Adds points every few pixels, so that a line between distant grid points has places for a label.
fn dense(line: &[Point]) -> Vec<Point> {
    let mut out = Vec::new();
    for pair in line.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let count = ((x1 - x0).hypot(y1 - y0) / 4.0).ceil().max(1.0);
        let shares = (0..count as u32).map(|i| f64::from(i) / count);
        out.extend(shares.map(|t| (x0 + t * (x1 - x0), y0 + t * (y1 - y0))));
    }
    out.extend(line.last());
    out
}

/// The bands with their limits, from the bottom.
fn colour_bar(scale: &Scale, title: &str, rect: Rect) -> Panel {
    let mut panel = free(rect);
    let tall = rect.height() / scale.count as f64;
    let height = |k: usize| rect.bottom - k as f64 * tall;
    panel.label(Label::new(at(rect.left, rect.top - 10.0), title));
    for band in 0..scale.count {
        let (top, bottom) = (height(band + 1), height(band));
        let style = scale.style(band).edge(stroke(INK, 0.25, &[]));
        panel.rectangle(at(rect.left, top), at(rect.right, bottom), style);
    }
    for k in 0..=scale.count {
        let place = at(rect.right + 5.0, height(k) + 3.8);
        panel.label(Label::new(place, number(scale.level(k), scale.step)));
    }
    panel
}
