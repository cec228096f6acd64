//! A CSV file of measured traces: `time_s` and columns of the computed trace by their names.

use super::points::SD;
use super::sheet::{self, Column, Sheet};
use super::unknown;
use crate::config::{Bound, Problem};
use crate::cycle::problems::Complaint;

/// Name of the column of times.
pub(crate) const TIME: &str = "time_s";

/// Reads a trace of which the columns `known` can be computed.
///
/// # Errors
/// All problems of the file; times that do not rise.
pub(crate) fn read(file: &str, bytes: &[u8], computed: &[&'static str]) -> Result<Sheet, Vec<Problem>> {
    let known = |name: &str| {
        let column = |range, may_be_empty| Ok(Column { name: name.to_owned(), range: Some(range), may_be_empty });
        if name == TIME {
            return column(Bound::closed(0.0, 1e6), false);
        }
        let (range, measured) = match name.strip_prefix(SD) {
            Some(rest) => (Bound::positive(), rest),
            None => (Bound::any(), name),
        };
        if measured != TIME && computed.contains(&measured) {
            return column(range, true);
        }
        let columns: Vec<&str> = computed.iter().copied().filter(|name| name.contains('_')).collect();
        Err(unknown(measured, &columns, "time_s and columns of the trace: `cvtcycle explain COLUMN`"))
    };
    let sheet = sheet::read(file, bytes, &known, &[TIME])?;
    let time = sheet.find(TIME).unwrap_or(0);
    let mut problems = Vec::new();
    for row in 1..sheet.rows.len() {
        let (before, now) = (sheet.number(row - 1, Some(time)), sheet.number(row, Some(time)));
        if before >= now {
            let allowed = format!("above {}", before.unwrap_or_default());
            problems.push(sheet.problem(
                row,
                time,
                Complaint::new("the time does not rise", allowed, "sort the rows, remove repeated ones"),
            ));
        }
    }
    if measured(&sheet).is_empty() {
        problems.push(sheet.problem(0, time, Complaint::new("no column was measured", "", "add, for example, transmission_sump_degc")));
    }
    for (k, column) in sheet.columns.iter().enumerate() {
        if let Some(of) = column.name.strip_prefix(SD)
            && sheet.find(of).is_none()
        {
            let message = format!("{} stands without a column {of}", column.name);
            problems.push(sheet.problem(0, k, Complaint::new(message, "", "add the measured column")));
        }
    }
    if problems.is_empty() { Ok(sheet) } else { Err(problems) }
}

/// Names of the measured columns of a sheet, and their indices.
pub(crate) fn measured(sheet: &Sheet) -> Vec<(usize, &str)> {
    let named = sheet.columns.iter().enumerate().map(|(k, column)| (k, column.name.as_str()));
    named.filter(|(_, name)| *name != TIME && !name.starts_with(SD)).collect()
}
