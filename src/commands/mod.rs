//! The commands, one file each: arguments, a checked plan, and the computation.

mod accelerate;
mod attribute;
mod belt;
mod calibrate;
mod check;
mod compare;
mod convert;
mod explain;
mod fleet;
mod fmu;
mod label;
mod levers;
mod list;
mod log;
mod losses;
mod new;
mod optimum;
mod program;
mod report;
mod rig;
mod run;
mod shell;
mod show;
mod study;
mod threads;
mod validate;
mod vehicles;
mod whatif;

pub use program::program;

use std::sync::LazyLock;

use clap::{ColorChoice, Parser, Subcommand};

use crate::print::{CommandResult, Terminal};
use cvtcycle::config::Problems;
use cvtcycle::output::BUILD;

/// Version and identity of the build. A study can be resumed by the same build only.
static LONG_VERSION: LazyLock<String> =
    LazyLock::new(|| format!("{} (build {BUILD})", env!("CARGO_PKG_VERSION")));

/// Command line of the program.
pub type Cli = CommandLine<Command>;

/// Drive-cycle losses and fuel of cars with a pushing-belt CVT, cold and warm, from component physics
#[derive(Debug, Parser)]
#[command(
    name = "cvtcycle",
    version,
    long_version = LONG_VERSION.as_str(),
    max_term_width = 100,
    propagate_version = true,
    after_help = "Example: cvtcycle run --cycle ece15_eudc --ambient -10\n\n\
        Exit codes: 0 success; 1 a check failed (trace missed, energy not balanced); 2 bad input; 130 stopped by Ctrl-C."
)]
pub struct CommandLine<C: Subcommand> {
    /// When to colour the output; `auto` colours on a terminal and obeys NO_COLOR
    #[arg(
        long,
        value_enum,
        global = true,
        value_name = "WHEN",
        default_value = "auto",
        display_order = 1000
    )]
    pub color: ColorChoice,
    #[command(subcommand)]
    command: C,
}

/// The command of a run alone: building the arguments of all commands takes longer than the drive.
#[derive(Debug, Subcommand)]
pub enum RunOnly {
    /// As the command of [`Command`].
    Run(Box<run::RunArgs>),
}

impl From<CommandLine<RunOnly>> for Cli {
    fn from(line: CommandLine<RunOnly>) -> Cli {
        let RunOnly::Run(args) = line.command;
        Cli {
            color: line.color,
            command: Command::Run(args),
        }
    }
}

