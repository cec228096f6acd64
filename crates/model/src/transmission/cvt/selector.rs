//! The selector of an automatic box at rest: drive, or neutral.
//!
//! | label | statement | status |
//! |---|---|---|
//! | SE-1 | neutral while the engine has run less than t_D since its start; t_D of the cycle, 15 s in the US city test, where the file says so | source: 40 CFR 86.136-90, from memory |
//! | SE-2 | neutral from t_N at rest on, where the file has one | ASSUMED: boxes that open their clutch at a long stop do so after 1 to 5 s |
//! | SE-3 | n share of a step in neutral: creep torque times 1 - n | derived: an open box passes on nothing |
//!
//! A car that moves is in drive, so a cycle that begins at once has no neutral.

use crate::keys::{Choice, Values, keys};
use crate::math::{Gather, Real, clamp, physics};

/// The checked selector.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Selector<R: Real = f64> {
    /// True where it is moved when the procedure of the cycle says so.
    #[gather(same)]
    pub by_cycle: bool,
    /// Time at rest from which the box is in neutral, s; infinite for a box that stays in drive.
    pub neutral_after_s: R,
}

/// Inputs of the selector in a step at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelectorSignals {
    /// Time from a start of the engine until the cycle has the selector in drive, s.
    pub procedure_s: f64,
    /// Time that the engine has run before the step, s.
    pub running_s: f64,
    /// Time that the car has been at rest before the step, s.
    pub rested_s: f64,
    /// Length of the step, s.
    pub dt_s: f64,
}

impl SelectorSignals {
    /// Share of a step for which the procedure of the cycle has the box in neutral, and the time at rest with the step, s.
    fn started(&self) -> (f64, f64) {
        let share = clamp((self.procedure_s - self.running_s) / self.dt_s, 0.0, 1.0); // SE-1
        (share, self.rested_s + self.dt_s)
    }
}

#[physics]
impl<R: Real> Selector<R> {
    /// Share of a step at rest that the box is in neutral, 0..1.
    pub fn neutral_share(&self, now: &SelectorSignals) -> R {
        let (started, rested_s) = now.started();
        let started = if self.by_cycle { started } else { 0.0 };
        let late_s = rested_s - self.neutral_after_s;
        (late_s / now.dt_s).clamp(0.0, 1.0).max(started) // SE-2
    }
}

keys! {
    /// Keys of `[transmission.cvt.selector]`.
    SELECTOR: SelectorKeys = "selector" [] {
        at_start: words(&[
            Choice::word("drive", "in drive from the first second"),
            Choice::word("by_cycle", "in park or neutral as long as the procedure of the cycle has it"),
        ], "drive"), "selector after a start of the engine", ["SE-1"];
        neutral_after_s: optional(number(0.0, 600.0)), "time at rest after which the box is in neutral; absent: it stays in drive", ["SE-2"];
    }
}

impl Selector {
    /// The selector from the values of its table.
    pub(super) fn from_values<V: Values>(s: &V) -> Self {
        Selector {
            by_cycle: s.word(&SELECTOR.at_start) == "by_cycle",
            neutral_after_s: s
                .optional(&SELECTOR.neutral_after_s)
                .unwrap_or(f64::INFINITY),
        }
    }
}
