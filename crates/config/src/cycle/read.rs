//! A user's CSV file to a cycle, or to all that is wrong with it.

use std::path::Path;

use super::distance::{DistanceRow, Stretch, stretches};
use super::gears::{GearColumns, GearCommand, commands};
use super::row::{GEARS, MAX_DURATION_S, NOTE, Over, Row, Rows, schema};
use super::{Cycle, Interval, Trace, Weighting};
use crate::csv::{self, Collector, Columns, Line, Table};
use crate::{Problem, Problems, readable};

/// Reads a drive cycle from the bytes of a CSV file called `file`.
///
/// Columns: `time_s` (s, strictly rising, any step; the first time becomes 0), or `distance_m` with `stop_s` at speed 0 (CY-1), and one of
/// `speed_kmh`, `speed_km_h`, `speed_m_s`, `speed_mph`. Optional, holding from their row to the next: `phase` (name), `gear` (0 to 10, for every gearbox that has
/// these gears), `gear_5mt`, `gear_6mt`, `gear_note` (`PM`, `K1` .., `GC`; see [`GearCommand`]), `grade_percent` or `grade` (rise over
/// run), `engine_off` (0 or 1, standing only). `operation` is passed over. Speed is linear between rows. Names of EPA's, FASTSim's and
/// VECTO's files are known, semicolons and tabs are read, and with semicolons or tabs decimal commas: [`Cycle::read_as`].
///
/// # Errors
/// All problems of the file at once, in the order of its lines, each with its place; after 50 the rest is counted in one last entry.
pub fn read_csv(file: &str, bytes: &[u8]) -> Result<Cycle, Problems> {
    read_columns(file, bytes, &Columns::default())
}

/// As [`read_csv`], with the columns that are meant; if there are any, all others are passed over.
///
/// # Errors
/// As there.
pub fn read_columns(file: &str, bytes: &[u8], columns: &Columns) -> Result<Cycle, Problems> {
    let mut phases = Vec::new();
    let (manual, read_as) = read_trace((file, columns), bytes, &mut phases)?;
    let path = Path::new(file);
    let text = |part: Option<&std::ffi::OsStr>| {
        part.and_then(|part| part.to_str())
            .unwrap_or(file)
            .to_owned()
    };
    Ok(Cycle {
        name: text(path.file_stem()),
        title: text(path.file_name()),
        phases,
        weighting: Weighting::None,
        manual,
        automatic: None,
        read_as,
        is_wltc: false,
    })
}

/// The trace alone, and how it was read. Phases known already keep their index, new ones are added.
pub(super) fn read_trace(
    (file, columns): (&str, &Columns),
    bytes: &[u8],
    phases: &mut Vec<String>,
) -> Result<(Trace, Option<String>), Problems> {
    let mut problems = Collector::new(file);
    let mut rows = Rows::new(phases);
    let schema = schema(columns);
    let table = csv::read(
        bytes,
        &schema,
        &mut problems,
        check_notes,
        |cells, problems| {
            rows.add(cells, problems);
            true
        },
    );
    rows.finish();
    let Some(table) = table else {
        return Err(problems.finish());
    };
    let rows = rows.rows;
    if rows.len() == 1 {
        problems.file(
            Problem::missing("the file has one row only")
                .allowed("at least two rows")
                .hint("a row holds until the next one: add one for the end"),
        );
    }
    // A table over distance has a time only when it is whole.
    let (intervals, row_of) =
        match problems.is_empty() && Over::from_table(&table) == Over::Distance {
            true => over_distance(&rows),
            false => {
                let pairs = rows.windows(2);
                (
                    pairs.map(|pair| interval(&pair[0], &pair[1])).collect(),
                    None,
                )
            }
        };
    let duration_s = intervals.last().map_or(0.0, |last| last.end_s);
    if problems.is_empty() && !(duration_s > 0.0 && duration_s <= MAX_DURATION_S) {
        let duration = readable(duration_s, 1);
        problems.file(
            Problem::out_of_range(format!("the cycle over distance takes {duration} s"))
                .allowed("above 0 and up to 1000000 s")
                .hint("are distances and speeds in the units that their columns say?"),
        );
    }
    problems.finish().finish()?;
    let read_as = read_as(&table);
    let has = GEARS.map(|k| table.has(k));
    Ok((trace(has, &rows, intervals, row_of), read_as))
}

/// The intervals of a table over distance, and the row of each.
fn over_distance(rows: &[Row]) -> (Vec<Interval>, Option<Vec<usize>>) {
    let row = |row: &Row| DistanceRow {
        distance_m: row.distance_m.unwrap_or_default(),
        speed_m_s: row.speed_m_s.unwrap_or_default(),
        stop_s: row.stop_s,
    };
    let list: Vec<DistanceRow> = rows.iter().map(row).collect();
    let stretches = stretches(&list);
    let interval = |s: &Stretch| Interval {
        start_s: s.time_s[0],
        end_s: s.time_s[1],
        start_speed_m_s: s.speed_m_s[0],
        end_speed_m_s: s.speed_m_s[1],
        phase: rows[s.row].phase,
        grade: rows[s.row].grade,
        engine_off: rows[s.row].engine_off,
    };
    let row_of = stretches.iter().map(|s| s.row).collect();
    (stretches.iter().map(interval).collect(), Some(row_of))
}

/// How a table was read, where it is not as the program writes its own.
fn read_as(table: &Table) -> Option<String> {
    let over = match Over::from_table(table) {
        Over::Time => None,
        Over::Distance => Some("over distance, with 1.0 m/s2 up and 1.5 m/s2 down (CY-1)"),
        Over::Seconds => Some("a row a second"),
    };
    let words: Vec<&str> = table.read_as().into_iter().chain(over).collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// Reports notes without a column of the gears that they are on.
fn check_notes(table: &Table, header: Line<'_>, problems: &mut Collector<'_>) {
    if table.has(NOTE) && !GEARS.iter().any(|k| table.has(*k)) {
        problems.line(header, "gear_note", || {
            Problem::missing("gear_note needs a column with the gears")
                .names_key()
                .allowed("gear, gear_5mt or gear_6mt")
                .hint("add a column gear, 0 where none is engaged")
        });
    }
}

/// The trace of rows; `has`: the columns of gears that there are, in the order of [`GEARS`].
pub(super) fn trace(
    has: [bool; 3],
    rows: &[Row],
    intervals: Vec<Interval>,
    row_of: Option<Vec<usize>>,
) -> Trace {
    let [plain, five, six] = [0, 1, 2].map(|k| -> Option<Vec<GearCommand>> {
        has[k].then(|| {
            let mut list = commands(rows.iter().map(|row| (row.gears[k], row.note)));
            match &row_of {
                Some(row_of) => row_of.iter().map(|row| list[*row]).collect(),
                None => {
                    list.truncate(intervals.len());
                    list
                }
            }
        })
    });
    Trace::with_gears(intervals, GearColumns::new(five, six, plain))
}

/// The interval from a row to the next.
pub(super) fn interval(row: &Row, next: &Row) -> Interval {
    let Row {
        phase,
        grade,
        engine_off,
        ..
    } = *row;
    Interval {
        start_s: row.time_s.unwrap_or_default(),
        end_s: next.time_s.unwrap_or_default(),
        start_speed_m_s: row.speed_m_s.unwrap_or_default(),
        end_speed_m_s: next.speed_m_s.unwrap_or_default(),
        phase,
        grade,
        engine_off,
    }
}
