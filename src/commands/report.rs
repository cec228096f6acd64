//! `report`: a directory of results to a document for a design review.

use std::path::PathBuf;

use cvtcycle::report::report;
use cvtcycle::report::write::{Form, Target};

use crate::args::{self as inputs, Offering};
use crate::print::{Answer, FAILED, Reply, json_text};

/// Arguments of `report`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle run --ambient -10 --out cold
  cvtcycle report cold
  cvtcycle run --ambient -10 --set transmission.cvt.belt.band_offset_mm=2 --out offset_2mm
  cvtcycle report cold offset_2mm --out offset.html
  cvtcycle study ambient --out matrix
  cvtcycle report cold --with matrix --force

The page loads nothing and needs no script; with one, pointing at a figure shows its numbers. Studies and the answer of
`validate --out` in folders of DIR are taken into its report. Exit code 1: the report is there, but something was missing for
it (a trace, a part of a study); 2: bad input.")]
pub struct Args {
    /// Directory that was given to --out of `run` or `study`; of two runs B is held against A
    #[arg(value_name = "DIR", required = true, num_args = 1..=2)]
    dirs: Vec<PathBuf>,
    /// A study or a validation that belongs into the report and stands elsewhere; repeatable
    #[arg(long, value_name = "DIR")]
    with: Vec<PathBuf>,
    /// Own title, logo, author and remarks (docs/report.md)
    #[arg(long, value_name = "FILE.toml")]
    cover: Option<String>,
    /// Name of the report [default: report.html in the (first) directory]; figures go to the folder NAME_figures beside it
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Form of the report: html or md [default: by the ending of --out, else html]
    #[arg(long, value_name = "FORM", value_parser = Offering(forms), hide_possible_values = true)]
    format: Option<String>,
    /// Replace an earlier report
    #[arg(long)]
    force: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
    /// Print nothing but problems
    #[arg(long, short)]
    quiet: bool,
}

fn forms() -> Vec<&'static str> {
    Form::NAMES.iter().map(|(name, _)| *name).collect()
}

/// Runs the command.
pub fn answer(args: &Args) -> Reply {
    let mut problems = cvtcycle::config::Problems::new();
    let by_ending = || args.out.as_deref().and_then(Form::of).unwrap_or(Form::Html);
    let form = match &args.format {
        Some(word) => problems
            .take(inputs::word("--format", word, &Form::NAMES))
            .unwrap_or(Form::Html),
        None => by_ending(),
    };
    let file = match (&args.out, args.dirs.first()) {
        (Some(file), _) => file.clone(),
        (None, Some(dir)) => dir.join(format!("report.{}", form.endings()[0])),
        (None, None) => PathBuf::new(),
    };
    let document = problems.take(report(&args.dirs, &args.with, args.cover.as_deref()));
    // Without a directory to look into, what is said of the place of the report would only repeat it.
    let target = match (&document, &args.out) {
        (None, None) => None,
        _ => problems.take(Target::new(&file, form, args.force)),
    };
    problems.finish()?;
    let (Some(document), Some(target)) = (document, target) else {
        unreachable!("what is missing has left a problem")
    };
    let written = target.write(&document)?;
    let warnings: String = document
        .warnings
        .iter()
        .map(|line| format!("cvtcycle: {line}\n"))
        .collect();
    let code = if document.warnings.is_empty() {
        0
    } else {
        FAILED
    };
    let paths: Vec<String> = written
        .iter()
        .map(|path| path.display().to_string())
        .collect();
    let stdout = match (args.json, args.quiet, paths.split_first()) {
        (true, _, Some((report, figures))) => json_text(
            &serde_json::json!({ "report": report, "figures": figures, "missing": document.warnings }),
        )?,
        (false, false, Some((report, figures))) => {
            format!("{report}\n{} figures beside it\n", figures.len())
        }
        _ => String::new(),
    };
    Ok(Answer {
        stdout,
        stderr: warnings,
        code,
    })
}
