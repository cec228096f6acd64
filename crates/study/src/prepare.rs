//! A plan to a study that is ready to run: cars, cycles, columns, and every value of every factor tried before anything starts.

use std::path::Path;
use std::sync::Arc;

use super::cars::{StudyCar, is_words};
use super::outputs::{EXCESS, FUEL, Run, outputs, phase_excess, phase_fuel};
use super::plan::{Keep, Plan};
use super::table::{Head, Kind};
use cvtcycle_config::cycle::{self, Cycle};
use cvtcycle_config::setup::is_path;
use cvtcycle_config::{Argument, Input, Problem, Problems, did_you_mean};
use cvtcycle_output::Component;
use cvtcycle_output::table::Column;
use cvtcycle_output::trace::{COLUMNS, TraceColumn, columns_for};

/// Name under which problems of a car's word are reported before they get their place in the plan.

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
    pub(super) factor_columns: Vec<FactorColumn>,
    pub(super) outputs: Vec<Column<Run>>,
    pub(super) traces: Vec<&'static TraceColumn>,
}

/// A column of the table of runs that holds a factor, or several with one key.
#[derive(Clone, Debug)]
pub(super) struct FactorColumn {
    /// Factors with this key.
    pub factors: Vec<usize>,
    pub kind: Kind,
}

/// Number of leading columns: point, vehicle, role, status, reason.
pub const HEAD_COLUMNS: usize = 5;

impl Study {
    /// Checks everything that a plan names: cars, cycles, keys, every value of every factor by itself, names of columns.
    ///
    /// # Errors
    /// All problems.
    pub fn prepare(plan: Plan) -> Result<Self, Problems> {
        let folder = Path::new(&plan.file)
            .parent()
            .filter(|_| is_path(&plan.file))
            .map(Path::to_path_buf)
            .unwrap_or_default();
        let mut problems = Problems::new();
        let cars = cars(&plan, &folder, &mut problems);
        let cycles = cycles(&plan, &folder, &mut problems);
        let Some(points) = plan.design.points(&plan.factors) else {
            problems.push(of_plan(
                &plan,
                "design",
                "the design has more points than can be counted",
                "give fewer values",
            ));
            return Err(problems);
        };
        for index in 0..plan.factors.len() {
            super::preflight::factor(&plan, index, &cars, &mut problems);
        }
        if !problems.is_empty() {
            return Err(dedup(problems));
        }
        let phases = phases(&cycles);
        let parts = parts(&cars, &plan);
        let outputs = outputs(&phases, &parts);
        let (factor_columns, mut heads) = factor_columns(&plan);
        let mut columns = head_columns();
        columns.append(&mut heads);
        columns.extend(outputs.iter().map(Column::head));
        let traces = traces(&plan, &cars, &parts);
        let trace_columns = if traces.is_empty() {
            Vec::new()
        } else {
            trace_columns(&traces)
        };
        let study = Study {
            plan,
            points,
            cars,
            cycles,
            phases,
            columns,
            trace_columns,
            factor_columns,
            outputs,
            traces,
        };
        let unknown = study.unknown_analysed();
        if unknown.is_empty() {
            Ok(study)
        } else {
            Err(unknown)
        }
    }

    /// Number of runs.
    #[must_use]
    pub fn runs(&self) -> u64 {
        self.points.saturating_mul(self.cars.len() as u64)
    }

    /// Names of the numbers of a row that can be analysed.
    pub fn output_names(&self) -> impl Iterator<Item = &str> {
        self.outputs.iter().map(|column| &*column.name)
    }

    /// Names of the numbers that are analysed: those of the plan, or else the fuels and the subject's excess, by phase as well.
    #[must_use]
    pub fn analysed(&self) -> Vec<String> {
        if !self.plan.analyse.is_empty() {
            return self.plan.analyse.clone();
        }
        let phases = || self.phases.iter();
        let fuels = std::iter::once(FUEL.to_owned()).chain(phases().map(|phase| phase_fuel(phase)));
        let excess =
            std::iter::once(EXCESS.to_owned()).chain(phases().map(|phase| phase_excess(phase)));
        if self.cars.len() > 1 {
            fuels.chain(excess).collect()
        } else {
            fuels.collect()
        }
    }

