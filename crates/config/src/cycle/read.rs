//! A user's CSV file to a cycle, or to all that is wrong with it.

use std::path::Path;

use super::gears::{GearColumns, GearCommand, commands};
use super::row::{GEARS, NOTE, Row, Rows, schema};
use super::{Cycle, Interval, Trace, Weighting};
use crate::csv::{self, Collector, Line, Table};
use crate::{Problem, Problems};

/// Reads a drive cycle from the bytes of a CSV file called `file`.
///
/// Columns: `time_s` (s, strictly rising, any step; the first time becomes 0) and one of `speed_kmh`, `speed_km_h`, `speed_m_s`,
/// `speed_mph`. Optional, holding from their row to the next: `phase` (name), `gear` (0 to 10, for every gearbox that has
/// these gears), `gear_5mt`, `gear_6mt`, `gear_note` (`PM`, `K1` .., `GC`; see [`GearCommand`]), `grade_percent` or `grade` (rise over
/// run), `engine_off` (0 or 1, standing only). `operation` is passed over. Speed is linear between rows.
///
/// # Errors
/// All problems of the file at once, in the order of its lines, each with its place; after 50 the rest is counted in one last entry.
pub fn read_csv(file: &str, bytes: &[u8]) -> Result<Cycle, Problems> {
    let mut phases = Vec::new();
    let manual = read_trace(file, bytes, &mut phases)?;
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
    })
}

/// The trace alone. Phases known already keep their index, new ones are added.
pub(super) fn read_trace(
    file: &str,
    bytes: &[u8],
    phases: &mut Vec<String>,
) -> Result<Trace, Problems> {
    let mut problems = Collector::new(file);
    let mut rows = Rows::new(phases);
    let schema = schema();
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
    problems.finish().finish()?;
    Ok(trace(&table, &rows))
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

fn trace(table: &Table, rows: &[Row]) -> Trace {
    let intervals = rows
        .windows(2)
        .map(|pair| interval(&pair[0], &pair[1]))
        .collect();
    let [plain, five, six] = [0, 1, 2].map(|k| -> Option<Vec<GearCommand>> {
        table.has(GEARS[k]).then(|| {
            let mut list = commands(rows.iter().map(|row| (row.gears[k], row.note)));
            list.truncate(rows.len().saturating_sub(1));
            list
        })
    });
    Trace::with_gears(intervals, GearColumns::new(five, six, plain))
}

fn interval(row: &Row, next: &Row) -> Interval {
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
