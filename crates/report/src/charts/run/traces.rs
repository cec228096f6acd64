//! Quantities of a run over time.

use super::PlotRun;
use super::timeline::{Series, Strip, side_by_side, timeline};
use crate::charts::engine::{CONTEXT, INK, PLAIN, STROKES, Stroke, range, stroke};
use crate::charts::picture::Picture;
use crate::number::grouped;
use cvtcycle_output::History;

/// Secondary and primary pressure.
const PRESSURES: [Stroke; 2] = [stroke(INK, 1.6, &[]), stroke("#d55e00", 1.3, &[4.0, 2.0])];
/// Height of the temperature panel of a lone car, and of one of several, pixels.
const TALL: [f64; 2] = [400.0, 190.0];

/// Maximum finite value of a column.
fn column_max(history: &History, column: &str) -> Option<f64> {
    Some(range(history.column(column).iter().copied())?.1)
}

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
    .map(|(column, title)| Strip::single(column, title, 140.0, PLAIN));
    let title = match column_max(run.history, "engine_speed_rpm") {
        Some(rpm) => format!("{} needs up to {} rpm", run.name, grouped(rpm, 0)),
        None => "Vehicle speed, ratio, engine speed and throttle".to_owned(),
    };
    timeline(run, title, &strips)
}

/// Pulley pressures, belt slip and clamp safety over time, with the vehicle speed for context.
pub fn pressure(run: &PlotRun) -> Picture {
    let pressures = [
        ("secondary_pressure_bar", "Secondary pressure"),
        ("primary_pressure_bar", "Primary pressure"),
    ];
    let lines = pressures.into_iter().zip(PRESSURES);
    let lines = lines.map(|((column, title), stroke)| Series::new(column, title, stroke));
    let safety = range(run.history.column("clamp_safety").iter().copied());
    let title = match (safety, column_max(run.history, "secondary_pressure_bar")) {
        (Some((least, _)), Some(bar)) if least > 0.0 => format!(
            "The belt of {} carries {} % of what its clamping holds at most; up to {} bar clamp it",
            run.name,
            grouped(100.0 / least, 0),
            grouped(bar, 1)
        ),
        _ => "Pulley pressures, slip and clamp safety".to_owned(),
    };
    // The safety of a belt without torque is unbounded; its inverse is the used share of the clamping.
    let used = Series {
        shown: Some(("%", |safety| 100.0 / safety)),
        ..Series::new("clamp_safety", "Clamping used", PLAIN)
    };
    let strips = [
        Strip {
            lines: lines.collect(),
            named: true,
            printed: run.published.pressure_bar.clone(),
            ..Strip::single("", "Pressure", 220.0, PLAIN)
        },
        Strip::single("slip_percent", "Belt slip", 130.0, PLAIN),
        Strip {
            lines: vec![used],
            with: &[0.0, 100.0],
            mark: Some((100.0, "All of the clamping used: the belt is at its limit")),
            ..Strip::single("clamp_safety", "Clamping used", 130.0, PLAIN)
        },
        Strip {
            title: "Speed",
            ..Strip::single("speed_kmh", "Vehicle speed", 100.0, CONTEXT)
        },
    ];
    timeline(run, title, &strips)
}

/// Temperatures over time: a panel for each car, all on one scale.
pub fn temperatures(runs: &[PlotRun]) -> Picture {
    let tall = TALL[usize::from(runs.len() > 1)];
    let cars: Vec<(&PlotRun, Strip)> = runs.iter().map(|run| (run, nodes(run, tall))).collect();
    let last = |history: &History, column: &str| {
        history
            .column(column)
            .iter()
            .copied()
            .rfind(|x| x.is_finite())
    };
    let ends = runs.first().and_then(|run| {
        let [oil, engine] =
            ["transmission_sump_degc", "engine_oil_degc"].map(|column| last(run.history, column));
        Some((run.name, oil?, engine?))
    });
    let title = ends.map_or_else(|| "Temperatures".to_owned(), |(name, oil, engine)| {
        format!(
            "{name} ends with {} degC in the sump of its transmission and {} degC in the engine oil",
            grouped(oil, 0),
            grouped(engine, 0)
        )
    });
    let names: Vec<&str> = runs.iter().map(|run| run.name).collect();
    let subject = match names.as_slice() {
        [name] => (*name).to_owned(),
        _ => "Temperatures over the cycle, one scale".to_owned(),
    };
    side_by_side(&cars, title, &subject)
}

/// The panel of a car.
fn nodes(run: &PlotRun, tall: f64) -> Strip {
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
    Strip {
        lines: lines.collect(),
        with: &[],
        named: true,
        printed: run.published.end_degc.clone(),
        ..Strip::single("coolant_degc", "Temperature", tall, PLAIN)
    }
}
