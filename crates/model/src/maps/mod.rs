//! Measured maps that replace models.

mod bsfc;
mod fuel_table;
mod judge;
mod loss;

pub use bsfc::{BsfcMap, Origin};
pub use fuel_table::{Basis, Fuel, FuelRow, FuelTable, Load, Point, Swept};
pub use judge::Verdict;
pub use loss::{LossMap, MapPoint, Scatter};

/// Why rows are no map: what is allowed, what is wrong, what helps.
#[derive(Clone, Debug, PartialEq)]
pub struct NoMap {
    /// Accepted values.
    pub allowed: String,
    /// Problem, one sentence.
    pub message: String,
    /// Remedy.
    pub hint: String,
}

impl NoMap {
    pub(crate) fn new(allowed: &str, message: String, hint: &str) -> Self {
        NoMap {
            allowed: allowed.to_owned(),
            message,
            hint: hint.to_owned(),
        }
    }
}
