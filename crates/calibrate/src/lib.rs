//! Parameters fitted to measurements: plan -> data -> residuals -> least squares -> what the fit is worth -> fitted files.
//!
//! | part | content |
//! |---|---|
//! | `plan` | a TOML file to a plan: free parameters, groups of data |
//! | `data` | measured CSV files to observations |
//! | `model` | numbers for the parameters to computed observations: rigs and cycles are run anew |
//! | `solve` | least squares, bounds, several starts, covariance, what the data do not identify; knows no physics |
//! | `outcome` | everything that a calibration found |
//! | `fitted` | vehicle and lubricant files with the fitted values |
//! | `recorded` | what logs of a car tell of it: another kind of experiment, read directly and without a search |
//!
//! A residual is (computed - measured) / sd. What is computed comes from the sources and expressions of [`cvtcycle_validate`], so that a
//! number is computed in the same way for a fit and for a verdict. A measured range has no residual within it.

pub mod data;
pub mod equations;
pub mod fitted;
pub mod model;
pub mod outcome;
pub mod plan;
pub mod recorded;
pub mod solve;

pub use cvtcycle_config::embedded::calibrations as embedded_calibrations;

/// Most starts of a search.
pub const MAX_STARTS: u64 = 1000;

use cvtcycle_config::{Problem, Problems};
use cvtcycle_output::progress::Progress;
use model::{Model, Prediction};
use outcome::{Fold, Outcome, Residual, Start, rms};
use plan::{CalibrationPlan, Measured, Observable};
use solve::{Bound, Failure, Fit, FitEnd, Uncertainty};

/// Probability of the sum of squares below which there is a warning.
const UNLIKELY: f64 = 0.01;
/// Probability of a sum of squares below which the model does not fit its data. ASSUMED: one in ten thousand by chance.
const IMPOSSIBLE: f64 = 1e-4;
/// A start within this share of the least cost found the same minimum.
const SAME_COST: f64 = 1e-3;
/// Distance from its prior, in its standard deviations, above which there is a warning.
const FAR: f64 = 3.0;

/// Reads the plan that a word of the user means, and loads its cars.
///
/// # Errors
/// All problems of the plan, of its data files and of its cars.
pub fn open(word: &str) -> Result<CalibrationPlan, Problems> {
    let (plan, mut problems) = plan::gather(word)?;
    // Without a vehicle, reported already, every key would be unknown.
    if !plan.car.vehicle.is_empty() {
        problems.extend(Model::new(&plan).err().unwrap_or_default());
    }
    if problems.is_empty() {
        Ok(plan)
    } else {
        Err(problems)
    }
}

