//! Reads a `trace_*.csv` of this program into a history.

use super::{History, MAX_PHASES, SHORTER, flags_of, is_number, known, missing};
use crate::Flags;
use crate::trace::{COLUMNS, TraceColumn};
use cvtcycle_config::bounded::STEPS;
use cvtcycle_config::csv::{self, Cells, Collector, Column, Line, Schema, Table};
use cvtcycle_config::{Bound, Problem, Problems};

/// Hint for a trace that cannot be read.
pub const AGAIN: &str = "write it anew with `cvtcycle run`";
/// Allowed contents of a cell of the column of flags.
pub const FLAGS: &str = "names of flags joined by |";

fn schema() -> Schema {
    let column = |own: &'static TraceColumn| match &*own.name {
        "time_s" => Column::number(&*own.name, Bound::any()).hint(AGAIN),
        "dt_s" => Column::number(&*own.name, Bound::positive()).hint(AGAIN),
        name if is_number(own) => Column::number(name, Bound::any())
            .or_empty()
            .allowed("a number with a decimal point, or nothing")
            .hint(AGAIN),
        name => Column::new(name, Cells::Word).or_empty(),
    };
    Schema {
        columns: COLUMNS.iter().map(column).collect(),
        names: "time_s,dt_s,phase,...".into(),
        lenient: Some(("trace of cvtcycle", AGAIN)),
        max_rows: (STEPS, SHORTER),
        ..Schema::default()
    }
}

impl History {
    /// Reads a CSV trace written by this program. Unknown columns, as of a newer version, are skipped.
    ///
    /// # Errors
    /// All problems at once, each with its line and column: the file is not text, a required column is missing or appears twice, a row has too
    /// few or too many values, a cell is not a number, a flag is unknown, time does not rise, there are no rows. Problems beyond 50 are counted
    /// in one last entry.
    pub fn read_csv(file_name: &str, bytes: &[u8]) -> Result<Self, Problems> {
        let mut problems = Collector::new(file_name);
        let schema = schema();
        let mut reading = None;
        csv::read(bytes, &schema, &mut problems, check, |row, problems| {
            let reading = reading.get_or_insert_with(|| Reading::new(row.table()));
            reading.add(row, problems)
        });
        problems.finish().finish()?;
        Ok(reading.map(|reading| reading.history).unwrap_or_default())
    }
}

/// Reports required columns that are missing.
fn check(table: &Table, header: Line<'_>, problems: &mut Collector<'_>) {
    for own in missing(&columns_of(table)) {
        problems.line(header, &own.name, || {
            Problem::missing(format!("the column {} is missing", own.name))
                .names_key()
                .allowed(format!("with {}: {}", own.name, own.doc))
                .hint(AGAIN)
        });
    }
}

fn columns_of(table: &Table) -> Vec<&'static TraceColumn> {
    known(table.columns().flatten().map(|column| &*column.name))
}

/// Trace being read; columns are indices into [`COLUMNS`].
struct Reading {
    history: History,
    numbers: Vec<usize>,
    time: usize,
    phase: usize,
    flags: usize,
    before_s: Option<f64>,
}

fn index(name: &str) -> usize {
    let found = COLUMNS.iter().position(|column| column.name == name);
    found.unwrap_or_default()
}

impl Reading {
    fn new(table: &Table) -> Self {
        let mut numbers = columns_of(table);
        numbers.retain(|own| is_number(own));
        Reading {
            history: History::empty(&numbers),
            numbers: numbers.iter().map(|own| index(&own.name)).collect(),
            time: index("time_s"),
            phase: index("phase"),
            flags: index("flags"),
            before_s: None,
        }
    }

    /// Adds a row; false once no further row should be read.
    fn add(&mut self, row: &csv::Row<'_, '_>, problems: &mut Collector<'_>) -> bool {
        let time_s = row.number(self.time);
        if let (Some(before_s), Some(time_s)) = (self.before_s, time_s)
            && time_s <= before_s
        {
            let problem = Problem::out_of_range("the time does not rise")
                .allowed(format!("above {before_s}, the time of the row above"))
                .hint("are rows doubled or out of order?");
            row.report(self.time, problems, problem);
        }
        self.before_s = time_s;
        for ((_, column), k) in self.history.columns.iter_mut().zip(&self.numbers) {
            column.push(row.number(*k).unwrap_or(f64::NAN));
        }
        let raised = flags_of(row.word(self.flags)).unwrap_or_else(|word| {
            row.report(self.flags, problems, unknown_flag(word));
            Flags::default()
        });
        self.history.step(&unquoted(row, self.phase), raised);
        if let Some(problem) = too_many_phases(&self.history) {
            problems.line(row.line, "phase", || problem);
            return false;
        }
        true
    }
}

/// Problem of a file in which nearly every step has a phase of its own.
pub fn too_many_phases(history: &History) -> Option<Problem> {
    let message = "there are too many phases";
    (history.phases().len() > MAX_PHASES).then(|| {
        Problem::too_large(message)
            .allowed(format!("up to {MAX_PHASES} different names"))
            .hint(AGAIN)
    })
}

/// Returns a word with its quotes as they were before it was written.
fn unquoted(row: &csv::Row<'_, '_>, column: usize) -> String {
    let cell = row.cell(column);
    let quoted = cell.is_some_and(|cell| cell.line.text[..cell.field.start].ends_with('"'));
    match quoted {
        true => row.word(column).replace("\"\"", "\""),
        false => row.word(column).to_owned(),
    }
}

fn unknown_flag(word: &str) -> Problem {
    let names: Vec<&str> = Flags::NAMES.iter().map(|(_, name)| *name).collect();
    let message = match word {
        "" => "a flag without a name".to_owned(),
        word => format!("the flag `{word}` is unknown"),
    };
    Problem::unknown_name(message)
        .allowed(FLAGS)
        .hint(format!("known are {}", names.join(", ")))
}
