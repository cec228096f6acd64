//! `rig variator`: the belt alone on its rig, slip against output torque.

mod files;
mod plan;
mod plots;
mod text;

use cvtcycle::model::transmission::cvt::variator::Formulation;

use crate::args::{self as inputs, Offering};
use crate::commands::Context;
use crate::commands::run::files::Written;
use crate::print::stream;
use crate::print::{Answer, Reply};

/// Arguments of `rig variator`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle rig variator
  cvtcycle rig variator --ratio low --pressure 15..35:5 --torque 0..300:5 --format csv
  cvtcycle rig variator --ratio high --pressure 11 --speed 1500 --out variator

A numeric option takes a number, a list (15,25,35), a range with a step (15..35:5, both ends belong to it) or without one
(15..35), or these mixed. Torques are those at the secondary pulley. Rows beyond what the rig can do are flagged, not left
out: 400 Nm and 250 Nm at secondary and primary, 40 bar, 3000 rpm at either shaft.")]
pub struct Args {
    /// The car whose variator is on the rig
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Offering(inputs::vehicles), hide_possible_values = true)]
    vehicle: String,
    /// Belt ratio: a number, `low` (the car's) or `high` (0.5, the rig's)
    #[arg(
        long,
        value_name = "R|low|high",
        default_value = "low,high",
        allow_hyphen_values = true
    )]
    ratio: String,
    /// Secondary pressure, bar [default: 15..35:5 above ratio 1, 10..12:0.5 below]
    #[arg(long, value_name = "BAR", allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Primary speed, rpm [default: 2000, or what keeps the secondary at 3000]
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
    /// Torque at the secondary pulley, Nm [default: from 0 to past what the belt carries]
    #[arg(long, value_name = "NM", allow_hyphen_values = true)]
    torque: Option<String>,
    /// Pulses a turn of the shafts' speed pick-ups, for the counting resolution; not printed for this rig (60 on the first one, 4.2.4)
    #[arg(
        long,
        value_name = "N",
        default_value = "60",
        allow_hyphen_values = true
    )]
    pulses: String,
    /// Transmission oil
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Offering(inputs::lubricants), hide_possible_values = true)]
    lubricant: Option<String>,
    /// Override one value of the vehicle; repeatable. `lubricant.KEY` reaches its oil
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Reading of the belt model: smooth, appendix_c or chapter_8; the rules of driving stay
    #[arg(long, value_name = "NAME", default_value = "smooth", value_parser = Offering(formulations), hide_possible_values = true)]
    formulation: String,
    /// Print one JSON object instead of a table
    #[arg(long, conflicts_with = "format")]
    json: bool,
    /// What to print: a line a curve for people, or CSV with all points
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "table")]
    format: Format,
    /// Write curves.csv, points.csv, summary.json and plots (SVG) into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<std::path::PathBuf>,
    /// Replace the files of an earlier run in the --out directory
    #[arg(long, requires = "out")]
    force: bool,
    /// Print no table, only problems; --json and --format csv still print
    #[arg(long, short)]
    quiet: bool,
}

/// What standard output carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// A line a curve
    Table,
    /// All points as CSV
    Csv,
}

fn formulations() -> Vec<&'static str> {
    Formulation::NAMES.iter().map(|(name, _)| *name).collect()
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let mut plan = plan::plan(args)?;
    let out = plan.out.take();
    let curves = plan.curves();
    let written = match out {
        Some(dir) => Some(files::write(dir, &plan, &curves)?),
        None => None,
    };
    let mut stdout = String::new();
    if args.json {
        stream::to_stdout(|out| files::write_json(out, &plan, &curves))?;
    } else if args.format == Format::Csv {
        stream::to_stdout(|out| files::write_points(out, &curves))?;
    } else if !args.quiet {
        stdout = text::tables(&plan, &curves, context.paint);
        stdout += &written.as_ref().map_or_else(String::new, Written::text);
    }
    let stderr = written
        .as_ref()
        .map_or_else(String::new, Written::left_over_text);
    Ok(Answer {
        stdout,
        stderr,
        code: 0,
    })
}
