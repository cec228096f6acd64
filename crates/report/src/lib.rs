//! The design-review report: a directory of results to a document, and the document to HTML or Markdown.
//!
//! | module | what stands there |
//! |---|---|
//! | `found` | a directory to what is in it: a run or a study, with studies and validation beside it |
//! | `cover` | the user's own title, logo, author and remarks |
//! | `document` | sections, paragraphs, tables, figures: what a report consists of, without its form |
//! | `number` | numbers to text with their unit, each kind in one place |
//! | `run`, `compare`, `study`, `validation` | what a run, two runs, a study, a validation have to say |
//! | `study_pictures` | the pictures of a study |
//! | `write` | the files of a report |
//! | `render` | the document as HTML or Markdown (templates in `reports/`) |
//!
//! Nothing is computed here that the results do not hold: sums, differences and shares of their numbers only.

pub mod charts;
pub mod compare;
pub mod cover;
pub mod document;
pub mod found;
pub mod number;
pub mod render;
pub mod run;
pub mod study;
pub mod study_pictures;
pub mod validation;
pub mod validation_page;
pub mod write;

use std::path::PathBuf;

use cover::Cover;
use cvtcycle_config::{Problem, Problems};
use document::Document;
use found::{Found, find};

/// The report of one directory, or of two runs against each other.
///
/// `with` names studies and validations that stand elsewhere, `cover` the user's title page.
///
/// # Errors
/// All problems of all inputs.
pub fn report(
    dirs: &[PathBuf],
    with: &[PathBuf],
    cover: Option<&str>,
) -> Result<Document, Problems> {
    let cover = cover.map(Cover::read).transpose();
    let looked: Vec<Result<Found, Problems>> = dirs.iter().map(|dir| find(dir, with)).collect();
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
            "a study stands beside one run, not beside {} and another one",
            other.display()
        );
        return Err(found::problem(first, &message, hint).into());
    }
    let pair: Vec<Found> = looked.into_iter().flatten().collect();
    let one = |problem: Problem| vec![problem];
    let mut document = match &pair[..] {
        [Found::Run(run)] => run::document(run).map_err(one)?,
        [Found::Study(study)] => study::document(study).map_err(one)?,
        [Found::Run(a), Found::Run(b)] => compare::document(a, b)?,
        _ => {
            let hint = "two directories are compared if both are runs; a study stands beside a run by --with";
            return Err(
                found::problem(&dirs[dirs.len() - 1], "this is no pair of runs", hint).into(),
            );
        }
    };
    if let Ok(Some(cover)) = cover {
        cover.apply(&mut document);
    }
    Ok(document)
}
