//! `belt`: the belt model at many operating points, row by row.

mod sink;

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::PathBuf;

use cvtcycle::config::setup::{self, Options, Setup};
use cvtcycle::config::{Bound, Problems};
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::file::OutputFile;
use cvtcycle::study::points::{self, Counts, Done, Job, Model};
use serde_json::{Map, Value, json};

use super::Context;
use crate::args::{self as inputs, Offering};
use crate::print::{Answer, Reply};
use sink::Offer;

/// Arguments of `belt`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Example, a point in low ratio as the thesis's own program has it:
  printf 'ratio,input_speed_rpm,secondary_pressure_bar,output_torque_nm\\n2.416,2000,30,60\\n' | cvtcycle belt --points - --formulation appendix_c

Columns read: ratio (I = R_sec / R_pri), input_speed_rpm, secondary_pressure_bar,
output_torque_nm (at the secondary pulley); where given, in place of the vehicle's values:
formulation, pulley_half_angle_deg, wedge_half_angle_deg, band_offset_mm, band_friction,
segment_friction, band_count, primary_on_stop (1: no primary deflection, 0: full; not given:
full in appendix_c, else falling to none towards the vehicle's lowest ratio), belt_temp_degc.
An empty cell counts as not given. `case` is passed through. All losses are torques at the
primary shaft.

Without belt_temp_degc friction stands as at 85 degC and no film lifts the bands; with it, the
fluid's law holds, and band_friction is its value at 85 degC. appendix_c and chapter_8 start
from the printed frictions, know no film, and are not defined at ratio 1 and at rest. Column
`flags` names what a point departs from; nothing is clamped for it:
  outside_ratio_range, above_capacity, gross_slip, no_active_arc, overrun,
  above_pressure_cap, below_pressure_floor, overspeed, outside_validity")]
pub struct Args {
    /// Table of operating points; - for standard input
    #[arg(long, value_name = "FILE.csv")]
    points: String,
    /// Reading of the belt model where a row names none: smooth (for driving), appendix_c or chapter_8 (as printed)
    #[arg(long, value_name = "NAME", default_value = "smooth", value_parser = Offering(formulations), hide_possible_values = true)]
    formulation: String,
    /// The car whose belt it is
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Offering(inputs::vehicles), hide_possible_values = true)]
    vehicle: String,
    /// Transmission oil
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Offering(inputs::lubricants), hide_possible_values = true)]
    lubricant: Option<String>,
    /// Override one value of the vehicle; repeatable. `lubricant.KEY` reaches its oil
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Adopted band speed for the travel columns: 0 the mean of what the pulleys require, 0.5 the smaller pulley's, -0.5 the larger one's
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0",
        allow_hyphen_values = true
    )]
    band_speed: String,
    /// Write the table into this file instead of standard output
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    /// Replace the --out file if it exists
    #[arg(long, requires = "out")]
    force: bool,
    /// Print one JSON object, with counts and rows, instead of the table
    #[arg(long)]
    json: bool,
    /// Print no notes and no counts
    #[arg(long, short)]
    quiet: bool,
}

fn formulations() -> Vec<&'static str> {
    Formulation::NAMES.iter().map(|(name, _)| *name).collect()
}

/// What the options say, as far as they are good.
struct Asked {
    setup: Option<Setup>,
    model: Option<Model>,
    formulation: Formulation,
    out: Option<OutputFile>,
}

/// Runs the command.
pub fn answer(args: &Args, _: Context) -> Reply {
    let mut problems = Problems::default();
    let mut asked = asked(args, &mut problems);
    let file = if args.points == "-" {
        "standard input"
    } else {
        args.points.as_str()
    };
    let out = asked
        .out
        .as_ref()
        .map(|out| out.path().display().to_string());
    let reader = problems.take(open(&args.points));
    let mut offer = Offer::new(asked.out.take(), args.json);
    let done = reader.and_then(|reader| {
        let job = Job {
            model: asked.model.take(),
            formulation: asked.formulation,
            rows: &mut offer,
        };
        problems.take(points::read(file, reader, job))
    });
    problems.finish()?;
    let (Some(Done { counts, ignored }), Some(sink)) = (done, offer.sink) else {
        unreachable!("what is missing has left a problem");
    };
    sink.finish(&head(&asked, &counts))?;
    let mut reply = Answer::default();
    if !ignored.is_empty() && !args.quiet {
        reply.stderr = format!(
            "cvtcycle: {file}: computed anew, not read: {}\n",
            some(&ignored)
        );
    }
    if let Some(out) = out.filter(|_| !args.quiet && !args.json) {
        reply.stdout = counts.text(&out);
    }
    Ok(reply)
}

