//! Where a value is from: its status, source and note, as the file says it or as it is inherited or set.

use std::borrow::Cow;

use crate::document::{Document, Entry, Node, OVERRIDE, Table, Value};
use crate::problem::Problem;
use crate::problem::near::{did_you_mean, one_of, suggest};
use crate::reader::log::KeyInfo;
use crate::reader::path::join;
use crate::reader::section::Section;

/// Allowed statuses of a value in a file.
pub(crate) const STATUSES: [&str; 4] = ["source", "derived", "fitted", "assumed"];
/// Fields of a value with its origin.
const FIELDS: [&str; 6] = ["value", RANGE, "status", "source", "note", COLUMNS];
/// The ends within which a number is known.
const RANGE: &str = "range";
/// The one that only names of CSV files have: which of their columns is which.
pub(crate) const COLUMNS: &str = "columns";
/// Status and source of what an override gives.
const SET: (&str, &str) = ("set", "command line");

impl KeyInfo {
    /// With a number in the key's unit, and its value in SI units, as an override would set it.
    pub(crate) fn set_number(&mut self, number: f64, si: f64) {
        (self.value, self.si) = (number.to_string(), Some(si));
        self.set_by_key(false);
    }

    /// As set by an override of its own key, or of a key in its table, which the file may have.
    pub(crate) fn set_by_key(&mut self, has_table: bool) {
        (self.status, self.source) = (SET.0.to_owned(), SET.1.to_owned());
        self.note.clear();
        self.range = None;
        if !has_table {
            self.from = OVERRIDE.to_owned();
        }
    }
}

/// A value as found, with its origin.
pub(crate) struct Found<'r> {
    pub node: &'r Node,
    pub status: &'r str,
    pub source: &'r str,
    pub note: Cow<'r, str>,
    pub range: Option<[f64; 2]>,
}

impl<'r> Found<'r> {
    /// A value of a file, of one that it inherits from, or of an override, without what it says about itself.
    pub fn new(document: &'r Document, node: &'r Node, own: &'r str) -> Self {
        let (status, source) = match document.parent(&node.span) {
            _ if node.span.is_set() => SET,
            Some(parent) => (parent.status, parent.words.as_str()),
            None => (own, ""),
        };
        Found {
            node,
            status,
            source,
            note: Cow::Borrowed(""),
            range: None,
        }
    }

    /// As set by an override.
    pub fn set(self) -> Self {
        let (status, source) = SET;
        Found {
            status,
            source,
            range: None,
            ..self
        }
    }

    /// Adds what the value says about itself. What an inherited one says is a remark: it is true of the car that it was written for.
    pub(super) fn add(&mut self, own: Origin<'r>, is_inherited: bool) {
        // A car that inherits a value knows as much of it as its class or like car.
        self.range = own.range;
        if is_inherited {
            self.note = Cow::Owned(own.words());
            return;
        }
        if !own.status.is_empty() && self.status != "set" {
            self.status = own.status;
        }
        (self.source, self.note) = (own.source, Cow::Borrowed(own.note));
    }
}

/// Status, source and note that a value states; empty if not stated.
#[derive(Default)]
pub(super) struct Origin<'r> {
    status: &'r str,
    source: &'r str,
    note: &'r str,
    range: Option<[f64; 2]>,
}

impl Origin<'_> {
    /// In one line: "there assumed: the usual fill; 5 l in the manual".
    fn words(&self) -> String {
        let there = match self.status {
            "" => String::new(),
            status => format!("there {status}"),
        };
        let parts = [(&*there, ": "), (self.source, "; "), (self.note, "")].into_iter();
        let mut text = String::new();
        let mut before = "";
        for (part, after) in parts.filter(|(part, _)| !part.is_empty()) {
            text = text + before + part;
            before = after;
        }
        text
    }
}

impl<'r> Section<'r> {
    /// Reads status, source and note of the value, and the columns of a CSV file.
    pub(super) fn origin(&self, key: &str, table: &'r Table, is_csv: bool) -> Origin<'r> {
        let fields = &FIELDS[..FIELDS.len() - usize::from(!is_csv)];
        let mut own = Origin::default();
        for (name, entry) in table.entries.iter().filter(|(name, _)| *name != "value") {
            let text = match &entry.node.value {
                Value::Text(text) => text.as_str(),
                _ => "",
            };
            match name.as_str() {
                RANGE => own.range = self.check_range(key, &entry.node, table.wrapped()),
                "status" => own.status = self.check_status(key, &entry.node, text),
                COLUMNS if !is_csv => self.unknown_field(key, (name, entry), fields),
                "source" | "note" | COLUMNS if !matches!(entry.node.value, Value::Text(_)) => {
                    self.wrong_type(&format!("{key}.{name}"), &entry.node, "text");
                }
                "source" => own.source = text,
                "note" => own.note = text,
                COLUMNS => {}
                _ => self.unknown_field(key, (name, entry), fields),
            }
        }
        own
    }

    /// Reports an entry of a value with its origin that is none of its fields.
    fn unknown_field(&self, key: &str, (name, entry): (&str, &Entry), fields: &[&str]) {
        let message = format!("unknown field `{name}` in `{}`", join(&self.path, key));
        let problem = Problem::unknown_key(message)
            .names_key()
            .allowed(fields.join(", "))
            .hint(suggest(name, fields));
        self.report(&entry.key, key, problem);
    }

    /// The ends of a range, where they hold the value.
    fn check_range(&self, key: &str, node: &Node, value: Option<&Node>) -> Option<[f64; 2]> {
        let number = |node: &Node| match &node.value {
            Value::Integer(value) => Some(*value as f64),
            Value::Float(value) => Some(*value),
            _ => None,
        };
        let ends = match &node.value {
            Value::List(items) => items.iter().map(number).collect::<Option<Vec<f64>>>(),
            _ => None,
        };
        let ends: Option<[f64; 2]> = ends.and_then(|ends| ends.try_into().ok());
        let value = value.and_then(number);
        match (ends, value) {
            (Some([low, high]), Some(x)) if low < high && (low..=high).contains(&x) => ends,
            _ => {
                let message = format!(
                    "`{}` has no range that holds its value",
                    join(&self.path, key)
                );
                let problem = Problem::out_of_range(message)
                    .names_key()
                    .allowed("two numbers with the value between them, low end first")
                    .hint("write `{ value = 1.0, range = [0.5, 3.0], status = \"assumed\" }`");
                self.report(&node.span, key, problem);
                None
            }
        }
    }

    /// The status, where it is a known one.
    fn check_status(&self, key: &str, node: &Node, text: &'r str) -> &'r str {
        if STATUSES.contains(&text) {
            return text;
        }
        let message = format!("`{}` has no known status", join(&self.path, key));
        let problem = Problem::unknown_name(message)
            .names_key()
            .allowed(one_of(&STATUSES))
            .hint(did_you_mean(text, STATUSES).unwrap_or_default());
        self.report(&node.span, key, problem);
        ""
    }
}
