//! Figures like 6-5 to 6-9 of the thesis.

use cvtcycle::model::bench::variator::{RigFlags, VariatorRow};
use cvtcycle::output::variator::{Curve, VariatorCurves};
use cvtcycle::report::charts::{CurveFigure, CurvePanel, CurveSeries, curve_figure};

const X: &str = "Torque at the secondary pulley [Nm]";
/// Largest number of tests that are drawn.
const MAX_TESTS: usize = 6;
/// Largest slip that is drawn.
const MAX_SLIP: f64 = 0.05;

/// A value of a row.
type Get = fn(&VariatorRow) -> f64;

/// Figures with their file names.
pub fn plots(plan: &VariatorCurves) -> Vec<(&'static str, String)> {
    let tests: Vec<&[Curve]> = plan
        .curves
        .chunk_by(Curve::is_same_test)
        .take(MAX_TESTS)
        .collect();
    let lines = |title: &str, y: &str, get: Get, marked: bool| {
        let panels = tests
            .iter()
            .map(|test| by_pressure(test, y, get, marked))
            .collect();
        curve_figure(&CurveFigure {
            title,
            subject: &subject(plan),
            x: X,
            panels,
        })
    };
    vec![
        ("radii.svg", radii(plan, &tests)),
        (
            "slip.svg",
            lines(
                "Belt slip",
                "Slip [%]",
                |r| 100.0 * r.belt.losses.slip_total,
                true,
            ),
        ),
        (
            "slip_zeroed.svg",
            lines(
                "Belt slip, zero at zero torque",
                "Slip reading [%]",
                |r| 100.0 * r.slip_zeroed(),
                true,
            ),
        ),
        (
            "primary_slip.svg",
            lines(
                "Slip speed at the primary pulley",
                "Slip speed [m/s]",
                |r| r.slip_m_s()[0],
                true,
            ),
        ),
        (
            "secondary_slip.svg",
            lines(
                "Slip speed at the secondary pulley",
                "Slip speed [m/s]",
                |r| r.slip_m_s()[1],
                true,
            ),
        ),
    ]
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
fn by_pressure(test: &[Curve], y: &str, get: Get, marked: bool) -> CurvePanel {
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
                marked: mark.into_iter().filter(|_| marked).collect(),
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
    let mut panels = Vec::new();
    for curve in tests.iter().filter_map(|test| test.get(test.len() / 2)) {
        let bar = curve.bar();
        let one = |name: &str, style: usize, get: Get| CurveSeries {
            name: name.to_owned(),
            points: points(curve, get),
            marked: Vec::new(),
            style: Some(style),
        };
        let panel = |pulley: &str, series: Vec<CurveSeries>| CurvePanel {
            title: format!("{pulley}, {}, {bar} bar", curve.test_name()),
            y: "Radius [mm]".to_owned(),
            with_zero: false,
            series,
            marks: String::new(),
        };
        let primary = vec![
            one("From belt and shaft speed", 1, |r| {
                1e3 * r.pulse_radius_m()[0]
            }),
            one("Geometric", 0, |r| 1e3 * r.geometry.primary_radius_m),
            one("Geometric, zeroed at no torque", 2, |r| {
                1e3 * r.zero.radius_m[0]
            }),
        ];
        let secondary = vec![
            one("From belt and shaft speed", 1, |r| {
                1e3 * r.pulse_radius_m()[1]
            }),
            one("Geometric", 0, |r| 1e3 * r.geometry.secondary_radius_m),
            one("Geometric, zeroed at no torque", 2, |r| {
                1e3 * r.zero.radius_m[1]
            }),
        ];
        panels.push(panel("Primary", primary));
        panels.push(panel("Secondary", secondary));
    }
    curve_figure(&CurveFigure {
        title: "Running radii, geometric and from speeds",
        subject: &subject(plan),
        x: X,
        panels,
    })
}
