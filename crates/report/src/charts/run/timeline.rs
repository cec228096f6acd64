//! Pictures over time: stacked panels over one axis, and the steps as a table.

use super::PlotRun;
use crate::charts::engine::{
    Axis, Chart, Cut, End, Entry, Label, PLOT_LEFT, Panel, QUIET, Rect, Shape, Stroke, Style,
    WIDTH, at, cell, range, stroke, text_width,
};
use crate::charts::lines::{PrintedMark, printed_entries};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{sign, with_unit};
use cvtcycle_output::History;
use cvtcycle_output::trace::column;

/// Width of the plots, pixels.
pub(super) const PLOT_WIDE: f64 = WIDTH - 28.0 - PLOT_LEFT;
/// Upper edge of the first plot: below the title and the names of the phases, pixels.
pub(super) const PLOT_TOP: f64 = 72.0;
const GAP: f64 = 16.0;
/// Room above a panel for its heading, pixels.
pub(super) const HEADED: f64 = 22.0;
/// Maximum number of rows of a table.
const MAX_ROWS: usize = 600;
/// The line of a marked value.
const LEVEL: Stroke = stroke(QUIET, 0.8, &[4.0, 2.0]);
/// Line at the beginning of a phase.
const PHASE: Stroke = stroke(QUIET, 0.75, &[1.0, 2.5]);
const PHASE_TEXT: f64 = 11.0;

/// Unit, and conversion of a value to it.
pub(super) type Shown = (&'static str, fn(f64) -> f64);

/// A column of the trace as a line.
pub(super) struct Series {
    pub column: &'static str,
    pub title: &'static str,
    pub stroke: Stroke,
    /// Unit other than that of the column, with the conversion.
    pub shown: Option<Shown>,
}

impl Series {
    pub fn new(column: &'static str, title: &'static str, stroke: Stroke) -> Self {
        Series {
            column,
            title,
            stroke,
            shown: None,
        }
    }

    fn unit(&self) -> &'static str {
        self.shown
            .map_or_else(|| unit(self.column), |(unit, _)| unit)
    }

    fn value(&self, x: f64) -> f64 {
        self.shown.map_or(x, |(_, of)| of(x))
    }

    /// Step of the last digit in a table.
    fn resolution(&self) -> f64 {
        self.shown.map_or_else(|| resolution(self.column), |_| 0.1)
    }
}

/// One panel.
pub(super) struct Strip {
    /// Title of the vertical axis, without unit.
    pub title: &'static str,
    /// Height, pixels.
    pub tall: f64,
    /// Lines, all in one unit; the first is on top.
    pub lines: Vec<Series>,
    /// Values that the axis includes in addition to the data.
    pub with: &'static [f64],
    /// Upper limit beyond which lines leave the panel.
    pub max: f64,
    /// Value marked with a thin line, and its name in the legend.
    pub mark: Option<(f64, &'static str)>,
    /// True to name lines at their ends.
    pub named: bool,
    /// Published numbers: ranges on the time axis, s, and on the vertical one.
    pub printed: Vec<([f64; 2], [f64; 2])>,
}

impl Strip {
    /// A panel of one line that begins at zero.
    pub fn single(column: &'static str, title: &'static str, tall: f64, stroke: Stroke) -> Self {
        Strip {
            title,
            tall,
            lines: vec![Series::new(column, title, stroke)],
            with: &[0.0],
            max: f64::INFINITY,
            mark: None,
            named: false,
            printed: Vec::new(),
        }
    }

    /// Room for the names at the ends of its lines, pixels.
    fn names(&self) -> f64 {
        let names = self.lines.iter().filter(|_| self.named);
        let widest = names
            .map(|line| text_width(line.title, PHASE_TEXT))
            .fold(0.0, f64::max);
        if widest > 0.0 { widest + 12.0 } else { 0.0 }
    }

    fn values<'h>(&self, history: &'h History) -> impl Iterator<Item = f64> + use<'_, 'h> {
        let lines = self.lines.iter();
        lines.flat_map(|line| history.column(line.column).iter().map(|x| line.value(*x)))
    }

    /// All values that must fit into the panel.
    fn heights(&self, history: &History) -> impl Iterator<Item = f64> {
        let values = self.values(history).map(|y| y.min(self.max));
        let values = values.filter(|y| y.is_finite());
        let printed = self.printed.iter().flat_map(|(_, y)| *y);
        values.chain(self.with.iter().copied()).chain(printed)
    }

    fn axis(&self, history: &History) -> Axis {
        let unit = self.lines.first().map_or("", Series::unit);
        let title = with_unit(self.title, unit);
        let ticks = (self.tall / 28.0) as usize;
        Axis::round(&title, self.heights(history), ticks)
    }

    fn panel(&self, rect: Rect, history: &History) -> Panel {
        self.panel_on(rect, history, self.axis(history))
    }

