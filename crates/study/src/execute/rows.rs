//! Rows of the table of runs, and of the table of traces while their cars drive.

use std::sync::Arc;

use super::cars::StudyCar;
use super::prepare::Study;
use crate::plan::FactorValue;
use crate::store::{Rows, SharedWords, Values};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_output::Row;
use cvtcycle_output::trace::TraceColumn;

/// Why a run has no numbers, or numbers that failed a check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Status {
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

/// Puts the runs of consecutive points into rows of the table of runs.
pub(super) struct Filler<'s> {
    study: &'s Study,
    /// Words of many rows, each held once.
    empty: Arc<str>,
    ok: Arc<str>,
}

impl<'s> Filler<'s> {
    pub fn new(study: &'s Study) -> Self {
        Filler {
            study,
            empty: "".into(),
            ok: "ok".into(),
        }
    }

    /// Appends the runs of a point.
    pub fn push(&self, point: u64, runs: &[PointRun], rows: &mut Rows) {
        for (car, run) in self.study.cars.iter().zip(runs) {
            let word = |text: &str| match text {
                "" => self.empty.clone(),
                "ok" => self.ok.clone(),
                text => Arc::from(text),
            };
            let mut columns = rows.values.iter_mut();
            let head = [
                car.name.clone(),
                car.role.clone(),
                word(run.status.word()),
                word(run.status.reason()),
            ];
            if let Some(Values::Count(cells)) = columns.next() {
                cells.push(i64::try_from(point).unwrap_or(i64::MAX));
            }
            for text in head {
                if let Some(Values::Text(cells)) = columns.next() {
                    cells.push(text);
                }
            }
            for (factors, cells) in self.study.factor_columns.iter().zip(columns.by_ref()) {
                let value = factors.iter().find_map(|&f| run.factors[f].as_ref());
                match (cells, value) {
                    (Values::Number(cells), Some(FactorValue::Number(x))) => cells.push(*x),
                    (Values::Number(cells), _) => cells.push(f64::NAN),
                    (Values::Text(cells), Some(value)) => cells.push(value.text()),
                    (Values::Text(cells), None) => cells.push(self.empty.clone()),
                    (Values::Count(cells), _) => cells.push(0),
                }
            }
            for (cells, number) in columns.zip(&run.numbers) {
                if let Values::Number(cells) = cells {
                    cells.push(*number);
                }
            }
        }
    }
}

/// The table of traces of some consecutive points.
pub(super) struct Traces<'s> {
    columns: &'s [&'static TraceColumn],
    rows: Rows,
    point: i64,
    /// A copy of this table alone: threads that count references to one word at once slow each other down.
    car: Arc<str>,
    words: SharedWords,
}

impl<'s> Traces<'s> {
    /// No rows yet, with room for a number of them; none if the study keeps no traces.
    pub fn new(study: &'s Study, rows: impl Fn() -> usize) -> Option<Self> {
        let traces = || Traces {
            columns: &study.traces,
            rows: Rows::with_capacity(&study.trace_columns, rows()),
            point: 0,
            car: "".into(),
            words: SharedWords::default(),
        };
        (!study.traces.is_empty()).then(traces)
    }

    /// The following rows belong to a car at a point.
    pub fn begin(&mut self, point: u64, car: &StudyCar) {
        self.point = i64::try_from(point).unwrap_or(i64::MAX);
        self.car = Arc::from(&*car.name);
        self.words = SharedWords::default();
    }

    /// Appends rows of a run through a cycle.
    pub fn push(&mut self, cycle: &Cycle, rows: &[Row]) {
        let phases = if cycle.phases.is_empty() {
            std::slice::from_ref(&cycle.name)
        } else {
            &cycle.phases
        };
        let mut columns = self.rows.values.iter_mut();
        if let Some(Values::Count(cells)) = columns.next() {
            cells.resize(cells.len() + rows.len(), self.point);
        }
        if let Some(Values::Text(cells)) = columns.next() {
            cells.resize(cells.len() + rows.len(), self.car.clone());
        }
        self.words.push(self.columns, rows, phases, columns);
    }

    /// The table.
    pub fn into_rows(self) -> Rows {
        self.rows
    }
}
