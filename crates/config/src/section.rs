//! Reading of single values from one table.
use std::ops::RangeInclusive;

use super::bound::Bound;
use super::document::{Node, Span, Table, Value};
use super::near::{one_of, suggest};
use super::reader::{Reader, join};
use super::units::{to_si, unit_of};
use super::value::{Lazy, Lookup};

/// A table at a dotted path. It also stands for a table that is absent and so has no keys.
#[derive(Clone)]
pub struct Section<'r> {
    pub(super) reader: &'r Reader<'r>,
    pub(super) path: String,
    pub(super) table: Option<&'r Table>,
    /// Header of the table, or of the nearest one around it that exists.
    pub(super) header: Option<Span>,
    /// Whether missing keys go without saying, after a problem with the table itself.
    pub(super) muted: bool,
}

impl<'r> Section<'r> {
    pub(super) fn root(reader: &'r Reader<'r>) -> Self {
        let table = Some(&reader.document.root);
        Section {
            reader,
            path: String::new(),
            table,
            header: reader.document.header.clone(),
            muted: false,
        }
    }

    /// Dotted path of the table; empty for the whole document.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Whether the table is present.
    pub fn exists(&self) -> bool {
        self.table.is_some()
    }

    /// Whether the key is present, as a value or as a table.
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

    /// Where the value of `key` stands; the header of the table, or the file, where it is absent.
    pub fn place(&self, key: &str) -> super::problem::Place {
        match self.table.and_then(|table| table.entries.get(key)) {
            Some(entry) => self.reader.document.place(&entry.node.span),
            None => self.absent(key, "", String::new(), String::new()).place,
        }
    }

