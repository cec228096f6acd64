//! `validate`: published values and own measurements compared with the model.

mod tables;

use clap::Args;
use cvtcycle::config::setup::{self, Options};
use cvtcycle::config::{Problem, Problems, bounded, decode};
use cvtcycle::output::files::OutputDir;
use cvtcycle::report::validation::page;
use cvtcycle::validate::{
    CandidateVehicle, MECHANISMS, Perturbations, PowerReport, Report, RowFile, ValidationRow, csv,
    files, json, judge, markdown,
};

use super::{Execute, threads};
use crate::args::problems::{bad_value, did_you_mean, overrides, problem};
use crate::args::{Names, ResultArgs, ThreadArgs, VehicleArgs, bytes, choice_names, one_of};
use crate::print::progress::{Progress, handle_interrupts};
use crate::print::{
    CommandOutput, CommandResult, Ending, Results, Terminal, WrittenFiles, json_text,
};

/// Arguments of `validate`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.help("Write summary.json, validation.csv, validation.html and validation.md into this directory; with --power also power.csv")),
    mut_arg("threads", |threads| threads.requires("power")),
    after_help = "\
Examples:
  cvtcycle validate
  cvtcycle validate --all
  cvtcycle validate --chapter 5 --mechanism pump
  cvtcycle validate --held-out
  cvtcycle validate --set transmission.cvt.pump.displacement_cc_rev=12
  cvtcycle validate --format html > validation.html
  cvtcycle validate --power --chapter 5

Verdicts: `agrees` (within the printed precision and the tolerance), `fit` (the same, but a parameter \
was fitted to it), `differs` (with the reason), `not comparable`, and `not computed` for a number that \
this car does not have. Exit code 1: the verdict of a row is not the recorded one. --power changes every number of the cars by itself, to 0.6 and 1.5 times, \
where nothing flips to 0.1 and 8 times, and says by row which changes flip its verdict; table, CSV and JSON object have it. Rows are TOML files (docs/validation_format.md); --rows adds your own \
measurements."
)]
pub struct ValidateArgs {
    /// Own rows in addition to the built-in ones; repeatable
    #[arg(long, value_name = "FILE.toml")]
    rows: Vec<String>,
    /// Leave out the built-in rows
    #[arg(long, requires = "rows")]
    only_rows: bool,
    /// Rows of one chapter only, such as 5 or C
    #[arg(long, value_name = "CHAPTER")]
    chapter: Option<String>,
    /// Rows of one mechanism only, named as the page of the book; `all` for every one
    #[arg(long, value_name = "NAME", value_parser = Names(mechanisms), hide_possible_values = true)]
    mechanism: Option<String>,
    /// Only rows that test the model: neither fitted to nor constants
    #[arg(long)]
    held_out: bool,
    /// Print every row; without it, and without a choice of rows, those that differ or whose verdict moved
    #[arg(long)]
    all: bool,
    /// Change every number of the cars by itself and say which changes flip the verdict of each row
    #[arg(long)]
    power: bool,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    car: VehicleArgs,
    /// Format of the output: table, csv, html, or md (a fragment for the book)
    #[arg(long, value_name = "FORM", default_value = "table", value_parser = Names(|| choice_names(&FORMS)), hide_possible_values = true, conflicts_with = "json")]
    format: String,
    #[command(flatten)]
    results: ResultArgs,
}

/// Form of standard output.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum ValidationForm {
    /// Tables.
    Table,
    /// CSV.
    Csv,
    /// HTML page.
    Html,
    /// Markdown.
    Markdown,
}

const FORMS: [(&str, ValidationForm); 4] = [
    ("table", ValidationForm::Table),
    ("csv", ValidationForm::Csv),
    ("html", ValidationForm::Html),
    ("md", ValidationForm::Markdown),
];

/// Every mechanism.
const ALL: &str = "all";

fn mechanisms() -> Vec<&'static str> {
    MECHANISMS.into_iter().chain([ALL]).collect()
}

/// Checked input of `validate`.
pub struct ValidatePlan {
    form: ValidationForm,
    files: Vec<RowFile>,
    candidate: CandidateVehicle,
    out: Option<OutputDir>,
}

impl Execute for ValidateArgs {
    type Plan = ValidatePlan;

    fn plan(&self, problems: &mut Problems) -> Option<ValidatePlan> {
        if self.power {
            handle_interrupts();
            let threads = self.threads.given(problems);
            problems.take(threads::begin(threads));
        }
        let form = problems.take(one_of("--format", &self.format, &FORMS));
        let texts = self.texts(problems);
        let files = texts.map(|own| problems.take(files(&own, !self.only_rows)));
        let files = files.flatten().unwrap_or_default();
        if !files.is_empty() {
            self.check_filters(&files, problems);
        }
        let out = self.results.out.dir(problems);
        if !self.only_rows {
            self.check_vehicle(problems);
        }
        let candidate = CandidateVehicle {
            vehicle: self.car.vehicle.clone(),
            lubricant: self.car.lubricant.clone(),
            set: overrides("--set", &self.car.set, problems),
            ..CandidateVehicle::default()
        };
        Some(ValidatePlan {
            form: form?,
            files,
            candidate,
            out,
        })
    }

