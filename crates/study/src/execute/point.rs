//! One point of a study: every car with the point's draw, and the rows that come of it.

use std::ops::Range;

use super::cars::{Binding, StudyCar, bound_of};
use super::prepare::Study;
use super::rows::{PointRun, Status, Traces};
use super::side_effects::SideEffects;
use crate::plan::{Acts, Factor, FactorValue, Plan};
use cvtcycle_config::Problem;
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::{Param, Setup, start_nodes};
use cvtcycle_model::drive::{Conditions, Outcome, Row, Run, Start, drive_each, drive_into};
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_output::summary::{Driven, Failure, RunSummary, Settings, compare, run_summary};

/// A car at a point, with the values of the factors there.
struct CarAtPoint<'a> {
    study: &'a Study,
    car: &'a StudyCar,
    values: &'a [Option<FactorValue>],
}

impl Study {
    /// Drives some points, each car's runs side by side where rows are not looked at; the rows of their runs go into `traces`, if they are kept.
    pub(super) fn points(
        &self,
        points: Range<u64>,
        mut traces: Option<&mut Traces>,
    ) -> Vec<Vec<PointRun>> {
        let Plan {
            factors, design, ..
        } = &self.plan;
        let of_point = |point: u64| -> Vec<Option<FactorValue>> {
            let value =
                |(f, factor): (usize, &Factor)| factor.value(design.level(factors, point, f));
            factors.iter().enumerate().map(value).collect()
        };
        let values: Vec<Vec<Option<FactorValue>>> = points.clone().map(of_point).collect();
        let mut subjects: Vec<Option<RunSummary>> = vec![None; values.len()];
        let mut runs: Vec<Vec<PointRun>> = (values.iter())
            .map(|_| Vec::with_capacity(self.cars.len()))
            .collect();
        // Traces need single drives: each point with all its cars, one by one.
        if traces.is_some() {
            for (k, point) in points.enumerate() {
                for (index, car) in self.cars.iter().enumerate() {
                    if let Some(traces) = &mut traces {
                        traces.begin(point, car);
                    }
                    let at = self.car_at(index, &values[k]);
                    let (run, summary) = at.run(subjects[k].as_ref(), traces.as_deref_mut());
                    if index == 0 && self.sides.is_none() {
                        subjects[k] = summary;
                    }
                    runs[k].push(run);
                }
            }
            return runs;
        }
        for index in 0..self.cars.len() {
            // Side effects come from rows, which cars side by side do not give.
            if self.cars[index].is_watched {
                for (values, runs) in values.iter().zip(&mut runs) {
                    runs.push(self.car_at(index, values).run(None, None).0);
                }
                continue;
            }
            let ready: Vec<Ready> = (values.iter())
                .map(|values| self.car_at(index, values).ready())
                .collect();
            let outcomes = self.drive_ready(&ready);
            for (k, (ready, outcome)) in ready.into_iter().zip(outcomes).enumerate() {
                let at = self.car_at(index, &values[k]);
                let (run, summary) = match outcome {
                    Some(outcome) => at.finished(ready, (&outcome, None), subjects[k].as_ref()),
                    None => (at.refused(ready), None),
                };
                if index == 0 && self.sides.is_none() {
                    subjects[k] = summary;
                }
                runs[k].push(run);
            }
        }
        runs
    }

    /// Drives a point.
    fn point(&self, point: u64) -> Vec<PointRun> {
        let runs = self.points(point..point + 1, None);
        runs.into_iter().flatten().collect()
    }

    fn car_at<'a>(&'a self, index: usize, values: &'a [Option<FactorValue>]) -> CarAtPoint<'a> {
        CarAtPoint {
            study: self,
            car: &self.cars[index],
            values,
        }
    }

