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

    fn text(&self) -> String {
        self.0.iter().map(|(_, line)| format!("{line}\n")).collect()
    }

    /// The problem of a line of the plan, under the option that made the line.
    fn as_option(&self, mut problem: Problem) -> Problem {
        if problem.place.file_name() != Some(PLAN) {
            return problem;
        }
        let key = problem.key.trim_start_matches("study.");
        let by_key = self
            .0
            .iter()
            .find(|(_, line)| line.split(" = ").next() == Some(key));
        let by_line = problem
            .place
            .line
            .checked_sub(1)
            .and_then(|k| self.0.get(k));
        let option = by_line.or(by_key).map_or("", |(option, _)| *option);
        let option = if option.is_empty() {
            "--ambient"
        } else {
            option
        };
        problem.place = Place::file(option);
        option.clone_into(&mut problem.key);
        problem
    }
}

impl StudyAmbientArgs {
    fn plan_text(&self) -> PlanText {
        let (car, comparison) = (&self.car, &self.comparison);
        let mut text = PlanText::default();
        text.line("", "# Made by `cvtcycle study ambient`.");
        text.line("", "[study]");
        let title = format!("{} on {}, cold to warm", car.vehicle, comparison.cycle);
        text.line("", format!("title = {}", quoted(&title)));
        text.line("--vehicle", format!("vehicle = {}", quoted(&car.vehicle)));
        if !comparison.baseline.is_empty() {
            let named: Vec<&String> = comparison.named_baselines().collect();
            text.line("--baseline", format!("baselines = {}", list(&named)));
        }
        text.line("--cycle", format!("cycle = {}", quoted(&comparison.cycle)));
        if let Some(oil) = &car.lubricant {
            text.line("--lubricant", format!("lubricant = {}", quoted(oil)));
        }
        if let Some(oil) = &comparison.engine_oil {
            text.line("--engine-oil", format!("engine_oil = {}", quoted(oil)));
        }
        if !car.set.is_empty() {
            text.line("--set", format!("set = {}", list(&car.set)));
        }
        if !comparison.set_all.is_empty() {
            text.line(
                "--set-all",
                format!("set_all = {}", list(&comparison.set_all)),
            );
        }
        if self.run.out.out.is_some() {
            text.line("", format!("keep = {}", list(&TRACES)));
        }
        for line in ["", "[study.design.grid]", ""] {
            text.line("", line);
        }
        text.line("--ambient", "[[factor]]");
        text.line("--ambient", "key = \"ambient_degc\"");
        text.line("--ambient", "name = \"ambient\"");
        text.line(
            "--ambient",
            format!("values = [{}]", numbers_or_words(&self.ambient)),
        );
        text.line("", "");
        text.line("--start", "[[factor]]");
        text.line("--start", "key = \"start\"");
        text.line(
            "--start",
            format!("values = [{}]", numbers_or_words(&self.start)),
        );
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
