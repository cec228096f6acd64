//! Figures like 6-5 to 6-9 of the thesis: slip and radii on the variator rig.

use super::engine::{
    Axis, BELOW, Chart, Entry, INK, LEFT, PLOT_LEFT, Panel, Point, Rect, STROKES, Side, Symbol,
    ZERO, at, range,
};
use super::picture::PictureTable;
use cvtcycle_model::bench::variator::{RigFlags, VariatorRow};
use cvtcycle_output::variator::{Curve, VariatorCurves};

const X: &str = "Torque at the secondary pulley [Nm]";
/// Largest number of tests that are drawn.
const MAX_TESTS: usize = 6;
/// Largest slip that is drawn.
const MAX_SLIP: f64 = 0.05;

const TOP: f64 = 84.0;
/// Room between two panels, pixels.
const GAP: f64 = 36.0;
const WIDE: f64 = 594.0;
/// Heights of a lone panel, and of one of several, pixels.
const TALL: [f64; 2] = [400.0, 260.0];
/// Width of the legends, pixels.
const STRIP: f64 = 196.0;
const RADIUS: f64 = 3.6;

/// A value of a row.
type Get = fn(&VariatorRow) -> f64;

/// File name, title, vertical axis and value of the figures of slip.
const SLIP: [(&str, &str, &str, Get); 4] = [
    ("slip.svg", "Belt slip", "Slip [%]", |r| {
        100.0 * r.belt.losses.slip_total
    }),
    (
        "slip_zeroed.svg",
        "Belt slip, zero at zero torque",
        "Slip reading [%]",
        |r| 100.0 * r.slip_zeroed(),
    ),
    (
        "primary_slip.svg",
        "Slip speed at the primary pulley",
        "Slip speed [m/s]",
        |r| r.slip_m_s()[0],
    ),
    (
        "secondary_slip.svg",
        "Slip speed at the secondary pulley",
        "Slip speed [m/s]",
        |r| r.slip_m_s()[1],
    ),
];

/// Name, number of the line and value in mm of the radii of both pulleys.
const RADII: [(&str, usize, [Get; 2]); 3] = [
    (
        "From belt and shaft speed",
        1,
        [
            |r| 1e3 * r.pulse_radius_m()[0],
            |r| 1e3 * r.pulse_radius_m()[1],
        ],
    ),
    (
        "Geometric",
        0,
        [
            |r| 1e3 * r.geometry.primary_radius_m,
            |r| 1e3 * r.geometry.secondary_radius_m,
        ],
    ),
    (
        "Geometric, zeroed at no torque",
        2,
        [|r| 1e3 * r.zero.radius_m[0], |r| 1e3 * r.zero.radius_m[1]],
    ),
];

/// Figures with their file names.
pub fn variator_figures(plan: &VariatorCurves) -> Vec<(&'static str, String)> {
    let tests = plan.curves.chunk_by(Curve::is_same_test).take(MAX_TESTS);
    let tests: Vec<&[Curve]> = tests.collect();
    let mut middles = Vec::new();
    for curve in tests.iter().filter_map(|test| test.get(test.len() / 2)) {
        middles.extend([radii("Primary", curve, 0), radii("Secondary", curve, 1)]);
    }
    let mut list = vec![(
        "radii.svg",
        figure(plan, "Running radii, geometric and from speeds", middles),
    )];
    for (file, title, y, get) in SLIP {
        let panels = tests.iter().map(|test| by_pressure(test, y, get)).collect();
        list.push((file, figure(plan, title, panels)));
    }
    list
}

/// Lines against torque with a legend of their own.
struct Curves {
    heading: String,
    y: &'static str,
    /// Whether zero is to lie on the vertical axis.
    with_zero: bool,
    lines: Vec<Line>,
}

struct Line {
    name: String,
    /// Number of its look.
    look: usize,
    /// Points in ascending order of torque.
    points: Vec<Point>,
    /// Where the breakpoint lies on it.
    breakpoint: Option<Point>,
}

