//! `study ambient`: the thesis's matrix of ambient temperatures, starts and cars.

use std::fmt::Write as _;

use cvtcycle::config::Problem;
use cvtcycle::study::plan::Plan;

use super::common::{self, Common};
use crate::args::{self as inputs, Offering};
use crate::commands::Context;
use crate::print::Reply;

/// Arguments of `study ambient`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle study ambient
  cvtcycle study ambient --ambient -30,-20,-10 --start soak --baseline rover_216_5mt
  cvtcycle study ambient --cycle ftp75 --lubricant dexron_iii --out dexron

With --out: ambient_fuel.svg, ambient_penalty.svg, warm_up_soak.svg and warm_up_warm.svg beside the tables of all runs and traces.")]
pub struct Args {
    /// Ambient temperatures, degC, separated by commas
    #[arg(
        long,
        value_name = "DEGC,...",
        default_value = "-10,0,10,25,40",
        allow_hyphen_values = true
    )]
    ambient: String,
    /// Starts, separated by commas: `soak`, `warm`, or temperatures in degC
    #[arg(
        long,
        value_name = "START,...",
        default_value = "soak,warm",
        allow_hyphen_values = true
    )]
    start: String,
    /// Cycle: a name, constant_V (V in km/h, 600 s), or a CSV file
    #[arg(long, value_name = "NAME|FILE.csv", default_value = "ece15_eudc", value_parser = Offering(inputs::cycles), hide_possible_values = true)]
    cycle: String,
    /// The car in question
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Offering(inputs::vehicles), hide_possible_values = true)]
    vehicle: String,
    /// Car to compare with; repeatable; `none` for no comparison [default: the baselines of the vehicle's file]
    #[arg(long, value_name = "NAME|FILE.toml|none", value_parser = Offering(inputs::baselines), hide_possible_values = true)]
    baseline: Vec<String>,
    /// Transmission oil of the vehicle in question; baselines keep theirs
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Offering(inputs::lubricants), hide_possible_values = true)]
    lubricant: Option<String>,
    /// Engine oil of all cars
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Offering(inputs::lubricants), hide_possible_values = true)]
    engine_oil: Option<String>,
    /// Override one value of the vehicle in question; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Override one value of the vehicle and of all baselines; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set_all: Vec<String>,
    #[command(flatten)]
    common: Common,
}

/// Columns of the traces that the warm-up pictures need.
const TRACES: [&str; 6] = [
    "time_s",
    "speed_kmh",
    "transmission_sump_degc",
    "belt_spray_degc",
    "engine_oil_degc",
    "coolant_degc",
];

/// Runs the command: the matrix is a plan like any other.
pub fn answer(args: &Args, context: Context) -> Reply {
    let text = plan_text(args);
    let plan = Plan::read(PLAN, &text).map_err(|problems| {
        problems
            .into_iter()
            .map(|p| as_option(p, args))
            .collect::<Vec<_>>()
    })?;
    let reply = common::run(plan, &args.common, context);
    reply.map_err(|problems| problems.into_iter().map(|p| as_option(p, args)).collect())
}

/// Name of the plan that these options make.
const PLAN: &str = "study ambient";

fn plan_text(args: &Args) -> String {
    let mut text = format!(
        "# Made by `cvtcycle study ambient`.\n[study]\ntitle = {}\n",
        quoted(&format!("{} on {}, cold to warm", args.vehicle, args.cycle))
    );
    let mut line = |key: &str, value: String| {
        // Writing into a String cannot fail.
        let _ = writeln!(text, "{key} = {value}");
    };
    line("vehicle", quoted(&args.vehicle));
    if !args.baseline.is_empty() {
        let named: Vec<&String> = args
            .baseline
            .iter()
            .filter(|name| *name != "none")
            .collect();
        line("baselines", list(&named));
    }
    line("cycle", quoted(&args.cycle));
    for (key, value) in [
        ("lubricant", &args.lubricant),
        ("engine_oil", &args.engine_oil),
    ] {
        if let Some(value) = value {
            line(key, quoted(value));
        }
    }
    for (key, values) in [("set", &args.set), ("set_all", &args.set_all)] {
        if !values.is_empty() {
            line(key, list(values));
        }
    }
    if args.common.out.is_some() {
        line("keep", list(&TRACES));
    }
    let numbers = |words: &str| {
        words
            .split(',')
            .map(|word| number_or_word(word.trim()))
            .collect::<Vec<_>>()
            .join(", ")
    };
    text + &format!(
        "\n[study.design.grid]\n\n[[factor]]\nkey = \"ambient_degc\"\nname = \"ambient\"\nvalues = [{}]\n\n[[factor]]\nkey = \"start\"\nvalues = [{}]\n",
        numbers(&args.ambient),
        numbers(&args.start),
    )
}

fn number_or_word(word: &str) -> String {
    // What TOML takes as a number goes in as written; all else is a word, for the plan's reading to judge.
    match word.parse::<f64>() {
        Ok(x) if x.is_finite() => format!("{x:?}"),
        _ => quoted(word),
    }
}

fn list<S: AsRef<str>>(words: &[S]) -> String {
    let words: Vec<String> = words.iter().map(|word| quoted(word.as_ref())).collect();
    format!("[{}]", words.join(", "))
}

fn quoted(word: &str) -> String {
    toml::Value::String(word.to_owned()).to_string()
}

/// A problem of the plan that the options made, under the option.
fn as_option(mut problem: Problem, args: &Args) -> Problem {
    if problem.place.file != PLAN {
        return problem;
    }
    let factor = |key: &str| {
        problem.key == key
            || problem.key.contains(key)
            || problem.message.contains(&format!("`{key}`"))
    };
    let option = match problem.key.as_str() {
        "study.vehicle" | "vehicle" => "--vehicle",
        "study.baselines" | "baselines" => "--baseline",
        "study.cycle" | "cycle" => "--cycle",
        "study.lubricant" | "lubricant" => "--lubricant",
        "study.engine_oil" | "engine_oil" => "--engine-oil",
        "study.set" | "set" => "--set",
        "study.set_all" | "set_all" => "--set-all",
        _ if factor("ambient_degc") => "--ambient",
        _ if factor("start") => "--start",
        // The factors' own lines of the plan: ambient comes first.
        _ => {
            if problem.place.line_text.contains("soak")
                || problem.place.line_text.contains(&args.start)
            {
                "--start"
            } else {
                "--ambient"
            }
        }
    };
    problem.place = cvtcycle::config::Place {
        file: option.to_owned(),
        ..cvtcycle::config::Place::default()
    };
    option.clone_into(&mut problem.key);
    problem
}
