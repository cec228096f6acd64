//! Numbers of a sample that need no order.

use serde::Serialize;

/// Statistics that need no sorting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Number of values.
    pub n: usize,
    /// Number of cells without a value.
    pub missing: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of the population, from n - 1; NaN of fewer than two values.
    pub sd: f64,
    /// Least value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}
