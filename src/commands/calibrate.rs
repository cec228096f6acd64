//! `calibrate`: parameters fitted to measurements, with their errors.

mod logs;
mod tables;

use std::time::{SystemTime, UNIX_EPOCH};

use clap::Args;
use cvtcycle::calibrate::outcome::Outcome;
use cvtcycle::calibrate::outcome::tables as csv_tables;
use cvtcycle::calibrate::plan::CalibrationPlan;
use cvtcycle::calibrate::{MAX_STARTS, calibrate, fitted, open};
use cvtcycle::config::setup::{AMBIENT, Kind, Options, is_path};
use cvtcycle::config::{ProblemKind, Problems};
use cvtcycle::output::files::OutputDir;
use cvtcycle::report::charts::calibration::calibration_pictures;

use super::{Execute, threads};
use crate::args::problems::{bad_value, overrides, problem};
use crate::args::{ColumnsArgs, Names, OutArgs, OutputArgs, ThreadArgs, count_if_given, number};
use crate::print::progress::{Progress, handle_interrupts};
use crate::print::{
    CommandOutput, CommandResult, Ending, Results, Terminal, WrittenFiles, json_text,
};

/// Arguments of `calibrate`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.help("Write the fitted files, tables, plots and calibration.json into this directory")),
    after_help = "\
Examples:
  cvtcycle calibrate rover_216_warm_up
  cvtcycle calibrate docs/calibration_example/plan.toml --out fitted
  cvtcycle run --vehicle fitted/rover_216_cvt_fitted.toml
  cvtcycle calibrate monday.csv tuesday.csv --vehicle civic_20_cvt --out mine
  cvtcycle run --vehicle mine/car.toml

Logs (any file that is no .toml, as `cvtcycle log` reads it) tell idle, fuel cut, ratio, lock-up, operating line and warm-up of the \
car that --vehicle is but for these, with the range of 90 % of resamples, and what they cannot tell; --out writes car.toml, that car \
with these values, ranges.toml, their ranges as factors of a study, and findings.json.

docs/calibration.md describes plans, data and results. A fit is no validation: the prediction error \
is that of the folds that were left out. Exit codes: 0 success; 1 the search did not converge or was \
stopped by Ctrl-C, a parameter affects no observation, or data are outside the validity of a model \
(results are printed and written nevertheless, with the best point so far); 2 bad input."
)]
pub struct CalibrateArgs {
    /// Plan: name of a built-in calibration, or a TOML file; or one or more logs of a car
    #[arg(value_name = "NAME|PLAN.toml|LOG", required = true, num_args = 1.., value_parser = Names(|| Kind::Calibration.names()), hide_possible_values = true)]
    plan: Vec<String>,
    /// Car of the logs, but for what they tell [default: none, without operating line and heat capacity]
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| Kind::Vehicle.names()), hide_possible_values = true)]
    vehicle: Option<String>,
    /// Override one value of this car; repeatable
    #[arg(long, value_name = "KEY=VALUE", requires = "vehicle")]
    set: Vec<String>,
    #[command(flatten)]
    columns: ColumnsArgs,
    /// Ambient temperature of logs without that channel, degC, -40 to 60 [default: 25]
    #[arg(long, value_name = "DEGC", allow_hyphen_values = true)]
    ambient: Option<String>,
    #[command(flatten)]
    out: OutArgs,
    /// Number of starts of the search, 1 to 1000 [default: from the plan]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    starts: Option<String>,
    /// Seed of the starts [default: from the plan]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    seed: Option<String>,
    /// Do not leave out one fold after the other: faster, but without prediction errors
    #[arg(long)]
    no_folds: bool,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    output: OutputArgs,
}

/// A plan, or logs.
pub enum Experiment {
    Plan(Box<(CalibrationPlan, Option<OutputDir>)>),
    Logs(Box<logs::LogsPlan>),
}

/// True if a word names a plan: a built-in calibration, or a TOML file.
fn is_plan(word: &str) -> bool {
    let toml = std::path::Path::new(word).extension();
    toml.is_some_and(|toml| toml.eq_ignore_ascii_case("toml")) || !is_path(word)
}

impl CalibrateArgs {
    fn logs(&self, problems: &mut Problems) -> Option<logs::LogsPlan> {
        let columns = self.columns.get(problems);
        let ambient = self.ambient.as_ref();
        let ambient = ambient.map(|text| number("--ambient", text, AMBIENT, "ambient_degc"));
        let ambient = problems.take(ambient.transpose());
        let of_plans = [
            ("--starts", self.starts.is_some()),
            ("--seed", self.seed.is_some()),
            ("--no-folds", self.no_folds),
        ];
        for (option, _) in of_plans.into_iter().filter(|(_, is)| *is) {
            let hint = "a log is read without a search: leave it out";
            problems.add(problem(option, "this is an option of plans", hint));
        }
        let options = Options {
            set: overrides("--set", &self.set, problems),
            ..Options::default()
        };
        let car = self.vehicle.as_deref().map(|word| (word, &options));
        let question = logs::question(
            &self.plan,
            &columns,
            car,
            ambient?.unwrap_or(25.0),
            problems,
        );
        let out = self.out.dir(problems);
        question.map(|question| logs::LogsPlan { question, out })
    }