fn asked(args: &Args, problems: &mut Problems) -> Asked {
    let formulation = problems
        .take(inputs::word(
            "--formulation",
            &args.formulation,
            &Formulation::NAMES,
        ))
        .unwrap_or_default();
    let options = Options {
        lubricant: args.lubricant.clone(),
        set: args.set.clone(),
        ..Options::default()
    };
    let setup = problems.take(setup::load(&args.vehicle, "--vehicle", &options));
    let band_speed = problems.take(inputs::number(
        "--band-speed",
        &args.band_speed,
        Bound::closed(-1.0, 1.0),
        "",
    ));
    let model = setup.as_ref().zip(band_speed).and_then(|(setup, share)| {
        let model = Model::new(setup, share);
        if model.is_none() {
            let message = format!("{} has no belt", args.vehicle);
            let hint = "`cvtcycle list vehicles` shows which have a CVT";
            problems.add(inputs::bad_value(
                "--vehicle",
                &args.vehicle,
                "a vehicle with a CVT",
                message,
                hint.to_owned(),
            ));
        }
        model
    });
    let file = args.out.as_ref().filter(|path| path.as_os_str() != "-");
    let out = file.map(|path| OutputFile::create(path, args.force).map_err(Problems::from));
    let out = out.and_then(|out| problems.take(out));
    // Points are computed only where everything else is good: what is bad is said without delay.
    let model = if problems.is_empty() { model } else { None };
    Asked {
        setup,
        model,
        formulation,
        out,
    }
}

fn open(points: &str) -> Result<Box<dyn BufRead>, Problems> {
    if points == "-" {
        return Ok(Box::new(io::stdin().lock()));
    }
    let unreadable = |why: String, hint: &str| {
        let message = format!("cannot read `{points}`: {why}");
        inputs::bad_value(
            "--points",
            points,
            "a readable file, or - for standard input",
            message,
            hint.to_owned(),
        )
    };
    if std::path::Path::new(points).is_dir() {
        return Err(unreadable(
            "it is a directory".to_owned(),
            "name a file in that directory",
        )
        .into());
    }
    match File::open(points) {
        Ok(file) => Ok(Box::new(BufReader::with_capacity(1 << 16, file))),
        Err(error) => Err(unreadable(
            error.to_string(),
            "check the path and its permissions; it is taken from the current directory",
        )
        .into()),
    }
}

/// Names, up to a number that fits into a line.
fn some(names: &[&str]) -> String {
    const LISTED: usize = 6;
    let more = names.len().saturating_sub(LISTED);
    let list = names[..names.len() - more].join(", ");
    if more > 0 {
        format!("{list} and {more} more")
    } else {
        list
    }
}

/// The JSON object without its rows.
fn head(asked: &Asked, counts: &Counts) -> Map<String, Value> {
    let mut head = Map::new();
    head.insert("schema".into(), json!(1));
    head.insert("program".into(), json!(cvtcycle::output::PROGRAM));
    if let Some(setup) = &asked.setup {
        head.insert("vehicle".into(), json!(setup.name));
        head.insert("lubricant".into(), json!(setup.oils().0.name));
    }
    head.insert("points".into(), json!(counts.points));
    head.insert(
        "status".into(),
        Value::Object(
            counts
                .by_status()
                .map(|(name, count)| (name.to_owned(), json!(count)))
                .collect(),
        ),
    );
    head.insert(
        "flags".into(),
        Value::Object(
            counts
                .by_flag()
                .map(|(name, count)| (name.to_owned(), json!(count)))
                .collect(),
        ),
    );
    head
}
