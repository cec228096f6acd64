//! `study`: many runs.

mod ambient;
pub mod execution;
mod export;
pub mod levers;
mod tables;

use std::path::{self, PathBuf};

use clap::{Args, Subcommand};
use cvtcycle::config::setup::{Kind, is_path};
use cvtcycle::config::{Problem, Problems};
use cvtcycle::report::results::StudyResults;
use cvtcycle::study::execute::relative;
use cvtcycle::study::plan::{Design, MAX_SAMPLES, Plan};
use cvtcycle::study::statistics::Confidence;
use cvtcycle::study::{Study, StudyManifest, store};

use super::{Execute, threads};
use crate::args::problems::{bad_value, problem};
use crate::args::{ConfidenceArgs, Names, OutputArgs, count_if_given};
use crate::print::{CommandResult, Terminal};
use execution::{Says, StudyRunArgs};
use levers::LeverResults;

/// Arguments of `study`.
#[derive(Args, Clone, Debug)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  cvtcycle study ambient
  cvtcycle study ambient --out ambient_study
  cvtcycle study uncertainty_rover --samples 64 --confidence 0.8
  cvtcycle study uncertainty_rover --samples 64 --vehicle mycar.toml --baseline twin
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
    /// Another vehicle than that of the plan, whose ranges are then taken relative to the values of its own cars
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| Kind::Vehicle.names()), hide_possible_values = true)]
    vehicle: Option<String>,
    /// Vehicle to compare the other one with; repeatable; `twin` for the same car with a manual box, `none` for no comparison [default: baselines of the vehicle file]
    #[arg(long, value_name = "NAME|FILE.toml|twin|none", requires = "vehicle", value_parser = Names(|| [Kind::Vehicle.names(), vec!["twin", "none"]].concat()), hide_possible_values = true)]
    baseline: Vec<String>,
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
        if let Some(vehicle) = &self.vehicle {
            plan = self.of_vehicle(plan, vehicle, problems)?;
        }
        self.run.prepare(plan, problems)
    }

    fn run(&self, study: Study, terminal: Terminal) -> CommandResult {
        self.run.run::<StudyResults>(&study, terminal)
    }
}

impl StudyPlanArgs {
    /// The plan for another vehicle.
    fn of_vehicle(&self, plan: Plan, vehicle: &str, problems: &mut Problems) -> Option<Plan> {
        let (mut plan, _) = problems.take(relative(plan))?;
        // Paths of the command line begin at the current folder, those of a plan at its own.
        let word = |word: &String| match is_path(word) {
            true => path::absolute(word)
                .map_or_else(|_| word.clone(), |path| path.display().to_string()),
            false => word.clone(),
        };
        let named = self
            .baseline
            .iter()
            .filter(|name| *name != "none")
            .map(word);
        plan.base.baselines = (!self.baseline.is_empty()).then(|| named.collect());
        plan.base.vehicle = word(&vehicle.to_owned());
        plan.title = format!("{}: {vehicle}", plan.title);
        Some(plan)
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
    type Plan = (StudyManifest, store::Study, Confidence);

    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        problems.take(threads::begin(None));
        let confidence = self.confidence.get(problems);
        let (outline, store) = problems.take(StudyResults::stored(&self.dir))?;
        Some((outline, store, confidence))
    }

    fn run(&self, (outline, store, confidence): Self::Plan, terminal: Terminal) -> CommandResult {
        match outline.levers {
            Some(_) => self.show::<LeverResults>((outline, store, confidence), terminal),
            None => self.show::<StudyResults>((outline, store, confidence), terminal),
        }
    }
}

impl StudyShowArgs {
    fn show<S: Says>(
        &self,
        (outline, store, confidence): (StudyManifest, store::Study, Confidence),
        terminal: Terminal,
    ) -> CommandResult {
        let study = S::of(outline, store, confidence)?;
        let tables = || study.tables(terminal.stdout);
        Ok(study.results()?.output(&self.output, tables))
    }
}
