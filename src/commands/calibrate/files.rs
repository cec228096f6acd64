//! The files of a calibration.

use cvtcycle::config::Problems;
use cvtcycle::output::files::OutputDir;
use cvtcycle::report::charts::calibration::calibration_pictures;
use cvtcycle::study::fit::fitted;
use cvtcycle::study::fit::outcome::{Outcome, Parameter, Residual};
use cvtcycle::study::fit::plan::Plan;

use crate::commands::run::files::Written;
use crate::commands::study::csv_files::{Table, number};
use crate::print::json_text;

/// Writes all files under their names, or none.
///
/// # Errors
/// A fitted file that cannot be made, or a directory that cannot be written.
pub fn write(
    mut dir: OutputDir,
    plan: &Plan,
    outcome: &Outcome,
    date: &str,
) -> Result<Written, Problems> {
    for (name, bytes) in all(plan, outcome, date)? {
        dir.write(&name, |out| out.write_all(&bytes))?;
    }
    Written::commit(dir).map_err(Problems::from)
}

/// Names and contents: the fitted files first.
fn all(plan: &Plan, outcome: &Outcome, date: &str) -> Result<Vec<(String, Vec<u8>)>, Problems> {
    let fitted = fitted::files(plan, outcome, date)?;
    let mut files: Vec<(String, Vec<u8>)> = fitted
        .into_iter()
        .map(|(name, text)| (name, text.into_bytes()))
        .collect();
    files.extend(tables(outcome));
    files.extend(
        calibration_pictures(outcome)
            .into_iter()
            .map(|(name, picture)| (format!("{name}.svg"), picture.svg.into_bytes())),
    );
    files.push(("plan.toml".to_owned(), plan.text.clone().into_bytes()));
    files.push((
        "calibration.json".to_owned(),
        json_text(outcome)?.into_bytes(),
    ));
    Ok(files)
}

/// The tables as CSV; those without rows are left out.
pub fn tables(outcome: &Outcome) -> Vec<(String, Vec<u8>)> {
    [
        parameters(outcome),
        residuals(outcome),
        correlation(outcome),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn some(x: Option<f64>) -> String {
    x.map_or_else(String::new, number)
}

fn parameters(outcome: &Outcome) -> Option<(String, Vec<u8>)> {
    let heads = [
        "parameter",
        "unit",
        "file_value",
        "fitted",
        "standard_error",
        "low",
        "high",
        "at_bound",
        "prior_mean",
        "prior_sd",
        "prior_status",
        "prior_share",
        "source",
    ];
    let mut table = Table::new(&heads);
    let row = |p: &Parameter| {
        let [mean, sd] = [0, 1].map(|k| some(p.prior.map(|prior| prior[k])));
        let mut row = vec![
            p.name.clone(),
            p.unit.clone(),
            number(p.file_value),
            number(p.value),
            some(p.standard_error),
        ];
        row.extend([
            number(p.low),
            number(p.high),
            p.at_bound.unwrap_or_default().to_owned(),
            mean,
            sd,
        ]);
        row.extend([
            p.prior_status.clone(),
            some(p.prior_share),
            p.source.clone(),
        ]);
        row
    };
    outcome.parameters.iter().for_each(|p| table.row(row(p)));
    table.file("parameters.csv")
}

fn residuals(outcome: &Outcome) -> Option<(String, Vec<u8>)> {
    let heads = [
        "group",
        "fold",
        "label",
        "what",
        "column",
        "time_s",
        "unit",
        "measured_low",
        "measured_high",
        "sd",
        "weight_sd",
        "before",
        "after",
        "left_out",
        "before_sd",
        "after_sd",
        "left_out_sd",
        "doubtful",
    ];
    let mut table = Table::new(&heads);
    let row = |r: &Residual| {
        let words = [&r.group, &r.fold, &r.label, &r.what, &r.column].map(Clone::clone);
        let mut row = Vec::from(words);
        row.extend([
            some(r.time_s),
            r.unit.clone(),
            some(r.low),
            some(r.high),
            number(r.sd),
            number(r.weight_sd),
        ]);
        row.extend([some(r.before), number(r.after), some(r.left_out)]);
        row.extend([
            some(r.before_sd),
            number(r.after_sd),
            some(r.left_out_sd),
            r.doubtful.to_string(),
        ]);
        row
    };
    outcome.residuals.iter().for_each(|r| table.row(row(r)));
    table.file("residuals.csv")
}

/// Row and column by the names of the parameters; an empty cell where a correlation is not known.
fn correlation(outcome: &Outcome) -> Option<(String, Vec<u8>)> {
    let names = || outcome.parameters.iter().map(|p| p.name.as_str());
    let heads: Vec<&str> = std::iter::once("parameter").chain(names()).collect();
    let mut table = Table::new(&heads);
    for (name, line) in names().zip(&outcome.correlation) {
        table.row(
            std::iter::once(name.to_owned())
                .chain(line.iter().map(|r| some(*r)))
                .collect(),
        );
    }
    table.file("correlation.csv")
}
