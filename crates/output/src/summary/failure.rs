//! Failed checks of a run, each with its time, and its worst or first row.
//!
//! | check | fails |
//! |---|---|
//! | `missed_trace` | a row with the flag: slower than the trace by more than its tolerance (TR-3) |
//! | `not_converged`, `too_hot`, `wrong_gear` | a row with the flag |
//! | `overspeed` | a row with the flag, more than 1 % above the end of the full-load line as well |
//! | `ledger_error` | an energy balance of a row open by more than 1e-9, or that of the run by more than the rounding of its sums |
//! | `not_finite` | a row in which torque, speed, fuel or a temperature is not finite; its ledger is not checked |
//! | flags of [`STRICT`] | under `--strict` a row with the flag |

use serde::{Deserialize, Serialize};

use super::{Driven, Settings};
use crate::Flags;
use crate::number::{finite, fixed};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_model::drive::{HIGHEST_K, Totals};
use cvtcycle_model::keys::rpm;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::math::larger;

/// Maximum ledger error of a row, and of a run unless its sums round more.
const LEDGER_TOLERANCE: f64 = 1e-9;
/// Engine speed over the end of the full-load line up to which overspeed is no failure: belt slip adds to the ratio target.
const OVERSPEED: f64 = 1.01;
/// Flags that fail a strict run.
const STRICT: [Flags; 4] = [
    Flags::OUTSIDE_VALIDITY,
    Flags::GROSS_SLIP,
    Flags::LOW_CLAMP,
    Flags::FLOW_LIMITED,
];
/// Names of the temperatures in [`HIGHEST_K`].
const HOT: [&str; HIGHEST_K.len()] = ["coolant", "engine oil", "transmission oil"];

/// A check that a run failed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// Name of the check: of a flag, `ledger_error` or `not_finite`.
    pub check: String,
    /// Time in rows that fail it; null for an energy balance.
    pub seconds: Option<f64>,
    /// End of the worst row, or of the first where they do not differ.
    pub at_s: Option<f64>,
    /// Phase of that row.
    pub phase: Option<String>,
    /// Subject of the value, unless the name of the check says it: `coolant`, `engine oil`, `transmission oil`.
    pub of: Option<String>,
    /// Value in the worst row.
    pub value: Option<f64>,
    /// Limit of the value.
    pub limit: Option<f64>,
    /// Unit of both.
    pub unit: Option<String>,
}

impl Failure {
    fn from_flag(flag: Flags, totals: &Totals) -> Self {
        Failure {
            check: flag.names().collect(),
            seconds: finite(totals.seconds(flag)),
            ..Failure::default()
        }
    }

    /// Adds the value of the worst row, the limit and the unit.
    fn value(self, value: f64, limit: impl Into<Option<f64>>, unit: &str) -> Self {
        Failure {
            value: finite(value),
            limit: limit.into(),
            unit: Some(unit.to_owned()),
            ..self
        }
    }

