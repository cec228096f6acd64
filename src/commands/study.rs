//! `study`: many runs.

mod ambient;
mod effects;
pub mod execution;
mod export;
pub mod levers;
mod merge;
mod share;
mod tables;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use cvtcycle::config::setup::Kind;
use cvtcycle::config::{Problem, Problems};
use cvtcycle::report::results::StudyResults;
use cvtcycle::study::execute::relative;
use cvtcycle::study::plan::{MAX_SAMPLES, Plan};
use cvtcycle::study::statistics::Confidence;
use cvtcycle::study::{Study, StudyManifest, store};

use super::{Execute, threads};
use crate::args::problems::problem;
use crate::args::{ConfidenceArgs, Names, OutputArgs, count_if_given, word_for_plan};
use crate::print::{CommandResult, Terminal};
use execution::{StudyOutput, StudyRunArgs};
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
  cvtcycle study my_plan.toml --dry-run
  cvtcycle study my_plan.toml --out s_3 --shard 3/100
  cvtcycle study merge my_study s_*
  cvtcycle study show my_study
  cvtcycle study export my_study --out my_study.parquet

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
    /// Write the table of all runs as one file: CSV or Parquet
    Export(export::StudyExportArgs),
    /// Put the shards of a study together, driven by other processes or machines
    Merge(Box<merge::StudyMergeArgs>),
}

impl StudyArgs {
    /// Runs the command.
    pub fn execute(&self, terminal: Terminal) -> CommandResult {
        match &self.command {
            Some(StudyCommand::Ambient(args)) => args.execute(terminal),
            Some(StudyCommand::Show(args)) => args.execute(terminal),
            Some(StudyCommand::Export(args)) => args.execute(terminal),
            Some(StudyCommand::Merge(args)) => args.execute(terminal),
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
        let study = self.prepared(word, problems);
        self.run.check_directory(problems);
        study
    }

    fn run(&self, study: Study, terminal: Terminal) -> CommandResult {
        self.run.run::<StudyResults>(&study, terminal)
    }
}

impl StudyPlanArgs {
    /// Applies the options to the plan.
    fn prepared(&self, word: &str, problems: &mut Problems) -> Option<Study> {
        let mut count = |option, text: &Option<String>, range| {
            count_if_given(option, text.as_ref(), range, problems)
        };
        let samples = count("--samples", &self.samples, 2..=MAX_SAMPLES);
        let seed = count("--seed", &self.seed, 0..=u64::MAX);
        let mut plan = problems.take(Plan::open(word))?;
        let changed = plan.design.changed(samples, seed);
        plan.design = problems.take(changed.map_err(cite_option))?;
        if let Some(vehicle) = &self.vehicle {
            plan = self.for_vehicle(plan, vehicle, problems)?;
        }
        self.run.prepare(plan, problems)
    }

    /// Adapts the plan to another vehicle.
    fn for_vehicle(&self, plan: Plan, vehicle: &str, problems: &mut Problems) -> Option<Plan> {
        let (mut plan, _) = problems.take(relative(plan))?;
        let named = self.baseline.iter().filter(|name| *name != "none");
        let named = named.map(|name| word_for_plan(name));
        plan.base.baselines = (!self.baseline.is_empty()).then(|| named.collect());
        plan.base.vehicle = word_for_plan(vehicle);
        let against = match plan.base.baselines.as_deref() {
            None | Some([]) => String::new(),
            Some(_) => format!(" against {}", self.baseline.join(", ")),
        };
        // Title and question of the plan describe its own cars.
        let name = self.plan.as_deref().unwrap_or_default();
        let is_varied = |key: &str| plan.factors.iter().any(|factor| factor.key == key);
        let mut at = String::new();
        if !is_varied("ambient_degc") {
            at += &format!(" at {} degC", plan.base.ambient_degc);
        }
        if !is_varied("cycle") {
            at += &format!(" on {}", plan.base.cycle);
        }
        plan.title = format!("{vehicle}{against}{at}, with the ranges of {name}");
        plan.question = String::new();
        Some(plan)
    }
}

/// Cites the option of a number.
fn cite_option(found: Problem) -> Problem {
    let option = format!("--{}", found.key);
    found.in_file(option.as_str()).key(option)
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
    fn show<S: StudyOutput>(
        &self,
        (outline, store, confidence): (StudyManifest, store::Study, Confidence),
        terminal: Terminal,
    ) -> CommandResult {
        let study = S::evaluate(outline, store, confidence)?;
        let tables = || study.tables(terminal.stdout);
        Ok(study.results()?.output(&self.output, tables))
    }
}
