//! Vehicles of a run: the subject with its overrides, then the baselines.

use clap::Args;
use cvtcycle::config::bounded;
use cvtcycle::config::cycle::{self, Cycle};
use cvtcycle::config::setup::{self, NamedBy, Options, Setup};
use cvtcycle::config::{Argument, Override, Problem, Problems};
use cvtcycle::model::drive::{Conditions, Outcome, Start, drive};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::summary::{Driven, Settings, StartWord, start_on};

use super::threads::in_parallel;
use crate::args::problems::{cite_override, overrides};
use crate::args::{
    AmbientArgs, ColumnsArgs, ComparisonArgs, DrivingArgs, FormulationArgs, VehicleArgs,
};

/// A vehicle of a run.
pub struct RunVehicle {
    /// Name of the vehicle file, with a number if two vehicles share it.
    pub name: String,
    /// Checked input.
    pub setup: Setup,
    /// Name or path, from the command line or from the subject's file.
    pub word: String,
    /// Options of its reading.
    pub options: Options,
    /// True for the subject before the changes of its user.
    pub is_unchanged: bool,
}

/// A run: its vehicles, cycle and conditions.
#[derive(Args, Clone, Debug)]
pub struct CaseArgs {
    #[command(flatten)]
    pub cars: ComparedArgs,
    #[command(flatten)]
    pub ambient: AmbientArgs,
    #[command(flatten)]
    pub driving: DrivingArgs,
}

/// Vehicles to compare, and their cycle.
#[derive(Args, Clone, Debug)]
pub struct ComparedArgs {
    #[command(flatten)]
    pub car: VehicleArgs,
    #[command(flatten)]
    pub comparison: ComparisonArgs,
    #[command(flatten)]
    pub columns: ColumnsArgs,
}

impl ComparedArgs {
    /// Reads the cycle and the vehicles.
    pub fn load(
        &self,
        baselines: Baselines,
        formulation: &FormulationArgs,
        problems: &mut Problems,
    ) -> Loaded {
        let word = &self.comparison.cycle.word;
        let columns = self.columns.get(problems);
        let (mut of_form, mut of_vehicles) = (Problems::new(), Problems::new());
        let formulation = formulation.get(&mut of_form);
        let comparison = (&self.comparison, baselines);
        let (cycle, vehicles) = in_parallel(
            || cycle::open(word, &columns),
            || load(&self.car, comparison, formulation, &mut of_vehicles),
        );
        let cycle = problems.take(cycle);
        problems.extend(of_form);
        problems.extend(of_vehicles);
        Loaded {
            cycle: subject_cycle(word, cycle, &vehicles),
            vehicles,
            formulation,
        }
    }
}

/// Vehicles and cycle; those with problems are missing.
pub struct Loaded {
    pub cycle: Option<Cycle>,
    pub vehicles: Vec<RunVehicle>,
    pub formulation: Formulation,
}

impl Loaded {
    /// Adds start and longest step, s.
    pub fn driven(
        self,
        start: Option<(Start, StartWord)>,
        dt_s: Option<f64>,
    ) -> Option<ComparedVehicles> {
        let cycle = self.cycle?;
        Some(ComparedVehicles {
            start: start_on(&cycle, start?),
            cycle,
            vehicles: self.vehicles,
            dt_s: dt_s?,
            formulation: self.formulation,
        })
    }
}

/// Vehicles compared on a cycle, subject first.
pub struct ComparedVehicles {
    pub cycle: Cycle,
    pub vehicles: Vec<RunVehicle>,
    pub start: (Start, StartWord),
    pub dt_s: f64,
    pub formulation: Formulation,
}

impl ComparedVehicles {
    /// Conditions of a drive at an ambient temperature, degC.
    pub fn conditions(&self, ambient_degc: f64, keep_rows: bool) -> Conditions {
        Conditions {
            ambient_k: ambient_degc + ZERO_DEGC_K,
            start: self.start.0,
            max_dt_s: self.dt_s,
            keep_rows,
        }
    }

    /// Settings for the summary.
    pub fn settings(&self, args: &ComparedArgs, strict: bool) -> Settings {
        Settings {
            dt_s: self.dt_s,
            formulation: self.formulation.name().to_owned(),
            set: args.car.set.clone(),
            set_all: args.comparison.set_all.clone(),
            strict,
        }
    }

