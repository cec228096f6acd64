//! A study on all cores: points go to the threads in order, a few at a time; the thread that drives the last one of a part puts the part
//! together. No thread waits for another at the end of a part.
//!
//! How the points fall into parts follows from the plan alone, so that the same parts come out on any number of threads and after any
//! interruption. Memory holds a few parts, whatever the number of points.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::filler::Filler;
use super::point::Worker;
use super::prepare::Study;
use super::progress::Progress;
use super::table::Rows;
use super::traces::Traces;
use cvtcycle_config::Problem;

/// Least number of points that a thread takes at a time, and the number of such takings that a larger part is divided into. What comes out
/// does not depend on them.
const MIN_CHUNK: u64 = 2;
const CHUNKS: u64 = 64;
/// Most points of a part, and the number of parts that a small study is divided into at least.
const MAX_POINTS: u64 = 4096;
const PARTS: u64 = 32;
/// Most rows of traces in a part.
const MAX_TRACE_ROWS: u64 = 50_000;

/// Where whole parts go: in no certain order, and several at once.
pub trait PartWriter: Sync {
    /// Takes a part, whole or not at all.
    ///
    /// # Errors
    /// What is in the way; the study then stops.
    fn write(&self, part: u64, runs: &Rows, trace: Option<&Rows>) -> Result<(), Problem>;
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
    #[must_use]
    pub fn points_per_part(&self) -> u64 {
        let small = self.points.div_ceil(PARTS).clamp(1, MAX_POINTS);
        if self.traces.is_empty() {
            return small;
        }
        let per_point = self.trace_rows_per_point().max(1);
        small.min((MAX_TRACE_ROWS / per_point).max(1))
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
            let automatic = car
                .setups(&self.plan.factors)
                .any(|setup| setup.transmission().is_cvt());
            let steps = self
                .cycles
                .iter()
                .map(|cycle| cycle.trace_for(automatic).step_count(self.plan.base.dt_s));
            steps.max().unwrap_or(0) as u64
        };
        self.cars.iter().map(rows).sum()
    }

    /// Computes the parts that are not in `done` and gives them to the sink. Uses the threads of the pool in which it is called, and one
    /// more that writes; where writing takes longer than driving, the threads of the pool write as well.
    ///
    /// # Errors
    /// The sink's problem.
    pub fn execute(
        &self,
        done: &BTreeSet<u64>,
        sink: &dyn PartWriter,
        progress: &dyn Progress,
    ) -> Result<End, Problem> {
        let left = (0..self.parts()).filter(|part| !done.contains(part));
        let papers = Papers {
            left: Box::new(left),
            points: (0, 0..0),
            pieces: BTreeMap::new(),
            spare: Vec::new(),
        };
        let chunk = (self.points_per_part() / CHUNKS).max(MIN_CHUNK);
        let desk = Desk {
            study: self,
            trace_rows: self.trace_rows_per_point(),
            chunk,
            papers: Mutex::new(papers),
        };
        // One part waits while another is written: enough that no thread is idle, little enough that memory stays flat.
        let (send, receive) = sync_channel::<Part>(1);
        std::thread::scope(|scope| {
            let desk = &desk;
            let writer = scope.spawn(move || {
                receive
                    .into_iter()
                    .try_for_each(|part| part.write(sink, desk))
            });
            let ends = rayon::broadcast(|_| self.work(desk, &Out { sink, send: &send }, progress));
            drop(send);
            let written = writer
                .join()
                .unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            let ends: Vec<End> = ends.into_iter().collect::<Result<_, _>>()?;
            written.map(|()| {
                if ends.contains(&End::Stopped) {
                    End::Stopped
                } else {
                    End::Complete
                }
            })
        })
    }

    /// What one thread does until nothing is left.
    fn work(&self, desk: &Desk, out: &Out, progress: &dyn Progress) -> Result<End, Problem> {
        let mut worker = Worker::default();
        while let Some((part, points)) = desk.take() {
            let from = points.start;
            let Some(piece) = self.piece(points, desk.trace_rows, &mut worker, progress) else {
                desk.clear();
                return Ok(End::Stopped);
            };
            let Some(pieces) = desk.give(part, from, piece) else {
                continue;
            };
            let taken = out.put(self.whole(part, pieces, desk), desk);
            if !matches!(taken, Ok(true)) {
                desk.clear();
            }
            taken?;
        }
        Ok(End::Complete)
    }

    /// Drives some points; nothing if the progress has stopped it.
    fn piece(
        &self,
        points: Range<u64>,
        trace_rows: u64,
        worker: &mut Worker,
        progress: &dyn Progress,
    ) -> Option<Piece> {
        let count = points.end - points.start;
        let rows_of =
            |per_point: u64| usize::try_from(count.saturating_mul(per_point)).unwrap_or(0);
        let filler = Filler::new(self);
        let mut runs = Rows::with_capacity(&self.columns, rows_of(self.cars.len() as u64));
        let mut traces = Traces::new(self, || rows_of(trace_rows));
        for point in points {
            if progress.stopped() {
                return None;
            }
            filler.push(
                point,
                &self.point(point, worker, traces.as_mut()),
                &mut runs,
            );
            progress.advance(self.cars.len() as u64);
        }
        Some(Piece {
            points: count,
            runs,
            traces: traces.map(Traces::into_rows),
        })
    }

    /// Puts the pieces of a part together, in order.
    fn whole(&self, part: u64, pieces: Vec<Piece>, desk: &Desk) -> Part {
        let rows = |of: fn(&Piece) -> usize| pieces.iter().map(of).sum();
        let mut runs = Rows::with_capacity(&self.columns, rows(|piece| piece.runs.len()));
        let trace_rows = rows(|piece| piece.traces.as_ref().map_or(0, Rows::len));
        let new = || Rows::with_capacity(&self.trace_columns, trace_rows);
        let mut traces =
            (!self.traces.is_empty()).then(|| desk.papers().spare.pop().unwrap_or_else(new));
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

impl Part {
    fn write(self, sink: &dyn PartWriter, desk: &Desk) -> Result<(), Problem> {
        sink.write(self.part, &self.runs, self.traces.as_ref())?;
        if let Some(mut rows) = self.traces {
            rows.clear();
            desk.papers().spare.push(rows);
        }
        Ok(())
    }
}

/// The way of a part to the sink.
struct Out<'a> {
    sink: &'a dyn PartWriter,
    send: &'a SyncSender<Part>,
}

