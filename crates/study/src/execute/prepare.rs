//! A plan to a study that is ready to run: cars, cycles, columns, and every value of every factor tried before anything starts.

use std::path::Path;
use std::sync::Arc;

use super::cars::{Column, StudyCar, words};
use super::notes::{not_drawn, notes};
use super::outputs::{EXCESS, FUEL, Run, outputs, phase_excess, phase_fuel};
use super::side_effects::SideEffects;
use crate::plan::{Keep, Plan};
use crate::store::{Head, Kind};
use cvtcycle_config::ProblemKind::{self, TooLarge, UnknownName};
use cvtcycle_config::cycle::{self, Cycle};
use cvtcycle_config::setup::{TWIN, baseline_of, is_path, name_of};
use cvtcycle_config::{Argument, Input, Place, Problem, Problems, did_you_mean, unit_of};
use cvtcycle_output::Component;
use cvtcycle_output::table::Column as OutputColumn;
use cvtcycle_output::trace::{COLUMNS, TraceColumn};
use serde_json::Value;

/// A study, ready to run.
pub struct Study {
    /// The plan.
    pub plan: Plan,
    /// Number of points.
    pub points: u64,
    /// Cars, the subject first.
    pub cars: Vec<StudyCar>,
    /// Cycles: the plan's, or those of its factor in the order of the list.
    pub cycles: Vec<Cycle>,
    /// Phase groups of all cycles that have several, in order.
    pub phases: Vec<String>,
    /// Columns of the table of runs: head, factors, numbers.
    pub columns: Vec<Head>,
    /// Columns of the table of traces; empty if none are kept.
    pub trace_columns: Vec<Head>,
    /// Limits of the results, a sentence each.
    pub notes: Vec<String>,
    /// Factors of each column that holds the values of a key.
    pub(super) factor_columns: Vec<Vec<usize>>,
    pub(super) outputs: Vec<OutputColumn<Run>>,
    pub(super) traces: Vec<&'static TraceColumn>,
    /// Engine speed, rpm, below which load is heard and felt, where side effects are kept.
    pub(super) sides: Option<f64>,
    /// Description of the columns for the manifest; `None` if the cars are those of the plan.
    pub levers: Option<Value>,
}

/// Cars in place of those of the plan.
pub struct Columns {
    /// In the order of the table.
    pub list: Vec<Column>,
    /// Engine speed below which load is heard and felt, rpm.
    pub heard_rpm: f64,
    /// Description of the columns for the manifest.
    pub about: Value,
}

impl Study {
    /// Checks everything that a plan names: cars, cycles, keys, every value of every factor by itself, names of columns.
    ///
    /// ```
    /// use cvtcycle_study::{Study, plan::Plan};
    /// let text = "study.design = \"grid\"\n[[factor]]\nkey = \"ambient_degc\"\nvalues = [-10, 25]\n";
    /// let study = Study::prepare(Plan::read("plan.toml", text)?)?;
    /// assert_eq!((study.points, &*study.cars[0].name), (2, "rover_216_cvt"));
    /// # Ok::<(), cvtcycle_config::Problems>(())
    /// ```
    ///
    /// # Errors
    /// All problems.
    pub fn prepare(plan: Plan) -> Result<Self, Problems> {
        Study::with(plan, None)
    }

    /// A study of a plan's factors with columns in place of its cars, which it keeps side effects of.
    ///
    /// # Errors
    /// All problems.
    pub fn of_columns(plan: Plan, columns: Columns) -> Result<Self, Problems> {
        Study::with(plan, Some(columns))
    }

