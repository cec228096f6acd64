//! A trace as a Parquet file.

use std::io::{self, Write};

use super::RowWriter;
use super::parquet::ParquetTable;
use crate::table::{Head, Rows};
use crate::traces::SharedWords;
use cvtcycle_output::Row;
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
