//! Charts of several panels over one quantity, with one legend: lines or stacked areas.
use super::axis::Axis;
use super::figure::{Anchor, Figure, INK, Path, Rect};
use super::legend::{Mark, legend};
use super::panel::{BELOW, LEFT, Panel};
use super::style::{STROKES, Stroke, fill};

const PLOT_LEFT: f64 = LEFT + 8.0;
const TOP: f64 = 62.0;
const HEADING: f64 = 20.0;
const STRIP: f64 = 210.0;
const GAP: f64 = 20.0;
/// Width and height of a lone panel, and of one of several.
const LONE: (f64, f64) = (600.0, 360.0);
const ONE_OF: (f64, f64) = (400.0, 230.0);

/// How a series looks: the same number looks the same in all panels of a chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// Number of the colour and dash pattern.
    pub index: usize,
    /// A thin dotted line of that colour, for what is held against it.
    pub dotted: bool,
}

/// One panel.
#[derive(Clone, Debug, Default)]
pub struct ChartPanel {
    /// What tells it from the others; may be empty.
    pub heading: String,
    /// Title of the vertical axis with its unit.
    pub y_title: String,
    /// Whether the vertical axis begins at 0.
    pub from_zero: bool,
    /// Whether series are areas upon each other, from the bottom; else lines.
    pub stacked: bool,
    /// Look and points of each series; stacked ones share their horizontal values.
    pub series: Vec<(Look, Vec<(f64, f64)>)>,
}

/// A chart.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// Of what, and under which conditions.
    pub subject: String,
    /// The picture in words, for those who cannot see it.
    pub description: String,
    /// Title of the horizontal axis with its unit.
    pub x_title: String,
    /// Panels, in rows of two.
    pub panels: Vec<ChartPanel>,
    /// Whether all panels have one vertical range.
    pub same_y: bool,
    /// Heading of the legend.
    pub legend: String,
    /// Look and name of each series.
    pub names: Vec<(Look, String)>,
}

/// Draws a chart as SVG text.
#[must_use]
pub fn chart(chart: &Chart) -> String {
    let several = chart.panels.len() > 1;
    let (wide, tall) = if several { ONE_OF } else { LONE };
    let columns = if several { 2 } else { 1 };
    let rows = chart.panels.len().div_ceil(columns).max(1);
    let pitch = (wide + LEFT + GAP, tall + BELOW + HEADING + GAP);
    let right = PLOT_LEFT + (columns - 1) as f64 * pitch.0 + wide;
    let size = (right + 18.0 + STRIP, TOP + rows as f64 * pitch.1);
    let mut figure = Figure::new(size, PLOT_LEFT, &chart.title, &chart.subject, &chart.description);
    let stacked = chart.panels.iter().any(|p| p.stacked);
    let count = chart.names.len();
    let paints: Vec<String> = (0..if stacked { count } else { 0 }).map(|i| fill(&mut figure, "part", i, count)).collect();
    for (k, panel) in chart.panels.iter().enumerate() {
        let (left, top) = (PLOT_LEFT + (k % columns) as f64 * pitch.0, TOP + HEADING + (k / columns) as f64 * pitch.1);
        let rect = Rect { left, right: left + wide, top, bottom: top + tall };
        draw(&mut figure, chart, panel, rect, &paints);
    }
    let mut entries: Vec<(Mark, String)> = Vec::new();
    for (look, name) in &chart.names {
        let mark = paints.get(look.index).map_or_else(|| Mark::Line(stroke(*look)), |paint| Mark::Fill(paint.clone()));
        entries.push((mark, name.clone()));
    }
    if stacked {
        entries.reverse(); // listed as they lie
    }
    legend(&mut figure, (right + 18.0, TOP + HEADING), STRIP - 8.0, &chart.legend, &entries);
    figure.finish()
}

fn draw(figure: &mut Figure, chart: &Chart, panel: &ChartPanel, rect: Rect, paints: &[String]) {
    let ticks = if chart.panels.len() > 1 { (5, 5) } else { (8, 8) };
    let xs = || chart.panels.iter().flat_map(|p| &p.series).flat_map(|(_, points)| points.iter().map(|p| p.0));
    let (low, high) = (xs().fold(f64::INFINITY, f64::min), xs().fold(f64::NEG_INFINITY, f64::max));
    // A lone value stands in the middle.
    let room = if low < high { 0.0 } else { 0.1 * low.abs() + 1e-3 };
    let x = Axis::exact(&chart.x_title, low - room, high + room, ticks.0);
    let ys: Vec<f64> = if chart.same_y { chart.panels.iter().flat_map(heights).collect() } else { heights(panel) };
    let y = Axis::round(&panel.y_title, ys.into_iter(), ticks.1);
    let axes = Panel::draw(figure, rect, x, y, true);
    figure.text((rect.left, rect.top - 7.0), 12.0, Anchor::Start, "font-weight=\"bold\"", INK, &panel.heading);
    if panel.stacked {
        stack(figure, &axes, panel, paints);
    } else {
        // The first of the list ends up on top.
        for (look, points) in panel.series.iter().rev() {
            let finite: Vec<(f64, f64)> = points.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
            axes.line_any(figure, &finite, stroke(*look));
        }
    }
    if panel.series.iter().all(|(_, points)| points.is_empty()) {
        axes.empty(figure);
    }
    axes.outline(figure);
}

/// Every height that has to fit into a panel.
fn heights(panel: &ChartPanel) -> Vec<f64> {
    let mut all: Vec<f64> = if panel.from_zero || panel.stacked { vec![0.0] } else { Vec::new() };
    if panel.stacked {
        let most = panel.series.iter().map(|(_, points)| points.len()).max().unwrap_or(0);
        let sum = |i: usize| panel.series.iter().filter_map(|(_, points)| points.get(i)).map(|p| p.1).sum::<f64>();
        all.extend((0..most).map(sum));
    } else {
        all.extend(panel.series.iter().flat_map(|(_, points)| points.iter().map(|p| p.1)));
    }
    all
}

fn stack(figure: &mut Figure, axes: &Panel, panel: &ChartPanel, paints: &[String]) {
    let mut base: Vec<f64> = vec![0.0; panel.series.iter().map(|(_, points)| points.len()).max().unwrap_or(0)];
    for (look, points) in &panel.series {
        let top: Vec<f64> = base.iter().zip(points).map(|(low, p)| low + p.1).collect();
        let mut path = Path::default();
        for (p, high) in points.iter().zip(&top) {
            path.line_to(axes.px(p.0), axes.py(*high));
        }
        for (p, low) in points.iter().zip(&base).rev() {
            path.line_to(axes.px(p.0), axes.py(*low));
        }
        path.close();
        let paint = paints.get(look.index).map_or("none", String::as_str);
        let data = path.finish();
        figure.raw(&format!(
            "<path class=\"layer\" d=\"{data}\" fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"1.5\" stroke-linejoin=\"round\"/>"
        ));
        base = top;
    }
}

fn stroke(look: Look) -> Stroke {
    let full = STROKES[look.index % STROKES.len()];
    if look.dotted { Stroke { width: 1.2, dash: &[1.5, 2.5], ..full } } else { full }
}
