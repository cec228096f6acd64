//! `study ambient`: the matrix of ambient temperatures, starts and vehicles of the thesis.

use clap::Args;
use cvtcycle::config::{Place, Problem, Problems};
use cvtcycle::study::Study;
use cvtcycle::study::plan::{Axis, Base, FactorValue, Keep, Places, Plan};

use super::execution::StudyRunArgs;
use crate::args::problems::overrides;
use crate::args::{ComparisonArgs, VehicleArgs};
use crate::commands::Execute;
use crate::print::{CommandResult, Terminal};
use cvtcycle::report::results::StudyResults;

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
/// Trace columns for the figures of the warm-up.
const TRACES: [&str; 6] = [
    "time_s",
    "speed_kmh",
    "transmission_sump_degc",
    "belt_spray_degc",
    "engine_oil_degc",
    "coolant_degc",
];
/// Options by the key of the plan that they set.
const OPTIONS: [(&str, &str); 7] = [
    ("vehicle", "--vehicle"),
    ("baselines", "--baseline"),
    ("cycle", "--cycle"),
    ("lubricant", "--lubricant"),
    ("engine_oil", "--engine-oil"),
    ("set", "--set"),
    ("set_all", "--set-all"),
];

impl Execute for StudyAmbientArgs {
    type Plan = Study;

    fn plan(&self, problems: &mut Problems) -> Option<Study> {
        let mut own = Problems::default();
        self.run.begin(&mut own);
        let plan = self.matrix(&mut own);
        let study = plan.and_then(|plan| self.run.prepare(plan, &mut own));
        self.run.check_directory(&mut own);
        own.into_iter()
            .for_each(|problem| problems.add(cite_option(problem)));
        study
    }

    fn run(&self, study: Study, terminal: Terminal) -> CommandResult {
        self.run.run::<StudyResults>(&study, terminal)
    }
}

/// Cites the option that set a key of the plan.
fn cite_option(problem: Problem) -> Problem {
    let option = problem.place.file_name().unwrap_or_default().to_owned();
    let is_option = ["--ambient", "--start"].contains(&option.as_str())
        || OPTIONS.iter().any(|(_, name)| *name == option);
    if is_option {
        problem.key(option)
    } else {
        problem
    }
}

impl StudyAmbientArgs {
    /// Builds the plan from the options. None after a problem.
    fn matrix(&self, problems: &mut Problems) -> Option<Plan> {
        let (car, comparison) = (&self.car, &self.comparison);
        let before = problems.len();
        let mut check = |key: &str, option: &str, word: &str| {
            let value = FactorValue::of_option(key, word).map_err(|p| p.in_file(option));
            problems.take(value)
        };
        check("vehicle", "--vehicle", &car.vehicle);
        comparison
            .named_baselines()
            .for_each(|name| drop(check("vehicle", "--baseline", name)));
        check("cycle", "--cycle", &comparison.cycle.word);
        let oils = [
            ("lubricant", "--lubricant", &car.lubricant),
            ("engine_oil", "--engine-oil", &comparison.engine_oil),
        ];
        for (key, option, name) in oils {
            name.iter().for_each(|name| drop(check(key, option, name)));
        }
        let axes = [
            ("ambient_degc", "--ambient", &self.ambient),
            ("start", "--start", &self.start),
        ]
        .map(|(key, option, words)| Axis {
            values: words
                .split(',')
                .filter_map(|word| check(key, option, word))
                .collect(),
            place: Place::file(option),
        });
        let set = overrides("--set", &car.set, problems);
        let set_all = overrides("--set-all", &comparison.set_all, problems);
        if problems.len() > before {
            return None;
        }
        let mut places = Places::new(Place::file("--ambient"));
        OPTIONS
            .iter()
            .for_each(|(key, option)| places.add(key, Place::file(*option)));
        let base = Base {
            vehicle: car.vehicle.clone(),
            baselines: (!comparison.baseline.is_empty())
                .then(|| comparison.named_baselines().cloned().collect()),
            cycle: comparison.cycle.word.clone(),
            lubricant: car.lubricant.clone(),
            engine_oil: comparison.engine_oil.clone(),
            set,
            set_all,
            ..Base::default()
        };
        let keep = match self.run.out.out {
            Some(_) => Keep::Columns(TRACES.map(str::to_owned).to_vec()),
            None => Keep::Summary,
        };
        let title = format!("{} on {}, cold to warm", car.vehicle, comparison.cycle.word);
        problems.take(Plan::matrix(&title, base, axes, keep, places))
    }
}
