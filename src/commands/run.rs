//! `run`: a vehicle and its baselines on one cycle.

mod files;
mod losses;
mod tables;

pub use tables::failures;

use std::ops::RangeInclusive;

use clap::Args;
use cvtcycle::config::Problems;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::model::drive::{Conditions, Start};
use cvtcycle::model::fluid::ZERO_DEGC_K;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::record::FILE;
use cvtcycle::output::summary::{Settings, StartWord, name_run};
use cvtcycle::study::execute::Study;
use cvtcycle::study::plan::Base;
use cvtcycle::study::run::{RunQuestion, summary};
use cvtcycle::study::words::drawn::{differences, prepare};

use super::vehicles::{self, Baselines, RunVehicle};
use super::{Execute, threads};
use crate::args::problems::{overrides, problem};
use crate::args::{
    AmbientArgs, ColumnsArgs, ComparisonArgs, DriveArgs, FormulationArgs, Names, OutArgs,
    OutputArgs, VehicleArgs, count_if_given, names_of, one_of, word_of_plan,
};
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text};
use cvtcycle::report::run_files::{self, TraceFormat};
use files::When;

/// Allowed number of draws.
const DRAWS: RangeInclusive<u64> = 2..=100_000;

/// Arguments of `run`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.help("Write summary.json, inputs.json, traces and plots (SVG) into this directory; `cvtcycle report DIR` makes a report of them")),
    after_help = "\
Examples:
  cvtcycle run --cycle ece15_eudc --ambient -10
  cvtcycle run --cycle ftp75 --baseline none --set transmission.cvt.pump.displacement_cc_rev=8
  cvtcycle run --cycle constant_120 --start 90 --json
  cvtcycle run --vehicle civic_20_cvt --baseline twin --draws 256
  cvtcycle run --ambient -10 --out cold_run
  cvtcycle run --out run2 --format parquet

`cvtcycle list cycles`, `list vehicles` and `list lubricants` print the built-in names, `cvtcycle explain KEY` explains a key of --set."
)]
pub struct RunArgs {
    #[command(flatten)]
    car: VehicleArgs,
    #[command(flatten)]
    comparison: ComparisonArgs,
    #[command(flatten)]
    columns: ColumnsArgs,
    #[command(flatten)]
    ambient: AmbientArgs,
    #[command(flatten)]
    drive: DriveArgs,
    #[command(flatten)]
    formulation: FormulationArgs,
    /// Drive each vehicle again without each loss for the fuel that it costs: always, never, or auto (unless the cycle has more
    /// than 20 000 steps)
    #[arg(long, value_name = "WHEN", default_value = "auto", value_parser = Names(|| names_of(&When::NAMES)), hide_possible_values = true)]
    price: String,
    /// How sure the difference to each baseline is: drive all cars again with so many draws of the plan uncertainty_rover, its
    /// ranges relative to the values of these cars. What --set gives is certain; not with --columns [default: only what is known of
    /// the shipped cars]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    draws: Option<String>,
    /// Fail (exit code 1) also where a model is used outside its validity, at gross slip or a clamp safety factor below 1,
    /// and where the flow of the pump is too small
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    out: OutArgs,
    /// Format of the traces: csv, parquet or both
    #[arg(long, value_name = "NAME", default_value = "csv", requires = "out", value_parser = Names(|| names_of(&TraceFormat::NAMES)), hide_possible_values = true)]
    format: String,
    /// Compute the effect of each value of each vehicle for the report of --out: always, never, or auto (unless the cycle has
    /// more than 20 000 steps)
    #[arg(long, value_name = "WHEN", default_value = "auto", requires = "out", value_parser = Names(|| names_of(&When::NAMES)), hide_possible_values = true)]
    sensitivity: String,
    #[command(flatten)]
    output: OutputArgs,
}

/// Checked input of a run.
pub struct RunPlan {
    cycle: Cycle,
    vehicles: Vec<RunVehicle>,
    ambient_degc: f64,
    start: (Start, StartWord),
    dt_s: f64,
    formulation: Formulation,
    format: TraceFormat,
    price: When,
    draws: Option<Study>,
    sensitivity: When,
    out: Option<OutputDir>,
}

