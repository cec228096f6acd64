//! Objective of the fit: residuals of the data and of the priors, evaluations counted, results checked, a stop obeyed.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-1 | an evaluation with another number of residuals, or with a residual that is not finite, has failed | ASSUMED |
//! | CA-7 | cost = sum of r^2 + sum of ((x - mean) / sd)^2 over the parameters with a prior | derived: -2 log of the posterior density but for a constant |

use std::sync::atomic::{AtomicUsize, Ordering};

use super::types::{Parameter, Residuals};
use cvtcycle_output::progress::Progress;

/// Reason for an evaluation without result.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum EvalError {
    Stopped,
    Model(String),
}

/// Values with the residuals of the data and the cost there.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub values: Vec<f64>,
    pub residuals: Vec<f64>,
    pub cost: f64,
}

/// Model, parameters and priors, with a count of the evaluations.
pub(super) struct Objective<'a> {
    pub model: &'a dyn Residuals,
    pub parameters: &'a [Parameter],
    progress: &'a dyn Progress,
    count: AtomicUsize,
}

impl<'a> Objective<'a> {
    pub fn new(
        model: &'a dyn Residuals,
        parameters: &'a [Parameter],
        progress: &'a dyn Progress,
    ) -> Self {
        Objective {
            model,
            parameters,
            progress,
            count: AtomicUsize::new(0),
        }
    }

    /// Evaluations so far.
    pub fn evaluations(&self) -> usize {
        self.count.load(Ordering::Relaxed)
    }

    /// Residuals of the data (CA-1).
    pub fn residuals(&self, values: &[f64]) -> Result<Vec<f64>, EvalError> {
        if self.progress.stopped() {
            return Err(EvalError::Stopped);
        }
        self.count.fetch_add(1, Ordering::Relaxed);
        let result = self.model.at(values);
        self.progress.advance(1);
        let residuals = result.map_err(EvalError::Model)?;
        let fault = if residuals.len() == self.model.count() {
            let bad = residuals.iter().position(|r| !r.is_finite());
            bad.map(|i| format!("residual {} is {}", i + 1, residuals[i]))
        } else {
            Some(wrong_count(residuals.len(), self.model.count()))
        };
        fault.map_or(Ok(residuals), |why| Err(EvalError::Model(why))) // CA-1
    }

    /// Residuals and cost.
    pub fn at(&self, values: Vec<f64>) -> Result<Point, EvalError> {
        let residuals = self.residuals(&values)?;
        let squares = |x: &[f64]| x.iter().map(|r| r * r).sum::<f64>();
        let cost = squares(&residuals) + squares(&prior_residuals(self.parameters, &values)); // CA-7
        if !cost.is_finite() {
            let why = "the sum of squares is not finite".to_owned();
            return Err(EvalError::Model(why));
        }
        Ok(Point {
            values,
            residuals,
            cost,
        })
    }
}

/// Message for a wrong number of residuals.
pub(super) fn wrong_count(found: usize, expected: usize) -> String {
    format!("the model gives {found} residuals in place of {expected}")
}

/// (value - mean) / sd of the parameters that have a prior.
pub(super) fn prior_residuals(parameters: &[Parameter], values: &[f64]) -> Vec<f64> {
    let pairs = parameters.iter().zip(values);
    let residual = |(p, x): (&Parameter, &f64)| p.prior.map(|prior| (x - prior.mean) / prior.sd);
    pairs.filter_map(residual).collect()
}