/// Rows up to the slip that is drawn, in ascending order of torque: the figures of the thesis end at 3 %, and at gross slip the value is only
/// a bound.
fn points(curve: &Curve, get: Get) -> Vec<Point> {
    let carried = curve.rows.iter().filter(|row| {
        row.belt.losses.slip_total.abs() <= MAX_SLIP && !row.flags.contains(RigFlags::GROSS_SLIP)
    });
    let mut points: Vec<Point> = carried.map(|row| (row.output_nm, get(row))).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

/// A line for each pressure with its breakpoint.
fn by_pressure(test: &[Curve], y: &'static str, get: Get) -> Curves {
    let line = |(look, curve): (usize, &Curve)| {
        let points = points(curve, get);
        let nm = curve.summary.breakpoint_nm;
        let mut pieces = points.windows(2);
        let piece = pieces.find(|pair| pair[0].0 <= nm && nm <= pair[1].0);
        let breakpoint = piece.map(|pair| {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            (nm, y0 + (y1 - y0) * (nm - x0) / (x1 - x0))
        });
        Line {
            name: format!("{} bar", curve.bar()),
            look,
            points,
            breakpoint,
        }
    };
    Curves {
        heading: test.first().map_or_else(String::new, Curve::test_name),
        y,
        with_zero: true,
        lines: test.iter().enumerate().map(line).collect(),
    }
}

/// Radii of a pulley, from the geometry and from the speeds.
fn radii(pulley: &str, curve: &Curve, k: usize) -> Curves {
    let line = |(name, look, get): (&str, usize, [Get; 2])| Line {
        name: name.to_owned(),
        look,
        points: points(curve, get[k]),
        breakpoint: None,
    };
    Curves {
        heading: format!("{pulley}, {}, {} bar", curve.test_name(), curve.bar()),
        y: "Radius [mm]",
        with_zero: false,
        lines: RADII.map(line).into(),
    }
}

/// Panels below each other, each with its legend to the right.
fn figure(plan: &VariatorCurves, title: &str, panels: Vec<Curves>) -> String {
    let tall = TALL[usize::from(panels.len() > 1)];
    let (vehicle, model) = (&plan.vehicle, &plan.formulation);
    let percent = 100.0 * MAX_SLIP;
    let subject = format!("{vehicle}, {model}; drawn up to {percent} % slip");
    let mut chart = Chart::new(title, subject, PLOT_LEFT).width(PLOT_LEFT + WIDE + 16.0 + STRIP);
    for (k, of) in panels.into_iter().enumerate() {
        let top = TOP + k as f64 * (tall + BELOW + GAP);
        let rect = Rect::new(LEFT + 8.0, top, WIDE, tall);
        let side = Side {
            corner: (rect.right + 16.0, rect.top),
            width: STRIP - 8.0,
            entries: entries(&of.lines),
            ..Side::default()
        };
        chart = chart.panels([draw(rect, of)]).side(side);
    }
    chart.picture(PictureTable::default()).svg
}

fn entries(lines: &[Line]) -> Vec<Entry> {
    let entry = |line: &Line| Entry::line(STROKES[line.look % STROKES.len()], &line.name);
    let marked = lines.iter().any(|line| line.breakpoint.is_some());
    let mark = || Entry::symbol(Symbol::CIRCLE, Symbol::white(INK), "Breakpoint");
    let entries = lines.iter().map(entry);
    entries.chain(marked.then(mark)).collect()
}

fn draw(rect: Rect, of: Curves) -> Panel {
    let points = |line: &Line| line.points.clone().into_iter().chain(line.breakpoint);
    let all: Vec<Point> = of.lines.iter().flat_map(points).collect();
    // Every panel has its own range: high ratio ends where low ratio has hardly begun.
    let (low, high) = range(all.iter().map(|p| p.0)).unwrap_or((0.0, 1.0));
    let zero = of.with_zero.then_some(0.0);
    let y = Axis::round(of.y, all.iter().map(|p| p.1).chain(zero), 7);
    let mut panel = Panel::new(rect, Axis::exact(X, low, high, 8), y)
        .heading(of.heading)
        .no_data(all.is_empty());
    if panel.y.low < 0.0 && panel.y.high > 0.0 {
        panel.level(0.0, ZERO);
    }
    let marks: Vec<Point> = of.lines.iter().filter_map(|line| line.breakpoint).collect();
    for line in of.lines.into_iter().rev() {
        panel.series(line.points, STROKES[line.look % STROKES.len()]);
    }
    for (x, y) in marks {
        let style = Symbol::white(INK).class("mark");
        panel.symbol(Symbol::CIRCLE, at(x, y), RADIUS, style);
    }
    panel
}
