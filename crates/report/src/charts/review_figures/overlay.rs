//! Traces of two runs over one time axis: A solid, B dashed.
use super::{TOP, WIDTH};
use crate::charts::axis::{Axis, number, range};
use crate::charts::figure::{Figure, Rect};
use crate::charts::legend::{Mark, below_height, legend_below};
use crate::charts::panel::{BELOW, LEFT, Panel};
use crate::charts::style::Stroke;
use crate::charts::{Picture, PictureTable, cell};

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

const A: Stroke = Stroke {
    colour: "#000000",
    width: 1.3,
    dash: &[],
};
const B: Stroke = Stroke {
    colour: "#d55e00",
    width: 1.6,
    dash: &[6.0, 3.0],
};
const PLOT_LEFT: f64 = LEFT + 8.0;
const PLOT_RIGHT: f64 = WIDTH - 20.0;
const TALL: f64 = 150.0;
const GAP: f64 = 16.0;
/// Most rows of the table.
const ROWS: usize = 600;

/// Panels over time, A solid and B dashed.
#[must_use]
pub fn overlay(of: &Overlay) -> Picture {
    let count = of.panels.len().max(1);
    let foot = TOP + count as f64 * (TALL + GAP) - GAP + BELOW + 8.0;
    let names = vec![format!("A: {}", of.a), format!("B: {}", of.b)];
    let size = (
        WIDTH,
        foot + below_height(
            names.iter().map(String::as_str),
            WIDTH - PLOT_LEFT - 20.0,
            "",
        ) + 8.0,
    );
    let mut figure = Figure::new(size, PLOT_LEFT, &of.title, &of.subject, &describe(of));
    let times = || {
        of.panels
            .iter()
            .flat_map(|panel| panel.a.iter().chain(&panel.b))
            .map(|point| point.0)
    };
    let (start, end) = range(times()).unwrap_or((0.0, 1.0));
    // A first step of a second ends at one: the axis begins where the run did.
    let start = if start > 0.0 && start < 0.02 * end {
        0.0
    } else {
        start
    };
    let time = Axis::exact("Time [s]", start, end, 10);
    let nothing = OverlayPanel::default();
    let panels: Vec<&OverlayPanel> = if of.panels.is_empty() {
        vec![&nothing]
    } else {
        of.panels.iter().collect()
    };
    for (k, quantity) in panels.into_iter().enumerate() {
        let top = TOP + k as f64 * (TALL + GAP);
        let rect = Rect {
            left: PLOT_LEFT,
            right: PLOT_RIGHT,
            top,
            bottom: top + TALL,
        };
        let y = Axis::round(
            &titled(quantity),
            quantity.a.iter().chain(&quantity.b).map(|point| point.1),
            5,
        );
        let panel = Panel::over_table(&mut figure, rect, time.clone(), y, k + 1 == count);
        panel.line(&mut figure, &quantity.a, A);
        panel.line(&mut figure, &quantity.b, B);
        if !quantity
            .a
            .iter()
            .chain(&quantity.b)
            .any(|point| point.1.is_finite())
        {
            panel.empty(&mut figure);
        }
    }
    let marks = [Mark::Line(A), Mark::Line(B)];
    let entries: Vec<_> = marks.into_iter().zip(names).collect();
    legend_below(
        &mut figure,
        (PLOT_LEFT, foot),
        WIDTH - PLOT_LEFT - 20.0,
        "",
        &entries,
    );
    Picture {
        svg: figure.finish(),
        table: table(of),
    }
}

fn titled(panel: &OverlayPanel) -> String {
    match panel.unit {
        "" | "-" => panel.title.clone(),
        "degC" => format!("{} [\u{b0}C]", panel.title),
        unit => format!("{} [{unit}]", panel.title),
    }
}

fn table(of: &Overlay) -> PictureTable {
    let mut table = PictureTable::new(&[("time", "s")]);
    for panel in &of.panels {
        let unit = match panel.unit {
            "-" => "",
            "degC" => "\u{b0}C",
            unit => unit,
        };
        table
            .columns
            .extend(["A", "B"].map(|run| (format!("{}, {run}", panel.title), unit)));
    }
    let mut times: Vec<f64> = of
        .panels
        .iter()
        .flat_map(|panel| panel.a.iter().chain(&panel.b))
        .map(|p| p.0)
        .filter(|t| t.is_finite())
        .collect();
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
    table.note = if every > 1 {
        format!(
            "One of {every} times is listed; the lines are drawn from all. Between two steps of a run its value is interpolated."
        )
    } else {
        "Between two steps of a run its value is interpolated.".to_owned()
    };
    table
}

