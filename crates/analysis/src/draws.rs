//! A car and those that it is compared with over the same draws of what is uncertain: the part of an answer that a live page has.
//!
//! | label | statement | status |
//! |---|---|---|
//! | AW-1 | all columns of a point have the same draw x_k: d_k = B_a(x_k)/B_b(x_k) - 1 of two cars a, b | derived, as PV-1 |
//! | AW-3 | no range is claimed where more than a fifth of the draws fail; more than a twentieth is a risk | ASSUMED: 0.05, 0.2 |
//!
//! A draw in which one of two compared cars fails is left out of their difference and counted.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, PoisonError};

use cvtcycle_config::setup::{
    NamedBy, Options, Setup, TWIN, baseline_of, is_same_vehicle, is_twin, load, name_of,
};
use cvtcycle_config::{Acts, Override, Problem, Problems};
use cvtcycle_output::progress::{NoProgress, Progress};
use cvtcycle_output::summary::{DrawnDifference, FAILED_SHARES};
use cvtcycle_study::execute::outputs::{FUEL, FUEL_OVER_TIME};
use cvtcycle_study::execute::{Column, Columns, End, PartWriter, Study, relative, with_ranges};
use cvtcycle_study::plan::{Base, Cars, Design, Factor, Plan};
use cvtcycle_study::statistics::{Confidence, Share, Summary};
use cvtcycle_study::store::{Rows, Values};

pub use crate::words::intervals::PLAN;

/// Engine speed, rpm, below which a loaded engine behind a closed clutch is heard and felt, where no other is given.
pub const HEARD_RPM: f64 = 1300.0;
/// Seed of the draws.
pub const SEED: u64 = 1;
/// Role of the car that others are compared with.
const REFERENCE: &str = "reference";

/// A car that is driven with the draws of another one.
#[derive(Clone, Debug)]
pub struct OtherCar {
    /// Purpose of the comparison.
    pub kind: OtherKind,
    /// Name, unique within its kind.
    pub name: String,
    /// Name or path of its file.
    pub word: String,
    /// Oils and overrides.
    pub options: Options,
    /// True if it has a CVT.
    pub is_cvt: bool,
}

/// Purpose of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OtherKind {
    /// A baseline.
    Baseline,
    /// The car before the change that the user makes.
    Unchanged,
    /// The car without one of its losses.
    WithoutLoss,
    /// The subject of another run.
    OtherRun,
}

impl OtherKind {
    /// Word in the table.
    pub fn name(self) -> &'static str {
        match self {
            OtherKind::Baseline => "baseline",
            OtherKind::Unchanged => "unchanged",
            OtherKind::WithoutLoss => "without_loss",
            OtherKind::OtherRun => "other_run",
        }
    }
}

/// The subject of a base, as it is read, and the cars that it is compared with: itself before its changes, then its baselines.
pub(crate) struct Compared {
    pub options: Options,
    pub setup: Setup,
    pub others: Vec<OtherCar>,
}

impl Compared {
    /// Reads the cars.
    ///
    /// # Errors
    /// Their problems.
    pub fn new(base: &Base) -> Result<Self, Problems> {
        let options = options_of(base, base.lubricant.clone(), &base.set);
        let setup = load(&base.vehicle, &options)?;
        let is_changed = base.lubricant.is_some() || !base.set.is_empty();
        let plain = options_of(base, None, &[]);
        let unchanged = is_changed.then(|| OtherCar {
            kind: OtherKind::Unchanged,
            name: OtherKind::Unchanged.name().to_owned(),
            word: base.vehicle.clone(),
            options: plain.clone(),
            is_cvt: setup.transmission().is_cvt(),
        });
        let mut others: Vec<OtherCar> = unchanged.into_iter().collect();
        for name in base.baselines.as_ref().unwrap_or(&setup.baselines) {
            // The subject's own file is the car unchanged.
            if is_changed && is_same_vehicle(name, &base.vehicle) {
                continue;
            }
            others.push(baseline(name, (base, &options), &plain)?);
        }
        Ok(Compared {
            options,
            setup,
            others,
        })
    }
}

