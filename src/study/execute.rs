//! A study on all cores: parts of consecutive points, computed in parallel, written one after the other while the next is computed.
//!
//! How the points fall into parts follows from the plan alone, so that the same parts come out on any number of threads and after any
//! interruption. Memory holds a few parts, whatever the number of points.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::sync_channel;

use rayon::prelude::*;

use super::point::{Filler, PointRun, Worker};
use super::prepare::Study;
use super::table::Rows;
use crate::config::Problem;

/// Points that one thread takes at a time.
const CHUNK: u64 = 2;
/// Most points of a part, and the number of parts that a small study is divided into at least.
const MOST_POINTS: u64 = 4096;
const PARTS: u64 = 32;
/// Most rows of traces in a part.
const MOST_TRACE_ROWS: u64 = 50_000;

/// Where whole parts go.
pub trait Sink: Sync {
    /// Takes a part, whole or not at all.
    ///
    /// # Errors
    /// What is in the way; the study then stops.
    fn write(&self, part: u64, runs: &Rows, trace: Option<&Rows>) -> Result<(), Problem>;
}

/// Looks on, and may stop the study.
pub trait Watcher: Sync {
    /// So many runs more are done.
    fn advance(&self, runs: u64);
    /// Whether the study is to stop now.
    fn stopped(&self) -> bool;
}

/// Nobody looks on.
#[derive(Clone, Copy, Debug)]
pub struct Unwatched;

impl Watcher for Unwatched {
    fn advance(&self, _: u64) {}

    fn stopped(&self) -> bool {
        false
    }
}

/// How an execution ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// All parts are there.
    Complete,
    /// Stopped by the watcher; finished parts are kept.
    Stopped,
}

impl Study {
    /// Number of points in a part; the last part may have fewer.
    #[must_use]
    pub fn points_per_part(&self) -> u64 {
        let small = self.points.div_ceil(PARTS).clamp(1, MOST_POINTS);
        if self.traces.is_empty() {
            return small;
        }
        let per_point = self.trace_rows_per_point().max(1);
        small.min((MOST_TRACE_ROWS / per_point).max(1))
    }

    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> u64 {
        self.points.div_ceil(self.points_per_part())
    }

    /// Points of a part.
    #[must_use]
    pub fn part_points(&self, part: u64) -> Range<u64> {
        let size = self.points_per_part();
        (part * size)..((part + 1) * size).min(self.points)
    }

    fn trace_rows_per_point(&self) -> u64 {
        let rows = |car: &super::cars::StudyCar| {
            let automatic = car.setups(&self.plan.factors).any(|setup| setup.transmission().is_cvt());
            let steps = self.cycles.iter().map(|cycle| cycle.trace_for(automatic).step_count(self.plan.base.dt_s));
            steps.max().unwrap_or(0) as u64
        };
        self.cars.iter().map(rows).sum()
    }

    /// Computes the parts that are not in `done` and gives them to the sink in order. Uses the threads of the pool in which it is called.
    ///
    /// # Errors
    /// The sink's problem.
    pub fn execute(&self, done: &BTreeSet<u64>, sink: &dyn Sink, watcher: &dyn Watcher) -> Result<End, Problem> {
        // One part waits while another is written: enough that no thread is idle, little enough that memory stays flat.
        let (send, receive) = sync_channel::<(u64, Rows, Option<Rows>)>(1);
        std::thread::scope(|scope| {
            let writer = scope.spawn(move || {
                for (part, runs, trace) in receive {
                    sink.write(part, &runs, trace.as_ref())?;
                }
                Ok(())
            });
            let workers = Mutex::new(Vec::new());
            let mut end = End::Complete;
            for part in (0..self.parts()).filter(|part| !done.contains(part)) {
                let Some((runs, trace)) = self.part(part, &workers, watcher) else {
                    end = End::Stopped;
                    break;
                };
                // A writer that has failed takes nothing more; its problem comes with its end.
                if send.send((part, runs, trace)).is_err() {
                    break;
                }
            }
            drop(send);
            writer.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)).map(|()| end)
        })
    }

    /// Drives the points of a part; nothing if the watcher has stopped it.
    fn part(&self, part: u64, workers: &Mutex<Vec<Worker>>, watcher: &dyn Watcher) -> Option<(Rows, Option<Rows>)> {
        let points = self.part_points(part);
        let chunks: Vec<Range<u64>> = points.clone().step_by(CHUNK as usize).map(|from| from..(from + CHUNK).min(points.end)).collect();
        let failed = AtomicU64::new(0);
        let driven: Vec<Vec<(u64, Vec<PointRun>)>> = chunks
            .into_par_iter()
            .map(|chunk| {
                let mut worker = take(workers);
                let mut list = Vec::with_capacity(CHUNK as usize);
                for point in chunk {
                    if watcher.stopped() {
                        failed.store(1, Ordering::Relaxed);
                        break;
                    }
                    list.push((point, self.point(point, &mut worker)));
                    watcher.advance(self.cars.len() as u64);
                }
                give_back(workers, worker);
                list
            })
            .collect();
        if failed.load(Ordering::Relaxed) > 0 {
            return None;
        }
        let filler = Filler::new(self);
        let count = usize::try_from(points.end - points.start).unwrap_or(0) * self.cars.len();
        let mut runs = Rows::with_capacity(&self.columns, count);
        let mut trace = (!self.traces.is_empty()).then(|| Rows::with_capacity(&self.trace_columns, 0));
        for (point, list) in driven.iter().flatten() {
            filler.push(*point, list, &mut runs);
            if let Some(trace) = &mut trace {
                filler.push_traces(*point, list, trace);
            }
        }
        Some((runs, trace))
    }
}

/// A worker that is free, or a new one. A poisoned lock holds workers as good as any: each point sets all that it needs.
fn take(workers: &Mutex<Vec<Worker>>) -> Worker {
    let mut free = workers.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    free.pop().unwrap_or_default()
}

fn give_back(workers: &Mutex<Vec<Worker>>, worker: Worker) {
    workers.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(worker);
}
