//! A trace as a Parquet file.

use std::io::{self, Write};
use std::sync::Arc;

use super::RowWriter;
use super::parquet::ParquetTable;
use super::table::{Head, Rows, Values};
use cvtcycle_output::Row;
use cvtcycle_output::table::Cell;
use cvtcycle_output::trace::TraceColumn;

/// Rows of a row group.
const GROUP: usize = 1 << 16;

/// Writes the rows of a run as Parquet, with the columns and cells of its CSV.
///
/// # Errors
/// Those of `out`.
pub fn write_trace_parquet<W: Write + Send>(
    out: W,
    columns: &[&'static TraceColumn],
    rows: &[Row],
    phases: &[String],
) -> io::Result<()> {
    let heads: Vec<Head> = columns.iter().map(|column| column.head()).collect();
    let mut words = SharedWords::default();
    let mut cells = |rows: &[Row]| {
        let mut cells = Rows::with_capacity(&heads, rows.len());
        words.push(columns, rows, phases, cells.values.iter_mut());
        cells
    };
    let mut groups = rows.chunks(GROUP);
    let first = cells(groups.next().unwrap_or_default());
    let mut table = Box::new(ParquetTable::new(out, &heads, &[], &first)?);
    table.write(&first)?;
    groups.try_for_each(|group| table.write(&cells(group)))?;
    table.finish()
}

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