/// A baseline, by its name in the vehicle's file, as a path, or as the twin of the subject.
fn baseline(
    name: &str,
    (base, subject): (&Base, &Options),
    plain: &Options,
) -> Result<OtherCar, Problems> {
    let word = match (name == TWIN, &base.baselines) {
        (false, Some(_)) => name.to_owned(),
        _ => baseline_of(&base.vehicle, name),
    };
    let options = match is_twin(&word) {
        true => subject.of_twin(NamedBy::File),
        false => plain.clone(),
    };
    let setup = load(&word, &options)?;
    Ok(OtherCar {
        kind: OtherKind::Baseline,
        name: name_of(&word),
        word,
        options,
        is_cvt: setup.transmission().is_cvt(),
    })
}

/// Oils and overrides of a car of a run.
pub(crate) fn options_of(base: &Base, lubricant: Option<String>, set: &[Override]) -> Options {
    Options {
        lubricant,
        engine_oil: base.engine_oil.clone(),
        set: base.set_all.iter().chain(set).cloned().collect(),
        formulation: base.formulation,
        named_by: NamedBy::File,
    }
}

/// Overrides by the user, of all cars and of the subject alone, which has the box of the plan's subject or not.
pub(crate) struct Given<'g> {
    pub set_all: &'g [Override],
    pub set: &'g [Override],
    pub is_like_subject: bool,
}

/// A relative plan with the ranges that the cars give their own values, without the factors whose value the user has given all of their cars.
pub(crate) fn with_knowledge(plan: Plan, of_cvt: bool, cars: &[&Setup], given: &Given) -> Plan {
    let mut plan = with_ranges(plan, of_cvt, cars);
    plan.factors.retain(|factor| !is_given(factor, given));
    plan
}

/// True for a factor whose value the user has given all of its cars: it is certain.
pub(crate) fn is_given(factor: &Factor, given: &Given) -> bool {
    let sets = |by: &Override| match factor.acts {
        // The value of a key, or a table with another option.
        Acts::Value => factor.key == by.key() || factor.key.starts_with(&format!("{}.", by.key())),
        _ => by.acts() == Acts::Value && factor.key == by.key(),
    };
    let of_subject = match factor.cars {
        Cars::Baselines => !given.is_like_subject,
        Cars::Subject => given.is_like_subject,
        Cars::All => factor.acts == Acts::Value,
    };
    given.set_all.iter().any(sets) || of_subject && given.set.iter().any(sets)
}

/// The study of a car and those that it is compared with, without levers.
///
/// # Errors
/// All problems of cars and conditions.
pub fn prepare(base: &Base, draws: u64) -> Result<Study, Problems> {
    let Compared {
        options,
        setup,
        others,
    } = Compared::new(base)?;
    study(base, (options, &setup), (others, &base.set_all), draws)
}

