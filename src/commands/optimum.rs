//! `optimum`: the least fuel that any controller of ratio and clamp can burn, and the operating line near it.

mod limits;
mod tables;

use std::path::Path;

use clap::Args;
use cvtcycle::analysis::optimum::{self, Answer, LawCar, NoAnswer, Question, ReadFrom};
use cvtcycle::config::csv::Columns;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::config::setup::{self, Options, Setup};
use cvtcycle::config::{Problems, cycle};
use cvtcycle::model::drive::{Conditions, Start};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::model::transmission::cvt::controller::{ClampKeys, ClampLaw};
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::record::Manifest;
use cvtcycle::output::summary::{SCHEMA, StartWord, start_on};
use serde::Serialize;

use super::{Execute, threads, vehicles};
use crate::args::problems::{bad_value, cite};
use crate::args::{
    AmbientArgs, ColumnsArgs, CycleArgs, DrivingArgs, Names, ResultArgs, ThreadArgs, VehicleArgs,
    cycles, number,
};
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text};
use limits::{MIN_RPM, Numbers, infeasible};

/// Minimum engine speeds for which the bound is printed, rpm.
const MIN_SPEEDS_RPM: [f64; 5] = [1000.0, 1100.0, 1200.0, 1300.0, 1500.0];

/// Arguments of `optimum`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.help("Write bound.csv, least_speed.csv, path.csv, the vehicle file with the line and summary.json into this directory")),
    mut_arg("dt", |dt| dt.default_value("0.25")),
    after_help = "\
Examples:
  cvtcycle optimum
  cvtcycle optimum --ambient -10 --least-rpm 1200 --reserve 15 --out best
  cvtcycle run --vehicle best/rover_216_cvt_line.toml
  cvtcycle optimum --vehicle mycar.toml --cycle wltc_class3b --no-line

Least fuel by dynamic programming over the ratio, and the clamping pressure where it is free, with the losses and temperatures of the model. \
No controller of ratio and clamp within the limits burns less than the bound, which is the least fuel less its tolerance. The least engine \
speed decides it, so it is given for several. The operating line is what a controller can do that sees demand and speed only: curves of a \
vehicle file (drive_line, overrun_line), proven by driving that file. Steps of 0.25 s: knowing the next second is worth more with longer ones. \
A torque converter locks up by its own law, start-stop by its own; the limits count while engine and box turn together."
)]
pub struct OptimumArgs {
    #[command(flatten)]
    car: VehicleArgs,
    #[command(flatten)]
    cycle: CycleArgs,
    #[command(flatten)]
    columns: ColumnsArgs,
    #[command(flatten)]
    ambient: AmbientArgs,
    #[command(flatten)]
    driving: DrivingArgs,
    /// Least engine speed with the clutch locked, rpm
    #[arg(
        long,
        value_name = "RPM",
        default_value = "1100",
        allow_hyphen_values = true
    )]
    least_rpm: String,
    /// Torque that is kept in reserve, % of full load
    #[arg(
        long,
        value_name = "PERCENT",
        default_value = "10",
        allow_hyphen_values = true
    )]
    reserve: String,
    /// Least safety factor of a free clamp
    #[arg(
        long,
        value_name = "X",
        default_value = "1.3",
        allow_hyphen_values = true
    )]
    safety: String,
    /// Largest slip with a free clamp, %
    #[arg(
        long,
        value_name = "PERCENT",
        default_value = "3",
        allow_hyphen_values = true
    )]
    max_slip: String,
    /// Ratios of the grid: four times a number, and one
    #[arg(
        long,
        value_name = "N",
        default_value = "97",
        allow_hyphen_values = true
    )]
    grid: String,
    /// The car's own clamp law only, and its own launch
    #[arg(long)]
    own_clamp: bool,
    /// Cycle on which the line is driven too (repeatable); `none` for none
    #[arg(
        long,
        value_name = "NAME|FILE.csv",
        default_values = ["wltc", "ftp75"],
        value_parser = Names(cycles),
        hide_possible_values = true
    )]
    prove: Vec<String>,
    /// No operating line
    #[arg(long)]
    no_line: bool,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    results: ResultArgs,
}

