//! Numbers for the parameters to computed observations: the cars are built anew, rigs and cycles run anew.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CM-1 | residual = (computed + common error of its group - measured) / sd; 0 within a measured range | convention |
//! | CM-2 | sd of a trace's values: sd sqrt(n / (duration / t_i + 1)), n values, t_i time after which two are independent | derived: as many values count as are independent |

mod candidate;

use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use candidate::Candidate;

use super::plan::{Free, Observation, Plan, What, at_item, problem};
use super::solve::{Parameter, Prior, Residuals};
use crate::check::source::Source;
use cvtcycle_config::rig::PREFIX;
use cvtcycle_config::setup::template::{ParameterRef, Variant, VehicleTemplate};
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_config::{KeyInfo, Place, Problem, ProblemKind, Problems};
use cvtcycle_model::bench::transmission::Conditions;

/// Width of the range of a common error, in its standard deviations.
const COMMON_WIDTH: f64 = 8.0;

/// One car of the plan, as often as its numbers change.
struct Kind {
    blueprint: VehicleTemplate,
    /// Where each parameter stands in it.
    slots: Vec<ParameterRef>,
    keys: Vec<KeyInfo>,
}

/// What was computed for one set of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// Computed observations, without common errors.
    pub computed: Vec<f64>,
    /// Points behind each that lie outside the validity of a model, or are left out because the belt slips grossly there.
    pub doubtful: Vec<usize>,
}

/// A plan with its cars loaded: ready to be evaluated.
pub struct Model<'p> {
    plan: &'p Plan,
    parameters: Vec<Parameter>,
    kinds: Vec<Kind>,
    /// Index of the kind of car by what a source asks for.
    by_options: HashMap<String, usize>,
    /// Cars that do not change, by the same.
    fixed: HashMap<String, Setup>,
    conditions: HashMap<String, (Conditions, Vec<KeyInfo>)>,
    /// Index of the common error of each group, counted behind the keys.
    common: Vec<Option<usize>>,
    pool: Mutex<Vec<Vec<Variant>>>,
}

impl<'p> Model<'p> {
    /// Loads the cars of a plan.
    ///
    /// # Errors
    /// What is wrong with its vehicle, keys, bounds and sources.
    pub fn new(plan: &'p Plan) -> Result<Self, Problems> {
        let mut model = Model {
            plan,
            parameters: Vec::new(),
            kinds: Vec::new(),
            by_options: HashMap::new(),
            fixed: HashMap::new(),
            conditions: HashMap::new(),
            common: Vec::new(),
            pool: Mutex::default(),
        };
        let mut problems: Problems = model
            .car(None)
            .err()
            .unwrap_or_default()
            .into_iter()
            .map(|p| in_plan(plan, p))
            .collect();
        problems.extend(model.free());
        problems.extend(
            cvtcycle_config::rig::load(&plan.set)
                .err()
                .unwrap_or_default()
                .into_iter()
                .map(|p| in_plan(plan, p)),
        );
        for source in used(plan) {
            let mut found = model.of_source(source, &problems);
            found.retain(|problem| !problems.contains(problem));
            problems.extend(found);
        }
        if !problems.is_empty() {
            return Err(problems);
        }
        for group in &plan.groups {
            model
                .common
                .push(group.common_sd.map(|_| model.parameters.len()));
            if let Some(sd) = group.common_sd {
                let (name, wide) = (format!("common error of {}", group.name), COMMON_WIDTH * sd);
                model.parameters.push(Parameter {
                    name,
                    start: 0.0,
                    low: -wide,
                    high: wide,
                    prior: Some(Prior { mean: 0.0, sd }),
                });
            }
        }
        Ok(model)
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &'p Plan {
        self.plan
    }

    /// Parameters of the fit: those of the plan in their order, then the common errors of groups.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Values of the files, where the first start is not told otherwise.
    #[must_use]
    pub fn file_values(&self) -> Vec<f64> {
        let own = self.kinds[0].slots.iter().map(ParameterRef::base);
        own.chain(
            self.parameters[self.plan.parameters.len()..]
                .iter()
                .map(|parameter| parameter.start),
        )
        .collect()
    }

