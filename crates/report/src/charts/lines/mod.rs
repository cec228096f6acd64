//! Line charts: one or more panels in rows of two with one legend; lines or stacked areas.
//!
//! Draws every line over a quantity other than time: ambient temperatures, tests of rigs, figures of the book.

mod printed;
mod table;

pub use printed::PrintedMark;
pub(crate) use printed::entries as printed_entries;

pub use super::engine::Palette;
use super::engine::{
    Axis, BELOW, Block, CONTEXT, Chart, End, Entry, Fill, LEFT, PLOT_LEFT, Panel, Rect, Shape,
    Side, Stroke, Style, Symbol, WIDTH, at, grid, range, stroke, text_width,
};
use super::picture::Picture;
use cvtcycle_output::Component;

const WIDE: f64 = WIDTH - 22.0 - PLOT_LEFT;
const TOP: f64 = 60.0;
const HEADING: f64 = 22.0;
/// Room between two panels of a row, and between rows, pixels.
const GAP: (f64, f64) = (14.0, 8.0);
/// Heights of a lone panel, and of one of several, pixels.
const TALL: [f64; 2] = [340.0, 210.0];
/// Maximum number of ticks of the axes of a lone panel, and of one of several.
const TICKS: [(usize, usize); 2] = [(9, 8), (6, 7)];

/// Size of names at the ends of lines, pixels; beyond this number of lines a legend has the names.
const NAME: f64 = 11.0;
const MAX_DIRECT: usize = 8;

/// A series' points in the units of its axes.
pub type Points = Vec<(f64, f64)>;

/// Appearance of a series: one index looks the same in all panels of a chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// Index of the colour and dash pattern; repeats after seven.
    pub index: usize,
    /// True for a thin dotted line of that colour, for a reference.
    pub dotted: bool,
}

/// Position of a range with its lower and its upper end.
pub type Level = (f64, f64, f64);

/// One panel.
#[derive(Clone, Debug, Default)]
pub struct LinePanel {
    /// Name of the panel; may be empty.
    pub heading: String,
    /// Title of the horizontal axis as `Quantity [unit]`; that of the chart if empty.
    pub x_title: &'static str,
    /// Title of the vertical axis as `Quantity [unit]`.
    pub y_title: &'static str,
    /// Values that the vertical axis includes in addition to those of the series; a line marks zero if it is one of them.
    pub with_y: Vec<f64>,
    /// True for stacked areas, from the bottom; false for lines.
    pub stacked: bool,
    /// Look and points of each series, with a gap where a value is not finite; stacked ones share their horizontal values.
    pub series: Vec<(Look, Points)>,
    /// Look, and position with lower and upper end, of ranges drawn below the lines.
    pub bands: Vec<(Look, Vec<Level>)>,
    /// Published numbers next to the series.
    pub printed: Vec<PrintedMark>,
}

/// A chart of lines.
#[derive(Clone, Debug, Default)]
pub struct LineChart {
    /// Title.
    pub title: String,
    /// Subject and conditions.
    pub subject: String,
    /// First sentence of the picture in words; axes and numbers are appended. May be empty.
    pub description: String,
    /// Title of the horizontal axes as `Quantity [unit]`.
    pub x_title: &'static str,
    /// Panels, in rows of two.
    pub panels: Vec<LinePanel>,
    /// True if every panel has its own horizontal range, false for a common one.
    pub own_x: bool,
    /// True if all panels of one quantity share a vertical range.
    pub same_y: bool,
    /// True for vertical axes as wide as the data, false for ends on round numbers.
    pub tight: bool,
    /// True to mark points: for few points whose connecting line is only a guide.
    pub marked: bool,
    /// Heading of the legend; may be empty.
    pub legend: String,
    /// Look and name of each series.
    pub names: Vec<(Look, String)>,
    /// Meaning of the colours of the lines.
    pub palette: Palette,
    /// Remarks below the legend.
    pub notes: Vec<String>,
    /// Component whose loss each stacked series is, by the index of its look; empty for other quantities.
    pub parts: Vec<Component>,
}

