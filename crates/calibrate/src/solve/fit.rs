//! All starts, and the best of them.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::jacobian::jacobian_with_gaps;
use super::objective::{Objective, prior_residuals};
use super::search::search;
use super::starts::starts;
use super::types::{Failure, Fit, FitEnd, Options, Parameter, Prior, Residuals, Start};
use cvtcycle_output::progress::Progress;

/// Fits the parameters: least squares of the residuals and of the priors between the bounds. Starts run in parallel, and so do the
/// columns of each Jacobian; the best start is the one of least cost, the earlier of equal ones.
///
/// # Errors
/// All faults of the parameters, or why no start had a result.
pub fn fit(
    model: &dyn Residuals,
    parameters: &[Parameter],
    options: &Options,
    progress: &dyn Progress,
) -> Result<Fit, Failure> {
    let reasons = faults(model, parameters);
    if !reasons.is_empty() {
        let starts = Vec::new();
        return Err(Failure { reasons, starts });
    }
    let objective = || Objective::new(model, parameters, progress);
    let (starts, points): (Vec<_>, Vec<_>) = starts(parameters, options.starts, options.seed)
        .into_par_iter()
        .map(|from| search(&objective(), options, from))
        .map(|search| (search.start, search.best))
        .unzip();
    let mut evaluations = starts.iter().map(|start| start.evaluations).sum();
    let found = points.into_iter().enumerate();
    let found = found.filter_map(|(i, point)| point.map(|point| (i, point)));
    let Some((best, (point, jacobian))) =
        found.min_by(|(_, (a, _)), (_, (b, _))| a.cost.total_cmp(&b.cost))
    else {
        return Err(without_result(parameters, starts));
    };
    let end = starts[best].end;
    let jacobian = jacobian.unwrap_or_else(|| {
        // After a stop there are no more evaluations.
        if end == FitEnd::Stopped {
            return DMatrix::from_element(point.residuals.len(), parameters.len(), f64::NAN);
        }
        let objective = objective();
        let jacobian = jacobian_with_gaps(&objective, &point);
        evaluations += objective.evaluations();
        jacobian
    });
    Ok(Fit {
        prior_residuals: prior_residuals(parameters, &point.values),
        values: point.values,
        residuals: point.residuals,
        cost: point.cost,
        jacobian,
        starts,
        best,
        end,
        evaluations,
    })
}

fn without_result(parameters: &[Parameter], starts: Vec<Start>) -> Failure {
    let reason = |(i, start): (usize, &Start)| {
        let pairs = parameters.iter().zip(&start.from);
        let values = pairs.map(|(p, x)| format!("{} = {x}", p.name));
        let values = values.collect::<Vec<_>>().join(", ");
        let why = start.failure.as_deref().unwrap_or("no answer");
        format!("start {} at {values}: {why}", i + 1)
    };
    let reasons = starts.iter().enumerate().map(reason).collect();
    Failure { reasons, starts }
}

/// Faults of the problem, one sentence each.
fn faults(model: &dyn Residuals, parameters: &[Parameter]) -> Vec<String> {
    let mut faults = Vec::new();
    if parameters.is_empty() {
        faults.push("no parameter is free: name at least one".to_string());
    }
    if model.count() == 0 {
        faults.push("there is nothing to fit to: give at least one observation".to_string());
    }
    let mut check = |holds: bool, name: &str, fault: String| {
        if !holds {
            faults.push(format!("{name}: {fault}"));
        }
    };
    for p in parameters {
        let (low, high, start) = (p.low, p.high, p.start);
        let bounded = low.is_finite() && high.is_finite() && low < high && p.range().is_finite();
        let fault = "both must be finite, the low one below the high one";
        check(
            bounded,
            &p.name,
            format!("bounds are {low} and {high}; {fault}"),
        );
        check(
            start.is_finite(),
            &p.name,
            format!("the start is {start}; it must be finite"),
        );
        if let Some(Prior { mean, sd }) = p.prior {
            let known = mean.is_finite() && sd.is_finite() && sd > 0.0;
            let fault = "both must be finite, the sd above 0";
            check(
                known,
                &p.name,
                format!("the prior is {mean} with sd {sd}; {fault}"),
            );
        }
    }
    faults
}
