//! A car through a cycle as a table: its trace, or its totals.

use super::{Marks, Table, from_rows, truth};
use crate::check::source::{Source, cycle};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{Conditions, Outcome, Start, litres_per_100km};
use cvtcycle_model::fluid::ZERO_DEGC_K;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, METAL, SUMP};
use cvtcycle_output::trace::COLUMNS;
use cvtcycle_output::{Component, Flags, Row};

/// A finished run.
#[derive(Clone, Debug)]
pub struct Driven {
    cycle: Cycle,
    outcome: Outcome,
    rated_w: f64,
    fuel_density_kg_m3: f64,
    co2_per_fuel: f64,
}

/// Columns beside those of the trace.
const MORE: [&str; 6] = [
    "moving",
    "coupled",
    "launch",
    "since_launch_s",
    "power_share",
    "transmission_loss_w",
];

const TOTALS: [&str; 17] = [
    "fuel_l_per_100km",
    "fuel_kg",
    "fuel_energy_kj",
    "co2_g_per_km",
    "distance_km",
    "duration_s",
    "standstill_fuel_kg",
    "wheel_work_positive_kj",
    "wheel_work_negative_kj",
    "transmission_kj",
    "belt_kj",
    "end_sump_degc",
    "end_engine_oil_degc",
    "end_coolant_degc",
    "end_metal_degc",
    "end_belt_degc",
    "missed_trace_s",
];

const LOSSES: [&str; Component::COUNT] = [
    "launch_clutch_kj",
    "pump_kj",
    "input_shaft_kj",
    "clutch_drag_kj",
    "belt_band_kj",
    "belt_film_kj",
    "belt_slip_kj",
    "belt_wedge_kj",
    "belt_penetration_kj",
    "belt_map_kj",
    "final_drive_kj",
    "gear_mesh_kj",
    "bearing_kj",
    "churning_kj",
    "seal_kj",
    "box_map_kj",
];

/// Names of the columns of the trace.
pub fn columns() -> Vec<&'static str> {
    let trace = COLUMNS.iter().map(|column| &*column.name);
    trace
        .chain(Flags::NAMES.iter().map(|(_, name)| *name))
        .chain(MORE)
        .collect()
}

/// Names of the columns of the totals.
pub fn total_columns() -> Vec<&'static str> {
    TOTALS.into_iter().chain(LOSSES).collect()
}

/// Drives a source's cycle.
///
/// # Errors
/// There is no such cycle.
pub fn drive(source: &Source, setup: &Setup) -> Result<Driven, String> {
    let cycle = cycle(source)?;
    let start = match (source.start_k(), source.start.as_str()) {
        (Some(k), _) => Start::At(k),
        (None, "warm") => Start::Warm,
        _ => Start::Soak,
    };
    let max_dt_s = source.axis("dt_s", 1.0).first().copied().unwrap_or(1.0);
    let conditions = Conditions {
        ambient_k: source.ambient_k(),
        start,
        max_dt_s,
        keep_rows: true,
    };
    let outcome = cvtcycle_model::drive::drive(setup, &cycle, &conditions);
    let engine = setup.car(source.ambient_k()).engine;
    let number = |key: &str| {
        setup
            .keys
            .iter()
            .find(|info| info.key == key)
            .and_then(|info| info.si)
            .unwrap_or(f64::NAN)
    };
    Ok(Driven {
        cycle,
        outcome,
        rated_w: engine.rated_w,
        fuel_density_kg_m3: engine.fuel_density_kg_m3,
        co2_per_fuel: number("engine.fuel.co2_per_fuel"),
    })
}

/// Indices of the phases that count.
fn phases(source: &Source, cycle: &Cycle) -> Vec<u16> {
    let groups = cycle.phase_groups();
    groups
        .into_iter()
        .filter(|(name, _)| source.phase.is_empty() || *name == source.phase)
        .flat_map(|(_, list)| list)
        .collect()
}