    /// Drives what is ready, the runs of a cycle side by side; none for a car that is refused.
    fn drive_ready(&self, ready: &[Ready]) -> Vec<Option<Outcome>> {
        let mut outcomes: Vec<Option<Outcome>> = ready.iter().map(|_| None).collect();
        for (number, cycle) in self.cycles.iter().enumerate() {
            let mut places = Vec::new();
            let mut runs = Vec::new();
            for (place, ready) in ready.iter().enumerate() {
                if let (Ok(setup), true) = (&ready.built, ready.cycle == number) {
                    places.push(place);
                    runs.push(Run {
                        vehicle: setup,
                        conditions: ready.conditions,
                    });
                }
            }
            for (place, outcome) in places.into_iter().zip(drive_each(&runs, cycle)) {
                outcomes[place] = Some(outcome);
            }
        }
        outcomes
    }
}

/// A car at a point, built, with how it is driven.
struct Ready {
    factors: Vec<Option<FactorValue>>,
    /// The car, or why there is none.
    built: Result<Setup, String>,
    /// Index of the cycle.
    cycle: usize,
    conditions: Conditions,
}

impl Study {
    /// A number of each car at the first point, with whether its run is fine; NaN where there is none.
    pub fn first_point(&self, output: &str) -> Vec<(f64, bool)> {
        let at = self.outputs.iter().position(|column| column.name == output);
        let runs = self.point(0);
        let number = |run: PointRun| {
            let number = at.and_then(|at| run.numbers.get(at).copied());
            (number.unwrap_or(f64::NAN), run.status == Status::Ok)
        };
        runs.into_iter().map(number).collect()
    }

    /// Factors of a car with draws outside the range of their keys, and their numbers of such draws.
    pub fn held(&self, car: &StudyCar) -> Vec<(usize, usize)> {
        let Plan {
            factors, design, ..
        } = &self.plan;
        let Ok(variant) = car.variant(0, factors) else {
            return Vec::new();
        };
        let count = |(f, factor): (usize, &Factor)| {
            let (Binding::Number(acts), Some(param), Some(bound)) =
                (car.bindings[f], &variant.params[f], bound_of(factor))
            else {
                return None;
            };
            let draws = (0..self.points).filter_map(|point| {
                let value = factor.value(design.level(factors, point, f))?;
                value.number()
            });
            let outside = |x: &f64| !bound.contains(car.drawn(f, acts, param.base(), *x));
            let held = draws.filter(outside).count();
            (held > 0).then_some((f, held))
        };
        factors.iter().enumerate().filter_map(count).collect()
    }
}

