//! A study on all cores: points go to the threads in order, a few at a time; the thread that drives the last one of a part puts the part
//! together. No thread waits for another at the end of a part.
//!
//! How the points fall into parts follows from the plan alone, so that the same parts come out on any number of threads and after any
//! interruption. Memory holds a few parts, whatever the number of points.

mod cars;
pub mod manifest;
pub mod outputs;
mod notes;
mod pilot;
mod point;
mod preflight;
mod prepare;
mod relative;
mod rows;
pub mod side_effects;

pub use cars::{Column, StudyCar};
pub use manifest::StudyManifest;
pub use notes::idle;
pub use pilot::Pilot;
pub(crate) use point::{reason, status};
pub use prepare::{Columns, Study};
pub use relative::{relative, with_ranges};

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{self, ScopedJoinHandle};

use crate::plan::{Factor, FactorValue, FactorValues, STUDY};
use crate::store::{PartTable, Rows, StudyDir, TRACE_ROWS};
use cvtcycle_config::bounded::{CELLS, kept_steps};
use cvtcycle_config::{Place, Problem};
use cvtcycle_model::drive::MAX_TOGETHER;
use cvtcycle_output::progress::Progress;
use manifest::{RUNS, TRACES};
use rows::{Filler, Traces};

/// Least number of points that a thread takes at a time: those that are driven side by side; and the number of such takings that a larger part is
/// divided into. What comes out does not depend on them.
const MIN_CHUNK: u64 = MAX_TOGETHER as u64;
const CHUNKS: u64 = 64;
/// Most points of a part, and the number of parts that a small study is divided into at least.
const MAX_POINTS: u64 = 4096;
const PARTS: u64 = 32;

/// Where whole parts go: in no certain order, and several at once.
pub trait PartWriter: Sync {
    /// Takes a part, whole or not at all.
    ///
    /// # Errors
    /// The cause of a failed write; the study then stops.
    fn write(&self, part: u64, runs: &Rows, trace: Option<&Rows>) -> Result<(), Problem>;
}

/// Writes the parts of a study into its directory.
pub struct DirWriter<'a> {
    study: &'a Study,
    dir: &'a StudyDir,
}

impl<'a> DirWriter<'a> {
    /// For a study in its directory.
    pub fn new(study: &'a Study, dir: &'a StudyDir) -> Self {
        DirWriter { study, dir }
    }
}

impl PartWriter for DirWriter<'_> {
    fn write(&self, part: u64, runs: &Rows, trace: Option<&Rows>) -> Result<(), Problem> {
        let index = usize::try_from(part).unwrap_or(usize::MAX);
        let trace = trace.map(|rows| PartTable {
            name: TRACES,
            columns: &self.study.trace_columns,
            rows,
            metadata: &[],
        });
        let runs = PartTable {
            name: RUNS,
            columns: &self.study.columns,
            rows: runs,
            metadata: &[],
        };
        let tables: Vec<PartTable> = trace.into_iter().chain([runs]).collect();
        self.dir.write_part(index, &tables)
    }
}

/// How an execution ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// All parts are there.
    Complete,
    /// Stopped by the progress; finished parts are kept.
    Stopped,
}

impl Study {
    /// Number of points in a part; the last part may have fewer.
    pub fn points_per_part(&self) -> u64 {
        let small = self.points.div_ceil(PARTS).clamp(1, MAX_POINTS);
        if self.traces.is_empty() {
            return small;
        }
        let per_point = self.trace_rows_per_point().max(1);
        small.min((TRACE_ROWS / per_point).max(1))
    }

    /// Number of parts.
    pub fn parts(&self) -> u64 {
        self.points.div_ceil(self.points_per_part())
    }

    /// Points of a part.
    pub fn part_points(&self, part: u64) -> Range<u64> {
        let size = self.points_per_part();
        (part * size)..((part + 1) * size).min(self.points)
    }

