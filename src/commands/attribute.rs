//! `attribute`: the fuel that each loss costs.

mod files;
mod tables;

use clap::Args;
use cvtcycle::analysis::attribute::{Attribution, Depth, Pairs, attribute};
use cvtcycle::config::{Bound, Problems};
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::record::Manifest;
use cvtcycle::output::summary::{SCHEMA, Summary, summarise};
use serde::Serialize;

use super::vehicles::{self, Baselines, ComparedArgs, ComparedVehicles};
use super::{Execute, run, threads};
use crate::args::problems::bad_value;
use crate::args::{
    AmbientsArgs, DrivingArgs, Names, ResultArgs, ThreadArgs, choice_names, number, one_of,
};
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text};

/// Allowed factor on a loss.
const FACTOR: Bound = Bound::closed(0.0, 5.0);
/// Names of the choices of `--pairs`.
const PAIRS: [(&str, Pairs); 3] = [
    ("large", Pairs::Large),
    ("all", Pairs::All),
    ("none", Pairs::None),
];

/// Arguments of `attribute`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.help("Write attribution.csv, pairs.csv, shapley.csv, summary.json and plots (SVG) into this directory")),
    mut_arg("baseline", |baseline| baseline.help("Another vehicle whose losses are priced as well; repeatable")),
    after_help = "\
Examples:
  cvtcycle attribute
  cvtcycle attribute --ambient -10,25 --vehicle mycar.toml --cycle wltc_class3b
  cvtcycle attribute --factor 0.5 --baseline rover_216_5mt
  cvtcycle attribute --pairs all --shapley --out prices

The car is driven again without each loss, with all else as it follows: oil and engine are colder, pressure and ratio follow. The prices of \
single losses need not add up to that of all together; `interaction` is the difference. `% energy` is the energy of the loss over that of the \
fuel, `alone` the fuel that a loss adds to a box without the others. Pairs are given in both orders where the interaction is at least 0.1 % of \
the fuel, or a tenth of the smaller price."
)]
pub struct AttributeArgs {
    #[command(flatten)]
    cars: ComparedArgs,
    #[command(flatten)]
    ambients: AmbientsArgs,
    #[command(flatten)]
    driving: DrivingArgs,
    /// Factor on each loss, 0 to 5: 0 is without it, 0.5 is half of it
    #[arg(
        long,
        value_name = "X",
        default_value = "0",
        allow_hyphen_values = true
    )]
    factor: String,
    /// Pairs of losses in both orders: large, all or none
    #[arg(long, value_name = "WHICH", default_value = "large", value_parser = Names(|| choice_names(&PAIRS)), hide_possible_values = true)]
    pairs: String,
    /// Share the whole price out over groups of losses, by Shapley's rule
    #[arg(long)]
    shapley: bool,
    /// Print the price in each part of the cycle
    #[arg(long)]
    by_phase: bool,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    results: ResultArgs,
}

/// Checked input of an attribution.
pub struct AttributePlan {
    cars: ComparedVehicles,
    ambients_degc: Vec<f64>,
    factor: f64,
    depth: Depth,
    out: Option<OutputDir>,
}

/// The object of `--json` and `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct AttributionSummary {
    #[serde(flatten)]
    manifest: Manifest,
    /// Factor on each loss in turn.
    factor: f64,
    /// A run with its prices for each ambient temperature.
    conditions: Vec<Summary>,
}

impl Execute for AttributeArgs {
    type Plan = AttributePlan;

    fn plan(&self, problems: &mut Problems) -> Option<AttributePlan> {
        let DrivingArgs { drive, formulation } = &self.driving;
        let cars = self.cars.load(Baselines::Named, formulation, problems);
        let ambients_degc = self.ambients.get(problems);
        let (start, dt_s) = drive.get(problems);
        let factor = problems.take(number("--factor", &self.factor, FACTOR, "factor"));
        if factor.is_some_and(|factor| (factor - 1.0).abs() <= 0.0) {
            let message = "with a factor of 1 nothing would change";
            let hint = "0 removes each loss, 0.5 halves it";
            let allowed = "0 to 5, and not 1";
            problems.add(bad_value("--factor", &self.factor, allowed, message, hint));
        }
        let pairs = problems.take(one_of("--pairs", &self.pairs, &PAIRS));
        let threads = self.threads.given(problems);
        problems.take(threads::begin(threads));
        let out = self.results.out.dir(problems);
        Some(AttributePlan {
            cars: cars.driven(start, dt_s)?,
            ambients_degc: ambients_degc?,
            factor: factor?,
            depth: Depth {
                alone: true,
                pairs: pairs?,
                shapley: self.shapley,
            },
            out,
        })
    }

    fn run(&self, mut plan: AttributePlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        let at = |ambient_degc: &f64| self.priced(&plan, *ambient_degc);
        let summary = AttributionSummary {
            manifest: Manifest::new(SCHEMA),
            factor: plan.factor,
            conditions: plan.ambients_degc.iter().map(at).collect(),
        };
        let json = json_text(&summary)?;
        let files = WrittenFiles::write(out, |dir| {
            files::write(dir, &summary)?;
            dir.put("summary.json", &json)?;
            Ok("")
        })?;
        let results = Results::new(json, failures(&summary), files);
        let tables = || tables::tables(&summary, &plan.cars.cycle, self.by_phase, terminal.stdout);
        Ok(results.output(&self.results.output, tables))
    }
}

impl AttributeArgs {
    /// Drives the cars at one ambient temperature and computes their prices.
    fn priced(&self, plan: &AttributePlan, ambient_degc: f64) -> Summary {
        let (cycle, vehicles) = (&plan.cars.cycle, &plan.cars.vehicles);
        let conditions = plan.cars.conditions(ambient_degc, false);
        let settings = plan.cars.settings(&self.cars, false);
        let outcomes = plan.cars.drive(&conditions);
        let driven = vehicles::driven(vehicles, &outcomes);
        let start = plan.cars.start.1.clone();
        let mut summary = summarise(cycle, ambient_degc, start, settings.clone(), &driven);
        for (run, car) in summary.runs.iter_mut().zip(vehicles) {
            let attribution = Attribution {
                setup: &car.setup,
                cycle,
                conditions,
                settings: &settings,
                factor: plan.factor,
                depth: plan.depth,
            };
            run.price = Some(attribute(&attribution, run));
        }
        summary
    }
}

/// One line for each failed check, of the original cars and of those with changed losses.
fn failures(summary: &AttributionSummary) -> Vec<String> {
    let failed_checks = |summary: &Summary| {
        let runs = summary.runs.iter();
        let changed = runs.flat_map(|run| {
            let price = run.price.iter().flat_map(|price| &price.failures);
            price.map(|text| format!("check failed: {} {text}", run.vehicle))
        });
        run::failures(summary)
            .into_iter()
            .chain(changed)
            .collect::<Vec<_>>()
    };
    summary.conditions.iter().flat_map(failed_checks).collect()
}