/// The study of a car and others; what is set for all is certain.
fn study(
    base: &Base,
    (options, setup): (Options, &Setup),
    (others, set_all): (Vec<OtherCar>, &[Override]),
    draws: u64,
) -> Result<Study, Problems> {
    let (plan, of_cvt) = relative(Plan::open(PLAN)?)?;
    // The other cars of this list have the values of the subject.
    let own = [OtherKind::Unchanged, OtherKind::WithoutLoss];
    let baselines = others.iter().filter(|other| !own.contains(&other.kind));
    let baselines = baselines.map(|other| load(&other.word, &other.options));
    let baselines = baselines.collect::<Result<Vec<_>, _>>()?;
    let cars: Vec<&Setup> = [setup].into_iter().chain(&baselines).collect();
    let is_cvt = setup.transmission().is_cvt();
    let given = Given {
        set_all,
        set: &options.set,
        is_like_subject: is_cvt == of_cvt,
    };
    let plan = with_knowledge(plan, of_cvt, &cars, &given);
    let design = Design::LatinHypercube {
        samples: draws,
        seed: SEED,
    };
    let column = |kind: &str, name: &str, (word, options, is_cvt): (&str, &Options, bool)| Column {
        name: format!("{kind}/{name}"),
        role: kind.to_owned(),
        word: word.to_owned(),
        is_subject: is_cvt == of_cvt,
        ambient_degc: base.ambient_degc,
        options: options.clone(),
        left_out: Vec::new(),
        is_watched: false,
    };
    let own = column(REFERENCE, "car", (&base.vehicle, &options, is_cvt));
    let others = others.iter().map(|other| {
        let car = (other.word.as_str(), &other.options, other.is_cvt);
        column(other.kind.name(), &other.name, car)
    });
    let columns = Columns {
        list: [own].into_iter().chain(others).collect(),
        heard_rpm: HEARD_RPM,
        about: serde_json::Value::Null,
    };
    let plan = Plan {
        base: base_of(base),
        // The cycle is the question's: its path does not begin at the plan's folder.
        file: "answer".to_owned(),
        title: String::new(),
        question: String::new(),
        analyse: Vec::new(),
        design,
        ..plan
    };
    Study::of_columns(plan, columns)
}

/// The conditions of a base: its cars are columns.
fn base_of(base: &Base) -> Base {
    Base {
        baselines: Some(Vec::new()),
        ..base.clone()
    }
}

/// The subjects of several runs of one cycle over the same draws: the difference of each to the first, in the order of `others`. A value that one
/// of them has been given is certain in all.
///
/// # Errors
/// Problems of the cars and of the plan.
pub fn compare(
    first: &Base,
    others: &[Base],
    draws: u64,
) -> Result<Vec<DrawnDifference>, Problems> {
    let mut cars = Vec::new();
    for (k, base) in others.iter().enumerate() {
        let options = options_of(base, base.lubricant.clone(), &base.set);
        let setup = load(&base.vehicle, &options)?;
        cars.push(OtherCar {
            kind: OtherKind::OtherRun,
            name: k.to_string(),
            word: base.vehicle.clone(),
            options,
            is_cvt: setup.transmission().is_cvt(),
        });
    }
    let given = others.iter().flat_map(|base| &base.set);
    let given: Vec<Override> = first
        .set_all
        .iter()
        .chain(&first.set)
        .chain(given)
        .cloned()
        .collect();
    let options = options_of(first, first.lubricant.clone(), &first.set);
    let setup = load(&first.vehicle, &options)?;
    let study = study(first, (options, &setup), (cars, &given), draws)?;
    let found = drive(&study, &NoProgress)?.unwrap_or_default();
    Ok(found.into_iter().map(|(_, drawn)| drawn).collect())
}

/// Drives all draws: the car against each other one, by name; `None` where the progress has stopped them.
///
/// # Errors
/// Values with which the study cannot be driven.
pub fn drive(
    study: &Study,
    progress: &dyn Progress,
) -> Result<Option<Vec<(String, DrawnDifference)>>, Problems> {
    let parts = Parts::default();
    Ok(match study.execute(&BTreeSet::new(), &parts, progress)? {
        End::Stopped => None,
        End::Complete => Some(differences(study, &parts)),
    })
}

/// The draws of a study, a part at a time, for a program that has to look up in between.
pub struct Draws {
    study: Study,
    parts: Parts,
    next: u64,
}

impl Draws {
    /// Nothing driven yet.
    pub fn new(study: Study) -> Self {
        Draws {
            study,
            parts: Parts::default(),
            next: 0,
        }
    }