/// The trace of a run, weighted with the length of the steps.
pub fn trace(source: &Source, driven: &Driven) -> Table {
    let wanted = phases(source, &driven.cycle);
    let mut launch = 0.0;
    let mut since = f64::NAN;
    let mut rows = Vec::new();
    let mut stood = true;
    for r in &driven.outcome.rows {
        let moving = r.speed_m_s > 0.0;
        if moving && stood {
            (launch, since) = (launch + 1.0, 0.0);
        }
        since += r.dt_s;
        stood = !moving;
        if wanted.contains(&r.phase) {
            rows.push((row(r, driven.rated_w, launch, since), r.dt_s));
        }
    }
    let place = |flag: Flags| {
        Flags::NAMES
            .iter()
            .position(|(name, _)| *name == flag)
            .map(|k| COLUMNS.len() + k)
    };
    let marks = Marks {
        gross: place(Flags::GROSS_SLIP),
        outside: place(Flags::OUTSIDE_VALIDITY),
    };
    from_rows(columns().len(), rows.into_iter(), marks)
}

fn row(r: &Row, rated_w: f64, launch: f64, since_s: f64) -> Vec<f64> {
    let coupled =
        !r.flags.contains(Flags::CLUTCH_SLIPPING) && !r.flags.contains(Flags::CLUTCH_OPEN);
    let more = [
        truth(r.speed_m_s > 0.0),
        truth(coupled),
        launch,
        since_s,
        r.wheel_power_w / rated_w,
        r.loss_w.iter().sum::<f64>(),
    ];
    let trace = COLUMNS.iter().map(|column| column.number_of(r));
    trace
        .chain(
            Flags::NAMES
                .iter()
                .map(|(flag, _)| truth(r.flags.contains(*flag))),
        )
        .chain(more)
        .collect()
}

/// The totals of a run as a table of one row. Temperatures and the missed trace are those of the whole run.
///
/// # Errors
/// Never for phases that the cycle has.
pub fn totals(source: &Source, driven: &Driven) -> Result<Table, String> {
    let outcome = &driven.outcome;
    let sum = outcome.totals.over(&phases(source, &driven.cycle));
    let degc = |node: usize| outcome.end.node_k[node] - ZERO_DEGC_K;
    let km = sum.distance_m / 1e3;
    let belt = cvtcycle_model::bench::BELT_PARTS
        .iter()
        .map(|c| sum.loss_j[*c as usize])
        .sum::<f64>();
    let head = [
        litres_per_100km(sum.fuel_kg, driven.fuel_density_kg_m3, sum.distance_m),
        sum.fuel_kg,
        sum.terms.fuel / 1e3,
        1e3 * sum.fuel_kg * driven.co2_per_fuel / km,
        km,
        sum.duration_s,
        sum.standstill_fuel_kg,
        sum.wheel_positive_j / 1e3,
        sum.wheel_negative_j / 1e3,
        sum.loss_j.iter().sum::<f64>() / 1e3,
        belt / 1e3,
        degc(SUMP),
        degc(ENGINE_OIL),
        degc(COOLANT),
        degc(METAL),
        degc(BELT),
        outcome.totals.seconds(Flags::MISSED_TRACE),
    ];
    let row: Vec<f64> = head
        .into_iter()
        .chain(sum.loss_j.iter().map(|j| j / 1e3))
        .collect();
    Ok(from_rows(
        row.len(),
        [(row, 1.0)].into_iter(),
        Marks::default(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_are_named_after_the_components() {
        let names: Vec<String> = Component::ALL
            .iter()
            .map(|c| format!("{}_kj", c.name()))
            .collect();
        assert_eq!(LOSSES.to_vec(), names);
    }

    #[test]
    fn no_column_is_named_twice() {
        for names in [columns(), total_columns()] {
            let mut sorted = names.clone();
            sorted.sort_unstable();
            sorted.dedup();
            assert_eq!(sorted.len(), names.len());
        }
    }
}
