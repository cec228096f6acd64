//! Rows of runs as cells of the table of traces, some at a time as they are driven, so that no run's rows need be kept.

use std::sync::Arc;

use super::cars::StudyCar;
use super::prepare::Study;
use super::table::{Rows, Values};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_output::Row;
use cvtcycle_output::columns::{Column, Value};
use cvtcycle_output::trace::push_value;

/// The table of traces of some consecutive points.
pub(super) struct Traces<'s> {
    columns: &'s [&'static Column],
    rows: Rows,
    point: i64,
    /// Of this table alone: counting who shares a word is slow where threads do it at once.
    car: Arc<str>,
    /// Words of the run that is driven, each held once.
    words: Vec<(Value, Arc<str>)>,
}

impl<'s> Traces<'s> {
    /// No rows yet, with room for a number of them; nothing if the study keeps none.
    pub fn new(study: &'s Study, rows: impl Fn() -> usize) -> Option<Self> {
        let traces = || Traces {
            columns: &study.traces,
            rows: Rows::with_capacity(&study.trace_columns, rows()),
            point: 0,
            car: "".into(),
            words: Vec::new(),
        };
        (!study.traces.is_empty()).then(traces)
    }

    /// What follows belongs to a car at a point.
    pub fn begin(&mut self, point: u64, car: &StudyCar) {
        self.point = i64::try_from(point).unwrap_or(i64::MAX);
        self.car = Arc::from(&*car.name);
        self.words.clear();
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
        for (column, cells) in self.columns.iter().zip(columns) {
            match cells {
                Values::Number(cells) => (column.numbers)(rows, cells),
                Values::Count(cells) => {
                    cells.extend(rows.iter().map(|row| count((column.get)(row))))
                }
                Values::Text(cells) => cells.extend(
                    rows.iter()
                        .map(|row| shared((column.get)(row), phases, &mut self.words)),
                ),
            }
        }
    }

    /// The table.
    pub fn into_rows(self) -> Rows {
        self.rows
    }
}

fn count(value: Value) -> i64 {
    match value {
        Value::Count(n) => i64::from(n),
        _ => 0,
    }
}

/// The text of a cell; the same value shares it.
fn shared(value: Value, phases: &[String], known: &mut Vec<(Value, Arc<str>)>) -> Arc<str> {
    if let Some((_, text)) = known.iter().find(|(other, _)| *other == value) {
        return text.clone();
    }
    let mut text = String::new();
    push_value(&mut text, value, phases);
    let text: Arc<str> = text.into();
    known.push((value, text.clone()));
    text
}
