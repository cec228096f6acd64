//! The row of a run: one table of columns, with the getter of each.
//!
//! Names and units are those of `run --json`, flattened: what stands there as `loss_kj.pump` is `loss_pump_kj` here.

use super::table::{Head, Kind};
use cvtcycle_output::summary::{Comparison, RunSummary};
use cvtcycle_output::{Component, Flags};

/// A number of a run's row.
#[derive(Clone, Debug)]
pub struct Output {
    /// Its column.
    pub column: Head,
    get: Getter,
}

#[derive(Clone, Debug)]
enum Getter {
    Summary(fn(&RunSummary) -> Option<f64>),
    Phase(String),
    Loss(&'static str),
    End(&'static str),
    Flag(&'static str),
    Excess,
    PhaseExcess(String),
}

impl Output {
    fn new(name: &str, unit: &str, doc: &str, get: Getter) -> Self {
        Output {
            column: Head {
                name: name.to_owned(),
                unit: unit.to_owned(),
                doc: doc.to_owned(),
                kind: Kind::Number,
            },
            get,
        }
    }

    /// The number of a run; NaN where there is none. `excess` is the subject against this car, none for the subject itself.
    #[must_use]
    pub fn number(&self, run: &RunSummary, excess: Option<&Comparison>) -> f64 {
        let found = match &self.get {
            Getter::Summary(get) => get(run),
            Getter::Phase(name) => run
                .phases
                .iter()
                .find(|p| column_word(&p.name) == *name)
                .and_then(|p| p.fuel_l_per_100km),
            Getter::Loss(name) => run.loss_kj.get(name),
            Getter::End(name) => run.end_degc.get(name),
            Getter::Flag(name) => run.flags_s.get(name),
            Getter::Excess => excess.and_then(|e| e.fuel_percent),
            Getter::PhaseExcess(name) => excess.and_then(|e| {
                e.phases_percent
                    .iter()
                    .find(|(p, _)| column_word(p) == *name)?
                    .1
            }),
        };
        found.unwrap_or(f64::NAN)
    }
}

/// The column of the subject's fuel over that of the row's car.
pub const EXCESS: &str = "subject_excess_percent";
/// The column of the headline fuel.
pub const FUEL: &str = "headline_fuel_l_per_100km";

/// The column of a phase's fuel.
#[must_use]
pub fn phase_fuel(phase: &str) -> String {
    format!("fuel_{}_l_per_100km", column_word(phase))
}

/// The column of the subject's fuel over that of the row's car in a phase.
#[must_use]
pub fn phase_excess(phase: &str) -> String {
    format!("subject_excess_{}_percent", column_word(phase))
}

/// A phase's name as part of a column's: lower case, `_` for what is neither letter nor digit.
#[must_use]
pub fn column_word(name: &str) -> String {
    name.chars()
        .map(|c| {
            if c.is_alphanumeric() {
                c.to_ascii_lowercase()
            } else {
                '_'
            }
        })
        .collect()
}

/// Every number of a row, for cycles with these phase groups and cars with these components.
#[must_use]
pub fn outputs(phases: &[String], components: &[Component]) -> Vec<Output> {
    let mut list = fuel(phases);
    list.extend(energy(components));
    list.extend(states());
    list
}

fn fuel(phases: &[String]) -> Vec<Output> {
    use Getter::Summary as S;
    let mut list = vec![
        Output::new(
            FUEL,
            "L/100 km",
            "fuel that stands for the car: weighted where the cycle is, else over the whole cycle",
            S(RunSummary::headline_fuel),
        ),
        Output::new(
            "fuel_l_per_100km",
            "L/100 km",
            "fuel over the whole cycle",
            S(|r| r.fuel_l_per_100km),
        ),
    ];
    for phase in phases {
        list.push(Output::new(
            &phase_fuel(phase),
            "L/100 km",
            &format!("fuel in {phase}"),
            Getter::Phase(column_word(phase)),
        ));
    }
    list.push(Output::new(
        EXCESS,
        "%",
        "headline fuel of the subject over that of this car at the same point; empty for the subject",
        Getter::Excess,
    ));
    for phase in phases {
        let doc =
            format!("fuel of the subject over that of this car in {phase}; empty for the subject");
        list.push(Output::new(
            &phase_excess(phase),
            "%",
            &doc,
            Getter::PhaseExcess(column_word(phase)),
        ));
    }
    list.extend([
        Output::new(
            "co2_g_per_km",
            "g/km",
            "carbon dioxide over the whole cycle",
            S(|r| r.co2_g_per_km),
        ),
        Output::new(
            "distance_km",
            "km",
            "driven distance",
            S(|r| Some(r.distance_km)),
        ),
        Output::new("duration_s", "s", "duration", S(|r| Some(r.duration_s))),
        Output::new(
            "standstill_fuel_g",
            "g",
            "fuel at standstill",
            S(|r| Some(r.standstill_fuel_g)),
        ),
    ]);
    list
}

fn energy(components: &[Component]) -> Vec<Output> {
    use Getter::Summary as S;
    let mut list = vec![
        Output::new(
            "fuel_energy_kj",
            "kJ",
            "lower heating value of the fuel",
            S(|r| Some(r.fuel_energy_kj)),
        ),
        Output::new(
            "wheel_work_positive_kj",
            "kJ",
            "demanded work at the wheels in driving",
            S(|r| Some(r.wheel_work_positive_kj)),
        ),
        Output::new(
            "wheel_work_negative_kj",
            "kJ",
            "demanded work at the wheels in braking, negative",
            S(|r| Some(r.wheel_work_negative_kj)),
        ),
        Output::new(
            "transmission_loss_kj",
            "kJ",
            "losses of the transmission",
            S(|r| Some(r.transmission_loss_kj())),
        ),
    ];
    for component in components {
        let name = component.name();
        list.push(Output::new(
            &format!("loss_{name}_kj"),
            "kJ",
            &format!("loss of {}", name.replace('_', " ")),
            Getter::Loss(name),
        ));
    }
    list.extend([
        Output::new(
            "loss_accessories_kj",
            "kJ",
            "work of the accessories",
            Getter::Loss("accessories"),
        ),
        Output::new(
            "loss_brake_kj",
            "kJ",
            "work of the wheel brakes",
            Getter::Loss("brake"),
        ),
        Output::new(
            "kinetic_kj",
            "kJ",
            "change of rotating energy",
            S(|r| Some(r.kinetic_kj)),
        ),
    ]);
    list
}

fn states() -> Vec<Output> {
    use Getter::Summary as S;
    let mut list: Vec<Output> = [
        ("transmission_sump", "transmission oil in the sump"),
        ("engine_oil", "engine oil"),
        ("coolant", "coolant and engine block"),
        ("transmission_metal", "transmission case and shafts"),
        ("belt_spray", "belt, pulleys and the oil sprayed off them"),
    ]
    .map(|(name, doc)| {
        Output::new(
            &format!("end_{name}_degc"),
            "degC",
            &format!("{doc} at the end"),
            Getter::End(name),
        )
    })
    .into();
    list.extend([
        Output::new(
            "min_clamp_safety",
            "-",
            "smallest clamp safety factor",
            S(|r| r.min_clamp_safety),
        ),
        Output::new(
            "at_ratio_limit_s",
            "s",
            "time at a ratio limit",
            S(|r| r.at_ratio_limit_s),
        ),
        Output::new(
            "ledger_error",
            "-",
            "largest ledger error of any row",
            S(|r| r.ledger_error),
        ),
        Output::new(
            "solve_residual",
            "-",
            "largest residual of the implicit solve",
            S(|r| Some(r.solve.worst_residual)),
        ),
        Output::new(
            "evaluations_per_step",
            "-",
            "mean evaluations of the driveline a row",
            S(|r| r.solve.evaluations_per_step),
        ),
    ]);
    for (flag, name) in Flags::NAMES {
        if flag != Flags::RATIO_LIMIT {
            list.push(Output::new(
                &format!("{name}_s"),
                "s",
                &format!("time with {}", name.replace('_', " ")),
                Getter::Flag(name),
            ));
        }
    }
    list
}
