//! Result of a calibration, for tables, files and pictures.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CO-1 | root mean square of residuals over their standard deviations, of a group, of a fold, of all | convention |

use super::plan::CalibrationPlan;
use cvtcycle_output::columns;
use cvtcycle_output::provenance::hash;
use cvtcycle_output::record::Manifest;
use cvtcycle_output::table::{Column, csv_bytes};
use serde::Serialize;

pub use super::solve::Direction;

/// Version of the form of `calibration.json`.
pub const SCHEMA: u32 = 1;

/// A fitted parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Dotted key; `common error of GROUP` for an error that a group has in common.
    pub name: String,
    /// Whether it is a key of the files.
    pub is_key: bool,
    /// Unit.
    pub unit: String,
    /// Value of the files.
    pub file_value: f64,
    /// Fitted value.
    pub value: f64,
    /// Standard error; none for a parameter that is not identified.
    pub standard_error: Option<f64>,
    /// Bounds.
    pub low: f64,
    /// Bounds.
    pub high: f64,
    /// Mean and standard deviation of what was known before.
    pub prior: Option<[f64; 2]>,
    /// Status of the prior.
    pub prior_status: String,
    /// Reason for bounds and prior.
    pub source: String,
    /// Variance after over variance before: near 1 if the data have no influence.
    pub prior_share: Option<f64>,
    /// `low` or `high` where the value lies at a bound.
    pub at_bound: Option<&'static str>,
    /// Whether it moves no observation.
    pub is_dead: bool,
}

/// One observation, before and after.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Residual {
    /// Name of its group.
    pub group: String,
    /// Name of its fold.
    pub fold: String,
    /// Identifier of a row, or column and place in a file.
    pub label: String,
    /// Meaning.
    pub what: String,
    /// Measured column; empty for expressions.
    pub column: String,
    /// Time of a trace's value, s.
    pub time_s: Option<f64>,
    /// Unit.
    pub unit: String,
    /// Measured number, or the lower end of a range; none where it is open.
    pub low: Option<f64>,
    /// The same number, or the upper end of a range.
    pub high: Option<f64>,
    /// Standard deviation as given.
    pub sd: f64,
    /// Standard deviation that counts in the fit.
    pub weight_sd: f64,
    /// Computed with the values of the files.
    pub before: Option<f64>,
    /// Computed with the fitted values.
    pub after: f64,
    /// Predicted by a fit without its fold.
    pub left_out: Option<f64>,
    /// Distance from what was measured over `weight_sd`, with the values of the files, without a common error.
    pub before_sd: Option<f64>,
    /// The same with the fitted values, a common error included.
    pub after_sd: f64,
    /// The same of the prediction without its fold.
    pub left_out_sd: Option<f64>,
    /// Points behind it outside the validity of a model, or left out because of gross slip.
    pub doubtful: usize,
}

/// A fold that was left out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fold {
    /// Name.
    pub name: String,
    /// Observations in it.
    pub observations: usize,
    /// Root mean square of its residuals with all data fitted, in standard deviations (CO-1).
    pub fitted_rms_sd: f64,
    /// The same when predicted; none where the fit without it failed.
    pub predicted_rms_sd: Option<f64>,
    /// How the fit without it ended.
    pub end: String,
}

/// One start of the search.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Start {
    /// Values at its beginning, in the order of the parameters.
    pub from: Vec<f64>,
    /// Values at its end.
    pub to: Vec<f64>,
    /// Sum of squares; none where the model has no result.
    pub cost: Option<f64>,
    /// How it ended.
    pub end: String,
    /// Evaluations of the model.
    pub evaluations: usize,
}

/// A finished calibration.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Outcome {
    /// Version [`SCHEMA`] of this object, and the program.
    #[serde(flatten)]
    pub manifest: Manifest,
    /// Title.
    pub title: String,
    /// Plan as cited.
    pub plan: String,
    /// SHA-256 of the plan's text.
    pub plan_sha256: String,
    /// Data files and their SHA-256.
    pub files: Vec<[String; 2]>,
    /// Vehicle as the plan names it.
    pub vehicle: String,
    /// How the best start ended.
    pub end: String,
    /// Whether it converged.
    pub converged: bool,
    /// Sum of squares of the residuals of data and priors with the file's values; none where the model has no result there.
    pub cost_before: Option<f64>,
    /// The same after the fit.
    pub cost_after: f64,
    /// Sum of squares of the data alone after the fit.
    pub chi2: f64,
    /// Data and priors less parameters.
    pub degrees_of_freedom: usize,
    /// Probability of a larger sum of squares by chance; none without degrees of freedom.
    pub chi2_probability: Option<f64>,
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// Observations.
    pub residuals: Vec<Residual>,
    /// Correlation of the parameters, row by row; none where a parameter is not known.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// Covariance of the parameters in their units, row by row.
    pub covariance: Vec<Vec<Option<f64>>>,
    /// Directions, least determined first.
    pub directions: Vec<Direction>,
    /// What the data alone do not identify, as sentences.
    pub not_identified: Vec<String>,
    /// Folds.
    pub folds: Vec<Fold>,
    /// Starts.
    pub starts: Vec<Start>,
    /// Evaluations of the model in all starts.
    pub evaluations: usize,
    /// Warnings, one sentence each: not converged, at a bound, outside validity, scatter beyond the deviations.
    pub warnings: Vec<String>,
}

