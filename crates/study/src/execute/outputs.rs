//! The row of a run: its columns.
//!
//! Names and units are those of `run --json`, flattened: `loss_kj.pump` there is `loss_pump_kj` here.

use cvtcycle_output::summary::{Comparison, RunSummary};
use cvtcycle_output::table::Column;
use cvtcycle_output::{Component, Flags, columns};

/// A run and the comparison of the subject with it; none for the subject itself.
pub type Run = (RunSummary, Option<Comparison>);

/// The column of the subject's fuel over that of the row's car.
pub const EXCESS: &str = "subject_excess_percent";
/// The column of the headline fuel.
pub const FUEL: &str = "headline_fuel_l_per_100km";

/// The column of the fuel over time, which a drive too short or too slow for the headline fuel has.
pub const FUEL_OVER_TIME: &str = "fuel_l_per_h";

/// The column of a phase's fuel.
pub fn phase_fuel(phase: &str) -> String {
    format!("fuel_{}_l_per_100km", column_word(phase))
}

/// The column of the subject's fuel over that of the row's car in a phase.
pub fn phase_excess(phase: &str) -> String {
    format!("subject_excess_{}_percent", column_word(phase))
}

/// A phase's name as part of a column's: lower case, `_` for what is neither letter nor digit.
pub fn column_word(name: &str) -> String {
    let letter = |c: char| {
        if c.is_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '_'
        }
    };
    name.chars().map(letter).collect()
}

/// Every number of a row, for cycles with these phase groups and cars with these components.
pub fn outputs(phases: &[String], components: &[Component]) -> Vec<Column<Run>> {
    let mut list = fuel(phases);
    list.extend(energy(components));
    list.extend(states());
    list.extend(columns! { Run;
        optional "transmission_efficiency_percent", "%", "mean efficiency of the transmission over the cycle: demanded work at the wheels in driving over that work with all losses, those of idling and overrun included", (r, _) => r.transmission_efficiency_percent;
    });
    list
}

fn fuel(phases: &[String]) -> Vec<Column<Run>> {
    let mut list = columns! { Run;
        optional FUEL, "L/100 km", "fuel of the car: weighted where the cycle is, else over the whole cycle", (r, _) => r.headline_fuel();
        optional "fuel_l_per_100km", "L/100 km", "fuel over the whole cycle", (r, _) => r.fuel_l_per_100km;
        optional FUEL_OVER_TIME, "L/h", "fuel over the whole cycle, by time", (r, _) => r.fuel_l_per_h;
    };
    list.extend(phases.iter().map(|phase| {
        let (doc, word) = (format!("fuel in {phase}"), column_word(phase));
        Column::optional(phase_fuel(phase), "L/100 km", doc, move |(r, _): &Run| {
            r.phases
                .iter()
                .find(|p| column_word(&p.name) == word)?
                .fuel_l_per_100km
        })
    }));
    list.extend(columns! { Run;
        optional EXCESS, "%", "headline fuel of the subject over that of this car at the same point; empty for the subject", (_, excess) => excess.as_ref()?.fuel_percent;
    });
    list.extend(phases.iter().map(|phase| {
        let doc =
            format!("fuel of the subject over that of this car in {phase}; empty for the subject");
        let word = column_word(phase);
        Column::optional(phase_excess(phase), "%", doc, move |(_, excess): &Run| {
            let phases = &excess.as_ref()?.phases_percent;
            phases.iter().find(|(name, _)| column_word(name) == word)?.1
        })
    }));
    list.extend(columns! { Run;
        optional "co2_g_per_km", "g/km", "carbon dioxide over the whole cycle", (r, _) => r.co2_g_per_km;
        number "distance_km", "km", "driven distance", (r, _) => r.distance_km;
        number "duration_s", "s", "duration", (r, _) => r.duration_s;
        number "standstill_fuel_g", "g", "fuel at standstill", (r, _) => r.standstill_fuel_g;
    });
    list
}

fn energy(components: &[Component]) -> Vec<Column<Run>> {
    let mut list = columns! { Run;
        number "fuel_energy_kj", "kJ", "lower heating value of the fuel", (r, _) => r.fuel_energy_kj;
        number "wheel_work_positive_kj", "kJ", "demanded work at the wheels in driving", (r, _) => r.wheel_work_positive_kj;
        number "wheel_work_negative_kj", "kJ", "demanded work at the wheels in braking, negative", (r, _) => r.wheel_work_negative_kj;
        number "transmission_loss_kj", "kJ", "losses of the transmission", (r, _) => r.transmission_loss_kj();
    };
    list.extend(components.iter().map(|component| {
        let name = component.name();
        let doc = format!("loss of {}", name.replace('_', " "));
        let column = format!("loss_{name}_kj");
        Column::optional(column, "kJ", doc, move |(r, _): &Run| r.loss_kj.get(name))
    }));
    list.extend(columns! { Run;
        optional "loss_accessories_kj", "kJ", "work of the accessories", (r, _) => r.loss_kj.get("accessories");
        optional "loss_brake_kj", "kJ", "work of the wheel brakes", (r, _) => r.loss_kj.get("brake");
        number "kinetic_kj", "kJ", "change of rotating energy", (r, _) => r.kinetic_kj;
    });
    list
}

fn states() -> Vec<Column<Run>> {
    let mut list = columns! { Run;
        optional "end_transmission_sump_degc", "degC", "transmission oil in the sump at the end", (r, _) => r.end_degc.get("transmission_sump");
        optional "end_engine_oil_degc", "degC", "engine oil at the end", (r, _) => r.end_degc.get("engine_oil");
        optional "end_coolant_degc", "degC", "coolant and engine block at the end", (r, _) => r.end_degc.get("coolant");
        optional "end_transmission_metal_degc", "degC", "transmission case and shafts at the end", (r, _) => r.end_degc.get("transmission_metal");
        optional "end_belt_spray_degc", "degC", "belt, pulleys and the oil sprayed off them at the end", (r, _) => r.end_degc.get("belt_spray");
        optional "min_clamp_safety", "-", "smallest clamp safety factor", (r, _) => r.min_clamp_safety;
        optional "at_ratio_limit_s", "s", "time at a ratio limit", (r, _) => r.at_ratio_limit_s;
        optional "ledger_error", "-", "largest ledger error of any row", (r, _) => r.ledger_error;
        optional "step_error_percent", "%", "estimate of the error of the fuel by the length of the steps", (r, _) => r.step_error_percent;
        number "solve_residual", "-", "largest residual of the implicit solve", (r, _) => r.solve.worst_residual;
        optional "evaluations_per_step", "-", "mean evaluations of the driveline a row", (r, _) => r.solve.evaluations_per_step;
    };
    let flags = Flags::NAMES
        .into_iter()
        .filter(|(flag, _)| *flag != Flags::RATIO_LIMIT);
    list.extend(flags.map(|(_, name)| {
        let doc = format!("time with {}", name.replace('_', " "));
        Column::optional(format!("{name}_s"), "s", doc, move |(r, _): &Run| {
            r.flags_s.get(name)
        })
    }));
    list
}