    /// Drives the next part; the differences after the last one.
    ///
    /// # Errors
    /// As [`drive`].
    pub fn advance(&mut self) -> Result<Option<Vec<(String, DrawnDifference)>>, Problems> {
        let (count, now) = (self.study.parts(), self.next);
        if now < count {
            let others = (0..count).filter(|part| *part != now).collect();
            self.study.execute(&others, &self.parts, &NoProgress)?;
            self.next += 1;
        }
        let is_whole = self.next >= count;
        Ok(is_whole.then(|| differences(&self.study, &self.parts)))
    }
}

/// Rows of the runs of a study, by part.
#[derive(Default)]
pub(crate) struct Parts(Mutex<BTreeMap<u64, Rows>>);

impl Parts {
    /// Cells of some columns of a part.
    pub fn columns(&self, study: &Study, part: u64, names: &[&str]) -> Vec<Values> {
        let parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(rows) = parts.get(&part) else {
            return Vec::new();
        };
        let column = |name: &&str| study.columns.iter().position(|head| head.name == *name);
        let found = names.iter().filter_map(column);
        found.map(|k| rows.values[k].clone()).collect()
    }
}

impl PartWriter for Parts {
    fn write(&self, part: u64, runs: &Rows, _: Option<&Rows>) -> Result<(), Problem> {
        let mut parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        parts.insert(part, runs.clone());
        Ok(())
    }
}

/// The first car of a study against each car that it is compared with, over the draws that both can be driven with.
pub(crate) fn differences(study: &Study, parts: &Parts) -> Vec<(String, DrawnDifference)> {
    let kinds = [
        OtherKind::Unchanged,
        OtherKind::Baseline,
        OtherKind::OtherRun,
    ];
    let is_compared = |role: &str| kinds.iter().any(|kind| kind.name() == role);
    let cars = study.cars.iter().enumerate();
    let cars = cars.filter(|(_, car)| is_compared(&car.role));
    cars.map(|(k, car)| {
        let name = car.name.rsplit('/').next().unwrap_or(&car.name).to_owned();
        let is_run = &*car.role == OtherKind::OtherRun.name();
        (name, difference(study, parts, (k, is_run)))
    })
    .collect()
}

/// The first car against another one; another run against the first car.
fn difference(study: &Study, parts: &Parts, (other, is_run): (usize, bool)) -> DrawnDifference {
    let cars = study.cars.len();
    let (mut list, mut failed) = (Vec::new(), BTreeMap::<String, u64>::new());
    let mut own_fuel = Vec::new();
    let mut forms = vec![Vec::new(); study.plan.forms_drawn().len()];
    for part in 0..study.parts() {
        let cells = parts.columns(study, part, &["status", "reason", FUEL, FUEL_OVER_TIME]);
        let [
            Values::Text(status),
            Values::Text(reason),
            Values::Number(fuel),
            Values::Number(over_time),
        ] = &cells[..]
        else {
            continue;
        };
        // A drive without way has no fuel over distance.
        let compared = match fuel.iter().any(|x| x.is_finite()) {
            true => fuel,
            false => over_time,
        };
        let points = status.chunks_exact(cars).zip(reason.chunks_exact(cars));
        let points = study.part_points(part).zip(points);
        let fuels = fuel.chunks_exact(cars).zip(compared.chunks_exact(cars));
        for ((point, (status, reason)), (own, fuel)) in points.zip(fuels) {
            if &*status[0] == "ok" {
                own_fuel.push(own[0]);
            }
            if [0, other].iter().all(|car| &*status[*car] == "ok") {
                let (own, of) = match is_run {
                    true => (fuel[other], fuel[0]),
                    false => (fuel[0], fuel[other]),
                };
                let percent = 100.0 * (own / of - 1.0); // AW-1
                list.push(percent);
                let form = study.plan.form_of(point);
                if let Some(of_form) = form.and_then(|form| forms.get_mut(form)) {
                    of_form.push(percent);
                }
                continue;
            }
            let of_pair = [0, other].map(|car| &*reason[car]);
            let names: BTreeSet<String> = of_pair.into_iter().flat_map(failed_checks).collect();
            for name in names {
                *failed.entry(name).or_default() += 1;
            }
        }
    }
    let mut reasons: Vec<(String, u64)> = failed.into_iter().collect();
    reasons.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    let summary = Summary::new(&list, Confidence::default());
    let more = Share::above_zero(&list, None);
    let forms = study.plan.forms_drawn().iter().zip(&forms);
    let forms = forms.filter(|(_, list)| !list.is_empty());
    let by_form = forms.map(|(form, list)| {
        let median = Summary::new(list, Confidence::default()).quantile(0.5);
        (form.title.clone(), list.len() as u64, median)
    });
    DrawnDifference {
        by_form: by_form.collect(),
        plan: PLAN.to_owned(),
        draws: more.n as u64,
        left_out: study.points - more.n as u64,
        reasons,
        more: more.k as u64,
        percent: [0.05, 0.5, 0.95].map(|p| summary.quantile(p)),
        fuel_l_per_100km: quantiles_of_most(&own_fuel, study.points).filter(|_| !is_run),
    }
}

