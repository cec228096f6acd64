//! Lines over a common quantity in panels below each other, with marks on them and a legend for each panel.

use crate::charts::engine::{
    Axis, BELOW, Chart, Entry, INK, LEFT, PLOT_LEFT, Panel, Rect, STROKES, Side, Stroke, Style,
    Symbol, ZERO, at, range,
};
use crate::charts::picture::PictureTable;

/// A picture of lines.
#[derive(Clone, Debug)]
pub struct CurveFigure<'a> {
    /// What it shows.
    pub title: &'a str,
    /// Of what.
    pub subject: &'a str,
    /// Title of the horizontal axis, with the unit.
    pub x: &'a str,
    /// Panels, from the top.
    pub panels: Vec<CurvePanel>,
}

/// One panel.
#[derive(Clone, Debug, Default)]
pub struct CurvePanel {
    /// What it shows; may be empty.
    pub title: String,
    /// Title of the vertical axis, with the unit.
    pub y: String,
    /// Whether zero is to lie on the vertical axis.
    pub with_zero: bool,
    /// Lines, in the order of the legend.
    pub series: Vec<CurveSeries>,
    /// Name of the marks in the legend; none without marks.
    pub marks: String,
}

/// One line.
#[derive(Clone, Debug, Default)]
pub struct CurveSeries {
    /// Name in the legend.
    pub name: String,
    /// Points in ascending order of x; gaps where a value is not finite.
    pub points: Vec<(f64, f64)>,
    /// Points to mark with a circle.
    pub marked: Vec<(f64, f64)>,
    /// Index of the style, where lines are to look alike; that of the series by default.
    pub style: Option<usize>,
}

const TOP: f64 = 58.0;
const ABOVE: f64 = 26.0;
const WIDE: f64 = 594.0;
/// Width of the legends, pixels.
const STRIP: f64 = 196.0;
const RADIUS: f64 = 3.6;

/// Draws the picture.
#[must_use]
pub fn curve_figure(of: &CurveFigure) -> String {
    let tall = if of.panels.len() > 1 { 260.0 } else { 400.0 };
    let titled = of.panels.iter().any(|panel| !panel.title.is_empty());
    let above = TOP + if titled { ABOVE } else { 0.0 };
    let mut chart =
        Chart::new(of.title, of.subject, PLOT_LEFT).width(PLOT_LEFT + WIDE + 16.0 + STRIP);
    for (k, panel) in of.panels.iter().enumerate() {
        let top = above + k as f64 * (tall + BELOW + ABOVE + 10.0);
        let rect = Rect::new(LEFT + 8.0, top, WIDE, tall);
        let side = Side {
            corner: (rect.right + 16.0, rect.top),
            width: STRIP - 8.0,
            entries: entries(panel),
            ..Side::default()
        };
        chart = chart.panels([draw(rect, of.x, panel)]).side(side);
    }
    chart.picture(PictureTable::default()).svg
}

fn stroke_of(k: usize, series: &CurveSeries) -> Stroke {
    STROKES[series.style.unwrap_or(k) % STROKES.len()]
}

fn entries(of: &CurvePanel) -> Vec<Entry> {
    let lines = of.series.iter().enumerate();
    let mut entries: Vec<Entry> = lines
        .map(|(k, s)| Entry::line(stroke_of(k, s), &s.name))
        .collect();
    if !of.marks.is_empty() {
        entries.push(Entry::symbol(Symbol::CIRCLE, Symbol::white(INK), &of.marks));
    }
    entries
}

fn draw(rect: Rect, x_title: &str, of: &CurvePanel) -> Panel {
    let points = |s: &'_ CurveSeries| [s.points.clone(), s.marked.clone()].concat();
    let all = || of.series.iter().flat_map(points);
    // Every panel has its own range: high ratio ends where low ratio has hardly begun.
    let (low, high) = range(all().map(|p| p.0)).unwrap_or((0.0, 1.0));
    let zero = of.with_zero.then_some(0.0);
    let x = Axis::exact(x_title, low, high, 8);
    let y = Axis::round(&of.y, all().map(|p| p.1).chain(zero), 7);
    let mut panel = Panel::new(rect, x, y)
        .heading(&of.title)
        .no_data(all().next().is_none());
    if panel.y.low < 0.0 && panel.y.high > 0.0 {
        panel.level(0.0, ZERO);
    }
    for (k, series) in of.series.iter().enumerate().rev() {
        panel.series(series.points.clone(), stroke_of(k, series));
    }
    for (x, y) in of.series.iter().flat_map(|s| &s.marked) {
        let style: Style = Symbol::white(INK).class("mark");
        panel.symbol(Symbol::CIRCLE, at(*x, *y), RADIUS, style);
    }
    panel
}
