//! `run`: a vehicle and its baselines on one cycle.

mod files;
mod losses;
mod tables;

pub use tables::failures;

use std::ops::RangeInclusive;
use std::path::Path;

use clap::Args;
use cvtcycle::analysis::answer::{Answer, drive_cars};
use cvtcycle::analysis::draws::prepare;
use cvtcycle::analysis::run::{RunQuestion, summary};
use cvtcycle::analysis::words::run::input_doubts;
use cvtcycle::config::Problems;
use cvtcycle::config::setup::{TWIN, is_path, is_twin};
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::progress::NoProgress;
use cvtcycle::output::record::FILE;
use cvtcycle::output::summary::{StartWord, Summary, name_run, start_on};
use cvtcycle::study::execute::Study;
use cvtcycle::study::plan::Base;
use cvtcycle::validate::published;
use serde::Serialize;

use super::threads::in_parallel;
use super::vehicles::{self, Baselines, CaseArgs, ComparedArgs, ComparedVehicles, RunVehicle};
use super::{Execute, threads};
use crate::args::problems::{overrides, problem};
use crate::args::{
    DrivingArgs, Names, OutArgs, OutputArgs, choice_names, count_if_given, one_of, word_for_plan,
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
    case: CaseArgs,
    /// Drive each vehicle again without each loss for the fuel that it costs: always, never, or auto (unless the cycle has more
    /// than 20 000 steps)
    #[arg(long, value_name = "WHEN", default_value = "auto", value_parser = Names(|| choice_names(&When::NAMES)), hide_possible_values = true)]
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
    #[arg(long, value_name = "NAME", default_value = "csv", requires = "out", value_parser = Names(|| choice_names(&TraceFormat::NAMES)), hide_possible_values = true)]
    format: String,
    /// Compute the effect of each value of each vehicle for the report of --out: always, never, or auto (unless the cycle has
    /// more than 20 000 steps)
    #[arg(long, value_name = "WHEN", default_value = "auto", requires = "out", value_parser = Names(|| choice_names(&When::NAMES)), hide_possible_values = true)]
    sensitivity: String,
    #[command(flatten)]
    output: OutputArgs,
}

/// Number of draws of a change without --draws: whole groups of runs that are driven side by side, and enough that runs which agree show 90 % of all. The first lines
/// say how many would give the ends a range of their own (ES-3).
const DRAWS_OF_CHANGE: u64 = 40;

/// A summary with the answer of the draws.
#[derive(Serialize)]
struct WithAnswer<'a> {
    #[serde(flatten)]
    summary: &'a Summary,
    #[serde(skip_serializing_if = "Option::is_none")]
    answer: Option<&'a Answer>,
}

/// Checked input of a run.
pub struct RunPlan {
    cars: ComparedVehicles,
    ambient_degc: f64,
    format: TraceFormat,
    price: When,
    draws: Option<Study>,
    sensitivity: When,
    out: Option<OutputDir>,
}

impl RunArgs {
    /// Arguments of the run behind a report, written to a directory.
    pub fn for_report(case: CaseArgs, dir: &Path) -> RunArgs {
        RunArgs {
            case,
            price: When::Auto.name().to_owned(),
            draws: None,
            strict: false,
            out: OutArgs {
                out: Some(dir.to_path_buf()),
                force: true,
            },
            format: TraceFormat::NAMES[0].0.to_owned(),
            sensitivity: When::Auto.name().to_owned(),
            output: OutputArgs::silent(),
        }
    }

    /// Path of the cycle's file, where no option says how it is read.
    fn cycle_file(&self) -> Option<String> {
        let (word, columns) = (
            &self.case.cars.comparison.cycle.word,
            &self.case.cars.columns,
        );
        let is_plain = columns.columns.is_none() && columns.repair.is_none();
        (is_path(word) && is_plain).then(|| word.clone())
    }

    /// Plan of this run for its draws.
    fn base(
        &self,
        (ambient_degc, start, dt_s, formulation): (f64, &StartWord, f64, Formulation),
        vehicles: &[RunVehicle],
        problems: &mut Problems,
    ) -> Option<Base> {
        let baselines = &vehicles[vehicles.len().min(1)..];
        let ComparedArgs {
            car,
            comparison,
            columns,
        } = &self.case.cars;
        let refused = match (baselines.is_empty(), &columns.columns) {
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
        // The car before its change is no baseline: the question adds it.
        let others = baselines.iter().filter(|car| !car.is_unchanged);
        let others = others.filter(|_| self.draws.is_some());
        let words = others.map(|car| match is_twin(&car.word) {
            true => TWIN.to_owned(),
            false => word_for_plan(&car.word),
        });
        Some(Base {
            vehicle: word_for_plan(&car.vehicle),
            baselines: Some(words.collect()),
            cycle: word_for_plan(&comparison.cycle.word),
            ambient_degc,
            start: start.text(),
            lubricant: car.lubricant.as_deref().map(word_for_plan),
            engine_oil: comparison.engine_oil.as_deref().map(word_for_plan),
            set: overrides("--set", &car.set, problems),
            set_all: overrides("--set-all", &comparison.set_all, problems),
            dt_s,
            formulation,
        })
    }
}

impl Execute for RunArgs {
    type Plan = RunPlan;

