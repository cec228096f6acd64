//! A plan to its outcome.

use super::model::{Model, Prediction};
use super::outcome::{self, Direction, Fold, Outcome, Residual, Start, rms};
use super::plan::{CalibrationPlan, Measured, Observable};
use super::solve::{self, Bound, Failure, Fit, FitEnd, Options, Uncertainty};
use crate::progress::Progress;
use cvtcycle_config::{Problem, Problems};

/// Probability of the sum of squares below which there is a warning.
const UNLIKELY: f64 = 0.01;
/// A start within this share of the least cost found the same minimum.
const SAME_COST: f64 = 1e-3;
/// Distance from its prior, in its standard deviations, above which there is a warning.
const FAR: f64 = 3.0;

/// Fits the parameters of a plan, and says what the fit is worth.
///
/// # Errors
/// What is wrong with the plan's vehicle, keys, bounds and sources; a problem if the model has no answer at any start.
pub fn calibrate(plan: &CalibrationPlan, progress: &dyn Progress) -> Result<Outcome, Problems> {
    let model = Model::new(plan)?;
    let search = &plan.search;
    let options = Options {
        starts: search.starts,
        seed: search.seed,
        max_evaluations: search.max_evaluations,
        tolerance: search.tolerance,
    };
    let fit = solve::fit(&model, model.parameters(), &options, progress)
        .map_err(|failure| problems_of(failure, plan))?;
    let folds = if search.leave_out && plan.folds.len() > 1 && fit.end != FitEnd::Stopped {
        let groups: Vec<usize> = plan
            .observations
            .iter()
            .map(|observation| observation.fold)
            .collect();
        solve::leave_out(
            &model,
            model.parameters(),
            &groups,
            &fit,
            &options,
            progress,
        )
    } else {
        Vec::new()
    };
    Ok(Found {
        uncertainty: solve::uncertainty(&fit, model.parameters()),
        model: &model,
        fit,
        folds,
    }
    .outcome())
}

/// Each cause of a fit without result once, whatever the number of starts with it.
fn problems_of(failure: Failure, plan: &CalibrationPlan) -> Problems {
    if failure.is_stop() {
        return Problem::stopped("stopped before the model gave an answer").into();
    }
    let mut causes = failure.reasons;
    if !failure.starts.is_empty() {
        let starts = failure.starts.into_iter();
        causes = starts.filter_map(|start| start.failure).collect();
    }
    causes.sort();
    causes.dedup();
    let hint = "leave out data where the model has no number; the first start is at the values of the files";
    let problem = |why: String| {
        Problem::failed(format!("the model has no answer: {why}"))
            .at(plan.place.clone())
            .hint(hint)
    };
    causes.into_iter().map(problem).collect()
}

/// A finished fit with its model.
struct Found<'m> {
    model: &'m Model<'m>,
    fit: Fit,
    uncertainty: Uncertainty,
    folds: Vec<solve::Fold>,
}

