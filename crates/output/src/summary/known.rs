//! External knowledge of a result: its uncertainty, and the published numbers that it contradicts.

use crate::number::signed;
use serde::{Deserialize, Serialize};

/// Difference of fuel over the draws of a plan of uncertainty, for exactly this case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DrawnDifference {
    /// Name of the plan.
    pub plan: String,
    /// Number of pairs.
    pub draws: u64,
    /// Pairs left out because a run fails.
    #[serde(default)]
    pub left_out: u64,
    /// Checks that fail in the pairs left out with their counts, the commonest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reasons: Vec<(String, u64)>,
    /// Pairs in which the subject uses more.
    pub more: u64,
    /// Quantiles 0.05, 0.5 and 0.95 of the difference, per cent; null (NaN) where all pairs fail.
    #[serde(deserialize_with = "numbers")]
    pub percent: [f64; 3],
    /// Quantiles 0.05, 0.5 and 0.95 of the fuel of the subject over the draws in which it works, L/100 km; none where too many fail.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fuel_l_per_100km: Option<[f64; 3]>,
    /// Median by form of a law, per cent, with the form's name for people and its draws; empty where the plan has one form.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub by_form: Vec<(String, u64, f64)>,
}

/// Numbers of which JSON has null for what is not finite.
fn numbers<'de, D: serde::Deserializer<'de>>(of: D) -> Result<[f64; 3], D::Error> {
    let read = <[Option<f64>; 3]>::deserialize(of)?;
    Ok(read.map(|x| x.unwrap_or(f64::NAN)))
}

/// Share of the draws that may fail without being named a risk, and above which the others claim no range: they are of a car that
/// works in the rest of its uncertainty alone.
pub const FAILED_SHARES: [f64; 2] = [0.05, 0.2];

impl DrawnDifference {
    /// Share of the pairs that fail.
    #[must_use]
    pub fn failed_share(&self) -> f64 {
        let all = self.draws + self.left_out;
        match all {
            0 => 0.0,
            all => self.left_out as f64 / all as f64,
        }
    }

    /// Ends of 90 % of the draws, per cent; `None` where too many draws fail for the others to give a range.
    #[must_use]
    pub fn ends(&self) -> Option<[f64; 2]> {
        let ends = [self.percent[0], self.percent[2]];
        let is_known =
            self.failed_share() <= FAILED_SHARES[1] && ends.iter().all(|x| x.is_finite());
        is_known.then_some(ends)
    }

    /// "+3.1 % with one form, +1.2 % with another"; `None` where the forms of a law agree: in sign, and within a third of the range.
    #[must_use]
    pub fn forms_in_words(&self) -> Option<String> {
        let medians = || self.by_form.iter().map(|(_, _, median)| *median);
        let (low, high) = (medians().reduce(f64::min)?, medians().reduce(f64::max)?);
        let differ =
            (low < 0.0) != (high < 0.0) || high - low > (self.percent[2] - self.percent[0]) / 3.0;
        let words = self.by_form.iter();
        let words =
            words.map(|(title, _, median)| format!("{} % with {title}", signed(*median, 1)));
        differ.then(|| words.collect::<Vec<_>>().join(", "))
    }

    /// "56 of 256 runs with uncertain values varied fail: gross_slip in 40, not_converged in 20"; `None` where so few fail that it is no risk.
    #[must_use]
    pub fn failures_in_words(&self) -> Option<String> {
        (self.failed_share() > FAILED_SHARES[0]).then(|| {
            let (failed, all) = (self.left_out, self.draws + self.left_out);
            let reasons = self
                .reasons
                .iter()
                .map(|(name, n)| format!("{name} in {n}"));
            let reasons = reasons.collect::<Vec<_>>().join(", ");
            format!("{failed} of {all} runs with uncertain values varied fail: {reasons}")
        })
    }
}

/// A published number that a number of this run contradicts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contradiction {
    /// Row of `cvtcycle validate`.
    pub row: String,
    /// Baseline of the difference; `None` for the fuel of the subject itself.
    pub baseline: Option<String>,
    /// Group of phases; `None` for the whole cycle.
    pub phase: Option<String>,
    /// The number of this run, in `unit`.
    pub computed: f64,
    /// Unit.
    pub unit: String,
    /// The published text.
    pub printed: String,
    /// Published range in the same unit; `None` in files of an earlier version.
    #[serde(default)]
    pub between: Option<[f64; 2]>,
    /// Condition at which it was found.
    pub condition: String,
}
