//! Fit without a group of observations, compared with it: the error of a prediction.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-19 | fold g: the fit to all residuals but those of group g, from the solution of all; then the residuals of group g at its values | source: cross-validation, Stone 1974 |

use rayon::prelude::*;

use super::fit::fit;
use super::jacobian::jacobian;
use super::objective::{EvalError, Objective, wrong_count};
use super::starts::starts;
use super::types::{Fit, FitEnd, Options, Parameter, Residuals};
use cvtcycle_output::progress::Progress;

/// A group left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Fold {
    /// The group.
    pub group: usize,
    /// Values fitted without it.
    pub values: Vec<f64>,
    /// Residuals of its observations at these values, in the order of the observations: predicted, not fitted. Empty where the model
    /// has no result.
    pub residuals: Vec<f64>,
    /// How the fit ended.
    pub end: FitEnd,
    /// Reason of the model, where it failed or the search stalled.
    pub failure: Option<String>,
}

/// The model without a group.
struct Without<'a> {
    model: &'a dyn Residuals,
    kept: Vec<usize>,
}

impl Residuals for Without<'_> {
    fn count(&self) -> usize {
        self.kept.len()
    }

    fn at(&self, values: &[f64]) -> Result<Vec<f64>, String> {
        let all = self.model.at(values)?;
        let kept = self.kept.iter().map(|&i| all.get(i).copied());
        kept.collect::<Option<_>>()
            .ok_or_else(|| wrong_count(all.len(), self.model.count()))
    }
}

/// Evaluates the model where all folds begin, and for their first Jacobian: a model that knows what it has computed has it ready for each of
/// them, and no two threads wait for the same numbers. Whatever fails here fails in the folds.
fn meet(objective: &Objective) {
    let first = starts(objective.parameters, 1, 0).swap_remove(0);
    if let Ok(point) = objective.at(first) {
        let _ = jacobian(objective, &point);
    }
}

/// One fold for each group, in ascending order (CA-19); `groups` has the group of each residual, a residual beyond its end has group 0.
/// Each fold starts at the solution only (moved off its bounds, CA-4), whatever `options.starts` says: it finds the minimum next to the
/// solution. With one group only there is nothing left to fit to, and the fold has that failure.
#[must_use]
pub fn leave_out(
    model: &dyn Residuals,
    parameters: &[Parameter],
    groups: &[usize],
    solution: &Fit,
    options: &Options,
    progress: &dyn Progress,
) -> Vec<Fold> {
    let group_of = |i: usize| groups.get(i).copied().unwrap_or(0);
    let mut all: Vec<usize> = (0..model.count()).map(group_of).collect();
    all.sort_unstable();
    all.dedup();
    let mut parameters = parameters.to_vec();
    for (p, x) in parameters.iter_mut().zip(&solution.values) {
        p.start = *x;
    }
    let options = Options {
        starts: 1,
        ..*options
    };
    meet(&Objective::new(model, &parameters, progress));
    let fold = |group: usize| {
        let kept = (0..model.count()).filter(|i| group_of(*i) != group);
        let kept = kept.collect();
        let mut fold = Fold {
            group,
            values: solution.values.clone(),
            residuals: Vec::new(),
            end: FitEnd::Stalled,
            failure: None,
        };
        match fit(&Without { model, kept }, &parameters, &options, progress) {
            Err(failure) => {
                fold.end = failure.starts.first().map_or(fold.end, |start| start.end);
                fold.failure = Some(failure.to_string());
                return fold;
            }
            Ok(fitted) => {
                (fold.values, fold.end) = (fitted.values, fitted.end);
                fold.failure = fitted.starts[fitted.best].failure.clone();
            }
        }
        match Objective::new(model, &parameters, progress).residuals(&fold.values) {
            Ok(rows) => {
                let own = rows.into_iter().enumerate();
                let own = own.filter(|(i, _)| group_of(*i) == group);
                fold.residuals = own.map(|(_, r)| r).collect(); // CA-19
            }
            Err(EvalError::Stopped) => {
                (fold.end, fold.failure) = (FitEnd::Stopped, Some("stopped".into()));
            }
            Err(EvalError::Model(why)) => fold.failure = Some(why),
        }
        fold
    };
    all.into_par_iter().map(fold).collect()
}
