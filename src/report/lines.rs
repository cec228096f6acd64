//! Line plots of anything against anything, one or more pairs of axes side by side.
use super::axis::Axis;
use super::figure::{Anchor, Figure, INK, Rect};
use super::legend::{Mark, legend};
use super::panel::{BELOW, LEFT, Panel};
use super::style::STROKES;

/// Height of the plotting area, pixels.
const HEIGHT: f64 = 300.0;
/// Where it begins below the headings, pixels.
const TOP: f64 = 78.0;
/// Width of a plotting area: of the only one, or of each of several, pixels.
const WIDTHS: [f64; 2] = [560.0, 330.0];
/// Room between two plotting areas beside the axis of the second, pixels.
const GAP: f64 = 22.0;
/// Room for the legend, pixels.
const STRIP: f64 = 190.0;
/// Ticks of an axis at most, for one area and for several.
const TICKS: [usize; 2] = [9, 6];

/// Points under a name; lines of the same name look the same in every pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Points, each in the units of its axes; a gap where one is not finite.
    pub points: Vec<(f64, f64)>,
}

/// One pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinePanel {
    /// What it shows, over it; may be empty.
    pub heading: String,
    /// Title of the horizontal axis with its unit.
    pub x: String,
    /// Title of the vertical axis with its unit.
    pub y: String,
    /// Values that the vertical axis takes in beside those of the lines.
    pub with_y: Vec<f64>,
    /// Lines.
    pub lines: Vec<Line>,
}

/// A line plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinePlot {
    /// Title.
    pub title: String,
    /// Of what and in which state.
    pub subject: String,
    /// Description for who cannot see it.
    pub desc: String,
    /// Heading of the legend; may be empty.
    pub legend: String,
    /// Pairs of axes from left to right.
    pub panels: Vec<LinePanel>,
}

/// Draws a line plot as an SVG document. Up to seven names stay apart; further ones begin again with the first look.
#[must_use]
pub fn line_plot(plot: &LinePlot) -> String {
    let several = usize::from(plot.panels.len() > 1);
    let count = if plot.panels.is_empty() { 1 } else { plot.panels.len() };
    let step = LEFT + WIDTHS[several] + GAP;
    let right = 8.0 + step * count as f64 - GAP;
    let size = (right + 16.0 + STRIP, TOP + HEIGHT + BELOW + 6.0);
    let mut figure = Figure::new(size, LEFT + 8.0, &plot.title, &plot.subject, &plot.desc);
    let names = names(plot);
    for (k, panel) in plot.panels.iter().enumerate() {
        let left = 8.0 + LEFT + step * k as f64;
        let rect = Rect { left, top: TOP, right: left + WIDTHS[several], bottom: TOP + HEIGHT };
        draw(&mut figure, panel, rect, &names, TICKS[several]);
    }
    let entries: Vec<_> = names.iter().enumerate().map(|(k, name)| (Mark::Line(STROKES[k % STROKES.len()]), (*name).to_owned())).collect();
    legend(&mut figure, (right + 16.0, TOP), STRIP - 8.0, &plot.legend, &entries);
    figure.finish()
}

/// Names of all lines in the order in which they first appear.
fn names(plot: &LinePlot) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for line in plot.panels.iter().flat_map(|panel| &panel.lines) {
        if !line.name.is_empty() && !names.contains(&line.name.as_str()) {
            names.push(&line.name);
        }
    }
    names
}

fn draw(figure: &mut Figure, panel: &LinePanel, rect: Rect, names: &[&str], ticks: usize) {
    let points = || panel.lines.iter().flat_map(|line| line.points.iter().copied());
    let x = Axis::exact(
        &panel.x,
        points().map(|p| p.0).filter(|x| x.is_finite()).fold(f64::INFINITY, f64::min),
        points().map(|p| p.0).filter(|x| x.is_finite()).fold(f64::NEG_INFINITY, f64::max),
        ticks,
    );
    let y = Axis::round(&panel.y, points().map(|p| p.1).chain(panel.with_y.iter().copied()), 7);
    let middle = 0.5 * (rect.left + rect.right);
    figure.text((middle, rect.top - 9.0), 12.0, Anchor::Middle, "", INK, &panel.heading);
    let axes = Panel::draw(figure, rect, x, y, true);
    if axes.y.low < 0.0 && axes.y.high > 0.0 {
        axes.line(figure, &[(axes.x.low, 0.0), (axes.x.high, 0.0)], super::style::CONTEXT);
    }
    for line in &panel.lines {
        let look = names.iter().position(|name| *name == line.name).unwrap_or(0);
        axes.line(figure, &line.points, STROKES[look % STROKES.len()]);
    }
    axes.outline(figure);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_name_has_one_look_and_one_entry() {
        let line = |name: &str, k: f64| Line { name: name.to_owned(), points: vec![(0.0, 0.0), (1.0, k)] };
        let panel = |names: [&str; 2]| LinePanel {
            x: "x".to_owned(),
            y: "y".to_owned(),
            lines: names.map(|n| line(n, 2.0)).to_vec(),
            ..LinePanel::default()
        };
        let plot = LinePlot { title: "t".to_owned(), panels: vec![panel(["a", "b"]), panel(["b", "c"])], ..LinePlot::default() };
        let svg = line_plot(&plot);
        assert_eq!(svg.matches("class=\"series\"").count(), 4);
        for name in ["a", "b", "c"] {
            assert_eq!(svg.matches(&format!(">{name}</text>")).count(), 1, "{name}");
        }
        assert!(svg.matches(STROKES[1].colour).count() >= 3, "b twice and in the legend");
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn nothing_to_draw_is_still_a_picture() {
        assert!(line_plot(&LinePlot::default()).ends_with("</svg>\n"));
        let empty = LinePlot { panels: vec![LinePanel::default()], ..LinePlot::default() };
        assert!(!line_plot(&empty).contains("inf"));
    }
}
