//! Pictures over time: panels under each other over one axis, and the steps as a table.
use super::PlotRun;
use super::axis::{Axis, number, range};
use super::figure::{Anchor, Figure, INK, QUIET, Rect, fit, text_width, units};
use super::legend::{Mark, below_height, legend_below};
use super::panel::{BELOW, LEFT, Panel};
use super::picture::{Picture, PictureTable, cell};
use super::style::Stroke;
use cvtcycle_output::History;
use cvtcycle_output::trace::column;

/// Width of a picture over time, pixels: on A4 its text is still read.
pub(super) const WIDTH: f64 = 880.0;
/// Left and right edge of the plots, and the upper one of the first: below the heading and the names of the phases.
pub(super) const PLOT_LEFT: f64 = LEFT + 8.0;
pub(super) const PLOT_RIGHT: f64 = WIDTH - 28.0;
pub(super) const PLOT_TOP: f64 = 72.0;
const GAP: f64 = 16.0;
/// Rows of a table at most.
const MOST_ROWS: usize = 600;
/// The line of a marked value.
const LEVEL: Stroke = Stroke {
    colour: QUIET,
    width: 0.8,
    dash: &[4.0, 2.0],
};
const PHASE_TEXT: f64 = 11.0;

/// A column of the trace as a line.
pub(super) struct Series {
    pub column: &'static str,
    pub title: &'static str,
    pub stroke: Stroke,
}

/// One panel.
pub(super) struct Strip {
    /// Title of the vertical axis, without unit.
    pub title: &'static str,
    /// Height, pixels.
    pub tall: f64,
    /// Its lines, all in one unit; the first ends up on top.
    pub lines: Vec<Series>,
    /// Values that the axis takes in beside the data.
    pub with: &'static [f64],
    /// Beyond this value lines leave the panel.
    pub most: f64,
    /// A value that is marked with a thin line, and its name in the legend.
    pub mark: Option<(f64, &'static str)>,
    /// Whether its lines stand in the legend.
    pub legend: bool,
}

impl Strip {
    /// A panel of one line that begins at zero.
    pub fn of(column: &'static str, title: &'static str, tall: f64, stroke: Stroke) -> Self {
        Strip {
            title,
            tall,
            lines: vec![Series {
                column,
                title,
                stroke,
            }],
            with: &[0.0],
            most: f64::INFINITY,
            mark: None,
            legend: false,
        }
    }

    fn unit(&self) -> &'static str {
        self.lines.first().map_or("", |line| unit(line.column))
    }

    fn axis(&self, history: &History) -> Axis {
        let title = if self.unit().is_empty() {
            self.title.to_owned()
        } else {
            format!("{} [{}]", self.title, self.unit())
        };
        let values = self
            .lines
            .iter()
            .flat_map(|line| history.column(line.column))
            .map(|y| y.min(self.most));
        Axis::round(
            &title,
            values
                .filter(|y| y.is_finite())
                .chain(self.with.iter().copied()),
            (self.tall / 28.0) as usize,
        )
    }
}

