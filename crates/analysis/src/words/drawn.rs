//! How sure the difference between cars is: both are driven again with the same draws of the uncertain values.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use cvtcycle_config::{Acts, Override, Problem, Problems};
use cvtcycle_output::summary::DrawnDifference;

use cvtcycle_output::progress::NoProgress;
use cvtcycle_study::execute::outputs::EXCESS;
use cvtcycle_study::execute::{PartWriter, Study, relative};
use cvtcycle_study::plan::{Base, Cars, Design, Factor, Plan};
use cvtcycle_study::statistics::{Confidence, Share, Summary};
use cvtcycle_study::store::{Rows, Values};

/// The plan that is drawn.
pub const PLAN: &str = "uncertainty_rover";
/// Seed of the draws.
const SEED: u64 = 1;

/// The draws of any cars: independent draws of the plan of uncertainty, its ranges taken relative to the values of its own cars. A value
/// that the user has set for all cars of a factor is certain, and so is one that the factor would replace. What is uncertain of the CVT of the
/// plan is so of every CVT, with the same draw, and what is so of its manual car of every manual one. `is_cvt`: whether the subject has a CVT.
///
/// # Errors
/// Problems of the plan or of the cars.
pub fn prepare(base: Base, samples: u64, is_cvt: bool) -> Result<Study, Problems> {
    let (mut plan, of_cvts) = relative(Plan::open(PLAN)?)?;
    let is_first = is_cvt == of_cvts;
    plan.factors
        .retain(|factor| !is_fixed(factor, &base, is_first));
    plan.by_box = Some(of_cvts);
    plan.design = Design::MonteCarlo {
        samples,
        seed: SEED,
    };
    plan.base = base;
    Study::prepare(plan)
}

/// `is_first`: whether the subject has the box of the plan's subject.
fn is_fixed(factor: &Factor, base: &Base, is_first: bool) -> bool {
    let is_set = |by: &Override| match factor.acts {
        // The value of a key, or a table with another option.
        Acts::Value => factor.key == by.key() || factor.key.starts_with(&format!("{}.", by.key())),
        _ => by.acts() == Acts::Value && factor.key == by.key(),
    };
    let of_subject = match factor.cars {
        Cars::Baselines => !is_first,
        Cars::Subject => is_first,
        Cars::All => factor.acts == Acts::Value,
    };
    base.set_all.iter().any(is_set) || of_subject && base.set.iter().any(is_set)
}

/// Drives all draws: the difference of the subject to each baseline, over the draws that both can be driven with.
///
/// # Errors
/// Values with which the study cannot be driven.
pub fn differences(study: &Study) -> Result<Vec<DrawnDifference>, Problems> {
    let memory = Memory::default();
    study.execute(&BTreeSet::new(), &memory, &NoProgress)?;
    Ok(memory.differences(study))
}

/// The draws of a study, a part at a time, for a program that has to look up in between.
pub struct Draws {
    study: Study,
    memory: Memory,
    next: u64,
}

impl Draws {
    /// Nothing driven yet.
    pub fn new(study: Study) -> Self {
        Draws {
            study,
            memory: Memory::default(),
            next: 0,
        }
    }

    /// Drives the next part; the differences, as [`differences`] has them, after the last one.
    ///
    /// # Errors
    /// As there.
    pub fn advance(&mut self) -> Result<Option<Vec<DrawnDifference>>, Problems> {
        let (parts, now) = (self.study.parts(), self.next);
        if now < parts {
            let others = (0..parts).filter(|part| *part != now).collect();
            self.study.execute(&others, &self.memory, &NoProgress)?;
            self.next += 1;
        }
        let is_whole = self.next >= parts;
        Ok(is_whole.then(|| self.memory.differences(&self.study)))
    }
}

/// Keeps the table of runs, by part.
#[derive(Default)]
struct Memory(Mutex<Vec<(u64, Rows)>>);

impl Memory {
    fn differences(&self, study: &Study) -> Vec<DrawnDifference> {
        let mut parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        parts.sort_by_key(|(part, _)| *part);
        let of = |baseline: usize| {
            let excess = excess(study, &parts, baseline);
            let summary = Summary::new(&excess, Confidence::default());
            let more = Share::above_zero(&excess, None);
            DrawnDifference {
                plan: PLAN.to_owned(),
                draws: more.n as u64,
                left_out: study.points - more.n as u64,
                more: more.k as u64,
                percent: [0.05, 0.5, 0.95].map(|p| summary.quantile(p)),
            }
        };
        (1..study.cars.len()).map(of).collect()
    }
}

impl PartWriter for Memory {
    fn write(&self, part: u64, runs: &Rows, _: Option<&Rows>) -> Result<(), Problem> {
        let mut parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        parts.push((part, runs.clone()));
        Ok(())
    }
}

/// Excess of the subject over a baseline, draw by draw, of good pairs.
fn excess(study: &Study, parts: &[(u64, Rows)], baseline: usize) -> Vec<f64> {
    let column = |name: &str| study.columns.iter().position(|head| head.name == name);
    let (Some(excess), Some(status)) = (column(EXCESS), column("status")) else {
        return Vec::new();
    };
    let cars = study.cars.len();
    let mut list = Vec::new();
    for (_, rows) in parts {
        let (Values::Number(excess), Values::Text(status)) =
            (&rows.values[excess], &rows.values[status])
        else {
            continue;
        };
        let points = excess.chunks_exact(cars).zip(status.chunks_exact(cars));
        let good =
            points.filter(|(_, status)| [0, baseline].iter().all(|car| &*status[*car] == "ok"));
        list.extend(good.map(|(excess, _)| excess[baseline]));
    }
    list
}