    fn run(&self, plan: ValidatePlan, terminal: Terminal) -> CommandResult {
        let report = judge(&plan.files, &plan.candidate, |row| self.is_selected(row))?;
        let mut object = json(&report);
        let power = match self.power {
            false => None,
            true => match self.power_report(&plan.files, &report) {
                None => return Ok(stopped()),
                found => found,
            },
        };
        if let Some(power) = &power {
            object["power"] = power.json();
        }
        let json = json_text(&object)?;
        let files = WrittenFiles::write(plan.out, |dir| {
            dir.put("summary.json", &json)?;
            dir.put("validation.csv", csv(&report))?;
            dir.put("validation.html", html(&report)?)?;
            dir.put("validation.md", markdown(&report))?;
            if let Some(power) = &power {
                dir.put("power.csv", power.csv())?;
            }
            Ok("")
        })?;
        let faults = power.as_ref().map(PowerReport::faults).unwrap_or_default();
        let failures = tables::changed_verdicts(&report).into_iter().chain(faults);
        let results = Results::new(json, failures.collect(), files);
        let stdout = match (plan.form, &power) {
            (ValidationForm::Table, power) => {
                let tables = || match power {
                    Some(power) => tables::power(&report, power, terminal.stdout),
                    None => tables::tables(&report, self.rows_shown(), terminal.stdout),
                };
                return Ok(results.output(&self.results.output, tables));
            }
            (ValidationForm::Csv, Some(power)) => {
                String::from_utf8_lossy(&power.csv()).into_owned()
            }
            (ValidationForm::Csv, None) => csv(&report),
            (ValidationForm::Html, _) => html(&report)?,
            (ValidationForm::Markdown, _) => markdown(&report),
        };
        Ok(CommandOutput {
            stdout,
            ..results.warnings()
        })
    }
}

fn stopped() -> CommandOutput {
    CommandOutput {
        stderr: "cvtcycle: stopped before every change was tried; no results\n".to_owned(),
        ending: Ending::CheckFailed,
        ..CommandOutput::default()
    }
}

impl ValidateArgs {
    /// Rows to print: all of a selection; without one those that differ or moved.
    fn rows_shown(&self) -> tables::Shown {
        let chosen = self.chapter.is_some()
            || self.mechanism.is_some()
            || self.held_out
            || !self.rows.is_empty();
        match self.all || chosen {
            true => tables::Shown::All,
            false => tables::Shown::Differing,
        }
    }

    /// Effect of changes of the cars on the verdicts. None after an interruption.
    fn power_report(&self, files: &[RowFile], report: &Report) -> Option<PowerReport> {
        let changes = Perturbations::of(files, &report.candidate);
        let progress =
            Progress::counted("changes", changes.count() as u64, self.results.output.quiet);
        let power = changes.power(files, report, &progress);
        progress.finish();
        power
    }

    /// Rejects a manual gearbox for the built-in rows, each of which would report a problem of its own.
    fn check_vehicle(&self, problems: &mut Problems) {
        // Problems of the vehicle are reported later, together with those of its overrides.
        let vehicle = setup::load(&self.car.vehicle, &Options::default());
        let hint = "`--only-rows` with `--rows FILE.toml` compares your own rows with it";
        self.car.need_cvt(vehicle.as_ref().ok(), hint, problems);
    }

    /// Reads the user's files of rows: names and texts. None if one is unreadable.
    fn texts(&self, problems: &mut Problems) -> Option<Vec<(String, String)>> {
        let read = |path: &String| {
            let text = bytes("--rows", path, bounded::TOML).and_then(|bytes| decode(path, &bytes));
            problems.take(text).map(|text| (path.clone(), text))
        };
        let texts: Vec<_> = self.rows.iter().map(read).collect();
        texts.into_iter().collect()
    }

    fn is_selected(&self, row: &ValidationRow) -> bool {
        let is = |wanted: Option<&String>, own: &str| {
            wanted.is_none_or(|wanted| wanted.eq_ignore_ascii_case(own))
        };
        let mechanism = self.mechanism.as_ref().filter(|name| *name != ALL);
        is(self.chapter.as_ref(), &row.chapter)
            && is(mechanism, row.mechanism)
            && (!self.held_out || row.is_held_out())
    }

    /// Reports unknown chapters and mechanisms. A known mechanism may have no rows.
    fn check_filters(&self, files: &[RowFile], problems: &mut Problems) {
        let rows = files.iter().flat_map(|file| &file.rows);
        let chapters = rows.map(|row| row.chapter.as_str());
        let mut chapters: Vec<&str> = chapters.collect();
        chapters.dedup();
        let is_unknown =
            |name: &str, known: &[&str]| !known.iter().any(|own| own.eq_ignore_ascii_case(name));
        if let Some(name) = self
            .chapter
            .as_ref()
            .filter(|name| is_unknown(name, &chapters))
        {
            let message = format!("no row belongs to chapter `{name}`");
            let allowed = chapters.join(", ");
            problems.add(bad_value("--chapter", name, &allowed, &message, ""));
        }
        if let Some(name) = self
            .mechanism
            .as_ref()
            .filter(|name| is_unknown(name, &mechanisms()))
        {
            let hint = did_you_mean(name, &MECHANISMS);
            let message = format!("there is no mechanism `{name}`");
            let allowed = MECHANISMS.join(", ");
            problems.add(bad_value("--mechanism", name, &allowed, &message, &hint));
        }
    }
}

fn html(report: &Report) -> Result<String, Problem> {
    page(report).map_err(|why| problem("--format", &why, ""))
}