/// Checked input.
pub struct OptimumPlan {
    cycle: Cycle,
    /// Further cycles for its line.
    elsewhere: Vec<Cycle>,
    /// The car under its own clamp law, then under the others.
    cars: Vec<(&'static str, Setup)>,
    options: Options,
    conditions: Conditions,
    start: StartWord,
    numbers: Numbers,
    out: Option<OutputDir>,
}

/// The object of `--json` and `summary.json`.
#[derive(Debug, Serialize)]
pub struct OptimumSummary {
    #[serde(flatten)]
    manifest: Manifest,
    vehicle: String,
    cycle: String,
    start: StartWord,
    #[serde(flatten)]
    numbers: Numbers,
    #[serde(flatten)]
    answer: Answer,
}

impl Execute for OptimumArgs {
    type Plan = OptimumPlan;

    fn plan(&self, problems: &mut Problems) -> Option<OptimumPlan> {
        let columns = self.columns.get(problems);
        let cycle = problems.take(self.own_cycle(&columns));
        let elsewhere = self.elsewhere(&columns, problems);
        let formulation = self.driving.formulation.get(problems);
        let options = self.car.options(formulation, problems);
        let setup = problems.take(setup::load(&self.car.vehicle, &options));
        let hint = "a manual box has gears; `study` varies its shift speeds";
        self.car.need_cvt(setup.as_ref(), hint, problems);
        let (start, dt_s) = self.driving.drive.get(problems);
        let least = number("--least-rpm", &self.least_rpm, MIN_RPM, "least_rpm");
        let least = problems.take(least);
        let numbers = self.numbers((dt_s, least), problems);
        if let Some(setup) = &setup {
            self.check_min_speed(setup, least, problems);
        }
        if let (Some(cycle), Some(dt_s)) = (&cycle, dt_s) {
            self.check_cycle(cycle, dt_s, problems);
        }
        let given = self.threads.given(problems);
        problems.take(threads::begin(given));
        let out = self.results.out.dir(problems);
        let numbers = numbers?;
        let own = setup.filter(|setup| setup.transmission().is_cvt())?;
        let cycle = cycle::for_car(&self.cycle.word, cycle?, &own);
        let start = start_on(&cycle, start?);
        let others = elsewhere.into_iter();
        let others = others.map(|(word, other)| cycle::for_car(&word, other, &own));
        Some(OptimumPlan {
            elsewhere: others.filter(|other| other.name != cycle.name).collect(),
            cycle,
            cars: self.laws(own, &options),
            options,
            conditions: conditions(&numbers, start.0),
            start: start.1,
            numbers,
            out,
        })
    }

    fn run(&self, mut plan: OptimumPlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        let cars: Vec<LawCar> = plan
            .cars
            .iter()
            .map(|(law, setup)| LawCar { law, setup })
            .collect();
        let n = plan.numbers;
        let free = (n.safety, n.max_slip_percent / 100.0);
        let question = Question {
            cars: &cars,
            cycle: &plan.cycle,
            conditions: plan.conditions,
            least_rpm: n.least_rpm,
            reserve: n.reserve_percent / 100.0,
            free: (!self.own_clamp).then_some(free),
            rates_per_s: None,
            grid: n.ratios,
            line: !self.no_line,
            elsewhere: &plan.elsewhere,
            launch_at_idle: !self.own_clamp,
            least_speeds_rpm: &MIN_SPEEDS_RPM,
        };
        let dir = self.results.out.out.as_deref();
        let from = ReadFrom {
            vehicle: &self.car.vehicle,
            options: &plan.options,
            named: &|word| named_from(dir, word),
        };
        let answer = optimum::answer(&question, &from);
        let answer = answer.map_err(|none| match none {
            NoAnswer::Infeasible(why) => infeasible(&why, self),
            NoAnswer::Line(problems) => problems,
            NoAnswer::NoCvt => {
                let allowed = "a vehicle with a CVT";
                let message = "the vehicle has no CVT";
                bad_value("--vehicle", &self.car.vehicle, allowed, message, "").into()
            }
            NoAnswer::TwoRanges => {
                let allowed = "a vehicle whose CVT has one range";
                let message = "the best ratio is sought in one range, and this box has two";
                let hint = "compare controls by `levers`, or set transmission.cvt.ranges = \"one\"";
                bad_value("--vehicle", &self.car.vehicle, allowed, message, hint).into()
            }
        })?;
        let summary = OptimumSummary {
            manifest: Manifest::new(SCHEMA),
            vehicle: plan.cars[0].1.name.clone(),
            cycle: plan.cycle.name.clone(),
            start: plan.start,
            numbers: n,
            answer,
        };
        let json = json_text(&summary)?;
        let files = WrittenFiles::write(out, |dir| {
            tables::write(dir, &summary)?;
            dir.put("summary.json", &json)?;
            Ok("")
        })?;
        let failures = summary.answer.failures.clone();
        let results = Results::new(json, failures, files);
        Ok(results.output(&self.results.output, || {
            tables::text(&summary, terminal.stdout)
        }))
    }
}

fn conditions(numbers: &Numbers, start: Start) -> Conditions {
    Conditions {
        ambient_k: numbers.ambient_degc + ZERO_DEGC_K,
        start,
        max_dt_s: numbers.dt_s,
        keep_rows: false,
    }
}

impl OptimumArgs {
    /// Reads the cycle. Columns may be meant for the files of `--prove` only.
    fn own_cycle(&self, columns: &Columns) -> Result<Cycle, Problems> {
        let is_file = |word: &String| word.ends_with(".csv");
        match !is_file(&self.cycle.word) && self.prove.iter().any(is_file) {
            true => cycle::find(&self.cycle.word),
            false => cycle::open(&self.cycle.word, columns),
        }
    }