    fn with(plan: Plan, columns: Option<Columns>) -> Result<Self, Problems> {
        let folder = folder_of(&plan).to_path_buf();
        let mut problems = Problems::new();
        let cars = match &columns {
            Some(columns) => of_columns(&plan, &columns.list, &mut problems),
            None => cars(&plan, &folder, &mut problems),
        };
        let cycles = cycles(&plan, &folder, &cars, &mut problems);
        let Some(points) = plan.design.points(&plan.factors) else {
            let message = "the design has more points than can be counted";
            problems.push(of_plan(
                TooLarge,
                &plan,
                "design",
                message,
                "give fewer values",
            ));
            return Err(problems);
        };
        for index in 0..plan.factors.len() {
            super::preflight::factor(&plan, index, &cars, &mut problems);
        }
        if !problems.is_empty() {
            let mut unlike = Problems::new();
            problems.into_iter().for_each(|problem| unlike.add(problem));
            return Err(unlike);
        }
        Study::of_cars(plan, points, columns, (cars, cycles))
    }

    /// A study of these cars and cycles.
    fn of_cars(
        plan: Plan,
        points: u64,
        columns: Option<Columns>,
        (cars, cycles): (Vec<StudyCar>, Vec<Cycle>),
    ) -> Result<Self, Problems> {
        let phases = phases(&cycles);
        let parts = parts(&cars, &plan);
        let outputs = outputs(&phases, &parts);
        unknown_analysed(&plan, &outputs).finish()?;
        let (factor_columns, heads) = factor_columns(&plan);
        let heads = head_columns().into_iter().chain(heads);
        let sides = columns.as_ref().map(|columns| columns.heard_rpm);
        let extra = sides.into_iter().flat_map(|_| SideEffects::heads());
        let traces = traces(&plan, &cars, &parts);
        let mut notes = notes(&plan, &cars);
        if columns.is_none() {
            notes.extend(not_drawn(&plan, &cars));
        }
        let trace_heads = head_columns().into_iter().take(2);
        let study = Study {
            points,
            notes,
            cars,
            cycles,
            phases,
            columns: heads
                .chain(outputs.iter().map(OutputColumn::head))
                .chain(extra)
                .collect(),
            trace_columns: match traces.as_slice() {
                [] => Vec::new(),
                traces => trace_heads
                    .chain(traces.iter().map(|column| column.head()))
                    .collect(),
            },
            factor_columns,
            outputs,
            traces,
            sides,
            levers: columns.map(|columns| columns.about),
            plan,
        };
        study.check_traces()?;
        Ok(study)
    }

    /// Numbers of a row of the table of runs.
    pub(super) fn numbers(&self) -> usize {
        self.outputs.len() + self.sides.map_or(0, |_| SideEffects::heads().count())
    }

    /// Number of runs.
    pub fn runs(&self) -> u64 {
        self.points.saturating_mul(self.cars.len() as u64)
    }

    /// Names of the numbers that are analysed: those of the plan, or else the fuels and the subject's excess, by phase as well.
    pub fn analysed(&self) -> Vec<String> {
        if !self.plan.analyse.is_empty() {
            return self.plan.analyse.clone();
        }
        let of_phases = |name: fn(&str) -> String| self.phases.iter().map(move |phase| name(phase));
        let mut names = vec![FUEL.to_owned()];
        names.extend(of_phases(phase_fuel));
        if self.cars.len() > 1 && self.sides.is_none() {
            names.push(EXCESS.to_owned());
            names.extend(of_phases(phase_excess));
        }
        names
    }
}

fn unknown_analysed(plan: &Plan, outputs: &[OutputColumn<Run>]) -> Problems {
    let known = || outputs.iter().map(|column| &*column.name);
    let is_unknown = |name: &&String| known().all(|other| other != name.as_str());
    let problem = |name: &String| {
        let hint = did_you_mean(name, known()).map_or_else(String::new, |hint| hint + " ");
        let message = format!("there is no number named `{name}` in a run's row");
        let hint = format!("{hint}docs/plan_format.md names them");
        of_plan(UnknownName, plan, "analyse", &message, &hint).value(name.as_str())
    };
    plan.analyse
        .iter()
        .filter(is_unknown)
        .map(problem)
        .collect()
}

/// A problem of a key of the plan's head.
fn of_plan(kind: ProblemKind, plan: &Plan, key: &str, message: &str, hint: &str) -> Problem {
    let place = plan.places.place(key).clone();
    Problem::new(kind, message).at(place).key(key).hint(hint)
}

