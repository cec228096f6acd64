//! Values as they are written: in the unit of their key and each with its place, for inputs in which another key decides what a value
//! has to be.
use crate::document::{Node, Value};
use crate::problem::place::Place;
use crate::problem::{Problem, ProblemKind};
use crate::reader::section::Section;
use crate::reader::value::Lookup;
use cvtcycle_model::keys::{Bound, Key, Kind, Presence, Quantity};

/// A value as written. Its checks report at its own place.
#[derive(Clone)]
pub struct RawValue<'r> {
    section: Section<'r>,
    key: String,
    node: &'r Node,
}

impl<'r> Section<'r> {
    /// The value of `key` as written; none if it is absent or, reported already, no value at all.
    pub fn raw(&self, key: &str, allowed: &str, doc: &str) -> Option<RawValue<'r>> {
        self.written(&Key::new(
            key,
            (Kind::Other(allowed), Presence::Optional),
            doc,
        ))
    }

    /// The value of `key` as written; none if it is absent or, reported already, no value at all.
    pub fn written(&self, key: &Key<'_>) -> Option<RawValue<'r>> {
        match self.open(key) {
            Lookup::Found(found) => {
                self.given(
                    key.name,
                    &found,
                    self.reader.document.written(&found.node.span).to_string(),
                    None,
                );
                Some(RawValue {
                    section: self.clone(),
                    key: key.name.to_string(),
                    node: found.node,
                })
            }
            Lookup::Absent | Lookup::Bad => None,
        }
    }
}

impl<'r> RawValue<'r> {
    /// The text of the file.
    #[must_use]
    pub fn text(&self) -> &'r str {
        self.section.reader.document.written(&self.node.span)
    }

    /// Place of the value.
    #[must_use]
    pub fn place(&self) -> Place {
        self.section.reader.document.place(&self.node.span)
    }

    /// True if it is a number, finite or not.
    #[must_use]
    pub fn is_number(&self) -> bool {
        matches!(self.node.value, Value::Integer(_) | Value::Float(_))
    }

    /// True if it is a table.
    #[must_use]
    pub fn is_table(&self) -> bool {
        matches!(self.node.value, Value::Table(_))
    }

    /// The text without its quotes, where it is one.
    #[must_use]
    pub fn word(&self) -> Option<&'r str> {
        match &self.node.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Items of a list.
    #[must_use]
    pub fn items(&self) -> Option<Vec<RawValue<'r>>> {
        match &self.node.value {
            Value::List(items) => Some(
                items
                    .iter()
                    .map(|node| RawValue {
                        node,
                        ..self.clone()
                    })
                    .collect(),
            ),
            _ => None,
        }
    }

    /// The finite number that it is, within its range in the unit of the quantity; otherwise none, and reported.
    #[must_use]
    pub fn number(&self, quantity: Quantity, allowed: Bound) -> Option<f64> {
        self.section
            .check_number(&self.key, || quantity, self.node, allowed)
    }

    /// Reports that it is of another kind than expected.
    pub fn wrong_type(&self, expected: &str) {
        self.section.wrong_type(&self.key, self.node, expected);
    }

    /// Reports it.
    pub fn report(&self, problem: Problem) {
        self.section.report(&self.node.span, &self.key, problem);
    }

    /// Reports that it does not fit.
    pub fn complain(&self, kind: ProblemKind, allowed: &str, message: &str, hint: &str) {
        self.report(Problem::new(kind, message).allowed(allowed).hint(hint));
    }

    /// As [`RawValue::complain`], with a message that names the key.
    pub fn complain_by_name(&self, kind: ProblemKind, allowed: &str, message: &str, hint: &str) {
        let problem = Problem::new(kind, message).names_key();
        self.report(problem.allowed(allowed).hint(hint));
    }
}

/// A complaint of each kind, about a key of a section and about a value.
macro_rules! complaints {
    ($($name:ident $kind:ident $doc:literal;)*) => {
        impl Section<'_> {
            $(#[doc = concat!("As [`Section::complain`]: ", $doc)]
            pub fn $name(&self, key: &str, allowed: &str, message: &str, hint: &str) {
                self.complain(ProblemKind::$kind, key, allowed, message, hint);
            })*
        }

        impl RawValue<'_> {
            $(#[doc = concat!("As [`RawValue::complain`]: ", $doc)]
            pub fn $name(&self, allowed: &str, message: &str, hint: &str) {
                self.complain(ProblemKind::$kind, allowed, message, hint);
            })*
        }
    };
}

complaints! {
    conflict Conflict "values contradict each other.";
    missing Missing "a required value is missing.";
    duplicate Duplicate "something is given twice.";
    unknown_key UnknownKey "a key or column is not known.";
    unknown_name UnknownName "a word is none of the known names.";
    out_of_range OutOfRange "a number is outside its range.";
    too_large TooLarge "there are more values than the limit.";
    mistyped WrongType "the value is of another type.";
}