    /// Reads the further cycles of the line by their names on the command line. The columns may apply to any of their files.
    fn elsewhere(&self, columns: &Columns, problems: &mut Problems) -> Vec<(String, Cycle)> {
        let others = |word: &&String| word.as_str() != "none";
        let mut open = |word: &String| {
            let found = match word.ends_with(".csv") {
                true => cycle::open(word, columns),
                false => cycle::find(word),
            };
            let found = found.map_err(|found| cite("--prove", found));
            Some((word.clone(), problems.take(found)?))
        };
        let words = self.prove.iter().filter(others);
        words.filter_map(&mut open).collect()
    }

    fn check_cycle(&self, cycle: &Cycle, dt_s: f64, problems: &mut Problems) {
        let trace = cycle.trace_for(true);
        if trace.max_speed_m_s() <= 0.0 {
            let message = "the car is at rest all the time: there is nothing to choose";
            let allowed = "a cycle that is driven";
            problems.add(bad_value("--cycle", &self.cycle.word, allowed, message, ""));
        }
        problems.take(vehicles::kept_count(trace.step_count(dt_s), dt_s));
    }

    /// The car under its own clamp law, then under each other law that its file has values for.
    fn laws(&self, own: Setup, options: &Options) -> Vec<(&'static str, Setup)> {
        let name = law_of(&own);
        let mut cars = vec![(name, own)];
        let others = ClampKeys::CHOICES.iter().map(|choice| choice.name);
        for law in others.filter(|law| *law != name && !self.own_clamp) {
            let set = format!("transmission.cvt.clamp={law}").parse();
            let Ok(set) = set else { continue };
            let mut options = options.clone();
            options.set.push(set);
            cars.extend(setup::load(&self.car.vehicle, &options).map(|car| (law, car)));
        }
        cars
    }
}

/// Converts a name, or a path from the current folder, for a file in another directory.
fn named_from(dir: Option<&Path>, word: &str) -> String {
    let Some(dir) = dir.filter(|_| word.ends_with(".toml")) else {
        return word.to_owned();
    };
    let [Ok(dir), Ok(file)] = [dir, Path::new(word)].map(std::path::absolute) else {
        return word.to_owned();
    };
    let pairs = dir.components().zip(file.components());
    let common = pairs.take_while(|(a, b)| a == b).count();
    if common == 0 {
        return file.display().to_string(); // on another drive
    }
    let up = dir.components().skip(common).map(|_| "..");
    let down = file.components().skip(common);
    let down = down.map(|part| part.as_os_str().to_string_lossy().into_owned());
    let all: Vec<String> = up.map(str::to_owned).chain(down).collect();
    all.join("/")
}

fn law_of(setup: &Setup) -> &'static str {
    let law = optimum::cvt(&setup.car(ZERO_DEGC_K)).map(|cvt| cvt.clamp);
    match law {
        Some(ClampLaw::TorqueFollowing { .. }) => "torque_following",
        Some(ClampLaw::SlipLimited { .. }) => "slip_limited",
        Some(ClampLaw::Table) => "table",
        Some(ClampLaw::Map(_)) | None => "map",
    }
}
