//! One evaluation: the cars with one set of values, and all observations computed with them.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use super::cars::{Car, Cars, RigConditions};
use crate::plan::{CalibrationPlan, Observable, Observation};
use cvtcycle_config::setup::Setup;
use cvtcycle_config::{Problem, Problems};
use cvtcycle_validate::expr::{Computed, Table, compute};
use cvtcycle_validate::source::{Kind, Source};
use cvtcycle_validate::store::{self, Store, View, once};
use cvtcycle_validate::tables;

/// The observations computed with one set of values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prediction {
    /// Computed observations, without common errors.
    pub computed: Vec<f64>,
    /// Points behind each that lie outside the validity of a model, or are left out at gross slip of the belt.
    pub doubtful: Vec<usize>,
}

/// Computes all observations.
pub fn predict(cars: &Cars, plan: &CalibrationPlan, values: &[f64]) -> Result<Prediction, String> {
    let cars = WithValues {
        cars,
        values,
        built: RefCell::default(),
    };
    observe(&cars, plan)
}

fn observe(cars: &WithValues, plan: &CalibrationPlan) -> Result<Prediction, String> {
    let store = Store::new(cars);
    let views = plan.views.iter();
    let evaluation = Evaluation {
        plan,
        cars,
        store: &store,
        views: views.map(|sources| View::new(&store, sources)).collect(),
        benches: RefCell::default(),
        times: [Kind::Run, Kind::Transient].map(|kind| {
            let columns = tables::columns(kind, false);
            columns
                .iter()
                .position(|name| *name == "time_s")
                .unwrap_or(0)
        }),
    };
    let mut prediction = Prediction::default();
    for observation in &plan.observations {
        let (computed, doubtful) = evaluation.observation(observation)?;
        if !computed.is_finite() {
            let label = &observation.label;
            return Err(format!("{label}: the model has no number there"));
        }
        prediction.computed.push(computed);
        prediction.doubtful.push(doubtful);
    }
    Ok(prediction)
}

struct Evaluation<'a> {
    plan: &'a CalibrationPlan,
    cars: &'a WithValues<'a>,
    store: &'a Store<'a>,
    views: Vec<View<'a>>,
    /// Tables of points on the bench, by their index in the plan.
    benches: RefCell<HashMap<usize, Result<Rc<Table>, String>>>,
    /// Column of the time in runs and transients.
    times: [usize; 2],
}

impl Evaluation<'_> {
    /// The number of an observation, and the doubtful points behind it.
    fn observation(&self, observation: &Observation) -> Result<(f64, usize), String> {
        let plan = self.plan;
        Ok(match &observation.observable {
            Observable::Expression { view, expr } => {
                let view = &self.views[*view];
                view.begin();
                let computed = compute(expr, view);
                match computed.map_err(|why| format!("{}: {why}", observation.label))? {
                    Computed::Number(x) => (x, view.noted().0 + view.noted().1),
                    _ => (f64::NAN, 0),
                }
            }
            Observable::Point { bench, row, column } => {
                let table = once(&self.benches, *bench, || self.bench(*bench).map(Rc::new))?;
                (table.column(*column)[*row], doubtful(&table, *row))
            }
            Observable::Trace {
                run,
                column,
                time_s,
            } => {
                let source = &plan.runs[*run];
                let table = self.store.table(source, false)?;
                let time = self.times[usize::from(source.kind != Kind::Run)];
                between(&table, [time, *column], *time_s)
            }
            Observable::Total { run, column } => {
                let table = self.store.table(&plan.runs[*run], true)?;
                (table.column(*column)[0], 0)
            }
        })
    }

    fn bench(&self, index: usize) -> Result<Table, String> {
        let bench = &self.plan.benches[index];
        let setup = store::Cars::setup(self.cars, Some(&bench.source));
        tables::bench::of_points(&bench.points, &*setup.map_err(|problems| first(&problems))?)
    }
}

/// 1 for each mark of a row.
fn doubtful(table: &Table, row: usize) -> usize {
    let flag = |list: &[bool]| usize::from(list.get(row).copied().unwrap_or(false));
    flag(&table.gross) + flag(&table.outside)
}

fn first(problems: &[Problem]) -> String {
    let first = problems.first().map(|problem| problem.message.clone());
    first.unwrap_or_else(|| "the car is refused".to_owned())
}

/// Rounding of a time, s.
const SLACK_S: f64 = 1e-6;

/// A column at a time, linear between the rows; its first or last value outside of them, the last one as doubtful.
fn between(table: &Table, [time, column]: [usize; 2], time_s: f64) -> (f64, usize) {
    let (times, values) = (table.column(time), table.column(column));
    let Some(last) = times.len().checked_sub(1) else {
        return (f64::NAN, 0);
    };
    let after = times.partition_point(|t| *t < time_s).min(last);
    // After the end of a test there is no number.
    let beyond = usize::from(time_s > times[last] + SLACK_S);
    let before = after.saturating_sub(1);
    let width = times[after] - times[before];
    let share = if width > 0.0 {
        ((time_s - times[before]) / width).clamp(0.0, 1.0)
    } else {
        1.0
    };
    let value = values[before] + share * (values[after] - values[before]);
    (value, doubtful(table, after) + beyond)
}

/// The cars with one set of values.
struct WithValues<'m> {
    cars: &'m Cars<'m>,
    values: &'m [f64],
    built: RefCell<HashMap<usize, Result<Rc<Setup>, String>>>,
}

impl WithValues<'_> {
    fn build(&self, index: usize) -> Result<Rc<Setup>, String> {
        let car = &self.cars.fitted[index];
        let numbers = car.params.iter().map(|(k, param)| (param, self.values[*k]));
        let set = car.base.with_numbers(&numbers.collect::<Vec<_>>());
        let set = set.map_err(|problems| first(&problems))?;
        let setup = Setup {
            keys: set.keys(),
            ..Setup::from_params(&set)
        };
        Ok(Rc::new(setup))
    }
}

impl store::Cars for WithValues<'_> {
    fn setup(&self, source: Option<&Source>) -> Result<Rc<Setup>, Problems> {
        match self.cars.car(source) {
            Car::Fixed(setup) => Ok(Rc::new(setup.clone())),
            Car::Fitted(index) => {
                let built = once(&self.built, index, || self.build(index));
                built.map_err(|message| Problem::failed(message).into())
            }
        }
    }

    fn conditions(&self, source: Option<&Source>) -> Result<RigConditions, Problems> {
        self.cars.conditions(source)
    }
}