/// The folder of a plan's file; the current one for a plan that is no file.
pub(super) fn folder_of(plan: &Plan) -> &Path {
    let path = is_path(&plan.file).then(|| Path::new(&plan.file));
    path.and_then(Path::parent).unwrap_or(Path::new(""))
}

/// A file that the plan names, seen from the current directory.
pub(super) fn in_folder(folder: &Path, word: &str) -> String {
    match is_path(word) {
        true => folder.join(word).to_string_lossy().into_owned(),
        false => word.to_owned(),
    }
}

/// The cars of a plan: the subject, then the baselines.
fn cars(plan: &Plan, folder: &Path, problems: &mut Problems) -> Vec<StudyCar> {
    let mut cars: Vec<StudyCar> = Vec::new();
    // Adds a car, and gives the baselines that its file names.
    let mut add = |word: &str, key: &str| {
        let name = unique(word, &cars);
        let car = StudyCar::new(&name, word, key == "vehicle", plan);
        let baselines = car.and_then(|car| {
            let baselines = car.baselines(&plan.factors)?;
            cars.push(car);
            Ok(baselines)
        });
        baselines.unwrap_or_else(|found| {
            problems.extend(found.map(|problem| in_plan(plan, key, problem)));
            Vec::new()
        })
    };
    let subject = in_folder(folder, &plan.base.vehicle);
    let own = add(&subject, "vehicle");
    // Names in the vehicle's file are relative to that file.
    let word = |name: &String| match &plan.base.baselines {
        Some(_) if name != TWIN => in_folder(folder, name),
        _ => baseline_of(&subject, name),
    };
    for name in plan.base.baselines.as_ref().unwrap_or(&own) {
        add(&word(name), "baselines");
    }
    cars
}

/// The columns as cars.
fn of_columns(plan: &Plan, columns: &[Column], problems: &mut Problems) -> Vec<StudyCar> {
    let car = |column: &Column| problems.take(StudyCar::of_column(column, plan));
    columns.iter().filter_map(car).collect()
}

/// A problem of what the plan names, with the place in the plan where it has no better one.
fn in_plan(plan: &Plan, key: &str, problem: Problem) -> Problem {
    let place = match &problem.place.input {
        Input::File(_) => return problem,
        Input::Argument(Argument::Lubricant) => plan.places.place("lubricant").clone(),
        Input::Argument(Argument::EngineOil) => plan.places.place("engine_oil").clone(),
        Input::Argument(_) => return problem.at(plan.places.place(key).clone()).key(key),
        Input::Override(text) => {
            let is_own = plan.base.set.iter().any(|by| by.to_string() == *text);
            let key = if is_own { "set" } else { "set_all" };
            plan.places.place(key).clone().of_item(text)
        }
    };
    problem.at(place)
}

/// A name of a car that no other one has, made of that of its file.
fn unique(word: &str, cars: &[StudyCar]) -> String {
    let name = name_of(word);
    let is_free = |name: &String| cars.iter().all(|car| !car.name.eq_ignore_ascii_case(name));
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    std::iter::once(name.clone())
        .chain(numbered)
        .find(is_free)
        .unwrap_or_default()
}

/// The plan's cycle, then those of its factor.
fn cycles(plan: &Plan, folder: &Path, cars: &[StudyCar], problems: &mut Problems) -> Vec<Cycle> {
    let mut subjects = cars
        .iter()
        .take(1)
        .flat_map(|car| car.setups(&plan.factors));
    let subject = subjects.next();
    let factor = plan.factors.iter().find(|factor| factor.key == "cycle");
    let own = (
        Arc::from(plan.base.cycle.as_str()),
        plan.places.place("cycle"),
    );
    let named = factor.into_iter().flat_map(|factor| {
        let words = words(factor).into_iter().enumerate();
        words.map(|(k, word)| (word, factor.places.nth("values", k)))
    });
    let find = |(word, place): (Arc<str>, &Place)| {
        let found = cycle::find(&in_folder(folder, &word));
        // The class of a WLTC is that of the subject.
        let found = found.map(|cycle| match subject {
            Some(car) => cycle::for_car(&word, cycle, car),
            None => cycle,
        });
        let of_plan = |problem: Problem| {
            // A problem within a file keeps its place there, with a line or without.
            if !problem.place.is_argument(Argument::Cycle) {
                return problem;
            }
            let problem = problem.at(place.clone()).key("cycle");
            match is_path(&word) {
                true => problem.hint("a path in a plan begins at the plan's folder"),
                false => problem,
            }
        };
        found
            .map_err(|found| problems.extend(found.map(of_plan)))
            .ok()
    };
    std::iter::once(own).chain(named).filter_map(find).collect()
}

