//! One sample of what is uncertain of a car, from which every range of its answer comes: of its fuel, of the difference to each car it is
//! compared with, of the price of each loss and of each change of its design; which value is worth a test; and in how many draws it fails.
//!
//! | label | statement | status |
//! |---|---|---|
//! | AW-2 | price of loss i in draw k: p_k = 1 - B(x_k; f_i = 0)/B(x_k), f_i as AT-1 | derived from AT-1 |

use std::collections::BTreeSet;

use serde::Serialize;

use crate::draws::{Compared, OtherCar, OtherKind, Own, Parts, differences, own};
use crate::levers::{
    Combine, Lever, LeverAnswer, LeverFile, LeverNotes, LeverRequest, lever_answer,
    prepare as prepare_levers,
};
use cvtcycle_config::setup::{Kind, Options, Setup};
use cvtcycle_config::{Override, Problem, Problems};
use cvtcycle_output::Component;
use cvtcycle_output::progress::Progress;
use cvtcycle_output::summary::{DrawnDifference, FAILED_SHARES, Summary as RunResultSummary};
use cvtcycle_study::answer::Information;
use cvtcycle_study::execute::outputs::FUEL;
use cvtcycle_study::execute::{End, Study};
use cvtcycle_study::plan::{Base, Plan};
use cvtcycle_study::statistics::{Confidence, Summary};
use cvtcycle_study::store::Values;
use cvtcycle_study::{StudyManifest, StudyTable, TableSource};

pub use crate::draws::{HEARD_RPM, PLAN, SEED};

/// Version of an [`Answer`] as JSON.
pub const SCHEMA: u32 = 2;
/// Draws of an answer: with 256 the ends of 90 % have intervals of their own (ES-3), and a failure in 1 % of all cases is seen.
pub const DRAWS: u64 = 256;

/// A car, and what is wanted to know of it. The ranges of the plan are taken relative to the values of the car; a range that a file gives its value
/// goes before them. A value that the user has given is certain.
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

/// Ranges, prices, options and risks of a car, all from one sample.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Version of this object.
    pub schema: u32,
    /// Plan whose factors are drawn, relative to the values of the car.
    pub plan: String,
    /// Draws.
    pub draws: u64,
    /// Draws in which the car as it is fails.
    pub failed_draws: usize,
    /// Checks that fail in them with their counts, the commonest first.
    pub reasons: Vec<(String, usize)>,
    /// Quantiles 0.05, 0.5 and 0.95 of the car's fuel over the draws in which it works, L/100 km.
    pub fuel_l_per_100km: [f64; 3],
    /// The car against itself before the change and against each baseline, by name.
    pub differences: Vec<(String, DrawnDifference)>,
    /// Quantiles 0.05, 0.5 and 0.95 of the fuel that is saved without a loss, per cent, by component (AW-2).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub prices: Vec<(String, [f64; 3])>,
    /// Changes of the design; none of a question without them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levers: Option<LeverAnswer>,
    /// Value of knowing each factor: the spread that is left of the difference to the first baseline, or of the fuel without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub information: Option<Information>,
    /// Estimate of the error of the fuel by the length of the steps, per cent; none where it was not made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step_error_percent: Option<f64>,
    /// Doubts about the inputs, a sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub doubts: Vec<String>,
}

impl Answer {
    /// The answer of a sample of cars, without prices and levers.
    fn of_sample(study: &Study, parts: &Parts) -> Self {
        let Own {
            fuel_l_per_100km,
            failed,
            reasons,
        } = own(study, parts);
        Answer {
            schema: SCHEMA,
            plan: PLAN.to_owned(),
            draws: study.points,
            failed_draws: failed,
            reasons,
            fuel_l_per_100km,
            differences: differences(study, parts),
            prices: Vec::new(),
            levers: None,
            information: None,
            step_error_percent: None,
            doubts: Vec::new(),
        }
    }

