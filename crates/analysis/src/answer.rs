//! One sample of what is uncertain of a car, from which every range of its answer comes: of its fuel, of the difference to each car it is
//! compared with, of the price of each loss and of each change of its design; which value is worth a test; and in how many draws it fails.
//!
//! | label | statement | status |
//! |---|---|---|
//! | AW-1 | all columns of a point have the same draw x_k: d_k = B_a(x_k)/B_b(x_k) - 1 of two cars a, b | derived, as PV-1 |
//! | AW-2 | price of loss i in draw k: p_k = 1 - B(x_k; f_i = 0)/B(x_k), f_i as AT-1 | derived from AT-1 |
//! | AW-3 | no range is claimed where more than a fifth of the draws fail; more than a twentieth is a risk | ASSUMED: 0.05, 0.2 |
//!
//! A draw in which one of two compared cars fails is left out of their difference and counted.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use serde::Serialize;

use crate::levers::{
    Combine, Lever, LeverAnswer, LeverFile, LeverNotes, LeverRequest, OtherCar, OtherKind,
    failed_checks, lever_answer, prepare as prepare_levers,
};
use cvtcycle_config::setup::{
    Kind, NamedBy, Options, Setup, TWIN, baseline_of, is_twin, load, name_of,
};
use cvtcycle_config::{Override, Problem, Problems};
use cvtcycle_output::Component;
use cvtcycle_output::progress::{NoProgress, Progress};
use cvtcycle_output::summary::{DrawnDifference, FAILED_SHARES};
use cvtcycle_study::answer::Information;
use cvtcycle_study::execute::outputs::FUEL;
use cvtcycle_study::execute::{End, PartWriter, Study};
use cvtcycle_study::plan::{Base, Plan};
use cvtcycle_study::statistics::{Confidence, Share, Summary};
use cvtcycle_study::store::{Rows, Values};
use cvtcycle_study::{StudyManifest, StudyTable, TableSource};

pub use crate::words::intervals::PLAN;

/// Version of an [`Answer`] as JSON.
pub const SCHEMA: u32 = 1;
/// Draws of an answer: with 256 the ends of 90 % have intervals of their own (ES-3), and a failure in 1 % of all cases is seen.
pub const DRAWS: u64 = 256;
/// Engine speed, rpm, below which a loaded engine behind a closed clutch is heard and felt, where no other is given.
pub const HEARD_RPM: f64 = 1300.0;
/// Seed of the draws.
pub const SEED: u64 = 1;

/// A car, and what is wanted to know of it. The ranges of the plan are taken relative to the values of the car; a range that a file gives its value
/// goes before them. What the user has given a value is certain.
#[derive(Clone, Debug)]
pub struct Question {
    /// Cars and conditions.
    pub base: Base,
    /// Changes of the design that are driven.
    pub levers: Vec<Lever>,
    /// True to drive the car without each of its losses.
    pub prices: bool,
    /// Draws.
    pub draws: u64,
    /// Engine speed, rpm, below which a loaded engine behind a closed clutch is heard and felt.
    pub heard_rpm: f64,
}

/// What one sample says of a car.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Version of this object.
    pub schema: u32,
    /// Plan whose factors are drawn, relative to the values of the car.
    pub plan: String,
    /// Draws.
    pub draws: u64,
    /// Quantiles 0.05, 0.5 and 0.95 of the car's fuel over the draws in which it works, L/100 km.
    pub fuel_l_per_100km: [f64; 3],
    /// The car against itself before the change and against each baseline, by name.
    pub differences: Vec<(String, DrawnDifference)>,
    /// Quantiles 0.05, 0.5 and 0.95 of the fuel that is saved without a loss, per cent, by component (AW-2).
    pub prices: Vec<(String, [f64; 3])>,
    /// Changes of the design.
    pub levers: LeverAnswer,
    /// What is left of the spread of the difference to the first baseline, or of the fuel without one, where a value is known.
    pub information: Option<Information>,
}

