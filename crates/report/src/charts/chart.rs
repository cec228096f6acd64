//! Line charts: one or more panels in rows of two with one legend; lines or stacked areas.
//!
//! Everything that is a line over a quantity and not over time is drawn here: ambient temperatures, tests of rigs, figures of the book.
mod table;

use super::axis::{Axis, range};
use super::figure::{Anchor, Figure, INK, Path, Rect, UNITS, fit, units};
use super::legend::{Mark, below_height, height, legend, legend_below};
use super::panel::{BELOW, LEFT, Panel};
use super::picture::Picture;
use super::style::{CONTEXT, STROKES, Stroke, fill};

/// Width of a chart, pixels: on A4 its text is still read.
const WIDTH: f64 = 880.0;
const PLOT_LEFT: f64 = LEFT + 8.0;
const PLOT_RIGHT: f64 = WIDTH - 22.0;
const TOP: f64 = 60.0;
const HEADING: f64 = 22.0;
/// Room between two panels of a row beside the axis of the second, and between rows beside headings and axes, pixels.
const GAP: (f64, f64) = (14.0, 8.0);
/// Heights of a lone panel, and of one of several, pixels.
const TALL: [f64; 2] = [340.0, 210.0];
/// Ticks of the axes at most: of a lone panel, and of one of several.
const TICKS: [(usize, usize); 2] = [(9, 8), (6, 7)];
const HEADING_TEXT: f64 = 12.0;

/// A series' points in the units of its axes.
pub type Points = Vec<(f64, f64)>;

/// How a series looks: the same number looks the same in all panels of a chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// Number of the colour and dash pattern; the eighth begins again with the first.
    pub index: usize,
    /// A thin dotted line of that colour, for what is held against it.
    pub dotted: bool,
}

/// One panel.
#[derive(Clone, Debug, Default)]
pub struct ChartPanel {
    /// What tells it from the others; may be empty.
    pub heading: String,
    /// Title of its horizontal axis as `Quantity [unit]`; that of the chart if empty.
    pub x_title: &'static str,
    /// Title of the vertical axis as `Quantity [unit]`.
    pub y_title: &'static str,
    /// Values that the vertical axis takes in beside those of the series; a line marks zero where it is one of them.
    pub with_y: Vec<f64>,
    /// Whether series are areas upon each other, from the bottom; else lines.
    pub stacked: bool,
    /// Look and points of each series, with a gap where a value is not finite; stacked ones share their horizontal values.
    pub series: Vec<(Look, Points)>,
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
    /// Title of the horizontal axes as `Quantity [unit]`.
    pub x_title: &'static str,
    /// Panels, in rows of two.
    pub panels: Vec<ChartPanel>,
    /// Whether every panel has a horizontal range of its own, else all have one.
    pub own_x: bool,
    /// Whether all panels have one vertical range.
    pub same_y: bool,
    /// Whether vertical axes are only as wide as the data, else they end on round numbers.
    pub tight: bool,
    /// Whether points are marked: where there are few of them, and what lies between is only a line.
    pub marked: bool,
    /// Heading of the legend; may be empty.
    pub legend: String,
    /// Look and name of each series.
    pub names: Vec<(Look, String)>,
}

/// Draws a chart. All panels over the quantity of the first column of its table tell the script their ends.
#[must_use]
pub fn chart(chart: &Chart) -> Picture {
    let place = Layout::of(chart);
    let mut figure = Figure::new(
        (WIDTH, place.tall),
        PLOT_LEFT,
        &chart.title,
        &chart.subject,
        &chart.description,
    );
    let stacked = chart.panels.iter().any(|p| p.stacked);
    let count = chart.names.len();
    let paints: Vec<String> = (0..if stacked { count } else { 0 })
        .map(|i| fill(&mut figure, "part", i, count))
        .collect();
    let (table, columns) = table::table(chart);
    for (k, panel) in chart.panels.iter().enumerate() {
        // Which columns of the table the panel draws.
        figure.raw(&format!(
            "<g data-columns=\"{}\">",
            columns.get(k).map_or("", String::as_str)
        ));
        draw(&mut figure, chart, panel, place.rect(k), &paints);
        figure.close();
    }
    let mut entries: Vec<(Mark, String)> = Vec::new();
    for (look, name) in &chart.names {
        let mark = paints.get(look.index).map_or_else(
            || Mark::Line(stroke(*look)),
            |paint| Mark::Fill(paint.clone()),
        );
        entries.push((mark, name.clone()));
    }
    if stacked {
        entries.reverse(); // listed as they lie
    }
    if !entries.is_empty() {
        let ((left, top), width) = place.legend;
        if place.beside {
            legend(&mut figure, (left, top), width, &chart.legend, &entries);
        } else {
            legend_below(&mut figure, (left, top), width, &chart.legend, &entries);
        }
    }
    Picture {
        svg: figure.finish(),
        table,
    }
}