/// Quantiles 0.05, 0.5 and 0.95 of numbers of a car that works in so many of the draws; none where too many fail (AW-3).
fn quantiles_of_most(of: &[f64], draws: u64) -> Option<[f64; 3]> {
    let failed = draws as f64 - of.len() as f64;
    let summary = Summary::new(of, Confidence::default());
    let is_known = !of.is_empty() && failed <= FAILED_SHARES[1] * draws as f64;
    let quantiles = [0.05, 0.5, 0.95].map(|p| summary.quantile(p));
    // A drive without way has none.
    let is_finite = quantiles.iter().all(|x| x.is_finite());
    (is_known && is_finite).then_some(quantiles)
}

/// A car by itself over all draws.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Own {
    /// Quantiles 0.05, 0.5 and 0.95 of its fuel over the draws in which it works, L/100 km.
    pub fuel_l_per_100km: [f64; 3],
    /// Draws in which it fails, and the names of the checks with their counts, the commonest first.
    pub failed: usize,
    pub reasons: Vec<(String, usize)>,
}

/// The first car of a study by itself.
pub(crate) fn own(study: &Study, parts: &Parts) -> Own {
    let cars = study.cars.len();
    let (mut list, mut failed, mut count) = (Vec::new(), BTreeMap::<String, usize>::new(), 0);
    for part in 0..study.parts() {
        let cells = parts.columns(study, part, &["status", "reason", FUEL]);
        let [
            Values::Text(status),
            Values::Text(reason),
            Values::Number(fuel),
        ] = &cells[..]
        else {
            continue;
        };
        for (row, status) in status.iter().enumerate().step_by(cars) {
            if &**status == "ok" {
                list.push(fuel[row]);
                continue;
            }
            count += 1;
            for name in failed_checks(&reason[row]).collect::<BTreeSet<_>>() {
                *failed.entry(name).or_default() += 1;
            }
        }
    }
    let mut reasons: Vec<(String, usize)> = failed.into_iter().collect();
    reasons.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    let summary = Summary::new(&list, Confidence::default());
    Own {
        fuel_l_per_100km: [0.05, 0.5, 0.95].map(|p| summary.quantile(p)),
        failed: count,
        reasons,
    }
}

/// Name of the failure of a car whose values do not go together, in the place of a check's.
const IMPOSSIBLE: &str = "impossible_values";

/// Names of the checks in the reason of a failed run: the first word of each part, since what follows differs from run to run. A car that cannot be
/// driven has a sentence in their place.
pub(crate) fn failed_checks(reason: &str) -> impl Iterator<Item = String> {
    let all = reason.split("; ").filter(|one| !one.is_empty());
    all.map(|one| match one.split_once(' ') {
        None => one.to_owned(),
        Some((name, rest)) if rest.starts_with("for ") => name.to_owned(),
        Some(_) => IMPOSSIBLE.to_owned(),
    })
}
