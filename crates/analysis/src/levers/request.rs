//! Request for a lever study, and descriptions of the columns of its table.

use super::Lever;
use super::combine::Combine;
use crate::draws::OtherCar;
use cvtcycle_config::Override;
use cvtcycle_config::setup::Options;
use cvtcycle_study::plan::Plan;
use serde::{Deserialize, Serialize};

/// Cars, levers and conditions of a lever study.
#[derive(Clone, Debug)]
pub struct LeverRequest {
    /// Levers, in the order of their files.
    pub levers: Vec<Lever>,
    /// Cars, names or paths.
    pub vehicles: Vec<String>,
    /// Ambient temperatures, degC.
    pub ambients_degc: Vec<f64>,
    /// Cycle, name or path.
    pub cycle: String,
    /// `soak`, `warm` or a temperature in degC.
    pub start: String,
    /// Largest step, s.
    pub dt_s: f64,
    /// Oils and overrides of the vehicles.
    pub base: Options,
    /// Those of the overrides that baselines have as well.
    pub set_all: Vec<Override>,
    /// Cars that are driven with the draws of the first vehicle, to be compared with it.
    pub others: Vec<OtherCar>,
    /// Plan whose factors are drawn, number of draws and seed; none for the cars as their files have them.
    pub draws: Option<(Plan, u64, u64)>,
    /// Combinations.
    pub combine: Combine,
    /// Engine speed, rpm, below which a loaded engine behind a closed clutch is heard and felt.
    pub heard_rpm: f64,
}

/// Description of the columns of a lever study.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LeverNotes {
    /// Name of the plan whose factors are drawn; none without draws.
    pub plan: Option<String>,
    /// Engine speed below which a loaded engine behind a closed clutch is heard and felt, rpm.
    pub heard_rpm: f64,
    /// In the order of the cars of the table.
    pub columns: Vec<ColumnNote>,
    /// Notes for the reader, a sentence each.
    pub notes: Vec<String>,
}

/// Description of a column.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ColumnNote {
    /// Name of the car.
    pub vehicle: String,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// `reference`, `lever`, `combination` or the name of an [`OtherKind`](crate::draws::OtherKind).
    pub kind: String,
    /// Name of the lever.
    pub name: String,
    /// Name for tables.
    pub title: String,
    /// The column that it is compared with; its own one of a reference.
    pub reference: usize,
    /// Levers of a combination.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub members: Vec<String>,
    /// Overrides of the car.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// Factors that are left out of its draw and of that of its reference.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub left_out: Vec<String>,
    /// Group; empty without one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub group: String,
    /// Requirements; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub needs: String,
    /// How its size is known.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub status: String,
    /// Reason or reference.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub source: String,
}
