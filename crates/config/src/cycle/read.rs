//! A user's CSV file to a cycle, or to all that is wrong with it.

use std::path::Path;

use super::gears::{GearColumns, GearCommand, commands};
use super::header::{Column, Header};
use super::problems::Collector;
use super::row::Row;
use super::table::Table;
use super::{Cycle, Interval, Trace, Weighting};
use crate::Problems;

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
    let Some(mut lines) = problems.lines(bytes) else {
        return Err(problems.finish());
    };
    let header = lines
        .next()
        .and_then(|line| Header::read(line, &mut problems));
    let Some(header) = header else {
        return Err(problems.finish());
    };
    let (rows, problems) = Table::read(&header, phases, problems, lines);
    if problems.is_empty() {
        Ok(trace(&header, &rows))
    } else {
        Err(problems.finish())
    }
}

fn trace(header: &Header, rows: &[Row]) -> Trace {
    let intervals = rows
        .windows(2)
        .map(|pair| interval(&pair[0], &pair[1]))
        .collect();
    let column = |column: Column, gear: fn(&Row) -> u8| -> Option<Vec<GearCommand>> {
        header.has(column).then(|| {
            let mut list = commands(rows.iter().map(|row| (gear(row), row.note)));
            list.truncate(rows.len().saturating_sub(1));
            list
        })
    };
    let five = column(Column::Gear5, |row| row.gear_5);
    let six = column(Column::Gear6, |row| row.gear_6);
    let plain = column(Column::Gear, |row| row.gear);
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