impl Out<'_> {
    /// Hands a part to the writer, or writes it where the writer is behind. False if the writer has failed and takes nothing more; its
    /// problem comes with its end.
    fn put(&self, part: Part, desk: &Desk) -> Result<bool, Problem> {
        match self.send.try_send(part) {
            Ok(()) => Ok(true),
            Err(TrySendError::Full(part)) => part.write(self.sink, desk).map(|()| true),
            Err(TrySendError::Disconnected(_)) => Ok(false),
        }
    }
}

/// Where threads take points and leave what came of them.
struct Desk<'s> {
    study: &'s Study,
    /// Rows of traces that a point has at most.
    trace_rows: u64,
    /// Points that a thread takes at a time.
    chunk: u64,
    papers: Mutex<Papers<'s>>,
}

struct Papers<'s> {
    /// Parts of which no point has been taken.
    left: Box<dyn Iterator<Item = u64> + Send + 's>,
    /// The part that points are taken from, and those that are left of it.
    points: (u64, Range<u64>),
    /// Of every part that is not whole its pieces, by their first point.
    pieces: BTreeMap<u64, BTreeMap<u64, Piece>>,
    /// Tables of traces that have been written, empty: room for so many rows is costly to get anew.
    spare: Vec<Rows>,
}

impl<'s> Desk<'s> {
    /// The next points of a part.
    fn take(&self) -> Option<(u64, Range<u64>)> {
        let mut papers = self.papers();
        if papers.points.1.is_empty() {
            let part = papers.left.next()?;
            papers.points = (part, self.study.part_points(part));
        }
        let (part, rest) = &mut papers.points;
        let from = rest.start;
        rest.start = rest.end.min(from.saturating_add(self.chunk));
        Some((*part, from..rest.start))
    }

    /// Leaves a piece; all pieces of its part, in order, if it was the last one.
    fn give(&self, part: u64, from: u64, piece: Piece) -> Option<Vec<Piece>> {
        let points = self.study.part_points(part);
        let mut papers = self.papers();
        let pieces = papers.pieces.entry(part).or_default();
        pieces.insert(from, piece);
        if pieces.values().map(|piece| piece.points).sum::<u64>() < points.end - points.start {
            return None;
        }
        papers
            .pieces
            .remove(&part)
            .map(|pieces| pieces.into_values().collect())
    }

    /// Nothing is left to take.
    fn clear(&self) {
        let mut papers = self.papers();
        papers.left = Box::new(std::iter::empty());
        papers.points = (0, 0..0);
    }

    fn papers(&self) -> MutexGuard<'_, Papers<'s>> {
        // A thread that has panicked ends the study in any case.
        self.papers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
