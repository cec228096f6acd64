//! Tables as CSV.

use std::io::{self, Write};

use super::table::{Head, Rows, Values};
use super::{RowWriter, check_shape};
use cvtcycle_output::number::push_exact;
use cvtcycle_output::table::CsvWriter;

/// Titles of the columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Header {
    /// Names.
    Names,
    /// Names with the unit behind them, `fuel_l_per_100km [L/100 km]`, where there is one.
    Units,
}

impl Header {
    /// The text over a column.
    pub fn text(self, column: &Head) -> String {
        if self == Header::Names || column.unit.is_empty() {
            column.name.clone()
        } else {
            format!("{} [{}]", column.name, column.unit)
        }
    }
}

/// A CSV table that is written piece by piece.
///
/// Numbers read back to the same `f64`; those that are not finite, and empty words, are empty fields. Minus zero is written as zero.
pub struct CsvTable<W: Write> {
    out: CsvWriter<W>,
    columns: Vec<Head>,
}

impl<W: Write> CsvTable<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn new(out: W, columns: &[Head], header: Header) -> io::Result<Self> {
        Ok(CsvTable {
            out: CsvWriter::new(out, columns.iter().map(|column| header.text(column)))?,
            columns: columns.to_vec(),
        })
    }
}

impl<W: Write> RowWriter for CsvTable<W> {
    fn write(&mut self, rows: &Rows) -> io::Result<()> {
        check_shape(&self.columns, rows)?;
        (0..rows.len()).try_for_each(|row| {
            self.out.row(&rows.values, |values, text| match values {
                Values::Number(numbers) if !numbers[row].is_finite() => {}
                Values::Number(numbers) => push_exact(text, numbers[row]),
                Values::Count(counts) => *text += &counts[row].to_string(),
                Values::Text(words) => *text += &words[row],
            })
        })
    }

    fn finish(self: Box<Self>) -> io::Result<()> {
        self.out.finish()
    }
}

/// Writes a whole table as CSV under the names of its columns.
///
/// # Errors
/// Those of [`CsvTable`].
pub fn write_csv<W: Write>(out: W, columns: &[Head], rows: &Rows) -> io::Result<()> {
    let mut table = Box::new(CsvTable::new(out, columns, Header::Names)?);
    table.write(rows)?;
    table.finish()
}