impl CarAtPoint<'_> {
    fn run(
        &self,
        subject: Option<&RunSummary>,
        traces: Option<&mut Traces>,
    ) -> (PointRun, Option<RunSummary>) {
        let ready = self.ready();
        let cycle = &self.study.cycles[ready.cycle];
        let Ok(setup) = &ready.built else {
            return (self.refused(ready), None);
        };
        let sides = self.study.sides.filter(|_| self.car.is_watched);
        let mut sides = sides.map(SideEffects::new);
        let outcome = {
            let mut push = watched(cycle, traces, sides.as_mut());
            drive_into(setup, cycle, &ready.conditions, Some(&mut push))
        };
        self.finished(ready, (&outcome, sides.as_ref()), subject)
    }

    /// The car at the point, with what is asked of it.
    fn ready(&self) -> Ready {
        let (factors, built) = self.build();
        Ready {
            factors,
            built,
            cycle: self.cycle(),
            conditions: self.conditions(),
        }
    }

    /// The run of a car that cannot be driven.
    fn refused(&self, ready: Ready) -> PointRun {
        PointRun {
            status: Status::NotRun(ready.built.err().unwrap_or_default()),
            factors: ready.factors,
            numbers: vec![f64::NAN; self.study.numbers()],
        }
    }

    /// The run of a car that has been driven.
    fn finished(
        &self,
        ready: Ready,
        (outcome, sides): (&Outcome, Option<&SideEffects>),
        subject: Option<&RunSummary>,
    ) -> (PointRun, Option<RunSummary>) {
        let Ok(setup) = &ready.built else {
            return (self.refused(ready), None);
        };
        let cycle = &self.study.cycles[ready.cycle];
        let formulation = self.option("formulation").map(FactorValue::to_string);
        let settings = Settings {
            formulation: formulation
                .unwrap_or_else(|| self.study.plan.base.formulation.name().to_owned()),
            ..Settings::default()
        };
        let named = Driven {
            name: &self.car.name,
            setup,
            outcome,
        };
        let summary = run_summary(cycle, &self.car.role, &settings, &named);
        let excess = subject.map(|subject| compare(subject, &summary));
        let status = status(&summary);
        let row = (summary, excess);
        let numbers = (self.study.outputs.iter()).map(|column| column.number_of(&row));
        let mut numbers: Vec<f64> = match sides {
            Some(sides) => numbers.chain(sides.numbers()).collect(),
            None => numbers.collect(),
        };
        numbers.resize(self.study.numbers(), f64::NAN);
        let run = PointRun {
            status,
            factors: ready.factors,
            numbers,
        };
        (run, Some(row.0))
    }

    /// Resolves the factors in the car; builds the car with these values, or gives the reason why it is refused.
    fn build(&self) -> (Vec<Option<FactorValue>>, Result<Setup, String>) {
        let all = &self.study.plan.factors;
        let weight =
            |(f, value): (usize, &Option<FactorValue>)| self.car.weight(f, &all[f], value.as_ref());
        let index = self.values.iter().enumerate().map(weight).sum();
        let variant = self.car.variant(index, all);
        let resolve = |f: usize| {
            let param = variant
                .as_ref()
                .ok()
                .and_then(|variant| variant.params[f].as_ref());
            self.resolve(f, param.map(Param::base))
        };
        let factors: Vec<_> = (0..all.len()).map(resolve).collect();
        let variant = match variant {
            Ok(variant) => variant,
            Err(problems) => return (factors, Err(reason(problems))),
        };
        if let Some((_, problem)) = variant.unknown.first() {
            let reason = reason(std::slice::from_ref(problem));
            return (factors, Err(reason));
        }
        let params = variant.params.iter().zip(&factors).zip(self.values);
        let numbers = params.filter_map(|((param, value), given)| match (param, value, given) {
            // Values that the design leaves alone are not set again: the file may not give them.
            (Some(param), Some(FactorValue::Number(x)), Some(_)) => Some((param, *x)),
            _ => None,
        });
        let set = variant.base.with_numbers(&numbers.collect::<Vec<_>>());
        let built = set.map(|set| Setup::from_params(&set));
        let built = built.map_err(|problems| reason(&problems));
        (factors, built)
    }

    /// Resolves a factor to its value in the car, or the car's own where the design leaves it; `None` if the factor does not reach the car.
    fn resolve(&self, f: usize, base: Option<f64>) -> Option<FactorValue> {
        let value = self.values[f].as_ref();
        let own = &self.study.plan.base;
        let number = |acts: Acts, base: f64| match value {
            Some(FactorValue::Number(x)) => {
                FactorValue::Number(self.car.resolved(f, acts, base, *x))
            }
            Some(word) => word.clone(),
            None => FactorValue::Number(base),
        };
        match self.car.bindings[f] {
            Binding::Not => None,
            Binding::Number(acts) => base.map(|base| number(acts, base)),
            Binding::Ambient => {
                let ambient_degc = self.car.ambient_degc.unwrap_or(own.ambient_degc);
                Some(number(Acts::Value, ambient_degc))
            }
            Binding::Step => Some(number(Acts::Value, own.dt_s)),
            Binding::Start | Binding::Cycle | Binding::Words { .. } => {
                value.cloned().or_else(|| self.own_word(f))
            }
        }
    }

    /// The word of the car that no factor has changed.
    fn own_word(&self, f: usize) -> Option<FactorValue> {
        let Plan { base, factors, .. } = &self.study.plan;
        let setup = &self.car.variant(0, factors).ok()?.setup;
        let word = match factors[f].key.as_str() {
            "start" => base.start.clone(),
            "cycle" => base.cycle.clone(),
            "lubricant" => setup.oils().0.name.clone(),
            "engine_oil" => setup.oils().1.name.clone(),
            "formulation" => base.formulation.name().to_owned(),
            key => setup
                .keys
                .iter()
                .find(|info| info.key == key)?
                .value
                .clone(),
        };
        Some(FactorValue::Word(word.into()))
    }

    /// Index of the factor of a run option.
    fn factor(&self, key: &str) -> Option<usize> {
        self.study
            .plan
            .factors
            .iter()
            .position(|factor| factor.key == key)
    }

    /// The value of a run option at this point, if a factor gives it to this car.
    fn option(&self, key: &str) -> Option<&FactorValue> {
        let mut all = self.study.plan.factors.iter().zip(&self.car.bindings);
        let is_it =
            |(factor, binding): (&Factor, &Binding)| factor.key == key && *binding != Binding::Not;
        let index = all.position(is_it)?;
        self.values[index].as_ref()
    }

    /// Index of the cycle: the plan's comes first, then those of the factor's list.
    fn cycle(&self) -> usize {
        let factor = self.factor("cycle").map(|f| &self.study.plan.factors[f]);
        let value = self.option("cycle");
        factor
            .zip(value)
            .map_or(0, |(factor, value)| factor.entry_of(value))
    }

    fn conditions(&self) -> Conditions {
        let base = &self.study.plan.base;
        let number = |key: &str, base: f64| {
            let value = self.factor(key).and_then(|f| self.resolve(f, None));
            value.and_then(|value| value.number()).unwrap_or(base)
        };
        let start = match self.option("start") {
            Some(FactorValue::Number(degc)) => Start::At(degc + ZERO_DEGC_K),
            Some(FactorValue::Word(word)) => start(word),
            None => start(&base.start),
        };
        let ambient_degc = self.car.ambient_degc.unwrap_or(base.ambient_degc);
        Conditions {
            ambient_k: number("ambient_degc", ambient_degc) + ZERO_DEGC_K,
            start,
            max_dt_s: number("dt_s", base.dt_s),
            keep_rows: false,
        }
    }
}