    /// Rows of the traces of a point at most: those of all cars, on the longest cycle with the shortest step.
    fn trace_rows_per_point(&self) -> u64 {
        let (dt_s, _) = self.shortest_step();
        let rows = |car: &StudyCar| {
            let mut setups = car.setups(&self.plan.factors);
            let automatic = setups.any(|setup| setup.transmission().is_cvt());
            let traces = self.cycles.iter().map(|cycle| cycle.trace_for(automatic));
            traces
                .map(|trace| trace.step_count(dt_s))
                .max()
                .unwrap_or(0) as u64
        };
        let sum = |sum: u64, car| sum.saturating_add(rows(car));
        self.cars.iter().fold(0, sum)
    }

    /// The shortest step of a point, s, and where the plan gives it.
    fn shortest_step(&self) -> (f64, &Place) {
        let plan = &self.plan;
        let own = (plan.base.dt_s, plan.places.place("dt_s"));
        let of_factor = |factor: &Factor| match &factor.values {
            FactorValues::List(list) => list
                .iter()
                .filter_map(FactorValue::number)
                .fold(own.0, f64::min),
            // One without ends reaches down to what the key allows.
            FactorValues::Distribution(distribution) => {
                distribution.support().0.max(STUDY.dt_s.range().low())
            }
        };
        let factors = plan.factors.iter().filter(|factor| factor.key == "dt_s");
        let factors = factors.map(|factor| (of_factor(factor), &factor.place));
        factors.fold(own, |a, b| if b.0 < a.0 { b } else { a })
    }

    /// Checks that the traces of a point, which a thread holds until they are written, are not too large.
    ///
    /// # Errors
    /// A problem of the plan.
    fn check_traces(&self) -> Result<(), Problem> {
        let columns = self.traces.len();
        if columns == 0 {
            return Ok(());
        }
        let rows = usize::try_from(self.trace_rows_per_point()).unwrap_or(usize::MAX);
        let (dt_s, place) = self.shortest_step();
        kept_steps(rows, dt_s).map_err(|problem| problem.at(place.clone()).key("dt_s"))?;
        let cells = rows.saturating_mul(columns);
        if cells <= CELLS {
            return Ok(());
        }
        Err(
            Problem::too_large(format!("one point keeps {cells} numbers of traces"))
                .at(self.plan.places.place("keep").clone())
                .key("keep")
                .allowed(format!("up to {CELLS} numbers"))
                .hint("keep fewer columns, or take a larger dt_s"),
        )
    }

    /// Computes the parts that are not in `done` and gives them to the writer. Uses the threads of the pool in which it is called, and one
    /// more that writes; where writing takes longer than driving, the threads of the pool write as well.
    ///
    /// # Errors
    /// The writer's problem.
    pub fn execute(
        &self,
        done: &BTreeSet<u64>,
        sink: &dyn PartWriter,
        progress: &dyn Progress,
    ) -> Result<End, Problem> {
        self.execute_with(thread::Builder::new(), done, sink, progress)
    }

    /// Executes with a thread that writes, if that one starts; without it those that drive write.
    fn execute_with(
        &self,
        writing: thread::Builder,
        done: &BTreeSet<u64>,
        sink: &dyn PartWriter,
        progress: &dyn Progress,
    ) -> Result<End, Problem> {
        let left = (0..self.parts()).filter(|part| !done.contains(part));
        let state = QueueState {
            left: Box::new(left),
            points: (0, 0..0),
            pieces: BTreeMap::new(),
            spare: Vec::new(),
        };
        let queue = Queue {
            study: self,
            trace_rows: self.trace_rows_per_point(),
            chunk: (self.points_per_part() / CHUNKS).max(MIN_CHUNK),
            state: Mutex::new(state),
        };
        // One part waits while another is written: enough that no thread is idle, little enough that memory stays flat.
        let (send, receive) = sync_channel::<Part>(1);
        thread::scope(|scope| {
            let queue = &queue;
            let write_all = || {
                receive
                    .into_iter()
                    .try_for_each(|part| queue.write(part, sink))
            };
            let writer = writing.spawn_scoped(scope, write_all).ok();
            let send = writer.is_some().then_some(send);
            let ends = rayon::broadcast(|_| self.work(queue, (sink, send.as_ref()), progress));
            drop(send);
            let written = writer.map_or(Ok(Ok(())), ScopedJoinHandle::join);
            let written = written.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            let ends: Vec<End> = ends.into_iter().collect::<Result<_, _>>()?;
            written?;
            Ok(match ends.contains(&End::Stopped) {
                true => End::Stopped,
                false => End::Complete,
            })
        })
    }

