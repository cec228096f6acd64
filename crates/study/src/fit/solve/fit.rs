//! All starts, and the best of them.

use rayon::prelude::*;

use super::ask::Ask;
use super::descend::descend;
use super::point::prior_residuals;
use super::starts::starts;
use super::{End, Failure, Fit, Options, Parameter, Residuals, slope};
use crate::progress::Progress;

/// Fits the parameters: least squares of the residuals and of the priors between the bounds. Starts go in parallel, and so do the columns
/// of each Jacobian; the best start is the one of least cost, the earlier of equal ones.
///
/// # Errors
/// What is wrong with the parameters (all at once), or why no start gave an answer.
pub fn fit(
    model: &dyn Residuals,
    parameters: &[Parameter],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Fit, Failure> {
    let reasons = wrong(model, parameters);
    if !reasons.is_empty() {
        return Err(Failure {
            reasons,
            starts: Vec::new(),
        });
    }
    let from = starts(parameters, options.starts, options.seed);
    let descents: Vec<_> = from
        .into_par_iter()
        .map(|from| descend(&Ask::new(model, progress), parameters, options, from))
        .collect();
    let mut evaluations = descents
        .iter()
        .map(|descent| descent.start.evaluations)
        .sum();
    let (starts, points): (Vec<_>, Vec<_>) = descents
        .into_iter()
        .map(|descent| (descent.start, descent.best))
        .unzip();
    let found = points
        .into_iter()
        .enumerate()
        .filter_map(|(i, point)| point.map(|point| (i, point)));
    let Some((best, (point, jacobian))) =
        found.min_by(|(_, (a, _)), (_, (b, _))| a.cost.total_cmp(&b.cost))
    else {
        let reason = |(i, start): (usize, &super::Start)| {
            let values = parameters
                .iter()
                .zip(&start.from)
                .map(|(p, x)| format!("{} = {x}", p.name))
                .collect::<Vec<_>>()
                .join(", ");
            format!(
                "start {} at {values}: {}",
                i + 1,
                start.failure.as_deref().unwrap_or("no answer")
            )
        };
        return Err(Failure {
            reasons: starts.iter().enumerate().map(reason).collect(),
            starts,
        });
    };
    let end = starts[best].end;
    let jacobian = jacobian.unwrap_or_else(|| {
        // Who stops does not wait for derivatives.
        if end == End::Stopped {
            return nalgebra::DMatrix::from_element(point.rows.len(), parameters.len(), f64::NAN);
        }
        let ask = Ask::new(model, progress);
        let columns = slope::columns(&ask, parameters, &point.values, &point.rows);
        evaluations += ask.evaluations();
        slope::matrix_with_gaps(columns, point.rows.len())
    });
    let prior_residuals = prior_residuals(parameters, &point.values);
    Ok(Fit {
        values: point.values,
        residuals: point.rows,
        prior_residuals,
        cost: point.cost,
        jacobian,
        starts,
        best,
        end,
        evaluations,
    })
}

/// What is wrong with what was asked for.
fn wrong(model: &dyn Residuals, parameters: &[Parameter]) -> Vec<String> {
    let mut wrong = Vec::new();
    if parameters.is_empty() {
        wrong.push("no parameter is free: name at least one".to_string());
    }
    if model.count() == 0 {
        wrong.push("there is nothing to fit to: give at least one observation".to_string());
    }
    for p in parameters {
        if !(p.low.is_finite() && p.high.is_finite() && p.low < p.high && p.range().is_finite()) {
            wrong.push(format!(
                "{}: bounds are {} and {}; both must be finite, the low one below the high one",
                p.name, p.low, p.high
            ));
        }
        if !p.start.is_finite() {
            wrong.push(format!(
                "{}: the start is {}; it must be finite",
                p.name, p.start
            ));
        }
        if let Some(prior) = p
            .prior
            .filter(|prior| !(prior.mean.is_finite() && prior.sd.is_finite() && prior.sd > 0.0))
        {
            wrong.push(format!(
                "{}: the prior is {} with sd {}; both must be finite, the sd above 0",
                p.name, prior.mean, prior.sd
            ));
        }
    }
    wrong
}