impl Outcome {
    /// Version, program, plan and files, without results.
    pub(super) fn of_plan(plan: &CalibrationPlan) -> Self {
        let files = plan.files.iter();
        Outcome {
            manifest: Manifest::new(SCHEMA),
            title: plan.title.clone(),
            plan: plan.file.clone(),
            plan_sha256: hash(plan.text.as_bytes()),
            files: files
                .map(|(path, hash)| [path.clone(), hash.clone()])
                .collect(),
            vehicle: plan.car.vehicle.clone(),
            ..Outcome::default()
        }
    }

    /// The observations with doubtful points, as `FIRST and N more`.
    #[must_use]
    pub fn doubtful(&self) -> Option<String> {
        let mut doubtful = self.residuals.iter().filter(|r| r.doubtful > 0);
        let first = &doubtful.next()?.label;
        Some(match doubtful.count() {
            0 => first.clone(),
            more => format!("{first} and {more} more"),
        })
    }

    /// Root mean square of all residuals in standard deviations: with the files' values, fitted, predicted fold by fold (CO-1).
    #[must_use]
    pub fn rms_sd(&self) -> [Option<f64>; 3] {
        let of: [fn(&Residual) -> Option<f64>; 3] =
            [|r| r.before_sd, |r| Some(r.after_sd), |r| r.left_out_sd];
        of.map(|of| {
            let all: Option<Vec<f64>> = self.residuals.iter().map(of).collect();
            rms(all?.into_iter())
        })
    }
}

/// Root mean square; none of nothing.
#[must_use]
pub fn rms(list: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = list.fold((0_u32, 0.0), |(n, sum), x| (n + 1, sum + x * x));
    (count > 0).then(|| (sum / f64::from(count)).sqrt()) // CO-1
}

/// Name and contents of every table that has rows. Numbers read back to the same `f64`; a missing one is an empty cell.
#[must_use]
pub fn tables(outcome: &Outcome) -> Vec<(String, Vec<u8>)> {
    let names = outcome.parameters.iter().map(|p| p.name.as_str());
    let rows: Vec<(&str, &[Option<f64>])> = names
        .zip(outcome.correlation.iter().map(Vec::as_slice))
        .collect();
    let files = [
        (
            "parameters.csv",
            csv_bytes(&parameters(), &outcome.parameters),
        ),
        ("residuals.csv", csv_bytes(&residuals(), &outcome.residuals)),
        ("correlation.csv", csv_bytes(&correlation(outcome), &rows)),
    ];
    let with_rows = files
        .into_iter()
        .filter_map(|(name, bytes)| Some((name.to_owned(), bytes?)));
    with_rows.collect()
}

fn parameters() -> Vec<Column<Parameter>> {
    columns! { Parameter;
        text "parameter", "", "", p => p.name.clone();
        text "unit", "", "", p => p.unit.clone();
        number "file_value", "", "", p => p.file_value;
        number "fitted", "", "", p => p.value;
        optional "standard_error", "", "", p => p.standard_error;
        number "low", "", "", p => p.low;
        number "high", "", "", p => p.high;
        text "at_bound", "", "", p => p.at_bound.unwrap_or_default().to_owned();
        optional "prior_mean", "", "", p => p.prior.map(|prior| prior[0]);
        optional "prior_sd", "", "", p => p.prior.map(|prior| prior[1]);
        text "prior_status", "", "", p => p.prior_status.clone();
        optional "prior_share", "", "", p => p.prior_share;
        text "source", "", "", p => p.source.clone();
    }
}

fn residuals() -> Vec<Column<Residual>> {
    columns! { Residual;
        text "group", "", "", r => r.group.clone();
        text "fold", "", "", r => r.fold.clone();
        text "label", "", "", r => r.label.clone();
        text "what", "", "", r => r.what.clone();
        text "column", "", "", r => r.column.clone();
        optional "time_s", "", "", r => r.time_s;
        text "unit", "", "", r => r.unit.clone();
        optional "measured_low", "", "", r => r.low;
        optional "measured_high", "", "", r => r.high;
        number "sd", "", "", r => r.sd;
        number "weight_sd", "", "", r => r.weight_sd;
        optional "before", "", "", r => r.before;
        number "after", "", "", r => r.after;
        optional "left_out", "", "", r => r.left_out;
        optional "before_sd", "", "", r => r.before_sd;
        number "after_sd", "", "", r => r.after_sd;
        optional "left_out_sd", "", "", r => r.left_out_sd;
        text "doubtful", "", "", r => r.doubtful.to_string();
    }
}

/// Name of a parameter and its correlations.
type NamedRow<'a> = (&'a str, &'a [Option<f64>]);

/// Row and column by the names of the parameters; an empty cell where a correlation is not known.
fn correlation<'a>(outcome: &Outcome) -> Vec<Column<NamedRow<'a>>> {
    let name = Column::text("parameter", "", "", |row: &NamedRow| row.0.to_owned());
    let of = |(k, p): (usize, &Parameter)| {
        Column::optional(p.name.clone(), "", "", move |row: &NamedRow| {
            row.1.get(k).copied().flatten()
        })
    };
    std::iter::once(name)
        .chain(outcome.parameters.iter().enumerate().map(of))
        .collect()
}
