//! Numbers for the parameters to computed observations: the cars are built anew, rigs and cycles run anew.
//!
//! | label | statement | status |
//! |---|---|---|
//! | CM-1 | residual = (computed + common error of its group - measured) / sd; 0 within a measured range | convention |
//! | CM-2 | sd of a trace's values: sd sqrt(n / (duration / t_i + 1)), n values, t_i time after which two are independent | derived: as many values count as are independent |

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::{Mutex, PoisonError};

use super::plan::{Free, Observation, Plan, What, problem};
use super::solve::{Parameter, Prior, Residuals};
use crate::config::{KeyInfo, Problem, to_si};
use crate::rig::transmission::Conditions;
use crate::rig::transmission::conditions::PREFIX;
use crate::setup::blueprint::{Bench, Blueprint, Slot};
use crate::setup::{Options, Setup, load};
use crate::validate::expr::{Computed, Table, compute};
use crate::validate::source::Source;
use crate::validate::store::{Cars, Store, View, once};
use crate::validate::tables;

/// Width of the range of a common error, in its standard deviations.
const COMMON_WIDTH: f64 = 8.0;

/// One car of the plan, as often as its numbers change.
struct Kind {
    blueprint: Blueprint,
    /// Where each parameter stands in it.
    slots: Vec<Slot>,
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
    pool: Mutex<Vec<Vec<Bench>>>,
}

