//! One descent of Levenberg and Marquardt in the transformed variables.
//!
//! Where the model fails, the step counts as one of enormous residuals: it is rejected, and the next is a tenth as long.

use std::cell::RefCell;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

use super::bounded;
use super::jacobian::jacobian;
use super::objective::{EvalError, Objective, Point, prior_residuals};
use super::types::{FitEnd, Options};

/// Residual in place of each where the model fails.
const REJECTED: f64 = 1e100;
/// Length of the first step by the length of the variables (MINPACK's `factor`).
const FIRST_STEP: f64 = 0.5;
/// Least tolerance: some dozens of roundings.
const MIN_TOLERANCE: f64 = 1e-14;

/// Result of a descent.
pub(super) struct Descent {
    /// Never worse than the first point.
    pub best: Point,
    /// Last Jacobian and the values at which it was computed.
    pub jacobian: Option<(Vec<f64>, DMatrix<f64>)>,
    pub end: FitEnd,
    /// Reason of the model at the last step, if that was rejected.
    pub rejected: Option<String>,
}

/// State that the solver's callbacks change.
struct State {
    best: Point,
    /// Point at the present variables; `None` before its evaluation and where that failed.
    here: Option<Point>,
    jacobian: Option<(Vec<f64>, DMatrix<f64>)>,
    halt: Option<FitEnd>,
    rejected: Option<String>,
}

struct Transformed<'a> {
    objective: &'a Objective<'a>,
    max_evaluations: usize,
    u: DVector<f64>,
    state: RefCell<State>,
}

impl Transformed<'_> {
    fn values(&self) -> Vec<f64> {
        let pairs = self.objective.parameters.iter().zip(&self.u);
        pairs.map(|(p, u)| bounded::outer(p, *u)).collect()
    }

    /// Rows of the data, of the priors, and zeros up to one for each parameter.
    fn height(&self) -> usize {
        let parameters = self.objective.parameters;
        let priors = parameters.iter().filter(|p| p.prior.is_some()).count();
        (self.objective.model.count() + priors).max(parameters.len())
    }

    fn stacked(&self, point: &Point) -> DVector<f64> {
        let priors = prior_residuals(self.objective.parameters, &point.values);
        let rows = point.residuals.iter().copied().chain(priors);
        let padded = rows.chain(std::iter::repeat(0.0));
        DVector::from_iterator(self.height(), padded.take(self.height()))
    }

    fn halt(&self, end: FitEnd) {
        self.state.borrow_mut().halt = Some(end);
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Transformed<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, u: &DVector<f64>) {
        self.u.copy_from(u);
        self.state.borrow_mut().here = None;
    }

    fn params(&self) -> DVector<f64> {
        self.u.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        if let Some(point) = &self.state.borrow().here {
            return Some(self.stacked(point));
        }
        if self.objective.evaluations() >= self.max_evaluations {
            self.halt(FitEnd::OutOfEvaluations);
            return None;
        }
        match self.objective.at(self.values()) {
            Ok(point) => {
                let stacked = self.stacked(&point);
                let mut state = self.state.borrow_mut();
                if point.cost < state.best.cost {
                    state.best = point.clone();
                }
                (state.here, state.rejected) = (Some(point), None);
                Some(stacked)
            }
            Err(EvalError::Stopped) => {
                self.halt(FitEnd::Stopped);
                None
            }
            Err(EvalError::Model(why)) => {
                self.state.borrow_mut().rejected = Some(why);
                Some(DVector::from_element(self.height(), REJECTED))
            }
        }
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let point = self.state.borrow().here.clone()?;
        let parameters = self.objective.parameters;
        if self.objective.evaluations() + 2 * parameters.len() > self.max_evaluations {
            self.halt(FitEnd::OutOfEvaluations);
            return None;
        }
        let data = match jacobian(self.objective, &point) {
            Ok(data) => data,
            Err(EvalError::Stopped) => {
                self.halt(FitEnd::Stopped);
                return None;
            }
            Err(EvalError::Model(why)) => {
                self.halt(FitEnd::Stalled);
                self.state.borrow_mut().rejected = Some(why);
                return None;
            }
        };
        let mut stacked = DMatrix::zeros(self.height(), parameters.len());
        stacked.rows_mut(0, data.nrows()).copy_from(&data);
        let mut row = data.nrows();
        for (k, (p, u)) in parameters.iter().zip(&self.u).enumerate() {
            if let Some(prior) = p.prior {
                stacked[(row, k)] = 1.0 / prior.sd;
                row += 1;
            }
            let slope = bounded::slope(p, *u, point.values[k]);
            stacked.column_mut(k).scale_mut(slope);
        }
        self.state.borrow_mut().jacobian = Some((point.values, data));
        Some(stacked)
    }
}

/// One descent from a point.
pub(super) fn descend(objective: &Objective, options: &Options, from: Point) -> Descent {
    let parameters = objective.parameters;
    let variables = parameters.iter().zip(&from.values);
    let u = variables.map(|(p, x)| bounded::inner(p, *x));
    let problem = Transformed {
        objective,
        max_evaluations: options.max_evaluations,
        u: DVector::from_iterator(parameters.len(), u),
        state: RefCell::new(State {
            best: from.clone(),
            here: Some(from),
            jacobian: None,
            halt: None,
            rejected: None,
        }),
    };
    let tolerance = options.tolerance.max(MIN_TOLERANCE);
    // The limit is checked above, where the evaluations of Jacobians are counted too.
    let patience = options
        .max_evaluations
        .clamp(1, usize::MAX / (parameters.len() + 2));
    let (problem, report) = LevenbergMarquardt::new()
        .with_ftol(tolerance)
        .with_xtol(tolerance)
        .with_gtol(tolerance)
        .with_stepbound(FIRST_STEP)
        .with_patience(patience)
        .minimize(problem);
    let state = problem.state.into_inner();
    let end = state.halt.unwrap_or(match report.termination {
        // The steps became short because the model failed at the ends of all longer ones.
        TerminationReason::Converged { ftol: false, .. } if state.rejected.is_some() => {
            FitEnd::Stalled
        }
        reason if reason.was_successful() => FitEnd::Converged,
        TerminationReason::LostPatience => FitEnd::OutOfEvaluations,
        _ => FitEnd::Stalled,
    });
    Descent {
        best: state.best,
        jacobian: state.jacobian,
        end,
        rejected: state.rejected,
    }
}