impl Answer {
    /// Draws in which the car as it is fails, and all.
    pub fn failed(&self) -> [usize; 2] {
        let block = self.levers.blocks.first();
        block.map_or([0, 0], |block| [block.failed, block.n])
    }

    /// True where few enough draws fail for the others to give ranges (AW-3).
    pub fn is_known(&self) -> bool {
        let [failed, n] = self.failed();
        failed as f64 <= FAILED_SHARES[1] * n as f64
    }

    /// Quantiles 0.05, 0.5 and 0.95 of the fuel, L/100 km, where they are known.
    pub fn fuel(&self) -> Option<[f64; 3]> {
        let is_finite = self.fuel_l_per_100km.iter().all(|x| x.is_finite());
        (self.is_known() && is_finite).then_some(self.fuel_l_per_100km)
    }

    /// "57 of 256 runs of the car with uncertain values varied fail: gross_slip in 57", where they are more than a few (AW-3).
    pub fn failures_in_words(&self) -> Option<String> {
        let [failed, n] = self.failed();
        let block = self.levers.blocks.first()?;
        (failed as f64 > FAILED_SHARES[0] * n as f64).then(|| {
            let reasons = block.reasons.iter().map(|(name, n)| format!("{name} in {n}"));
            let reasons = reasons.collect::<Vec<_>>().join(", ");
            format!("{failed} of {n} runs of the car as it is, its uncertain values varied, fail: {reasons}")
        })
    }
}

/// The changes of a design that the program knows.
///
/// # Errors
/// Problems of an embedded file: a defect of the program.
pub fn shipped_levers() -> Result<Vec<Lever>, Problems> {
    let mut all = Vec::new();
    for name in Kind::Levers.names() {
        all.extend(LeverFile::open(name)?.levers);
    }
    Ok(all)
}