impl<'p> Model<'p> {
    /// Loads the cars of a plan.
    ///
    /// # Errors
    /// What is wrong with its vehicle, keys, bounds and sources.
    pub fn new(plan: &'p Plan) -> Result<Self, Vec<Problem>> {
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
        model.car(None)?;
        let mut problems = model.free();
        for source in used(plan) {
            if let Err(mut found) = model.of_source(source) {
                found.retain(|problem| !problems.contains(problem));
                problems.append(&mut found);
            }
        }
        if !problems.is_empty() {
            return Err(problems);
        }
        for group in &plan.groups {
            model.common.push(group.common_sd.map(|_| model.parameters.len()));
            if let Some(sd) = group.common_sd {
                let (name, wide) = (format!("common error of {}", group.name), COMMON_WIDTH * sd);
                model.parameters.push(Parameter { name, start: 0.0, low: -wide, high: wide, prior: Some(Prior { mean: 0.0, sd }) });
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
        let own = self.kinds[0].slots.iter().map(Slot::base);
        own.chain(self.parameters[self.plan.parameters.len()..].iter().map(|parameter| parameter.start)).collect()
    }

    /// Units of the parameters.
    #[must_use]
    pub fn units(&self) -> Vec<String> {
        let own = self.kinds[0].slots.iter().map(|slot| slot.unit().to_owned());
        let common = self.plan.groups.iter().enumerate().filter(|(_, group)| group.common_sd.is_some());
        let unit_of = |group: usize| self.plan.observations.iter().find(|o| o.group == group).map(|o| o.unit.clone()).unwrap_or_default();
        own.chain(common.map(|(k, _)| unit_of(k))).collect()
    }

    /// Options of the car of a source; of the plan's own car for none.
    fn options(&self, source: Option<&Source>) -> Options {
        let own = source.is_none_or(|source| source.vehicle.is_none());
        let plan_set = if own { self.plan.set.as_slice() } else { &[] };
        let source_set = source.map(|source| source.set.as_slice()).unwrap_or_default();
        let lubricant = source.and_then(|source| source.lubricant.clone());
        Options {
            lubricant: lubricant.or_else(|| self.plan.lubricant.clone().filter(|_| own)),
            engine_oil: self.plan.engine_oil.clone().filter(|_| own),
            set: plan_set.iter().chain(source_set).filter(|set| !set.starts_with(PREFIX)).cloned().collect(),
            formulation: source.map(|source| source.formulation).unwrap_or_default(),
        }
    }

    /// The car of a source by name.
    fn name_of(&self, source: Option<&Source>) -> String {
        let vehicle = source.and_then(|source| source.vehicle.as_deref()).unwrap_or(&self.plan.vehicle);
        let own = source.is_none_or(|source| source.vehicle.is_none());
        format!("{own} {vehicle} {:?}", self.options(source))
    }

    fn car(&mut self, source: Option<&Source>) -> Result<(), Vec<Problem>> {
        let name = self.name_of(source);
        if self.by_options.contains_key(&name) || self.fixed.contains_key(&name) {
            return Ok(());
        }
        let options = self.options(source);
        if let Some(vehicle) = source.and_then(|source| source.vehicle.as_deref()) {
            self.fixed.insert(name, load(vehicle, "vehicle", &options)?);
            return Ok(());
        }
        let (blueprint, setup) = Blueprint::load(&self.plan.vehicle, "calibration.vehicle", &options)?;
        let mut problems = Vec::new();
        let mut slots = Vec::new();
        for free in &self.plan.parameters {
            match blueprint.slot(&free.key) {
                Ok(slot) => slots.push(slot),
                Err(found) => {
                    let allowed = "the key of a single number of the vehicle or of its fluids";
                    let told = Problem { place: free.place.clone(), key: "key".into(), value: free.key.clone(), ..found };
                    problems.push(if told.allowed.is_empty() { Problem { allowed: allowed.into(), ..told } } else { told });
                }
            }
        }
        if !problems.is_empty() {
            return Err(problems);
        }
        self.by_options.insert(name, self.kinds.len());
        self.kinds.push(Kind { blueprint, slots, keys: setup.keys });
        Ok(())
    }

    fn of_source(&mut self, source: &Source) -> Result<(), Vec<Problem>> {
        let at = |found: Problem| {
            let place = if found.place.line > 0 { found.place.clone() } else { source.place.clone() };
            Problem { place, message: format!("source `{}`: {}", source.name, found.message), ..found }
        };
        let mut problems: Vec<Problem> = Vec::new();
        if source.vehicle.is_none() {
            problems.extend(self.held(&source.set, &source.place).into_iter().map(at));
            if source.lubricant.is_some()
                && let Some(free) = self.plan.parameters.iter().find(|free| free.key.starts_with("lubricant."))
            {
                let message = format!("source `{}` has a fluid of its own, in which `{}` would be another value", source.name, free.key);
                problems.push(problem(&source.place, "lubricant", "", message, "fit the two fluids in plans of their own"));
            }
        }
        if let Err(found) = self.car(Some(source)) {
            problems.extend(found.into_iter().map(at));
        }
        let sets: Vec<String> = self.plan.set.iter().chain(&source.set).cloned().collect();
        match Conditions::load(&sets) {
            Ok(found) => {
                self.conditions.insert(sets.join("\n"), found);
            }
            Err(found) => problems.extend(found.into_iter().map(at)),
        }
        if problems.is_empty() { Ok(()) } else { Err(problems) }
    }

    /// Assignments that hold what is to be fitted.
    fn held(&self, sets: &[String], place: &crate::config::Place) -> Vec<Problem> {
        let holds = |free: &&Free| sets.iter().any(|set| set.split_once('=').is_some_and(|(key, _)| key.trim() == free.key));
        let told = |free: &Free| problem(place, "set", "", format!("`{}` is set and free", free.key), "remove one of them");
        self.plan.parameters.iter().filter(holds).map(told).collect()
    }

    /// Checks the plan's parameters against the car and makes those of the fit.
    fn free(&mut self) -> Vec<Problem> {
        let mut problems = self.held(&self.plan.set, &self.plan.place);
        let mut bench = self.kinds[0].blueprint.bench();
        for (free, slot) in self.plan.parameters.iter().zip(&self.kinds[0].slots) {
            for (word, value) in [("low", free.low), ("high", free.high)] {
                bench.reset();
                bench.set(slot, value);
                if bench.build().is_err() {
                    let first = bench.problems().into_iter().next().unwrap_or_default();
                    let message = format!("parameter {}: `{word}` = {value} is refused: {}", free.key, first.message);
                    let allowed = if first.allowed.is_empty() { slot.allowed().to_owned() } else { first.allowed };
                    problems.push(problem(
                        &free.place,
                        word,
                        &allowed,
                        message,
                        "bounds are in the unit of the key; keep them where the model holds",
                    ));
                }
            }
            let start = free.start.unwrap_or(slot.base());
            if start.is_nan() {
                let message = format!("parameter {}: the file has no value to start from", free.key);
                problems.push(problem(&free.place, "start", "a number", message, "add `start`"));
            } else if !(free.low..=free.high).contains(&start) {
                let message = format!("parameter {}: the file's value {start} is outside the bounds", free.key);
                problems.push(problem(
                    &free.place,
                    "start",
                    &format!("{} to {}", free.low, free.high),
                    message,
                    "widen the bounds, or add `start`",
                ));
            }
            self.parameters.push(Parameter { name: free.key.clone(), start, low: free.low, high: free.high, prior: free.prior });
        }
        problems
    }

    /// Computes all observations.
    ///
    /// # Errors
    /// Why one of them has no number at these values.
    pub fn answer(&self, values: &[f64]) -> Result<Answer, String> {
        let taken = self.pool.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let benches = taken.unwrap_or_else(|| self.kinds.iter().map(|kind| kind.blueprint.bench()).collect());
        let candidate = Candidate { model: self, values, benches: RefCell::new(benches), built: RefCell::default() };
        let answer = candidate.answer();
        self.pool.lock().unwrap_or_else(PoisonError::into_inner).push(candidate.benches.into_inner());
        answer
    }

    /// Distance of each computed observation from what was measured, in its own unit, common errors included (CM-1).
    #[must_use]
    pub fn distances(&self, computed: &[f64], values: &[f64]) -> Vec<f64> {
        let one = |(observation, computed): (&Observation, &f64)| {
            let common = self.common[observation.group].map_or(0.0, |k| values[k]);
            observation.measured.distance(computed + common) // CM-1
        };
        self.plan.observations.iter().zip(computed).map(one).collect()
    }
}

impl Residuals for Model<'_> {
    fn count(&self) -> usize {
        self.plan.observations.len()
    }

    fn at(&self, values: &[f64]) -> Result<Vec<f64>, String> {
        let answer = self.answer(values)?;
        let distances = self.distances(&answer.computed, values);
        Ok(self.plan.observations.iter().zip(distances).map(|(observation, distance)| distance / observation.weight_sd).collect())
    }
}

/// All sources that observations look at.
fn used(plan: &Plan) -> Vec<&Source> {
    let mut found: Vec<&Source> = plan.benches.iter().map(|bench| &bench.source).chain(&plan.runs).collect();
    for observation in &plan.observations {
        if let What::Expression { view, expr } = &observation.what_computed {
            let mut indices = Vec::new();
            expr.sources(&mut indices);
            found.extend(indices.into_iter().flatten().filter_map(|k| plan.views[*view].get(k)));
        }
    }
    let mut seen: Vec<(&str, &crate::config::Place)> = Vec::new();
    found.retain(|source| {
        let new = !seen.contains(&(&source.name, &source.place));
        seen.push((&source.name, &source.place));
        new
    });
    found
}

/// The cars with one set of values.
struct Candidate<'m> {
    model: &'m Model<'m>,
    values: &'m [f64],
    benches: RefCell<Vec<Bench>>,
    built: RefCell<HashMap<usize, Result<Rc<Setup>, String>>>,
}