    /// Takes work from the queue until it is empty; runs in each thread.
    fn work(
        &self,
        queue: &Queue,
        (sink, send): (&dyn PartWriter, Option<&SyncSender<Part>>),
        progress: &dyn Progress,
    ) -> Result<End, Problem> {
        while let Some((part, points)) = queue.take() {
            let from = points.start;
            let Some(piece) = self.piece(points, queue.trace_rows, progress) else {
                queue.clear();
                return Ok(End::Stopped);
            };
            let Some(pieces) = queue.give(part, from, piece) else {
                continue;
            };
            // To the writing thread, or written here where that one is behind.
            let part = self.whole(part, pieces, queue);
            let sent = match send {
                Some(send) => send.try_send(part),
                None => Err(TrySendError::Full(part)),
            };
            let taken = match sent {
                Ok(()) => continue,
                Err(TrySendError::Full(part)) => queue.write(part, sink),
                // It has failed and takes nothing more; its problem comes with its end.
                Err(TrySendError::Disconnected(_)) => {
                    queue.clear();
                    Ok(())
                }
            };
            taken.inspect_err(|_| queue.clear())?;
        }
        Ok(End::Complete)
    }

    /// Drives some points; nothing if the progress has stopped it.
    fn piece(&self, points: Range<u64>, trace_rows: u64, progress: &dyn Progress) -> Option<Piece> {
        let (count, cars) = (points.end - points.start, self.cars.len() as u64);
        let rows_of = |per_point| usize::try_from(count.saturating_mul(per_point)).unwrap_or(0);
        let filler = Filler::new(self);
        let mut runs = Rows::with_capacity(&self.columns, rows_of(cars));
        let mut traces = Traces::new(self, || rows_of(trace_rows));
        let mut from = points.start;
        while from < points.end {
            if progress.stopped() {
                return None;
            }
            let to = points.end.min(from.saturating_add(MAX_TOGETHER as u64));
            let of_points = self.points(from..to, traces.as_mut());
            for (point, of_point) in (from..to).zip(&of_points) {
                filler.push(point, of_point, &mut runs);
                progress.advance(cars);
            }
            from = to;
        }
        Some(Piece {
            points: count,
            runs,
            traces: traces.map(Traces::into_rows),
        })
    }

    /// Puts the pieces of a part together, in order.
    fn whole(&self, part: u64, pieces: Vec<Piece>, queue: &Queue) -> Part {
        let rows = |of: fn(&Piece) -> usize| pieces.iter().map(of).sum();
        let mut runs = Rows::with_capacity(&self.columns, rows(|piece| piece.runs.len()));
        let trace_rows = rows(|piece| piece.traces.as_ref().map_or(0, Rows::len));
        let new = || Rows::with_capacity(&self.trace_columns, trace_rows);
        let spare = || queue.state().spare.pop().unwrap_or_else(new);
        let mut traces = (!self.traces.is_empty()).then(spare);
        for piece in pieces {
            runs.append(piece.runs);
            if let (Some(traces), Some(rows)) = (&mut traces, piece.traces) {
                traces.append(rows);
            }
        }
        Part { part, runs, traces }
    }
}

/// The rows of some consecutive points.
struct Piece {
    points: u64,
    runs: Rows,
    traces: Option<Rows>,
}

/// A part, ready to be written.
struct Part {
    part: u64,
    runs: Rows,
    traces: Option<Rows>,
}

