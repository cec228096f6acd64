//! Numbers of one car: fields of [`RunSummary`], with their values in [`run_summary`].

use crate::fleet_spread::FleetRange;
use serde::{Deserialize, Serialize};

use super::failure::{Deficit, Failure, LedgerErrors, failures, has_failed_trace};
use super::maps_left::MapLeft;
use super::phases::{PhaseFuel, PhaseSummary, phases, weighted_fuel};
use super::{Driven, Named, PriceSummary, Settings};
use crate::number::{finite, fixed, tiny};
use crate::{Component, Flags, PhaseTotals, TERM_NAMES};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_model::drive::Outcome;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, METAL, SUMP};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::clamp_cause::ClampCause;
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// Source of the shift speeds of a twin that has none of its own.
const BY_RULE: &str = "TW-3";
/// Source of shift speeds that are values of the vehicle's file.
const OF_FILE: &str = "shift speeds of the vehicle file";

/// Miles per imperial gallon at 1 L/100 km.
const MPG_UK: f64 = 282.481;
/// Miles per US gallon at 1 L/100 km.
const MPG_US: f64 = 235.215;

/// One car's numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunSummary {
    /// Name of the vehicle, unique within the run.
    pub vehicle: String,
    /// Name for people.
    pub title: String,
    /// Name in tables and figures, unique within the run; empty in files of an earlier version.
    #[serde(default)]
    pub short: String,
    /// `subject`, `unchanged` (the subject before the changes of its user) or `baseline`.
    pub role: String,
    /// `cvt` or `manual`.
    pub transmission: String,
    /// Transmission oil.
    pub lubricant: String,
    /// Engine oil.
    pub engine_oil: String,
    /// Launch device other than a clutch: `torque_converter`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub launch_device: Option<String>,
    /// Source of a manual car's gears; null for a CVT.
    pub gear_schedule: Option<String>,
    /// Driven distance.
    pub distance_km: f64,
    /// Duration.
    pub duration_s: f64,
    /// Fuel mass.
    pub fuel_kg: f64,
    /// Fuel volume.
    pub fuel_l: f64,
    /// The same mass, g; null in files of an earlier version.
    #[serde(default)]
    pub fuel_g: Option<f64>,
    /// Fuel over time; null in files of an earlier version.
    #[serde(default)]
    pub fuel_l_per_h: Option<f64>,
    /// Fuel over time; null in files of an earlier version.
    #[serde(default)]
    pub fuel_kg_per_h: Option<f64>,
    /// Fuel over the whole cycle; null below 10 m, and below a mean speed of 1 km/h.
    pub fuel_l_per_100km: Option<f64>,
    /// FTP75 only: fuel weighted by bag.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weighted_fuel_l_per_100km: Option<f64>,
    /// Range of the fuel from measured cars; absent for a car that has measurements of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fleet: Option<FleetRange>,
    /// Quantiles 0.05, 0.5 and 0.95 of the headline fuel over the draws of what is uncertain; absent where none were driven.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drawn: Option<[f64; 3]>,
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
    /// Moving time by the cause that decided the secondary pressure; null for a manual box.
    pub clamp_cause_s: Option<Named>,
    /// Time at a ratio limit; null for a manual box.
    pub at_ratio_limit_s: Option<f64>,
    /// Temperatures at the end.
    pub end_degc: Named,
    /// Largest ledger error of any row.
    pub ledger_error: Option<f64>,
    /// Ledger error of the terms summed over the run.
    pub run_ledger_error: Option<f64>,
    /// Time in which the car was slower than its trace by more than the tolerance of the test (TR-3).
    pub trace_missed_s: f64,
    /// Standard deviation of the fuel by the length of the steps (TS-1).
    #[serde(default)]
    pub step_error_percent: Option<f64>,
    /// Time outside the validity of a model.
    pub outside_validity_s: f64,
    /// Seconds with each flag.
    pub flags_s: Named,
    /// Row with the largest missing power; null if the trace was followed.
    pub worst_deficit: Option<Deficit>,
    /// Statistics of the implicit solve.
    pub solve: Solve,
    /// Measured maps that were left for a large part of the drive.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub maps_left: Vec<MapLeft>,
    /// Notes for readers of these numbers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Names of the failed checks, as in `failures`.
    pub failed_checks: Vec<String>,
    /// Failed checks, each with its time and its worst or first row; empty in files of an earlier version.
    #[serde(default)]
    pub failures: Vec<Failure>,
    /// Demanded work at the wheels in driving over that work with all losses of the transmission; null without either.
    pub transmission_efficiency_percent: Option<f64>,
    /// Price of each loss; null if not computed.
    #[serde(default)]
    pub price: Option<PriceSummary>,
}

