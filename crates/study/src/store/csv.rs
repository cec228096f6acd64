//! Tables as CSV.

use std::io::{self, Write};

use super::check_shape;
use crate::table::{Column, Rows, Values};
use cvtcycle_output::columns::Value;
use cvtcycle_output::trace::{csv_error, push_value};

/// What stands over the columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Header {
    /// Names.
    Names,
    /// Names with the unit behind them, `fuel_l_per_100km [L/100 km]`, where there is one.
    Units,
}

impl Header {
    /// The text over a column.
    #[must_use]
    pub fn of(self, column: &Column) -> String {
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
    out: csv::Writer<W>,
    columns: Vec<Column>,
}

impl<W: Write> CsvTable<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// Whatever `out` reports.
    pub fn new(out: W, columns: &[Column], header: Header) -> io::Result<Self> {
        let mut out = csv::Writer::from_writer(out);
        out.write_record(columns.iter().map(|column| header.of(column)))
            .map_err(csv_error)?;
        Ok(CsvTable {
            out,
            columns: columns.to_vec(),
        })
    }

    /// Writes some rows.
    ///
    /// # Errors
    /// Whatever `out` reports; [`io::ErrorKind::InvalidInput`] for rows of another table.
    pub fn write(&mut self, rows: &Rows) -> io::Result<()> {
        check_shape(&self.columns, rows)?;
        let mut text = String::new();
        for row in 0..rows.len() {
            for values in &rows.values {
                text.clear();
                match values {
                    Values::Number(numbers) => {
                        push_value(&mut text, Value::Number(numbers[row]), &[])
                    }
                    Values::Count(counts) => text += &counts[row].to_string(),
                    Values::Text(words) => text += &words[row],
                }
                self.out.write_field(&text).map_err(csv_error)?;
            }
            self.out.write_record(None::<&[u8]>).map_err(csv_error)?;
        }
        Ok(())
    }

    /// Hands everything on.
    ///
    /// # Errors
    /// Whatever `out` reports.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Writes a whole table as CSV under the names of its columns.
///
/// # Errors
/// Those of [`CsvTable`].
pub fn write_csv<W: Write>(out: W, columns: &[Column], rows: &Rows) -> io::Result<()> {
    let mut table = CsvTable::new(out, columns, Header::Names)?;
    table.write(rows)?;
    table.finish()
}
