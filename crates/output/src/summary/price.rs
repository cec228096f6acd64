//! What the losses of a car cost: fuel that would be saved with less of them.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::Named;

/// Price of each loss, of all together, and what the parts do not add up to (AT-1 to AT-6).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PriceSummary {
    /// Factor on each loss in turn: 0 is without it.
    pub factor: f64,
    /// By component; without those that lose nothing.
    pub losses: IndexMap<String, LossPrice>,
    /// All losses at once (AT-2).
    pub together: Saving,
    /// What the parts do not add up to (AT-3).
    pub interaction: Saving,
    /// Pairs of losses; empty where none was asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<PairPrice>,
    /// The whole price shared out over groups (AT-6); empty where it was not asked for.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub groups: IndexMap<String, Saving>,
    /// What a reader of these numbers should know.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Checks that a changed car fails and the car itself does not.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<String>,
}

/// Fuel that is saved; null without distance.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Saving {
    /// Of the headline fuel of the car.
    pub l_per_100km: Option<f64>,
    /// The same, per cent of that fuel.
    pub percent: Option<f64>,
    /// By group of phases, L/100 km of the group.
    pub phases: Named,
}

/// Price of one loss.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LossPrice {
    /// Group with which it is shared out.
    pub group: String,
    /// Energy that it takes.
    pub loss_kj: Option<f64>,
    /// That energy, per cent of the fuel's.
    pub energy_percent: Option<f64>,
    /// Fuel that is saved with the factor on this loss (AT-1).
    #[serde(flatten)]
    pub saved: Saving,
    /// Fuel that it adds to a car that has the factor on all losses (AT-5); absent where it was not asked for.
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
    /// What both at once save more than each by itself.
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