    /// Index of a column of the table of runs.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    fn unknown_analysed(&self) -> Problems {
        let known: Vec<&str> = self.output_names().collect();
        let unknown = self
            .plan
            .analyse
            .iter()
            .filter(|name| !known.contains(&name.as_str()));
        unknown
            .map(|name| {
                let hint = did_you_mean(name, known.iter().copied())
                    .map_or_else(String::new, |question| question + " ");
                let problem = of_plan(
                    &self.plan,
                    "analyse",
                    &format!("there is no number named `{name}` in a run's row"),
                    "",
                );
                problem
                    .value(name.clone())
                    .hint(format!("{hint}docs/plan_format.md names them"))
            })
            .collect()
    }
}

fn dedup(problems: Problems) -> Problems {
    let mut list = Problems::new();
    for problem in problems {
        if !list.contains(&problem) {
            list.push(problem);
        }
    }
    list
}

/// A problem of a key of the plan's head.
pub(super) fn of_plan(plan: &Plan, key: &str, message: &str, hint: &str) -> Problem {
    Problem::invalid(message)
        .at(plan.places.of(key).clone())
        .key(key)
        .hint(hint)
}

/// A file that the plan names, seen from the current directory.
pub(super) fn in_folder(folder: &Path, word: &str) -> String {
    if is_path(word) {
        folder.join(word).to_string_lossy().into_owned()
    } else {
        word.to_owned()
    }
}

/// A car's file as the study cites it.
fn cars(plan: &Plan, folder: &Path, problems: &mut Problems) -> Vec<StudyCar> {
    let mut cars: Vec<StudyCar> = Vec::new();
    let subject = in_folder(folder, &plan.base.vehicle);
    let own = add(&subject, "vehicle", true, plan, &mut cars, problems);
    let named = match &plan.base.baselines {
        Some(list) => list.iter().map(|name| in_folder(folder, name)).collect(),
        // Names in the vehicle's file are relative to that file.
        None => own
            .iter()
            .map(|name| in_folder(Path::new(&subject).parent().unwrap_or(Path::new("")), name))
            .collect::<Vec<_>>(),
    };
    for word in named {
        add(&word, "baselines", false, plan, &mut cars, problems);
    }
    cars
}

/// Adds a car, and gives the baselines that its file names.
fn add(
    word: &str,
    key: &str,
    subject: bool,
    plan: &Plan,
    cars: &mut Vec<StudyCar>,
    problems: &mut Problems,
) -> Vec<String> {
    let stem = Path::new(word)
        .file_stem()
        .map_or_else(|| word.to_owned(), |s| s.to_string_lossy().into_owned());
    let name = unique(&stem, cars);
    let made = StudyCar::new(&name, word, subject, plan).map_err(Problems::from);
    match made.and_then(|car| {
        car.check_base(&plan.factors)
            .map(|baselines| (car, baselines))
    }) {
        Ok((car, baselines)) => {
            cars.push(car);
            baselines
        }
        Err(list) => {
            problems.extend(list.into_iter().map(|problem| in_plan(plan, key, problem)));
            Vec::new()
        }
    }
}

/// A problem of what the plan names, with the plan's file where it has no better place.
fn in_plan(plan: &Plan, key: &str, problem: Problem) -> Problem {
    let key = match &problem.place.input {
        Input::File(_) => return problem,
        Input::Argument(Argument::Lubricant) => "lubricant",
        Input::Argument(Argument::EngineOil) => "engine_oil",
        Input::Argument(_) => key,
        Input::Override(text) => {
            let is_own = plan.base.set.iter().any(|by| by.to_string() == *text);
            let key = if is_own { "set" } else { "set_all" };
            let place = of_plan(plan, key, "", "").place.of_item(text);
            return problem.at(place);
        }
    };
    problem.at(of_plan(plan, key, "", "").place)
}

fn unique(name: &str, cars: &[StudyCar]) -> String {
    let taken = |name: &str| cars.iter().any(|car| car.name.eq_ignore_ascii_case(name));
    if !taken(name) {
        return name.to_owned();
    }
    (2..)
        .map(|n| format!("{name}_{n}"))
        .find(|name| !taken(name))
        .unwrap_or_default()
}

/// The plan's cycle, or those of its factor.
fn cycles(plan: &Plan, folder: &Path, problems: &mut Problems) -> Vec<Cycle> {
    let factor = plan.factors.iter().find(|factor| factor.key == "cycle");
    let words: Vec<Arc<str>> = factor.map_or_else(Vec::new, super::cars::words);
    let mut list = Vec::new();
    for (k, word) in std::iter::once(Arc::from(plan.base.cycle.as_str()))
        .chain(words)
        .enumerate()
    {
        match cycle::find(&in_folder(folder, &word)) {
            Ok(cycle) => list.push(cycle),
            Err(found) => {
                let place = factor
                    .filter(|_| k > 0)
                    .map(|factor| factor.places.nth("values", k - 1).clone());
                let place = place.unwrap_or_else(|| of_plan(plan, "cycle", "", "").place);
                // A problem within a file keeps its place there, with a line or without.
                problems.extend(found.into_iter().map(|problem| {
                    match problem.place.is_argument(Argument::Cycle) {
                        true if is_path(&word) => problem
                            .at(place.clone())
                            .hint("a path in a plan begins at the plan's folder"),
                        true => problem.at(place.clone()),
                        false => problem,
                    }
                }));
            }
        }
    }
    list
}

