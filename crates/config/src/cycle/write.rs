//! A cycle as the text of a file: the program's own table, or one of another program.

use std::fmt::Write;

use super::{Cycle, GearCommand, Trace};
use crate::one_line;

/// Form of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// The program's own table, with all that a cycle has.
    Csv,
    /// VECTO, over time.
    Vdri,
    /// FASTSim 3.
    Fastsim,
    /// EPA: a title, times in s and speeds in mph.
    Epa,
}

impl Format {
    /// Names of the forms.
    pub const NAMES: [(&'static str, Format); 4] = [
        ("csv", Format::Csv),
        ("vdri", Format::Vdri),
        ("fastsim", Format::Fastsim),
        ("epa", Format::Epa),
    ];
}

/// A text, and what of the cycle its form cannot hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The text of the file.
    pub text: String,
    /// Parts of the cycle that are left out, for people.
    pub left_out: Vec<&'static str>,
}

// The international mile, exact by definition.
const MPH: f64 = 1609.344 / 3600.0;

/// Columns of a row: its name and the text of a cell. The last row, which holds over nothing, repeats the one above.
struct Column<'a> {
    name: &'static str,
    cell: Box<dyn Fn(usize) -> String + 'a>,
}

impl<'a> Column<'a> {
    fn new(name: &'static str, cell: impl Fn(usize) -> String + 'a) -> Self {
        Column {
            name,
            cell: Box::new(cell),
        }
    }
}

/// Writes a trace of a cycle. Speeds and grades have up to twelve decimals.
///
/// ```
/// use cvtcycle_config::cycle::{Format, embedded, read_csv, write};
/// let cycle = embedded("ece15").expect("a shipped cycle");
/// let written = write(&cycle, &cycle.manual, Format::Csv);
/// let again = read_csv("ece15.csv", written.text.as_bytes())?;
/// assert_eq!(again.manual.gears(5), cycle.manual.gears(5));
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
#[must_use]
pub fn write(cycle: &Cycle, trace: &Trace, format: Format) -> Written {
    let speed = |name, unit_m_s: f64| {
        Column::new(name, move |k| {
            rounded(at(trace, k).1 / unit_m_s).to_string()
        })
    };
    let time = |name| Column::new(name, |k| at(trace, k).0.to_string());
    let grade = |name, factor: f64| {
        Column::new(name, move |k| {
            rounded(held(trace, k).grade * factor).to_string()
        })
    };
    let has_grade = trace.intervals.iter().any(|i| i.grade != 0.0);
    let is_off = trace.intervals.iter().any(|i| i.engine_off);
    let has = |is: bool, what: &'static str| is.then_some(what);
    let mut left_out = vec![
        has(!cycle.phases.is_empty(), "phases"),
        has(is_off, "the engine's rest"),
    ];
    let (head, columns, sign) = match format {
        Format::Csv => {
            left_out.clear();
            let mut columns = vec![time("time_s"), speed("speed_kmh", 1.0 / 3.6)];
            columns.extend(own_columns(cycle, trace, is_off));
            columns.extend(has_grade.then(|| grade("grade", 1.0)));
            (String::new(), columns, ",")
        }
        Format::Vdri => {
            let mut columns = vec![time("<t>"), speed("<v>", 1.0 / 3.6), grade("<grad>", 100.0)];
            columns.extend(gear_column(trace));
            left_out.push(has(
                trace.gear_columns().count() > 1,
                "all gears but the first column",
            ));
            (String::new(), columns, ",")
        }
        Format::Fastsim => {
            left_out.push(has(trace.has_gears(), "gears"));
            let columns = vec![
                time("time_seconds"),
                speed("speed_meters_per_second", 1.0),
                grade("grade", 1.0),
            ];
            (String::new(), columns, ",")
        }
        Format::Epa => {
            left_out.extend([has(trace.has_gears(), "gears"), has(has_grade, "grades")]);
            let name = one_line(&cycle.name).to_uppercase();
            let head = format!("{name}.TXT\t{}\n", one_line(&cycle.title));
            (
                head,
                vec![time("Test Time, secs"), speed("Target Speed, mph", MPH)],
                "\t",
            )
        }
    };
    Written {
        text: head + &table(&columns, trace.intervals.len(), sign),
        left_out: left_out.into_iter().flatten().collect(),
    }
}

