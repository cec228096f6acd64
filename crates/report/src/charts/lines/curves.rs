//! Lines over a common quantity in panels below each other, with marks on them and a legend for each panel.

use crate::charts::engine::{
    Axis, BELOW, Chart, Entry, INK, LEFT, Mark, PLOT_LEFT, Panel, Rect, STROKES, Side, Stroke,
    Style, Symbol, ZERO, at, number, range,
};

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
    let mut chart = Chart {
        title: of.title.to_owned(),
        subject: of.subject.to_owned(),
        description: describe(of),
        left: PLOT_LEFT,
        width: PLOT_LEFT + WIDE + 16.0 + STRIP,
        ..Chart::default()
    };
    for (k, panel) in of.panels.iter().enumerate() {
        let top = above + k as f64 * (tall + BELOW + ABOVE + 10.0);
        let rect = Rect::new(LEFT + 8.0, top, WIDE, tall);
        chart.panels.push(draw(rect, of.x, panel));
        chart.sides.push(Side {
            corner: (rect.right + 16.0, rect.top),
            width: STRIP - 8.0,
            entries: entries(panel),
            ..Side::default()
        });
    }
    chart.picture().svg
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
        let mark = Mark::Symbol(Symbol::CIRCLE, RADIUS, Symbol::white(INK));
        let name = of.marks.clone();
        entries.push(Entry { mark, name });
    }
    entries
}

fn draw(rect: Rect, x_title: &str, of: &CurvePanel) -> Panel {
    let all = || {
        of.series
            .iter()
            .flat_map(|s| s.points.iter().chain(&s.marked))
    };
    // Every panel has its own range: high ratio ends where low ratio has hardly begun.
    let (low, high) = range(all().map(|p| p.0)).unwrap_or((0.0, 1.0));
    let zero = of.with_zero.then_some(0.0);
    let x = Axis::exact(x_title, low, high, 8);
    let y = Axis::round(&of.y, all().map(|p| p.1).chain(zero), 7);
    let mut panel = Panel {
        heading: of.title.clone(),
        no_data: all().next().is_none(),
        ..Panel::new(rect, x, y)
    };
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

fn describe(of: &CurveFigure) -> String {
    let line = |s: &CurveSeries| match range(s.points.iter().map(|p| p.1)) {
        Some((low, high)) => {
            let step = (high - low) / 100.0;
            format!(
                "{} from {} to {}",
                s.name,
                number(low, step),
                number(high, step)
            )
        }
        None => format!("{} without data", s.name),
    };
    let panel = |panel: &CurvePanel| {
        let lines: Vec<String> = panel.series.iter().map(line).collect();
        let comma = if panel.title.is_empty() { "" } else { ", " };
        format!("{}{comma}{}: {}", panel.title, panel.y, lines.join("; "))
    };
    let panels: Vec<String> = of.panels.iter().map(panel).collect();
    format!("Over {}. {}.", of.x, panels.join(". "))
}
