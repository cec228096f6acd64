//! Figures like 6-5 to 6-9 of the thesis.

use cvtcycle_model::bench::variator::{RigFlags, VariatorRow};
use cvtcycle_output::variator::{Curve, VariatorCurves};

use super::{CurveFigure, CurvePanel, CurveSeries, curve_figure};

const X: &str = "Torque at the secondary pulley [Nm]";
/// Largest number of tests that are drawn.
const MAX_TESTS: usize = 6;
/// Largest slip that is drawn.
const MAX_SLIP: f64 = 0.05;

/// A value of a row.
type Get = fn(&VariatorRow) -> f64;

/// File name, title, vertical axis and value of the figures with a line for each pressure.
const KINDS: [(&str, &str, &str, Get); 4] = [
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

/// Figures of the curves of the variator rig with their file names.
#[must_use]
pub fn variator_figures(plan: &VariatorCurves) -> Vec<(&'static str, String)> {
    let tests = plan.curves.chunk_by(Curve::is_same_test);
    let tests: Vec<&[Curve]> = tests.take(MAX_TESTS).collect();
    let lines = KINDS.map(|(file, title, y, get)| {
        let panels = tests.iter().map(|test| by_pressure(test, y, get));
        let figure = CurveFigure {
            title,
            subject: &subject(plan),
            x: X,
            panels: panels.collect(),
        };
        (file, curve_figure(&figure))
    });
    let radii = ("radii.svg", radii(plan, &tests));
    [radii].into_iter().chain(lines).collect()
}

/// Rows up to the slip that is drawn: the figures of the thesis end at 3 %, and at gross slip the value is only a bound.
fn carried(curve: &Curve) -> impl Iterator<Item = &VariatorRow> {
    curve.rows.iter().filter(|row| {
        row.belt.losses.slip_total.abs() <= MAX_SLIP && !row.flags.contains(RigFlags::GROSS_SLIP)
    })
}

fn ascending(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points
}

fn points(curve: &Curve, get: Get) -> Vec<(f64, f64)> {
    ascending(
        carried(curve)
            .map(|row| (row.output_nm, get(row)))
            .collect(),
    )
}

fn subject(plan: &VariatorCurves) -> String {
    format!(
        "{}, {}; drawn up to {} % slip",
        plan.vehicle,
        plan.formulation,
        100.0 * MAX_SLIP
    )
}

/// One panel with a line for each pressure and its breakpoint marked where it lies on the line.
fn by_pressure(test: &[Curve], y: &str, get: Get) -> CurvePanel {
    let series: Vec<CurveSeries> = test
        .iter()
        .map(|curve| {
            let points = points(curve, get);
            let at = curve.summary.breakpoint_nm;
            let mark = points
                .windows(2)
                .find(|pair| pair[0].0 <= at && at <= pair[1].0)
                .map(|pair| {
                    let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
                    (at, y0 + (y1 - y0) * (at - x0) / (x1 - x0))
                });

            CurveSeries {
                name: format!("{} bar", curve.bar()),
                points,
                marked: mark.into_iter().collect(),
                style: None,
            }
        })
        .collect();
    let marks = if series.iter().any(|s| !s.marked.is_empty()) {
        "Breakpoint".to_owned()
    } else {
        String::new()
    };
    CurvePanel {
        title: test.first().map_or_else(String::new, Curve::test_name),
        y: y.to_owned(),
        with_zero: true,
        series,
        marks,
    }
}

/// Radii of both pulleys at the middle pressure of each test, from the geometry and from the speeds.
fn radii(plan: &VariatorCurves, tests: &[&[Curve]]) -> String {
    let pulleys: [(&str, [Get; 3]); 2] = [
        (
            "Primary",
            [
                |r| 1e3 * r.pulse_radius_m()[0],
                |r| 1e3 * r.geometry.primary_radius_m,
                |r| 1e3 * r.zero.radius_m[0],
            ],
        ),
        (
            "Secondary",
            [
                |r| 1e3 * r.pulse_radius_m()[1],
                |r| 1e3 * r.geometry.secondary_radius_m,
                |r| 1e3 * r.zero.radius_m[1],
            ],
        ),
    ];
    let names = [
        ("From belt and shaft speed", 1),
        ("Geometric", 0),
        ("Geometric, zeroed at no torque", 2),
    ];
    let middle = tests.iter().filter_map(|test| test.get(test.len() / 2));
    let panels = middle.flat_map(|curve| {
        pulleys.map(|(pulley, radii)| {
            let series = names
                .iter()
                .zip(radii)
                .map(|((name, style), get)| CurveSeries {
                    name: (*name).to_owned(),
                    points: points(curve, get),
                    marked: Vec::new(),
                    style: Some(*style),
                });
            CurvePanel {
                title: format!("{pulley}, {}, {} bar", curve.test_name(), curve.bar()),
                y: "Radius [mm]".to_owned(),
                with_zero: false,
                series: series.collect(),
                marks: String::new(),
            }
        })
    });
    curve_figure(&CurveFigure {
        title: "Running radii, geometric and from speeds",
        subject: &subject(plan),
        x: X,
        panels: panels.collect(),
    })
}