fn phases(cycles: &[Cycle]) -> Vec<String> {
    let mut list: Vec<String> = Vec::new();
    for cycle in cycles {
        let groups = cycle.phase_groups();
        if groups.len() < 2 {
            continue;
        }
        for (name, _) in groups {
            if !list.contains(&name) {
                list.push(name);
            }
        }
    }
    list
}

/// Components of all cars, of all their variants that can be made, in the order of the power flow.
fn parts(cars: &[StudyCar], plan: &Plan) -> Vec<Component> {
    let mut found = Vec::new();
    for car in cars {
        for setup in car.setups(&plan.factors) {
            found.extend(setup.transmission().components());
        }
    }
    Component::ALL
        .into_iter()
        .filter(|component| found.contains(component))
        .collect()
}

fn head_columns() -> Vec<Head> {
    let column = |name: &str, kind: Kind, doc: &str| Head {
        name: name.into(),
        unit: String::new(),
        doc: doc.into(),
        kind,
    };
    vec![
        column(
            "point",
            Kind::Count,
            "number of the point of the design, from 0; all cars of a point share its draw",
        ),
        column("vehicle", Kind::Text, "name of the car"),
        column("role", Kind::Text, "subject or baseline"),
        column(
            "status",
            Kind::Text,
            "ok, failed (it ran, but a check failed) or not_run (the values do not go together)",
        ),
        column("reason", Kind::Text, "what failed; empty for ok"),
    ]
}

fn factor_columns(plan: &Plan) -> (Vec<FactorColumn>, Vec<Head>) {
    let mut list: Vec<FactorColumn> = Vec::new();
    let mut heads: Vec<Head> = Vec::new();
    for (index, factor) in plan.factors.iter().enumerate() {
        let kind = if is_words(factor) {
            Kind::Text
        } else {
            Kind::Number
        };
        if let Some(k) = heads.iter().position(|head| head.name == factor.key) {
            list[k].factors.push(index);
            if kind == Kind::Text {
                (list[k].kind, heads[k].kind) = (kind, kind);
            }
            continue;
        }
        list.push(FactorColumn {
            factors: vec![index],
            kind,
        });
        let unit = if kind == Kind::Text {
            String::new()
        } else {
            key_unit(&factor.key)
        };
        let doc = format!(
            "{} in this run; empty for a car that it does not reach",
            factor.name
        );
        heads.push(Head {
            name: factor.key.clone(),
            unit,
            doc,
            kind,
        });
    }
    for (head, column) in heads.iter_mut().zip(&list) {
        head.kind = column.kind;
    }
    (list, heads)
}

/// Unit of the values of a key.
pub(super) fn key_unit(key: &str) -> String {
    cvtcycle_config::unit_of(key.rsplit('.').next().unwrap_or(key)).to_owned()
}

/// Trace columns that are kept.
fn traces(plan: &Plan, cars: &[StudyCar], parts: &[Component]) -> Vec<&'static TraceColumn> {
    let any = |cvt: bool| {
        cars.iter()
            .flat_map(|car| car.setups(&plan.factors))
            .any(|setup| setup.transmission().is_cvt() == cvt)
    };
    let of = |cvt: bool| {
        if any(cvt) {
            columns_for(cvt, parts)
        } else {
            Vec::new()
        }
    };
    let (cvt, manual) = (of(true), of(false));
    let has = |list: &[&TraceColumn], name: &str| list.iter().any(|column| column.name == name);
    let wanted = |name: &str| match &plan.keep {
        Keep::Summary => false,
        Keep::Columns(names) => names.iter().any(|wanted| wanted == name),
        Keep::Everything => has(&cvt, name) || has(&manual, name),
    };
    COLUMNS
        .iter()
        .filter(|column| wanted(&column.name))
        .collect()
}

fn trace_columns(traces: &[&'static TraceColumn]) -> Vec<Head> {
    let mut list = head_columns();
    list.truncate(2);
    list.extend(traces.iter().map(|column| column.head()));
    list
}
