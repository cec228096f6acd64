//! Rows as CSV and JSON, buffered until the last one is checked.

use std::io::{self, BufWriter, Seek, SeekFrom, Write};

use cvtcycle::config::{Problem, Problems};
use cvtcycle::output::file::OutputFile;
use cvtcycle::output::number::push_exact;
use cvtcycle::output::table::{Cell, Column, json_row};
use cvtcycle::validate::belt::{OUTPUTS, Point, Solved, Take, output_columns};
use tempfile::{SpooledTempFile, spooled_tempfile};

use crate::args::problems::problem;
use crate::print::{Form, Paint, to_stdout};

/// Buffer size in memory for standard output; the rest is buffered on disk.
const MAX_IN_MEMORY: usize = 1 << 20;

/// Buffer of a table.
#[derive(Debug)]
enum Buffer {
    File(Box<OutputFile>),
    Spool(BufWriter<SpooledTempFile>),
}

impl Buffer {
    fn spool() -> Self {
        Buffer::Spool(BufWriter::new(spooled_tempfile(MAX_IN_MEMORY)))
    }

    fn put(&mut self, text: &str) -> Result<(), Problems> {
        let bytes = text.as_bytes();
        match self {
            Buffer::File(file) => file
                .write_all(bytes)
                .map_err(|error| file.cannot_write(&error)),
            Buffer::Spool(spool) => spool
                .write_all(bytes)
                .map_err(|error| cannot_buffer(&error)),
        }
        .map_err(Problems::from)
    }
}

/// Rows of a table of points. CSV goes to the file if there is one, else to standard output unless JSON goes there.
#[derive(Debug)]
pub struct RowSink {
    csv: Option<Buffer>,
    json: Option<Buffer>,
    /// Columns, set when the header of the input is read.
    columns: Vec<Column<Point>>,
    rows: u64,
    line: String,
}

impl Take for RowSink {
    fn begin(&mut self, with_case: bool) -> Result<(), Problems> {
        self.columns = output_columns(with_case);
        let names: Vec<&str> = self.columns.iter().map(|column| &*column.name).collect();
        let csv = self.csv.as_mut();
        csv.map_or(Ok(()), |csv| csv.put(&(names.join(",") + "\n")))
    }

    fn put(&mut self, case: &str, row: &Solved) -> Result<(), Problems> {
        let row = (case.replace("\"\"", "\""), *row);
        if let Some(csv) = &mut self.csv {
            self.line.clear();
            csv_line(&mut self.line, &self.columns, &row);
            csv.put(&self.line)?;
        }
        if let Some(json) = &mut self.json {
            let comma = if self.rows == 0 { "\n" } else { ",\n" };
            json.put(&format!("{comma}{}", json_row(&self.columns, &row)))?;
        }
        self.rows += 1;
        Ok(())
    }
}

impl RowSink {
    /// Creates an empty sink.
    pub fn new(file: Option<OutputFile>, json: bool) -> Self {
        let file = file.map(|file| Buffer::File(Box::new(file)));
        RowSink {
            csv: file.or_else(|| (!json).then(Buffer::spool)),
            json: json.then(Buffer::spool),
            columns: Vec::new(),
            rows: 0,
            line: String::new(),
        }
    }

    /// Commits the file and sends the rest to standard output: JSON after its `head` (an object without rows).
    pub fn finish(self, head: &serde_json::Value) -> Result<(), Problems> {
        match self.csv {
            Some(Buffer::File(file)) => drop(file.commit()?),
            Some(Buffer::Spool(spool)) => send(Form::Text(Paint::NONE), spool, "", "")?,
            None => {}
        }
        if let Some(Buffer::Spool(spool)) = self.json {
            let head = head.to_string();
            let open = head.strip_suffix('}').unwrap_or(&head);
            send(Form::Json, spool, &format!("{open},\"rows\":["), "\n]}\n")?;
        }
        Ok(())
    }
}

/// Formats a row as CSV, with `;` between flags and `NaN` for a point without solution.
fn csv_line(line: &mut String, columns: &[Column<Point>], row: &Point) {
    let given = columns.len() - OUTPUTS.len();
    for (k, column) in columns.iter().enumerate() {
        if k > 0 {
            line.push(',');
        }
        match column.cell(row) {
            Cell::Number(x) if x.is_nan() && k < given => {}
            Cell::Number(x) => push_exact(line, x),
            Cell::Names(names) => line.push_str(&names.join(";")),
            Cell::Text(words) if words.contains([',', '"']) => {
                *line += &format!("\"{}\"", words.replace('"', "\"\""));
            }
            cell => cell.push(line, &[]),
        }
    }
    line.push('\n');
}

/// Copies a buffer to standard output.
fn send(
    form: Form,
    spool: BufWriter<SpooledTempFile>,
    before: &str,
    after: &str,
) -> Result<(), Problems> {
    let kept = spool
        .into_inner()
        .map_err(io::IntoInnerError::into_error)
        .and_then(|mut kept| kept.seek(SeekFrom::Start(0)).map(|_| kept));
    let mut kept = kept.map_err(|error| cannot_buffer(&error))?;
    to_stdout(form, |out| {
        out.write_all(before.as_bytes())?;
        io::copy(&mut kept, out)?;
        out.write_all(after.as_bytes())
    })
}

fn cannot_buffer(error: &io::Error) -> Problem {
    let hint = "the table is buffered there until it is complete: free some space, or write to a file with --out";
    problem(
        "standard output",
        &format!("cannot write in the folder of temporary files: {error}"),
        hint,
    )
}