    /// Drives all of them.
    pub fn drive(&self, conditions: &Conditions) -> Vec<Outcome> {
        let drive = |car: &RunVehicle| drive(&car.setup, &self.cycle, conditions);
        let Some((subject, baselines)) = self.vehicles.split_first() else {
            return Vec::new();
        };
        if baselines.is_empty() {
            return vec![drive(subject)];
        }
        let others = || baselines.iter().map(drive).collect::<Vec<_>>();
        let (others, own) = in_parallel(others, || drive(subject));
        std::iter::once(own).chain(others).collect()
    }
}

/// Pairs the vehicles with their outcomes, for a summary.
pub fn driven<'a>(vehicles: &'a [RunVehicle], outcomes: &'a [Outcome]) -> Vec<Driven<'a>> {
    let driven = vehicles.iter().zip(outcomes).map(|(car, outcome)| Driven {
        name: &car.name,
        setup: &car.setup,
        outcome,
    });
    driven.collect()
}

/// Checks that the steps of all vehicles fit into memory.
/// # Errors
/// A problem of `--dt`.
pub fn kept_steps(vehicles: &[RunVehicle], cycle: &Cycle, dt_s: f64) -> Result<(), Problem> {
    let steps = vehicles.iter().map(|car| {
        let is_cvt = car.setup.transmission().is_cvt();
        cycle.trace_for(is_cvt).step_count(dt_s)
    });
    kept_count(steps.fold(0, usize::saturating_add), dt_s)
}

/// Checks that a number of steps fits into memory.
/// # Errors
/// A problem of `--dt`.
pub fn kept_count(steps: usize, dt_s: f64) -> Result<(), Problem> {
    bounded::kept_steps(steps, dt_s)
        .map_err(|problem| problem.in_file("--dt").key("--dt").value(dt_s.to_string()))
}

/// Source of the baselines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Baselines {
    /// Options, else the vehicle file.
    OfFile,
    /// Options only.
    Named,
}

/// Loads all vehicles, subject first. A bad one leaves its problems, and the others are read too.
pub fn load(
    car: &VehicleArgs,
    (comparison, baselines): (&ComparisonArgs, Baselines),
    formulation: Formulation,
    problems: &mut Problems,
) -> Vec<RunVehicle> {
    let own = overrides("--set", &car.set, problems);
    let set_all = overrides("--set-all", &comparison.set_all, problems);
    let baseline = Options {
        engine_oil: comparison.engine_oil.clone(),
        set: set_all.clone(),
        formulation,
        ..Options::default()
    };
    let subject = Options {
        lubricant: car.lubricant.clone(),
        set: set_all.iter().cloned().chain(own).collect(),
        ..baseline.clone()
    };
    let setup = problems.take(load_one(&car.vehicle, &subject, &set_all));
    if setup.is_none() {
        check_fluids(car, comparison, problems);
    }
    let names = match baselines {
        Baselines::Named if comparison.baseline.is_empty() => Vec::new(),
        _ => comparison.baselines(&car.vehicle, setup.as_ref(), problems),
    };
    // Problems of a baseline cite the file or the option that names it.
    let (option, named_by) = match comparison.baseline.is_empty() {
        true => (car.vehicle.as_str(), NamedBy::File),
        false => ("--baseline", NamedBy::Caller),
    };
    let baseline = Options {
        named_by,
        ..baseline
    };
    // A change is compared with the car of the file, unless that is no whole car without it. A baseline that names the same file is that car.
    let is_changed = car.lubricant.is_some() || !car.set.is_empty();
    let is_own = |name: &String| setup::is_same_vehicle(name, &car.vehicle);
    let is_named = names.iter().any(is_own);
    let is_wanted = is_named || (baselines == Baselines::OfFile && !comparison.has_none());
    let unchanged = (is_changed && is_wanted)
        .then(|| setup::load(&car.vehicle, &baseline).ok())
        .flatten()
        .filter(|before| setup.as_ref().is_some_and(|after| differs(before, after)));
    let mut loaded = vec![(&car.vehicle, setup, subject.clone())];
    let has_unchanged = unchanged.is_some();
    let names: Vec<String> = names
        .into_iter()
        .filter(|name| !(has_unchanged && is_own(name)))
        .collect();
    loaded.extend(unchanged.map(|mut setup| {
        setup.short += " as it is";
        (&car.vehicle, Some(setup), baseline.clone())
    }));
    // Derives a twin from the subject with its overrides.
    let twin = subject.of_twin(named_by);
    let load_baseline = |name: &String| {
        let options = match setup::is_twin(name) {
            true => &twin,
            false => &baseline,
        };
        let setup = load_one(name, options, &set_all).map_err(|found| cite_vehicle(option, found));
        (setup, options.clone())
    };
    let setups = match names.as_slice() {
        [first, others @ ..] if !others.is_empty() => {
            let others = || others.iter().map(load_baseline).collect::<Vec<_>>();
            let (others, first) = in_parallel(others, || load_baseline(first));
            std::iter::once(first).chain(others).collect()
        }
        names => names.iter().map(load_baseline).collect::<Vec<_>>(),
    };
    for (name, (setup, options)) in names.iter().zip(setups) {
        loaded.push((name, problems.take(setup), options));
    }
    let mut vehicles: Vec<RunVehicle> = Vec::new();
    for (word, setup, options) in loaded {
        let Some(setup) = setup else { continue };
        let is_unchanged = has_unchanged && vehicles.len() == 1;
        let name = match is_unchanged {
            true => "unchanged".to_owned(),
            false => setup.name.clone(),
        };
        vehicles.push(RunVehicle {
            name: unique(&name, &vehicles),
            setup,
            word: word.clone(),
            options,
            is_unchanged,
        });
    }
    vehicles
}

