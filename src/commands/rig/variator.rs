//! `rig variator`: the belt alone on its rig, slip against output torque.

mod plan;
mod tables;

use clap::Args;
use cvtcycle::config::Problems;
use cvtcycle::report::charts::variator_figures;

use crate::args::{FormulationArgs, OutArgs, TableOutputArgs, VehicleArgs};
use crate::commands::Execute;
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, stream};
use plan::VariatorPlan;

/// Arguments of `rig variator`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.help("Write curves.csv, points.csv, summary.json and plots (SVG) into this directory")),
    mut_arg("format", |format| format.help("What to print: a line for each curve, or CSV with all points")),
    after_help = "\
Examples:
  cvtcycle rig variator
  cvtcycle rig variator --ratio low --pressure 15..35:5 --torque 0..300:5 --format csv
  cvtcycle rig variator --ratio high --pressure 11 --speed 1500 --out variator

A numeric option takes a number, a list (15,25,35), a range with a step (15..35:5, both ends included) or without one \
(15..35), or these mixed. Torques are those at the secondary pulley. Rows beyond the limits of the rig are flagged, not \
removed: 400 Nm and 250 Nm at secondary and primary, 40 bar, 3000 rpm at either shaft."
)]
pub struct RigVariatorArgs {
    #[command(flatten)]
    car: VehicleArgs,
    /// Belt ratio: a number, `low` (of the vehicle) or `high` (0.5, of the rig)
    #[arg(long, value_name = "R|low|high", default_value = plan::RATIOS, allow_hyphen_values = true)]
    ratio: String,
    /// Secondary pressure, bar [default: 15..35:5 above ratio 1, 10..12:0.5 below]
    #[arg(long, value_name = "BAR", allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Primary speed, rpm [default: 2000, or less to keep the secondary at 3000]
    #[arg(long, value_name = "RPM", allow_hyphen_values = true)]
    speed: Option<String>,
    /// Belt temperature, degC
    #[arg(
        long,
        value_name = "DEGC",
        default_value = "85",
        allow_hyphen_values = true
    )]
    temp: String,
    /// Torque at the secondary pulley, Nm [default: from 0 to beyond the torque capacity]
    #[arg(long, value_name = "NM", allow_hyphen_values = true)]
    torque: Option<String>,
    /// Pulses per turn of the speed sensors, for the resolution; not published for this rig (60 on the first one, 4.2.4)
    #[arg(
        long,
        value_name = "N",
        default_value = "60",
        allow_hyphen_values = true
    )]
    pulses: String,
    #[command(flatten)]
    formulation: FormulationArgs,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    output: TableOutputArgs,
}

impl Execute for RigVariatorArgs {
    type Plan = VariatorPlan;

    fn plan(&self, problems: &mut Problems) -> Option<VariatorPlan> {
        plan::plan(self, problems)
    }

    fn run(&self, mut plan: VariatorPlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        let found = plan.solve();
        let files = WrittenFiles::write(out, |dir| {
            dir.write("curves.csv", |out| found.write_curves(out))?;
            dir.write("points.csv", |out| found.write_points(out))?;
            dir.write("summary.json", |out| found.write_json(out))?;
            for (name, svg) in variator_figures(&found) {
                dir.put(name, svg)?;
            }
            Ok("")
        })?;
        stream(
            &self.output,
            |out| found.write_json(out),
            |out| found.write_points(out),
        )?;
        let results = Results::new(String::new(), Vec::new(), files);
        Ok(results.table_output(&self.output, || tables::tables(&found, terminal.stdout)))
    }
}
