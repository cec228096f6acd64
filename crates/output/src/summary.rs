//! The numbers of a run as one object: `run --json`, `summary.json`, and what the tables print.
//!
//! Names are a contract with users' scripts. A number that was not computed, or is none, is null. Outside
//! units (degC, kJ, L/100 km) begin here.

mod gather;
mod named;

pub use gather::{compare, run_summary, summarise};
pub use named::Named;

use serde::{Deserialize, Serialize};

use super::Flags;
use super::record::Manifest;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::Outcome;

/// Version of the object; a new number when a name goes or changes its meaning.
pub const SCHEMA: u32 = 1;
/// Ledger error above which a run counts as failed.
const LEDGER_TOLERANCE: f64 = 1e-9;
/// Flags that fail a strict run.
const STRICT: [Flags; 4] = [
    Flags::OUTSIDE_VALIDITY,
    Flags::GROSS_SLIP,
    Flags::LOW_CLAMP,
    Flags::FLOW_LIMITED,
];

/// A whole run: the subject and its baselines through one cycle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version [`SCHEMA`] of this object, and the program.
    #[serde(flatten)]
    pub manifest: Manifest,
    /// Name of the cycle.
    pub cycle: String,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// `soak`, `warm`, or the temperature of all nodes in degC.
    pub start: StartWord,
    /// What else was asked for.
    pub settings: Settings,
    /// The subject, then the baselines.
    pub runs: Vec<RunSummary>,
    /// The subject against each baseline.
    pub comparison: Vec<Comparison>,
}

/// Start as the user wrote it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum StartWord {
    /// `soak` or `warm`.
    Word(String),
    /// All nodes at a temperature, degC.
    Degc(f64),
}

/// Settings other than cycle, ambient and start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Largest step, s.
    pub dt_s: f64,
    /// Reading of the belt model.
    pub formulation: String,
    /// Overrides of the subject.
    pub set: Vec<String>,
    /// Overrides of all cars.
    pub set_all: Vec<String>,
    /// Whether departures from validity fail the run.
    pub strict: bool,
}

/// One car's numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunSummary {
    /// Name of the vehicle, unique within the run.
    pub vehicle: String,
    /// Name for people.
    pub title: String,
    /// `subject` or `baseline`.
    pub role: String,
    /// `cvt` or `manual`.
    pub transmission: String,
    /// Transmission oil.
    pub lubricant: String,
    /// Engine oil.
    pub engine_oil: String,
    /// Where a manual car's gears come from; null for a CVT.
    pub gear_schedule: Option<String>,
    /// Driven distance.
    pub distance_km: f64,
    /// Duration.
    pub duration_s: f64,
    /// Fuel mass.
    pub fuel_kg: f64,
    /// Fuel volume.
    pub fuel_l: f64,
    /// Fuel over the whole cycle.
    pub fuel_l_per_100km: Option<f64>,
    /// FTP75 only: fuel weighted by bag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weighted_fuel_l_per_100km: Option<f64>,
    /// Miles per imperial gallon, of the weighted fuel where there is one.
    pub mpg_uk: Option<f64>,
    /// Miles per US gallon, of the weighted fuel where there is one.
    pub mpg_us: Option<f64>,
    /// Carbon dioxide over the whole cycle.
    pub co2_g_per_km: Option<f64>,
    /// FTP75 only: carbon dioxide of the weighted fuel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weighted_co2_g_per_km: Option<f64>,
    /// By group of phases.
    pub phases: Vec<PhaseSummary>,
    /// Demanded work at the wheels in driving.
    pub wheel_work_positive_kj: f64,
    /// Demanded work at the wheels in braking, negative.
    pub wheel_work_negative_kj: f64,
    /// Lower heating value of the fuel.
    pub fuel_energy_kj: f64,
    /// By component of this transmission, then accessories and brake.
    pub loss_kj: Named,
    /// Change of rotating energy.
    pub kinetic_kj: f64,
    /// Terms of both ledgers.
    pub ledger_kj: Named,
    /// Fuel at standstill.
    pub standstill_fuel_g: f64,
    /// Smallest clamp safety factor; null for a manual box.
    pub min_clamp_safety: Option<f64>,
    /// Time at a ratio limit; null for a manual box.
    pub at_ratio_limit_s: Option<f64>,
    /// Temperatures at the end.
    pub end_degc: Named,
    /// Largest ledger error of any row.
    pub ledger_error: Option<f64>,
    /// Ledger error of the terms summed over the run.
    pub run_ledger_error: Option<f64>,
    /// Time in which the car could not follow.
    pub trace_missed_s: f64,
    /// Time outside the validity of a model.
    pub outside_validity_s: f64,
    /// Seconds with each flag.
    pub flags_s: Named,
    /// Where most power was missing; null if the trace was followed.
    pub worst_deficit: Option<Deficit>,
    /// How the implicit solve went.
    pub solve: Solve,
    /// Names of the checks that failed: `missed_trace`, `ledger_error`, `not_converged`, or a flag under `--strict`.
    pub failed_checks: Vec<String>,
}