/// The study of a question.
///
/// # Errors
/// All problems of cars, levers and conditions.
pub fn prepare(question: &Question) -> Result<Study, Problems> {
    let base = &question.base;
    let of_car = |lubricant: Option<String>, set: &[Override]| options_of(base, lubricant, set);
    let subject = of_car(base.lubricant.clone(), &base.set);
    let setup = load(&base.vehicle, &subject)?;
    let is_changed = base.lubricant.is_some() || !base.set.is_empty();
    let unchanged = is_changed.then(|| OtherCar {
        kind: OtherKind::Unchanged,
        name: OtherKind::Unchanged.name().to_owned(),
        word: base.vehicle.clone(),
        options: of_car(None, &[]),
        is_cvt: setup.transmission().is_cvt(),
    });
    let named = base.baselines.as_ref().unwrap_or(&setup.baselines);
    let mut others: Vec<OtherCar> = unchanged.into_iter().collect();
    for name in named {
        others.push(baseline(name, (base, &subject), &of_car(None, &[]))?);
    }
    if question.prices {
        others.extend(without_losses(base, &setup, &subject)?);
    }
    let levers = question.levers.iter();
    let own = levers.filter(|lever| {
        lever
            .of_cvt
            .is_none_or(|cvt| cvt == setup.transmission().is_cvt())
    });
    prepare_levers(&LeverRequest {
        levers: own.cloned().collect(),
        heard_rpm: question.heard_rpm,
        ..request(base, (subject, others), question.draws)?
    })
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

/// The subject without each of its losses in turn.
fn without_losses(base: &Base, setup: &Setup, subject: &Options) -> Result<Vec<OtherCar>, Problem> {
    let is_cvt = setup.transmission().is_cvt();
    let kind = if is_cvt { "cvt" } else { "manual" };
    let components: Vec<Component> = setup.transmission().components().into_iter().collect();
    let without = |component: &Component| {
        let name = component.name();
        let mut options = subject.clone();
        let key = format!("transmission.{kind}.loss_factor.{name}");
        options.set.push(Override::new(&key, "0")?);
        Ok(OtherCar {
            kind: OtherKind::WithoutLoss,
            name: name.to_owned(),
            word: base.vehicle.clone(),
            options,
            is_cvt,
        })
    };
    components.iter().map(without).collect()
}

impl Question {
    /// Only the differences to the other cars.
    pub fn differences(base: Base, draws: u64) -> Self {
        Question {
            base,
            levers: Vec::new(),
            prices: false,
            draws,
            heard_rpm: HEARD_RPM,
        }
    }
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

    /// Drives the next part; the answer after the last one.
    ///
    /// # Errors
    /// As [`drive`].
    pub fn advance(&mut self) -> Result<Option<Answer>, Problems> {
        let (count, now) = (self.study.parts(), self.next);
        let memory = Memory {
            study: &self.study,
            parts: &self.parts,
        };
        if now < count {
            let others = (0..count).filter(|part| *part != now).collect();
            self.study.execute(&others, &memory, &NoProgress)?;
            self.next += 1;
        }
        Ok(match self.next >= count {
            true => Some(memory.answer()?),
            false => None,
        })
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
    let given: Vec<Override> = others.iter().flat_map(|base| &base.set).cloned().collect();
    let subject = options_of(first, first.lubricant.clone(), &first.set);
    let study = prepare_levers(&LeverRequest {
        set_all: first.set.iter().chain(&given).cloned().collect(),
        ..request(first, (subject, cars), draws)?
    })?;
    let answer = drive(&study, &NoProgress)?;
    Ok(answer.map_or_else(Vec::new, |answer| {
        answer
            .differences
            .into_iter()
            .map(|(_, drawn)| drawn)
            .collect()
    }))
}

/// Oils and overrides of a car of a run.
fn options_of(base: &Base, lubricant: Option<String>, set: &[Override]) -> Options {
    Options {
        lubricant,
        engine_oil: base.engine_oil.clone(),
        set: base.set_all.iter().chain(set).cloned().collect(),
        formulation: base.formulation,
        named_by: NamedBy::File,
    }
}

/// The request of a car under the conditions of its base, without levers.
fn request(
    base: &Base,
    (subject, others): (Options, Vec<OtherCar>),
    draws: u64,
) -> Result<LeverRequest, Problems> {
    Ok(LeverRequest {
        levers: Vec::new(),
        vehicles: vec![base.vehicle.clone()],
        ambients_degc: vec![base.ambient_degc],
        cycle: base.cycle.clone(),
        start: base.start.clone(),
        dt_s: base.dt_s,
        base: subject,
        set_all: base.set_all.clone(),
        others,
        draws: Some((Plan::open(PLAN)?, draws, SEED)),
        combine: Combine::Automatic,
        heard_rpm: HEARD_RPM,
    })
}

/// Drives all draws; `None` where the progress has stopped them.
///
/// # Errors
/// Values with which the study cannot be driven.
pub fn drive(study: &Study, progress: &dyn Progress) -> Result<Option<Answer>, Problems> {
    let parts = Parts::default();
    let memory = Memory {
        study,
        parts: &parts,
    };
    let end = study.execute(&BTreeSet::new(), &memory, progress)?;
    match end {
        End::Stopped => Ok(None),
        End::Complete => Ok(Some(memory.answer()?)),
    }
}

/// Rows of the runs, by part.
type Parts = Mutex<Vec<(u64, Rows)>>;

/// Table of the runs of a study.
struct Memory<'s> {
    study: &'s Study,
    parts: &'s Parts,
}

impl Memory<'_> {
    fn answer(&self) -> Result<Answer, Problem> {
        let manifest = StudyManifest::new(self.study);
        let table = StudyTable::new(&manifest, self)?;
        let confidence = Confidence::default();
        let levers = lever_answer(&table, confidence)?;
        let about: LeverNotes = manifest
            .levers
            .clone()
            .and_then(|about| serde_json::from_value(about).ok())
            .unwrap_or_default();
        let fuel = table.by_car(&[FUEL])?.swap_remove(0);
        let ends = |list: &[f64]| {
            let summary = Summary::new(list, confidence);
            [0.05, 0.5, 0.95].map(|p| summary.quantile(p))
        };
        let pairs = |car: usize, other: usize| -> Vec<f64> {
            let pairs = fuel[car].iter().zip(&fuel[other]);
            pairs.map(|(a, b)| 100.0 * (a / b - 1.0)).collect() // AW-1
        };
        let columns = || about.columns.iter().enumerate();
        let of_kind = |kind: OtherKind| columns().filter(move |(_, note)| note.kind == kind.name());
        let mut differences = Vec::new();
        let mut first = None;
        let compared = of_kind(OtherKind::Unchanged).chain(of_kind(OtherKind::Baseline));
        // Another run is compared with the first, a car with those it is compared with.
        let compared = compared.chain(of_kind(OtherKind::OtherRun));
        for (car, note) in compared {
            let percent = match note.kind == OtherKind::OtherRun.name() {
                true => pairs(car, note.reference),
                false => pairs(note.reference, car),
            };
            let more = Share::above_zero(&percent, None);
            let drawn = DrawnDifference {
                plan: PLAN.to_owned(),
                draws: more.n as u64,
                left_out: manifest.points - more.n as u64,
                reasons: failures(&table, [note.reference, car])?,
                more: more.k as u64,
                percent: ends(&percent),
            };
            if note.kind == OtherKind::Baseline.name() && first.is_none() {
                first = Some(percent);
            }
            differences.push((note.name.clone(), drawn));
        }
        let price = |(car, note): (usize, &crate::levers::ColumnNote)| {
            let saved: Vec<f64> = pairs(car, note.reference).iter().map(|x| -x).collect(); // AW-2
            (note.name.clone(), ends(&saved))
        };
        let spread = first.unwrap_or_else(|| fuel[0].clone());
        Ok(Answer {
            schema: SCHEMA,
            plan: PLAN.to_owned(),
            draws: manifest.points,
            fuel_l_per_100km: ends(&fuel[0]),
            prices: of_kind(OtherKind::WithoutLoss).map(price).collect(),
            information: Information::of_sample(&manifest.plan, &spread, confidence),
            differences,
            levers,
        })
    }
}

