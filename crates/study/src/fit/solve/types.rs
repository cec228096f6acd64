//! What goes into a fit and what comes out of it.

use std::fmt;

use nalgebra::DMatrix;

/// What is known of a parameter without the data: a normal distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// Mean, in the parameter's unit.
    pub mean: f64,
    /// Standard deviation, in the parameter's unit; above 0.
    pub sd: f64,
}

/// A parameter to be fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name as people know it.
    pub name: String,
    /// Value of the first start. At a bound or beyond it is moved inside by a hundredth of the range (CA-4).
    pub start: f64,
    /// Least value, finite.
    pub low: f64,
    /// Greatest value, finite and above `low`. Bounds more than three decades apart make the steps of the derivative coarse (CA-6).
    pub high: f64,
    /// What is known beforehand.
    pub prior: Option<Prior>,
}

impl Parameter {
    /// Distance between the bounds.
    #[must_use]
    pub fn range(&self) -> f64 {
        self.high - self.low
    }
}

/// The model and its data.
pub trait Residuals: Sync {
    /// Number of residuals, always the same.
    fn count(&self) -> usize;

    /// (computed - measured) / standard deviation of each observation at these values, which are in the parameters' own units.
    ///
    /// # Errors
    /// Why the model has no answer there. The fit refuses the step and goes on.
    fn at(&self, values: &[f64]) -> Result<Vec<f64>, String>;
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Number of starts, the given one included; 0 counts as 1.
    pub starts: usize,
    /// Seed of where the other starts are.
    pub seed: u64,
    /// Evaluations of the model after which a start ends; one Jacobian may go beyond it.
    pub most_evaluations: usize,
    /// Relative change of cost and of parameters, and cosine between residuals and columns of the Jacobian, at which a start ends. Below 1e-14
    /// it counts as 1e-14; below the model's own noise it costs evaluations and gains nothing.
    pub tolerance: f64,
}

/// How a start ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Cost, parameters or angles changed by no more than the tolerance: a minimum, perhaps one of several.
    Converged,
    /// The evaluations of the start are spent. The best point so far may be far from a minimum.
    OutOfEvaluations,
    /// Stopped by the caller. The best point so far is kept.
    Stopped,
    /// No way on, and no minimum: the model failed at the start, or wherever the next step led, or on both sides of the point.
    NoProgress,
}

/// One start and where it led.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Values at the start, inside the bounds.
    pub from: Vec<f64>,
    /// Best values found; those of `from` where the model gave no answer.
    pub to: Vec<f64>,
    /// Sum of squares at `to`, priors included (CA-7); infinite without an answer.
    pub cost: f64,
    /// How it ended.
    pub end: End,
    /// Evaluations of the model.
    pub evaluations: usize,
    /// What the model said, where it had no answer at the start or no way on.
    pub failure: Option<String>,
}

/// A fit: the best of its starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Values of the parameters; exactly a bound where it holds the fit.
    pub values: Vec<f64>,
    /// Residuals of the data.
    pub residuals: Vec<f64>,
    /// (value - mean) / sd of each parameter that has a prior, in the order of the parameters.
    pub prior_residuals: Vec<f64>,
    /// Sum of squares of both (CA-7).
    pub cost: f64,
    /// Change of each residual of the data (row) by each parameter (column) at the solution, per own unit. NaN in a column where the model has
    /// no answer on either side, or where the fit was stopped before.
    pub jacobian: DMatrix<f64>,
    /// All starts, the given one first.
    pub starts: Vec<Start>,
    /// Index of the start that led here.
    pub best: usize,
    /// How that start ended.
    pub end: End,
    /// Evaluations of the model by all starts and for the last Jacobian.
    pub evaluations: usize,
}

/// No start gave an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// What is wrong with the parameters, or why each start failed.
    pub reasons: Vec<String>,
    /// The starts, where there were any.
    pub starts: Vec<Start>,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reasons.join("; "))
    }
}

impl std::error::Error for Failure {}