/// One group of phases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhaseSummary {
    /// Name of the group.
    pub name: String,
    /// Driven distance.
    pub distance_km: f64,
    /// Duration.
    pub duration_s: f64,
    /// Fuel mass.
    pub fuel_kg: f64,
    /// Fuel; null without distance.
    pub fuel_l_per_100km: Option<f64>,
    /// Carbon dioxide; null without distance.
    pub co2_g_per_km: Option<f64>,
    /// Losses of the transmission.
    pub transmission_loss_kj: f64,
}

/// The worst row of a missed trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deficit {
    /// Missing power.
    pub power_w: f64,
    /// Missing torque at the wheels.
    pub wheel_torque_nm: Option<f64>,
    /// End of the row.
    pub at_s: f64,
    /// Phase of the row.
    pub phase: String,
}

/// How the implicit solve went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solve {
    /// Largest residual, as a fraction of full-load torque.
    pub worst_residual: f64,
    /// Mean evaluations of the driveline a row.
    pub evaluations_per_step: Option<f64>,
}

/// The subject against one baseline; positive means that the subject uses more.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Name of the baseline.
    pub baseline: String,
    /// Difference of the fuel per distance over the whole cycle (FTP75: weighted), per cent.
    pub fuel_percent: Option<f64>,
    /// Difference by group of phases, per cent.
    pub phases_percent: Named,
}

/// A car that has been driven.
#[derive(Clone, Copy, Debug)]
pub struct Driven<'a> {
    /// Name, unique within the run.
    pub name: &'a str,
    /// Its input.
    pub setup: &'a Setup,
    /// What came out.
    pub outcome: &'a Outcome,
}

impl RunSummary {
    /// Headline fuel of the car: weighted where the cycle is.
    pub fn headline_fuel(&self) -> Option<f64> {
        self.weighted_fuel_l_per_100km.or(self.fuel_l_per_100km)
    }

    /// Sum of the transmission's losses, kJ.
    pub fn transmission_loss_kj(&self) -> f64 {
        self.ledger_kj.get("losses").unwrap_or(0.0)
    }

    fn checks(&self, strict: bool) -> Vec<String> {
        let flag = |flag: Flags| {
            let name = flag.names().next().unwrap_or_default();
            (name, self.flags_s.get(name).is_some_and(|s| s > 0.0))
        };
        // Stated as what is good, so that an error that is no number fails.
        let closed = |error: Option<f64>| error.is_some_and(|e| e <= LEDGER_TOLERANCE);
        let balanced = closed(self.ledger_error) && closed(self.run_ledger_error);
        let mut list = vec![
            flag(Flags::MISSED_TRACE),
            ("ledger_error", !balanced),
            flag(Flags::NOT_CONVERGED),
        ];
        if strict {
            list.extend(STRICT.map(flag));
        }
        list.retain(|(_, failed)| *failed);
        list.into_iter().map(|(name, _)| name.to_owned()).collect()
    }
}