    /// The table `name` within this one. It may be absent: keys read from it are then missing.
    pub fn table(&self, name: &str) -> Section<'r> {
        let mut section = self.below(name);
        self.reader.note(|log| {
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
                self.reader.note(|log| {
                    log.read.insert(section.path.clone());
                });
                self.wrong_type(name, node, "a table");
                section.muted = true;
            }
            None => {}
        }
        section
    }

    /// The table `name` within this one, before it is known whether there is one. Silent readings know no paths.
    pub(super) fn below(&self, name: &str) -> Section<'r> {
        let path = if self.reader.is_silent() {
            String::new()
        } else {
            join(&self.path, name)
        };
        Section {
            reader: self.reader,
            path,
            table: None,
            header: self.header.clone(),
            muted: self.muted,
        }
    }

    /// A required number, in SI units; NaN after a problem.
    pub fn number(&self, key: &str, allowed: Bound, doc: &str) -> f64 {
        self.read_number(key, allowed, doc)
            .unwrap_or_else(|absent| {
                if absent {
                    self.missing(key, Lazy(|| allowed.in_unit(unit_of(key))));
                }
                f64::NAN
            })
    }

    /// A number, in SI units, with a default in the key's own unit; NaN after a problem.
    pub fn number_or(&self, key: &str, allowed: Bound, default: f64, doc: &str) -> f64 {
        debug_assert!(
            allowed.contains(default),
            "default of {key} is out of range"
        );
        self.read_number(key, allowed, doc)
            .unwrap_or_else(|absent| {
                if !absent {
                    return f64::NAN;
                }
                let si = to_si(key, default);
                self.defaulted(key, default, Some(si));
                si
            })
    }

    /// A number, in SI units, that may be absent; NaN after a problem.
    pub fn optional_number(&self, key: &str, allowed: Bound, doc: &str) -> Option<f64> {
        match self.read_number(key, allowed, doc) {
            Ok(si) => Some(si),
            Err(absent) => (!absent).then_some(f64::NAN),
        }
    }

    /// An integer with a default; the default also after a problem. It is not converted to SI units.
    pub fn integer_or(
        &self,
        key: &str,
        allowed: RangeInclusive<i64>,
        default: i64,
        doc: &str,
    ) -> i64 {
        let range = Lazy(|| match (*allowed.start(), *allowed.end()) {
            (low, i64::MAX) => format!("integer of at least {low}"),
            (low, high) => format!("integer from {low} to {high}"),
        });
        let found = match self.open(key, &range, doc) {
            Lookup::Found(found) => found,
            Lookup::Bad => return default,
            Lookup::Absent => {
                self.defaulted(key, default, Some(to_si(key, default as f64)));
                return default;
            }
        };
        match found.node.value {
            Value::Integer(value) if allowed.contains(&value) => {
                self.given(key, &found, value, Some(to_si(key, value as f64)));
                value
            }
            Value::Integer(_) => {
                self.out_of_range(key, found.node, &range.to_string());
                default
            }
            _ => {
                self.wrong_type(key, found.node, "an integer");
                default
            }
        }
    }

    /// A boolean with a default; the default also after a problem.
    pub fn boolean_or(&self, key: &str, default: bool, doc: &str) -> bool {
        match self.open(key, "true or false", doc) {
            Lookup::Found(found) => {
                if let Value::Boolean(value) = found.node.value {
                    self.given(key, &found, value, None);
                    return value;
                }
                self.wrong_type(key, found.node, "true or false");
            }
            Lookup::Absent => self.defaulted(key, default, None),
            Lookup::Bad => {}
        }
        default
    }

    /// A required text; empty after a problem.
    pub fn text(&self, key: &str, doc: &str) -> String {
        self.read_text(key, "text", doc).unwrap_or_else(|absent| {
            if absent {
                self.missing(key, "text");
            }
            String::new()
        })
    }

    /// A text with a default; empty after a problem.
    pub fn text_or(&self, key: &str, default: &str, doc: &str) -> String {
        self.read_text(key, "text", doc).unwrap_or_else(|absent| {
            if !absent {
                return String::new();
            }
            self.defaulted(key, default, None);
            default.to_string()
        })
    }

    /// A text that may be absent.
    pub fn optional_text(&self, key: &str, doc: &str) -> Option<String> {
        self.read_text(key, "text", doc).ok()
    }

    /// One of `words`, with a default; the default also after a problem.
    pub fn word_or(
        &self,
        key: &str,
        words: &[&'static str],
        default: &'static str,
        doc: &str,
    ) -> &'static str {
        let allowed = Lazy(|| one_of(words));
        match self.open(key, &allowed, doc) {
            Lookup::Found(found) => {
                let Value::Text(text) = &found.node.value else {
                    self.wrong_type(key, found.node, "text");
                    return default;
                };
                if let Some(word) = words.iter().find(|word| *word == text) {
                    self.given(key, &found, text, None);
                    return word;
                }
                let hint = suggest(text, words);
                let message = format!("`{}` is not known for `{}`", text, join(&self.path, key));
                self.report(&found.node.span, key, &allowed.to_string(), message, hint);
            }
            Lookup::Absent => self.defaulted(key, default, None),
            Lookup::Bad => {}
        }
        default
    }

    /// Adds a problem found in a file that this section names.
    pub fn report_problem(&self, problem: super::problem::Problem) {
        self.reader.problem(problem);
    }

    /// Adds a problem at the place of `key`, with the value as written, or at the header of the table
    /// if the key is absent.
    pub fn complain(&self, key: &str, allowed: &str, message: &str, hint: &str) {
        let entry = self.table.and_then(|table| table.entries.get(key));
        let problem = match entry.map(|entry| &entry.node) {
            Some(Node {
                value: Value::Table(table),
                span,
            }) => {
                let span = table.wrapped().map_or(span, |node| &node.span);
                return self.report(span, key, allowed, message.to_string(), hint.to_string());
            }
            Some(node) => {
                return self.report(
                    &node.span,
                    key,
                    allowed,
                    message.to_string(),
                    hint.to_string(),
                );
            }
            None => || self.absent(key, allowed, message.to_string(), hint.to_string()),
        };
        self.reader.fault(problem);
    }
}