    /// Units of the parameters.
    #[must_use]
    pub fn units(&self) -> Vec<String> {
        let own = self.kinds[0]
            .slots
            .iter()
            .map(|slot| slot.unit().to_owned());
        let common = self
            .plan
            .groups
            .iter()
            .enumerate()
            .filter(|(_, group)| group.common_sd.is_some());
        let unit_of = |group: usize| {
            self.plan
                .observations
                .iter()
                .find(|o| o.group == group)
                .map(|o| o.unit.clone())
                .unwrap_or_default()
        };
        own.chain(common.map(|(k, _)| unit_of(k))).collect()
    }

    /// Options of the car of a source; of the plan's own car for none.
    fn options(&self, source: Option<&Source>) -> Options {
        let own = source.is_none_or(|source| source.vehicle.is_none());
        let plan_set = if own { self.plan.set.as_slice() } else { &[] };
        let source_set = source
            .map(|source| source.set.as_slice())
            .unwrap_or_default();
        let lubricant = source.and_then(|source| source.lubricant.clone());
        Options {
            lubricant: lubricant.or_else(|| self.plan.lubricant.clone().filter(|_| own)),
            engine_oil: self.plan.engine_oil.clone().filter(|_| own),
            set: plan_set
                .iter()
                .chain(source_set)
                .filter(|set| !set.starts_with(PREFIX))
                .cloned()
                .collect(),
            formulation: source.map(|source| source.formulation).unwrap_or_default(),
        }
    }

    /// The car of a source by name.
    fn name_of(&self, source: Option<&Source>) -> String {
        let vehicle = source
            .and_then(|source| source.vehicle.as_deref())
            .unwrap_or(&self.plan.vehicle);
        let own = source.is_none_or(|source| source.vehicle.is_none());
        format!("{own} {vehicle} {:?}", self.options(source))
    }

    fn car(&mut self, source: Option<&Source>) -> Result<(), Problems> {
        let name = self.name_of(source);
        if self.by_options.contains_key(&name) || self.fixed.contains_key(&name) {
            return Ok(());
        }
        let options = self.options(source);
        if let Some(vehicle) = source.and_then(|source| source.vehicle.as_deref()) {
            self.fixed.insert(name, load(vehicle, "vehicle", &options)?);
            return Ok(());
        }
        let (blueprint, setup) =
            VehicleTemplate::load(&self.plan.vehicle, "calibration.vehicle", &options)?;
        let mut problems = Problems::new();
        let mut slots = Vec::new();
        for free in &self.plan.parameters {
            match blueprint.slot(&free.key) {
                Ok(slot) => slots.push(slot),
                Err(found) => {
                    let allowed = "the key of a single number of the vehicle or of its fluids";
                    let hint = match found.kind {
                        ProblemKind::WrongTransmission | ProblemKind::NotSingle => format!(
                            "`cvtcycle show {}` prints its keys; words and lists are held, in `set`",
                            self.plan.vehicle
                        ),
                        _ => found.hint.clone(),
                    };
                    let found = found.hint(hint);
                    let told = found
                        .at(free.place.clone())
                        .key("key")
                        .value(free.key.clone());
                    problems.push(if told.allowed.is_empty() {
                        told.allowed(allowed)
                    } else {
                        told
                    });
                }
            }
        }
        // With what could be found more can be checked; nothing is computed with a plan of which this is not all.
        self.by_options.insert(name, self.kinds.len());
        self.kinds.push(Kind {
            blueprint,
            slots,
            keys: setup.keys,
        });
        if problems.is_empty() {
            Ok(())
        } else {
            Err(problems)
        }
    }

