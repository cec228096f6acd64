//! The tables that the program carries to traces.
//!
//! They are written as the program writes tables, and a test has the reader of users' files find no problem in them. So nothing is looked for here
//! but the values: a `run` spent a third of its time on reading its cycle. The test holds every trace to the bit against that reader.

use super::Trace;
use super::gears::Note;
use super::read::{interval, trace};
use super::row::{Row, speed};

/// Kind of a column of such a table.
#[derive(Clone, Copy)]
enum Column {
    Time,
    Speed,
    Phase,
    /// By its place among the columns of gears.
    Gear(usize),
    Note,
    /// For the reader of the file only.
    Other,
}

impl Column {
    fn from_name(name: &str) -> Option<Column> {
        Some(match name {
            "time_s" => Column::Time,
            "speed_km_h" => Column::Speed,
            "phase" => Column::Phase,
            "gear_5mt" => Column::Gear(1),
            "gear_6mt" => Column::Gear(2),
            "gear_note" => Column::Note,
            "operation" => Column::Other,
            _ => return None,
        })
    }
}

/// Index of a phase by its name, which is added where it is new.
fn phase(name: &str, phases: &mut Vec<String>) -> Option<u16> {
    let known = phases.iter().position(|known| known == name);
    let place = known.unwrap_or_else(|| {
        phases.push(name.to_owned());
        phases.len() - 1
    });
    u16::try_from(place).ok()
}

/// Parts of a text between bytes of ASCII. They are short: `str::split` would set out for a search of long ones at each.
fn split(text: &str, at: u8) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let all = rest?;
        let end = all.bytes().position(|byte| byte == at);
        rest = end.map(|end| &all[end + 1..]);
        Some(&all[..end.unwrap_or(all.len())])
    })
}

/// The cells of a line.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    split(line, b',')
}

/// The trace of a table whose first row is at 0 s; none where it has another column or a cell that is not of its kind. Phases known already keep their index,
/// new ones are added.
pub(super) fn plain_trace(text: &str, phases: &mut Vec<String>) -> Option<Trace> {
    let mut lines = split(text, b'\n').map(|line| line.strip_suffix('\r').unwrap_or(line));
    let columns: Vec<Column> = cells(lines.next()?)
        .map(Column::from_name)
        .collect::<Option<_>>()?;
    let has = [0, 1, 2].map(|gear| {
        let is = |column: &Column| matches!(column, Column::Gear(own) if *own == gear);
        columns.iter().any(is)
    });
    let mut rows: Vec<Row> = Vec::new();
    let mut before = phases.len();
    for line in lines.filter(|line| !line.is_empty()) {
        before = phases.len();
        let mut row = Row::default();
        for (column, cell) in columns.iter().zip(cells(line)) {
            match column {
                Column::Time => row.time_s = Some(cell.parse().ok()?),
                Column::Speed => row.speed_m_s = Some(speed("speed_km_h", cell.parse().ok()?).1),
                Column::Phase => row.phase = phase(cell, phases)?,
                Column::Gear(gear) => row.gears[*gear] = cell.parse().ok()?,
                Column::Note => row.note = Note::parse(cell)?,
                Column::Other => {}
            }
        }
        rows.push(row);
    }
    // The last row holds over nothing, nor does a phase that only it names.
    phases.truncate(before);
    let pairs = rows.windows(2);
    let intervals = pairs.map(|pair| interval(&pair[0], &pair[1])).collect();
    Some(trace(has, &rows, intervals, None))
}
