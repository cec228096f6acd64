//! A study put together of shards: folders in which parts of it were driven, by other processes or on other machines.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::dir::{StudyDir, other_settings};
use super::names::{self, Layout, MANIFEST, PLAN};
use super::read::{Study, is_whole, marked_parts};
use cvtcycle_config::ProblemKind::{Conflict, Damaged, Duplicate, Missing, Unreadable};
use cvtcycle_config::bounded::{self, ReadError};
use cvtcycle_config::{Problem, Problems, Setting};
use cvtcycle_output::files::problem;

/// Ranges of missing parts that are listed.
const MAX_LISTED: usize = 12;

/// A folder with parts of a study. What all shards have alike is not held for each.
struct Shard {
    path: PathBuf,
    layout: Layout,
}

/// Inputs that a study was begun with, byte for byte.
struct Begun {
    path: PathBuf,
    manifest: Vec<u8>,
    plan: Vec<u8>,
}

impl Begun {
    fn read(path: &Path) -> Result<Self, Problem> {
        let read = |name: &str, limit| {
            let file = path.join(name);
            let unreadable = |error: ReadError| {
                let message = format!("cannot read {name} in {}: {error}", path.display());
                problem(path, &message, error.hint("check its permissions")).kind(Unreadable)
            };
            bounded::read_file(file, limit).map_err(unreadable)
        };
        Ok(Begun {
            manifest: read(MANIFEST, bounded::RECORD)?,
            plan: read(PLAN, bounded::TOML)?,
            path: path.to_path_buf(),
        })
    }

    /// The problem of a shard that was begun with something else.
    fn foreign(&self, shard: &Begun) -> Problem {
        let found = other_settings(&shard.path, (&shard.manifest, &self.manifest), &self.plan);
        let hint = format!(
            "all shards are of one plan and one build of the program, here those of {}",
            self.path.display()
        );
        found.kind(Conflict).hint(hint).settings(&[])
    }
}

impl Shard {
    fn open(path: &Path) -> Result<(Self, Begun), Problem> {
        let study = Study::open(path)?;
        let shard = Shard {
            path: path.to_path_buf(),
            layout: study.layout().clone(),
        };
        Ok((shard, Begun::read(path)?))
    }

    /// The mark of a part, byte for byte: the checksums of its files.
    fn mark(&self, part: usize) -> Option<Vec<u8>> {
        let file = names::parts_folder(&self.path).join(names::part_mark(part));
        bounded::read_file(file, bounded::CHECKSUMS).ok()
    }
}

/// Where each part is: the number of its shard.
type Found = BTreeMap<usize, usize>;

impl StudyDir {
    /// Puts the parts of shards into a new study in a directory. Shards are studies with one manifest, byte for byte. A part that two of
    /// them have is taken once, if both have the same bytes.
    ///
    /// # Errors
    /// All problems at once, each with its folder: no study, a folder that is named twice, a study of another plan, a damaged part, a part
    /// that differs in two shards, parts that are in none. Nothing is written then.
    pub fn merge(
        path: impl AsRef<Path>,
        shards: &[PathBuf],
        force: bool,
    ) -> Result<Self, Problems> {
        let path = path.as_ref();
        let mut problems = Problems::new();
        check_names(path, shards, &mut problems);
        let mut first: Option<Begun> = None;
        let (mut opened, mut foreign) = (Vec::new(), Problems::new());
        for path in shards {
            let Some((shard, begun)) = problems.take(Shard::open(path)) else {
                continue;
            };
            opened.push(shard);
            match &first {
                None => first = Some(begun),
                Some(first) if first.manifest == begun.manifest => {}
                Some(first) => foreign.add(first.foreign(&begun)),
            }
        }
        problems.extend(foreign);
        let (Some(first), shards) = (first, opened) else {
            return Err(problems);
        };
        // Problems of the parts of a foreign study would only follow from the first.
        problems.finish()?;
        let mut problems = Problems::new();
        let found = parts_of(&shards, &mut problems);
        let parts = shards.first().map_or(0, |shard| shard.layout.parts);
        missing(path, &found, parts, &mut problems);
        problems.finish()?;
        let dir = StudyDir::create(path, &first.manifest, &first.plan, force)?;
        for (part, shard) in found {
            dir.adopt(part, &shards[shard].path)?;
        }
        Ok(dir)
    }
}

/// Reports folders that are named twice, and the new one among them.
fn check_names(path: &Path, shards: &[PathBuf], problems: &mut Problems) {
    let real = |path: &Path| fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let mut seen = vec![real(path)];
    for shard in shards {
        let own = real(shard);
        if seen.contains(&own) {
            let message = format!("{} is named twice", shard.display());
            let found = problem(shard, &message, "name each folder once");
            problems.add(found.kind(Duplicate));
        }
        seen.push(own);
    }
}

/// The parts that are there; reports damaged ones, and those that differ.
fn parts_of(shards: &[Shard], problems: &mut Problems) -> Found {
    let mut found = Found::new();
    for (number, shard) in shards.iter().enumerate() {
        let name = shard.path.display();
        let layout = &shard.layout;
        let marked = marked_parts(&shard.path, layout).map_err(|error| {
            let message = format!("cannot read the parts in {name}: {error}");
            problem(&shard.path, &message, "check its permissions").kind(Unreadable)
        });
        for part in problems.take(marked).unwrap_or_default() {
            if !is_whole(&shard.path, layout, part) {
                let message = format!(
                    "part {part} in {name} is damaged: a file is not there, or has not the checksum of its mark"
                );
                let hint = "continue the study there, which drives that part again";
                let found = problem(&shard.path, &message, hint).settings(&[Setting::Resume]);
                problems.add(found.kind(Damaged));
                continue;
            }
            match found.get(&part) {
                None => {
                    found.insert(part, number);
                }
                Some(before) if shards[*before].mark(part) == shard.mark(part) => {}
                Some(before) => {
                    let other = shards[*before].path.display();
                    let message = format!("part {part} in {name} is another one than in {other}");
                    let hint =
                        "one of the two machines computes wrongly: drive the part on a third one";
                    problems.add(problem(&shard.path, &message, hint).kind(Conflict));
                }
            }
        }
    }
    found
}

/// Reports the parts that no shard has.
fn missing(path: &Path, found: &Found, parts: usize, problems: &mut Problems) {
    let mut ranges: Vec<(usize, usize)> = Vec::new();
    for part in (0..parts).filter(|part| !found.contains_key(part)) {
        match ranges.last_mut() {
            Some((_, end)) if *end == part => *end += 1,
            _ => ranges.push((part, part + 1)),
        }
    }
    if ranges.is_empty() {
        return;
    }
    let count: usize = ranges.iter().map(|(from, to)| to - from).sum();
    let word = |(from, to): &(usize, usize)| match to - from {
        1 => from.to_string(),
        _ => format!("{from}..{to}"),
    };
    let listed: Vec<String> = ranges.iter().take(MAX_LISTED).map(word).collect();
    let more = ranges.len().saturating_sub(MAX_LISTED);
    let more = match more {
        0 => String::new(),
        n => format!(" and {n} more ranges"),
    };
    let listed = listed.join(", ");
    let message = format!("{count} of {parts} parts are in no shard: {listed}{more}");
    let hint = "drive them into another folder, or name the folder that has them";
    problems.add(problem(path, &message, hint).kind(Missing));
}
