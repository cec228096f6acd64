//! `report`: a directory of results to a document for a design review.

use std::path::{Path, PathBuf};

use clap::{Args, ColorChoice};
use cvtcycle::analysis::answer::{self, Answer};
use cvtcycle::report::document::Document;
use cvtcycle::report::whatif::{LiveSection, section_of_dir};
use cvtcycle::report::write::{Form, Target};
use cvtcycle::report::{Drives, report_with};

use super::run::RunArgs;
use super::vehicles::CaseArgs;
use super::{Execute, threads};
use crate::args::problems::problem;
use crate::args::{Names, ResultArgs, choice_names, one_of};
use crate::print::progress::Progress;
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text};
use cvtcycle::config::Problems;
use cvtcycle::study::Study;
use tempfile::TempDir;

/// Options of the run that a report is made of, where no directory is given.
const RUN_OPTIONS: [&str; 13] = [
    "vehicle",
    "lubricant",
    "set",
    "cycle",
    "baseline",
    "engine_oil",
    "set_all",
    "columns",
    "repair",
    "ambient",
    "start",
    "dt",
    "formulation",
];

/// Arguments of `report`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.value_name("FILE").help("Report file [default: report.html in the (first) directory, without one in the current directory]; figures go to the folder NAME_figures next to it")),
    mut_args(|arg| match RUN_OPTIONS.contains(&arg.get_id().as_str()) {
        true => arg.conflicts_with("dirs").help_heading("Run to report on, without DIR"),
        false => arg,
    }),
    after_help = "\
Examples:
  cvtcycle report --vehicle civic_20_cvt --cycle wltc --ambient -7
  cvtcycle run --ambient -10 --out cold
  cvtcycle report cold
  cvtcycle run --ambient -10 --set transmission.cvt.belt.band_offset_mm=2 --out offset_2mm
  cvtcycle report cold offset_2mm --out offset.html
  cvtcycle study ambient --out matrix
  cvtcycle report cold --with matrix --force

Without DIR, and for the directory of a run without a study of levers, the report computes ranges, price of each loss, options, risk and \
next test from 256 draws of the uncertain values, the same for all of its cars (some 12 000 drives); --stored leaves that out.

The page loads nothing and works without scripts; with scripts, pointing at a figure shows its numbers. Results of studies and \
of `validate --out` in folders of DIR are included. Exit code 1: the report was written, but data for it were missing (a trace, \
a part of a study); 2: bad input."
)]
pub struct ReportArgs {
    /// Directory written by `run --out` or `study --out`; of several runs, 2 to 20, each is compared with the first
    #[arg(value_name = "DIR", num_args = 0..=20)]
    dirs: Vec<PathBuf>,
    #[command(flatten)]
    case: CaseArgs,
    /// Only what the directory holds: no draws, no options
    #[arg(long)]
    stored: bool,
    /// Directory of a study or validation to include; repeatable
    #[arg(long, value_name = "DIR")]
    with: Vec<PathBuf>,
    /// Every figure and table, not the body of twelve pages alone
    #[arg(long)]
    full: bool,
    /// With the simulator and levers of the run's own cars in the page (HTML)
    #[arg(long)]
    live: bool,
    /// Title, logo, author and remarks of the report (docs/report.md)
    #[arg(long, value_name = "FILE.toml")]
    cover: Option<String>,
    /// Format of the report: html or md [default: from the file extension of --out, else html]
    #[arg(long, value_name = "FORM", value_parser = Names(|| choice_names(&Form::NAMES)), hide_possible_values = true)]
    format: Option<String>,
    #[command(flatten)]
    results: ResultArgs,
}

impl ReportArgs {
    /// Checks the options of the interactive section, and returns whether it is wanted.
    fn check_live(&self, form: Form, problems: &mut Problems) -> bool {
        let refused = match (&self.dirs[..], form) {
            (_, Form::Markdown) => Some(("levers are in a page alone", "choose --format html")),
            ([_, _, ..], _) => Some((
                "several runs cannot be driven again on one page",
                "make the report of one of them",
            )),
            _ => None,
        };
        if let Some((message, hint)) = refused {
            problems.add(problem("--live", message, hint));
        }
        refused.is_none()
    }
}

