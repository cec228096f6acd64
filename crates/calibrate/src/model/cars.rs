//! The cars of a plan: loaded, with their problems at their places in the plan.

use std::collections::{HashMap, HashSet};

use crate::plan::{CalibrationPlan, FreeParameter, Observable, problem};
use crate::solve::Parameter;
use cvtcycle_config::ProblemKind::{Conflict, Missing, OutOfRange};
use cvtcycle_config::setup::{Param, ParamSet, Setup, load};
use cvtcycle_config::{Argument, Input, KeyInfo, Override, Place, Problem, ProblemKind, Problems};
use cvtcycle_model::rig::transmission::Conditions;
use cvtcycle_validate::source::Source;

/// A car of the plan with parameters that the fit changes.
pub struct FittedCar {
    pub base: ParamSet,
    /// The parameters in it, with their places among those of the plan.
    pub params: Vec<(usize, Param)>,
}

/// Settings of the transmission rig and their keys.
pub type RigConditions = (Conditions, Vec<KeyInfo>);

/// All cars of a plan.
pub struct Cars<'p> {
    plan: &'p CalibrationPlan,
    /// Cars that the fit changes, the plan's own without changes of a source first.
    pub fitted: Vec<FittedCar>,
    /// Index of the fitted car by [`Cars::name`].
    by_name: HashMap<String, usize>,
    /// Cars that the fit does not change, by the same.
    fixed: HashMap<String, Setup>,
    conditions: HashMap<String, RigConditions>,
    /// Value of the file and unit of each parameter, by the first vehicle that has it.
    pub known: Vec<(f64, String)>,
}

/// Car of a source.
pub enum Car<'a> {
    /// Index of a car that the fit changes.
    Fitted(usize),
    /// A car that the fit does not change.
    Fixed(&'a Setup),
}

impl<'p> Cars<'p> {
    /// Loads the cars of a plan; with the parameters of the fit.
    pub fn load(plan: &'p CalibrationPlan) -> Result<(Self, Vec<Parameter>), Problems> {
        let mut cars = Cars {
            plan,
            fitted: Vec::new(),
            by_name: HashMap::new(),
            fixed: HashMap::new(),
            conditions: HashMap::new(),
            known: Vec::new(),
        };
        let mut problems: Problems = cars.add(None).err().unwrap_or_default();
        problems = problems.map(|p| in_plan(plan, p));
        problems.extend(cars.set_and_free(&plan.car.set, &plan.places[3]));
        let mut parameters = Vec::new();
        let rig = plan.car.conditions(None).err().unwrap_or_default();
        problems.extend(rig.map(|p| in_plan(plan, p)));
        for source in used(plan) {
            let mut found = cars.add_source(source, &problems);
            found.retain(|problem| !problems.contains(problem));
            problems.extend(found);
        }
        for (k, free) in plan.parameters.iter().enumerate() {
            let found: Vec<(&FittedCar, &Param)> = (cars.fitted.iter())
                .flat_map(|car| {
                    let own = car.params.iter().filter(|(place, _)| *place == k);
                    own.map(move |(_, param)| (car, param))
                })
                .collect();
            match found.first() {
                Some((_, param)) => {
                    let mut at_bounds = found
                        .iter()
                        .map(|(car, param)| at_bounds(free, param, &car.base));
                    problems.extend(
                        at_bounds
                            .find(|found| !found.is_empty())
                            .unwrap_or_default(),
                    );
                    problems.extend(of_other_unit(free, &found));
                    if problems.is_empty() {
                        problems.extend(in_no_vehicle(free, &found));
                    }
                    parameters.push(parameter((free, free.name(plan)), param, &mut problems));
                    cars.known.push((param.base(), param.unit().to_owned()));
                }
                None if problems.is_empty() => problems.push(unused(free)),
                // The problem of one that is not found is known already.
                None => {}
            }
        }
        if problems.is_empty() {
            Ok((cars, parameters))
        } else {
            Err(problems)
        }
    }