fn table(columns: &[Column<'_>], intervals: usize, sign: &str) -> String {
    let names: Vec<&str> = columns.iter().map(|column| column.name).collect();
    let mut text = names.join(sign) + "\n";
    for k in 0..=intervals {
        for (i, column) in columns.iter().enumerate() {
            let before = if i == 0 { "" } else { sign };
            let _ = write!(text, "{before}{}", (column.cell)(k));
        }
        text.push('\n');
    }
    text
}

/// Without the digits of a unit's rounding: 3.6 km/h, not 3.5999999999999996.
fn rounded(x: f64) -> f64 {
    const DECIMALS: f64 = 1e12;
    (x * DECIMALS).round() / DECIMALS
}

/// Time in s and speed in m/s of a row.
fn at(trace: &Trace, k: usize) -> (f64, f64) {
    match (trace.intervals.get(k), trace.intervals.last()) {
        (Some(i), _) => (i.start_s, i.start_speed_m_s),
        (None, Some(last)) => (last.end_s, last.end_speed_m_s),
        (None, None) => (0.0, 0.0),
    }
}

/// Values from a row on; at the last one as before it.
fn held(trace: &Trace, k: usize) -> &super::Interval {
    &trace.intervals[k.min(trace.intervals.len() - 1)]
}

/// Phase, gears and engine of the program's own table.
fn own_columns<'a>(cycle: &'a Cycle, trace: &'a Trace, is_off: bool) -> Vec<Column<'a>> {
    let mut columns = Vec::new();
    if !cycle.phases.is_empty() {
        columns.push(Column::new("phase", |k| {
            let phase = usize::from(held(trace, k).phase);
            quoted(cycle.phases.get(phase).map_or("", String::as_str))
        }));
    }
    let last = trace.intervals.len().saturating_sub(1);
    let gears: Vec<(&'static str, &'a [GearCommand])> = trace.gear_columns().collect();
    for (name, list) in gears.iter().copied() {
        columns.push(Column::new(name, move |k| {
            list[k.min(last)].gear().to_string()
        }));
    }
    if !gears.is_empty() {
        // One note serves all columns, as in the table that they come from.
        columns.push(Column::new("gear_note", move |k| {
            let mut commands = gears.iter().map(|(_, list)| list[k.min(last)]);
            commands.find_map(note).unwrap_or_default()
        }));
    }
    if is_off {
        columns.push(Column::new("engine_off", |k| {
            u8::from(held(trace, k).engine_off).to_string()
        }));
    }
    columns
}

/// The note of a command whose gear does not say it all.
fn note(command: GearCommand) -> Option<String> {
    match command {
        GearCommand::Declutched(gear) => Some(format!("K{gear}")),
        GearCommand::Change(_) => Some("GC".to_owned()),
        GearCommand::Neutral | GearCommand::InGear(_) => None,
    }
}

/// VECTO's gears: 0 where the clutch is open.
fn gear_column(trace: &Trace) -> Option<Column<'_>> {
    let (_, list) = trace.gear_columns().next()?;
    let last = trace.intervals.len().saturating_sub(1);
    Some(Column::new("<gear>", move |k| match list[k.min(last)] {
        GearCommand::Neutral | GearCommand::Declutched(_) => "0".to_owned(),
        GearCommand::InGear(gear) | GearCommand::Change(gear) => gear.to_string(),
    }))
}

/// A word of a table in quotes where it needs them. A quote in a word that was read in quotes is written twice already.
fn quoted(word: &str) -> String {
    let needs = word.contains(',') || word.starts_with('"') || word.trim() != word;
    if needs {
        format!("\"{word}\"")
    } else {
        word.to_owned()
    }
}
