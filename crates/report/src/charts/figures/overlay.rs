//! Traces of two runs over one time axis: A solid, B dashed.

use super::TOP;
use crate::charts::engine::{
    Axis, Chart, Entry, INK, PLOT_LEFT, Panel, Rect, Stroke, WIDTH, cell, range, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{sign, with_unit};

/// Traces of two runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Title.
    pub title: String,
    /// Cycle and conditions.
    pub subject: String,
    /// Names of runs A and B.
    pub names: [String; 2],
    /// Panels from the top; two to four read well.
    pub panels: Vec<OverlayPanel>,
}

/// One quantity of both runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OverlayPanel {
    /// Name of the quantity.
    pub title: String,
    /// Unit; empty or `-` for a plain number.
    pub unit: &'static str,
    /// Time, s, and value in runs A and B; a gap where a value is not finite.
    pub runs: [Vec<(f64, f64)>; 2],
}

const RUNS: [Stroke; 2] = [stroke(INK, 1.3, &[]), stroke("#d55e00", 1.6, &[6.0, 3.0])];
const WIDE: f64 = WIDTH - 20.0 - PLOT_LEFT;
const TALL: f64 = 150.0;
const GAP: f64 = 16.0;
/// Maximum number of rows of the table.
const ROWS: usize = 600;

impl OverlayPanel {
    fn points(&self) -> impl Iterator<Item = &(f64, f64)> {
        self.runs.iter().flatten()
    }

    /// Unit as written; empty for a plain number.
    pub(super) fn sign(&self) -> &'static str {
        sign(if self.unit == "-" { "" } else { self.unit })
    }

    /// Step that gives about four digits over the range of the panel.
    pub(super) fn digits(&self) -> f64 {
        let (low, high) = range(self.points().map(|p| p.1)).unwrap_or((0.0, 1.0));
        let size = high.abs().max(low.abs()).clamp(1e-6, 1e9);
        10f64.powf((size / 2000.0).log10().ceil()).min(1.0)
    }
}

/// Panels over time, A solid and B dashed.
pub fn overlay(data: &Overlay) -> Picture {
    let times = data.panels.iter().flat_map(OverlayPanel::points);
    let (start, end) = range(times.map(|point| point.0)).unwrap_or((0.0, 1.0));
    // A step of a second ends at one: the axis begins at the start of the run.
    let from_zero = start > 0.0 && start < 0.02 * end;
    let time = Axis::exact("Time [s]", if from_zero { 0.0 } else { start }, end, 10);
    let nothing = [OverlayPanel::default()];
    let quantities = if data.panels.is_empty() {
        &nothing[..]
    } else {
        &data.panels
    };
    let panel = |(k, data): (usize, &OverlayPanel)| {
        let y = Axis::round(
            &with_unit(&data.title, data.sign()),
            data.points().map(|point| point.1),
            5,
        );
        let rect = Rect::new(PLOT_LEFT, TOP + k as f64 * (TALL + GAP), WIDE, TALL);
        let mut panel = Panel::new(rect, time.clone(), y)
            .over_table()
            .x_labels(k + 1 == quantities.len())
            .no_data(!data.points().any(|point| point.1.is_finite()));
        for (points, stroke) in data.runs.iter().zip(RUNS) {
            panel.series(points.clone(), stroke);
        }
        panel
    };
    let entries = RUNS.into_iter().zip(["A", "B"]).zip(&data.names);
    let entries = entries.filter(|(_, name)| !name.is_empty());
    let entries =
        entries.map(|((stroke, run), name)| Entry::line(stroke, format!("{run}: {name}")));
    Chart::new(&data.title, &data.subject, PLOT_LEFT)
        .lead(format!(
            "Run A, {}, and run B, {}",
            data.names[0], data.names[1]
        ))
        .panels(quantities.iter().enumerate().map(panel))
        .legend((PLOT_LEFT, WIDE), entries)
        .picture(table(data))
}

fn table(data: &Overlay) -> PictureTable {
    let mut table = PictureTable::new(&[("time", "s")]);
    for panel in &data.panels {
        let column = |run: &str| (format!("{}, {run}", panel.title), panel.sign());
        table.columns.extend(["A", "B"].map(column));
    }
    let times = data.panels.iter().flat_map(OverlayPanel::points);
    let mut times: Vec<f64> = times.map(|p| p.0).filter(|t| t.is_finite()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let every = times.len().div_ceil(ROWS).max(1);
    let steps: Vec<f64> = data.panels.iter().map(OverlayPanel::digits).collect();
    for time in times.iter().step_by(every) {
        let mut cells = vec![cell(*time, 0.1)];
        for (panel, step) in data.panels.iter().zip(&steps) {
            cells.extend(panel.runs.each_ref().map(|run| cell(at(run, *time), *step)));
        }
        table.push(cells);
    }
    if every > 1 {
        table.note = format!("One of {every} times is listed; the lines are drawn from all. ");
    }
    table.note += "Between two steps of a run its value is interpolated.";
    table
}

/// Value of a trace at a time; NaN outside it or in a gap.
pub(super) fn at(points: &[(f64, f64)], time: f64) -> f64 {
    let next = points.partition_point(|point| point.0 < time);
    let before = next.checked_sub(1).and_then(|i| points.get(i));
    match (before, points.get(next)) {
        (_, Some(after)) if after.0 <= time => after.1,
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (time - a.0) / (b.0 - a.0),
        _ => f64::NAN,
    }
}
