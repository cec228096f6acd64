//! What is wrong with an input, as data: kind, place, value, allowed range and a hint.

use std::fmt;

use serde::Serialize;

use super::place::{Input, Place};

macro_rules! kinds {
    ($($kind:ident $constructor:ident $doc:literal;)*) => {
        /// Kind of a problem, for programs; the message is for people.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
        #[serde(rename_all = "snake_case")]
        #[non_exhaustive]
        pub enum ProblemKind {
            $(#[doc = $doc] $kind,)*
            /// The value does not fit for another reason, which the message states.
            #[default]
            Invalid,
            /// So many more problems of the file are counted and not described.
            NotShown(usize),
        }

        impl Problem {
            $(#[doc = concat!($doc, " The message is one sentence without the place.")]
            #[must_use]
            pub fn $constructor(message: impl Into<String>) -> Self {
                Problem::new(ProblemKind::$kind, message)
            })*
        }
    };
}

kinds! {
    UnknownKey unknown_key "A key or a column that is not known.";
    UnknownName unknown_name "A word that is none of the known names.";
    Missing missing "A required value, key, column or row is missing.";
    WrongType wrong_type "A value of another type: text for a number, a table for a value.";
    OutOfRange out_of_range "A number outside its range.";
    Duplicate duplicate "Something that is given twice.";
    Conflict conflict "Values that contradict each other.";
    WrongTransmission wrong_transmission "A key of a transmission that the vehicle does not have.";
    NotSingle not_single "A key that holds no single number, where one is needed.";
    Syntax syntax "Text that is not valid TOML, CSV, JSON or Parquet, or no valid expression.";
    TooLarge too_large "More rows, values, bytes or cases than the limit.";
    Unreadable unreadable "A file that cannot be read.";
    Output output "A file or folder that cannot be written.";
    Failed failed "A calculation without a result.";
    Stopped stopped "The user or a time limit stopped the work.";
}

/// A setting of a call that a hint speaks about; a program adds the word by which its user gives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Setting {
    /// Earlier results are replaced.
    Replace,
    /// An interrupted study is continued.
    Resume,
    /// Results that are added to a report.
    Added,
}

/// One problem of an input.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// What kind of problem it is.
    pub kind: ProblemKind,
    /// Where it is.
    pub place: Place,
    /// Dotted key or CSV column name; empty where the whole input is meant.
    pub key: String,
    /// The offending value as written; empty where something is missing.
    pub value: String,
    /// What would be accepted, in words or as a range with its unit; empty where there is no range.
    pub allowed: String,
    /// What is wrong, one sentence without the place.
    pub message: String,
    /// What to do about it; empty if nothing useful can be said.
    pub hint: String,
    /// Settings that the hint speaks about.
    pub settings: &'static [Setting],
    /// Known names that may have been meant, the most likely first.
    pub suggested: Box<[String]>,
}

impl Problem {
    /// A problem of a kind; the message is one sentence without the place.
    #[must_use]
    pub fn new(kind: ProblemKind, message: impl Into<String>) -> Self {
        Problem {
            kind,
            message: message.into(),
            ..Problem::default()
        }
    }

    /// A problem of kind [`ProblemKind::Invalid`].
    #[must_use]
    pub fn invalid(message: impl Into<String>) -> Self {
        Problem::new(ProblemKind::Invalid, message)
    }

    /// With this kind.
    #[must_use]
    pub fn kind(self, kind: ProblemKind) -> Self {
        Problem { kind, ..self }
    }

    /// At this place, in this input or in this argument.
    #[must_use]
    pub fn at(self, place: impl Into<Place>) -> Self {
        let place = place.into();
        Problem { place, ..self }
    }

    /// In this file, without a line.
    #[must_use]
    pub fn in_file(self, file: impl Into<String>) -> Self {
        self.at(Place::file(file))
    }

    /// With the context in which it was found at the beginning of its message.
    #[must_use]
    pub fn with_context(self, context: &str) -> Self {
        let message = format!("{context}{}", self.message);
        self.message(message)
    }

    /// With the settings that its hint speaks about.
    #[must_use]
    pub fn settings(self, settings: &'static [Setting]) -> Self {
        Problem { settings, ..self }
    }

    /// With known names that may have been meant.
    #[must_use]
    pub fn suggest(self, names: &[&str]) -> Self {
        let suggested = names.iter().map(|name| (*name).to_owned()).collect();
        Problem { suggested, ..self }
    }

    /// The last entry of a list that would be too long: how many more problems the file has.
    #[must_use]
    pub fn more(input: Input, count: usize) -> Self {
        let more = if count == 1 {
            "problem is"
        } else {
            "problems are"
        };
        Problem::new(
            ProblemKind::NotShown(count),
            format!("{count} more {more} not shown"),
        )
        .at(input)
        .hint("mend the ones above first; they often have one cause")
    }

    /// The number of a [`Problem::more`]; none of any other problem.
    #[must_use]
    pub fn not_shown(&self) -> Option<usize> {
        match self.kind {
            ProblemKind::NotShown(count) => Some(count),
            _ => None,
        }
    }
}

macro_rules! texts {
    ($($field:ident $doc:literal;)*) => {
        impl Problem {
            $(#[doc = $doc]
            #[must_use]
            pub fn $field(mut self, $field: impl Into<String>) -> Self {
                self.$field = $field.into();
                self
            })*
        }
    };
}

texts! {
    key "Of this key or column.";
    value "With this offending value.";
    allowed "With the accepted values.";
    message "With another message.";
    hint "With this hint.";
}

impl fmt::Display for Problem {
    /// One line: place, message, hint.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { input, line, .. } = &self.place;
        match line {
            _ if *input == Input::default() => {}
            0 => write!(f, "{input}: ")?,
            line => write!(f, "{input}:{line}: ")?,
        }
        f.write_str(&self.message)?;
        if self.hint.is_empty() {
            Ok(())
        } else {
            write!(f, " ({})", self.hint)
        }
    }
}

impl std::error::Error for Problem {}

/// A number for a sentence: so many decimals, and with a power of ten where the figures before the point would be no help.
pub fn readable(x: f64, decimals: usize) -> String {
    if x.abs() < 1e6 {
        format!("{x:.decimals$}")
    } else {
        format!("{x:.1e}")
    }
}
