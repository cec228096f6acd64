//! The design-review report: a directory of results to a document, and the document to HTML or Markdown.
//!
//! | module | content |
//! |---|---|
//! | `results` | reads a directory: a run with its studies and validation, or a study |
//! | `cover` | the user's own title, logo, author and remarks |
//! | `document` | sections, paragraphs, tables, figures: the content of a report, without its form |
//! | `number` | numbers to text with their unit |
//! | `run`, `compare`, `study`, `validation` | the sections on a run, two runs (and a table of any number), a study, a validation |
//! | `study::levers` | the sections on a study of levers |
//! | `study_answers` | the results of a study in sentences |
//! | `study_pictures` | the pictures of a study |
//! | `computed` | what page 1 says from one sample, where a directory does not hold it |
//! | `whatif` | interactive page |
//! | `live_section` | content of an interactive page: levers, states, answers |
//! | `run_files` | the files of a run, of which a report is made |
//! | `write` | the files of a report |
//! | `render` | the document as HTML or Markdown (templates in `reports/`) |
//!
//! Nothing is computed here that the results do not hold: sums, differences and shares of their numbers only.

pub mod charts;
pub mod compare;
mod computed;
pub mod cover;
pub mod document;
pub mod whatif;
mod live_section;
pub mod results;
pub mod number;
mod problems;
pub mod render;
mod run;
pub mod run_files;
mod study;
pub mod study_answers;
pub mod study_pictures;
pub mod validation;
pub mod write;

use std::path::PathBuf;

use cover::Cover;
use cvtcycle_analysis::answer::Answer;
use cvtcycle_config::{Problems, Setting};
use cvtcycle_study::Study;
use document::Document;
use problems::problem;
use results::{ResultDir, RunResults, find};

/// Builds the report of one directory, or of two runs against each other.
///
/// `with` names studies and validations in other directories, `cover` the user's title page.
///
/// ```no_run
/// use std::path::Path;
///
/// use cvtcycle_report::write::{Form, Target};
///
/// let document = cvtcycle_report::report(&["cold".into(), "offset_2mm".into()], &[], None)?;
/// let target = Target::new(Path::new("offset.html"), Form::Html, false)?;
/// let written = target.write(&document)?;
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
///
/// # Errors
/// All problems of all inputs.
pub fn report(
    dirs: &[PathBuf],
    with: &[PathBuf],
    cover: Option<&str>,
) -> Result<Document, Problems> {
    report_with(dirs, with, cover, None)
}

/// Drives the study of a run's question: `None` where the user has stopped it.
pub type Drives<'a> = &'a dyn Fn(&Study) -> Result<Option<Answer>, Problems>;

/// As [`report`]; the ranges, options and next test of a run that has no study of levers are computed by `drives`.
///
/// # Errors
/// As [`report`], and problems of the study.
pub fn report_with(
    dirs: &[PathBuf],
    with: &[PathBuf],
    cover: Option<&str>,
    drives: Option<Drives>,
) -> Result<Document, Problems> {
    let mut problems = Problems::new();
    let cover = cover.map(Cover::read).transpose();
    let cover = cover.unwrap_or_else(|found| {
        problems.extend(found);
        None
    });
    let mut results = Vec::new();
    for dir in dirs {
        match find(dir, with) {
            Ok(found) => results.push(found),
            Err(found) => problems.extend(found),
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    if let ([_, other, ..], [first, ..]) = (dirs, with) {
        let hint = "leave it out, or make the report of one run";
        let message = format!(
            "a study can be added to the report of one run, not of several: {} is the second one",
            other.display()
        );
        return Err(problem(first, &message, hint).into());
    }
    if let ([ResultDir::Run(run)], Some(drives)) = (&mut results[..], drives) {
        compute(run, drives)?;
    }
    let mut document = match &results[..] {
        [ResultDir::Run(run)] => run::document(run)?,
        [ResultDir::Study(study)] => study::document(study)?,
        [ResultDir::Run(a), ResultDir::Run(b)] => compare::document(a, b)?,
        runs if runs.len() > 2 && runs.iter().all(|run| matches!(run, ResultDir::Run(_))) => {
            compare::side_by_side::document(&compare::compare(dirs, 0, false)?)
        }
        _ => {
            let hint =
                "directories are compared if all are runs; add a study to the report of a run";
            let message = "these are not all runs";
            let problem = problem(&dirs[dirs.len() - 1], message, hint);
            return Err(problem.settings(&[Setting::Added]).into());
        }
    };
    if let Some(cover) = cover {
        cover.apply(&mut document);
    }
    Ok(document)
}

/// Adds the answer of a run, unless its directory has a study of levers of the same case.
fn compute(run: &mut RunResults, drives: Drives) -> Result<(), Problems> {
    let summary = &run.summary;
    let has_levers = |study| study_answers::levers_of_run(study, summary).is_some();
    if run.studies.iter().any(has_levers) {
        return Ok(());
    }
    match computed::study_of_run(run) {
        Ok(study) => run.answer = drives(&study)?,
        Err(why) => run.no_answer = Some(why),
    }
    if let Some(answer) = &run.answer {
        answer.merge(&mut run.summary);
    }
    Ok(())
}
