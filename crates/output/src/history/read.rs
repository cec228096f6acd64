//! A `trace_*.csv` of this program back to a history.

use super::{History, MAX_PHASES, MAX_STEPS, SHORTER, flags_of, is_number, known, missing};
use crate::Flags;
use crate::trace::column;
use cvtcycle_config::Problems;
use cvtcycle_config::cycle::problems::{Collector, Complaint, Line};
use cvtcycle_config::cycle::text::Field;

/// What helps with a trace that cannot be read.
pub const AGAIN: &str = "write it anew with `cvtcycle run ... --out DIR --force`";
/// What a cell of numbers may hold.
const NUMBER: &str = "a number with a decimal point, or nothing";
/// What a cell of the column of flags may hold.
pub const FLAGS: &str = "names of flags joined by |";

/// What a column of the file is for.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Use {
    /// The numbers of that index.
    Number(usize),
    Phase,
    Flags,
    /// A column of a newer version.
    Nothing,
}

/// The columns of the file.
struct Header<'t> {
    names: Vec<&'t str>,
    uses: Vec<Use>,
    numbers: usize,
    time: Option<usize>,
    dt: Option<usize>,
}

impl History {
    /// Reads a trace that this program has written as CSV. Columns that it does not know, as of a newer version, are passed over.
    ///
    /// # Errors
    /// All problems at once, each with its line and column: the file is no text, a column that every trace has is missing or there
    /// twice, a row has too few or too many values, a cell is no number, a flag is unknown, time does not rise, there are no rows.
    /// After 50 the rest is counted in one last entry.
    pub fn read_csv(file_name: &str, bytes: &[u8]) -> Result<Self, Problems> {
        let mut problems = Collector::new(file_name);
        let Some(mut lines) = problems.lines(bytes) else {
            return Err(problems.finish());
        };
        let Some(header) = lines.next().and_then(|line| header(line, &mut problems)) else {
            return Err(problems.finish());
        };
        let history = rows(&header, lines, &mut problems);
        if history.is_empty() && problems.is_empty() {
            problems.file(Complaint::new(
                "the file has column names and no rows",
                "at least one row",
                AGAIN,
            ));
        }
        if problems.is_empty() {
            Ok(history)
        } else {
            Err(problems.finish())
        }
    }
}

/// Reads the names of the columns; none where the lines below them could not be understood.
fn header<'t>(line: Line<'t>, problems: &mut Collector) -> Option<Header<'t>> {
    let fields = problems.names(line)?;
    let columns = known(fields.iter().map(|field| field.text));
    if columns.is_empty() {
        problems.line(line, "", || {
            Complaint::new(
                "this is no trace of cvtcycle: it has none of its columns",
                "time_s,dt_s,phase,...",
                AGAIN,
            )
        });
        return None;
    }
    for own in missing(&columns) {
        problems.line(line, &own.name, || {
            Complaint::new(
                format!("the column {} is missing", own.name),
                format!("with {}: {}", own.name, own.doc),
                AGAIN,
            )
        });
    }
    let numbers: Vec<&str> = columns
        .iter()
        .filter(|column| is_number(column))
        .map(|column| &*column.name)
        .collect();
    let mut uses = Vec::new();
    for (k, field) in fields.iter().enumerate() {
        let known = column(field.text).is_some();
        if known && fields[..k].iter().any(|other| other.text == field.text) {
            problems.value(line, *field, field.text, || {
                Complaint::new(
                    format!("the column {} is there twice", field.text),
                    "once",
                    AGAIN,
                )
            });
        }
        uses.push(
            match (
                field.text,
                numbers.iter().position(|name| *name == field.text),
            ) {
                (_, Some(index)) => Use::Number(index),
                ("phase", None) => Use::Phase,
                ("flags", None) => Use::Flags,
                _ => Use::Nothing,
            },
        );
    }
    let at = |name: &str| numbers.iter().position(|own| *own == name);
    let (time, dt) = (at("time_s"), at("dt_s"));
    Some(Header {
        names: fields.iter().map(|field| field.text).collect(),
        uses,
        numbers: numbers.len(),
        time,
        dt,
    })
}

