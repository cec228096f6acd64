//! Figures like 6-5 to 6-9 of the thesis: slip and radii on the variator rig, with its printed numbers.

use super::engine::{
    Axis, BELOW, Chart, End, Entry, INK, LEFT, PLOT_LEFT, PUBLISHED, Palette, Panel, Point, Stroke,
    Style, Symbol, WIDTH, ZERO, at, grid, range, stroke,
};
use super::picture::PictureTable;
use super::printed::{THESIS_CAR, number};
use crate::number::{grouped, signed};
use cvtcycle_model::rig::variator::{RigFlags, VariatorRow};
use cvtcycle_output::variator::{Curve, VariatorCurves};

const X: &str = "Torque at the secondary pulley [Nm]";
/// Maximum number of drawn tests.
const MAX_TESTS: usize = 6;
/// Maximum drawn slip.
const MAX_SLIP: f64 = 0.05;
/// Slip up to which the thesis has figures, a share.
const PRINTED_SLIP: f64 = 0.03;
/// Secondary pressure of the printed slip speeds and breakpoint, bar.
const PRINTED_BAR: f64 = 30.0;

const TOP: f64 = 84.0;
/// Room between two panels, and right of each for the names of its lines, pixels.
const GAP: f64 = 36.0;
const NAMES: f64 = 62.0;
/// Sizes of a panel alone in its row, and of one of two, pixels.
const LONE: Point = (WIDTH - PLOT_LEFT - NAMES - 12.0, 270.0);
const PAIRED: Point = ((WIDTH - PLOT_LEFT - LEFT - 2.0 * NAMES - 24.0) / 2.0, 240.0);
const RADIUS: f64 = 3.6;

/// A value of a row.
type Get = fn(&VariatorRow) -> f64;

const SLIP: Get = |r| 100.0 * r.belt.losses.slip_total;
const SLIP_SPEED: [(&str, Get); 2] = [
    ("Primary", |r| r.slip_m_s()[0]),
    ("Secondary", |r| r.slip_m_s()[1]),
];

/// Figures with their file names.
pub fn variator_figures(rig_curves: &VariatorCurves) -> Vec<(&'static str, String)> {
    let tests = rig_curves
        .curves
        .chunk_by(Curve::is_same_test)
        .take(MAX_TESTS);
    let tests: Vec<&[Curve]> = tests.collect();
    let is_printed = rig_curves.vehicle == THESIS_CAR;
    let slip = |test: &&[Curve]| {
        let mut curves = by_pressure(test, "Slip [%]", SLIP);
        if is_printed {
            curves.printed_slip(test);
        }
        curves
    };
    let mut speeds = Vec::new();
    for test in &tests {
        for (k, (pulley, get)) in SLIP_SPEED.into_iter().enumerate() {
            let mut curves = by_pressure(test, "Slip speed [m/s]", get);
            let name = test.first().map_or_else(String::new, short_name);
            curves.heading = format!("{pulley}, {name}");
            if is_printed {
                curves.printed_speed(test, k);
            }
            speeds.push(curves);
        }
    }
    let middles = tests.iter().filter_map(|test| test.get(test.len() / 2));
    let radii =
        middles.flat_map(|curve| [radii("Primary", curve, 0), radii("Secondary", curve, 1)]);
    vec![
        (
            "radii.svg",
            figure(rig_curves, radius_title(&tests), radii.collect(), 2),
        ),
        (
            "slip.svg",
            figure(
                rig_curves,
                slip_title(&tests),
                tests.iter().map(slip).collect(),
                1,
            ),
        ),
        (
            "slip_speed.svg",
            figure(rig_curves, speed_title(&tests), speeds, 2),
        ),
    ]
}

/// Ratio and speed of a test, without its temperature: fits above half of a picture.
fn short_name(curve: &Curve) -> String {
    let name = curve.test_name();
    let short = name
        .rsplit_once(", belt")
        .map(|(short, _)| short.to_owned());
    short.unwrap_or(name)
}

/// "15 bar".
fn bar(curve: &Curve) -> String {
    format!("{} bar", curve.bar())
}