/// All commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate a vehicle and its baselines on a drive cycle: fuel, losses, temperatures
    Run(Box<run::RunArgs>),
    /// Compute the fuel that each loss of the transmission costs: the car driven again without it
    #[command(visible_alias = "price")]
    Attribute(Box<attribute::AttributeArgs>),
    /// Compute the least fuel that any controller of ratio and clamp can burn, and the best operating line
    Optimum(Box<optimum::OptimumArgs>),
    /// Drive changes of a design next to the car as it is: what each saves, how sure that is, and what it does besides
    Levers(Box<levers::LeversArgs>),
    /// Compute full-throttle times: 0-100 km/h, 0-60 mph, 80-120 km/h, a quarter mile, with the limit of grip
    Accelerate(Box<accelerate::AccelerateArgs>),
    /// Compute the figures of a fuel label: US city and highway, by two formulas and five cycles, and WLTP at 14 and 23 degC
    Label(label::LabelArgs),
    /// Run many simulations: ambient temperatures, parameter sweeps, sampling, with statistics
    Study(Box<study::StudyArgs>),
    /// Write a design-review report of a run or a study, or of two runs compared: one HTML file and its figures
    Report(Box<report::ReportArgs>),
    /// Make a page on which a car can be driven again with other values: no server, no network
    Whatif(Box<whatif::WhatifArgs>),
    /// Compare runs with each other: fuel, losses, and the values in which the cars differ
    Compare(compare::CompareArgs),
    /// Compare with the published values of the thesis, and with your own measurements
    Validate(Box<validate::ValidateArgs>),
    /// Fit parameters to measurements, with standard errors and prediction errors
    Calibrate(Box<calibrate::CalibrateArgs>),
    /// Simulate the test rigs of the thesis
    Rig(rig::RigArgs),
    /// Compute the loss of each transmission component at one operating point or over a grid
    Losses(Box<losses::LossesArgs>),
    /// Evaluate the belt model at the operating points of a table
    Belt(Box<belt::BeltArgs>),
    /// Drive many cars of a table on tests, and compare with measured fuel
    Fleet(Box<fleet::FleetArgs>),
    /// Write a vehicle file from catalogue numbers
    New(Box<new::NewArgs>),
    /// Show what is understood of a recorded drive: channels, units, rate, repairs, doubts; write it as a cycle
    Log(log::LogArgs),
    /// Convert a drive cycle from one form of file to another: EPA, FASTSim, VECTO, a logger's table
    Convert(convert::ConvertArgs),
    /// Write a car as an FMU (FMI 2.0 or 3.0), a unit for co-simulation in other programs
    Fmu(Box<fmu::FmuArgs>),
    /// List the built-in cycles, vehicles, classes, lubricants or levers
    List(list::ListArgs),
    /// Show all values of a vehicle or lubricant with status and source, or a cycle
    Show(show::ShowArgs),
    /// Explain a key, a column, a flag, an equation or a term: value in each file, unit, range, meaning
    Explain(explain::ExplainArgs),
    /// Check input files without running them
    Check(check::CheckArgs),
    /// Print the JSON Schema of an input file, for editors and other programs
    Schema(shell::SchemaArgs),
    /// Print the book of assumptions: the source of every value
    Assumptions(shell::AssumptionsArgs),
    /// Print a completion script for a shell
    Completions(shell::CompletionsArgs),
    /// Print the manual page of the program or of one command
    Man(shell::ManArgs),
}

/// A command with parsed arguments: first its plan with all problems at once, then the run.
trait Execute {
    /// Checked input of the command.
    type Plan;

    /// Checks the arguments and reads the input files. Returns None only after recording a problem.
    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan>;

    /// Computes, writes the files and returns the text to print.
    fn run(&self, plan: Self::Plan, terminal: Terminal) -> CommandResult;

    /// Plans, and runs without a problem.
    fn execute(&self, terminal: Terminal) -> CommandResult {
        let mut problems = Problems::default();
        match self.plan(&mut problems) {
            Some(plan) if problems.is_empty() => self.run(plan, terminal),
            _ => Err(problems),
        }
    }
}

impl Cli {
    /// Runs the command.
    pub fn execute(&self, terminal: Terminal) -> CommandResult {
        match &self.command {
            Command::Run(args) => args.execute(terminal),
            Command::Attribute(args) => args.execute(terminal),
            Command::Fleet(args) => args.execute(terminal),
            Command::Optimum(args) => args.execute(terminal),
            Command::Levers(args) => args.execute(terminal),
            Command::Accelerate(args) => args.execute(terminal),
            Command::Label(args) => args.execute(terminal),
            Command::Log(args) => args.execute(terminal),
            Command::Study(args) => args.execute(terminal),
            Command::Report(args) => args.execute(terminal),
            Command::Whatif(args) => args.execute(terminal),
            Command::Compare(args) => args.execute(terminal),
            Command::Validate(args) => args.execute(terminal),
            Command::Calibrate(args) => args.execute(terminal),
            Command::Rig(args) => args.execute(terminal),
            Command::Losses(args) => args.execute(terminal),
            Command::Belt(args) => args.execute(terminal),
            Command::Convert(args) => args.execute(terminal),
            Command::New(args) => args.execute(terminal),
            Command::Fmu(args) => args.execute(terminal),
            Command::List(args) => args.execute(terminal),
            Command::Show(args) => args.execute(terminal),
            Command::Explain(args) => args.execute(terminal),
            Command::Check(args) => args.execute(terminal),
            Command::Schema(args) => shell::schema(args),
            Command::Assumptions(args) => shell::assumptions(args),
            Command::Completions(args) => shell::completions(args),
            Command::Man(args) => shell::man(args),
        }
    }
}
