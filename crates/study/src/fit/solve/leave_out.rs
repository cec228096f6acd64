//! Fitted without a group of observations, compared with it: what a prediction is worth.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-19 | fold g: the fit to all residuals but those of group g, from the solution of all; then the residuals of group g at its values | source: cross-validation, Stone 1974 |

use rayon::prelude::*;

use super::ask::{Ask, Refusal};
use super::{End, Fit, Options, Parameter, Residuals, fit};
use crate::progress::Progress;

/// A group left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Fold {
    /// The group.
    pub group: usize,
    /// Values fitted without it.
    pub values: Vec<f64>,
    /// Residuals of its observations at these values, in the order of the observations: predicted, not fitted. Empty where the model has no
    /// answer.
    pub residuals: Vec<f64>,
    /// How the fit ended.
    pub end: End,
    /// What the model said, where it had no answer or no way on.
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
        let wrong = || {
            format!(
                "the model gives {} residuals in place of {}",
                all.len(),
                self.model.count()
            )
        };
        self.kept
            .iter()
            .map(|&i| all.get(i).copied().ok_or_else(wrong))
            .collect()
    }
}

/// One fold for each group that occurs, in ascending order (CA-19); `groups` has the group of each residual, a residual beyond its end has group 0.
/// Each fold starts at the solution only (moved off its bounds, CA-4), whatever `options.starts` says: it finds the minimum next to the
/// solution. With one group only nothing is left to fit to, and the fold says so.
#[must_use]
pub fn leave_out(
    model: &dyn Residuals,
    parameters: &[Parameter],
    groups: &[usize],
    solution: &Fit,
    options: &Options,
    progress: &dyn Progress,
) -> Vec<Fold> {
    let of = |i: usize| groups.get(i).copied().unwrap_or(0);
    let mut all: Vec<usize> = (0..model.count()).map(of).collect();
    all.sort_unstable();
    all.dedup();
    let parameters: Vec<Parameter> = parameters
        .iter()
        .zip(&solution.values)
        .map(|(p, x)| Parameter {
            start: *x,
            ..p.clone()
        })
        .collect();
    let options = Options {
        starts: 1,
        ..*options
    };
    let fold = |group: usize| {
        let without = Without {
            model,
            kept: (0..model.count()).filter(|i| of(*i) != group).collect(),
        };
        let none = |values, end, failure| Fold {
            group,
            values,
            residuals: Vec::new(),
            end,
            failure: Some(failure),
        };
        let fitted = match fit(&without, &parameters, &options, progress) {
            Ok(fitted) => fitted,
            Err(failure) => {
                let end = failure
                    .starts
                    .first()
                    .map_or(End::NoProgress, |start| start.end);
                return none(solution.values.clone(), end, failure.to_string());
            }
        };
        match Ask::new(model, progress).at(&fitted.values) {
            Ok(rows) => {
                let residuals = rows
                    .into_iter()
                    .enumerate()
                    .filter(|(i, _)| of(*i) == group)
                    .map(|(_, r)| r)
                    .collect(); // CA-19
                let failure = fitted.starts[fitted.best].failure.clone();
                Fold {
                    group,
                    values: fitted.values,
                    residuals,
                    end: fitted.end,
                    failure,
                }
            }
            Err(Refusal::Stopped) => none(fitted.values, End::Stopped, "stopped".into()),
            Err(Refusal::Model(why)) => none(fitted.values, fitted.end, why),
        }
    };
    all.into_par_iter().map(fold).collect()
}
