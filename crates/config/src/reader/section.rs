//! Reading of single values from one table.
use crate::document::{Node, Span, Table, Value};
use crate::problem::place::Place;
use crate::problem::{Problem, ProblemKind};
use crate::reader::Reader;
use crate::reader::path::join;
use cvtcycle_model::keys::Key;

/// A table at a dotted path. An absent table is a table without keys.
#[derive(Clone)]
pub struct Section<'r> {
    pub(crate) reader: &'r Reader<'r>,
    pub(crate) path: String,
    pub(crate) table: Option<&'r Table>,
    /// Header of the table, or of the nearest one around it that exists.
    pub(crate) header: Option<Span>,
    /// True if missing keys go without saying, after a problem with the table itself.
    pub(crate) muted: bool,
}

impl Reader<'_> {
    /// The table of the whole document.
    pub fn root(&self) -> Section<'_> {
        Section {
            reader: self,
            path: String::new(),
            table: Some(&self.document.root),
            header: self.document.header.clone(),
            muted: false,
        }
    }
}

impl<'r> Section<'r> {
    /// Dotted path of the table; empty for the whole document.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// True if the table is present.
    pub fn exists(&self) -> bool {
        self.table.is_some()
    }

    /// True if the key is present, as a value or as a table.
    pub fn has(&self, key: &str) -> bool {
        self.table
            .is_some_and(|table| table.entries.contains_key(key))
    }

    /// Names of the entries of the table, in the order of the alphabet.
    pub fn names(&self) -> Vec<&'r str> {
        self.table
            .map(|table| table.entries.keys().map(String::as_str).collect())
            .unwrap_or_default()
    }

    /// Place of the value of `key`; the header of the table, or the file, where it is absent.
    pub fn place(&self, key: &str) -> Place {
        match self.table.and_then(|table| table.entries.get(key)) {
            Some(entry) => self.reader.document.place(&entry.node.span),
            None => self.absent(key, Problem::default()).place,
        }
    }

    /// The path of a file that the value of `key` names, relative to the folder of the whole input: one that is inherited is relative to
    /// the file in which it is written.
    pub(crate) fn path_of_file(&self, key: &str, file: &str) -> String {
        let node = self.table.and_then(|table| table.entries.get(key));
        let parent = node.and_then(|entry| self.reader.document.parent(&entry.node.span));
        parent.map_or_else(
            || file.to_owned(),
            |parent| parent.folder.join(file).to_string_lossy().into_owned(),
        )
    }

    /// The table `name` within this one. It may be absent: keys read from it are then missing.
    pub fn table(&self, name: &str) -> Section<'r> {
        let mut section = self.below(name);
        self.reader.record(|log| {
            log.values.add_table(&section.path);
            log.tables.insert(section.path.clone());
        });
        match self
            .table
            .and_then(|table| table.entries.get(name))
            .map(|entry| &entry.node)
        {
            Some(Node {
                value: Value::Table(table),
                span,
            }) => {
                (section.table, section.header) = (Some(table), Some(span.clone()));
            }
            Some(node) => {
                self.reader.record(|log| {
                    log.read.insert(section.path.clone());
                });
                self.wrong_type(name, node, "a table");
                section.muted = true;
            }
            None => {}
        }
        section
    }

    /// The table `name` within this one, before it is known whether there is one.
    pub(crate) fn below(&self, name: &str) -> Section<'r> {
        let path = join(&self.path, name);
        Section {
            reader: self.reader,
            path,
            table: None,
            header: self.header.clone(),
            muted: self.muted,
        }
    }

    /// A text that may be absent.
    pub fn optional_text(&self, key: &Key<'_>) -> Option<String> {
        self.read_text(key).ok()
    }

    /// Counts all keys as read, where their meaning is not known.
    pub fn pass_over(&self) {
        for name in self.names() {
            let _ = self.raw(name, "", "");
        }
    }

    /// Adds a problem found in a file that this section names.
    pub fn report_problem(&self, problem: Problem) {
        self.reader.problem(problem);
    }

    /// Adds a problem at the place of `key`, with the value as written, or at the header of the table if the key is absent.
    pub fn report_at(&self, key: &str, problem: Problem) {
        let entry = self.table.and_then(|table| table.entries.get(key));
        match entry.map(|entry| &entry.node) {
            Some(node) => self.report(&node.inner().span, key, problem),
            None => self.reader.report(|| self.absent(key, problem)),
        }
    }

    /// As [`Section::report_at`], for a value that does not fit.
    pub fn complain(&self, kind: ProblemKind, key: &str, allowed: &str, message: &str, hint: &str) {
        self.report_at(key, Problem::new(kind, message).allowed(allowed).hint(hint));
    }

    /// As [`Section::complain`], with a message that names the key.
    pub fn complain_by_name(
        &self,
        kind: ProblemKind,
        key: &str,
        allowed: &str,
        message: &str,
        hint: &str,
    ) {
        let problem = Problem::new(kind, message).names_key();
        self.report_at(key, problem.allowed(allowed).hint(hint));
    }
}
