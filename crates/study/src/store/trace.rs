//! The trace of a run as Parquet: written, and read back to a history.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use super::RowWriter;
use super::file_problem;
use super::parquet::{ParquetTable, RUN_KEY};
use super::parquet_read::{ParquetFile, unreadable};
use super::table::{Head, Rows, Values};
use cvtcycle_config::ProblemKind::{
    self, Missing, OutOfRange, Syntax, TooLarge, UnknownName, WrongType,
};
use cvtcycle_config::bounded::{self, STEPS};
use cvtcycle_config::{Problem, Problems};
use cvtcycle_output::history::{
    AGAIN, FLAGS, History, SHORTER, flags_of, is_number, known, missing, too_many_phases,
};
use cvtcycle_output::table::Cell;
use cvtcycle_output::trace::TraceColumn;
use cvtcycle_output::{Flags, Row};

/// Rows of a row group.
const GROUP: usize = 1 << 16;

/// Writes the rows of a run as Parquet, with the columns and cells of its CSV, and the word of the run in the metadata.
///
/// # Errors
/// Those of `out`.
pub fn write_trace_parquet<W: Write + Send>(
    out: W,
    columns: &[&'static TraceColumn],
    rows: &[Row],
    phases: &[String],
    run: &str,
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
    let mut table = Box::new(ParquetTable::new(out, &heads, &[(RUN_KEY, run)], &first)?);
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

/// Reads a trace that this program has written as Parquet. Columns that it does not know, as of a newer version, are passed over.
///
/// The file has to be one of this program: the Parquet library trusts the lengths that it finds in a file.
///
/// # Errors
/// All problems at once: the file cannot be read or is no table of this program, a column that every trace has is missing, a flag is
/// unknown, time does not rise, there are no rows. Of each column the first bad row is named.
pub fn read_trace_parquet(path: &Path) -> Result<History, Problems> {
    let hinted = |problem: Problem| Problems::from(problem.hint(AGAIN));
    let file = bounded::open_file(path).map_err(|error| hinted(unreadable(path, &error)))?;
    let file = ParquetFile::open_known(path, file).map_err(hinted)?;
    let columns = known(file.columns().iter().map(|head| head.name.as_str()));
    if columns.is_empty() {
        let message = "this is no trace of cvtcycle: it has none of its columns";
        return Err(file_problem(Syntax, path, message, AGAIN).into());
    }
    let lacks = |own: &TraceColumn| {
        file_problem(
            Missing,
            path,
            format!("the column {} is missing", own.name),
            AGAIN,
        )
        .key(&*own.name)
    };
    let mut problems: Problems = missing(&columns).into_iter().map(lacks).collect();
    if file.rows() == 0 {
        problems.push(file_problem(Missing, path, "the file has no rows", AGAIN));
    }
    if file.rows() > STEPS as u64 {
        let message = format!("the file says that it has {} rows", file.rows());
        return Err(file_problem(TooLarge, path, message, SHORTER)
            .allowed(format!("up to {STEPS}"))
            .into());
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let names: Vec<&str> = columns.iter().map(|column| &*column.name).collect();
    let read = file.read(&names).map_err(hinted)?;
    let numbers = columns.iter().copied().filter(|column| is_number(column));
    let mut history = History::empty(&numbers.collect::<Vec<_>>());
    let (mut phases, mut flags): (Vec<Arc<str>>, Vec<Arc<str>>) = (Vec::new(), Vec::new());
    for (column, values) in columns.iter().zip(read.values) {
        match (&*column.name, values) {
            ("phase", Values::Text(words)) => phases = words,
            ("flags", Values::Text(words)) => flags = words,
            (_, Values::Text(_)) if !is_number(column) => {}
            (name, Values::Number(numbers)) if is_number(column) => history.put(name, numbers),
            (name, Values::Count(counts)) if is_number(column) => {
                history.put(name, counts.iter().map(|n| *n as f64).collect())
            }
            (name, _) => {
                let message =
                    "the column holds words where numbers are due, or the other way round";
                problems.push(bad(WrongType, path, name, "", message, ""));
            }
        }
    }
    steps(path, &mut history, &phases, &flags, &mut problems);
    problems.extend(times(path, &history));
    if problems.is_empty() {
        Ok(history)
    } else {
        Err(problems)
    }
}

fn steps(
    path: &Path,
    history: &mut History,
    phases: &[Arc<str>],
    flags: &[Arc<str>],
    problems: &mut Problems,
) {
    let mut unknown = None;
    for (row, (phase, cell)) in phases.iter().zip(flags).enumerate() {
        let found = flags_of(cell).unwrap_or_else(|word| {
            unknown.get_or_insert((row, word));
            Flags::default()
        });
        history.step(phase, found);
        if let Some(problem) = too_many_phases(history) {
            let path = path.display().to_string();
            problems.push(problem.key("phase").value(path.as_str()).in_file(path));
            return;
        }
    }
    problems.extend(unknown.map(|(row, word)| {
        let message = format!("unknown flag in row {}", row + 1);
        bad(UnknownName, path, "flags", word, &message, FLAGS)
    }));
}

/// Checks times and lengths of the steps; reports the first bad one of each.
fn times(path: &Path, history: &History) -> Problems {
    let (time, dt) = (history.time_s(), history.dt_s());
    let late = |row: &usize| !time[*row].is_finite() || (*row > 0 && time[*row] <= time[row - 1]);
    let short = |row: &usize| !(dt[*row].is_finite() && dt[*row] > 0.0);
    let at = |key: &str, row: usize, value: f64, message: &str, allowed: &str| {
        let message = format!("{message} in row {}", row + 1);
        bad(OutOfRange, path, key, &value.to_string(), &message, allowed)
    };
    let late = (0..time.len()).find(late).map(|row| {
        let allowed = "above that of the row before";
        at("time_s", row, time[row], "the time does not rise", allowed)
    });
    let short = (0..dt.len()).find(short).map(|row| {
        let message = "the length of the step is not positive";
        at("dt_s", row, dt[row], message, "above 0 s")
    });
    late.into_iter().chain(short).collect()
}

fn bad(
    kind: ProblemKind,
    path: &Path,
    key: &str,
    value: &str,
    message: &str,
    allowed: &str,
) -> Problem {
    let problem = file_problem(kind, path, message, AGAIN);
    problem.key(key).value(value).allowed(allowed)
}