/// Draws a chart of lines.
pub fn line_chart(data: &LineChart) -> Picture {
    let (table, columns) = table::table(data);
    let direct = data.is_direct();
    let mut rects = layout(data);
    if let Some(rect) = rects.first_mut().filter(|_| direct) {
        let widths = data.names.iter().map(|(_, name)| text_width(name, NAME));
        rect.right -= widths.fold(0.0, f64::max) + 12.0;
    }
    let panels = data.panels.iter().zip(&rects).zip(columns);
    let panels = panels.map(|((panel, rect), columns)| draw(data, panel, *rect, columns));
    let stacked = data.panels.iter().any(|panel| panel.stacked);
    let entry = |(look, name): &(Look, String)| match stacked {
        true => Entry::fill(data.fill(look.index), name),
        false => Entry::line(data.stroke(*look), name),
    };
    let named = data.names.iter().filter(|_| !direct);
    let mut entries: Vec<Entry> = named.map(entry).collect();
    if stacked {
        entries.reverse(); // listed as they lie
    }
    entries.extend(printed_entries(
        data.panels.iter().flat_map(|panel| &panel.printed),
    ));
    let chart = Chart::new(&data.title, &data.subject, PLOT_LEFT)
        .lead(&data.description)
        .panels(panels);
    let heading = if direct {
        String::new()
    } else {
        data.legend.clone()
    };
    let side = Side {
        heading,
        entries,
        ..Side::default()
    };
    let chart = match free_place(&rects, side) {
        Ok(side) => chart.side(side),
        Err((heading, entries)) => chart.foot(Block::legend((PLOT_LEFT, WIDE), &heading, entries)),
    };
    let chart = match data.notes.is_empty() {
        true => chart,
        false => chart.notes((PLOT_LEFT, WIDE), data.notes.clone()),
    };
    chart.picture(table)
}

/// Rectangles of the panels.
fn layout(data: &LineChart) -> Vec<Rect> {
    let several = data.panels.len() > 1;
    let columns = 1 + usize::from(several);
    let wide = if several {
        (WIDE - LEFT - GAP.0) / 2.0
    } else {
        WIDE
    };
    let tall = TALL[usize::from(several)];
    let headed = data.panels.iter().any(|panel| !panel.heading.is_empty());
    let heading = if headed { HEADING } else { 0.0 };
    let pitch = (wide + LEFT + GAP.0, tall + heading + BELOW + GAP.1);
    let place = grid((PLOT_LEFT, TOP + heading), (wide, tall), pitch, columns);
    (0..data.panels.len()).map(place).collect()
}

/// Legend in the place that an odd number of panels leaves free, or its heading and entries if it does not fit.
fn free_place(rects: &[Rect], mut side: Side) -> Result<Side, (String, Vec<Entry>)> {
    if let [first, .., last] = rects
        && rects.len() % 2 == 1
    {
        side.corner = (first.right + GAP.0 + LEFT, last.top);
        side.width = last.width();
        if side.height() <= last.height() {
            return Ok(side);
        }
    }
    Err((side.heading, side.entries))
}

impl LineChart {
    /// True if lines are named at their ends: in a lone panel with several lines, up to a limit.
    fn is_direct(&self) -> bool {
        let lone = self.panels.len() == 1 && (2..=MAX_DIRECT).contains(&self.names.len());
        lone && self
            .panels
            .iter()
            .all(|panel| !panel.stacked && panel.series.len() == self.names.len())
    }

    /// Line style of a look.
    fn stroke(&self, look: Look) -> Stroke {
        let count = self.names.iter().map(|(look, _)| look.index + 1).max();
        let full = self.palette.stroke(look.index, count.unwrap_or(1));
        let dotted = stroke(full.colour, 1.2, &[1.5, 2.5]);
        if look.dotted { dotted } else { full }
    }

    /// Fill of a stacked series: components have their own colours.
    fn fill(&self, index: usize) -> Fill {
        match self.parts.get(index) {
            Some(part) => Fill::component(*part),
            None => Fill::nth(index, self.names.len()),
        }
    }

    /// Name of a line at its right end.
    fn end(&self, (look, points): &(Look, Points)) -> Option<End> {
        let (_, name) = self.names.iter().find(|(other, _)| other == look)?;
        let finite = points
            .iter()
            .rfind(|p| p.0.is_finite() && p.1.is_finite())?;
        Some(End {
            at: *finite,
            text: name.clone(),
            colour: self.stroke(*look).colour,
        })
    }

    /// Title of the horizontal axis of a panel.
    fn x_title(&self, panel: &LinePanel) -> &'static str {
        if panel.x_title.is_empty() {
            self.x_title
        } else {
            panel.x_title
        }
    }

    /// True if all panels share one quantity as horizontal axis.
    fn one_x(&self) -> bool {
        let mut titles = self.panels.iter().map(|panel| self.x_title(panel));
        let first = titles.next();
        titles.all(|title| Some(title) == first)
    }
}

impl Look {
    /// Solid line of that index.
    pub fn solid(index: usize) -> Self {
        let dotted = false;
        Look { index, dotted }
    }
}

