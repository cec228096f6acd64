//! Rows of runs as cells of columns: of the table of traces while a study runs, and of a trace file.

use std::sync::Arc;

use super::cars::StudyCar;
use super::prepare::Study;
use super::table::{Rows, Values};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_output::Row;
use cvtcycle_output::table::Cell;
use cvtcycle_output::trace::TraceColumn;

/// Words of a run, each kept once.
#[derive(Default)]
pub(crate) struct SharedWords(Vec<(Cell, Arc<str>)>);

impl SharedWords {
    /// The text of a cell; equal cells share it.
    fn text(&mut self, cell: Cell, phases: &[String]) -> Arc<str> {
        if let Some((_, text)) = self.0.iter().find(|(other, _)| *other == cell) {
            return text.clone();
        }
        let mut text = String::new();
        cell.push(&mut text, phases);
        let text: Arc<str> = text.into();
        self.0.push((cell, text.clone()));
        text
    }

    /// Appends the cells of some rows of one run to the columns of a table.
    pub fn push<'v>(
        &mut self,
        columns: &[&TraceColumn],
        rows: &[Row],
        phases: &[String],
        values: impl Iterator<Item = &'v mut Values>,
    ) {
        for (column, cells) in columns.iter().zip(values) {
            match cells {
                Values::Number(cells) => column.numbers(rows, cells),
                Values::Count(cells) => {
                    cells.extend(rows.iter().map(|row| count(&column.cell(row))))
                }
                Values::Text(cells) => {
                    cells.extend(rows.iter().map(|row| self.text(column.cell(row), phases)));
                }
            }
        }
    }
}

fn count(cell: &Cell) -> i64 {
    match cell {
        Cell::Count(n) => i64::try_from(*n).unwrap_or(i64::MAX),
        _ => 0,
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