    /// Loads what a source needs; gives its problems, but those of the plan's own car, `known` already, only once.
    fn of_source(&mut self, source: &Source, known: &[Problem]) -> Problems {
        let at = |found: Problem| {
            let place = if found.place.line > 0 {
                found.place.clone()
            } else {
                source.place.clone()
            };
            let key = match found.key.as_str() {
                "--lubricant" => "lubricant".to_owned(),
                _ => found.key.clone(),
            };
            assigned(found.key(key), place).with_context(&format!("source `{}`: ", source.name))
        };
        let is_new = |found: &Problem| {
            !known
                .iter()
                .any(|old| old.message == found.message && old.value == found.value)
        };
        let mut problems = Problems::new();
        if source.vehicle.is_none() {
            problems.extend(self.held(&source.set, &source.place).into_iter().map(at));
            if source.lubricant.is_some()
                && let Some(free) = self
                    .plan
                    .parameters
                    .iter()
                    .find(|free| free.key.starts_with("lubricant."))
            {
                let message = format!(
                    "source `{}` has a fluid of its own, in which `{}` would be another value",
                    source.name, free.key
                );
                problems.push(problem(
                    &source.place,
                    "lubricant",
                    "",
                    message,
                    "fit the two fluids in plans of their own",
                ));
            }
        }
        // Without the plan's own car there is none with a source's changes either.
        if (source.vehicle.is_some() || !self.kinds.is_empty())
            && let Err(found) = self.car(Some(source))
        {
            problems.extend(found.into_iter().filter(is_new).map(at));
        }
        let sets: Vec<String> = self.plan.set.iter().chain(&source.set).cloned().collect();
        match cvtcycle_config::rig::load(&sets) {
            Ok(found) => {
                self.conditions.insert(sets.join("\n"), found);
            }
            Err(found) => problems.extend(found.into_iter().filter(is_new).map(at)),
        }
        problems
    }

    /// Assignments that hold what is to be fitted.
    fn held(&self, sets: &[String], place: &Place) -> Problems {
        let holds = |free: &&Free| {
            sets.iter().any(|set| {
                set.split_once('=')
                    .is_some_and(|(key, _)| key.trim() == free.key)
            })
        };
        let hint = "what is set is held: remove it from `set`, or remove its [[parameter]]";
        let told = |free: &Free| {
            problem(
                &at_item(place.clone(), &free.key),
                "set",
                "",
                format!("`{}` is set and free", free.key),
                hint,
            )
        };
        self.plan
            .parameters
            .iter()
            .filter(holds)
            .map(told)
            .collect()
    }

    /// Checks the plan's parameters against the car and makes those of the fit.
    fn free(&mut self) -> Problems {
        let mut problems = self.held(&self.plan.set, &self.plan.places[3]);
        let Some(kind) = self.kinds.first() else {
            return problems;
        };
        let mut bench = kind.blueprint.bench();
        for free in &self.plan.parameters {
            // One that is not found was told already.
            let Some(slot) = kind.slots.iter().find(|slot| slot.key() == free.key.trim()) else {
                continue;
            };
            for (word, value, place) in [
                ("low", free.low, &free.bounds[0]),
                ("high", free.high, &free.bounds[1]),
            ] {
                bench.reset();
                bench.set(slot, value);
                if bench.build().is_err() {
                    let first = bench.problems().into_iter().next().unwrap_or_default();
                    let message = format!(
                        "parameter {}: the car is refused at `{word}`: {}",
                        free.key, first.message
                    );
                    let allowed = if first.allowed.is_empty() {
                        slot.allowed().to_owned()
                    } else {
                        first.allowed
                    };
                    // It may call for another key that goes with it.
                    let own = first.key.is_empty()
                        || slot.key().ends_with(&first.key)
                        || first.hint.is_empty();
                    let hint = if own {
                        "bounds are in the unit of the key; the search may go to both"
                    } else {
                        &first.hint
                    };
                    problems.push(
                        problem(place, word, &allowed, message, hint).value(value.to_string()),
                    );
                }
            }
            let start = free.start.unwrap_or(slot.base());
            if start.is_nan() {
                let message = format!(
                    "parameter {}: the file has no value to start from",
                    free.key
                );
                problems.push(problem(
                    &free.place,
                    "start",
                    "a number",
                    message,
                    "add `start`, in the unit of the key",
                ));
            } else if !(free.low..=free.high).contains(&start) {
                let message = format!(
                    "parameter {}: the file's value {start} is outside the bounds",
                    free.key
                );
                problems.push(problem(
                    &free.place,
                    "start",
                    &format!("{} to {}", free.low, free.high),
                    message,
                    "widen the bounds, or add `start`",
                ));
            }
            self.parameters.push(Parameter {
                name: free.key.clone(),
                start,
                low: free.low,
                high: free.high,
                prior: free.prior,
            });
        }
        problems
    }

