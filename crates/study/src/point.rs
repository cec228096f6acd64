//! One point of a study: every car with the point's draw, and the rows that come of it.

use std::collections::HashMap;

use super::cars::{Binding, StudyCar, text, words};
use super::design::Level;
use super::plan::{Acts, FactorValue};
use super::preflight::resolved;
use super::prepare::Study;
use super::traces::Traces;
use cvtcycle_config::Problem;
use cvtcycle_config::setup::Setup;
use cvtcycle_config::setup::template::{ParameterRef, Variant};
use cvtcycle_model::drive::{Conditions, Outcome, Start, drive_into};
use cvtcycle_model::fluid::ZERO_DEGC_K;
use cvtcycle_output::summary::{Driven, RunSummary, Settings, compare, run_summary};

/// What one thread keeps from point to point: a bench for each variant of each car, and room for the levels.
#[derive(Default)]
pub(super) struct Worker {
    benches: HashMap<(usize, usize), Variant>,
    levels: Vec<Level>,
}

/// Why a run has no numbers, or numbers that failed a check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Status {
    Ok,
    Failed(String),
    NotRun(String),
}

impl Status {
    pub fn word(&self) -> &'static str {
        match self {
            Status::Ok => "ok",
            Status::Failed(_) => "failed",
            Status::NotRun(_) => "not_run",
        }
    }

    pub fn reason(&self) -> &str {
        match self {
            Status::Ok => "",
            Status::Failed(reason) | Status::NotRun(reason) => reason,
        }
    }
}

/// A run of a point.
pub(super) struct PointRun {
    pub status: Status,
    pub factors: Vec<Option<FactorValue>>,
    pub numbers: Vec<f64>,
}

/// A car driven, before its numbers are put together.
struct DrivenCar {
    setup: Setup,
    outcome: Outcome,
}

impl Study {
    /// Drives a point; the rows of its runs go into `traces`, if they are kept.
    pub(super) fn point(
        &self,
        point: u64,
        worker: &mut Worker,
        mut traces: Option<&mut Traces>,
    ) -> Vec<PointRun> {
        let mut levels = std::mem::take(&mut worker.levels);
        self.plan
            .design
            .levels(&self.plan.factors, point, &mut levels);
        let values: Vec<Option<FactorValue>> = self
            .plan
            .factors
            .iter()
            .zip(&levels)
            .map(|(factor, level)| factor.value(*level))
            .collect();
        worker.levels = levels;
        let mut subject: Option<RunSummary> = None;
        let mut runs = Vec::with_capacity(self.cars.len());
        for (k, car) in self.cars.iter().enumerate() {
            if let Some(traces) = &mut traces {
                traces.begin(point, car);
            }
            let (run, summary) = self.car(
                (k, car),
                &values,
                worker,
                subject.as_ref(),
                traces.as_deref_mut(),
            );
            if k == 0 {
                subject = summary;
            }
            runs.push(run);
        }
        runs
    }

    fn car(
        &self,
        (k, car): (usize, &StudyCar),
        values: &[Option<FactorValue>],
        worker: &mut Worker,
        subject: Option<&RunSummary>,
        traces: Option<&mut Traces>,
    ) -> (PointRun, Option<RunSummary>) {
        let cycle = self.cycle_of(car, values);
        let mut run = PointRun {
            status: Status::Ok,
            factors: Vec::new(),
            numbers: Vec::new(),
        };
        let driven = match self.build(k, car, values, worker, &mut run.factors) {
            Ok(setup) => {
                let conditions = self.conditions(car, values);
                let cycle = &self.cycles[cycle];
                let outcome = match traces {
                    Some(traces) => drive_into(
                        &setup,
                        cycle,
                        &conditions,
                        Some(&mut |rows| traces.push(cycle, rows)),
                    ),
                    None => drive_into(&setup, cycle, &conditions, None),
                };
                DrivenCar { setup, outcome }
            }
            Err(reason) => {
                run.status = Status::NotRun(reason);
                run.numbers = vec![f64::NAN; self.outputs.len()];
                return (run, None);
            }
        };
        let settings = Settings {
            formulation: self.formulation_word(car, values),
            ..Settings::default()
        };
        let named = Driven {
            name: &car.name,
            setup: &driven.setup,
            outcome: &driven.outcome,
        };
        let summary = run_summary(&self.cycles[cycle], &car.role, &settings, &named);
        run.status = status(&summary);
        let excess = subject.map(|subject| compare(subject, &summary));
        let row = (summary, excess);
        run.numbers = self
            .outputs
            .iter()
            .map(|column| column.number_of(&row))
            .collect();
        (run, Some(row.0))
    }

    /// The car with the point's values; in `factors` what each factor has become in it.
    fn build(
        &self,
        k: usize,
        car: &StudyCar,
        values: &[Option<FactorValue>],
        worker: &mut Worker,
        factors: &mut Vec<Option<FactorValue>>,
    ) -> Result<Setup, String> {
        let all = &self.plan.factors;
        let index = all
            .iter()
            .zip(values)
            .enumerate()
            .map(|(f, (factor, value))| car.weight(f, factor, value.as_ref()))
            .sum();
        let variant = car.variant(index, all);
        for (f, value) in values.iter().enumerate() {
            let slot = variant
                .as_ref()
                .ok()
                .and_then(|variant| variant.slots[f].as_ref());
            factors.push(self.resolve(f, car, value.as_ref(), slot.map(ParameterRef::base)));
        }
        let variant = variant.map_err(reason)?;
        if let Some((_, problem)) = variant.unknown.first() {
            return Err(reason(std::slice::from_ref(problem)));
        }
        let bench = worker
            .benches
            .entry((k, index))
            .or_insert_with(|| variant.blueprint.bench());
        bench.reset();
        for ((slot, value), given) in variant.slots.iter().zip(factors.iter()).zip(values) {
            // What the design leaves alone is not put in again: a file may well not give it.
            if let (Some(slot), Some(FactorValue::Number(x)), Some(_)) = (slot, value, given) {
                bench.set(slot, *x);
            }
        }
        bench.build().map_err(|_| reason(&bench.problems()))
    }