/// Hands the rows of a run on to whatever is kept of them.
fn watched<'a>(
    cycle: &'a Cycle,
    mut traces: Option<&'a mut Traces>,
    mut sides: Option<&'a mut SideEffects>,
) -> impl FnMut(&[Row]) {
    move |rows| {
        if let Some(traces) = &mut traces {
            traces.push(cycle, rows);
        }
        if let Some(sides) = &mut sides {
            sides.see(rows);
        }
    }
}

fn start(word: &str) -> Start {
    match word {
        "soak" => Start::Soak,
        "warm" => Start::Warm,
        nodes if nodes.contains('=') => start_nodes(nodes).map_or(Start::Soak, Start::Nodes),
        // The plan has checked that it is a number.
        degc => degc
            .parse()
            .map_or(Start::Soak, |degc: f64| Start::At(degc + ZERO_DEGC_K)),
    }
}

/// A run fails as `run` fails; gross slip, of which `run` only warns, makes its numbers no statement about a car that anyone would build.
pub(crate) fn status(summary: &RunSummary) -> Status {
    let mut reasons: Vec<String> = summary.failures.iter().map(Failure::brief).collect();
    let slips = summary.flags_s.get("gross_slip").filter(|s| *s > 0.0);
    reasons.extend(slips.map(|s| format!("gross_slip for {s:.0} s")));
    if reasons.is_empty() {
        Status::Ok
    } else {
        Status::Failed(reasons.join("; "))
    }
}

/// Problems in one line.
pub(crate) fn reason(problems: &[Problem]) -> String {
    let messages = problems
        .iter()
        .map(|problem| match problem.allowed.as_str() {
            "" => problem.message.clone(),
            allowed => format!("{} (allowed: {allowed})", problem.message),
        });
    let text = messages.collect::<Vec<_>>().join("; ");
    text.replace(['\n', '\r'], " ")
}
