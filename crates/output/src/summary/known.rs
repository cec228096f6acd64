//! External knowledge of a result: its uncertainty, and the published numbers that it contradicts.

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
    /// Pairs in which the subject uses more.
    pub more: u64,
    /// Quantiles 0.05, 0.5 and 0.95 of the difference, per cent.
    pub percent: [f64; 3],
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
