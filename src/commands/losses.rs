//! `losses`: loss of each transmission component at one operating point or over a grid.

mod plan;
mod tables;

use std::cell::Cell;
use std::io;

use clap::Args;
use cvtcycle::config::Problems;
use cvtcycle::output::Flags;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::loss_forms::{MapForm, write_form};
use cvtcycle::output::loss_table::{MapPart, write_map};
use cvtcycle::output::losses::{Axis, LossRow};
use cvtcycle::report::charts::loss_figures;

use super::Execute;
use crate::args::{FormulationArgs, Names, OutArgs, TableOutputArgs, VehicleArgs, choice_names};
use crate::print::{
    CommandOutput, CommandResult, Form, Paint, Results, Terminal, WrittenFiles, json_text, stream,
    to_stdout,
};
use plan::LossesPlan;

/// Maximum number of points drawn.
const MAX_DRAWN: usize = 100_000;
const NOT_DRAWN: &str = "  no plots: more than 100000 points\n";

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
  cvtcycle losses --ratio 1 --speed 600..6000:600 --torque -60..140:20 --as-map box --map-form vtlm > ratio_1.vtlm

A numeric option takes a number, a list (25,50,75), a range with a step (1000..4000:250, both ends included) or without \
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
    /// Torque into the input shaft, Nm, in place of --torque; in a CVT the clamping law sees it over full load as throttle
    #[arg(
        long,
        value_name = "NM",
        allow_hyphen_values = true,
        conflicts_with = "torque"
    )]
    input_torque: Option<String>,
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
    /// input_shaft, clutch_drag, seal_ring, final_drive, or the whole box. --torque is then that of the map: at the
    /// secondary pulley (belt, final_drive) or at the input shaft (box)
    #[arg(long, value_name = "COMPONENT", value_parser = Names(|| choice_names(&MapPart::NAMES)), hide_possible_values = true, conflicts_with_all = ["json", "format"])]
    as_map: Option<String>,
    /// Form of a map of the whole box: csv, as a vehicle file can name it; vtlm, a transmission loss map of VECTO; gem, the table of 40 CFR
    /// 1037.565(g), with its grid where none is given; modelica, tables over speed and kinematic viscosity
    #[arg(long, value_name = "FORM", default_value = "csv", value_parser = Names(|| choice_names(&MapForm::NAMES)), hide_possible_values = true)]
    map_form: String,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    output: TableOutputArgs,
}

impl Execute for LossesArgs {
    type Plan = LossesPlan;

    fn plan(&self, problems: &mut Problems) -> Option<LossesPlan> {
        plan::plan(self, problems)
    }

    fn run(&self, plan: LossesPlan, terminal: Terminal) -> CommandResult {
        let LossesPlan {
            losses,
            map,
            form,
            out,
        } = plan;
        if let Some(part) = map {
            let (bench, grid) = (&losses.bench, &losses.grid);
            let write = |out: &mut dyn io::Write| match form {
                MapForm::Csv => write_map(out, bench, part, grid),
                form => write_form(out, form, bench, grid),
            };
            let head = losses.json_head(self.as_map.as_deref());
            return self.write_map(&head, form, out, write);
        }
        let files = WrittenFiles::write(out, |dir| {
            dir.write("losses.csv", |out| losses.write_csv(out, losses.rows()))?;
            dir.write("summary.json", |out| losses.write_json(out, losses.rows()))?;
            if losses.grid.len() > MAX_DRAWN {
                return Ok(NOT_DRAWN);
            }
            for (name, svg) in loss_figures(&losses) {
                dir.put(&name, svg)?;
            }
            Ok("")
        })?;
        let unsolved = Cell::new((0_usize, None));
        let look = |row: &LossRow| {
            if row.answer.flags.contains(Flags::NOT_CONVERGED) {
                let (count, first) = unsolved.get();
                unsolved.set((count + 1, first.or(Some(row.requested))));
            }
        };
        let rows = || losses.rows().inspect(look);
        let json = |out: &mut dyn io::Write| losses.write_json(out, rows());
        stream(&self.output, json, |out| losses.write_csv(out, rows()))?;
        let table = match self.output.is_streamed() {
            true => String::new(),
            false => tables::table(&losses, rows(), terminal.stdout),
        };
        let (count, all) = (unsolved.get().0, losses.grid.len());
        let failure = |first: [f64; Axis::COUNT]| {
            let has = if count == 1 { "has" } else { "have" };
            let first = losses.values_in_words(&first, &Axis::ALL);
            format!("check failed: {count} of {all} points {has} no solution, first at {first}")
        };
        let failures = unsolved.get().1.map(failure).into_iter().collect();
        let results = Results::new(String::new(), failures, files);
        Ok(results.table_output(&self.output, || table))
    }
}

impl LossesArgs {
    /// Prints the map of a component, or writes it with the head of the JSON object, which marks the directory as a result.
    fn write_map(
        &self,
        head: &serde_json::Value,
        form: MapForm,
        out: Option<OutputDir>,
        write: impl FnOnce(&mut dyn io::Write) -> io::Result<()>,
    ) -> CommandResult {
        if out.is_none() {
            to_stdout(Form::Text(Paint::NONE), write)?;
            return Ok(CommandOutput::default());
        }
        let name = self.as_map.as_deref().unwrap_or_default();
        let files = WrittenFiles::write(out, |dir| {
            let file = format!("map_{name}.{}", form.ending());
            dir.write(&file, |out| write(out))?;
            dir.put("summary.json", json_text(head)?)?;
            Ok("")
        })?;
        let results = Results::new(String::new(), Vec::new(), files);
        Ok(results.output(&self.output.output, String::new))
    }
}
