//! Traces of two runs over one time axis: A solid, B dashed.

use super::TOP;
use crate::charts::engine::{
    Axis, Block, Chart, Entry, INK, PLOT_LEFT, Panel, Rect, Stroke, WIDTH, cell, number, range,
    stroke,
};
use crate::charts::picture::{Picture, PictureTable};

/// Traces of two runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// What it shows.
    pub title: String,
    /// Cycle and conditions.
    pub subject: String,
    /// Name of run A.
    pub a: String,
    /// Name of run B.
    pub b: String,
    /// Panels from the top; two to four read well.
    pub panels: Vec<OverlayPanel>,
}

/// One quantity of both runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OverlayPanel {
    /// Name of the quantity.
    pub title: String,
    /// Its unit; empty or `-` for a plain number.
    pub unit: &'static str,
    /// Time, s, and value of run A; a gap where a value is not finite.
    pub a: Vec<(f64, f64)>,
    /// The same of run B.
    pub b: Vec<(f64, f64)>,
}

const RUNS: [Stroke; 2] = [stroke(INK, 1.3, &[]), stroke("#d55e00", 1.6, &[6.0, 3.0])];
const WIDE: f64 = WIDTH - 20.0 - PLOT_LEFT;
const TALL: f64 = 150.0;
const GAP: f64 = 16.0;
/// Most rows of the table.
const ROWS: usize = 600;

impl Overlay {
    /// All points of both runs.
    fn points(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.panels.iter().flat_map(OverlayPanel::points)
    }
}

impl OverlayPanel {
    fn points(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.a.iter().chain(&self.b)
    }
}

/// Panels over time, A solid and B dashed.
#[must_use]
pub fn overlay(of: &Overlay) -> Picture {
    let (start, end) = range(of.points().map(|point| point.0)).unwrap_or((0.0, 1.0));
    // A first step of a second ends at one: the axis begins where the run did.
    let start = if start > 0.0 && start < 0.02 * end {
        0.0
    } else {
        start
    };
    let time = Axis::exact("Time [s]", start, end, 10);
    let nothing = [OverlayPanel::default()];
    let quantities = if of.panels.is_empty() {
        &nothing[..]
    } else {
        &of.panels
    };
    let panel = |(k, quantity): (usize, &OverlayPanel)| {
        let y = Axis::round(&titled(quantity), quantity.points().map(|point| point.1), 5);
        let rect = Rect::new(PLOT_LEFT, TOP + k as f64 * (TALL + GAP), WIDE, TALL);
        let mut panel = Panel {
            over_table: true,
            x_labels: k + 1 == quantities.len(),
            no_data: !quantity.points().any(|point| point.1.is_finite()),
            ..Panel::new(rect, time.clone(), y)
        };
        for (points, stroke) in [&quantity.a, &quantity.b].into_iter().zip(RUNS) {
            panel.series(points.clone(), stroke);
        }
        panel
    };
    let names = [format!("A: {}", of.a), format!("B: {}", of.b)];
    let entries = RUNS
        .into_iter()
        .zip(names)
        .map(|(stroke, name)| Entry::line(stroke, name));
    let chart = Chart {
        title: of.title.clone(),
        subject: of.subject.clone(),
        description: describe(of),
        left: PLOT_LEFT,
        panels: quantities.iter().enumerate().map(panel).collect(),
        foot: vec![Block::legend((PLOT_LEFT, WIDE), "", entries.collect())],
        table: table(of),
        ..Chart::default()
    };
    chart.picture()
}

/// The unit as it is written; none for a plain number.
fn sign(panel: &OverlayPanel) -> &'static str {
    match panel.unit {
        "-" => "",
        "degC" => "\u{b0}C",
        unit => unit,
    }
}

fn titled(panel: &OverlayPanel) -> String {
    match sign(panel) {
        "" => panel.title.clone(),
        unit => format!("{} [{unit}]", panel.title),
    }
}

fn table(of: &Overlay) -> PictureTable {
    let mut table = PictureTable::new(&[("time", "s")]);
    for panel in &of.panels {
        let column = |run: &str| (format!("{}, {run}", panel.title), sign(panel));
        table.columns.extend(["A", "B"].map(column));
    }
    let mut times: Vec<f64> = of.points().map(|p| p.0).filter(|t| t.is_finite()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let every = times.len().div_ceil(ROWS).max(1);
    let steps: Vec<f64> = of.panels.iter().map(digits).collect();
    for time in times.iter().step_by(every) {
        let mut cells = vec![cell(*time, 0.1)];
        for (panel, step) in of.panels.iter().zip(&steps) {
            cells.extend([&panel.a, &panel.b].map(|points| cell(at(points, *time), *step)));
        }
        table.push(cells);
    }
    let interpolated = "Between two steps of a run its value is interpolated.";
    table.note = if every > 1 {
        format!("One of {every} times is listed; the lines are drawn from all. {interpolated}")
    } else {
        interpolated.to_owned()
    };
    table
}

/// A step with about four digits over the range of a panel.
fn digits(panel: &OverlayPanel) -> f64 {
    let (low, high) = range(panel.points().map(|p| p.1)).unwrap_or((0.0, 1.0));
    let size = high.abs().max(low.abs()).clamp(1e-6, 1e9);
    10f64.powf((size / 2000.0).log10().ceil()).min(1.0)
}

/// Value of a trace at a time; none outside it or in a gap.
fn at(points: &[(f64, f64)], time: f64) -> f64 {
    let next = points.partition_point(|point| point.0 < time);
    let Some(after) = points.get(next) else {
        return f64::NAN;
    };
    if after.0 <= time {
        return after.1;
    }
    let Some(before) = next.checked_sub(1).and_then(|i| points.get(i)) else {
        return f64::NAN;
    };
    before.1 + (after.1 - before.1) * (time - before.0) / (after.0 - before.0)
}

fn describe(of: &Overlay) -> String {
    let span = |points: &[(f64, f64)]| {
        let Some((low, high)) = range(points.iter().map(|p| p.1)) else {
            return "without data".to_owned();
        };
        let step = if high - low < 20.0 { 0.01 } else { 1.0 };
        format!("from {} to {}", number(low, step), number(high, step))
    };
    let panel = |of: &OverlayPanel| format!("{}: A {}, B {}", titled(of), span(&of.a), span(&of.b));
    let panels: Vec<String> = of.panels.iter().map(panel).collect();
    format!(
        "Traces over time of run A, {}, and run B, {}. {}.",
        of.a,
        of.b,
        panels.join("; ")
    )
}
