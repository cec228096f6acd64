//! What is known of a result from elsewhere: how sure it is, and which published number it contradicts.

use serde::{Deserialize, Serialize};

/// A difference of fuel over the draws of a plan of uncertainty, for this very case.
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
    /// Baseline of the difference; none for the fuel of the subject itself.
    pub baseline: Option<String>,
    /// Group of phases; none for the whole cycle.
    pub phase: Option<String>,
    /// The number of this run, in `unit`.
    pub computed: f64,
    /// Its unit.
    pub unit: String,
    /// The published text.
    pub printed: String,
    /// The published numbers, from the smallest to the largest, in the same unit; none in files of an earlier version.
    #[serde(default)]
    pub between: Option<[f64; 2]>,
    /// At which condition it was found.
    pub condition: String,
}