    /// The car of a source, loaded before.
    pub fn car(&self, source: Option<&Source>) -> Car<'_> {
        let name = self.name(source);
        let fitted = || Car::Fitted(self.by_name.get(&name).copied().unwrap_or(0));
        self.fixed.get(&name).map_or_else(fitted, Car::Fixed)
    }

    /// Settings of the transmission rig for a source.
    pub fn conditions(&self, source: Option<&Source>) -> Result<RigConditions, Problems> {
        let name = format!("{:?}", self.plan.car.overrides(source));
        let known = self.conditions.get(&name).cloned();
        known.map_or_else(|| self.plan.car.conditions(source), Ok)
    }

    /// Vehicle and options of a source as one text.
    fn name(&self, source: Option<&Source>) -> String {
        let car = &self.plan.car;
        let own = source.is_none_or(|source| source.vehicle.is_none());
        format!("{own} {} {:?}", car.vehicle_of(source), car.options(source))
    }

    fn add(&mut self, source: Option<&Source>) -> Result<(), Problems> {
        let name = self.name(source);
        if self.by_name.contains_key(&name) || self.fixed.contains_key(&name) {
            return Ok(());
        }
        let car = &self.plan.car;
        let options = car.options(source);
        let vehicle = source.and_then(|source| source.vehicle.as_ref());
        let vehicle = vehicle.unwrap_or(&car.vehicle);
        let plan = self.plan;
        let own = |(_, free): &(usize, &FreeParameter)| free.is_of(vehicle, plan);
        let free: Vec<_> = plan.parameters.iter().enumerate().filter(own).collect();
        if free.is_empty() && *vehicle != car.vehicle {
            self.fixed.insert(name, load(vehicle, &options)?);
            return Ok(());
        }
        let base = ParamSet::load(vehicle, &options)?;
        let mut problems = Problems::new();
        let mut params = Vec::new();
        for (k, free) in free {
            let (found, refused) = in_vehicle(free, &base);
            params.extend(found.into_iter().map(|param| (k, param)));
            let refused = refused.into_iter();
            problems.extend(refused.map(|(key, found)| not_free(free, key, found, vehicle)));
        }
        // With the parameters that were found more can be checked; nothing is computed after a problem.
        self.by_name.insert(name, self.fitted.len());
        self.fitted.push(FittedCar { base, params });
        if problems.is_empty() {
            Ok(())
        } else {
            Err(problems)
        }
    }

    /// Loads the car and rig of a source; returns its problems except those of the plan's own car, which are `known`.
    fn add_source(&mut self, source: &Source, known: &[Problem]) -> Problems {
        let context = format!("source `{}`: ", source.name);
        let at = |found: Problem| {
            let own = Some(&found.place).filter(|place| place.line > 0);
            let place = own.unwrap_or(&source.place).clone();
            let found = match found.place.is_argument(Argument::Lubricant) {
                true => found.key("lubricant"),
                false => found,
            };
            assigned(found, place).with_context(&context)
        };
        let is_new = |found: &Problem| {
            let same = |old: &Problem| old.message == found.message && old.value == found.value;
            !known.iter().any(same)
        };
        let mut problems = Problems::new();
        if source.vehicle.is_none() {
            problems.extend(self.set_and_free(&source.set, &source.place).map(at));
            problems.extend(self.fitted_fluid(source));
        }
        // Without the plan's own car there is none with a source's changes either.
        if source.vehicle.is_some() || !self.fitted.is_empty() {
            let found = self.add(Some(source)).err().unwrap_or_default();
            problems.extend(found.into_iter().filter(is_new).map(at));
        }
        match self.plan.car.conditions(Some(source)) {
            Ok(found) => {
                let name = format!("{:?}", self.plan.car.overrides(Some(source)));
                self.conditions.insert(name, found);
            }
            Err(found) => problems.extend(found.into_iter().filter(is_new).map(at)),
        }
        problems
    }

    /// A fluid of a source's own, where one is fitted.
    fn fitted_fluid(&self, source: &Source) -> Option<Problem> {
        source.lubricant.as_ref()?;
        let of_fluid = |free: &&FreeParameter| free.keys().any(|key| key.starts_with("lubricant."));
        let free = self.plan.parameters.iter().find(of_fluid)?;
        let message = format!(
            "source `{}` has a fluid of its own, in which `{}` would be another value",
            source.name, free.key
        );
        let hint = "fit the two fluids in plans of their own";
        Some(problem(
            Conflict,
            &source.place,
            "lubricant",
            "",
            message,
            hint,
        ))
    }

    /// Parameters that an override sets.
    fn set_and_free(&self, set: &[Override], place: &Place) -> Problems {
        let keys = self.plan.parameters.iter().flat_map(FreeParameter::keys);
        let both = keys.filter(|key| set.iter().any(|by| by.key() == *key));
        both.map(|key| {
            let message = format!("`{key}` is set and free");
            let hint = "what is set is held: remove it from `set`, or remove its [[parameter]]";
            problem(
                Conflict,
                &place.clone().of_item(key),
                "set",
                "",
                message,
                hint,
            )
        })
        .collect()
    }
}