    /// Formats the failure in a few words: `overspeed for 212 s, worst 15117.0 rpm at 98 s in eudc`.
    pub fn brief(&self) -> String {
        let check = &self.check;
        let Some(seconds) = self.seconds else {
            return check.clone();
        };
        let row = self.at_s.zip(self.phase.as_ref());
        let row = row.map(|(at_s, phase)| format!("at {at_s:.0} s in {phase}"));
        let value = self.value.zip(self.unit.as_ref());
        let row = match (value, row) {
            (Some((value, unit)), Some(row)) => {
                format!(", worst {} {unit} {row}", fixed(value, 1))
            }
            (None, Some(row)) => format!(", first {row}"),
            (_, None) => String::new(),
        };
        format!("{check} for {seconds:.0} s{row}")
    }
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

impl Deficit {
    /// Finds the worst row of a run that missed its trace.
    pub(super) fn worst(cycle: &Cycle, driven: &Driven) -> Option<Self> {
        let totals = &driven.outcome.totals;
        let at_s = finite(totals.worst_deficit_at_s)?;
        Some(Deficit {
            power_w: totals.worst_deficit_w,
            wheel_torque_nm: finite(totals.worst_deficit_nm),
            at_s,
            phase: phase_at(cycle, driven, at_s)?,
        })
    }
}

/// Finds the phase of a row by its end, s.
fn phase_at(cycle: &Cycle, driven: &Driven, at_s: f64) -> Option<String> {
    let trace = cycle.trace_for(driven.setup.transmission().is_cvt());
    let interval = trace.intervals.iter().find(|i| at_s <= i.end_s + 1e-9)?;
    let name = cycle.phases.get(usize::from(interval.phase));
    Some(name.unwrap_or(&cycle.name).to_lowercase())
}

/// True if a run is slower than its trace by more than the tolerance of the test (TR-3).
#[must_use]
pub fn has_failed_trace(totals: &Totals) -> bool {
    totals.seconds(Flags::MISSED_TRACE) > 0.0
}

/// Relative errors of the energy balances of a run: maximum over the rows, and of the sums.
#[derive(Clone, Copy, Debug)]
pub(super) struct LedgerErrors {
    pub row: Option<f64>,
    pub run: Option<f64>,
}

/// Lists all failed checks of a run.
pub(super) fn failures(
    cycle: &Cycle,
    settings: &Settings,
    driven: &Driven,
    ledger: LedgerErrors,
) -> Vec<Failure> {
    let (totals, engine) = (&driven.outcome.totals, driven.setup.engine());
    let flag = |flag: Flags| (totals.seconds(flag) > 0.0).then(|| Failure::from_flag(flag, totals));
    let at = |failure: Failure, at_s: f64| Failure {
        at_s: finite(at_s),
        phase: phase_at(cycle, driven, at_s),
        ..failure
    };

    let missed = flag(Flags::MISSED_TRACE);
    let missed = missed.map(|failure| match Deficit::worst(cycle, driven) {
        Some(worst) => at(failure, worst.at_s).value(worst.power_w / 1e3, None::<f64>, "kW"),
        None => failure,
    });
    let fastest = totals.fastest_rad_s;
    let line_ends = engine.full_load.points().last();
    let limit = line_ends.map_or(engine.highest_rad_s, |(speed, _)| {
        larger(speed, engine.highest_rad_s)
    });
    let overspeed = flag(Flags::OVERSPEED)
        .filter(|_| fastest.value > OVERSPEED * limit)
        .map(|failure| at(failure, fastest.at_s).value(rpm(fastest.value), rpm(limit), "rpm"));
    let hottest = HIGHEST_K.iter().zip(totals.hottest_k).zip(HOT);
    let hottest = hottest.map(|(((_, most_k), found), of)| (found, *most_k, of));
    let hottest = hottest
        .max_by(|(a, most_a, _), (b, most_b, _)| (a.value - most_a).total_cmp(&(b.value - most_b)));
    let too_hot = flag(Flags::TOO_HOT)
        .zip(hottest)
        .map(|(failure, (found, most_k, of))| {
            let [value, limit] = [found.value, most_k].map(|k| k - ZERO_DEGC_K);
            let of = Some(of.to_owned());
            at(Failure { of, ..failure }, found.at_s).value(value, limit, "degC")
        });
    let wrong_gear = flag(Flags::WRONG_GEAR).map(|failure| at(failure, totals.wrong_gear_at_s));
    let not_finite = (totals.not_finite_s > 0.0).then(|| {
        let failure = Failure {
            check: "not_finite".to_owned(),
            seconds: finite(totals.not_finite_s),
            ..Failure::default()
        };
        at(failure, totals.not_finite_at_s)
    });
    // The comparison is positive so that NaN fails. A plain sum of n terms rounds by up to n epsilon.
    let closed = |error: Option<f64>, tolerance: f64| error.is_some_and(|e| e <= tolerance);
    let rounding = totals.rows as f64 * f64::EPSILON;
    let run_tolerance = larger(LEDGER_TOLERANCE, rounding);
    let balanced = closed(ledger.row, LEDGER_TOLERANCE) && closed(ledger.run, run_tolerance);
    let open = (!balanced && not_finite.is_none()).then(|| Failure {
        check: "ledger_error".to_owned(),
        ..Failure::default()
    });

    let list = [
        missed,
        open,
        flag(Flags::NOT_CONVERGED),
        overspeed,
        too_hot,
        wrong_gear,
        not_finite,
    ];
    let strict = STRICT.into_iter().filter(|_| settings.strict).map(flag);
    list.into_iter().chain(strict).flatten().collect()
}
