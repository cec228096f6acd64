//! `losses`: loss of each transmission component at one operating point or over a grid.

mod files;
mod plan;
mod plots;
mod tables;

use std::cell::RefCell;
use std::io;

use clap::Args;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::loss_table::{MapPart, write_map};
use cvtcycle::output::losses::{FlagCount, LossRow};

use super::Execute;
use crate::args::{FormulationArgs, Names, OutArgs, OutputArgs, VehicleArgs, names_of};
use crate::print::{CommandOutput, CommandResult, Results, Terminal, WrittenFiles, to_stdout};
use cvtcycle::config::Problems;
use plan::LossesPlan;

/// Arguments of `losses`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.help("Write losses.csv, summary.json and plots (SVG) into this directory")),
    after_help = "\
Examples:
  cvtcycle losses --ratio low --speed 2500 --temp 80
  cvtcycle losses --speed 1000..4000:250 --temp 25,50,75,95 --format csv
  cvtcycle losses --ratio high --speed 2000..4000 --torque 0..100:10 --out high_map
  cvtcycle losses --vehicle rover_216_5mt --gear 3 --torque 50
  cvtcycle losses --ratio high..low:0.2 --speed 500..6000:500 --temp -10..90:25 --as-map pump > pump.csv

A numeric option takes a number, a list (25,50,75), a range with a step (1000..4000:250, both ends included) or without
one (1000..4000), or these mixed. Losses are torques at the input shaft; the launch clutch is locked."
)]
pub struct LossesArgs {
    #[command(flatten)]
    car: VehicleArgs,
    /// Belt ratio of a CVT: a number, `low` or `high` [default: low]
    #[arg(long, value_name = "R|low|high", allow_hyphen_values = true)]
    ratio: Option<String>,
    /// Gear of a manual gearbox [default: all]
    #[arg(long, value_name = "GEAR", allow_hyphen_values = true)]
    gear: Option<String>,
    /// Speed of the input shaft, rpm, above 0 [default: 2500]
    #[arg(long, value_name = "RPM", allow_hyphen_values = true)]
    speed: Option<String>,
    /// Torque taken from the output shaft, after the final drive, Nm; negative in overrun [default: 0]
    #[arg(long, value_name = "NM", allow_hyphen_values = true)]
    torque: Option<String>,
    /// Transmission oil in the sump, degC [default: 80]
    #[arg(long, value_name = "DEGC", allow_hyphen_values = true)]
    temp: Option<String>,
    /// Belt and the oil sprayed off it, degC [default: steady state above the sump]
    #[arg(long, value_name = "DEGC", allow_hyphen_values = true)]
    belt_temp: Option<String>,
    /// Secondary pressure, bar [default: that of the clamping law at --throttle]
    #[arg(long, value_name = "BAR", allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Throttle for the clamping law, 0 to 1 [default: 0]
    #[arg(long, value_name = "X", allow_hyphen_values = true)]
    throttle: Option<String>,
    #[command(flatten)]
    formulation: FormulationArgs,
    /// Write the loss of one component as a map (CSV) that a vehicle file can use in place of the model: belt, pump,
    /// input_shaft, clutch_drag, final_drive, or box of a manual gearbox. --torque is then that of the map: at the
    /// secondary pulley (belt, final_drive) or at the input shaft (box)
    #[arg(long, value_name = "COMPONENT", value_parser = Names(map_parts), hide_possible_values = true, conflicts_with_all = ["json", "format"])]
    as_map: Option<String>,
    /// What to print: a table for people, or CSV with all columns
    #[arg(
        long,
        value_enum,
        value_name = "FORMAT",
        default_value = "table",
        conflicts_with = "json"
    )]
    format: LossesFormat,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    output: OutputArgs,
}

/// Form of standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum LossesFormat {
    /// A table for people
    Table,
    /// All columns as CSV
    Csv,
}

fn map_parts() -> Vec<&'static str> {
    names_of(&MapPart::NAMES)
}

impl Execute for LossesArgs {
    type Plan = LossesPlan;

    fn plan(&self, problems: &mut Problems) -> Option<LossesPlan> {
        plan::plan(self, problems)
    }

    fn run(&self, mut plan: LossesPlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        if let Some(part) = plan.map {
            return self.write_map(&plan, part, out);
        }
        let files = match out {
            Some(dir) => files::write(dir, &plan)?,
            None => WrittenFiles::default(),
        };
        let flags = RefCell::new(FlagCount::default());
        let counted = |row: LossRow| {
            flags.borrow_mut().add(row.answer.flags);
            row
        };
        let rows = || plan.grid.rows(&plan.bench).map(counted);
        let mut table = String::new();
        if self.output.json() {
            to_stdout(|out| files::write_json(out, &plan, rows()))?;
        } else if self.format == LossesFormat::Csv {
            to_stdout(|out| files::write_csv(out, &plan, rows()))?;
        } else {
            table = tables::table(&plan, rows(), terminal.stdout);
        }
        let flags = flags.into_inner();
        let unsolved = flags.named().find(|(name, _)| *name == "not_converged");
        let failure = unsolved
            .map(|(_, count)| format!("{count} of {} points not converged", plan.grid.len()));
        let results = Results {
            failures: failure.into_iter().collect(),
            files,
            ..Results::default()
        };
        let printed = self.output.json() || self.format == LossesFormat::Csv;
        Ok(if printed {
            results.warnings()
        } else {
            results.output(&self.output, || table)
        })
    }
}

impl LossesArgs {
    fn write_map(&self, plan: &LossesPlan, part: MapPart, out: Option<OutputDir>) -> CommandResult {
        let write = |out: &mut dyn io::Write| write_map(out, &plan.bench, part, &plan.grid);
        let Some(dir) = out else {
            to_stdout(write)?;
            return Ok(CommandOutput::default());
        };
        let name = self.as_map.as_deref().unwrap_or_default();
        let results = Results {
            files: files::write_map(dir, plan, name, write)?,
            ..Results::default()
        };
        Ok(results.output(&self.output, String::new))
    }
}
