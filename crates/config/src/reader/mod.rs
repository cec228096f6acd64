//! One pass over a document: what was read, what is known, what is wrong. A `Section` gives the values of a table of keys (`value`: one;
//! `lists`; `choice`; `maps` of files), `log` keeps what was read, `unknown` names what was not.

mod choice;
pub mod lists;
pub(crate) mod log;
pub mod maps;
pub(crate) mod origin;
pub(crate) mod path;
pub(crate) mod raw_value;
pub(crate) mod recorded;
pub(crate) mod section;
pub(crate) mod unknown;
pub(crate) mod value;
mod values;

use std::cell::{Cell, RefCell};

use crate::document::{Document, Entry};
use crate::files::Files;
use crate::problem::place::Place;
use crate::problem::{Problem, Problems};
use crate::reader::log::{KeyInfo, Log};
use crate::reader::path::parent;
use crate::reader::recorded::Recorded;
use crate::reader::unknown::{BELT, is_row, unread};

/// Choice between a belt and a chain.
const KIND_OF_BELT: [&str; 4] = ["transmission", "cvt", "belt", "kind"];

/// One reading session. It collects all problems and what is known about every key that is read.
pub struct Reader<'d> {
    pub(crate) document: &'d Document,
    log: RefCell<Log>,
    /// Problems so far.
    problem_count: Cell<usize>,
    /// Files that the document names.
    pub(crate) files: Option<&'d dyn Files>,
}

impl<'d> Reader<'d> {
    /// Starts to read `document`.
    pub fn new(document: &'d Document) -> Self {
        Reader {
            document,
            log: RefCell::default(),
            problem_count: Cell::new(0),
            files: None,
        }
    }

    /// With the files that the document names.
    #[must_use]
    pub fn with_files(self, files: &'d dyn Files) -> Self {
        Reader {
            files: Some(files),
            ..self
        }
    }

    /// Writes something down.
    pub(crate) fn record(&self, write: impl FnOnce(&mut Log)) {
        write(&mut self.log.borrow_mut());
    }

    /// Counts a problem; `message` describes it, except after many.
    pub(crate) fn report(&self, message: impl FnOnce() -> Problem) {
        self.count(|log| &mut log.problems, message);
    }

    /// Counts a missing key, apart from other problems.
    pub(crate) fn report_missing(&self, message: impl FnOnce() -> Problem) {
        self.count(|log| &mut log.missing, message);
    }

    fn count(
        &self,
        list: impl FnOnce(&mut Log) -> &mut Vec<Problem>,
        message: impl FnOnce() -> Problem,
    ) {
        self.problem_count.set(self.problem_count.get() + 1);
        self.record(|log| {
            if log.has_room() {
                list(log).push(message());
            } else {
                log.more += 1;
            }
        });
    }

    /// Problems so far.
    pub(crate) fn problem_count(&self) -> usize {
        self.problem_count.get()
    }

    /// Adds a problem found outside the reader.
    pub fn problem(&self, problem: Problem) {
        self.report(|| problem);
    }

    /// Every key that was looked up so far, whatever is wrong with its value.
    pub fn known(&self) -> Vec<KeyInfo> {
        self.log.borrow().keys.clone()
    }

    /// Ends the session with every key that was read, in the order of reading.
    ///
    /// # Errors
    /// All problems, in the order of their places, including keys that are present but were never read; of a great many the last entry states
    /// how many more there are.
    pub fn finish(self) -> Result<Vec<KeyInfo>, Problems> {
        self.finish_with_values().map(|(keys, _)| keys)
    }

    /// As [`Reader::finish`], with the values that the parts of the model have read.
    ///
    /// # Errors
    /// As there.
    pub(crate) fn finish_with_values(self) -> Result<(Vec<KeyInfo>, Recorded), Problems> {
        let document = self.document;
        let mut log = self.log.into_inner();
        let mut unknown = Vec::new();
        unread(&log, &document.root, "", &mut unknown);
        // Inherited keys that another box or engine model leaves unused are no mistake of the file.
        // So are those of a belt whose place a chain takes by an assignment.
        let kind = document.root.node(&KIND_OF_BELT);
        let by_assignment = kind.is_some_and(|node| node.span.is_set());
        let useless = |(path, entry): &(String, &Entry)| {
            let replaced = by_assignment && path.starts_with(BELT) && !entry.key.is_set();
            (document.parent(&entry.key).is_some() || replaced) && is_row(path)
        };
        unknown.retain(|found| !useless(found));
        for (path, entry) in unknown {
            if !log.has_room() {
                log.more += 1;
                continue;
            }
            let (problem, meant) = log.unknown(document, &path, entry);
            // A mistyped option explains the missing choice around it, too.
            let explained = |key: &str| {
                meant
                    .as_deref()
                    .is_some_and(|meant| key == meant || key == parent(meant))
            };
            log.missing.retain(|missing| !explained(&missing.key));
            log.problems.push(problem);
        }
        log.problems.append(&mut log.missing);
        if log.problems.is_empty() {
            return Ok((log.keys, log.values));
        }
        let rank = |place: &Place| {
            document
                .sources
                .iter()
                .position(|source| source.input == place.input)
        };
        log.problems.sort_by_key(|problem| {
            let place = &problem.place;
            (rank(place).unwrap_or(usize::MAX), place.line, place.column)
        });
        let mut problems = Problems::new();
        for problem in log.problems {
            if !problems.contains(&problem) {
                problems.push(problem);
            }
        }
        if log.more > 0 {
            problems.push(Problem::more(document.sources[0].input.clone(), log.more));
        }
        Err(problems)
    }
}
