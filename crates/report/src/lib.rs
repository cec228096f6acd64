//! The design-review report: a directory of results to a document, and the document to HTML or Markdown.
//!
//! | module | content |
//! |---|---|
//! | `results` | reads a directory: a run with its studies and validation, or a study |
//! | `cover` | the user's own title, logo, author and remarks |
//! | `document` | sections, paragraphs, tables, figures: the content of a report, without its form |
//! | `number` | numbers to text with their unit |
//! | `run`, `compare`, `study`, `validation` | the sections on a run, two runs, a study, a validation |
//! | `study_answers` | the results of a study in sentences |
//! | `study_pictures` | the pictures of a study |
//! | `write` | the files of a report |
//! | `render` | the document as HTML or Markdown (templates in `reports/`) |
//!
//! Nothing is computed here that the results do not hold: sums, differences and shares of their numbers only.

pub mod charts;
pub mod compare;
mod consistency;
pub mod cover;
pub mod document;
pub mod results;
pub mod number;
mod problems;
pub mod render;
pub mod run;
pub mod study;
pub mod study_answers;
pub mod study_pictures;
pub mod validation;
pub mod validation_page;
pub mod write;

use std::path::PathBuf;

use cover::Cover;
use cvtcycle_config::{Problem, Problems, Setting};
use document::Document;
use results::{ResultDir, find};

/// The report of one directory, or of two runs against each other.
///
/// `with` names studies and validations in other directories, `cover` the user's title page.
///
/// # Errors
/// All problems of all inputs.
pub fn report(
    dirs: &[PathBuf],
    with: &[PathBuf],
    cover: Option<&str>,
) -> Result<Document, Problems> {
    let cover = cover.map(Cover::read).transpose();
    let looked: Vec<Result<ResultDir, Problems>> = dirs.iter().map(|dir| find(dir, with)).collect();
    let mut problems: Problems = cover.as_ref().err().cloned().unwrap_or_default();
    problems.extend(
        looked
            .iter()
            .filter_map(|found| found.as_ref().err())
            .flatten()
            .cloned(),
    );
    if !problems.is_empty() {
        return Err(problems);
    }
    if let ([_, other], [first, ..]) = (dirs, with) {
        let hint = "leave it out, or make the report of one run";
        let message = format!(
            "a study can be added to the report of one run, not of two: {} is the second one",
            other.display()
        );
        return Err(problems::problem(first, &message, hint).into());
    }
    let pair: Vec<ResultDir> = looked.into_iter().flatten().collect();
    let one = |problem: Problem| vec![problem];
    let mut document = match &pair[..] {
        [ResultDir::Run(run)] => run::document(run).map_err(one)?,
        [ResultDir::Study(study)] => study::document(study).map_err(one)?,
        [ResultDir::Run(a), ResultDir::Run(b)] => compare::document(a, b)?,
        _ => {
            let hint =
                "two directories are compared if both are runs; add a study to the report of a run";
            let last = &dirs[dirs.len() - 1];
            let problem = problems::problem(last, "these are not two runs", hint);
            return Err(problem.settings(&[Setting::Added]).into());
        }
    };
    if let Ok(Some(cover)) = cover {
        cover.apply(&mut document);
    }
    Ok(document)
}