impl RunArgs {
    /// The run as a plan has it, for its draws.
    fn base(
        &self,
        (ambient_degc, start, dt_s, formulation): (f64, &StartWord, f64, Formulation),
        vehicles: &[RunVehicle],
        problems: &mut Problems,
    ) -> Option<Base> {
        let (_, baselines) = vehicles.split_first()?;
        let refused = match (baselines.is_empty(), &self.columns.columns) {
            (true, _) => Some(("there is no baseline", "name one: --baseline twin")),
            (false, Some(_)) => Some((
                "the draws have no --columns",
                "write the cycle in the program's own form: `cvtcycle convert cycle`",
            )),
            (false, None) => None,
        };
        if let Some((message, hint)) = refused {
            problems.add(problem("--draws", message, hint));
            return None;
        }
        let named = self.comparison.named_baselines();
        let named: Vec<String> = named.map(|name| word_of_plan(name)).collect();
        Some(Base {
            vehicle: word_of_plan(&self.car.vehicle),
            baselines: (!named.is_empty()).then_some(named),
            cycle: word_of_plan(&self.comparison.cycle.word),
            ambient_degc,
            start: start.text(),
            lubricant: self.car.lubricant.as_deref().map(word_of_plan),
            engine_oil: self.comparison.engine_oil.as_deref().map(word_of_plan),
            set: overrides("--set", &self.car.set, problems),
            set_all: overrides("--set-all", &self.comparison.set_all, problems),
            dt_s,
            formulation,
        })
    }
}

impl Execute for RunArgs {
    type Plan = RunPlan;

    fn plan(&self, problems: &mut Problems) -> Option<RunPlan> {
        let cycle = self.comparison.cycle(&self.columns, problems);
        let formulation = self.formulation.get(problems);
        let comparison = (&self.comparison, Baselines::OfFile);
        let vehicles = vehicles::load(&self.car, comparison, formulation, problems);
        let cycle = vehicles::own_cycle(&self.comparison.cycle.word, cycle, &vehicles);
        let ambient = self.ambient.get(problems);
        let (start, dt_s) = self.drive.get(problems);
        let format = problems.take(one_of("--format", &self.format, &TraceFormat::NAMES));
        let when = |option: &str, word: &str| one_of(option, word, &When::NAMES);
        let price = problems.take(when("--price", &self.price));
        let sensitivity = problems.take(when("--sensitivity", &self.sensitivity));
        if self.out.out.is_some() || price != Some(When::Never) || self.draws.is_some() {
            problems.take(threads::begin(None));
        }
        let wanted = count_if_given("--draws", self.draws.as_ref(), DRAWS, problems);
        let draws = match (wanted, ambient, &start, dt_s) {
            (Some(n), Some(degc), Some((_, start)), Some(dt_s)) if problems.is_empty() => {
                let base = self.base((degc, start, dt_s, formulation), &vehicles, problems);
                let is_cvt = vehicles[0].setup.transmission().is_cvt();
                base.and_then(|base| problems.take(prepare(base, n, is_cvt)))
            }
            _ => None,
        };
        if self.out.out.is_some() {
            let kept = cycle.as_ref().zip(dt_s);
            let kept = kept.map(|(cycle, dt_s)| vehicles::kept_steps(&vehicles, cycle, dt_s));
            kept.and_then(|kept| problems.take(kept));
        }
        let out = self.out.dir(problems);
        Some(RunPlan {
            cycle: cycle?,
            vehicles,
            ambient_degc: ambient?,
            start: start?,
            dt_s: dt_s?,
            formulation,
            format: format?,
            price: price?,
            draws,
            sensitivity: sensitivity?,
            out,
        })
    }

    fn run(&self, mut plan: RunPlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        let (cycle, vehicles) = (&plan.cycle, &plan.vehicles);
        let conditions = Conditions {
            ambient_k: plan.ambient_degc + ZERO_DEGC_K,
            start: plan.start.0,
            max_dt_s: plan.dt_s,
            keep_rows: out.is_some(),
        };
        let outcomes = vehicles::drive_all(vehicles, cycle, &conditions);
        let driven = vehicles::driven(vehicles, &outcomes);
        let settings = Settings {
            dt_s: plan.dt_s,
            formulation: plan.formulation.name().to_owned(),
            set: self.car.set.clone(),
            set_all: self.comparison.set_all.clone(),
            strict: self.strict,
        };
        let question = RunQuestion {
            cycle,
            conditions,
            ambient_degc: plan.ambient_degc,
            start: plan.start.1,
            settings,
            price: plan.price.wanted(cycle, plan.dt_s),
        };
        let mut summary = summary(&question, &driven);
        if let Some(study) = &plan.draws {
            let drawn = differences(study)?;
            for (comparison, drawn) in summary.comparison.iter_mut().zip(drawn) {
                comparison.interval = Some(drawn);
            }
        }
        let mut record = None;
        if out.is_some() {
            let inputs = files::record(vehicles, cycle, &conditions, plan.sensitivity)?;
            name_run(&mut summary, record.insert(inputs));
        }
        let json = json_text(&summary)?;
        let files = WrittenFiles::write(out, |dir| {
            run_files::write(dir, plan.format, &summary, cycle, &driven)?;
            dir.put("summary.json", &json)?;
            // Last: it lists the others.
            if let Some(mut record) = record {
                record.files = dir.sums().clone();
                dir.put(FILE, json_text(&record)?)?;
            }
            Ok("")
        })?;
        let results = Results::new(json, tables::failures(&summary), files);
        let tables = || tables::tables(&summary, cycle, terminal.stdout);
        Ok(results.output(&self.output, tables))
    }
}
