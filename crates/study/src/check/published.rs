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
    rows_of(is_about)
        .into_iter()
        .filter(|row| {
            let about = row.about.as_ref();
            about.is_some_and(|about| about.subject == subject && about.cycle == cycle)
        })
        .collect()
}

/// The rows of the program's files with these ids, in their order; none of an id that no row has.
pub fn with_ids(ids: &[&str]) -> Vec<ValidationRow> {
    let heads: Vec<String> = ids.iter().map(|id| format!("id = \"{id}\"\n")).collect();
    let rows = rows_of(|row| heads.iter().any(|head| row.starts_with(head.as_str())));
    let of = |id: &&str| rows.iter().find(|row| row.id == **id).cloned();
    ids.iter().filter_map(of).collect()
}

/// The rows of the program's files whose text is wanted.
fn rows_of(wanted: impl Fn(&&str) -> bool) -> Vec<ValidationRow> {
    let reduced = |(name, text): &(&str, &str)| {
        let mut parts = text.split(ROW);
        let head = parts.next()?;
        let rows: Vec<&str> = parts.filter(&wanted).collect();
        (!rows.is_empty()).then(|| ((*name).to_owned(), [&[head], &rows[..]].concat().join(ROW)))
    };
    let files: Vec<(String, String)> = embedded_rows().iter().filter_map(reduced).collect();
    let read = if files.is_empty() {
        Ok(Vec::new())
    } else {
        read(COMMON, &files)
    };
    read.into_iter()
        .flatten()
        .flat_map(|file| file.rows)
        .collect()
}

/// The beginning of a row.
const ROW: &str = "\n[[row]]\n";
