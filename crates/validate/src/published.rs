//! Published numbers that are the headline of a run: rows that say with `about` of which.

use super::read::read;
use super::rows::ValidationRow;
use super::{COMMON, embedded_rows};

/// The rows of the program's files about a vehicle on a cycle, alone or over one of the baselines. Only these are read: all rows would take longer
/// than a run.
pub fn published(subject: &str, baselines: &[&str], cycle: &str) -> Vec<ValidationRow> {
    let quote = |word: &str| format!("\"{word}\"");
    let quoted = [subject, cycle].map(quote);
    let quoted_baselines: Vec<String> = baselines.iter().map(|word| quote(word)).collect();
    let holds = |line: &str, word: &String| line.contains(word.as_str());
    let is_compared = |line: &str| {
        !line.contains(BASELINE) || quoted_baselines.iter().any(|word| holds(line, word))
    };
    let is_about = |row: &&str| {
        let mut lines = row
            .split(ABOUT)
            .skip(1)
            .filter_map(|rest| rest.lines().next());
        lines.any(|line| quoted.iter().all(|word| holds(line, word)) && is_compared(line))
    };
    let rows = rows_of(|row| row.contains(ABOUT) && is_about(row));
    rows.into_iter()
        .filter(|row| {
            let about = row.about.as_ref();
            about.is_some_and(|about| {
                let baseline = about.baseline.as_deref();
                about.subject == subject
                    && about.cycle == cycle
                    && baseline.is_none_or(|name| baselines.contains(&name))
            })
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
/// The key of the vehicle that a row compares with, in that line.
const BASELINE: &str = "baseline = ";
/// The beginning of a row.
const ROW: &str = "\n[[row]]\n";
/// The beginning of a tolerance or a source.
const PART: &str = "\n[";

/// Gives the text before the rows of a file.
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
    use super::super::rows::About;
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
        let keys = |about: About| (about.subject, about.baseline, about.cycle);
        let mut compared: Vec<_> = abouts.map(keys).collect();
        compared.sort();
        compared.dedup();
        assert!(compared.len() > 6, "{compared:?}");
        for (subject, baseline, cycle) in compared {
            let is_about = |row: &&ValidationRow| {
                let about = row.about.as_ref();
                about.is_some_and(|of| {
                    let same = of.baseline.is_none() || of.baseline == baseline;
                    of.subject == subject && of.cycle == cycle && same
                })
            };
            let plain = |row: &ValidationRow| ValidationRow {
                id_place: Place::default(),
                place: Place::default(),
                compute: None,
                cause: None,
                ..row.clone()
            };
            let whole: Vec<ValidationRow> = all.iter().filter(is_about).map(plain).collect();
            let baselines: Vec<&str> = baseline.as_deref().into_iter().collect();
            let own = published(&subject, &baselines, &cycle);
            let own: Vec<ValidationRow> = own.iter().map(plain).collect();
            assert_eq!(
                format!("{own:?}"),
                format!("{whole:?}"),
                "{subject} {baseline:?} {cycle}"
            );
        }
        assert!(published("rover_216_cvt", &["rover_216_5mt"], "nycc").is_empty());
        assert!(published("rover_216_cvt", &[], "ece15_eudc").is_empty());
    }
}