    fn panel_on(&self, rect: Rect, history: &History, y: Axis) -> Panel {
        let mut values = self.values(history);
        let mut panel = Panel::new(rect, time_axis(history), y)
            .over_table()
            .no_data(!values.any(|y| y.is_finite()));
        if let Some((level, _)) = self.mark {
            panel.level(level, LEVEL);
        }
        let first = panel.items.len();
        for line in self.lines.iter().rev() {
            panel.series(points(history, line), line.stroke);
        }
        if self.max.is_finite() {
            let lines = panel.items.split_off(first);
            panel.add(Shape::Within(None, lines), Style::default());
        }
        for (x, y) in &self.printed {
            PrintedMark { x: *x, y: *y }.draw(&mut panel, false);
        }
        if self.named {
            let ends = self.lines.iter().filter_map(|line| {
                let points = points(history, line);
                let last = points.into_iter().rfind(|p| p.1.is_finite())?;
                Some(End {
                    at: last,
                    text: line.title.to_owned(),
                    colour: line.stroke.colour,
                })
            });
            let ends = ends.collect();
            panel.ends = ends;
        }
        panel
    }
}

/// Draws the panels of a run, with one legend below.
pub(super) fn timeline(run: &PlotRun, title: impl Into<String>, strips: &[Strip]) -> Picture {
    let lines: Vec<&Series> = strips.iter().flat_map(|strip| &strip.lines).collect();
    let wide = PLOT_WIDE - strips.iter().map(Strip::names).fold(0.0, f64::max);
    let mut top = PLOT_TOP;
    let panel = |(k, strip): (usize, &Strip)| {
        let rect = Rect::new(PLOT_LEFT, top, wide, strip.tall);
        let mut panel = strip
            .panel(rect, run.history)
            .x_labels(k + 1 == strips.len());
        phases(&mut panel, run.history, k == 0);
        top += strip.tall + GAP;
        panel
    };
    Chart::new(title, run.name, PLOT_LEFT)
        .panels(strips.iter().enumerate().map(panel))
        .legend((PLOT_LEFT, PLOT_WIDE), entries(strips))
        .picture(table(&[(run, lines)]))
}

/// Draws one panel for each car, below each other on one scale; the lines are named at their ends.
pub(super) fn side_by_side(cars: &[(&PlotRun, Strip)], title: String, subject: &str) -> Picture {
    let axes = cars.iter().map(|(run, strip)| strip.axis(run.history));
    let title_of = axes.map(|axis| axis.title).next().unwrap_or_default();
    let values = cars
        .iter()
        .flat_map(|(run, strip)| strip.heights(run.history));
    let ticks = cars.first().map_or(6.0, |(_, strip)| strip.tall / 28.0);
    let y = Axis::round(&title_of, values, ticks as usize);
    let wide = PLOT_WIDE
        - cars
            .iter()
            .map(|(_, strip)| strip.names())
            .fold(0.0, f64::max);
    let mut top = PLOT_TOP;
    let mut first = 1;
    let panel = |(k, (run, strip)): (usize, &(&PlotRun, Strip))| {
        top += HEADED;
        let rect = Rect::new(PLOT_LEFT, top, wide, strip.tall);
        let panel = strip.panel_on(rect, run.history, y.clone());
        let mut panel = panel.x_labels(k + 1 == cars.len());
        panel.heading = run.name.to_owned();
        panel.columns = (first..first + strip.lines.len()).collect();
        first += strip.lines.len();
        phases(&mut panel, run.history, false);
        top += strip.tall + GAP;
        panel
    };
    let panels: Vec<Panel> = cars.iter().enumerate().map(panel).collect();
    let strips: Vec<&Strip> = cars.iter().map(|(_, strip)| strip).collect();
    let listed = cars
        .iter()
        .map(|(run, strip)| (*run, strip.lines.iter().collect::<Vec<_>>()));
    Chart::new(title, subject, PLOT_LEFT)
        .panels(panels)
        .legend((PLOT_LEFT, PLOT_WIDE), entries(strips))
        .picture(table(&listed.collect::<Vec<_>>()))
}

/// Legend entries of marked values and published numbers; lines are named by their axis or at their ends.
fn entries<'s>(strips: impl IntoIterator<Item = &'s Strip>) -> Vec<Entry> {
    let strips: Vec<&Strip> = strips.into_iter().collect();
    let levels = strips.iter().filter_map(|strip| strip.mark);
    let levels = levels.map(|(_, name)| Entry::line(LEVEL, name));
    let printed = strips.iter().flat_map(|strip| &strip.printed);
    let printed: Vec<PrintedMark> = printed.map(|(x, y)| PrintedMark { x: *x, y: *y }).collect();
    levels.chain(printed_entries(printed.iter())).collect()
}

/// Unit of a column.
fn unit(name: &str) -> &'static str {
    sign(column(name).map_or("", |column| column.unit))
}