/// A step with about four digits over the range of a panel.
fn digits(panel: &OverlayPanel) -> f64 {
    let (low, high) = range(panel.a.iter().chain(&panel.b).map(|p| p.1)).unwrap_or((0.0, 1.0));
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
        let step = |low: f64, high: f64| if high - low < 20.0 { 0.01 } else { 1.0 };
        range(points.iter().map(|p| p.1)).map_or_else(
            || "without data".to_owned(),
            |(low, high)| {
                format!(
                    "from {} to {}",
                    number(low, step(low, high)),
                    number(high, step(low, high))
                )
            },
        )
    };
    let told: Vec<String> = of
        .panels
        .iter()
        .map(|panel| {
            format!(
                "{}: A {}, B {}",
                titled(panel),
                span(&panel.a),
                span(&panel.b)
            )
        })
        .collect();
    format!(
        "Traces over time of run A, {}, and run B, {}. {}.",
        of.a,
        of.b,
        told.join("; ")
    )
}

#[cfg(test)]
mod tests {
    use super::super::tidy::{check, numbers};
    use super::*;

    fn two() -> Overlay {
        let wave = |k: f64, n: u32| (1..=n).map(|i| (f64::from(i), k * f64::from(i))).collect();
        let mut gap: Vec<(f64, f64)> = wave(0.001, 1180);
        gap[4].1 = f64::NAN;
        let panel = |title: &str, unit, a, b| OverlayPanel {
            title: title.to_owned(),
            unit,
            a,
            b,
        };
        Overlay {
            title: "Two runs".to_owned(),
            subject: "ece15_eudc".to_owned(),
            a: "one & <other>".to_owned(),
            b: "name ".repeat(80),
            panels: vec![
                panel("Sump", "degC", wave(0.05, 1180), wave(0.04, 1000)),
                panel("Belt ratio", "-", gap, Vec::new()),
            ],
        }
    }

    #[test]
    fn lines_and_table_are_the_traces() {
        let picture = overlay(&two());
        check(&picture);
        assert_eq!(picture.svg.matches("class=\"series\"").count(), 3);
        assert!(picture.table.rows.len() <= ROWS && picture.table.note.starts_with("One of 2"));
        let third = &picture.table.rows[2];
        assert!(
            (numbers(&third[0]) - 5.0).abs() < 1e-9
                && (numbers(&third[1]) - 0.25).abs() < 0.06
                && third[3].is_empty()
                && third[4].is_empty()
        );
        assert_eq!(
            picture.table.rows.last().map(|row| row[2].clone()),
            Some(String::new()),
            "B has ended"
        );
        let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
        let frames: Vec<_> = doc
            .descendants()
            .filter(|n| n.has_attribute("data-x0"))
            .collect();
        assert_eq!(frames.len(), 2);
        assert!(
            frames.iter().all(|n| n.attribute("data-x0") == Some("0.0")
                && n.attribute("data-x1") == Some("1180.0"))
        );
    }

    #[test]
    fn a_value_between_two_steps_is_interpolated() {
        let points = [(1.0, 10.0), (3.0, 30.0), (4.0, f64::NAN)];
        assert!(
            (at(&points, 1.0) - 10.0).abs() < 1e-12
                && (at(&points, 2.0) - 20.0).abs() < 1e-12
                && (at(&points, 3.0) - 30.0).abs() < 1e-12
        );
        assert!(
            at(&points, 0.5).is_nan()
                && at(&points, 3.5).is_nan()
                && at(&points, 9.0).is_nan()
                && at(&[], 1.0).is_nan()
        );
    }

    #[test]
    fn nothing_is_still_a_picture() {
        check(&overlay(&Overlay::default()));
        check(&overlay(&Overlay {
            panels: vec![OverlayPanel::default(); 4],
            ..Overlay::default()
        }));
        let broken = OverlayPanel {
            a: vec![(f64::NAN, 1.0), (2.0, f64::INFINITY)],
            ..OverlayPanel::default()
        };
        check(&overlay(&Overlay {
            panels: vec![broken],
            ..Overlay::default()
        }));
    }
}
