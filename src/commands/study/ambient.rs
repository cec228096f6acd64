//! `study ambient`: the matrix of ambient temperatures, starts and vehicles of the thesis.

use clap::Args;
use cvtcycle::config::{Place, Problem, Problems};
use cvtcycle::study::Study;
use cvtcycle::study::plan::Plan;

use super::execution::StudyRunArgs;
use crate::args::{ComparisonArgs, VehicleArgs};
use crate::commands::Execute;
use crate::print::{CommandResult, Terminal};

/// Arguments of `study ambient`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle study ambient
  cvtcycle study ambient --ambient -30,-20,-10 --start soak --baseline rover_216_5mt
  cvtcycle study ambient --cycle ftp75 --lubricant dexron_iii --out dexron

With --out: tables of all runs and traces, ambient_fuel.svg, ambient_penalty.svg, warm_up_soak.svg and warm_up_warm.svg.")]
pub struct StudyAmbientArgs {
    /// Ambient temperatures, degC, separated by commas
    #[arg(long, value_name = "DEGC,...", default_value = DEGC, allow_hyphen_values = true)]
    ambient: String,
    /// Starts, separated by commas: `soak`, `warm`, or temperatures in degC
    #[arg(long, value_name = "START,...", default_value = STARTS, allow_hyphen_values = true)]
    start: String,
    #[command(flatten)]
    comparison: ComparisonArgs,
    #[command(flatten)]
    car: VehicleArgs,
    #[command(flatten)]
    run: StudyRunArgs,
}

/// Default temperatures.
const DEGC: &str = "-10,0,10,25,40";
/// Default starts.
const STARTS: &str = "soak,warm";
/// Columns of the traces that the warm-up figures need.
const TRACES: [&str; 6] = [
    "time_s",
    "speed_kmh",
    "transmission_sump_degc",
    "belt_spray_degc",
    "engine_oil_degc",
    "coolant_degc",
];

impl Execute for StudyAmbientArgs {
    type Plan = Study;

    /// The matrix is a plan like any other; its problems are reported under the options that made it.
    fn plan(&self, problems: &mut Problems) -> Option<Study> {
        let text = self.plan_text();
        let mut own = Problems::default();
        let plan = own.take(Plan::read(PLAN, &text.text()));
        let study = plan.and_then(|plan| self.run.prepare(plan, &mut own));
        own.into_iter()
            .for_each(|problem| problems.add(text.as_option(problem)));
        study
    }

    fn run(&self, study: Study, terminal: Terminal) -> CommandResult {
        self.run.run(&study, terminal)
    }
}

/// Name of the plan that these options make.
const PLAN: &str = "study ambient";

/// Lines of the plan with the option that each comes from.
#[derive(Default)]
struct PlanText(Vec<(&'static str, String)>);

impl PlanText {
    fn line(&mut self, option: &'static str, line: impl Into<String>) {
        self.0.push((option, line.into()));
    }

    /// Adds `key = value`, if there is a value.
    fn entry(&mut self, option: &'static str, key: &str, value: Option<String>) {
        if let Some(value) = value {
            self.line(option, format!("{key} = {value}"));
        }
    }

    fn text(&self) -> String {
        self.0.iter().map(|(_, line)| format!("{line}\n")).collect()
    }

    /// The problem of a line of the plan, under the option that made the line.
    fn as_option(&self, problem: Problem) -> Problem {
        if problem.place.file_name() != Some(PLAN) {
            return problem;
        }
        let key = problem.key.trim_start_matches("study.");
        let index = problem.place.line.checked_sub(1);
        let line = index.and_then(|k| self.0.get(k));
        let is_of_key = |line: &str| line.split(" = ").next() == Some(key);
        let by_key = || self.0.iter().find(|(_, line)| is_of_key(line));
        let option = match line.or_else(by_key) {
            Some((option, _)) if !option.is_empty() => *option,
            _ => "--ambient",
        };
        problem.at(Place::file(option)).key(option)
    }
}

impl StudyAmbientArgs {
    fn plan_text(&self) -> PlanText {
        let (car, comparison) = (&self.car, &self.comparison);
        let title = format!("{} on {}, cold to warm", car.vehicle, comparison.cycle);
        let baselines = (!comparison.baseline.is_empty()).then(|| {
            let named: Vec<&String> = comparison.named_baselines().collect();
            list(&named)
        });
        let sets = |sets: &[String]| (!sets.is_empty()).then(|| list(sets));
        let keep = self.run.out.out.as_ref().map(|_| list(&TRACES));
        let oil = |oil: &Option<String>| oil.as_deref().map(quoted);
        let values = |text: &str| Some(format!("[{}]", numbers_or_words(text)));
        let mut text = PlanText::default();
        text.line("", "# Made by `cvtcycle study ambient`.");
        text.line("", "[study]");
        text.entry("", "title", Some(quoted(&title)));
        text.entry("--vehicle", "vehicle", Some(quoted(&car.vehicle)));
        text.entry("--baseline", "baselines", baselines);
        text.entry("--cycle", "cycle", Some(quoted(&comparison.cycle)));
        text.entry("--lubricant", "lubricant", oil(&car.lubricant));
        text.entry("--engine-oil", "engine_oil", oil(&comparison.engine_oil));
        text.entry("--set", "set", sets(&car.set));
        text.entry("--set-all", "set_all", sets(&comparison.set_all));
        text.entry("", "keep", keep);
        for line in ["", "[study.design.grid]", ""] {
            text.line("", line);
        }
        text.line("--ambient", "[[factor]]");
        text.entry("--ambient", "key", Some(quoted("ambient_degc")));
        text.entry("--ambient", "name", Some(quoted("ambient")));
        text.entry("--ambient", "values", values(&self.ambient));
        text.line("", "");
        text.line("--start", "[[factor]]");
        text.entry("--start", "key", Some(quoted("start")));
        text.entry("--start", "values", values(&self.start));
        text
    }
}

/// Finite numbers as TOML numbers; everything else as text, which the plan checks.
fn numbers_or_words(text: &str) -> String {
    let value = |word: &str| match word.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => format!("{x:?}"),
        _ => quoted(word.trim()),
    };
    text.split(',').map(value).collect::<Vec<_>>().join(", ")
}

fn list<S: AsRef<str>>(words: &[S]) -> String {
    let words: Vec<String> = words.iter().map(|word| quoted(word.as_ref())).collect();
    format!("[{}]", words.join(", "))
}

fn quoted(word: &str) -> String {
    toml::Value::String(word.to_owned()).to_string()
}
