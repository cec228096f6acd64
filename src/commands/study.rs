//! `study`: many runs.

mod ambient;
mod execution;
mod export;
mod tables;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use cvtcycle::config::setup::Kind;
use cvtcycle::config::{Problem, Problems};
use cvtcycle::report::results::StudyResults;
use cvtcycle::study::Study;
use cvtcycle::study::plan::{Design, MAX_SAMPLES, Plan};

use super::{Execute, threads};
use crate::args::problems::{bad_value, problem};
use crate::args::{ConfidenceArgs, Names, OutputArgs, count_if_given};
use crate::print::{CommandResult, Terminal};
use execution::{StudyRunArgs, results};

/// Arguments of `study`.
#[derive(Args, Clone, Debug)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  cvtcycle study ambient
  cvtcycle study ambient --out ambient_study
  cvtcycle study uncertainty_rover --samples 64 --confidence 0.8
  cvtcycle study my_plan.toml --out my_study
  cvtcycle study my_plan.toml --out my_study --resume
  cvtcycle study show my_study
  cvtcycle study export my_study --out my_study.xlsx

docs/plan_format.md describes plans. Exit codes: 0 success; 1 some runs failed, with the reason in their rows; 2 bad input or a \
full disk; 130 stopped by Ctrl-C: finished parts are kept, --resume continues."
)]
pub struct StudyArgs {
    #[command(subcommand)]
    command: Option<StudyCommand>,
    #[command(flatten)]
    plan: StudyPlanArgs,
}

#[derive(Clone, Debug, Subcommand)]
enum StudyCommand {
    /// Run the matrix of the thesis: ambient temperatures, from a soak and warm, each vehicle
    Ambient(Box<ambient::StudyAmbientArgs>),
    /// Summarise a finished or partial study
    Show(StudyShowArgs),
    /// Write the table of all runs as one file: CSV, Parquet or Excel workbook
    Export(export::StudyExportArgs),
}

impl StudyArgs {
    /// Runs the command.
    pub fn execute(&self, terminal: Terminal) -> CommandResult {
        match &self.command {
            Some(StudyCommand::Ambient(args)) => args.execute(terminal),
            Some(StudyCommand::Show(args)) => args.execute(terminal),
            Some(StudyCommand::Export(args)) => args.execute(terminal),
            None => self.plan.execute(terminal),
        }
    }
}

/// Arguments of `study PLAN`.
#[derive(Args, Clone, Debug)]
struct StudyPlanArgs {
    /// Plan: name of a built-in plan, or a TOML file
    #[arg(value_name = "NAME|PLAN.toml", value_parser = Names(|| Kind::Plan.names()), hide_possible_values = true)]
    plan: Option<String>,
    /// Number of samples, for designs that draw samples [default: from the plan]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    samples: Option<String>,
    /// Seed of the samples [default: from the plan]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    seed: Option<String>,
    #[command(flatten)]
    run: StudyRunArgs,
}

impl Execute for StudyPlanArgs {
    type Plan = Study;

    fn plan(&self, problems: &mut Problems) -> Option<Study> {
        let Some(word) = &self.plan else {
            let names = Kind::Plan.names().join(", ");
            let hint = format!("name a plan: {names}, or a TOML file; or `study ambient`");
            problems.add(problem("PLAN", "no plan is named", &hint));
            return None;
        };
        self.run.begin(problems);
        let mut count = |option, text: &Option<String>, range| {
            count_if_given(option, text.as_ref(), range, problems)
        };
        let samples = count("--samples", &self.samples, 2..=MAX_SAMPLES);
        let seed = count("--seed", &self.seed, 0..=u64::MAX);
        let mut plan = problems.take(Plan::open(word))?;
        plan.design = problems.take(changed(&plan.design, samples, seed))?;
        self.run.prepare(plan, problems)
    }

    fn run(&self, study: Study, terminal: Terminal) -> CommandResult {
        self.run.run(&study, terminal)
    }
}

/// The design of the plan with the samples and the seed of the options.
fn changed(design: &Design, samples: Option<u64>, seed: Option<u64>) -> Result<Design, Problem> {
    let option = match (samples, seed) {
        (None, None) => return Ok(*design),
        (Some(_), _) => "--samples",
        (None, Some(_)) => "--seed",
    };
    let (Some(range), Some(changed)) = (design.sample_range(), design.with(samples, seed)) else {
        let message = "the design of the plan draws no samples";
        let hint =
            "--samples and --seed are for Latin hypercube, Sobol, Monte Carlo and Saltelli designs";
        return Err(problem(option, message, hint));
    };
    match samples {
        Some(samples) if !range.contains(&samples) => {
            let allowed = format!("{} to {}", range.start(), range.end());
            let message = format!("{samples} samples are out of range for this design");
            let hint = format!("the nearest allowed value is {}", range.end());
            let value = samples.to_string();
            Err(bad_value(option, &value, &allowed, &message, &hint))
        }
        _ => Ok(changed),
    }
}

/// Arguments of `study show`.
#[derive(Args, Clone, Debug)]
#[command(
    after_help = "Example:\n  cvtcycle study show my_study\n\nFor an interrupted study it shows the results of the finished parts, and their number."
)]
struct StudyShowArgs {
    /// Directory written by `study --out`
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    #[command(flatten)]
    confidence: ConfidenceArgs,
    #[command(flatten)]
    output: OutputArgs,
}

impl Execute for StudyShowArgs {
    type Plan = StudyResults;

    fn plan(&self, problems: &mut Problems) -> Option<StudyResults> {
        problems.take(threads::begin(None));
        let confidence = self.confidence.get(problems);
        problems.take(StudyResults::open(&self.dir, confidence))
    }

    fn run(&self, study: StudyResults, terminal: Terminal) -> CommandResult {
        let tables = || tables::tables(&study, terminal.stdout);
        Ok(results(&study)?.output(&self.output, tables))
    }
}