/// True if two readings of a car differ in more than what its twin is derived with.
fn differs(before: &Setup, after: &Setup) -> bool {
    let values = |setup: &Setup| -> Vec<(String, String)> {
        let own = setup
            .keys
            .iter()
            .filter(|info| !info.key.starts_with("twin."));
        own.map(|info| (info.key.clone(), info.value.clone()))
            .collect()
    };
    values(before) != values(after)
}

/// Cycle for the subject: its class selects the WLTC.
fn subject_cycle(word: &str, cycle: Option<Cycle>, vehicles: &[RunVehicle]) -> Option<Cycle> {
    let cycle = cycle?;
    Some(match vehicles.first() {
        Some(subject) => cycle::for_car(word, cycle, &subject.setup),
        None => cycle,
    })
}

/// Checks the fluids alone, after a problem with the vehicle.
fn check_fluids(car: &VehicleArgs, comparison: &ComparisonArgs, problems: &mut Problems) {
    let fluids = [
        (&car.lubricant, Argument::Lubricant),
        (&comparison.engine_oil, Argument::EngineOil),
    ];
    for (word, argument) in fluids {
        let fluid = word.as_ref().map(|word| setup::load_lubricant(word));
        let named = |problem: Problem| match problem.place.is_argument(Argument::Lubricant) {
            true => problem.at(argument),
            false => problem,
        };
        problems.take(fluid.transpose().map_err(|found| found.map(named)));
    }
}

/// Cites the option behind problems of the vehicle's name.
fn cite_vehicle(option: &str, found: Problems) -> Problems {
    found.map(
        |problem| match problem.place.is_argument(Argument::Vehicle) {
            true => problem.in_file(option).key(option),
            false => problem,
        },
    )
}

/// Loads a vehicle. Problems of an override for all vehicles name the vehicle and the option.
fn load_one(word: &str, options: &Options, set_all: &[Override]) -> Result<Setup, Problems> {
    let named = |problem: Problem| {
        let by = set_all.iter().find(|by| by.input() == problem.place.input);
        let Some(by) = by else { return problem };
        let problem = problem.with_context(&format!("{word}: "));
        cite_override("--set-all", &by.to_string(), problem)
    };
    setup::load(word, options).map_err(|problems| problems.map(named))
}

fn unique(name: &str, vehicles: &[RunVehicle]) -> String {
    let is = |car: &RunVehicle, name: &str| car.name.eq_ignore_ascii_case(name);
    let taken = |name: &String| vehicles.iter().any(|car| is(car, name));
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken(name)).unwrap_or_default()
}
