//! The cars with one set of values, and what they compute.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use super::{Answer, Model};
use crate::check::expr::{Computed, Table, compute};
use crate::check::source::{Kind, Source};
use crate::check::store::{Cars, Store, View, once};
use crate::check::tables;
use crate::fit::plan::What;
use cvtcycle_config::setup::Setup;
use cvtcycle_config::setup::template::Variant;
use cvtcycle_config::{KeyInfo, Problem, Problems, to_si};
use cvtcycle_model::bench::transmission::Conditions;

/// The cars with one set of values.
pub(super) struct Candidate<'m> {
    pub model: &'m Model<'m>,
    pub values: &'m [f64],
    pub benches: RefCell<Vec<Variant>>,
    pub built: RefCell<HashMap<usize, Result<Rc<Setup>, String>>>,
}

impl Candidate<'_> {
    /// Computes all observations.
    pub fn answer(&self) -> Result<Answer, String> {
        let plan = self.model.plan;
        let store = Store::new(self);
        let views: Vec<View> = plan
            .views
            .iter()
            .map(|sources| View::new(&store, sources))
            .collect();
        let benches: RefCell<HashMap<usize, Rc<Table>>> = RefCell::default();
        let times = tables::columns(Kind::Run, false);
        let transient_times = tables::columns(Kind::Transient, false);
        let time = times.iter().position(|name| *name == "time_s").unwrap_or(0);
        let transient_time = transient_times
            .iter()
            .position(|name| *name == "time_s")
            .unwrap_or(0);
        let mut answer = Answer {
            computed: Vec::new(),
            doubtful: Vec::new(),
        };
        for observation in &plan.observations {
            let (computed, doubtful) = match &observation.what_computed {
                What::Expression { view, expr } => {
                    let view = &views[*view];
                    view.begin();
                    match compute(expr, view)
                        .map_err(|why| format!("{}: {why}", observation.label))?
                    {
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
                    let flag =
                        |list: &[bool]| usize::from(list.get(*row).copied().unwrap_or(false));
                    (
                        table.columns[*column][*row],
                        flag(&table.gross) + flag(&table.outside),
                    )
                }
                What::Trace {
                    run,
                    column,
                    time_s,
                } => {
                    let source = &plan.runs[*run];
                    let table = store.table(source, false)?;
                    let time = if source.kind == Kind::Run {
                        time
                    } else {
                        transient_time
                    };
                    between(&table, [time, *column], *time_s)
                }
                What::Total { run, column } => {
                    (store.table(&plan.runs[*run], true)?.columns[*column][0], 0)
                }
            };
            if !computed.is_finite() {
                return Err(format!(
                    "{}: the model has no number there",
                    observation.label
                ));
            }
            answer.computed.push(computed);
            answer.doubtful.push(doubtful);
        }
        Ok(answer)
    }

    fn bench(&self, index: usize) -> Result<Table, String> {
        let bench = &self.model.plan.benches[index];
        let setup = self
            .setup(Some(&bench.source))
            .map_err(|problems| first(&problems))?;
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
    problems.first().map_or_else(
        || "the car is refused".to_owned(),
        |problem| problem.message.clone(),
    )
}

/// Rounding of a time, s.
const SLACK_S: f64 = 1e-6;

/// A column at a time, straight between the rows; its first or last value outside of them, the last one as doubtful.
fn between(table: &Table, [time, column]: [usize; 2], time_s: f64) -> (f64, usize) {
    let (times, values) = (&table.columns[time], &table.columns[column]);
    let Some(last) = times.len().checked_sub(1) else {
        return (f64::NAN, 0);
    };
    let after = times.partition_point(|t| *t < time_s).min(last);
    let flag = |list: &[bool]| usize::from(list.get(after).copied().unwrap_or(false));
    // A test that is over says nothing of later times.
    let beyond = usize::from(time_s > times[last] + SLACK_S);
    let doubtful = flag(&table.gross) + flag(&table.outside) + beyond;
    let before = after.saturating_sub(1);
    let width = times[after] - times[before];
    let share = if width > 0.0 {
        ((time_s - times[before]) / width).clamp(0.0, 1.0)
    } else {
        1.0
    };
    (
        values[before] + share * (values[after] - values[before]),
        doubtful,
    )
}

impl Cars for Candidate<'_> {
    fn setup(&self, source: Option<&Source>) -> Result<Rc<Setup>, Problems> {
        let name = self.model.name_of(source);
        if let Some(setup) = self.model.fixed.get(&name) {
            return Ok(Rc::new(setup.clone()));
        }
        let kind = self.model.by_options.get(&name).copied().unwrap_or(0);
        let built = once(&self.built, kind, || self.build(kind));
        built.map_err(|message| Problem::invalid(message).into())
    }

    fn conditions(&self, source: Option<&Source>) -> Result<(Conditions, Vec<KeyInfo>), Problems> {
        let own = source
            .map(|source| source.set.as_slice())
            .unwrap_or_default();
        let sets: Vec<String> = self.model.plan.set.iter().chain(own).cloned().collect();
        match self.model.conditions.get(&sets.join("\n")) {
            Some(found) => Ok(found.clone()),
            None => cvtcycle_config::rig::load(&sets),
        }
    }
}
