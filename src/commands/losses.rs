//! `losses`: what each part of a transmission loses, at one operating point or over a grid of them.

mod files;
mod plan;
mod plots;
mod text;

use std::cell::RefCell;
use std::io;

use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::loss_table::{MapPart, write_map};
use cvtcycle::output::losses::{FlagCount, LossRow};

use super::Context;
use super::run::files::Written;
use crate::args::{self as inputs, Offering};
use crate::print::stream;
use crate::print::{Answer, FAILED, Reply};
use plan::Plan;

/// Arguments of `losses`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle losses --ratio low --speed 2500 --temp 80
  cvtcycle losses --speed 1000..4000:250 --temp 25,50,75,95 --format csv
  cvtcycle losses --ratio high --speed 2000..4000 --torque 0..100:10 --out high_map
  cvtcycle losses --vehicle rover_216_5mt --gear 3 --torque 50
  cvtcycle losses --ratio high..low:0.2 --speed 500..6000:500 --temp -10..90:25 --as-map pump > pump.csv

A numeric option takes a number, a list (25,50,75), a range with a step (1000..4000:250, both ends belong to it) or
without one (1000..4000), or these mixed. Losses are torques at the input shaft; the launch clutch is locked.")]
pub struct Args {
    /// The car whose transmission is on the bench
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Offering(inputs::vehicles), hide_possible_values = true)]
    vehicle: String,
    /// Belt ratio of a CVT: a number, `low` or `high` [default: low]
    #[arg(long, value_name = "R|low|high", allow_hyphen_values = true)]
    ratio: Option<String>,
    /// Gear of a manual box [default: all]
    #[arg(long, value_name = "GEAR", allow_hyphen_values = true)]
    gear: Option<String>,
    /// Speed of the input shaft, rpm, above 0
    #[arg(
        long,
        value_name = "RPM",
        default_value = "2500",
        allow_hyphen_values = true
    )]
    speed: String,
    /// Torque taken from the output shaft, after the final drive, Nm; negative where the wheels drive
    #[arg(
        long,
        value_name = "NM",
        default_value = "0",
        allow_hyphen_values = true
    )]
    torque: String,
    /// Transmission oil in the sump, degC
    #[arg(
        long,
        value_name = "DEGC",
        default_value = "80",
        allow_hyphen_values = true
    )]
    temp: String,
    /// Belt and the oil sprayed off it, degC [default: in steady state over the sump]
    #[arg(long, value_name = "DEGC", allow_hyphen_values = true)]
    belt_temp: Option<String>,
    /// Secondary pressure, bar [default: the clamp law's at --throttle]
    #[arg(long, value_name = "BAR", allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Throttle that the clamp law sees, 0 to 1 [default: 0]
    #[arg(long, value_name = "X", allow_hyphen_values = true)]
    throttle: Option<String>,
    /// Transmission oil
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Offering(inputs::lubricants), hide_possible_values = true)]
    lubricant: Option<String>,
    /// Override one value of the vehicle; repeatable. `lubricant.KEY` reaches its oil
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Reading of the belt model: smooth (as in driving), appendix_c or chapter_8 (as printed in the thesis)
    #[arg(long, value_name = "NAME", default_value = "smooth", value_parser = Offering(formulations), hide_possible_values = true)]
    formulation: String,
    /// Write one component's loss as a map that a vehicle file can name in place of the model (CSV): belt, pump,
    /// input_shaft, clutch_drag, final_drive, or box of a manual one. --torque is then the map's own: at the secondary
    /// pulley (belt, final_drive) or at the input shaft (box)
    #[arg(long, value_name = "COMPONENT", value_parser = Offering(map_parts), hide_possible_values = true, conflicts_with_all = ["json", "format"])]
    as_map: Option<String>,
    /// Print one JSON object instead of a table
    #[arg(long, conflicts_with = "format")]
    json: bool,
    /// What to print: a table for people, or CSV with all columns
    #[arg(long, value_enum, value_name = "FORMAT", default_value = "table")]
    format: Format,
    /// Write losses.csv, summary.json and plots (SVG) into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<std::path::PathBuf>,
    /// Replace the files of an earlier run in the --out directory
    #[arg(long, requires = "out")]
    force: bool,
    /// Print no table and no notes; --json, --format csv and --as-map still print
    #[arg(long, short)]
    quiet: bool,
}

/// What standard output carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// A table for people
    Table,
    /// All columns as CSV
    Csv,
}

fn formulations() -> Vec<&'static str> {
    Formulation::NAMES.iter().map(|(name, _)| *name).collect()
}

fn map_parts() -> Vec<&'static str> {
    MapPart::NAMES.iter().map(|(name, _)| *name).collect()
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let mut plan = plan::plan(args)?;
    let out = plan.out.take();
    if let Some(part) = plan.map {
        return map(args, &plan, part, out);
    }
    let flags = RefCell::new(FlagCount::default());
    let written = match out {
        Some(dir) => Some(files::write(dir, &plan)?),
        None => None,
    };
    let counted = |row: LossRow| {
        flags.borrow_mut().add(row.answer.flags);
        row
    };
    let rows = || plan.grid.rows(&plan.bench).map(counted);
    let mut stdout = String::new();
    if args.json {
        stream::to_stdout(|out| files::write_json(out, &plan, rows()))?;
    } else if args.format == Format::Csv {
        stream::to_stdout(|out| files::write_csv(out, &plan, rows()))?;
    } else if args.quiet {
        rows().for_each(drop);
    } else {
        stdout = text::table(&plan, rows(), context.paint);
        stdout += &written.as_ref().map_or_else(String::new, Written::text);
    }
    let mut stderr = written
        .as_ref()
        .map_or_else(String::new, Written::left_over_text);
    let open = flags
        .borrow()
        .named()
        .find(|(name, _)| *name == "not_converged");
    if let Some((_, count)) = open {
        stderr += &format!(
            "cvtcycle: {count} of {} points not converged\n",
            plan.grid.len()
        );
    }
    Ok(Answer {
        stdout,
        stderr,
        code: if open.is_some() { FAILED } else { 0 },
    })
}

fn map(
    args: &Args,
    plan: &Plan,
    part: MapPart,
    out: Option<cvtcycle::output::files::OutputDir>,
) -> Reply {
    let write = |out: &mut dyn io::Write| write_map(out, &plan.bench, part, &plan.grid);
    let Some(mut dir) = out else {
        stream::to_stdout(write)?;
        return Ok(Answer::default());
    };
    let written = files::write_map(
        &mut dir,
        plan,
        args.as_map.as_deref().unwrap_or_default(),
        write,
    )
    .and_then(|()| Written::commit(dir));
    let written = written?;
    let stdout = if args.quiet {
        String::new()
    } else {
        written.text().trim_start().to_owned()
    };
    Ok(Answer {
        stdout,
        stderr: written.left_over_text(),
        code: 0,
    })
}
