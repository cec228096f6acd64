//! `report`: a directory of results to a document for a design review.

use std::path::PathBuf;

use clap::Args;
use cvtcycle::report::document::Document;
use cvtcycle::report::report;
use cvtcycle::report::whatif::{LiveSection, section_of_dir};
use cvtcycle::report::write::{Form, Target};

use super::{Execute, threads};
use crate::args::problems::problem;
use crate::args::{Names, ResultArgs, choice_names, one_of};
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text};
use cvtcycle::config::Problems;

/// Arguments of `report`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.value_name("FILE").help("Report file [default: report.html in the (first) directory]; figures go to the folder NAME_figures next to it")),
    after_help = "\
Examples:
  cvtcycle run --ambient -10 --out cold
  cvtcycle report cold
  cvtcycle run --ambient -10 --set transmission.cvt.belt.band_offset_mm=2 --out offset_2mm
  cvtcycle report cold offset_2mm --out offset.html
  cvtcycle study ambient --out matrix
  cvtcycle report cold --with matrix --force

The page loads nothing and works without scripts; with scripts, pointing at a figure shows its numbers. Results of studies and \
of `validate --out` in folders of DIR are included. Exit code 1: the report was written, but data for it were missing (a trace, \
a part of a study); 2: bad input."
)]
pub struct ReportArgs {
    /// Directory written by `run --out` or `study --out`; with two runs, B is compared with A
    #[arg(value_name = "DIR", required = true, num_args = 1..=2)]
    dirs: Vec<PathBuf>,
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
            ([_, _], _) => Some((
                "two runs cannot be driven again on one page",
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

impl Execute for ReportArgs {
    type Plan = (Document, Target);

    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        problems.take(threads::begin(None));
        let out = self.results.out.out.as_deref();
        let form = match &self.format {
            Some(word) => problems.take(one_of("--format", word, &Form::NAMES)),
            None => None,
        };
        let form = form.or_else(|| out.and_then(Form::from_path));
        let form = form.unwrap_or(Form::Html);
        let fits = !self.live || self.check_live(form, problems);
        let document = problems.take(report(&self.dirs, &self.with, self.cover.as_deref()));
        let file = match out {
            Some(file) => file.to_path_buf(),
            // An unreadable directory would be reported a second time through the file in it.
            None if document.is_none() => return None,
            None => self
                .dirs
                .first()?
                .join(format!("report.{}", form.endings()[0])),
        };
        let target = problems.take(Target::new(&file, form, self.results.out.force));
        let mut document = document?.shown(self.full);
        if self.live && fits {
            let first_figure = document.figures().count() + 1;
            let live: LiveSection = problems.take(section_of_dir(&self.dirs[0], first_figure))?;
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
        let json = serde_json::json!({ "report": report, "figures": figures, "missing": missing });
        let (json, warnings) = (json_text(&json)?, document.warnings.clone());
        let results = Results::new(json, warnings, WrittenFiles::default());
        let table = || format!("{report}\n{} figures next to it\n", figures.len());
        Ok(results.output(&self.results.output, table))
    }
}