/// Where threads take points and leave what came of them.
struct Queue<'s> {
    study: &'s Study,
    /// Rows of traces that a point has at most.
    trace_rows: u64,
    /// Points that a thread takes at a time.
    chunk: u64,
    state: Mutex<QueueState<'s>>,
}

struct QueueState<'s> {
    /// Parts of which no point has been taken.
    left: Box<dyn Iterator<Item = u64> + Send + 's>,
    /// The part that points are taken from, and those that are left of it.
    points: (u64, Range<u64>),
    /// Pieces of incomplete parts: by part, then by first point.
    pieces: BTreeMap<u64, BTreeMap<u64, Piece>>,
    /// Tables of traces that have been written, empty: room for so many rows is costly to get anew.
    spare: Vec<Rows>,
}

impl<'s> Queue<'s> {
    /// The next points of a part.
    fn take(&self) -> Option<(u64, Range<u64>)> {
        let mut state = self.state();
        if state.points.1.is_empty() {
            let part = state.left.next()?;
            state.points = (part, self.study.part_points(part));
        }
        let (part, rest) = &mut state.points;
        let from = rest.start;
        rest.start = rest.end.min(from.saturating_add(self.chunk));
        Some((*part, from..rest.start))
    }

    /// Leaves a piece; all pieces of its part, in order, if it was the last one.
    fn give(&self, part: u64, from: u64, piece: Piece) -> Option<Vec<Piece>> {
        let points = self.study.part_points(part);
        let mut state = self.state();
        let pieces = state.pieces.entry(part).or_default();
        pieces.insert(from, piece);
        let there: u64 = pieces.values().map(|piece| piece.points).sum();
        if there < points.end - points.start {
            return None;
        }
        let pieces = state.pieces.remove(&part)?;
        Some(pieces.into_values().collect())
    }

    /// Writes a part, and keeps the room of its traces.
    fn write(&self, part: Part, sink: &dyn PartWriter) -> Result<(), Problem> {
        sink.write(part.part, &part.runs, part.traces.as_ref())?;
        if let Some(mut rows) = part.traces {
            rows.clear();
            self.state().spare.push(rows);
        }
        Ok(())
    }

    /// Nothing is left to take.
    fn clear(&self) {
        let mut state = self.state();
        state.left = Box::new(std::iter::empty());
        state.points = (0, 0..0);
    }

    fn state(&self) -> MutexGuard<'_, QueueState<'s>> {
        // A thread that has panicked ends the study in any case.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Plan;
    use cvtcycle_output::progress::NoProgress;

    /// Keeps the rows of every part in words: a missing number is equal to another.
    #[derive(Default)]
    struct Shelf(Mutex<BTreeMap<u64, String>>);

    impl PartWriter for Shelf {
        fn write(&self, part: u64, runs: &Rows, _: Option<&Rows>) -> Result<(), Problem> {
            let mut parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            assert!(
                parts.insert(part, format!("{runs:?}")).is_none(),
                "{part} twice"
            );
            Ok(())
        }
    }

    #[test]
    fn where_no_thread_can_start_those_that_drive_write_the_same_parts() {
        let text = "[study]\nbaselines = []\ncycle = \"ece15\"\ndesign = \"grid\"\n\
            [[factor]]\nkey = \"ambient_degc\"\nrange = { from = 0, to = 39, step = 1 }\n";
        let plan = Plan::read("p.toml", text).expect("a plan");
        let study = Study::prepare(plan).expect("a study");
        // No system has room for such a stack.
        let none = thread::Builder::new().stack_size(usize::MAX / 4);
        let shelves = [none, thread::Builder::new()].map(|writing| {
            let shelf = Shelf::default();
            let end = study.execute_with(writing, &BTreeSet::new(), &shelf, &NoProgress);
            assert_eq!(end.expect("written"), End::Complete);
            shelf.0.into_inner().expect("whole")
        });
        assert_eq!(shelves[0].len() as u64, study.parts());
        assert_eq!(shelves[0], shelves[1]);
    }
}