/// Title: slip at low torque and at the end over the pressures of the first test.
fn slip_title(tests: &[&[Curve]]) -> String {
    let test = tests.first().copied().unwrap_or_default();
    let ends = test.first().zip(test.last());
    let breakpoints = ends.map(|(a, b)| (a.summary.breakpoint_nm, b.summary.breakpoint_nm, a, b));
    match breakpoints.filter(|of| of.0.is_finite() && of.1.is_finite()) {
        Some((from, to, a, b)) if test.len() > 1 => format!(
            "The belt holds up to {} Nm at {} and {} Nm at {}, then slips",
            grouped(from, 0),
            bar(a),
            grouped(to, 0),
            bar(b)
        ),
        Some((from, _, a, _)) => {
            format!(
                "The belt holds up to {} Nm at {}, then slips",
                grouped(from, 0),
                bar(a)
            )
        }
        None => "Belt slip against torque".to_owned(),
    }
}

/// Interpolates one quantity at the point where a curve passes a value of another one.
fn where_it_is(curve: &Curve, of: Get, value: f64, get: Get) -> Option<f64> {
    let points: Vec<(f64, f64)> = rows(curve).map(|row| (of(row), get(row))).collect();
    let mut pieces = points.windows(2);
    let piece = pieces.find(|pair| pair[0].0 <= value && value < pair[1].0)?;
    let ((x0, y0), (x1, y1)) = (piece[0], piece[1]);
    Some(y0 + (y1 - y0) * (value - x0) / (x1 - x0))
}

/// Curve at the pressure of the printed slip speeds, in a test that has one and a breakpoint.
fn printed_curve(test: &[Curve]) -> Option<&Curve> {
    let own = |curve: &&Curve| (curve.bar() - PRINTED_BAR).abs() < 1e-6;
    let curve = test.iter().find(own)?;
    curve.summary.breakpoint_nm.is_finite().then_some(curve)
}

fn speed_title(tests: &[&[Curve]]) -> String {
    let of = |curve: &Curve| {
        let speeds = SLIP_SPEED
            .map(|(_, get)| where_it_is(curve, |r| r.belt.losses.slip_total, PRINTED_SLIP, get));
        Some((bar(curve), speeds[0]?, speeds[1]?))
    };
    let first = tests
        .iter()
        .filter_map(|test| printed_curve(test).or(test.first()));
    match first.filter_map(of).next() {
        Some((at, primary, secondary)) => format!(
            "At {at} and 3 % slip the belt slips {} m/s on the primary and {} m/s on the secondary",
            grouped(primary, 2),
            grouped(secondary, 2)
        ),
        None => "Slip speed at both pulleys against torque".to_owned(),
    }
}

/// Relative change of the primary's radius from the speeds, from zero torque to the last drawn torque, %.
fn radius_change(curve: &Curve) -> Option<(f64, f64)> {
    points(curve, RADII[0].1[0]).last().copied()
}

fn radius_title(tests: &[&[Curve]]) -> String {
    let middle = tests.first().and_then(|test| test.get(test.len() / 2));
    match middle.and_then(radius_change) {
        Some((nm, change)) => format!(
            "At {} Nm slip changes the primary's radius, as read from the speeds, by {} %; the sheaves do not move",
            grouped(nm, 0),
            signed(grouped(change, 1), change)
        ),
        None => "Running radii, geometric and from speeds".to_owned(),
    }
}

/// Lines against torque.
struct Curves {
    heading: String,
    y: &'static str,
    lines: Vec<Line>,
    /// Meaning of the colours.
    palette: Palette,
    /// Published points, and a published range over all torques.
    printed: (Vec<Point>, Option<[f64; 2]>),
}

struct Line {
    name: String,
    /// Points in ascending order of torque.
    points: Vec<Point>,
    /// Breakpoint on the line.
    breakpoint: Option<Point>,
}

impl Curves {
    /// Typical slip by the thesis, and its printed breakpoint.
    fn printed_slip(&mut self, test: &[Curve]) {
        if printed_curve(test).is_none() {
            return;
        }
        let breakpoint = number(&["6.08"]).map(|[nm, _]| (nm, 0.0));
        self.printed = (breakpoint.into_iter().collect(), number(&["6.11b"]));
    }

