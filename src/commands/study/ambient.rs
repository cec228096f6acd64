//! `study ambient`: the thesis's matrix of ambient temperatures, starts and cars.

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
    let lines = plan_lines(args);
    let text: String = lines.iter().map(|(_, line)| format!("{line}\n")).collect();
    let reply = Plan::read(PLAN, &text).and_then(|plan| common::run(plan, &args.common, context));
    reply.map_err(|problems| problems.into_iter().map(|p| at_option(p, &lines)).collect())
}

/// Name of the plan that these options make.
const PLAN: &str = "study ambient";

/// The lines of the plan, each with the option that it comes from.
fn plan_lines(args: &Args) -> Vec<(&'static str, String)> {
    let title = format!("{} on {}, cold to warm", args.vehicle, args.cycle);
    let mut lines = vec![
        ("", "# Made by `cvtcycle study ambient`.".to_owned()),
        ("", "[study]".to_owned()),
        ("", format!("title = {}", quoted(&title))),
    ];
    let mut add = |option, key: &str, value: Option<String>| {
        lines.extend(value.map(|value| (option, format!("{key} = {value}"))));
    };
    let given = |word: &Option<String>| word.as_deref().map(quoted);
    let listed = |words: &[String]| (!words.is_empty()).then(|| list(words));
    let is_car = |name: &&String| *name != "none";
    let baselines: Vec<&String> = args.baseline.iter().filter(is_car).collect();
    add("--vehicle", "vehicle", Some(quoted(&args.vehicle)));
    let compared = !args.baseline.is_empty();
    add(
        "--baseline",
        "baselines",
        compared.then(|| list(&baselines)),
    );
    add("--cycle", "cycle", Some(quoted(&args.cycle)));
    add("--lubricant", "lubricant", given(&args.lubricant));
    add("--engine-oil", "engine_oil", given(&args.engine_oil));
    add("--set", "set", listed(&args.set));
    add("--set-all", "set_all", listed(&args.set_all));
    add(
        "--out",
        "keep",
        args.common.out.as_ref().map(|_| list(&TRACES)),
    );
    lines.push(("", String::new()));
    lines.push(("--ambient", "[study.design.grid]".to_owned()));
    let factors = [
        (
            "--ambient",
            "key = \"ambient_degc\"\nname = \"ambient\"",
            &args.ambient,
        ),
        ("--start", "key = \"start\"", &args.start),
    ];
    for (option, keys, values) in factors {
        lines.push((
            option,
            format!("\n[[factor]]\n{keys}\nvalues = [{}]", numbers(values)),
        ));
    }
    let split = |(option, text): &(&'static str, String)| {
        let lines = text.split('\n').map(|line| (*option, line.to_owned()));
        lines.collect::<Vec<_>>()
    };
    lines.iter().flat_map(split).collect()
}

/// Numbers as TOML numbers, other words as text for the plan's reader to judge.
fn numbers(words: &str) -> String {
    let item = |word: &str| match word.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => format!("{x:?}"),
        _ => quoted(word.trim()),
    };
    words.split(',').map(item).collect::<Vec<_>>().join(", ")
}

fn list<S: AsRef<str>>(words: &[S]) -> String {
    let words: Vec<String> = words.iter().map(|word| quoted(word.as_ref())).collect();
    format!("[{}]", words.join(", "))
}

fn quoted(word: &str) -> String {
    toml::Value::String(word.to_owned()).to_string()
}

/// A problem of a line of the plan, under the option that the line comes from.
fn at_option(problem: Problem, lines: &[(&'static str, String)]) -> Problem {
    let line = problem.place.line.checked_sub(1).and_then(|k| lines.get(k));
    match line {
        Some((option, _)) if problem.place.file == PLAN && !option.is_empty() => {
            problem.in_file(*option).key(*option)
        }
        _ => problem,
    }
}