impl Found<'_> {
    fn outcome(&self) -> Outcome {
        let (fit, u) = (&self.fit, &self.uncertainty);
        let file_values = self.model.file_values();
        let before = self.model.predict(&file_values).ok();
        let residuals = self.residuals(before.as_ref(), &file_values);
        let parameters = self.parameters(&file_values);
        let best_first = u.directions.iter().rev();
        let directions = best_first.map(|d| Direction {
            singular_value: d.singular_value,
            weights: d.weights.clone(),
        });
        let mut outcome = Outcome {
            end: fit.end.name().to_owned(),
            converged: fit.end == FitEnd::Converged,
            cost_before: cost_before(&residuals, &parameters),
            cost_after: fit.cost,
            chi2: sum_of_squares(fit.residuals.iter().copied()),
            degrees_of_freedom: u.degrees_of_freedom,
            chi2_probability: u.chi2_probability,
            parameters,
            folds: self.folds_of(&residuals),
            residuals,
            correlation: matrix(&u.correlation),
            covariance: matrix(&u.covariance),
            directions: directions.collect(),
            not_identified: solve::not_identified(fit, self.model.parameters()),
            starts: fit.starts.iter().map(start).collect(),
            evaluations: fit.evaluations,
            ..Outcome::of_plan(self.model.plan())
        };
        outcome.warnings = warnings(&outcome);
        outcome
    }

    fn parameters(&self, file_values: &[f64]) -> Vec<outcome::Parameter> {
        let (plan, u) = (self.model.plan(), &self.uncertainty);
        let units = self.model.units();
        let one = |(k, p): (usize, &solve::Parameter)| {
            let own = plan.parameters.get(k);
            outcome::Parameter {
                name: p.name.clone(),
                is_key: own.is_some(),
                unit: units[k].clone(),
                file_value: file_values[k],
                value: self.fit.values[k],
                standard_error: u.standard_error[k],
                low: p.low,
                high: p.high,
                prior: p.prior.map(|prior| [prior.mean, prior.sd]),
                prior_status: own.map_or_else(|| "assumed".to_owned(), |free| free.status.clone()),
                source: own.map_or_else(
                    || "one error for all data of the group".to_owned(),
                    |free| free.source.clone(),
                ),
                prior_share: u.prior_share[k],
                at_bound: u.at_bound[k]
                    .map(|bound| if bound == Bound::Low { "low" } else { "high" }),
                is_dead: u.dead.contains(&k),
            }
        };
        self.model
            .parameters()
            .iter()
            .enumerate()
            .map(one)
            .collect()
    }

    fn residuals(&self, before: Option<&Prediction>, file_values: &[f64]) -> Vec<Residual> {
        let plan = self.model.plan();
        // The model has a result at the end of the fit.
        let after = self.model.predict(&self.fit.values).unwrap_or_default();
        let left_out = self.left_out();
        let before_distances =
            before.map(|answer| self.model.distances(&answer.computed, file_values));
        let one = |(k, o): (usize, &super::plan::Observation)| {
            let (low, high) = match o.measured {
                Measured::Value(x) => (x, x),
                Measured::Within(low, high) => (low, high),
            };
            Residual {
                group: plan.groups[o.group].name.clone(),
                fold: plan.folds[o.fold].clone(),
                label: o.label.clone(),
                what: o.what.clone(),
                column: o.column.clone(),
                time_s: if let Observable::Trace { time_s, .. } = o.observable {
                    Some(time_s)
                } else {
                    None
                },
                unit: o.unit.clone(),
                low: low.is_finite().then_some(low),
                high: high.is_finite().then_some(high),
                sd: o.sd,
                weight_sd: o.weight_sd,
                before: before.map(|answer| answer.computed[k]),
                after: after.computed.get(k).copied().unwrap_or(f64::NAN),
                left_out: left_out[k].0,
                before_sd: before_distances.as_ref().map(|list| list[k] / o.weight_sd),
                after_sd: self.fit.residuals[k],
                left_out_sd: left_out[k].1,
                doubtful: after.doubtful.get(k).copied().unwrap_or(0),
            }
        };
        plan.observations.iter().enumerate().map(one).collect()
    }

    /// Prediction of each observation by the fit without its fold, and its residual.
    fn left_out(&self) -> Vec<(Option<f64>, Option<f64>)> {
        let plan = self.model.plan();
        let mut all = vec![(None, None); plan.observations.len()];
        for fold in &self.folds {
            let Ok(answer) = self.model.predict(&fold.values) else {
                continue;
            };
            let own = (0..all.len()).filter(|k| plan.observations[*k].fold == fold.group);
            for (k, residual) in own.zip(&fold.residuals) {
                all[k] = (Some(answer.computed[k]), Some(*residual));
            }
        }
        all
    }

    fn folds_of(&self, residuals: &[Residual]) -> Vec<Fold> {
        let plan = self.model.plan();
        let one = |fold: &solve::Fold| {
            let name = plan.folds[fold.group].clone();
            let own = || residuals.iter().filter(|r| r.fold == name);
            Fold {
                observations: own().count(),
                fitted_rms_sd: rms(own().map(|r| r.after_sd)).unwrap_or(f64::NAN),
                predicted_rms_sd: rms(fold.residuals.iter().copied()),
                end: fold
                    .failure
                    .clone()
                    .unwrap_or_else(|| fold.end.name().to_owned()),
                name,
            }
        };
        self.folds.iter().map(one).collect()
    }
}