/// Where panels and legend go.
struct Layout {
    columns: usize,
    panel: (f64, f64),
    pitch: (f64, f64),
    first: (f64, f64),
    legend: ((f64, f64), f64),
    /// Whether the legend stands in the place that an odd number of panels leaves free.
    beside: bool,
    tall: f64,
}

impl Layout {
    fn of(chart: &Chart) -> Self {
        let several = chart.panels.len() > 1;
        let columns = if several { 2 } else { 1 };
        let rows = chart.panels.len().div_ceil(columns).max(1);
        let wide = if several {
            (PLOT_RIGHT - PLOT_LEFT - LEFT - GAP.0) / 2.0
        } else {
            PLOT_RIGHT - PLOT_LEFT
        };
        let tall = TALL[usize::from(several)];
        let heading = if chart.panels.iter().any(|panel| !panel.heading.is_empty()) {
            HEADING
        } else {
            0.0
        };
        let pitch = (wide + LEFT + GAP.0, tall + heading + BELOW + GAP.1);
        let bottom = TOP + rows as f64 * pitch.1;
        let names: Vec<String> = chart.names.iter().map(|(_, name)| name.clone()).collect();
        let free = tall - if chart.legend.is_empty() { 0.0 } else { 20.0 };
        let beside = several
            && chart.panels.len() % 2 == 1
            && !names.is_empty()
            && height(&names, wide) <= free;
        let full = PLOT_RIGHT - PLOT_LEFT;
        let (legend, tall_legend) = if beside {
            (
                ((PLOT_LEFT + pitch.0, bottom - pitch.1 + heading), wide),
                0.0,
            )
        } else if names.is_empty() {
            (((PLOT_LEFT, bottom), full), 0.0)
        } else {
            (
                ((PLOT_LEFT, bottom), full),
                below_height(names.iter().map(String::as_str), full, &chart.legend) + 6.0,
            )
        };
        Layout {
            columns,
            panel: (wide, tall),
            pitch,
            first: (PLOT_LEFT, TOP + heading),
            legend,
            beside,
            tall: bottom + tall_legend,
        }
    }

    fn rect(&self, k: usize) -> Rect {
        let (left, top) = (
            self.first.0 + (k % self.columns) as f64 * self.pitch.0,
            self.first.1 + (k / self.columns) as f64 * self.pitch.1,
        );
        Rect {
            left,
            right: left + self.panel.0,
            top,
            bottom: top + self.panel.1,
        }
    }
}

impl Chart {
    /// Title of the horizontal axis of a panel.
    fn x_title(&self, panel: &ChartPanel) -> &'static str {
        if panel.x_title.is_empty() {
            self.x_title
        } else {
            panel.x_title
        }
    }

    /// Whether all panels stand over one quantity.
    fn one_x(&self) -> bool {
        self.panels
            .windows(2)
            .all(|pair| self.x_title(&pair[0]) == self.x_title(&pair[1]))
    }
}

