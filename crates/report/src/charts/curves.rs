//! Lines over a common axis in panels below each other, with marks on them and one legend a panel.
use super::axis::{Axis, number, range};
use super::figure::{Anchor, Figure, INK, Rect, UNITS, units};
use super::legend::{Mark, height, legend};
use super::panel::{BELOW, LEFT, Panel};
use super::style::{STROKES, Stroke};

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
const STRIP: f64 = 196.0;
const ZERO: Stroke = Stroke {
    colour: "#000000",
    width: 0.8,
    dash: &[],
};
const CIRCLE: &str = "fill=\"#ffffff\" stroke=\"#000000\" stroke-width=\"6\"";

/// Draws the picture.
#[must_use]
pub fn curve_figure(of: &CurveFigure) -> String {
    let count = of.panels.len().max(1);
    let tall = if count > 1 { 260.0 } else { 400.0 };
    let titled = of.panels.iter().any(|panel| !panel.title.is_empty());
    let above = if titled { ABOVE } else { 0.0 };
    // Every panel keeps its own range of x: high ratio ends where low ratio has hardly begun.
    let place = |k: usize| {
        let top = TOP + above + k as f64 * (tall + BELOW + ABOVE + 10.0);
        Rect {
            left: LEFT + 8.0,
            top,
            right: LEFT + 8.0 + WIDE,
            bottom: top + tall,
        }
    };
    let size = (
        place(0).right + 16.0 + STRIP,
        place(count - 1).bottom + BELOW + 6.0,
    );
    let mut figure = Figure::new(size, LEFT + 8.0, of.title, of.subject, &told(of));
    for (k, panel) in of.panels.iter().enumerate() {
        draw(&mut figure, place(k), of.x, panel);
    }
    figure.finish()
}

fn draw(figure: &mut Figure, rect: Rect, x_title: &str, of: &CurvePanel) {
    let all = || {
        of.series
            .iter()
            .flat_map(|s| s.points.iter().chain(&s.marked))
    };
    let (low, high) = range(all().map(|p| p.0)).unwrap_or((0.0, 1.0));
    let x = Axis::exact(x_title, low, high, 8);
    let zero = of.with_zero.then_some(0.0);
    let y = Axis::round(&of.y, all().map(|p| p.1).chain(zero), 7);
    let panel = Panel::draw(figure, rect, x, y, true);
    figure.text(
        (rect.left, rect.top - 8.0),
        12.0,
        Anchor::Start,
        "",
        INK,
        &of.title,
    );
    if panel.y.low < 0.0 && panel.y.high > 0.0 {
        panel.line(figure, &[(panel.x.low, 0.0), (panel.x.high, 0.0)], ZERO);
    }
    let stroke = |i: usize, s: &CurveSeries| STROKES[s.style.unwrap_or(i) % STROKES.len()];
    for (i, series) in of.series.iter().enumerate().rev() {
        panel.line(figure, &series.points, stroke(i, series));
    }
    for (x, y) in of
        .series
        .iter()
        .flat_map(|s| &s.marked)
        .filter(|p| p.0.is_finite() && p.1.is_finite())
    {
        let (cx, cy, r) = (units(panel.px(*x)), units(panel.py(*y)), 3.6 * UNITS);
        figure.raw(&format!(
            "<circle class=\"mark\" cx=\"{cx}\" cy=\"{cy}\" r=\"{r:.1}\" {CIRCLE}/>"
        ));
    }
    if all().next().is_none() {
        panel.empty(figure);
    }
    let mut entries: Vec<(Mark, String)> = of
        .series
        .iter()
        .enumerate()
        .map(|(i, s)| (Mark::Line(stroke(i, s)), s.name.clone()))
        .collect();
    if !of.marks.is_empty() {
        entries.push((Mark::Circle(3.6, CIRCLE.to_owned()), of.marks.clone()));
    }
    let names: Vec<String> = entries.iter().map(|(_, name)| name.clone()).collect();
    debug_assert!(
        height(&names, STRIP) < rect.bottom - rect.top + BELOW,
        "the legend is longer than its panel"
    );
    legend(
        figure,
        (rect.right + 16.0, rect.top),
        STRIP - 8.0,
        "",
        &entries,
    );
}

fn told(of: &CurveFigure) -> String {
    let panel = |panel: &CurvePanel| {
        let series = panel
            .series
            .iter()
            .map(|s| match range(s.points.iter().map(|p| p.1)) {
                Some((low, high)) => format!(
                    "{} from {} to {}",
                    s.name,
                    number(low, (high - low) / 100.0),
                    number(high, (high - low) / 100.0)
                ),
                None => format!("{} without data", s.name),
            });
        let head = if panel.title.is_empty() {
            panel.y.clone()
        } else {
            format!("{}, {}", panel.title, panel.y)
        };
        format!("{head}: {}", series.collect::<Vec<_>>().join("; "))
    };
    format!(
        "Over {}. {}.",
        of.x,
        of.panels.iter().map(panel).collect::<Vec<_>>().join(". ")
    )
}