impl Candidate<'_> {
    fn answer(&self) -> Result<Answer, String> {
        let plan = self.model.plan;
        let store = Store::new(self);
        let views: Vec<View> = plan.views.iter().map(|sources| View::new(&store, sources)).collect();
        let benches: RefCell<HashMap<usize, Rc<Table>>> = RefCell::default();
        let times = tables::columns(crate::validate::source::Kind::Run, false);
        let transient_times = tables::columns(crate::validate::source::Kind::Transient, false);
        let time = times.iter().position(|name| *name == "time_s").unwrap_or(0);
        let transient_time = transient_times.iter().position(|name| *name == "time_s").unwrap_or(0);
        let mut answer = Answer { computed: Vec::new(), doubtful: Vec::new() };
        for observation in &plan.observations {
            let (computed, doubtful) = match &observation.what_computed {
                What::Expression { view, expr } => {
                    let view = &views[*view];
                    view.begin();
                    match compute(expr, view).map_err(|why| format!("{}: {why}", observation.label))? {
                        Computed::Number(x) => (x, view.noted().0 + view.noted().1),
                        _ => (f64::NAN, 0),
                    }
                }
                What::Point { bench, row, column } => {
                    let table = match benches.borrow().get(bench) {
                        Some(table) => Rc::clone(table),
                        None => Rc::new(self.bench(*bench)?),
                    };
                    benches.borrow_mut().insert(*bench, Rc::clone(&table));
                    let flag = |list: &[bool]| usize::from(list.get(*row).copied().unwrap_or(false));
                    (table.columns[*column][*row], flag(&table.gross) + flag(&table.outside))
                }
                What::Trace { run, column, time_s } => {
                    let source = &plan.runs[*run];
                    let table = store.table(source, false)?;
                    let time = if source.kind == crate::validate::source::Kind::Run { time } else { transient_time };
                    between(&table, [time, *column], *time_s)
                }
                What::Total { run, column } => (store.table(&plan.runs[*run], true)?.columns[*column][0], 0),
            };
            if !computed.is_finite() {
                return Err(format!("{}: the model has no number there", observation.label));
            }
            answer.computed.push(computed);
            answer.doubtful.push(doubtful);
        }
        Ok(answer)
    }

    fn bench(&self, index: usize) -> Result<Table, String> {
        let bench = &self.model.plan.benches[index];
        let setup = self.setup(Some(&bench.source)).map_err(|problems| first(&problems))?;
        tables::bench::of_points(&bench.points, &setup)
    }

    fn build(&self, kind: usize) -> Result<Rc<Setup>, String> {
        let own = &self.model.kinds[kind];
        let mut benches = self.benches.borrow_mut();
        let bench = &mut benches[kind];
        bench.reset();
        for (slot, value) in own.slots.iter().zip(self.values) {
            bench.set(slot, *value);
        }
        let mut setup = match bench.build() {
            Ok(setup) => setup,
            Err(_) => return Err(first(&bench.problems())),
        };
        setup.keys.clone_from(&own.keys);
        for (slot, value) in own.slots.iter().zip(self.values) {
            if let Some(info) = setup.keys.iter_mut().find(|info| info.key == slot.key()) {
                (info.value, info.si) = (value.to_string(), Some(to_si(&info.key, *value)));
            }
        }
        Ok(Rc::new(setup))
    }
}