    /// What a factor's value has become in a car, or the car's own where the design leaves it; none where the factor does not reach it.
    fn resolve(
        &self,
        f: usize,
        car: &StudyCar,
        value: Option<&FactorValue>,
        base: Option<f64>,
    ) -> Option<FactorValue> {
        let number = |acts, base: f64| match value {
            Some(FactorValue::Number(x)) => FactorValue::Number(resolved(acts, base, *x)),
            Some(word) => word.clone(),
            None => FactorValue::Number(base),
        };
        match car.bindings[f] {
            Binding::Not => None,
            Binding::Number(acts) => base.map(|base| number(acts, base)),
            Binding::Ambient => Some(number(Acts::Value, self.plan.base.ambient_degc)),
            Binding::Step => Some(number(Acts::Value, self.plan.base.dt_s)),
            Binding::Start | Binding::Cycle | Binding::Words { .. } => {
                value.cloned().or_else(|| self.own_word(f, car))
            }
        }
    }

    /// The word of a car that no factor has changed.
    fn own_word(&self, f: usize, car: &StudyCar) -> Option<FactorValue> {
        let base = &self.plan.base;
        let setup = &car.variant(0, &self.plan.factors).ok()?.setup;
        let word = match self.plan.factors[f].key.as_str() {
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

    /// The value of a run option at this point, if a factor gives it to this car.
    fn option<'v>(
        &self,
        key: &str,
        car: &StudyCar,
        values: &'v [Option<FactorValue>],
    ) -> Option<&'v FactorValue> {
        let index = (0..values.len())
            .find(|&f| self.plan.factors[f].key == key && car.bindings[f] != Binding::Not)?;
        values[index].as_ref()
    }

    /// Index of the cycle: the plan's comes first, then those of the factor's list.
    fn cycle_of(&self, car: &StudyCar, values: &[Option<FactorValue>]) -> usize {
        let Some(value) = self.option("cycle", car, values) else {
            return 0;
        };
        let word = text(value);
        let factor = self
            .plan
            .factors
            .iter()
            .find(|factor| factor.key == "cycle");
        factor
            .and_then(|factor| words(factor).iter().position(|other| *other == word))
            .map_or(0, |k| k + 1)
    }

    fn conditions(&self, car: &StudyCar, values: &[Option<FactorValue>]) -> Conditions {
        let base = &self.plan.base;
        let number = |key: &str, base: f64| {
            let f = (0..values.len()).find(|&f| self.plan.factors[f].key == key);
            match f.and_then(|f| self.resolve(f, car, values[f].as_ref(), None)) {
                Some(FactorValue::Number(x)) => x,
                _ => base,
            }
        };
        let start = match self.option("start", car, values) {
            Some(FactorValue::Number(degc)) => Start::At(degc + ZERO_DEGC_K),
            Some(FactorValue::Word(word)) => start(word),
            None => start(&base.start),
        };
        Conditions {
            ambient_k: number("ambient_degc", base.ambient_degc) + ZERO_DEGC_K,
            start,
            max_dt_s: number("dt_s", base.dt_s),
            keep_rows: false,
        }
    }

    fn formulation_word(&self, car: &StudyCar, values: &[Option<FactorValue>]) -> String {
        let word = self
            .option("formulation", car, values)
            .map(|value| text(value).to_string());
        word.unwrap_or_else(|| self.plan.base.formulation.name().to_owned())
    }
}

fn start(word: &str) -> Start {
    match word {
        "soak" => Start::Soak,
        "warm" => Start::Warm,
        // The plan has checked that it is a number.
        degc => degc
            .parse()
            .map_or(Start::Soak, |degc: f64| Start::At(degc + ZERO_DEGC_K)),
    }
}

/// A run fails as `run` fails; gross slip, of which `run` only warns, makes its numbers no statement about a car that anyone would build.
fn status(summary: &RunSummary) -> Status {
    let mut reasons = summary.failed_checks.clone();
    let slips = summary.flags_s.get("gross_slip").is_some_and(|s| s > 0.0);
    if slips {
        reasons.push("gross_slip".to_owned());
    }
    if reasons.is_empty() {
        return Status::Ok;
    }
    let described = reasons
        .iter()
        .map(|name| match (name.as_str(), &summary.worst_deficit) {
            ("missed_trace", Some(worst)) => format!(
                "missed_trace for {:.0} s, worst {:.1} kW at {:.0} s in {}",
                summary.trace_missed_s,
                worst.power_w / 1e3,
                worst.at_s,
                worst.phase
            ),
            (name, _) => match summary.flags_s.get(name) {
                Some(s) => format!("{name} for {s:.0} s"),
                None => name.to_owned(),
            },
        });
    Status::Failed(described.collect::<Vec<_>>().join("; "))
}

/// Problems in one line.
fn reason(problems: &[Problem]) -> String {
    let messages = problems.iter().map(|problem| {
        let allowed = if problem.allowed.is_empty() {
            String::new()
        } else {
            format!(" (allowed: {})", problem.allowed)
        };
        format!("{}{allowed}", problem.message)
    });
    let text = messages.collect::<Vec<_>>().join("; ");
    text.replace(['\n', '\r'], " ")
}