/// Reference of a fuel consumption: distance or time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Distance, L/100 km.
    Distance,
    /// Time, L/h: the drive has no distance to speak of.
    Time,
}

impl Over {
    /// Unit of the consumption.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Over::Distance => "L/100 km",
            Over::Time => "L/h",
        }
    }
}

/// Statistics of the implicit solve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solve {
    /// Largest residual, as a fraction of full-load torque.
    pub worst_residual: f64,
    /// Mean evaluations of the driveline a row.
    pub evaluations_per_step: Option<f64>,
}

impl RunSummary {
    /// Failed checks and gross slip, each with its time: with any of them the numbers are none of a car that has driven the cycle.
    pub fn faults(&self) -> Vec<String> {
        let seconds = |failure: &Failure| match failure.seconds {
            Some(s) => format!("{} for {s:.0} s", failure.check.replace('_', " ")),
            None => failure.check.replace('_', " "),
        };
        let slip = Flags::GROSS_SLIP.names().next().unwrap_or_default();
        let is_failed = self.failures.iter().any(|failure| failure.check == slip);
        let slips = self.flags_s.get(slip).filter(|s| *s > 0.0 && !is_failed);
        let failures = self.failures.iter().map(seconds);
        let slips = slips.map(|s| format!("{} for {s:.0} s", slip.replace('_', " ")));
        failures.chain(slips).collect()
    }

    /// Name in tables and figures.
    pub fn label(&self) -> &str {
        match self.short.as_str() {
            "" => &self.vehicle,
            short => short,
        }
    }

    /// Headline fuel of the car: weighted where the cycle is.
    pub fn headline_fuel(&self) -> Option<f64> {
        self.weighted_fuel_l_per_100km.or(self.fuel_l_per_100km)
    }

    /// Fuel over time, L/h; of files of an earlier version too.
    pub fn litres_per_hour(&self) -> Option<f64> {
        let of_old = || finite(self.fuel_l * 3600.0 / self.duration_s);
        self.fuel_l_per_h.or_else(of_old)
    }

    /// Denominator of the headline fuel: distance, or time on a drive too short or too slow for L/100 km.
    pub fn over(&self) -> Over {
        match self.headline_fuel() {
            Some(_) => Over::Distance,
            None => Over::Time,
        }
    }

    /// Consumption over distance or time.
    pub fn consumption(&self, over: Over) -> Option<f64> {
        match over {
            Over::Distance => self.headline_fuel(),
            Over::Time => self.litres_per_hour(),
        }
    }

    /// Term of the power ledger that consumes fuel, kJ. `electric` is the remainder of battery, starter and alternator: their losses, and the
    /// energy stored in the battery (0 without start-stop).
    pub fn term_kj(&self, name: &str) -> Option<f64> {
        let term = |name: &str| self.ledger_kj.get(name);
        match name {
            "electric" => Some(term("electric_loss")? - term("store")?),
            name => term(name),
        }
    }

    /// Name of a transmission loss for people: the launch device has its own name.
    pub fn loss_words(&self, component: &str) -> String {
        let launch = component == Component::LaunchClutch.name();
        let own = self.launch_device.as_deref().filter(|_| launch);
        own.unwrap_or(component).replace('_', " ")
    }

    /// Sum of the transmission's losses, kJ.
    pub fn transmission_loss_kj(&self) -> f64 {
        self.ledger_kj.get("losses").unwrap_or(0.0)
    }