fn rows<'t>(
    header: &Header,
    lines: impl Iterator<Item = Line<'t>>,
    problems: &mut Collector,
) -> History {
    let mut history = History::empty(
        &known(header.names.iter().copied())
            .into_iter()
            .filter(|column| is_number(column))
            .collect::<Vec<_>>(),
    );
    let mut fields: Vec<Field> = Vec::new();
    let mut before_s = f64::NAN;
    let mut numbers = vec![f64::NAN; header.numbers];
    for line in lines {
        if history.len() == MAX_STEPS {
            problems.line(line, "", || {
                Complaint::new(
                    "the trace has too many steps",
                    format!("up to {MAX_STEPS}"),
                    SHORTER,
                )
            });
            break;
        }
        if !problems.split(line, header.names.len(), &mut fields) {
            before_s = f64::NAN;
            continue;
        }
        let (mut phase, mut flags) = (String::new(), Flags::default());
        for ((field, name), kind) in fields.iter().zip(&header.names).zip(&header.uses) {
            match kind {
                Use::Number(index) => {
                    let least = if Some(*index) == header.time {
                        Least::Above(before_s)
                    } else if Some(*index) == header.dt {
                        Least::Above(0.0)
                    } else {
                        Least::Anything
                    };
                    numbers[*index] = number(line, *field, name, least, problems);
                }
                Use::Phase => phase = word(line, *field),
                Use::Flags => flags = flags_in(line, *field, problems),
                Use::Nothing => {}
            }
        }
        before_s = header.time.map_or(f64::NAN, |time| numbers[time]);
        for ((_, column), number) in history.columns.iter_mut().zip(&numbers) {
            column.push(*number);
        }
        history.step(&phase, flags);
        if let Some(complaint) = too_many_phases(&history) {
            problems.line(line, "phase", || complaint);
            break;
        }
    }
    history
}

/// What is wrong where nearly every step has a phase of its own.
pub fn too_many_phases(history: &History) -> Option<Complaint> {
    let message = "there are too many phases";
    (history.phases().len() > MAX_PHASES).then(|| {
        Complaint::new(
            message,
            format!("up to {MAX_PHASES} different names"),
            AGAIN,
        )
    })
}

/// What a number has to be.
#[derive(Clone, Copy)]
enum Least {
    /// Anything, or nothing.
    Anything,
    /// A number above this one; any number where this is none.
    Above(f64),
}

fn number(line: Line, field: Field, name: &str, least: Least, problems: &mut Collector) -> f64 {
    if field.text.is_empty() {
        if let Least::Above(_) = least {
            problems.value(line, field, name, || {
                Complaint::new("the cell is empty", "a number", AGAIN)
            });
        }
        return f64::NAN;
    }
    let Some(number) = field.text.parse::<f64>().ok().filter(|x| x.is_finite()) else {
        problems.value(line, field, name, || {
            Complaint::new("this is no number", NUMBER, AGAIN)
        });
        return f64::NAN;
    };
    if let Least::Above(low) = least
        && number <= low
    {
        let complaint = match name {
            "time_s" => Complaint::new(
                "the time does not rise",
                format!("above {low}, the time of the row above"),
                "are rows doubled or out of order?",
            ),
            _ => Complaint::new("the length of the step is not positive", "above 0 s", AGAIN),
        };
        problems.value(line, field, name, || complaint);
    }
    number
}

/// A word, with the quotes in it as they were before it was written.
fn word(line: Line, field: Field) -> String {
    let quoted = line.text[..field.start].ends_with('"');
    if quoted {
        field.text.replace("\"\"", "\"")
    } else {
        field.text.to_owned()
    }
}

fn flags_in(line: Line, field: Field, problems: &mut Collector) -> Flags {
    flags_of(field.text).unwrap_or_else(|word| {
        let names: Vec<&str> = Flags::NAMES.iter().map(|(_, name)| *name).collect();
        let hint = format!("known are {}", names.join(", "));
        let message = if word.is_empty() {
            "a flag without a name".to_owned()
        } else {
            format!("the flag `{word}` is unknown")
        };
        problems.value(line, field, "flags", || {
            Complaint::new(message, FLAGS, hint)
        });
        Flags::default()
    })
}