impl ReportArgs {
    /// Runs the car of the options into a temporary directory. `None` after a problem.
    fn run_of_options(&self, problems: &mut Problems) -> Option<TempDir> {
        let dir = tempfile::tempdir().map_err(|error| {
            let message = format!("cannot make a temporary directory: {error}");
            problem("report", &message, "name another by the variable TMPDIR")
        });
        let dir = problems.take(dir)?;
        let run = RunArgs::for_report(self.case.clone(), &dir.path().join("run"));
        let plan = run.plan(problems).filter(|_| problems.is_empty())?;
        // Failed checks are in the report.
        problems.take(run.run(plan, Terminal::new(ColorChoice::Never)))?;
        Some(dir)
    }

    /// Drives the draws of a run's question.
    fn drive(&self, study: &Study) -> Result<Option<Answer>, Problems> {
        let progress = Progress::counted("runs", study.runs(), self.results.output.quiet);
        let answer = answer::drive(study, &progress);
        progress.finish();
        answer
    }
}

impl Execute for ReportArgs {
    type Plan = (Document, Target);

    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        problems.take(threads::begin(None));
        let temporary = match self.dirs.is_empty() {
            true => Some(self.run_of_options(problems)?),
            false => None,
        };
        let dirs = match &temporary {
            Some(dir) => vec![dir.path().join("run")],
            None => self.dirs.clone(),
        };
        let out = self.results.out.out.as_deref();
        let form = match &self.format {
            Some(word) => problems.take(one_of("--format", word, &Form::NAMES)),
            None => None,
        };
        let form = form.or_else(|| out.and_then(Form::from_path));
        let form = form.unwrap_or(Form::Html);
        let fits = !self.live || self.check_live(form, problems);
        let drives = |study: &Study| self.drive(study);
        let drives: Option<Drives> = (!self.stored).then_some(&drives);
        let document = report_with(&dirs, &self.with, self.cover.as_deref(), drives);
        let document = problems.take(document);
        let file = match out {
            Some(file) => file.to_path_buf(),
            // An unreadable directory would be reported a second time through the file in it.
            None if document.is_none() => return None,
            None => {
                let dir = self.dirs.first().map_or(Path::new(""), PathBuf::as_path);
                dir.join(format!("report.{}", form.endings()[0]))
            }
        };
        let target = problems.take(Target::new(&file, form, self.results.out.force));
        let mut document = document?.shown(self.full);
        if self.live && fits {
            let first_figure = document.figures().count() + 1;
            let live: LiveSection = problems.take(section_of_dir(&dirs[0], first_figure))?;
            document.live = Some(live);
        }
        Some((document, target?))
    }

    fn run(&self, (document, target): Self::Plan, _: Terminal) -> CommandResult {
        let paths = target.write(&document)?;
        let paths = paths.iter().map(|path| path.display().to_string());
        let paths: Vec<String> = paths.collect();
        let (report, figures) = paths
            .split_first()
            .map_or(("", &[][..]), |(first, rest)| (first, rest));
        let missing = &document.warnings;
        let json = serde_json::json!({ "report": report, "figures": figures, "missing": missing, "answer": document.answer });
        let (json, mut warnings) = (json_text(&json)?, document.warnings.clone());
        let failing = document.answer.as_ref().filter(|answer| {
            let [failed, all] = answer.failed();
            2 * failed > all
        });
        warnings.extend(failing.and_then(|answer| answer.failures_in_words()));
        let results = Results::new(json, warnings, WrittenFiles::default());
        let table = || format!("{report}\n{} figures next to it\n", figures.len());
        Ok(results.output(&self.results.output, table))
    }
}
