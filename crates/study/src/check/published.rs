//! Published numbers that are the headline of a run: rows that say with `about` of which.

use super::read::read;
use super::rows::ValidationRow;
use super::{COMMON, embedded_rows};

/// The rows of the program's files about a vehicle on a cycle. Only these are read: all rows would take longer than a run.
pub fn published(subject: &str, cycle: &str) -> Vec<ValidationRow> {
    let quoted = [subject, cycle].map(|word| format!("\"{word}\""));
    let is_about = |row: &&str| {
        let mut lines = row.lines().filter(|line| line.starts_with("about = "));
        lines.any(|line| quoted.iter().all(|word| line.contains(word.as_str())))
    };
    let reduced = |(name, text): &(&str, &str)| {
        let mut parts = text.split(ROW);
        let head = parts.next()?;
        let rows: Vec<&str> = parts.filter(is_about).collect();
        (!rows.is_empty()).then(|| ((*name).to_owned(), [&[head], &rows[..]].concat().join(ROW)))
    };
    let files: Vec<(String, String)> = embedded_rows().iter().filter_map(reduced).collect();
    let read = if files.is_empty() {
        Ok(Vec::new())
    } else {
        read(COMMON, &files)
    };
    let rows = read.into_iter().flatten().flat_map(|file| file.rows);
    rows.filter(|row| {
        let about = row.about.as_ref();
        about.is_some_and(|about| about.subject == subject && about.cycle == cycle)
    })
    .collect()
}

/// The beginning of a row.
const ROW: &str = "\n[[row]]\n";
