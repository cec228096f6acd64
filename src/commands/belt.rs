//! `belt`: the belt model at the operating points of a table, row by row.

mod sink;

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use clap::Args;
use cvtcycle::config::{Bound, Problems};
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::file::OutputFile;
use cvtcycle::output::files::listed;
use cvtcycle::output::record::Manifest;
use cvtcycle::validate::belt::{self, Counts, Done, Job, Model};
use serde_json::{Map, Value, json};

use super::Execute;
use crate::args::problems::bad_value;
use crate::args::{FormulationArgs, OutArgs, OutputArgs, VehicleArgs, number};
use crate::print::{CommandOutput, CommandResult, Terminal};
use sink::RowSink;

/// Maximum number of names that a note lists.
const MAX_LISTED: usize = 6;

/// Arguments of `belt`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.value_name("FILE.csv").help("Write the table into this file instead of standard output")),
    after_help = "\
Example, a point in low ratio of the thesis's Appendix C:
  printf 'ratio,input_speed_rpm,secondary_pressure_bar,output_torque_nm\\n2.416,2000,30,60\\n' | cvtcycle belt --points - --formulation appendix_c

Columns that are read: ratio (I = R_sec / R_pri), input_speed_rpm, secondary_pressure_bar,
output_torque_nm (at the secondary pulley); where given, in place of the vehicle's values:
formulation, pulley_half_angle_deg, wedge_half_angle_deg, band_offset_mm, band_friction,
segment_friction, band_count, primary_on_stop (1: no primary deflection, 0: full; not given:
full in appendix_c, else falling to none towards the vehicle's lowest ratio), belt_temp_degc.
An empty cell counts as not given. `case` is passed through. All losses are torques at the
primary shaft.

Without belt_temp_degc friction is that at 85 degC, without film lift-off; with it, the friction
law of the fluid applies, and band_friction is its value at 85 degC. appendix_c and chapter_8
start from the printed frictions, have no film, and are not defined at ratio 1 and at rest.
Column `flags` lists the limits that a point exceeds; its values are not changed:
  outside_ratio_range, above_capacity, gross_slip, no_active_arc, overrun,
  above_pressure_cap, below_pressure_floor, overspeed, outside_validity"
)]
pub struct BeltArgs {
    /// Table of operating points; - for standard input
    #[arg(long, value_name = "FILE.csv")]
    points: String,
    #[command(flatten)]
    formulation: FormulationArgs,
    #[command(flatten)]
    car: VehicleArgs,
    /// Band speed for the travel columns: 0 the mean of what the pulleys require, 0.5 that of the smaller pulley, -0.5 of the larger [default: -0.5 in smooth, else 0]
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true)]
    band_speed: Option<String>,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    output: OutputArgs,
}

impl Execute for BeltArgs {
    /// Computed rows, the JSON object without them, and the output printed along with them.
    type Plan = (RowSink, Value, CommandOutput);

    /// Reads and computes row by row, because a table may exceed memory. Reports the problems of all rows.
    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        let formulation = self.formulation.get(problems);
        let setup = self.car.load(Formulation::default(), problems);
        let range = Bound::closed(-1.0, 1.0);
        let share = self.band_speed.as_ref();
        let share = share.map(|text| problems.take(number("--band-speed", text, range, "")));
        let model = setup
            .as_ref()
            .and_then(|setup| Model::new(setup, share.flatten()));
        let hint = "`cvtcycle list vehicles` shows which have a CVT";
        self.car.need_cvt(setup.as_ref(), hint, problems);
        let file = self
            .out
            .path(problems)
            .filter(|path| path.as_os_str() != "-");
        let file = file.and_then(|path| problems.take(OutputFile::create(path, self.out.force)));
        let out = file.as_ref().map(|out| out.path().display().to_string());
        // Computes points only if all other input is good, since they would be dropped otherwise.
        let model = model.filter(|_| problems.is_empty());
        let reader = problems.take(open(&self.points))?;
        let name = match self.points.as_str() {
            "-" => "standard input",
            file => file,
        };
        let mut rows = RowSink::new(file, self.output.json());
        let job = Job {
            model,
            formulation,
            rows: &mut rows,
        };
        let Done { counts, ignored } = problems.take(belt::read(name, reader, job))?;
        let setup = setup?;
        let quiet = self.output.quiet;
        let ignored = listed(&ignored, MAX_LISTED);
        let stderr = match ignored.is_empty() || quiet {
            true => String::new(),
            false => format!("cvtcycle: {name}: columns computed anew, not read: {ignored}\n"),
        };
        let stdout = out.filter(|_| !quiet && !self.output.json());
        let output = CommandOutput {
            stdout: stdout.map_or_else(String::new, |out| counts.text(&out)),
            stderr,
            ..CommandOutput::default()
        };
        let head = head(&setup.name, &setup.oils().0.name, &counts);
        Some((rows, head, output))
    }

    fn run(&self, (rows, head, output): Self::Plan, _: Terminal) -> CommandResult {
        rows.finish(&head)?;
        Ok(output)
    }
}

fn open(points: &str) -> Result<Box<dyn BufRead>, Problems> {
    let unreadable = |why: &str, hint: &str| {
        let allowed = "a readable file, or - for standard input";
        let message = format!("cannot read `{points}`: {why}");
        Err(bad_value("--points", points, allowed, &message, hint).into())
    };
    if points == "-" {
        return Ok(Box::new(io::stdin().lock()));
    }
    if Path::new(points).is_dir() {
        return unreadable("it is a directory", "name a file in that directory");
    }
    let hint = "check the path and its permissions; it is relative to the current directory";
    match File::open(points) {
        Ok(file) => Ok(Box::new(BufReader::with_capacity(1 << 16, file))),
        Err(error) => unreadable(&error.to_string(), hint),
    }
}

/// Builds the JSON object without its rows.
fn head(vehicle: &str, lubricant: &str, counts: &Counts) -> Value {
    let object = |counts: &mut dyn Iterator<Item = (&'static str, u64)>| {
        counts
            .map(|(name, count)| (name.to_owned(), json!(count)))
            .collect::<Map<_, _>>()
    };
    Manifest::new(1).with(&json!({
        "vehicle": vehicle,
        "lubricant": lubricant,
        "points": counts.points,
        "status": object(&mut counts.by_status()),
        "flags": object(&mut counts.by_flag()),
    }))
}
