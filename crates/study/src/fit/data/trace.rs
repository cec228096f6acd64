//! A CSV file of measured traces: `time_s` and columns of the computed trace by their names.

use super::points::SD;
use super::sheet::{self, Measured, Sheet};
use cvtcycle_config::csv::Column;
use cvtcycle_config::{Bound, Problem, Problems};

/// Name of the column of times.
pub const TIME: &str = "time_s";

/// So many columns are listed one by one.
const FEW: usize = 40;

/// Reads a trace, of which the columns `computed` can be computed, as far as it can be understood, and all problems of the file: also times
/// that do not rise.
pub fn read(file: &str, bytes: &[u8], computed: &[&'static str]) -> (Option<Sheet>, Problems) {
    let measurable: Vec<&str> = (computed.iter().copied())
        .filter(|name| *name != TIME)
        .collect();
    let time = Column::number(TIME, Bound::closed(0.0, 1e6)).required();
    let columns = std::iter::once(time).chain(sheet::measured(&measurable));
    let with_unit = measurable.iter().filter(|name| name.contains('_'));
    let names = if with_unit.clone().count() <= FEW {
        with_unit.copied().collect::<Vec<_>>().join(", ")
    } else {
        "time_s and columns of the trace: `cvtcycle explain COLUMN`".to_owned()
    };
    let measured = Measured {
        is_measured: &is_measured,
        example: "transmission_sump_degc",
    };
    let (sheet, mut problems) = sheet::read(file, bytes, columns.collect(), names, Some(measured));
    if let Some(sheet) = &sheet
        && let Some(time) = sheet.find(TIME)
    {
        let given: Vec<(usize, f64)> = (0..sheet.rows.len())
            .filter_map(|row| Some((row, sheet.number(row, Some(time))?)))
            .collect();
        let falls: Vec<&[(usize, f64)]> = given
            .windows(2)
            .filter(|pair| pair[0].1 >= pair[1].1)
            .collect();
        if let Some([(_, before), (row, _)]) = falls.first() {
            let message = format!("the time does not rise{}", and_more(falls.len()));
            let complaint = Problem::invalid(message)
                .allowed(format!("above {before} s"))
                .hint("sort the rows, remove repeated ones");
            problems.add(sheet.problem(*row, time, complaint));
        }
    }
    (sheet, problems.finish())
}

/// Words for the rows beyond the first one of which the same is to be said.
pub fn and_more(rows: usize) -> String {
    match rows {
        0 | 1 => String::new(),
        2 => ", nor is it right in 1 more row".to_owned(),
        _ => format!(", nor is it right in {} more rows", rows - 1),
    }
}

fn is_measured(name: &str) -> bool {
    !name.is_empty() && name != TIME && !name.starts_with(SD)
}

/// Names of the measured columns of a sheet, and their indices.
pub fn measured(sheet: &Sheet) -> Vec<(usize, &str)> {
    let named = sheet
        .columns
        .iter()
        .enumerate()
        .map(|(k, column)| (k, column.as_str()));
    named.filter(|(_, name)| is_measured(name)).collect()
}
