//! Prices of a car's losses: fuel saved by reducing them.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::Named;

/// Price of each loss, of all together, and their interaction (AT-1 to AT-6).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PriceSummary {
    /// Factor on each loss in turn; 0 removes it.
    pub factor: f64,
    /// Prices by component, without components that lose nothing.
    pub losses: IndexMap<String, LossPrice>,
    /// All losses at once (AT-2).
    pub together: Saving,
    /// Difference between all losses at once and the sum of the parts (AT-3).
    pub interaction: Saving,
    /// Pairs of losses; empty unless requested.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<PairPrice>,
    /// Shares of groups in the whole price (AT-6); empty unless requested.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub groups: IndexMap<String, Saving>,
    /// Notes for readers of these numbers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Checks that fail in a changed car and not in the car itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<String>,
}

/// Fuel that is saved; null without distance.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Saving {
    /// Share of the car's headline fuel.
    pub l_per_100km: Option<f64>,
    /// Saving, per cent of that fuel.
    pub percent: Option<f64>,
    /// By group of phases, L/100 km of the group.
    pub phases: Named,
}

/// Price of one loss.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LossPrice {
    /// Group whose share includes it.
    pub group: String,
    /// Energy lost.
    pub loss_kj: Option<f64>,
    /// That energy, per cent of the fuel's.
    pub energy_percent: Option<f64>,
    /// Fuel that is saved with the factor on this loss (AT-1).
    #[serde(flatten)]
    pub saved: Saving,
    /// Quantiles 0.05 and 0.95 of the saving over the draws of what is uncertain, per cent; absent where none were driven.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub range: Option<[f64; 2]>,
    /// Fuel that it adds to a car that has the factor on all losses (AT-5); absent unless requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub alone: Option<Saving>,
}

/// Two losses, one after the other (AT-4).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PairPrice {
    /// The first loss.
    pub a: String,
    /// The second one.
    pub b: String,
    /// Saving of both at once beyond the sum of each.
    pub interaction: Saving,
    /// Price of the first in the car as it is, L/100 km.
    pub a_with_b: Option<f64>,
    /// Price of the first with the factor on the second, L/100 km.
    pub a_without_b: Option<f64>,
    /// Price of the second in the car as it is, L/100 km.
    pub b_with_a: Option<f64>,
    /// Price of the second with the factor on the first, L/100 km.
    pub b_without_a: Option<f64>,
}
