//! `run`: a car and its baselines through one cycle.

mod cars;
pub mod files;
mod record;
mod text;

use cvtcycle::config::Bound;
use cvtcycle::config::Problems;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::config::setup::AMBIENT;
use cvtcycle::model::drive::{Conditions, Outcome, Start, drive};
use cvtcycle::model::fluid::ZERO_DEGC_K;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::record::FILE;
use cvtcycle::output::summary::{Driven, Settings, StartWord, Summary, name_of, summarise};

use super::Context;
use crate::args::{self as inputs, Offering};
use crate::print::{Answer, FAILED, Reply, json_text};
use cars::Car;
use files::TraceFormat;

/// Allowed length of a step, s.
const STEP: Bound = Bound::closed(0.01, 10.0);

/// Arguments of `run`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle run --cycle ece15_eudc --ambient -10
  cvtcycle run --cycle ftp75 --baseline none --set transmission.cvt.pump.displacement_cc_rev=8
  cvtcycle run --cycle constant_120 --start 90 --json
  cvtcycle run --ambient -10 --out cold_run
  cvtcycle run --out run2 --format parquet

`cvtcycle list cycles`, `list vehicles` and `list lubricants` name what can be driven, `cvtcycle explain KEY` what can be set.")]
pub struct Args {
    /// Cycle: a name, constant_V (V in km/h, 600 s), or a CSV file
    #[arg(long, value_name = "NAME|FILE.csv", default_value = "ece15_eudc", value_parser = Offering(inputs::cycles), hide_possible_values = true)]
    cycle: String,
    /// The car in question
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Offering(inputs::vehicles), hide_possible_values = true)]
    vehicle: String,
    /// Car to compare with; repeatable; `none` for no comparison [default: the baselines of the vehicle's file]
    #[arg(long, value_name = "NAME|FILE.toml|none", value_parser = Offering(inputs::baselines), hide_possible_values = true)]
    baseline: Vec<String>,
    /// Ambient temperature, degC, -40 to 60
    #[arg(
        long,
        value_name = "DEGC",
        default_value = "25",
        allow_hyphen_values = true
    )]
    ambient: String,
    /// Start: `soak` (everything at ambient), `warm` (the same cycle has just been driven from a soak), or all
    /// temperatures in degC
    #[arg(
        long,
        value_name = "soak|warm|DEGC",
        default_value = "soak",
        allow_hyphen_values = true
    )]
    start: String,
    /// Transmission oil of the vehicle in question; baselines keep theirs
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Offering(inputs::lubricants), hide_possible_values = true)]
    lubricant: Option<String>,
    /// Engine oil of all cars
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Offering(inputs::lubricants), hide_possible_values = true)]
    engine_oil: Option<String>,
    /// Override one value of the vehicle in question; repeatable. `lubricant.KEY` and `engine_oil.KEY` reach its fluids
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Override one value of the vehicle and of all baselines; repeatable. `--set` goes before it
    #[arg(long, value_name = "KEY=VALUE")]
    set_all: Vec<String>,
    /// Longest time step, s, 0.01 to 10
    #[arg(
        long,
        value_name = "SECONDS",
        default_value = "1",
        allow_hyphen_values = true
    )]
    dt: String,
    /// Reading of the belt model: smooth (for driving), appendix_c or chapter_8 (as printed in the thesis)
    #[arg(long, value_name = "NAME", default_value = "smooth", value_parser = Offering(formulations), hide_possible_values = true)]
    formulation: String,
    /// Fail (exit code 1) also where a model leaves its validity, the belt slips grossly or is clamped too little, or the
    /// pump's flow does not suffice
    #[arg(long)]
    strict: bool,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
    /// Write summary.json, inputs.json, traces and plots (SVG) into this directory; `cvtcycle report DIR` makes a report of them
    #[arg(long, value_name = "DIR")]
    out: Option<std::path::PathBuf>,
    /// Format of the traces: csv, parquet or both
    #[arg(long, value_name = "NAME", default_value = "csv", requires = "out", value_parser = Offering(formats), hide_possible_values = true)]
    format: String,
    /// How much each value of each car matters, written into inputs.json for the report: always, never, or auto (unless the
    /// cycle has more than 20 000 steps)
    #[arg(long, value_name = "WHEN", default_value = "auto", requires = "out", value_parser = Offering(record::when), hide_possible_values = true)]
    sensitivity: String,
    /// Replace the files of an earlier run in the --out directory
    #[arg(long, requires = "out")]
    force: bool,
    /// Print nothing but problems
    #[arg(long, short)]
    quiet: bool,
}

fn formats() -> Vec<&'static str> {
    TraceFormat::NAMES.iter().map(|(name, _)| *name).collect()
}

pub fn formulations() -> Vec<&'static str> {
    Formulation::NAMES.iter().map(|(name, _)| *name).collect()
}

