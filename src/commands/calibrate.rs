//! `calibrate`: parameters fitted to measurements, and what the fit is worth.

mod date;
mod files;
mod progress;
#[cfg(test)]
mod tests;
mod text;

use std::path::PathBuf;

use cvtcycle::config::Problems;
use cvtcycle::config::setup::Kind;
use cvtcycle::output::files::OutputDir;
use cvtcycle::study::fit::outcome::Outcome;
use cvtcycle::study::fit::plan::Plan;
use cvtcycle::study::fit::{calibrate, open};

use super::Context;
use super::run::files::Written;
use crate::args::Offering;
use crate::print::progress::{listen, stop_asked};
use crate::print::{Answer, FAILED, Reply, json_text, problem};
use progress::Progress;

/// Arguments of `calibrate`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle calibrate rover_216_warm_up
  cvtcycle calibrate docs/calibration_example/plan.toml --out fitted
  cvtcycle run --vehicle fitted/rover_216_cvt_fitted.toml

docs/calibration.md says how a plan and its data are written, and what the numbers mean. A fit is
no validation: what the model predicts is told by the folds that were left out. Exit codes: 0 fine;
1 the search did not converge or was stopped by Ctrl-C, a parameter moves no observation, or data
lie outside the validity of a model (all is printed and written all the same, with the best point
so far); 2 bad input.")]
pub struct Args {
    /// Plan: a name of the shipped calibrations, or a TOML file
    #[arg(value_name = "NAME|PLAN.toml", value_parser = Offering(plans), hide_possible_values = true)]
    plan: String,
    /// Write the fitted files, tables, plots and calibration.json into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Replace the files of an earlier run in the --out directory
    #[arg(long, requires = "out")]
    force: bool,
    /// Starts of the search in place of the plan's, 1 to 1000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: Option<u16>,
    /// Seed of the starts in place of the plan's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Do not leave out one fold after the other: faster, but nothing is said about predictions
    #[arg(long)]
    no_folds: bool,
    /// Threads, 1 to 1024 [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
    /// Print nothing but problems
    #[arg(long, short)]
    quiet: bool,
}

fn plans() -> Vec<&'static str> {
    Kind::Calibration.names()
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    listen();
    let mut problems = Problems::default();
    let plan = problems.take(open(&args.plan, "PLAN"));
    let out = args
        .out
        .as_ref()
        .map(|dir| OutputDir::create(dir, args.force).map_err(Problems::from));
    let out = out.and_then(|dir| problems.take(dir));
    problems.finish()?;
    let Some(mut plan) = plan else {
        return Ok(Answer::default());
    };
    asked(&mut plan, args);
    let outcome = match fit(&plan, args) {
        Err(problems)
            if stop_asked()
                && problems
                    .iter()
                    .all(|problem| problem.message.contains("stopped")) =>
        {
            let stderr = "cvtcycle: stopped before the model gave an answer; nothing was written\n"
                .to_owned();
            return Ok(Answer {
                stderr,
                code: FAILED,
                ..Answer::default()
            });
        }
        outcome => outcome?,
    };
    let written = match out {
        Some(dir) => files::write(dir, &plan, &outcome, &date::today())?,
        None => Written::default(),
    };
    reply(&outcome, &written, args, context)
}

/// What the options ask for in place of the plan.
fn asked(plan: &mut Plan, args: &Args) {
    if let Some(starts) = args.starts {
        plan.search.starts = usize::from(starts);
    }
    if let Some(seed) = args.seed {
        plan.search.seed = seed;
    }
    plan.search.leave_out &= !args.no_folds;
}

fn fit(plan: &Plan, args: &Args) -> Result<Outcome, Problems> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.map_or(0, usize::from))
        .build();
    let pool = pool.map_err(|e| {
        problem(
            "--threads",
            &format!("cannot start threads: {e}"),
            "give fewer",
        )
    })?;
    let progress = Progress::new(args.quiet);
    let outcome = pool.install(|| calibrate(plan, &progress));
    progress.finish();
    outcome
}

/// What a finished calibration says, and whether all is fine with it.
fn reply(outcome: &Outcome, written: &Written, args: &Args, context: Context) -> Reply {
    let failures = failures(outcome);
    let stdout = match (args.json, args.quiet) {
        (true, _) => json_text(outcome)?,
        (_, true) => String::new(),
        _ => text::answer(outcome, context.paint) + &written.text(),
    };
    let left = if args.json || args.quiet {
        String::new()
    } else {
        written.left_over_text()
    };
    let stderr = failures
        .iter()
        .map(|why| format!("cvtcycle: {why}\n"))
        .collect::<String>()
        + &left;
    Ok(Answer {
        stdout,
        stderr,
        code: if failures.is_empty() { 0 } else { FAILED },
    })
}

/// What makes the exit code 1; a parameter at a bound is a warning only.
fn failures(outcome: &Outcome) -> Vec<String> {
    let mut list = Vec::new();
    if !outcome.converged {
        list.push(format!(
            "the search did not converge ({}); the values are those of the best point so far",
            outcome.end
        ));
    }
    let dead: Vec<&str> = outcome
        .parameters
        .iter()
        .filter(|p| p.is_dead)
        .map(|p| p.name.as_str())
        .collect();
    if !dead.is_empty() {
        list.push(format!(
            "no observation depends on {}: hold it, or add data that see it",
            dead.join(", ")
        ));
    }
    let doubtful: Vec<&str> = outcome
        .residuals
        .iter()
        .filter(|r| r.doubtful > 0)
        .map(|r| r.label.as_str())
        .collect();
    if let Some(first) = doubtful.first() {
        let more = if doubtful.len() > 1 {
            format!(" and {} more", doubtful.len() - 1)
        } else {
            String::new()
        };
        list.push(format!(
            "outside the validity of a model, or with points left out at gross slip: {first}{more}"
        ));
    }
    list
}