fn first(problems: &[Problem]) -> String {
    problems.first().map_or_else(|| "the car is refused".to_owned(), |problem| problem.message.clone())
}

/// A column at a time, straight between the rows; its first or last value outside of them.
fn between(table: &Table, [time, column]: [usize; 2], time_s: f64) -> (f64, usize) {
    let (times, values) = (&table.columns[time], &table.columns[column]);
    let Some(last) = times.len().checked_sub(1) else { return (f64::NAN, 0) };
    let after = times.partition_point(|t| *t < time_s).min(last);
    let flag = |list: &[bool]| usize::from(list.get(after).copied().unwrap_or(false));
    let doubtful = flag(&table.gross) + flag(&table.outside);
    let before = after.saturating_sub(1);
    let width = times[after] - times[before];
    let share = if width > 0.0 { ((time_s - times[before]) / width).clamp(0.0, 1.0) } else { 1.0 };
    (values[before] + share * (values[after] - values[before]), doubtful)
}

impl Cars for Candidate<'_> {
    fn setup(&self, source: Option<&Source>) -> Result<Rc<Setup>, Vec<Problem>> {
        let name = self.model.name_of(source);
        if let Some(setup) = self.model.fixed.get(&name) {
            return Ok(Rc::new(setup.clone()));
        }
        let kind = self.model.by_options.get(&name).copied().unwrap_or(0);
        let built = once(&self.built, kind, || self.build(kind));
        built.map_err(|message| vec![Problem { message, ..Problem::default() }])
    }

    fn conditions(&self, source: Option<&Source>) -> Result<(Conditions, Vec<KeyInfo>), Vec<Problem>> {
        let own = source.map(|source| source.set.as_slice()).unwrap_or_default();
        let sets: Vec<String> = self.model.plan.set.iter().chain(own).cloned().collect();
        match self.model.conditions.get(&sets.join("\n")) {
            Some(found) => Ok(found.clone()),
            None => Conditions::load(&sets),
        }
    }
}