/// Everything that the run needs, checked.
struct Plan {
    cycle: Cycle,
    cars: Vec<Car>,
    ambient_degc: f64,
    start: (Start, StartWord),
    dt_s: f64,
    formulation: Formulation,
    format: TraceFormat,
    sensitivity: record::When,
    out: Option<OutputDir>,
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let plan = plan(args)?;
    let conditions = Conditions {
        ambient_k: plan.ambient_degc + ZERO_DEGC_K,
        start: plan.start.0,
        max_dt_s: plan.dt_s,
        keep_rows: plan.out.is_some(),
    };
    let outcomes: Vec<Outcome> = plan
        .cars
        .iter()
        .map(|car| drive(&car.setup, &plan.cycle, &conditions))
        .collect();
    let driven: Vec<Driven> = plan
        .cars
        .iter()
        .zip(&outcomes)
        .map(|(car, outcome)| Driven {
            name: &car.name,
            setup: &car.setup,
            outcome,
        })
        .collect();
    let settings = Settings {
        dt_s: plan.dt_s,
        formulation: name_of(plan.formulation).to_owned(),
        set: args.set.clone(),
        set_all: args.set_all.clone(),
        strict: args.strict,
    };
    let summary = summarise(
        &plan.cycle,
        plan.ambient_degc,
        plan.start.1,
        settings,
        &driven,
    );
    let json = json_text(&summary)?;
    let written = match plan.out {
        Some(mut dir) => {
            let record = json_text(&record::record(
                &plan.cars,
                &plan.cycle,
                &conditions,
                plan.sensitivity,
            )?)?;
            dir.write(FILE, |out| out.write_all(record.as_bytes()))?;
            files::write(dir, plan.format, &json, &summary, &plan.cycle, &driven)?
        }
        None => files::Written::default(),
    };
    Ok(reply(args, context, &plan.cycle, &summary, json, &written))
}

fn reply(
    args: &Args,
    context: Context,
    cycle: &Cycle,
    summary: &Summary,
    json: String,
    written: &files::Written,
) -> Answer {
    let failed = text::failures(summary);
    let code = if failed.is_empty() { 0 } else { FAILED };
    let told = failed
        .iter()
        .map(|line| format!("cvtcycle: {line}\n"))
        .collect::<String>();
    if args.json || args.quiet {
        let stdout = if args.json { json } else { String::new() };
        return Answer {
            stdout,
            stderr: told + &written.left_over_text(),
            code,
        };
    }
    let stdout = text::tables(summary, cycle, context.paint) + &written.text();
    Answer {
        stdout,
        stderr: written.left_over_text(),
        code,
    }
}

fn plan(args: &Args) -> Result<Plan, cvtcycle::config::Problems> {
    let mut problems = Problems::default();
    let cycle = problems.take(inputs::cycle("--cycle", &args.cycle));
    let formulation = problems.take(inputs::word(
        "--formulation",
        &args.formulation,
        &Formulation::NAMES,
    ));
    let cars = cars::load(args, formulation.unwrap_or_default(), &mut problems);
    let ambient = problems.take(inputs::number(
        "--ambient",
        &args.ambient,
        AMBIENT,
        "ambient_degc",
    ));
    let start = problems.take(start(&args.start));
    let dt_s = problems.take(inputs::number("--dt", &args.dt, STEP, "dt_s"));
    let format = problems.take(inputs::word("--format", &args.format, &TraceFormat::NAMES));
    let sensitivity = problems.take(inputs::word(
        "--sensitivity",
        &args.sensitivity,
        &record::WHEN,
    ));
    let out = args
        .out
        .as_ref()
        .map(|dir| OutputDir::create(dir, args.force).map_err(Problems::from));
    let out = out.and_then(|dir| problems.take(dir));
    problems.finish()?;
    match (
        cycle,
        ambient,
        start,
        dt_s,
        formulation,
        format.zip(sensitivity),
    ) {
        (
            Some(cycle),
            Some(ambient_degc),
            Some(start),
            Some(dt_s),
            Some(formulation),
            Some((format, sensitivity)),
        ) => Ok(Plan {
            cycle,
            cars,
            ambient_degc,
            start,
            dt_s,
            formulation,
            format,
            sensitivity,
            out,
        }),
        _ => unreachable!("what is missing has left a problem"),
    }
}

fn start(value: &str) -> Result<(Start, StartWord), cvtcycle::config::Problems> {
    let word = |start: Start| Ok((start, StartWord::Word(value.to_owned())));
    match value {
        "soak" => return word(Start::Soak),
        "warm" => return word(Start::Warm),
        _ => {}
    }
    let bound = Bound::closed(-40.0, 130.0);
    let degc = inputs::number("--start", value, bound, "start_degc").map_err(|problems| {
        let allowed = format!("soak, warm, or {}", bound.in_unit("°C"));
        let hint = inputs::did_you_mean(value, &["soak", "warm"]);
        problems.map(|p| {
            let hint = hint.clone().unwrap_or_else(|| p.hint.clone());
            p.allowed(allowed.clone()).hint(hint)
        })
    })?;
    Ok((Start::At(degc + ZERO_DEGC_K), StartWord::Degc(degc)))
}