    /// Computes all observations.
    ///
    /// # Errors
    /// Why one of them has no number at these values.
    pub fn answer(&self, values: &[f64]) -> Result<Answer, String> {
        let taken = self
            .pool
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .pop();
        let benches = taken.unwrap_or_else(|| {
            self.kinds
                .iter()
                .map(|kind| kind.blueprint.bench())
                .collect()
        });
        let candidate = Candidate {
            model: self,
            values,
            benches: RefCell::new(benches),
            built: RefCell::default(),
        };
        let answer = candidate.answer();
        self.pool
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push(candidate.benches.into_inner());
        answer
    }

    /// Distance of each computed observation from what was measured, in its own unit, common errors included (CM-1).
    #[must_use]
    pub fn distances(&self, computed: &[f64], values: &[f64]) -> Vec<f64> {
        let one = |(observation, computed): (&Observation, &f64)| {
            let common = self.common[observation.group].map_or(0.0, |k| values[k]);
            observation.measured.distance(computed + common) // CM-1
        };
        self.plan
            .observations
            .iter()
            .zip(computed)
            .map(one)
            .collect()
    }
}

impl Residuals for Model<'_> {
    fn count(&self) -> usize {
        self.plan.observations.len()
    }

    fn at(&self, values: &[f64]) -> Result<Vec<f64>, String> {
        let answer = self.answer(values)?;
        let distances = self.distances(&answer.computed, values);
        Ok(self
            .plan
            .observations
            .iter()
            .zip(distances)
            .map(|(observation, distance)| distance / observation.weight_sd)
            .collect())
    }
}

/// A problem of the plan's own car at its place in the plan, where it stands in no file.
fn in_plan(plan: &Plan, found: Problem) -> Problem {
    let [vehicle, lubricant, engine_oil, set] = &plan.places;
    let (place, key) = match found.place.file.as_str() {
        "calibration.vehicle" => (vehicle, "vehicle"),
        "--lubricant" => (lubricant, "lubricant"),
        "--engine-oil" => (engine_oil, "engine_oil"),
        file if file.starts_with("--set") => (set, "set"),
        _ => return found,
    };
    assigned(found.key(key), place.clone())
}

/// A problem moved to a place in the plan: there to the assignment of a list that is meant, where it stands in that line.
fn assigned(found: Problem, place: Place) -> Problem {
    let assignment = found.place.file.strip_prefix("--set ").unwrap_or_default();
    let place = at_item(place, assignment);
    found.at(place)
}

/// All sources that observations look at.
fn used(plan: &Plan) -> Vec<&Source> {
    let mut found: Vec<&Source> = plan
        .benches
        .iter()
        .map(|bench| &bench.source)
        .chain(&plan.runs)
        .collect();
    for observation in &plan.observations {
        if let What::Expression { view, expr } = &observation.what_computed {
            let mut indices = Vec::new();
            expr.sources(&mut indices);
            found.extend(
                indices
                    .into_iter()
                    .flatten()
                    .filter_map(|k| plan.views[*view].get(k)),
            );
        }
    }
    let mut seen: Vec<(&str, &cvtcycle_config::Place)> = Vec::new();
    found.retain(|source| {
        let new = !seen.contains(&(&source.name, &source.place));
        seen.push((&source.name, &source.place));
        new
    });
    found
}