/// Draws the panels of a run, with one legend below.
pub(super) fn timeline(run: &PlotRun, title: &str, about: &str, strips: &[Strip]) -> Picture {
    let lines = || strips.iter().flat_map(|strip| &strip.lines);
    let told: Vec<String> = lines().map(|line| words(run.history, line)).collect();
    // A line that has its panel alone is named by the axis.
    let named = strips
        .iter()
        .filter(|strip| strip.legend)
        .flat_map(|strip| &strip.lines)
        .map(|line| (line.stroke, line.title));
    let levels = strips
        .iter()
        .filter_map(|strip| strip.mark)
        .map(|(_, name)| (LEVEL, name));
    let entries: Vec<_> = named
        .chain(levels)
        .map(|(stroke, name)| (Mark::Line(stroke), name.to_owned()))
        .collect();
    let width = PLOT_RIGHT - PLOT_LEFT;
    let bottom =
        PLOT_TOP + strips.iter().map(|strip| strip.tall + GAP).sum::<f64>() - GAP + BELOW + 8.0;
    let below = below_height(entries.iter().map(|(_, name)| name.as_str()), width, "");
    let desc = format!("{about} {}.", told.join("; "));
    let mut figure = Figure::new((WIDTH, bottom + below), PLOT_LEFT, title, run.name, &desc);
    let mut top = PLOT_TOP;
    for (k, strip) in strips.iter().enumerate() {
        let rect = Rect {
            left: PLOT_LEFT,
            right: PLOT_RIGHT,
            top,
            bottom: top + strip.tall,
        };
        let axes = Panel::over_table(
            &mut figure,
            rect,
            time_axis(run.history),
            strip.axis(run.history),
            k + 1 == strips.len(),
        );
        phases(&mut figure, &axes, run.history, k == 0);
        draw(&mut figure, &axes, run.history, strip);
        top += strip.tall + GAP;
    }
    if !entries.is_empty() {
        legend_below(&mut figure, (PLOT_LEFT, bottom), width, "", &entries);
    }
    Picture {
        svg: figure.finish(),
        table: table(run, &lines().collect::<Vec<_>>()),
    }
}

fn draw(figure: &mut Figure, axes: &Panel, history: &History, strip: &Strip) {
    if let Some((level, _)) = strip.mark {
        let at = axes.py(level);
        figure.line(
            (axes.rect.left, at),
            (axes.rect.right, at),
            &LEVEL.attributes(),
        );
    }
    let cut = strip.most.is_finite();
    if cut {
        let (left, top) = (units(axes.rect.left), units(axes.rect.top));
        let (wide, tall) = (units(axes.rect.right) - left, units(axes.rect.bottom) - top);
        let id = format!("within-{top}");
        figure.define(&format!("<clipPath id=\"{id}\"><rect x=\"{left}\" y=\"{top}\" width=\"{wide}\" height=\"{tall}\"/></clipPath>\n"));
        figure.raw(&format!("<g clip-path=\"url(#{id})\">"));
    }
    let mut any = false;
    for line in strip.lines.iter().rev() {
        let points = points(history, line.column);
        any |= points.iter().any(|(_, y)| y.is_finite());
        axes.line(figure, &points, line.stroke);
    }
    if cut {
        figure.close();
    }
    if !any {
        axes.empty(figure);
    }
}

/// Unit of a column.
fn unit(name: &str) -> &'static str {
    match column(name).map_or("", |column| column.unit) {
        "degC" => "\u{b0}C",
        unit => unit,
    }
}

/// The points of a column: means stand in the middle of their step, temperatures at its end, a gear holds for the whole of it.
fn points(history: &History, name: &str) -> Vec<(f64, f64)> {
    let steps = || {
        history
            .time_s()
            .iter()
            .zip(history.dt_s())
            .zip(history.column(name))
    };
    if name == "gear" {
        return steps()
            .flat_map(|((end, dt), y)| [(end - dt, *y), (*end, *y)])
            .collect();
    }
    let back = if name.ends_with("_degc") { 0.0 } else { 0.5 };
    steps()
        .map(|((end, dt), y)| (end - back * dt, *y))
        .collect()
}

/// The time axis of a trace: all of it, no more.
pub(super) fn time_axis(history: &History) -> Axis {
    let (time, dt) = (history.time_s(), history.dt_s());
    let start = time
        .first()
        .zip(dt.first())
        .map_or(0.0, |(end, dt)| end - dt);
    Axis::exact("Time [s]", start, time.last().copied().unwrap_or(1.0), 10)
}