/// Checks that fail in the draws of two cars with their counts, the commonest first.
fn failures(table: &StudyTable, cars: [usize; 2]) -> Result<Vec<(String, u64)>, Problem> {
    let [own, other] = cars.map(|car| table.words("reason", car));
    let mut counts: Vec<(String, u64)> = Vec::new();
    for (own, other) in own?.iter().zip(&other?) {
        let names = [own, other].into_iter().filter(|text| !text.is_empty());
        let names: BTreeSet<String> = names.flat_map(|text| failed_checks(text)).collect();
        for name in names {
            match counts.iter_mut().find(|(known, _)| *known == name) {
                Some((_, n)) => *n += 1,
                None => counts.push((name, 1)),
            }
        }
    }
    counts.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    Ok(counts)
}

impl PartWriter for Memory<'_> {
    fn write(&self, part: u64, runs: &Rows, _: Option<&Rows>) -> Result<(), Problem> {
        let mut parts = self.parts.lock().unwrap_or_else(PoisonError::into_inner);
        parts.push((part, runs.clone()));
        parts.sort_by_key(|(part, _)| *part);
        Ok(())
    }
}

impl TableSource for Memory<'_> {
    fn parts(&self) -> Vec<u64> {
        (0..self.study.parts()).collect()
    }

    fn columns(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem> {
        let parts = self.parts.lock().unwrap_or_else(PoisonError::into_inner);
        let Some((_, rows)) = parts.iter().find(|(index, _)| *index == part) else {
            return Ok(Vec::new());
        };
        let columns = &self.study.columns;
        let column = |name: &&str| columns.iter().position(|head| head.name == *name);
        let found = names.iter().filter_map(column);
        Ok(found.map(|k| rows.values[k].clone()).collect())
    }

    fn traces(&self, _: u64, _: &[&str]) -> Result<Vec<Values>, Problem> {
        Ok(Vec::new())
    }
}