fn phases(cycles: &[Cycle]) -> Vec<String> {
    let mut list: Vec<String> = Vec::new();
    let groups = cycles.iter().map(Cycle::phase_groups);
    for (name, _) in groups.filter(|groups| groups.len() > 1).flatten() {
        if !list.contains(&name) {
            list.push(name);
        }
    }
    list
}

/// Components of all cars, of all their variants that can be made, in the order of the power flow.
fn parts(cars: &[StudyCar], plan: &Plan) -> Vec<Component> {
    let setups = cars.iter().flat_map(|car| car.setups(&plan.factors));
    let found: Vec<Component> = setups
        .flat_map(|setup| setup.transmission().components())
        .collect();
    let all = Component::ALL.into_iter();
    all.filter(|component| found.contains(component)).collect()
}

fn head_columns() -> Vec<Head> {
    [
        (
            "point",
            Kind::Count,
            "number of the point of the design, from 0; all cars of a point share its draw",
        ),
        ("vehicle", Kind::Text, "name of the car"),
        ("role", Kind::Text, "subject or baseline"),
        (
            "status",
            Kind::Text,
            "ok, failed (it ran, but a check failed) or not_run (the values do not go together)",
        ),
        ("reason", Kind::Text, "what failed; empty for ok"),
    ]
    .map(|(name, kind, doc)| Head {
        name: name.into(),
        unit: String::new(),
        doc: doc.into(),
        kind,
    })
    .into()
}

/// The factors of each key, and the heads of their columns.
fn factor_columns(plan: &Plan) -> (Vec<Vec<usize>>, Vec<Head>) {
    let mut list: Vec<Vec<usize>> = Vec::new();
    let mut heads: Vec<Head> = Vec::new();
    for (index, factor) in plan.factors.iter().enumerate() {
        let kind = match factor.values.are_numbers() {
            true => Kind::Number,
            false => Kind::Text,
        };
        if let Some(k) = heads.iter().position(|head| head.name == factor.key) {
            list[k].push(index);
            if kind == Kind::Text {
                heads[k].kind = kind;
            }
            continue;
        }
        list.push(vec![index]);
        let unit = if kind == Kind::Text {
            ""
        } else {
            unit_of(&factor.key)
        };
        heads.push(Head {
            name: factor.key.clone(),
            unit: unit.to_owned(),
            doc: format!(
                "{} in this run; empty for a car that it does not reach",
                factor.name
            ),
            kind,
        });
    }
    (list, heads)
}

/// Trace columns that are kept.
fn traces(plan: &Plan, cars: &[StudyCar], parts: &[Component]) -> Vec<&'static TraceColumn> {
    let is_wanted: Box<dyn Fn(&&TraceColumn) -> bool> = match &plan.keep {
        Keep::Summary => Box::new(|_| false),
        Keep::Columns(names) => Box::new(|column| names.iter().any(|name| *name == column.name)),
        Keep::Everything => {
            let setups = cars.iter().flat_map(|car| car.setups(&plan.factors));
            let kinds: Vec<bool> = setups.map(|setup| setup.transmission().is_cvt()).collect();
            Box::new(move |column| kinds.iter().any(|cvt| column.scope.includes(*cvt, parts)))
        }
    };
    COLUMNS.iter().filter(is_wanted).collect()
}