    fn plan(&self, problems: &mut Problems) -> Option<RunPlan> {
        let DrivingArgs { drive, formulation } = &self.case.driving;
        let cars = self
            .case
            .cars
            .load(Baselines::OfFile, formulation, problems);
        let ambient = self.case.ambient.get(problems);
        let (start, dt_s) = drive.get(problems);
        let start = start.map(|start| match &cars.cycle {
            Some(cycle) => start_on(cycle, start),
            None => start,
        });
        let format = problems.take(one_of("--format", &self.format, &TraceFormat::NAMES));
        let when = |option: &str, word: &str| one_of(option, word, &When::NAMES);
        let price = problems.take(when("--price", &self.price));
        let sensitivity = problems.take(when("--sensitivity", &self.sensitivity));
        if self.out.out.is_some() || price != Some(When::Never) || self.draws.is_some() {
            problems.take(threads::begin(None));
        }
        let wanted = count_if_given("--draws", self.draws.as_ref(), DRAWS, problems);
        let is_changed = cars.vehicles.iter().any(|car| car.is_unchanged);
        let is_drawn = is_changed && self.case.cars.columns.columns.is_none();
        let wanted = wanted.or((is_drawn && self.draws.is_none()).then_some(DRAWS_OF_CHANGE));
        let draws = match (wanted, ambient, &start, dt_s) {
            (Some(n), Some(degc), Some((_, start)), Some(dt_s)) if problems.is_empty() => {
                let how = (degc, start, dt_s, cars.formulation);
                let base = self.base(how, &cars.vehicles, problems);
                base.and_then(|base| problems.take(prepare(&base, n)))
            }
            _ => None,
        };
        if self.out.out.is_some() {
            let kept = cars.cycle.as_ref().zip(dt_s);
            let kept = kept.map(|(cycle, dt_s)| vehicles::kept_steps(&cars.vehicles, cycle, dt_s));
            kept.and_then(|kept| problems.take(kept));
        }
        let out = self.out.dir(problems);
        Some(RunPlan {
            cars: cars.driven(start, dt_s)?,
            ambient_degc: ambient?,
            format: format?,
            price: price?,
            draws,
            sensitivity: sensitivity?,
            out,
        })
    }

    fn run(&self, mut plan: RunPlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        let (cycle, vehicles) = (&plan.cars.cycle, &plan.cars.vehicles);
        let conditions = plan.cars.conditions(plan.ambient_degc, out.is_some());
        // Looks up published values by the name of a shipped vehicle, in parallel with the drive.
        let names: Vec<&str> = vehicles.iter().map(|car| car.name.as_str()).collect();
        let read = || published(names[0], &names[1..], &cycle.name);
        let (published, outcomes) = in_parallel(read, || plan.cars.drive(&conditions));
        let driven = vehicles::driven(vehicles, &outcomes);
        let question = RunQuestion {
            cycle,
            conditions,
            ambient_degc: plan.ambient_degc,
            start: plan.cars.start.1.clone(),
            settings: plan.cars.settings(&self.case.cars, self.strict),
            price: plan.price.wanted(cycle, plan.cars.dt_s),
            has_unchanged: vehicles.iter().any(|car| car.is_unchanged),
            published: Some(published),
        };
        let mut summary = summary(&question, &driven);
        let mut answer = match &plan.draws {
            Some(study) => drive_cars(study, &NoProgress)?,
            None => None,
        };
        if let Some(answer) = &mut answer {
            answer.merge(&mut summary);
            answer.doubts = input_doubts(&summary);
        }
        let mut record = None;
        if out.is_some() {
            let inputs = files::record(vehicles, cycle, &conditions, plan.sensitivity)?;
            let mut inputs = inputs;
            inputs.cycle.file = self.cycle_file();
            name_run(&mut summary, record.insert(inputs));
        }
        let json = match out.is_some() || self.output.json() {
            true => json_text(&WithAnswer {
                summary: &summary,
                answer: answer.as_ref(),
            })?,
            false => String::new(),
        };
        let files = WrittenFiles::write(out, |dir| {
            run_files::write(dir, plan.format, &summary, cycle, &driven)?;
            dir.put("summary.json", &json)?;
            // Written last, because it lists the other files.
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