fn sum_of_squares(list: impl Iterator<Item = f64>) -> f64 {
    list.map(|x| x * x).sum()
}

/// Sum of squares of data and priors with the values of the files.
fn cost_before(residuals: &[Residual], parameters: &[outcome::Parameter]) -> Option<f64> {
    let before: Option<Vec<f64>> = residuals.iter().map(|r| r.before_sd).collect();
    let priors = parameters.iter();
    let priors = priors.filter_map(|p| p.prior.map(|[mean, sd]| (p.file_value - mean) / sd));
    Some(sum_of_squares(before?.into_iter()) + sum_of_squares(priors))
}

fn start(start: &solve::Start) -> Start {
    let end = start.failure.as_ref().map_or_else(
        || start.end.name().to_owned(),
        |why| format!("{}: {why}", start.end.name()),
    );
    Start {
        from: start.from.clone(),
        to: start.to.clone(),
        cost: start.cost.is_finite().then_some(start.cost),
        end,
        evaluations: start.evaluations,
    }
}

fn matrix(m: &nalgebra::DMatrix<f64>) -> Vec<Vec<Option<f64>>> {
    m.row_iter()
        .map(|row| row.iter().map(|x| x.is_finite().then_some(*x)).collect())
        .collect()
}

/// Warnings, one sentence each.
fn warnings(o: &Outcome) -> Vec<String> {
    let mut warnings = Vec::new();
    if !o.converged {
        warnings.push(format!(
            "the search did not converge ({}): the values are the best point so far, no minimum",
            o.end
        ));
    }
    for p in o.parameters.iter().filter(|p| p.is_dead) {
        let name = &p.name;
        warnings.push(format!(
            "{name} moves no datum: it is not fitted by these data"
        ));
    }
    warnings.extend(o.parameters.iter().flat_map(of_parameter));
    if let Some(p) = o.chi2_probability.filter(|p| *p < UNLIKELY) {
        let factor = (o.cost_after / o.degrees_of_freedom as f64).sqrt();
        warnings.push(format!(
            "the data scatter more than their standard deviations say: a sum of squares of {:.1} with {} degrees of freedom has a probability of {p:.1e}; \
             the standard errors are too small by a factor of about {factor:.1}",
            o.cost_after, o.degrees_of_freedom
        ));
    }
    if let Some(observations) = o.doubtful() {
        warnings.push(format!("{observations}: computed outside the validity of a model, or with points left out at gross slip"));
    }
    let same = |cost: f64| cost <= o.cost_after * (1.0 + SAME_COST) + 1e-9;
    let starts = o.starts.iter();
    let elsewhere = starts.filter(|s| !s.cost.is_some_and(same)).count();
    if elsewhere > 0 {
        let all = o.starts.len();
        warnings.push(format!(
            "{elsewhere} of {all} starts ended in another place, with a larger sum of squares"
        ));
    }
    warnings
}

/// A parameter at a bound, or far from its prior.
fn of_parameter(p: &outcome::Parameter) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Some(bound) = p.at_bound {
        warnings.push(format!(
            "{} lies at its {bound} bound, {}: the data would carry it further",
            p.name, p.value
        ));
    }
    if let Some([mean, sd]) = p.prior {
        let away = (p.value - mean).abs();
        if away > FAR * sd {
            warnings.push(format!(
                "{} is {:.1} standard deviations away from its prior",
                p.name,
                away / sd
            ));
        }
    }
    warnings
}