    /// Slip speed of the primary at 3 % slip, and of the secondary where the primary has the printed one.
    fn printed_speed(&mut self, test: &[Curve], pulley: usize) {
        let torque: Get = |r| r.output_nm;
        let Some((curve, [primary, _])) = printed_curve(test).zip(number(&["6.12a"])) else {
            return;
        };
        let point = match pulley {
            0 => where_it_is(curve, |r| r.belt.losses.slip_total, PRINTED_SLIP, torque)
                .map(|nm| (nm, primary)),
            _ => {
                let nm = where_it_is(curve, SLIP_SPEED[0].1, primary, torque);
                nm.zip(number(&["6.12b"]))
                    .map(|(nm, [speed, _])| (nm, speed))
            }
        };
        self.printed.0.extend(point);
    }

    fn count(&self) -> usize {
        self.lines.len()
    }

    fn stroke(&self, line: usize) -> Stroke {
        self.palette.stroke(line, self.count())
    }
}

/// Rows up to the drawn slip, in ascending order of torque: the figures of the thesis end at 3 %, and at gross slip the value is only a bound.
fn rows(curve: &Curve) -> impl Iterator<Item = &VariatorRow> {
    curve.rows.iter().filter(|row| {
        row.belt.losses.slip_total.abs() <= MAX_SLIP && !row.flags.contains(RigFlags::GROSS_SLIP)
    })
}