    /// Formats a failure as the end of a sentence that begins with the car.
    pub fn failure_text(&self, failure: &Failure) -> String {
        let seconds = fixed(failure.seconds, 1);
        let (at, phase) = (fixed(failure.at_s, 1), failure.phase.as_deref());
        let row = format!("at {at} s in {}", phase.unwrap_or_default());
        let unit = failure.unit.as_deref().unwrap_or_default();
        let limit = fixed(failure.limit, 0);
        let value = |decimals| format!("{} {unit} {row}", fixed(failure.value, decimals));
        match failure.check.as_str() {
            "missed_trace" => {
                let worst = self.worst_deficit.as_ref().map_or_else(String::new, |d| {
                    let torque = d.wheel_torque_nm;
                    let torque = torque.map(|nm| format!(" or {} Nm at the wheels", fixed(nm, 0)));
                    let (torque, kw) = (torque.unwrap_or_default(), fixed(d.power_w / 1e3, 1));
                    format!(", worst {row}: {kw} kW{torque} missing")
                });
                format!("misses the trace for {seconds} s{worst}")
            }
            "ledger_error" => {
                let (step, whole) = (tiny(self.ledger_error), tiny(self.run_ledger_error));
                format!(
                    "energy does not balance: relative error {step} in the worst time step, {whole} over the run"
                )
            }
            "overspeed" => {
                let value = value(0);
                format!("turns the engine at {value}, above {limit} {unit}, for {seconds} s")
            }
            "too_hot" => {
                let (node, value) = (failure.of.as_deref().unwrap_or("oil"), value(1));
                format!("heats the {node} to {value}, above {limit} {unit}, for {seconds} s")
            }
            "wrong_gear" => format!(
                "is driven faster for {seconds} s in which the cycle prescribes no gear, first {row}"
            ),
            "not_finite" => format!(
                "has a torque, speed, fuel flow or temperature that is no number for {seconds} s, first {row}"
            ),
            flag => format!("{flag} for {seconds} s"),
        }
    }
}

/// Summarises one car. `role` is `subject` or `baseline`.
pub fn run_summary(cycle: &Cycle, role: &str, settings: &Settings, driven: &Driven) -> RunSummary {
    let Driven {
        name,
        setup,
        outcome,
    } = *driven;
    let totals = &outcome.totals;
    let (engine, cvt) = (setup.engine(), setup.transmission().is_cvt());
    let (oil, engine_oil) = setup.oils();
    let all = totals.total();
    let fuel = PhaseFuel::new(&all, engine);
    let weighted = weighted_fuel(cycle, driven, engine);
    let headline = weighted.or(fuel.l_per_100km).filter(|l| *l > 0.0);
    let mpg = |factor: f64| headline.map(|l| factor / l);
    let seconds = |flag: Flags| totals.seconds(flag);
    let flags = Flags::NAMES.iter().zip(totals.flag_s);
    let terms = TERM_NAMES.iter().zip(all.terms.as_array());
    let mut summary = RunSummary {
        vehicle: name.to_owned(),
        title: setup.title.clone(),
        short: setup.short.clone(),
        role: role.to_owned(),
        transmission: if cvt { "cvt" } else { "manual" }.to_owned(),
        lubricant: oil.name.clone(),
        engine_oil: engine_oil.name.clone(),
        launch_device: launch_device(setup.transmission()),
        gear_schedule: gear_schedule(driven),
        distance_km: all.distance_m / 1e3,
        duration_s: all.duration_s,
        fuel_kg: all.fuel_kg,
        fuel_l: all.fuel_kg / engine.fuel_density_kg_m3 * 1e3,
        fuel_g: finite(all.fuel_kg * 1e3),
        fuel_l_per_h: fuel.l_per_h,
        fuel_kg_per_h: finite(all.fuel_kg * 3600.0 / all.duration_s),
        fuel_l_per_100km: fuel.l_per_100km,
        weighted_fuel_l_per_100km: weighted,
        fleet: None,
        drawn: None,
        mpg_uk: mpg(MPG_UK),
        mpg_us: mpg(MPG_US),
        co2_g_per_km: fuel.co2_g_per_km,
        weighted_co2_g_per_km: weighted
            .map(|l| l * engine.fuel_density_kg_m3 * engine.co2_kg_kg / 100.0),
        phases: phases(cycle, driven, engine),
        wheel_work_positive_kj: all.wheel_positive_j / 1e3,
        wheel_work_negative_kj: all.wheel_negative_j / 1e3,
        fuel_energy_kj: all.terms.fuel / 1e3,
        loss_kj: losses(driven, settings, &all),
        kinetic_kj: all.terms.kinetic / 1e3,
        ledger_kj: terms
            .map(|(name, joules)| (*name, finite(joules / 1e3)))
            .collect(),
        standstill_fuel_g: all.standstill_fuel_kg * 1e3,
        min_clamp_safety: finite(totals.min_clamp_safety).filter(|_| cvt),
        clamp_cause_s: cvt.then(|| {
            let causes = ClampCause::NAMES.iter().zip(totals.clamp_cause_s);
            causes.map(|((_, name), s)| (*name, finite(s))).collect()
        }),
        at_ratio_limit_s: cvt.then(|| seconds(Flags::RATIO_LIMIT)),
        end_degc: end_temperatures(outcome, cvt),
        ledger_error: finite(totals.ledger_error),
        run_ledger_error: finite(larger(all.terms.power_error(), all.terms.heat_error())),
        trace_missed_s: seconds(Flags::MISSED_TRACE),
        step_error_percent: finite(100.0 * totals.step_error_kg() / all.fuel_kg),
        outside_validity_s: seconds(Flags::OUTSIDE_VALIDITY),
        flags_s: flags.map(|((_, name), s)| (*name, finite(s))).collect(),
        worst_deficit: Deficit::worst(cycle, driven).filter(|_| has_failed_trace(totals)),
        solve: Solve {
            worst_residual: totals.worst_residual,
            evaluations_per_step: finite(totals.evaluations as f64 / totals.rows as f64),
        },
        maps_left: Vec::new(),
        notes: setup.notes.clone(),
        failed_checks: Vec::new(),
        failures: Vec::new(),
        transmission_efficiency_percent: finite(
            100.0 * all.wheel_positive_j / (all.wheel_positive_j + all.terms.losses),
        ),
        price: None,
    };
    let ledger = LedgerErrors {
        row: summary.ledger_error,
        run: summary.run_ledger_error,
    };
    summary.failures = failures(cycle, settings, driven, ledger);
    let names = summary.failures.iter().map(|failure| failure.check.clone());
    summary.failed_checks = names.collect();
    summary
}

