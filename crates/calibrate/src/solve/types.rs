//! Input and result of a fit.

use std::fmt;

use nalgebra::DMatrix;

/// Knowledge of a parameter without the data: a normal distribution.
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
    /// Name in messages and tables.
    pub name: String,
    /// Value of the first start. At a bound or beyond it is moved inside by a hundredth of the range (CA-4).
    pub start: f64,
    /// Least value, finite.
    pub low: f64,
    /// Greatest value, finite and above `low`. Bounds more than three decades apart make the steps of the derivative coarse (CA-6).
    pub high: f64,
    /// Prior knowledge.
    pub prior: Option<Prior>,
}

impl Parameter {
    /// A parameter without prior.
    #[must_use]
    pub fn new(name: impl Into<String>, start: f64, low: f64, high: f64) -> Self {
        Parameter {
            name: name.into(),
            start,
            low,
            high,
            prior: None,
        }
    }

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
    /// Why the model has no result there. The fit rejects the step and goes on.
    fn at(&self, values: &[f64]) -> Result<Vec<f64>, String>;
}

/// Settings of the search.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Options {
    /// Number of starts, the given one included; 0 counts as 1.
    pub starts: usize,
    /// Seed of where the other starts are.
    pub seed: u64,
    /// Evaluations of the model after which a start ends; one Jacobian may go beyond it.
    pub max_evaluations: usize,
    /// Relative change of cost and of parameters, and cosine between residuals and columns of the Jacobian, at which a start ends. Below 1e-14
    /// it counts as 1e-14; below the model's own noise it costs evaluations and gains nothing.
    pub tolerance: f64,
}

/// How a start ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitEnd {
    /// Cost, parameters or angles changed by no more than the tolerance: a minimum, perhaps one of several.
    Converged,
    /// The evaluations of the start are spent. The best point so far may be far from a minimum.
    OutOfEvaluations,
    /// Stopped from outside. The best point so far is kept.
    Stopped,
    /// No further step, and no minimum: the model failed at the start, at the end of every next step, or on both sides of the point.
    Stalled,
}

/// One start and where it led.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Values at the start, inside the bounds.
    pub from: Vec<f64>,
    /// Best values found; those of `from` where the model has no result.
    pub to: Vec<f64>,
    /// Sum of squares at `to`, priors included (CA-7); infinite without a result.
    pub cost: f64,
    /// How it ended.
    pub end: FitEnd,
    /// Evaluations of the model.
    pub evaluations: usize,
    /// Reason of the model, where it failed at the start or the search stalled.
    pub failure: Option<String>,
}

/// A fit: the best of its starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Values of the parameters; exactly the bound where one limits the fit.
    pub values: Vec<f64>,
    /// Residuals of the data.
    pub residuals: Vec<f64>,
    /// (value - mean) / sd of each parameter that has a prior, in the order of the parameters.
    pub prior_residuals: Vec<f64>,
    /// Sum of squares of both (CA-7).
    pub cost: f64,
    /// Change of each residual of the data (row) by each parameter (column) at the solution, per own unit. NaN in a column where the model
    /// fails on either side, or where the fit was stopped before.
    pub jacobian: DMatrix<f64>,
    /// All starts, the given one first.
    pub starts: Vec<Start>,
    /// Index of the start that led here.
    pub best: usize,
    /// How that start ended.
    pub end: FitEnd,
    /// Evaluations of the model by all starts and for the last Jacobian.
    pub evaluations: usize,
}

/// The error of a fit without result.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Faults of the parameters, or why each start failed.
    pub reasons: Vec<String>,
    /// The starts; empty if the parameters have faults.
    pub starts: Vec<Start>,
}

impl FitEnd {
    /// Name in tables and files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            FitEnd::Converged => "converged",
            FitEnd::OutOfEvaluations => "out of evaluations",
            FitEnd::Stopped => "stopped",
            FitEnd::Stalled => "no progress",
        }
    }
}

impl Failure {
    /// True if a start was stopped before its first result: whether it has one is not known.
    #[must_use]
    pub fn is_stop(&self) -> bool {
        self.starts.iter().any(|start| start.end == FitEnd::Stopped)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reasons.join("; "))
    }
}

impl std::error::Error for Failure {}