fn draw(data: &LineChart, panel: &LinePanel, rect: Rect, columns: Vec<usize>) -> Panel {
    let ticks = TICKS[usize::from(data.panels.len() > 1)];
    let own = std::slice::from_ref(panel);
    let x_of = if data.own_x { own } else { &data.panels };
    let alike = |other: &&LinePanel| other.y_title == panel.y_title;
    let y_of: Vec<LinePanel> = match data.same_y {
        true => data.panels.iter().filter(alike).cloned().collect(),
        false => own.to_vec(),
    };
    let x = x_axis(data.x_title(panel), x_of, data.marked, ticks.0);
    let y = y_axis(panel.y_title, &y_of, data.tight, ticks.1);
    let mut drawn = Panel::new(rect, x, y).heading(&panel.heading);
    (drawn.over_table, drawn.columns) = (data.one_x(), columns);
    let y = &drawn.y;
    if y.low < 0.0 && y.high > 0.0 && panel.with_y.iter().any(|y| y.abs() <= 0.0) {
        drawn.level(0.0, CONTEXT);
    }
    if panel.stacked {
        stack_layers(&mut drawn, panel.series.clone(), |k| data.fill(k));
    } else {
        for (look, band) in &panel.bands {
            let fill = Style::fill(Fill::plain(data.stroke(*look).colour)).fill_opacity(0.15);
            drawn.add(Shape::between(band), fill.class("band"));
        }
        // The first of the list is on top.
        for (look, points) in panel.series.iter().rev() {
            let stroke = data.stroke(*look);
            drawn.series(points.clone(), stroke);
            for (x, y) in points.iter().filter(|_| data.marked) {
                let style = Style::colour(stroke.colour).class("mark");
                drawn.symbol(Symbol::CIRCLE, at(*x, *y), 2.6, style);
            }
        }
    }
    for mark in &panel.printed {
        mark.draw(&mut drawn, panel.stacked);
    }
    if data.is_direct() {
        let ends = panel.series.iter().filter_map(|series| data.end(series));
        drawn.ends = ends.collect();
    }
    let finite = |(x, y): &(f64, f64)| x.is_finite() && y.is_finite();
    let mut points = panel.series.iter().flat_map(|(_, points)| points);
    drawn.no_data(!points.any(finite))
}

fn x_axis(title: &str, panels: &[LinePanel], marked: bool, ticks: usize) -> Axis {
    let series = panels.iter().flat_map(|panel| &panel.series);
    let points = series.flat_map(|(_, points)| points);
    let (low, high) = range(points.map(|p| p.0)).unwrap_or((0.0, 1.0));
    // A step of a second ends at one: the axis begins at the start of the drive.
    let from_zero = title.starts_with("Time") && low > 0.0 && low < 0.02 * high;
    let low = if from_zero { 0.0 } else { low };
    let room = match high - low {
        span if span > 0.0 && marked => 0.03 * span,
        span if span > 0.0 => 0.0,
        // A lone value lies in the middle.
        _ => 0.1 * low.abs() + 1e-3,
    };
    Axis::exact(title, low - room, high + room, ticks)
}

fn y_axis(title: &str, panels: &[LinePanel], tight: bool, ticks: usize) -> Axis {
    let all = || panels.iter().flat_map(heights);
    match range(all()) {
        // The margin keeps lines off the frame.
        Some((low, high)) if tight && high - low > 1e-9 * high.abs() => {
            let room = 0.04 * (high - low);
            Axis::exact(title, low - room, high + room, ticks)
        }
        _ => Axis::round(title, all(), ticks),
    }
}

/// All heights that must fit into a panel.
fn heights(panel: &LinePanel) -> Vec<f64> {
    let mut all = panel.with_y.clone();
    all.extend(panel.printed.iter().flat_map(|mark| mark.y));
    let bands = panel.bands.iter().flat_map(|(_, band)| band);
    all.extend(bands.flat_map(|(_, low, high)| [*low, *high]));
    let series = || panel.series.iter().map(|(_, points)| points);
    if panel.stacked {
        all.push(0.0);
        let count = series().map(Vec::len).max().unwrap_or(0);
        let at = |i: usize| series().filter_map(move |points| points.get(i));
        let sum = |i: usize| at(i).map(|p| p.1).sum::<f64>();
        all.extend((0..count).map(sum));
    } else {
        all.extend(series().flatten().map(|p| p.1));
    }
    all
}

/// Adds the series of a panel as stacked areas; values that are not finite count as zero.
pub(crate) fn stack_layers(
    drawn: &mut Panel,
    series: Vec<(Look, Points)>,
    fill: impl Fn(usize) -> Fill,
) {
    let longest = series.iter().map(|(_, points)| points.len()).max();
    let mut base = vec![0.0; longest.unwrap_or(0)];
    for (look, points) in series {
        let height = |y: f64| if y.is_finite() { y } else { 0.0 };
        let layer = points.iter().zip(&mut base).map(|(p, base)| {
            let low = *base;
            *base += height(p.1);
            (p.0, low, *base)
        });
        let layer: Vec<_> = layer.collect();
        let style = Style::edged(fill(look.index), 0.4).class("layer");
        drawn.add(Shape::between(&layer), style);
    }
}
