//! `study`: many runs.

mod ambient;
mod common;
mod export;
mod matrix;
mod results;
mod show;
mod text;

use clap::Subcommand;

use super::Context;
use crate::args::Offering;
use crate::print::{Reply, problem};
use common::Common;
use cvtcycle::config::Problems;
use cvtcycle::config::setup::Kind;
use cvtcycle::study::plan::{Design, Plan};

/// Arguments of `study`.
#[derive(Clone, Debug, clap::Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  cvtcycle study ambient
  cvtcycle study ambient --out ambient_study
  cvtcycle study uncertainty_rover --samples 64
  cvtcycle study my_plan.toml --out my_study
  cvtcycle study my_plan.toml --out my_study --resume
  cvtcycle study show my_study
  cvtcycle study export my_study --out my_study.xlsx

docs/plan_format.md says what a plan may hold. Exit codes: 0 fine; 1 some runs failed, and stand in the table with their reason;
2 bad input or a full disk; 130 stopped by Ctrl-C: finished parts are kept, --resume goes on."
)]
pub struct Args {
    #[command(subcommand)]
    what: Option<What>,
    #[command(flatten)]
    plan: PlanArgs,
}

#[derive(Clone, Debug, Subcommand)]
enum What {
    /// The thesis's matrix: ambient temperatures, from a soak and warm, each car
    Ambient(Box<ambient::Args>),
    /// Summarise a finished or partial study
    Show(show::Args),
    /// Write the table of all runs as one file: CSV, Parquet or Excel workbook
    Export(export::Args),
}

#[derive(Clone, Debug, clap::Args)]
struct PlanArgs {
    /// Plan: a name of the shipped plans, or a TOML file
    #[arg(value_name = "NAME|PLAN.toml", value_parser = Offering(plans), hide_possible_values = true)]
    plan: Option<String>,
    /// Samples in place of the plan's (designs that have samples): for a quick look
    #[arg(long, value_name = "N")]
    samples: Option<u64>,
    /// Seed in place of the plan's
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    #[command(flatten)]
    common: Common,
}

fn plans() -> Vec<&'static str> {
    Kind::Plan.names()
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    match &args.what {
        Some(What::Ambient(args)) => ambient::answer(args, context),
        Some(What::Show(args)) => show::answer(args, context),
        Some(What::Export(args)) => export::answer(args),
        None => plan(&args.plan, context),
    }
}

fn plan(args: &PlanArgs, context: Context) -> Reply {
    let Some(word) = &args.plan else {
        let hint = format!(
            "name a plan: {}, or a TOML file; or `study ambient`",
            plans().join(", ")
        );
        return Err(problem("PLAN", "no plan is named", &hint).into());
    };
    let mut plan = Plan::open(word, "PLAN")?;
    plan.design = drawn(&plan.design, args)?;
    common::run(plan, &args.common, context)
}

/// The plan's design with the samples and the seed that the options ask for.
fn drawn(design: &Design, args: &PlanArgs) -> Result<Design, Problems> {
    if args.samples.is_none() && args.seed.is_none() {
        return Ok(*design);
    }
    let option = if args.samples.is_some() {
        "--samples"
    } else {
        "--seed"
    };
    let (Some(range), Some(changed)) =
        (design.sample_range(), design.with(args.samples, args.seed))
    else {
        let hint =
            "--samples and --seed are for Latin hypercube, Sobol, Monte Carlo and Saltelli designs";
        return Err(problem(option, "the plan's design draws nothing", hint).into());
    };
    match args.samples {
        Some(samples) if !range.contains(&samples) => Err(problem(
            "--samples",
            &format!("{samples} samples are out of range for this design"),
            "",
        )
        .value(samples.to_string())
        .allowed(format!("{} to {}", range.start(), range.end()))
        .into()),
        _ => Ok(changed),
    }
}