/// Points of a column: means at the middle of their step, temperatures at its end, a gear over all of it.
fn points(history: &History, of: &Series) -> Vec<(f64, f64)> {
    let name = of.column;
    let times = history.time_s().iter().zip(history.dt_s());
    let steps = times.zip(history.column(name));
    if name == "gear" {
        return steps
            .flat_map(|((end, dt), y)| [(end - dt, *y), (*end, *y)])
            .collect();
    }
    let back = if name.ends_with("_degc") { 0.0 } else { 0.5 };
    steps
        .map(|((end, dt), y)| (end - back * dt, of.value(*y)))
        .collect()
}

/// Start of a trace, s.
fn start_s(history: &History) -> Option<f64> {
    let first = history.time_s().first().zip(history.dt_s().first());
    first.map(|(end, dt)| end - dt)
}

/// Time axis over exactly a trace.
pub(super) fn time_axis(history: &History) -> Axis {
    let end = history.time_s().last().copied().unwrap_or(1.0);
    Axis::exact("Time [s]", start_s(history).unwrap_or(0.0), end, 10)
}

/// Marks the beginnings of phases, with names above the plot where these fit.
pub(super) fn phases(panel: &mut Panel, history: &History, named: bool) {
    let Some(mut from) = start_s(history) else {
        return;
    };
    let steps: Vec<usize> = (0..history.len()).collect();
    let parts: Vec<&[usize]> = steps
        .chunk_by(|a, b| history.phase(*a) == history.phase(*b))
        .collect();
    for (i, part) in parts.iter().enumerate() {
        let (first, to) = (part[0], history.time_s()[part[part.len() - 1]]);
        let wide = panel.px(to) - panel.px(from);
        if i > 0 && wide > 3.0 {
            panel.upright(from, PHASE);
        }
        let name = history.phases().get(history.phase(first));
        let name = name.map_or("", String::as_str);
        let short = Cut::End.apply(name, PHASE_TEXT, wide - 4.0);
        // A name cut to a few letters is useless.
        let readable = short == name || text_width(&short, PHASE_TEXT) > 40.0;
        if named && parts.len() > 1 && readable {
            let place = at(0.5 * (from + to), f64::INFINITY).shift(0.0, -5.0);
            let name = Label::new(place, name).middle().class("phase");
            panel.label(name.cut(Cut::End, wide - 4.0));
        }
        from = to;
    }
}

/// Table of thinned steps of the first run with all drawn columns; of the others the steps that end at the same time.
fn table(runs: &[(&PlotRun, Vec<&Series>)]) -> PictureTable {
    let plain = |unit: &'static str| if unit == "-" { "" } else { unit };
    let several = runs.len() > 1;
    let mut table = PictureTable::new(&[("Time", "s")]);
    for (run, lines) in runs {
        let name = |line: &&Series| match several {
            true => format!("{}: {}", run.name, line.title.to_lowercase()),
            false => line.title.to_owned(),
        };
        let columns = lines.iter().map(|line| (name(line), plain(line.unit())));
        table.columns.extend(columns);
    }
    let Some((first, _)) = runs.first() else {
        return table;
    };
    let history = first.history;
    let every = history.len().div_ceil(MAX_ROWS).max(1);
    // Steps are rarely shorter than a hundredth of a second; distinct times stay distinct in any case.
    let step_s = range(history.dt_s().iter().copied()).map_or(1.0, |(least, _)| {
        if least >= 0.999_999 { 0.1 } else { 0.01 }
    });
    for (i, time) in history.time_s().iter().enumerate().step_by(every) {
        let mut cells = vec![cell(*time, step_s)];
        for (run, lines) in runs {
            let of = run.history;
            let here = of
                .time_s()
                .get(i)
                .is_some_and(|own| (own - time).abs() < 1e-3 || !several);
            let value = |line: &Series| {
                let own = of.column(line.column).get(i).filter(|_| here);
                own.map_or(f64::NAN, |x| line.value(*x))
            };
            let numbers = lines.iter().map(|line| (value(line), line.resolution()));
            cells.extend(numbers.map(|(x, step)| cell(x, step)));
        }
        table.push(cells);
    }
    table.note =
        "A row is the step that ends at its time: temperatures at its end, all else its mean."
            .to_owned();
    if every > 1 {
        let ordinal = match every {
            2 => "second".to_owned(),
            3 => "third".to_owned(),
            n => format!("{n}th"),
        };
        let whole = match several {
            true => "the traces".to_owned(),
            false => format!("trace_{}.csv", first.name),
        };
        table.note += &format!(
            " Every {ordinal} step is listed; all of them are in {whole}; the lines are drawn from all steps."
        );
    }
    table
}

/// Step of the last digit in a table.
fn resolution(name: &str) -> f64 {
    match unit(name) {
        "rpm" | "W" | "" => 1.0,
        "-" => 0.001,
        "bar" | "%" => 0.01,
        _ => 0.1,
    }
}