/// Fits the parameters of a plan, and computes the uncertainty of the fit.
///
/// # Errors
/// Problems of the plan's vehicle, keys, bounds and sources; a problem if the model has no answer at any start.
///
/// ```no_run
/// use cvtcycle_output::progress::NoProgress;
/// let plan = cvtcycle_calibrate::open("rover_216_warm_up")?;
/// let outcome = cvtcycle_calibrate::calibrate(&plan, &NoProgress)?;
/// for p in &outcome.parameters {
///     println!("{} = {} {}", p.name, p.value, p.unit);
/// }
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn calibrate(plan: &CalibrationPlan, progress: &dyn Progress) -> Result<Outcome, Problems> {
    let model = Model::new(plan)?;
    let (parameters, options) = (model.parameters(), &plan.search);
    let fit = solve::fit(&model, parameters, options, progress)
        .map_err(|failure| problems_of(failure, plan))?;
    let mut folds = Vec::new();
    if plan.leave_out && plan.folds.len() > 1 && fit.end != FitEnd::Stopped {
        let groups: Vec<usize> = plan.observations.iter().map(|o| o.fold).collect();
        folds = solve::leave_out(&model, parameters, &groups, &fit, options, progress);
    }
    let found = Found {
        uncertainty: solve::uncertainty(&fit, parameters),
        model: &model,
        fit,
        folds,
    };
    Ok(found.outcome())
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
        let problem = Problem::failed(format!("the model has no answer: {why}"));
        problem.at(plan.place.clone()).hint(hint)
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
            directions: u.directions.iter().rev().cloned().collect(),
            not_identified: solve::not_identified(fit, self.model.parameters()),
            starts: fit.starts.iter().map(start).collect(),
            evaluations: fit.evaluations,
            ..Outcome::of_plan(self.model.plan())
        };
        outcome.warnings = warnings(&outcome);
        outcome.manifest = outcome.manifest.clone().for_run(&outcome);
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
                prior_status: own.map_or("assumed", |free| free.status).to_owned(),
                source: own
                    .map_or("one error for all data of the group", |free| &free.source)
                    .to_owned(),
                prior_share: u.prior_share[k],
                at_bound: u.at_bound[k]
                    .map(|bound| if bound == Bound::Low { "low" } else { "high" }),
                is_dead: u.dead.contains(&k),
            }
        };
        let all = self.model.parameters().iter().enumerate();
        all.map(one).collect()
    }

    fn residuals(&self, before: Option<&Prediction>, file_values: &[f64]) -> Vec<Residual> {
        let plan = self.model.plan();
        // The model has a result at the end of the fit.
        let after = self.model.predict(&self.fit.values).unwrap_or_default();
        let left_out = self.left_out();
        let distances = before.map(|answer| self.model.distances(&answer.computed, file_values));
        let one = |(k, o): (usize, &plan::Observation)| {
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
                time_s: match o.observable {
                    Observable::Trace { time_s, .. } => Some(time_s),
                    _ => None,
                },
                unit: o.unit.clone(),
                low: low.is_finite().then_some(low),
                high: high.is_finite().then_some(high),
                sd: o.sd,
                weight_sd: o.weight_sd,
                before: before.map(|answer| answer.computed[k]),
                after: after.computed.get(k).copied().unwrap_or(f64::NAN),
                left_out: left_out[k].0,
                before_sd: distances.as_ref().map(|list| list[k] / o.weight_sd),
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
                end: fold.failure.clone().unwrap_or(fold.end.name().to_owned()),
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
    let mut end = start.end.name().to_owned();
    if let Some(why) = &start.failure {
        end += &format!(": {why}");
    }
    Start {
        from: start.from.clone(),
        to: start.to.clone(),
        cost: start.cost.is_finite().then_some(start.cost),
        end,
        evaluations: start.evaluations,
    }
}

fn matrix(m: &nalgebra::DMatrix<f64>) -> Vec<Vec<Option<f64>>> {
    let finite = |x: &f64| x.is_finite().then_some(*x);
    m.row_iter()
        .map(|row| row.iter().map(finite).collect())
        .collect()
}

impl Outcome {
    /// Why the model does not fit these data: a parameter that the data would carry beyond a bound of the plan, or residuals beyond all chance. A
    /// coefficient that is found to be 0 is a result: the mechanism is not seen.
    pub fn misfit(&self) -> Vec<String> {
        let at_bound = self
            .parameters
            .iter()
            .filter(|p| p.at_bound.is_some() && p.value != 0.0);
        let mut list: Vec<String> = at_bound
            .map(|p| {
                let (name, value, bound) = (&p.name, p.value, p.at_bound.unwrap_or_default());
                format!("the model does not fit these data: {name} lies at its {bound} bound, {value}; widen the bound if it is not physical, or change the model")
            })
            .collect();
        if let Some(p) = self.chi2_probability.filter(|p| *p < IMPOSSIBLE) {
            let factor = (self.cost_after / self.degrees_of_freedom as f64).sqrt();
            list.push(format!(
                "the model does not fit these data: residuals are {factor:.1} times their standard deviations, which has a probability of {p:.1e}; state larger deviations if the data are worse than said, or change the model"
            ));
        }
        list
    }
}

/// Warnings, one sentence each.
fn warnings(o: &Outcome) -> Vec<String> {
    let mut warnings = Vec::new();
    if !o.converged {
        let end = &o.end;
        warnings.push(format!(
            "the search did not converge ({end}): the values are the best point so far, no minimum"
        ));
    }
    let dead = o.parameters.iter().filter(|p| p.is_dead).map(|p| &p.name);
    warnings
        .extend(dead.map(|name| format!("{name} moves no datum: it is not fitted by these data")));
    for p in &o.parameters {
        let (name, value) = (&p.name, p.value);
        if let Some(bound) = p.at_bound {
            warnings.push(format!(
                "{name} lies at its {bound} bound, {value}: the data would carry it further"
            ));
        }
        let away = p.prior.map(|[mean, sd]| (value - mean).abs() / sd);
        if let Some(away) = away.filter(|away| *away > FAR) {
            warnings.push(format!(
                "{name} is {away:.1} standard deviations away from its prior"
            ));
        }
    }
    if let Some(p) = o.chi2_probability.filter(|p| *p < UNLIKELY) {
        let (cost, freedom) = (o.cost_after, o.degrees_of_freedom);
        let factor = (cost / freedom as f64).sqrt();
        warnings.push(format!(
            "the data scatter more than their standard deviations say: a sum of squares of {cost:.1} with {freedom} degrees of freedom has a probability of {p:.1e}; \
             the standard errors are too small by a factor of about {factor:.1}"
        ));
    }
    if let Some(observations) = o.doubtful() {
        warnings.push(format!("{observations}: computed outside the validity of a model, or with points left out at gross slip"));
    }
    let same = |cost: f64| cost <= o.cost_after * (1.0 + SAME_COST) + 1e-9;
    let elsewhere = o
        .starts
        .iter()
        .filter(|s| !s.cost.is_some_and(same))
        .count();
    if elsewhere > 0 {
        let all = o.starts.len();
        warnings.push(format!(
            "{elsewhere} of {all} starts ended in another place, with a larger sum of squares"
        ));
    }
    warnings
}
