//! The files of a calibration.

use cvtcycle::config::Problems;
use cvtcycle::output::files::OutputDir;
use cvtcycle::report::charts::calibration::calibration_pictures;
use cvtcycle::study::fit::fitted;
use cvtcycle::study::fit::outcome::Outcome;
use cvtcycle::study::fit::plan::CalibrationPlan;
use cvtcycle::study::fit::tables::tables;

use crate::print::{WrittenFiles, json_text};

/// Writes all files under their names, or none.
///
/// # Errors
/// A fitted file that cannot be made, or a directory that cannot be written.
pub fn write(
    mut dir: OutputDir,
    plan: &CalibrationPlan,
    outcome: &Outcome,
    date: &str,
) -> Result<WrittenFiles, Problems> {
    for (name, bytes) in all(plan, outcome, date)? {
        dir.write(&name, |out| out.write_all(&bytes))?;
    }
    WrittenFiles::commit(dir).map_err(Problems::from)
}

/// Names and contents: the fitted files first.
fn all(
    plan: &CalibrationPlan,
    outcome: &Outcome,
    date: &str,
) -> Result<Vec<(String, Vec<u8>)>, Problems> {
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