fn draw(figure: &mut Figure, chart: &Chart, panel: &ChartPanel, rect: Rect, paints: &[String]) {
    let ticks = TICKS[usize::from(chart.panels.len() > 1)];
    let own = std::slice::from_ref(panel);
    let xs = if chart.own_x { own } else { &chart.panels }
        .iter()
        .flat_map(|p| &p.series)
        .flat_map(|(_, points)| points.iter().map(|p| p.0));
    let (low, high) = range(xs).unwrap_or((0.0, 1.0));
    let room = match high - low {
        span if span > 0.0 && chart.marked => 0.03 * span,
        span if span > 0.0 => 0.0,
        // A lone value stands in the middle.
        _ => 0.1 * low.abs() + 1e-3,
    };
    let x = Axis::exact(chart.x_title(panel), low - room, high + room, ticks.0);
    let y = y_axis(
        panel.y_title,
        if chart.same_y { &chart.panels } else { own },
        chart.tight,
        ticks.1,
    );
    let axes = if chart.one_x() {
        Panel::over_table(figure, rect, x, y, true)
    } else {
        Panel::draw(figure, rect, x, y, true)
    };
    let heading = fit(&panel.heading, HEADING_TEXT, rect.right - rect.left);
    figure.text(
        (rect.left, rect.top - 7.0),
        HEADING_TEXT,
        Anchor::Start,
        "font-weight=\"bold\"",
        INK,
        &heading,
    );
    if axes.y.low < 0.0 && axes.y.high > 0.0 && panel.with_y.iter().any(|y| y.abs() <= 0.0) {
        axes.line(figure, &[(axes.x.low, 0.0), (axes.x.high, 0.0)], CONTEXT);
    }
    if panel.stacked {
        stack(figure, &axes, panel, paints);
    } else {
        // The first of the list ends up on top.
        for (look, points) in panel.series.iter().rev() {
            line(figure, &axes, points, stroke(*look));
            if chart.marked {
                marks(figure, &axes, points, stroke(*look));
            }
        }
    }
    let finite = |(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
    if !panel
        .series
        .iter()
        .any(|(_, points)| points.iter().any(finite))
    {
        axes.empty(figure);
    }
    axes.outline(figure);
}

fn y_axis(title: &str, panels: &[ChartPanel], tight: bool, ticks: usize) -> Axis {
    let all = || panels.iter().flat_map(heights);
    match range(all()) {
        // So narrow that lines keep off the frame.
        Some((low, high)) if tight && high - low > 1e-9 * high.abs() => {
            let room = 0.04 * (high - low);
            Axis::exact(title, low - room, high + room, ticks)
        }
        _ => Axis::round(title, all(), ticks),
    }
}

/// Every height that has to fit into a panel.
fn heights(panel: &ChartPanel) -> Vec<f64> {
    let mut all = panel.with_y.clone();
    if panel.stacked {
        all.push(0.0);
        let most = panel
            .series
            .iter()
            .map(|(_, points)| points.len())
            .max()
            .unwrap_or(0);
        let sum = |i: usize| {
            panel
                .series
                .iter()
                .filter_map(|(_, points)| points.get(i))
                .map(|p| p.1)
                .sum::<f64>()
        };
        all.extend((0..most).map(sum));
    } else {
        all.extend(
            panel
                .series
                .iter()
                .flat_map(|(_, points)| points.iter().map(|p| p.1)),
        );
    }
    all
}

/// A line with gaps where values are not finite; what turns back on its way is drawn in full.
fn line(figure: &mut Figure, axes: &Panel, points: &[(f64, f64)], stroke: Stroke) {
    for part in points
        .split(|(x, y)| !x.is_finite() || !y.is_finite())
        .filter(|part| !part.is_empty())
    {
        if part.is_sorted_by(|a, b| a.0 <= b.0) {
            axes.line(figure, part, stroke);
        } else {
            axes.line_any(figure, part, stroke);
        }
    }
}

/// A dot at each point.
fn marks(figure: &mut Figure, axes: &Panel, points: &[(f64, f64)], stroke: Stroke) {
    for (x, y) in points
        .iter()
        .filter(|(x, y)| x.is_finite() && y.is_finite())
    {
        let (cx, cy, r) = (units(axes.px(*x)), units(axes.py(*y)), 2.6 * UNITS);
        figure.raw(&format!(
            "<circle class=\"mark\" cx=\"{cx}\" cy=\"{cy}\" r=\"{r:.1}\" fill=\"{}\"/>",
            stroke.colour
        ));
    }
}

fn stack(figure: &mut Figure, axes: &Panel, panel: &ChartPanel, paints: &[String]) {
    let mut base: Vec<f64> = vec![
        0.0;
        panel
            .series
            .iter()
            .map(|(_, points)| points.len())
            .max()
            .unwrap_or(0)
    ];
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
    if look.dotted {
        Stroke {
            width: 1.2,
            dash: &[1.5, 2.5],
            ..full
        }
    } else {
        full
    }
}

#[cfg(test)]
mod tests;
