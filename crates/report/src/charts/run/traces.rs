//! The quantities of a run over time.

use super::PlotRun;
use super::timeline::{Series, Strip, timeline};
use crate::charts::engine::{CONTEXT, INK, PLAIN, STROKES, Stroke, range, stroke};
use crate::charts::picture::Picture;

/// Secondary and primary pressure.
const PRESSURES: [Stroke; 2] = [stroke(INK, 1.6, &[]), stroke("#d55e00", 1.3, &[4.0, 2.0])];

/// Clamp safety beyond which the line leaves its panel, as a multiple of the smallest one and within limits: at low torque it has no
/// bound, and what matters is how near it comes to 1.
const MAX_SAFETY: (f64, f64, f64) = (4.0, 4.0, 30.0);

/// Vehicle speed, ratio or gear, engine speed and throttle over time.
pub fn driveline(run: &PlotRun) -> Picture {
    let ratio = if run.history.is_cvt() {
        ("belt_ratio", "Belt ratio")
    } else {
        ("gear", "Gear")
    };
    let strips = [
        ("speed_kmh", "Vehicle speed"),
        ratio,
        ("engine_speed_rpm", "Engine speed"),
        ("throttle", "Throttle"),
    ]
    .map(|(column, title)| Strip::of(column, title, 140.0, PLAIN));
    timeline(
        run,
        "Vehicle speed, ratio, engine speed and throttle",
        &strips,
    )
}

/// Pulley pressures, belt slip and clamp safety over time, with the vehicle speed for context.
pub fn pressure(run: &PlotRun) -> Picture {
    let pressures = [
        ("secondary_pressure_bar", "Secondary pressure"),
        ("primary_pressure_bar", "Primary pressure"),
    ];
    let lines = pressures.into_iter().zip(PRESSURES);
    let lines = lines.map(|((column, title), stroke)| Series::new(column, title, stroke));
    let (times, low, high) = MAX_SAFETY;
    let safety = run.history.column("clamp_safety").iter().copied();
    let least = range(safety).map_or(f64::INFINITY, |(least, _)| least);
    let max = (times * least).clamp(low, high).round();
    let strips = [
        Strip {
            lines: lines.collect(),
            legend: true,
            ..Strip::of("", "Pressure", 220.0, PLAIN)
        },
        Strip::of("slip_percent", "Belt slip", 130.0, PLAIN),
        Strip {
            max,
            mark: Some((1.0, "Clamp safety 1: belt at its limit")),
            ..Strip::of("clamp_safety", "Clamp safety", 130.0, PLAIN)
        },
        Strip {
            title: "Speed",
            ..Strip::of("speed_kmh", "Vehicle speed", 100.0, CONTEXT)
        },
    ];
    timeline(run, "Pulley pressures, slip and clamp safety", &strips)
}

/// Temperatures over time.
pub fn temperatures(run: &PlotRun) -> Picture {
    let names = [
        ("coolant_degc", "Coolant"),
        ("engine_oil_degc", "Engine oil"),
        ("transmission_sump_degc", "Transmission sump"),
        ("transmission_metal_degc", "Transmission metal"),
        ("belt_spray_degc", "Belt spray"),
        ("cooler_out_degc", "Cooler outlet"),
    ];
    let there = |column: &str| run.history.column(column).iter().any(|y| y.is_finite());
    let lines = names.into_iter().zip(STROKES);
    let lines = lines.filter(|((column, _), _)| there(column));
    let lines = lines.map(|((column, title), stroke)| Series::new(column, title, stroke));
    let strip = Strip {
        lines: lines.collect(),
        with: &[],
        legend: true,
        ..Strip::of("coolant_degc", "Temperature", 400.0, PLAIN)
    };
    timeline(run, "Temperatures", &[strip])
}
