//! The expressions of a file: the names that they may use, and their faults as problems.

use super::expr::{Expr, Fault, Names, parse};
use super::source::{Kind, Source};
use super::tables;
use cvtcycle_config::{Place, Problem, Section};

/// Sources of a file, and the known keys.
pub struct FileNames<'a> {
    /// Sources of computed values.
    pub sources: &'a [Source],
    /// Keys of the vehicle files.
    pub keys: &'a [String],
}

impl Names for FileNames<'_> {
    fn sources(&self) -> Vec<&str> {
        self.sources.iter().map(|source| &*source.name).collect()
    }

    fn columns(&self, source: usize, totals: bool) -> Vec<&'static str> {
        match self.sources.get(source).map(|source| source.kind) {
            Some(kind) if kind == Kind::Run || !totals => tables::columns(kind, totals),
            _ => Vec::new(),
        }
    }

    fn keys(&self) -> &[String] {
        self.keys
    }
}

/// Parses the expression of a key; its faults are reported as problems with their place in the text. None for an empty text.
pub fn expression(s: &Section, key: &str, text: &str, names: &FileNames) -> Option<Expr> {
    if text.trim().is_empty() {
        return None;
    }
    let report = |fault| s.report_problem(within(s.place(key), key, text, fault));
    let parsed = parse(text, names);
    parsed
        .map_err(|faults| faults.into_iter().for_each(report))
        .ok()
}

/// A fault in an expression as a problem at its place.
fn within(mut place: Place, key: &str, text: &str, fault: Fault) -> Problem {
    // The place is exact if the text is on one line without escapes.
    let quoted = place.line_text.chars().skip(place.column.saturating_sub(1));
    let quoted = quoted.collect::<String>();
    let unquoted = quoted.strip_prefix(['"', '\'']);
    if unquoted.is_some_and(|rest| rest.starts_with(text)) {
        place.column += 1 + fault.at;
        place.width = fault.width;
    }
    let hint = match fault.hint.as_str() {
        "" => "docs/validation_format.md shows what an expression may hold",
        hint => hint,
    };
    Problem::invalid(format!("`{key}`: {}", fault.message))
        .at(place)
        .key(key)
        .value(fault.word)
        .hint(hint)
}