/// The problem of a parameter of vehicles that no data are of.
fn unused(free: &FreeParameter) -> Problem {
    let message = format!("no data are of a vehicle of `{}`", free.key);
    let hint = "name a vehicle of a source or of points, or remove the parameter";
    let allowed = "vehicles of the data";
    problem(Conflict, &free.place, "vehicles", allowed, message, hint)
}

/// The keys of a parameter that a vehicle has, and those that it refuses. A key of another transmission is refused only if the vehicle has no
/// key of the parameter at all.
pub fn in_vehicle<'f>(
    free: &'f FreeParameter,
    base: &ParamSet,
) -> (Vec<Param>, Vec<(&'f str, Problem)>) {
    let (mut params, mut refused) = (Vec::new(), Vec::new());
    for key in free.keys() {
        match base.param(key) {
            Ok(param) => params.push(param),
            Err(found) => refused.push((key, found)),
        }
    }
    if !params.is_empty() {
        refused.retain(|(_, found)| found.kind != ProblemKind::WrongTransmission);
    }
    refused.truncate(1);
    (params, refused)
}

/// The problem of keys that cannot have one number because their units differ.
fn of_other_unit(free: &FreeParameter, found: &[(&FittedCar, &Param)]) -> Option<Problem> {
    let (_, first) = found.first()?;
    let (_, other) = found
        .iter()
        .find(|(_, param)| param.unit() != first.unit())?;
    let message = format!(
        "`{}` in `{}` and `{}` in `{}` cannot be one number",
        first.key(),
        first.unit(),
        other.key(),
        other.unit()
    );
    let hint = "give each a [[parameter]] of its own";
    let allowed = "keys of one unit";
    Some(problem(
        Conflict,
        &free.place,
        "also",
        allowed,
        message,
        hint,
    ))
}

/// The problem of a key that no vehicle of the parameter has.
fn in_no_vehicle(free: &FreeParameter, found: &[(&FittedCar, &Param)]) -> Option<Problem> {
    let is_set = |key: &str| found.iter().any(|(_, param)| param.key() == key);
    let key = free.keys().find(|key| !is_set(key))?;
    let message = format!("no vehicle of this parameter has `{key}`");
    let hint = "name one that has it in `vehicles`, or remove the key";
    let place = free.also_place.clone().of_item(key);
    let allowed = "keys of the vehicles";
    Some(problem(Conflict, &place, "also", allowed, message, hint))
}

/// The problem of a key that cannot be fitted, at its place in the plan.
fn not_free(free: &FreeParameter, key: &str, found: Problem, vehicle: &str) -> Problem {
    let hint = match found.kind {
        ProblemKind::WrongTransmission | ProblemKind::NotSingle => {
            format!("`cvtcycle show {vehicle}` prints its keys; words and lists are held, in `set`")
        }
        _ => found.hint.clone(),
    };
    let allowed = if found.allowed.is_empty() {
        "the key of a single number of the vehicle or of its fluids".to_owned()
    } else {
        found.allowed.clone()
    };
    let (place, word) = match key == free.key {
        true => (free.place.clone(), "key"),
        false => (free.also_place.clone().of_item(key), "also"),
    };
    found
        .at(place)
        .key(word)
        .value(key)
        .allowed(allowed)
        .hint(hint)
}

/// Bounds at which the car is invalid.
fn at_bounds(free: &FreeParameter, param: &Param, base: &ParamSet) -> Vec<Problem> {
    let mut problems = Vec::new();
    let ends = [("low", free.low), ("high", free.high)];
    for ((word, value), place) in ends.into_iter().zip(&free.bounds) {
        let Err(found) = base.with_numbers(&[(param, value)]) else {
            continue;
        };
        let first = found.into_iter().next().unwrap_or_default();
        let message = format!(
            "parameter {}: the car is refused at `{word}`: {}",
            free.key, first.message
        );
        // The problem may be another key that depends on this one.
        let own = first.key.is_empty() || param.key().ends_with(&first.key);
        let hint = if own || first.hint.is_empty() {
            "bounds are in the unit of the key; the search may go to both"
        } else {
            &first.hint
        };
        let allowed = if first.allowed.is_empty() {
            param.allowed()
        } else {
            &first.allowed
        };
        let problem = problem(first.kind, place, word, allowed, message, hint).names_key();
        problems.push(problem.value(value.to_string()));
    }
    problems
}

/// The parameter of the fit.
fn parameter(
    (free, name): (&FreeParameter, String),
    param: &Param,
    problems: &mut Problems,
) -> Parameter {
    let start = free.start.unwrap_or(param.base());
    let mut refuse = |kind, allowed: &str, message: &str, hint: &str| {
        let message = format!("parameter {}: {message}", free.key);
        problems.push(problem(kind, &free.place, "start", allowed, message, hint));
    };
    if start.is_nan() {
        let hint = "add `start`, in the unit of the key";
        refuse(
            Missing,
            "a number",
            "the file has no value to start from",
            hint,
        );
    } else if !(free.low..=free.high).contains(&start) {
        let allowed = format!("{} to {}", free.low, free.high);
        let message = format!("the file's value {start} is outside the bounds");
        refuse(
            OutOfRange,
            &allowed,
            &message,
            "widen the bounds, or add `start`",
        );
    }
    Parameter {
        prior: free.prior,
        ..Parameter::new(name, start, free.low, free.high)
    }
}

/// A problem of the plan's own car at its place in the plan, unless its place is in a file.
fn in_plan(plan: &CalibrationPlan, found: Problem) -> Problem {
    let [vehicle, lubricant, engine_oil, set] = &plan.places;
    let (place, key) = match &found.place.input {
        Input::Argument(Argument::Lubricant) => (lubricant, "lubricant"),
        Input::Argument(Argument::EngineOil) => (engine_oil, "engine_oil"),
        Input::Argument(_) => (vehicle, "vehicle"),
        Input::Override(_) => (set, "set"),
        Input::File(_) => return found,
    };
    assigned(found.key(key), place.clone())
}

/// A problem moved to a place in the plan: to the assignment of a list, where it is in that line.
fn assigned(found: Problem, place: Place) -> Problem {
    let place = place.of_item(found.place.assignment().unwrap_or_default());
    found.at(place)
}

/// All sources of the observations, each once.
fn used(plan: &CalibrationPlan) -> Vec<&Source> {
    let benches = plan.benches.iter().map(|bench| &bench.source);
    let mut found: Vec<&Source> = benches.chain(&plan.runs).collect();
    for observation in &plan.observations {
        if let Observable::Expression { view, expr } = &observation.observable {
            let sources = expr.sources().into_iter().flatten();
            found.extend(sources.filter_map(|k| plan.views[*view].get(k)));
        }
    }
    let mut seen = HashSet::new();
    found.retain(|s| seen.insert((&s.name, s.place.file_name(), s.place.line, s.place.column)));
    found
}
