//! Problems of an input, as data: kind, place, value, allowed range and a hint; and all problems of an input, which are collected
//! before any is shown.
//!
//! | file | content |
//! |---|---|
//! | `place` | where: file, line, column, argument or assignment |
//! | `source` | the text of a file, for the lines of problems |
//! | `near` | names like a mistyped one |
//! | `render` | problems as text for people |
//! | `visible` | characters of a stranger's text that must not reach a screen |

pub(crate) mod near;
pub(crate) mod place;
pub(crate) mod render;
pub(crate) mod source;
pub(crate) mod visible;

use crate::problem::place::{Input, Place};
use serde::Serialize;
use std::fmt;
use std::ops::{Deref, DerefMut};

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
            NotShown(u32),
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
    Locked locked "A folder in which another process writes.";
    Damaged damaged "A file of this program with other content than it wrote.";
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
    /// Runs that were not driven alike are compared.
    Loosely,
    /// The columns of a table that are meant.
    Columns,
    /// The repairs of a log.
    Repair,
}

/// A choice with which an input is read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Proposal {
    /// Columns as their setting takes them; empty where they stay.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub columns: String,
    /// Repairs as their setting takes them, besides those that are made; empty where they stay.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub repair: String,
}

/// One problem of an input.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// Kind of problem.
    pub kind: ProblemKind,
    /// Where it is.
    pub place: Place,
    /// Dotted key or CSV column name; empty where the whole input is meant.
    pub key: String,
    /// The offending value as written; empty where something is missing.
    pub value: String,
    /// Accepted values, in words or as a range with its unit; empty where there is no range.
    pub allowed: String,
    /// Message, one sentence without the place.
    pub message: String,
    /// Remedy; empty if nothing useful can be said.
    pub hint: String,
    /// Settings that the hint speaks about.
    pub settings: &'static [Setting],
    /// Known names that may have been meant, the most likely first.
    pub suggested: Box<[String]>,
    /// Columns with which the file is read, as the setting takes them; empty where there are none.
    #[serde(flatten)]
    pub proposal: Option<Box<Proposal>>,
    /// True if the message names the key; else the key is put before it in a text with lines.
    #[serde(skip)]
    pub names_key: bool,
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

    /// Sets the key or column. The message names it only if it was made for it: see [`Problem::names_key`].
    #[must_use]
    pub fn key(self, key: impl Into<String>) -> Self {
        let key = key.into();
        let names_key = self.names_key && self.key == key;
        Problem { names_key, ..self }.for_key(key)
    }

    /// With a message that names the key, which is given before or with the place.
    #[must_use]
    pub fn names_key(self) -> Self {
        let names_key = true;
        Problem { names_key, ..self }
    }

    /// Sets the key or column, which the message names or not, as before.
    pub(crate) fn for_key(self, key: impl Into<String>) -> Self {
        let key = key.into();
        Problem { key, ..self }
    }

    /// With the settings that its hint speaks about.
    #[must_use]
    pub fn settings(self, settings: &'static [Setting]) -> Self {
        Problem { settings, ..self }
    }

    /// With the columns with which the file is read; none if the text is empty.
    #[must_use]
    pub fn columns(self, columns: impl Into<String>) -> Self {
        let columns: String = columns.into();
        let repair = String::new();
        let proposal = (!columns.is_empty()).then(|| Box::new(Proposal { columns, repair }));
        Problem { proposal, ..self }
    }

    /// Columns with which the file is read; empty where there are none.
    #[must_use]
    pub fn proposed(&self) -> &str {
        self.proposal.as_ref().map_or("", |own| &own.columns)
    }

    /// With the repair with which the log is read.
    #[must_use]
    pub fn repair(self, repair: &str) -> Self {
        let columns = self.proposed().to_owned();
        let repair = repair.to_owned();
        let proposal = Some(Box::new(Proposal { columns, repair }));
        Problem { proposal, ..self }
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
            ProblemKind::NotShown(u32::try_from(count).unwrap_or(u32::MAX)),
            format!("{count} more {more} not shown"),
        )
        .at(input)
        .hint("mend the ones above first; they often have one cause")
    }

    /// The number of a [`Problem::more`]; none of any other problem.
    #[must_use]
    pub fn not_shown(&self) -> Option<usize> {
        match self.kind {
            ProblemKind::NotShown(count) => usize::try_from(count).ok(),
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

/// All problems of an input; the error of what reads or checks one. It is used like the list in it; as JSON it is that list.
///
/// ```
/// use cvtcycle_config::setup::{self, Options};
/// let set = vec!["road_load.mass_kg=-3".parse()?];
/// let problems = setup::load("rover_216_cvt", &Options { set, ..Options::default() }).unwrap_err();
/// let json = serde_json::to_value(&problems).unwrap();
/// assert_eq!(json[0]["kind"], "out_of_range");
/// assert_eq!(json[0]["place"]["override"], "road_load.mass_kg=-3");
/// let error: Box<dyn std::error::Error> = problems.into();
/// assert!(error.to_string().contains("`road_load.mass_kg` is out of range"));
/// # Ok::<(), cvtcycle_config::Problem>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Problems(Vec<Problem>);

/// Most problems of one input that are described.
const MAX_DESCRIBED: usize = 1000;

impl Problems {
    /// No problems.
    #[must_use]
    pub fn new() -> Self {
        Problems::default()
    }

    /// Adds the problems of a part of an input after those of the parts before it. Beyond some number they are counted only, in one last
    /// entry: a file of nothing but mistakes has more of them than its own size in memory.
    pub fn append(&mut self, found: Problems) {
        let all = &mut self.0;
        let mut rest = all.pop_if(|last| last.not_shown().is_some());
        for problem in found {
            match (problem.not_shown(), all.len() < MAX_DESCRIBED) {
                (None, true) => all.push(problem),
                (count, _) => {
                    let before = rest.and_then(|rest| rest.not_shown()).unwrap_or(0);
                    let more = Problem::more(problem.place.input, before + count.unwrap_or(1));
                    rest = Some(more);
                }
            }
        }
        all.extend(rest);
    }

    /// These problems after a change of each.
    #[must_use]
    pub fn map(self, change: impl FnMut(Problem) -> Problem) -> Self {
        self.into_iter().map(change).collect()
    }

    /// The value; none after adding its problems.
    pub fn take<T>(&mut self, result: Result<T, impl Into<Problems>>) -> Option<T> {
        result
            .map_err(|found| found.into().into_iter().for_each(|one| self.add(one)))
            .ok()
    }

    /// Adds a problem unless it is known: two cars may name the same bad file.
    pub fn add(&mut self, problem: Problem) {
        if !self.contains(&problem) {
            self.push(problem);
        }
    }

    /// Nothing, or all problems.
    ///
    /// # Errors
    /// There are problems.
    pub fn finish(self) -> Result<(), Problems> {
        if self.is_empty() { Ok(()) } else { Err(self) }
    }
}

impl Deref for Problems {
    type Target = Vec<Problem>;

    fn deref(&self) -> &Vec<Problem> {
        &self.0
    }
}

impl DerefMut for Problems {
    fn deref_mut(&mut self) -> &mut Vec<Problem> {
        &mut self.0
    }
}

impl From<Problem> for Problems {
    fn from(problem: Problem) -> Self {
        Problems(vec![problem])
    }
}

impl From<Vec<Problem>> for Problems {
    fn from(problems: Vec<Problem>) -> Self {
        Problems(problems)
    }
}

impl FromIterator<Problem> for Problems {
    fn from_iter<I: IntoIterator<Item = Problem>>(problems: I) -> Self {
        Problems(problems.into_iter().collect())
    }
}

impl IntoIterator for Problems {
    type Item = Problem;
    type IntoIter = std::vec::IntoIter<Problem>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl<'p> IntoIterator for &'p Problems {
    type Item = &'p Problem;
    type IntoIter = std::slice::Iter<'p, Problem>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

impl fmt::Display for Problems {
    /// One line for each problem.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.iter().map(ToString::to_string).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl std::error::Error for Problems {}