/// Name of a launch device other than a clutch.
fn launch_device(transmission: &Transmission) -> Option<String> {
    let coupling = transmission.coupling();
    coupling.by_command().then(|| coupling.device().to_owned())
}

/// Source of the gears; no file holds the shift speeds of a twin.
fn gear_schedule(driven: &Driven) -> Option<String> {
    let words = driven.outcome.gear_schedule;
    let mut keys = driven.setup.keys.iter();
    let is_rule =
        keys.any(|info| info.key == "transmission.manual.upshift_kmh" && info.source == BY_RULE);
    let words = match is_rule {
        true => words.replacen(OF_FILE, "shift speeds by the rule TW-3, assumed", 1),
        false => words.to_owned(),
    };
    Some(words).filter(|words| !words.is_empty())
}

fn larger(a: f64, b: f64) -> f64 {
    // NaN must not be hidden by the other operand.
    if a.is_nan() || a > b { a } else { b }
}

fn losses(driven: &Driven, settings: &Settings, all: &PhaseTotals) -> Named {
    // The verification formulations have no film model: all shear belongs to the bands.
    let film =
        settings.formulation.is_empty() || settings.formulation == Formulation::Smooth.name();
    let joules = |c: Component| all.loss_j[c];
    let part = |c: Component| match c {
        Component::BeltFilm if !film => None,
        Component::BeltBand if !film => finite((joules(c) + joules(Component::BeltFilm)) / 1e3),
        _ => finite(joules(c) / 1e3),
    };
    let components = driven.setup.transmission().components();
    let components = components.into_iter().map(|c| (c.name(), part(c)));
    let rest = [
        ("accessories", all.terms.accessories),
        ("brake", all.terms.brake),
    ];
    let rest = rest.map(|(name, joules)| (name, finite(joules / 1e3)));
    components.chain(rest).collect()
}

fn end_temperatures(outcome: &Outcome, cvt: bool) -> Named {
    let degc = |node: usize| finite(outcome.end.node_k[node] - ZERO_DEGC_K);
    [
        ("transmission_sump", degc(SUMP)),
        ("engine_oil", degc(ENGINE_OIL)),
        ("coolant", degc(COOLANT)),
        ("transmission_metal", degc(METAL)),
        ("belt_spray", degc(BELT).filter(|_| cvt)),
    ]
    .into_iter()
    .collect()
}
