//! Rows to CSV and JSON, kept aside until all of them are good.

use std::io::{self, BufWriter, Seek, SeekFrom, Write};

use cvtcycle::config::{Problem, Problems};
use cvtcycle::output::file::OutputFile;
use cvtcycle::output::number::push_exact;
use cvtcycle::output::table::{Cell, Column, json_row};
use cvtcycle::study::points::{OUTPUTS, Point, Solved, Take, output_columns};
use tempfile::{SpooledTempFile, spooled_tempfile};

use crate::print::problem;
use crate::print::stream;

/// Up to this size what goes to standard output waits in memory, beyond it on disk.
const IN_MEMORY: usize = 1 << 20;

/// Where a table waits for its end.
#[derive(Debug)]
enum Place {
    File(Box<OutputFile>),
    Spool(BufWriter<SpooledTempFile>),
}

impl Place {
    fn spool() -> Self {
        Place::Spool(BufWriter::new(spooled_tempfile(IN_MEMORY)))
    }

    fn put(&mut self, text: &str) -> Result<(), Problems> {
        match self {
            Place::File(file) => file
                .write_all(text.as_bytes())
                .map_err(|error| file.cannot_write(&error).into()),
            Place::Spool(spool) => spool
                .write_all(text.as_bytes())
                .map_err(|error| unspooled(&error).into()),
        }
    }
}

/// Where rows may go, once there are some.
#[derive(Debug)]
pub struct Offer {
    file: Option<OutputFile>,
    json: bool,
    /// None as long as there is no good line of names.
    pub sink: Option<Sink>,
}

impl Offer {
    /// CSV to the file if there is one, else to standard output unless `json` goes there.
    pub fn new(file: Option<OutputFile>, json: bool) -> Self {
        Offer {
            file,
            json,
            sink: None,
        }
    }
}

impl Take for Offer {
    fn begin(&mut self, with_case: bool) -> Result<(), Problems> {
        self.sink = Some(Sink::new(self.file.take(), self.json, with_case)?);
        Ok(())
    }

    fn put(&mut self, case: &str, row: &Solved) -> Result<(), Problems> {
        self.sink
            .as_mut()
            .map_or(Ok(()), |sink| sink.put(case, row))
    }
}

/// The outputs of a run over points.
#[derive(Debug)]
pub struct Sink {
    csv: Option<Place>,
    json: Option<Place>,
    columns: Vec<Column<Point>>,
    rows: u64,
    line: String,
}

impl Sink {
    fn new(file: Option<OutputFile>, json: bool, with_case: bool) -> Result<Self, Problems> {
        let csv = file.map(|file| Place::File(Box::new(file)));
        let csv = if csv.is_none() && !json {
            Some(Place::spool())
        } else {
            csv
        };
        let mut sink = Sink {
            csv,
            json: json.then(Place::spool),
            columns: output_columns(with_case),
            rows: 0,
            line: String::new(),
        };
        if let Some(csv) = &mut sink.csv {
            let names: Vec<&str> = sink.columns.iter().map(|column| &*column.name).collect();
            csv.put(&(names.join(",") + "\n"))?;
        }
        Ok(sink)
    }

    /// Adds a row.
    pub fn put(&mut self, case: &str, row: &Solved) -> Result<(), Problems> {
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

    /// Gives the file its name and sends the rest to standard output, JSON after its `head` (an object without rows).
    pub fn finish(self, head: &serde_json::Map<String, serde_json::Value>) -> Result<(), Problems> {
        match self.csv {
            Some(Place::File(file)) => drop(file.commit()?),
            Some(Place::Spool(spool)) => send(spool, "", "")?,
            None => {}
        }
        if let Some(Place::Spool(spool)) = self.json {
            let head = serde_json::Value::Object(head.clone()).to_string();
            let open = head.strip_suffix('}').unwrap_or(&head);
            send(spool, &format!("{open},\"rows\":["), "\n]}\n")?;
        }
        Ok(())
    }
}

/// A row as CSV: `;` between flags, and `NaN` where a point has no solution.
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

/// Sends what was kept aside to standard output.
fn send(spool: BufWriter<SpooledTempFile>, before: &str, after: &str) -> Result<(), Problems> {
    let kept = spool
        .into_inner()
        .map_err(io::IntoInnerError::into_error)
        .and_then(|mut kept| kept.seek(SeekFrom::Start(0)).map(|_| kept));
    let mut kept = kept.map_err(|error| unspooled(&error))?;
    stream::to_stdout(|out| {
        out.write_all(before.as_bytes())?;
        io::copy(&mut kept, out)?;
        out.write_all(after.as_bytes())
    })
}

fn unspooled(error: &io::Error) -> Problem {
    let hint = "the table is kept aside until it is complete: free some space there, or write to a file with --out";
    problem(
        "standard output",
        &format!("cannot write in the folder of temporary files: {error}"),
        hint,
    )
}
