//! Published numbers that are the headline of a run: rows that say with `about` of which.

use super::read::read;
use super::rows::ValidationRow;
use super::{COMMON, embedded_rows};

/// The rows of the program's files about a vehicle on a cycle. Only these are read: all rows would take longer than a run.
pub fn published(subject: &str, cycle: &str) -> Vec<ValidationRow> {
    let quoted = [subject, cycle].map(|word| format!("\"{word}\""));
    let is_about = |row: &&str| {
        let mut lines = row
            .split(ABOUT)
            .skip(1)
            .filter_map(|rest| rest.lines().next());
        lines.any(|line| quoted.iter().all(|word| line.contains(word.as_str())))
    };
    let rows = rows_of(|row| row.contains(ABOUT) && is_about(row));
    rows.into_iter()
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
    let files: Vec<(&str, Vec<&str>)> = embedded_rows()
        .iter()
        .map(|(name, text)| (*name, text.split(ROW).skip(1).filter(&wanted).collect()))
        .filter(|(_, rows): &(_, Vec<&str>)| !rows.is_empty())
        .collect();
    if files.is_empty() {
        return Vec::new();
    }
    let heads = files.iter().map(|(name, _)| head_of(name));
    let heads: Vec<&str> = heads.chain([COMMON.1]).collect();
    let rows: Vec<&str> = files.iter().flat_map(|(_, rows)| rows).copied().collect();
    let mut heads = used(&heads, &rows);
    let common = heads.pop().unwrap_or_default();
    let texts = files.iter().zip(heads).map(|((name, rows), head)| {
        let text = [&[head.as_str()], &rows[..]].concat().join(ROW);
        ((*name).to_owned(), text)
    });
    let texts: Vec<(String, String)> = texts.collect();
    let read = read((COMMON.0, &common), &texts);
    read.into_iter()
        .flatten()
        .flat_map(|file| file.rows)
        .collect()
}

/// The beginning of the line that says which run a row is about.
const ABOUT: &str = "\nabout = ";
/// The beginning of a row.
const ROW: &str = "\n[[row]]\n";
/// The beginning of a tolerance or a source.
const PART: &str = "\n[";

/// What is before the rows of a file.
fn head_of(name: &str) -> &'static str {
    let file = embedded_rows().iter().find(|(of, _)| *of == name);
    file.and_then(|(_, text)| text.split(ROW).next())
        .unwrap_or_default()
}

/// The heads without the tolerances and sources that neither the rows nor what they use name.
fn used(heads: &[&str], rows: &[&str]) -> Vec<String> {
    let split: Vec<Vec<&str>> = heads
        .iter()
        .map(|head| head.split(PART).collect())
        .collect();
    let mut named: Vec<&str> = rows.to_vec();
    let mut kept: Vec<Vec<bool>> = split.iter().map(|parts| vec![false; parts.len()]).collect();
    let mut at = 0;
    while let Some(text) = named.get(at).copied() {
        at += 1;
        for (parts, kept) in split.iter().zip(&mut kept) {
            for (part, kept) in parts.iter().zip(kept).skip(1) {
                if !*kept && name(part).is_none_or(|name| text.contains(name)) {
                    *kept = true;
                    named.push(part);
                }
            }
        }
    }
    let of_head = |(parts, kept): (&Vec<&str>, &Vec<bool>)| {
        let first = parts.iter().take(1).copied();
        let rest = parts.iter().zip(kept).filter(|(_, kept)| **kept);
        let all: Vec<&str> = first.chain(rest.map(|(part, _)| *part)).collect();
        all.join(PART)
    };
    split.iter().zip(&kept).map(of_head).collect()
}

/// The name in `sources.NAME]`, what follows after it left out.
fn name(part: &str) -> Option<&str> {
    let (title, _) = part.split_once(']')?;
    title.split('.').nth(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cvtcycle_config::Place;

    /// The whole files, read with all that is in them: the same rows, but for their places.
    #[test]
    fn rows_are_those_of_the_whole_files() {
        let files: Vec<(String, String)> = (embedded_rows().iter())
            .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()))
            .collect();
        let all = read(COMMON, &files).expect("the program's own rows");
        let all: Vec<ValidationRow> = all.into_iter().flat_map(|file| file.rows).collect();
        let abouts = all.iter().filter_map(|row| row.about.clone());
        let mut pairs: Vec<_> = abouts.map(|about| (about.subject, about.cycle)).collect();
        pairs.sort();
        pairs.dedup();
        assert!(pairs.len() > 4, "{pairs:?}");
        for (subject, cycle) in pairs {
            let is_about = |row: &&ValidationRow| {
                let about = row.about.as_ref();
                about.is_some_and(|of| of.subject == subject && of.cycle == cycle)
            };
            let plain = |row: &ValidationRow| ValidationRow {
                id_place: Place::default(),
                place: Place::default(),
                compute: None,
                cause: None,
                ..row.clone()
            };
            let whole: Vec<ValidationRow> = all.iter().filter(is_about).map(plain).collect();
            let own: Vec<ValidationRow> = published(&subject, &cycle).iter().map(plain).collect();
            assert_eq!(
                format!("{own:?}"),
                format!("{whole:?}"),
                "{subject} {cycle}"
            );
        }
        assert!(published("rover_216_cvt", "nycc").is_empty());
    }
}