    /// Options of logs that a plan does not take.
    fn only_logs(&self, problems: &mut Problems) {
        let list = [
            ("--vehicle", self.vehicle.is_some()),
            ("--columns", self.columns.columns.is_some()),
            ("--repair", self.columns.repair.is_some()),
            ("--ambient", self.ambient.is_some()),
        ];
        for (option, _) in list.into_iter().filter(|(_, is)| *is) {
            let hint = "a plan has it in its file: leave it out";
            problems.add(problem(option, "this is an option of logs", hint));
        }
        if self.plan.len() > 1 {
            let (all, hint) = (
                self.plan.join(" "),
                "logs are named alone, plans one by one",
            );
            let message = "a plan is given alone";
            problems.add(bad_value("PLAN", &all, "one plan, or logs", message, hint));
        }
    }
}

impl Execute for CalibrateArgs {
    type Plan = Experiment;

    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        if !self.plan.iter().any(|word| is_plan(word)) {
            return self
                .logs(problems)
                .map(|plan| Experiment::Logs(Box::new(plan)));
        }
        self.only_logs(problems);
        handle_interrupts();
        let threads = self.threads.given(problems);
        problems.take(threads::begin(threads));
        let mut count = |option, text: &Option<String>, range| {
            count_if_given(option, text.as_ref(), range, problems)
        };
        let starts = count("--starts", &self.starts, 1..=MAX_STARTS);
        let seed = count("--seed", &self.seed, 0..=u64::MAX);
        let plan = problems.take(open(&self.plan[0]));
        let out = self.out.dir(problems);
        let mut plan = plan?;
        let search = &mut plan.search;
        search.starts = starts.map_or(search.starts, |starts| starts as usize);
        search.seed = seed.unwrap_or(search.seed);
        plan.leave_out &= !self.no_folds;
        Some(Experiment::Plan(Box::new((plan, out))))
    }

    fn run(&self, experiment: Self::Plan, terminal: Terminal) -> CommandResult {
        let (plan, out) = match experiment {
            Experiment::Logs(plan) => return logs::run(*plan, &self.output, terminal),
            Experiment::Plan(both) => *both,
        };
        let progress = Progress::evaluations(self.output.quiet);
        let outcome = calibrate(&plan, &progress);
        progress.finish();
        let outcome = match outcome {
            Err(problems) if problems.iter().any(|p| p.kind == ProblemKind::Stopped) => {
                return Ok(stopped());
            }
            outcome => outcome?,
        };
        let json = json_text(&outcome)?;
        let files = WrittenFiles::write(out, |dir| {
            for (name, text) in fitted::files(&plan, &outcome, &today())? {
                dir.put(&name, text)?;
            }
            for (name, csv) in csv_tables(&outcome) {
                dir.put(&name, csv)?;
            }
            for (name, picture) in calibration_pictures(&outcome) {
                dir.put(&format!("{name}.svg"), picture.svg)?;
            }
            dir.put("plan.toml", &plan.text)?;
            dir.put("calibration.json", &json)?;
            Ok("")
        })?;
        let results = Results::new(json, failures(&outcome), files);
        Ok(results.output(&self.output, || tables::tables(&outcome, terminal.stdout)))
    }
}

fn stopped() -> CommandOutput {
    CommandOutput {
        stderr: "cvtcycle: stopped before the first evaluation; no results\n".to_owned(),
        ending: Ending::CheckFailed,
        ..CommandOutput::default()
    }
}

/// Reasons for exit code 1.
fn failures(outcome: &Outcome) -> Vec<String> {
    let mut list = Vec::new();
    if !outcome.converged {
        let end = &outcome.end;
        list.push(format!(
            "the search did not converge ({end}); the values are those of the best point so far"
        ));
    }
    let dead = outcome.parameters.iter().filter(|p| p.is_dead);
    let dead: Vec<&str> = dead.map(|p| p.name.as_str()).collect();
    if !dead.is_empty() {
        let names = dead.join(", ");
        list.push(format!(
            "no observation depends on {names}: fix it, or add data that depend on it"
        ));
    }
    list.extend(outcome.misfit());
    let doubtful = outcome.residuals.iter().filter(|r| r.doubtful > 0);
    if let [first, rest @ ..] = doubtful.collect::<Vec<_>>().as_slice() {
        let more = match rest.len() {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        let label = &first.label;
        list.push(format!(
            "outside the validity of a model, or with points left out at gross slip: {label}{more}"
        ));
    }
    list
}

const DAY_S: u64 = 86_400;

/// Date as YYYY-MM-DD in UTC. `SOURCE_DATE_EPOCH` replaces the clock, for reproducible files.
fn today() -> String {
    let given = std::env::var("SOURCE_DATE_EPOCH").ok();
    let given = given.and_then(|text| text.trim().parse::<u64>().ok());
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let now = now.map_or(0, |since| since.as_secs());
    date(given.unwrap_or(now) / DAY_S)
}

/// Gregorian date of a number of days after 1 January 1970, up to the year 9999.
fn date(days: u64) -> String {
    // Days since 1 March of year 0: a leap day is then the last day of its year, and the lengths of months follow a fixed pattern.
    let days = days.min(2_932_896) + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year_of_era = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day_of_year = day - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 {
        from_march + 3
    } else {
        from_march - 9
    };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
#[path = "../../tests/cli/calibration_tables.rs"]
mod tests;