fn points(curve: &Curve, get: Get) -> Vec<Point> {
    let mut points: Vec<Point> = rows(curve).map(|row| (row.output_nm, get(row))).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// A line for each pressure with its breakpoint.
fn by_pressure(test: &[Curve], y: &'static str, get: Get) -> Curves {
    let line = |curve: &Curve| {
        let points = points(curve, get);
        let nm = curve.summary.breakpoint_nm;
        let mut pieces = points.windows(2);
        let piece = pieces.find(|pair| pair[0].0 <= nm && nm <= pair[1].0);
        let breakpoint = piece.map(|pair| {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            (nm, y0 + (y1 - y0) * (nm - x0) / (x1 - x0))
        });
        Line {
            name: bar(curve),
            points,
            breakpoint,
        }
    };
    Curves {
        heading: test.first().map_or_else(String::new, Curve::test_name),
        y,
        lines: test.iter().map(line).collect(),
        palette: Palette::Ordered,
        printed: (Vec::new(), None),
    }
}

/// Name and value of the radii of both pulleys: their change from the rig's radius at zero torque, %.
const RADII: [(&str, [Get; 2]); 2] = [
    (
        "speeds",
        [
            |r| 100.0 * (r.pulse_radius_m()[0] / r.zero.radius_m[0] - 1.0),
            |r| 100.0 * (r.pulse_radius_m()[1] / r.zero.radius_m[1] - 1.0),
        ],
    ),
    (
        "sheaves",
        [
            |r| 100.0 * (r.geometry.primary_radius_m / r.zero.radius_m[0] - 1.0),
            |r| 100.0 * (r.geometry.secondary_radius_m / r.zero.radius_m[1] - 1.0),
        ],
    ),
];

/// Radii of a pulley, by geometry and by speeds.
fn radii(pulley: &str, curve: &Curve, k: usize) -> Curves {
    let line = |(name, get): (&str, [Get; 2])| Line {
        name: name.to_owned(),
        points: points(curve, get[k]),
        breakpoint: None,
    };
    Curves {
        heading: format!("{pulley}, {}, {}", short_name(curve), bar(curve)),
        y: "Radius against no torque [%]",
        lines: RADII.map(line).into(),
        palette: Palette::Kinds,
        printed: (Vec::new(), None),
    }
}

/// Panels in rows, with the names of the lines at their ends.
fn figure(
    rig_curves: &VariatorCurves,
    title: String,
    panels: Vec<Curves>,
    columns: usize,
) -> String {
    let (vehicle, model) = (&rig_curves.vehicle, &rig_curves.formulation);
    let percent = 100.0 * MAX_SLIP;
    let subject = format!("{vehicle}, {model}; drawn up to {percent} % slip");
    let size = if columns > 1 { PAIRED } else { LONE };
    let pitch = (size.0 + NAMES + LEFT + 12.0, size.1 + BELOW + GAP);
    let place = grid((PLOT_LEFT, TOP), size, pitch, columns);
    let entries = entries(&panels);
    let panels = panels.into_iter().enumerate();
    let panels: Vec<Panel> = panels
        .map(|(k, of)| {
            let rect = place(k);
            draw(Panel::new(rect, Axis::default(), Axis::default()), of)
        })
        .collect();
    Chart::new(title, subject, PLOT_LEFT)
        .panels(panels)
        .legend((PLOT_LEFT, WIDTH - PLOT_LEFT - 20.0), entries)
        .picture(PictureTable::default())
        .svg
}

fn entries(panels: &[Curves]) -> Vec<Entry> {
    let lines = panels.iter().flat_map(|of| &of.lines);
    let marked = lines.clone().any(|line| line.breakpoint.is_some());
    let point = panels.iter().any(|of| !of.printed.0.is_empty());
    let band = panels.iter().any(|of| of.printed.1.is_some());
    let breakpoint = || Entry::symbol(Symbol::CIRCLE, Symbol::white(INK), "breakpoint");
    let printed = || {
        let style = Symbol::white(PUBLISHED);
        Entry::symbol(Symbol::DIAMOND, style, "printed in the thesis, 30 bar")
    };
    let typical = || Entry::line(EDGE, "slip that the thesis calls typical");
    let list = [
        marked.then(breakpoint),
        point.then(printed),
        band.then(typical),
    ];
    list.into_iter().flatten().collect()
}

/// Edge of a published range.
const EDGE: Stroke = stroke(PUBLISHED, 1.2, &[3.0, 2.0]);

fn draw(mut panel: Panel, of: Curves) -> Panel {
    let points = |line: &Line| line.points.clone().into_iter().chain(line.breakpoint);
    let all: Vec<Point> = of.lines.iter().flat_map(points).collect();
    // Each panel has its own range: high ratio ends at torques where low ratio has hardly begun.
    let (low, high) = range(all.iter().map(|p| p.0)).unwrap_or((0.0, 1.0));
    let printed = of.printed.0.iter().map(|p| p.1);
    let printed = printed.chain(of.printed.1.into_iter().flatten());
    panel.x = Axis::exact(X, low, high, 6);
    panel.y = Axis::round(of.y, all.iter().map(|p| p.1).chain([0.0]).chain(printed), 6);
    panel = panel.heading(&of.heading).no_data(all.is_empty());
    if panel.y.low < 0.0 && panel.y.high > 0.0 {
        panel.level(0.0, ZERO);
    }
    if let Some([from, to]) = of.printed.1 {
        let band = Style::colour(PUBLISHED).fill_opacity(0.10).class("printed");
        panel.rectangle(at(low, from), at(high, to), band);
        panel.level(from, EDGE);
        panel.level(to, EDGE);
    }
    for (k, line) in of.lines.iter().enumerate().rev() {
        panel.series(line.points.clone(), of.stroke(k));
    }
    for (x, y) in of.lines.iter().filter_map(|line| line.breakpoint) {
        let style = Symbol::white(INK).class("mark");
        panel.symbol(Symbol::CIRCLE, at(x, y), RADIUS, style);
    }
    for (x, y) in &of.printed.0 {
        let style = Symbol::white(PUBLISHED).class("printed");
        panel.symbol(Symbol::DIAMOND, at(*x, *y), RADIUS + 1.4, style);
    }
    let ends = of.lines.iter().enumerate();
    let ends = ends.filter_map(|(k, line)| {
        Some(End {
            at: *line.points.last()?,
            text: line.name.clone(),
            colour: of.stroke(k).colour,
        })
    });
    let ends = ends.collect();
    panel.ends = ends;
    panel
}