    /// Draws in which the car as it is fails, and all.
    pub fn failed(&self) -> [usize; 2] {
        [self.failed_draws, self.draws as usize]
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

    /// Puts the ranges of this answer in place of those of other samples: a document has one.
    pub fn merge(&self, summary: &mut RunResultSummary) {
        // Without draws of the baselines the car before its change is the only one.
        if self.differences.len() <= summary.comparison.len() {
            let drawn = self.differences.iter().map(|(_, drawn)| drawn.clone());
            summary.take_drawn(drawn.collect());
        }
        let Some(run) = summary.runs.first_mut() else {
            return;
        };
        run.drawn = self.fuel();
        if let Some(price) = &mut run.price {
            for (name, [low, _, high]) in &self.prices {
                if let Some(loss) = price.losses.get_mut(name) {
                    loss.range = self.is_known().then_some([*low, *high]);
                }
            }
        }
    }

    /// "57 of 256 runs of the car with uncertain values varied fail: gross_slip in 57", where they are more than a few (AW-3).
    pub fn failures_in_words(&self) -> Option<String> {
        let [failed, n] = self.failed();
        (failed as f64 > FAILED_SHARES[0] * n as f64).then(|| {
            let reasons = self.reasons.iter().map(|(name, n)| format!("{name} in {n}"));
            let reasons = reasons.collect::<Vec<_>>().join(", ");
            format!("{failed} of {n} runs of the car as it is, its uncertain values varied, fail: {reasons}")
        })
    }
}

/// Drives all draws of a sample of cars ([`crate::draws::prepare`]); `None` where the progress has stopped them.
///
/// # Errors
/// Values with which the study cannot be driven.
pub fn drive_cars(study: &Study, progress: &dyn Progress) -> Result<Option<Answer>, Problems> {
    let parts = Parts::default();
    Ok(match study.execute(&BTreeSet::new(), &parts, progress)? {
        End::Stopped => None,
        End::Complete => Some(Answer::of_sample(study, &parts)),
    })
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
    let Compared {
        options,
        setup,
        mut others,
    } = Compared::new(base)?;
    if question.prices {
        others.extend(without_losses(base, &setup, &options)?);
    }
    let is_cvt = setup.transmission().is_cvt();
    let levers = question.levers.iter();
    let own = levers.filter(|lever| lever.of_cvt.is_none_or(|cvt| cvt == is_cvt));
    prepare_levers(&LeverRequest {
        levers: own.cloned().collect(),
        vehicles: vec![base.vehicle.clone()],
        ambients_degc: vec![base.ambient_degc],
        cycle: base.cycle.clone(),
        start: base.start.clone(),
        dt_s: base.dt_s,
        base: options,
        set_all: base.set_all.clone(),
        others,
        draws: Some((Plan::open(PLAN)?, question.draws, SEED)),
        combine: Combine::Automatic,
        heard_rpm: question.heard_rpm,
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

/// Drives all draws; `None` where the progress has stopped them.
///
/// # Errors
/// Values with which the study cannot be driven.
pub fn drive(study: &Study, progress: &dyn Progress) -> Result<Option<Answer>, Problems> {
    let parts = Parts::default();
    Ok(match study.execute(&BTreeSet::new(), &parts, progress)? {
        End::Stopped => None,
        End::Complete => Some(answer(study, &parts)?),
    })
}

/// Table of the runs of a study.
struct Memory<'s> {
    study: &'s Study,
    parts: &'s Parts,
}

fn answer(study: &Study, parts: &Parts) -> Result<Answer, Problem> {
    let manifest = StudyManifest::new(study);
    let memory = Memory { study, parts };
    let table = StudyTable::new(&manifest, &memory)?;
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
    let first = of_kind(OtherKind::Baseline).next();
    let first = first.map(|(car, note)| pairs(note.reference, car));
    let price = |(car, note): (usize, &crate::levers::ColumnNote)| {
        let saved: Vec<f64> = pairs(car, note.reference).iter().map(|x| -x).collect(); // AW-2
        (note.name.clone(), ends(&saved))
    };
    let spread = first.unwrap_or_else(|| fuel[0].clone());
    Ok(Answer {
        prices: of_kind(OtherKind::WithoutLoss).map(price).collect(),
        information: Information::of_sample(&manifest.plan, &spread, confidence),
        levers: Some(levers),
        ..Answer::of_sample(study, parts)
    })
}

impl TableSource for Memory<'_> {
    fn parts(&self) -> Vec<u64> {
        (0..self.study.parts()).collect()
    }

    fn columns(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem> {
        Ok(self.parts.columns(self.study, part, names))
    }

    fn traces(&self, _: u64, _: &[&str]) -> Result<Vec<Values>, Problem> {
        Ok(Vec::new())
    }
}
