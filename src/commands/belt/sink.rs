//! Rows to CSV and JSON, kept aside until all of them are good.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};

use cvtcycle::config::{Problem, Problems};
use cvtcycle::output::file::OutputFile;
use cvtcycle::study::points::{
    CASE, FLAGS, FORMULATION, NUMBERS, OUTPUTS, STATUS, Solved, Take, name, output_names,
};
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
    with_case: bool,
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
            with_case,
            rows: 0,
            line: String::new(),
        };
        if let Some(csv) = &mut sink.csv {
            let names: Vec<&str> = output_names(with_case).collect();
            csv.put(&(names.join(",") + "\n"))?;
        }
        Ok(sink)
    }

    /// Adds a row.
    pub fn put(&mut self, case: &str, row: &Solved) -> Result<(), Problems> {
        if let Some(csv) = &mut self.csv {
            self.line.clear();
            csv_line(&mut self.line, self.with_case.then_some(case), row);
            csv.put(&self.line)?;
        }
        if let Some(json) = &mut self.json {
            self.line.clear();
            self.line
                .push_str(if self.rows == 0 { "\n" } else { ",\n" });
            json_line(&mut self.line, self.with_case.then_some(case), row);
            json.put(&self.line)?;
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

fn csv_line(line: &mut String, case: Option<&str>, row: &Solved) {
    if let Some(case) = case {
        // Quotes within are doubled already: the text is as it stood in the input.
        let quote = if case.contains([',', '"']) { "\"" } else { "" };
        // Writing to a string cannot fail.
        let _ = write!(line, "{quote}{case}{quote},");
    }
    line.push_str(name(row.formulation));
    for number in row.numbers {
        line.push(',');
        if !number.is_nan() {
            push(line, number);
        }
    }
    for (_, value) in OUTPUTS {
        line.push(',');
        push(line, value(&row.point));
    }
    line.push(',');
    line.push_str(row.point.status.name());
    line.push(',');
    for (place, flag) in row.flags.names().enumerate() {
        line.push_str(if place > 0 { ";" } else { "" });
        line.push_str(flag);
    }
    line.push('\n');
}

fn json_line(line: &mut String, case: Option<&str>, row: &Solved) {
    line.push('{');
    if let Some(case) = case {
        let _ = write!(
            line,
            "\"{CASE}\":{},",
            serde_json::Value::from(case.replace("\"\"", "\""))
        );
    }
    let _ = write!(line, "\"{FORMULATION}\":\"{}\"", name(row.formulation));
    let given = NUMBERS.iter().map(|number| number.name).zip(row.numbers);
    for (key, number) in given.chain(OUTPUTS.iter().map(|(key, value)| (*key, value(&row.point)))) {
        let _ = write!(line, ",\"{key}\":");
        if number.is_finite() {
            push(line, number);
        } else {
            line.push_str("null");
        }
    }
    let flags: Vec<&str> = row.flags.names().collect();
    let _ = write!(
        line,
        ",\"{STATUS}\":\"{}\",\"{FLAGS}\":{}}}",
        row.point.status.name(),
        serde_json::Value::from(flags)
    );
}

/// A number in the fewest digits that read back to the same; -0 as 0, what is none as `NaN`.
fn push(line: &mut String, number: f64) {
    let number = number + 0.0;
    let plain = (1e-5..1e15).contains(&number.abs()) || number.abs() <= 0.0 || !number.is_finite();
    let _ = if plain {
        write!(line, "{number}")
    } else {
        write!(line, "{number:e}")
    };
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
