//! Writers of tables: CSV and JSON.

use std::borrow::Borrow;
use std::io::{self, Write};

use serde_json::{Value as Json, json};

use super::Column;

/// CSV writer, row by row. Numbers read back to the same `f64`.
pub struct CsvWriter<W: Write> {
    out: csv::Writer<W>,
    text: String,
}

impl<W: Write> CsvWriter<W> {
    /// Writes the names of the columns.
    ///
    /// # Errors
    /// I/O errors of `out`.
    pub fn new<T: AsRef<[u8]>>(out: W, names: impl IntoIterator<Item = T>) -> io::Result<Self> {
        let mut out = csv::Writer::from_writer(out);
        out.write_record(names).map_err(csv_error)?;
        Ok(CsvWriter {
            out,
            text: String::new(),
        })
    }

    /// Writes a row; each cell appends its text.
    ///
    /// # Errors
    /// I/O errors of `out`.
    pub fn row<T>(
        &mut self,
        cells: impl IntoIterator<Item = T>,
        push: impl Fn(T, &mut String),
    ) -> io::Result<()> {
        for cell in cells {
            self.text.clear();
            push(cell, &mut self.text);
            self.out.write_field(&self.text).map_err(csv_error)?;
        }
        self.out.write_record(None::<&[u8]>).map_err(csv_error)
    }

    /// Flushes the output.
    ///
    /// # Errors
    /// I/O errors of `out`.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Unwraps the operating system's error from one of CSV, which says that the disk is full.
fn csv_error(error: csv::Error) -> io::Error {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error,
        other => io::Error::other(format!("{other:?}")),
    }
}

/// Writes names and rows as CSV. `phases` are the names of phases that cells refer to.
///
/// # Errors
/// I/O errors of `out`.
pub fn write_csv<R, C: Borrow<Column<R>>, I: Borrow<R>>(
    out: impl Write,
    columns: &[C],
    rows: impl IntoIterator<Item = I>,
    phases: &[String],
) -> io::Result<()> {
    let names = columns.iter().map(|column| column.borrow().name.as_bytes());
    let mut csv = CsvWriter::new(out, names)?;
    for row in rows {
        csv.row(columns, |column, text| {
            column.borrow().cell(row.borrow()).push(text, phases);
        })?;
    }
    csv.finish()
}

/// Formats rows as CSV in memory; `None` if there are no rows.
pub fn csv_bytes<R>(columns: &[Column<R>], rows: &[R]) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let written = write_csv(&mut bytes, columns, rows, &[]);
    // Writing into memory cannot fail.
    debug_assert!(written.is_ok());
    (!rows.is_empty()).then_some(bytes)
}

/// Describes the columns: name, unit and meaning.
pub fn json_columns<R>(columns: &[Column<R>]) -> Json {
    let head = |c: &Column<R>| json!({ "name": c.name, "unit": c.unit, "meaning": c.doc });
    columns.iter().map(head).collect()
}

/// Converts a row to an object by column name.
pub fn json_row<R>(columns: &[Column<R>], row: &R) -> Json {
    let cell = |column: &Column<R>| (column.name.clone().into_owned(), column.cell(row).json());
    Json::Object(columns.iter().map(cell).collect())
}

/// Converts rows to objects.
pub fn json_rows<R>(columns: &[Column<R>], rows: &[R]) -> Json {
    rows.iter().map(|row| json_row(columns, row)).collect()
}

/// Writes an object: the entries of the object `head`, then `points`, a row a line.
///
/// # Errors
/// I/O errors of `out`.
pub fn write_json<R, I: Borrow<R>>(
    out: &mut dyn Write,
    head: &Json,
    columns: &[Column<R>],
    rows: impl IntoIterator<Item = I>,
) -> io::Result<()> {
    let head = serde_json::to_string_pretty(head)?;
    let open = head.trim_end_matches('}').trim_end();
    write!(out, "{open},\n  \"points\": [")?;
    for (k, row) in rows.into_iter().enumerate() {
        let comma = if k > 0 { "," } else { "" };
        write!(out, "{comma}\n    {}", json_row(columns, row.borrow()))?;
    }
    out.write_all(b"\n  ]\n}\n")
}