/// A series in words, for those who cannot see the picture.
fn words(history: &History, line: &Series) -> String {
    let values = history.column(line.column);
    let Some((low, high)) = range(values.iter().copied()) else {
        return format!("{} without data", line.title);
    };
    let unit = match unit(line.column) {
        "-" | "" => String::new(),
        unit => format!(" {unit}"),
    };
    let step = if high - low < 20.0 { 0.01 } else { 1.0 };
    let last = values
        .iter()
        .rev()
        .find(|y| y.is_finite())
        .filter(|_| line.column.ends_with("_degc"));
    let end = last.map_or(String::new(), |y| {
        format!(" and {} at the end", number(*y, 1.0))
    });
    format!(
        "{} from {} to {}{unit}{end}",
        line.title,
        number(low, step),
        number(high, step)
    )
}

/// Marks where phases begin, with their names above the plot where these fit.
pub(super) fn phases(figure: &mut Figure, panel: &Panel, history: &History, named: bool) {
    let (time, dt) = (history.time_s(), history.dt_s());
    let Some(mut from) = time.first().zip(dt.first()).map(|(end, dt)| end - dt) else {
        return;
    };
    let steps: Vec<usize> = (0..time.len()).collect();
    let parts: Vec<&[usize]> = steps
        .chunk_by(|a, b| history.phase(*a) == history.phase(*b))
        .collect();
    for (i, part) in parts.iter().enumerate() {
        let (Some(first), Some(last)) = (part.first(), part.last()) else {
            continue;
        };
        let (left, right) = (panel.px(from), panel.px(time[*last]));
        if i > 0 && left.is_finite() && right - left > 3.0 {
            let attributes =
                format!("stroke=\"{QUIET}\" stroke-width=\"3\" stroke-dasharray=\"4 10\"");
            figure.line(
                (left, panel.rect.top),
                (left, panel.rect.bottom),
                &attributes,
            );
        }
        let name = history
            .phases()
            .get(history.phase(*first))
            .map_or("", String::as_str);
        let short = fit(name, PHASE_TEXT, right - left - 4.0);
        // A name cut to a few letters tells nothing.
        let tells = short == name || text_width(&short, PHASE_TEXT) > 40.0;
        if named && parts.len() > 1 && tells && !short.is_empty() {
            let at = (0.5 * (left + right), panel.rect.top - 5.0);
            figure.text(
                at,
                PHASE_TEXT,
                Anchor::Middle,
                "class=\"phase\"",
                INK,
                &short,
            );
        }
        from = time[*last];
    }
}

/// Every so many steps with all columns that are drawn.
fn table(run: &PlotRun, lines: &[&Series]) -> PictureTable {
    let mut columns = vec![("Time", "s")];
    columns.extend(
        lines
            .iter()
            .map(|line| (line.title, shown(unit(line.column)))),
    );
    let mut table = PictureTable::new(&columns);
    let history = run.history;
    let every = history.len().div_ceil(MOST_ROWS).max(1);
    // Steps are hardly ever shorter than a hundredth of a second; times are told apart in any case.
    let step_s = range(history.dt_s().iter().copied()).map_or(1.0, |(least, _)| {
        if least >= 0.999_999 { 0.1 } else { 0.01 }
    });
    for (i, time) in history.time_s().iter().enumerate().step_by(every) {
        let mut cells = vec![cell(*time, step_s)];
        cells.extend(lines.iter().map(|line| {
            cell(
                history
                    .column(line.column)
                    .get(i)
                    .copied()
                    .unwrap_or(f64::NAN),
                fineness(line.column),
            )
        }));
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
        table.note += &format!(
            " Every {ordinal} step is listed; all of them are in trace_{}.csv; the lines are drawn from all steps.",
            run.name
        );
    }
    table
}

/// The unit in a table; none for plain ratios.
fn shown(unit: &'static str) -> &'static str {
    if unit == "-" { "" } else { unit }
}

/// What tells neighbours apart in a table.
fn fineness(name: &str) -> f64 {
    match unit(name) {
        "rpm" | "W" => 1.0,
        "" => 1.0,
        "-" => 0.001,
        "bar" | "%" => 0.01,
        _ => 0.1,
    }
}
