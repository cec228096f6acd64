//! Values, the model's answer there, and its cost.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-7 | cost = sum of r^2 + sum of ((x - mean) / sd)^2 over the parameters with a prior | derived: -2 log of the posterior density but for a constant |

use super::Parameter;

/// Values with the model's answer.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub values: Vec<f64>,
    pub rows: Vec<f64>,
    pub cost: f64,
}

impl Point {
    pub fn new(parameters: &[Parameter], values: Vec<f64>, rows: Vec<f64>) -> Point {
        let squares = |x: &[f64]| x.iter().map(|r| r * r).sum::<f64>();
        let cost = squares(&rows) + squares(&prior_residuals(parameters, &values)); // CA-7
        Point { values, rows, cost }
    }
}

/// (value - mean) / sd of the parameters that have a prior.
pub(super) fn prior_residuals(parameters: &[Parameter], values: &[f64]) -> Vec<f64> {
    parameters
        .iter()
        .zip(values)
        .filter_map(|(p, x)| p.prior.map(|prior| (x - prior.mean) / prior.sd))
        .collect()
}
