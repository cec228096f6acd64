//! What is wrong with an input, as data: kind, place, value, allowed range and a hint.

use std::fmt;
use std::ops::{Deref, DerefMut};

use serde::Serialize;

/// Location in the user's input.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Place {
    /// File name as the user gave it, `embedded:NAME`, or `--set` / `--ambient` for the command line.
    pub file: String,
    /// Line, counted from 1; 0 where the input has no lines.
    pub line: usize,
    /// Column of the first character of the value, counted from 1; 0 where unknown.
    pub column: usize,
    /// The text of that line, for the caret; empty where unknown.
    pub line_text: String,
    /// Number of characters that the caret underlines.
    pub width: usize,
}

impl Place {
    /// A whole file, or an option of the command line.
    #[must_use]
    pub fn file(file: impl Into<String>) -> Self {
        Place {
            file: file.into(),
            ..Place::default()
        }
    }
}

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
    Syntax syntax "Text that is not valid TOML, CSV, JSON or Parquet.";
    TooLarge too_large "More rows, values, bytes or cases than the limit.";
    Unreadable unreadable "A file that cannot be read.";
    Output output "A file or folder that cannot be written.";
    Failed failed "A calculation without a result.";
    Stopped stopped "The user or a time limit stopped the work.";
}

/// One problem of the user's input. All problems of an input are collected before any is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// What kind of problem it is.
    pub kind: ProblemKind,
    /// Where it is.
    pub place: Place,
    /// Dotted key, CSV column name or option; empty where the whole file is meant.
    pub key: String,
    /// The offending value as written; empty where something is missing.
    pub value: String,
    /// What would be accepted, in words or as a range with its unit; empty where there is no range.
    pub allowed: String,
    /// What is wrong, one sentence without the place.
    pub message: String,
    /// What to do about it; empty if nothing useful can be said.
    pub hint: String,
    /// Known names that may have been meant, the most likely first.
    pub suggested: Vec<String>,
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

    /// At this place.
    #[must_use]
    pub fn at(self, place: Place) -> Self {
        Problem { place, ..self }
    }

    /// In this file or option, without a line.
    #[must_use]
    pub fn in_file(self, file: impl Into<String>) -> Self {
        self.at(Place::file(file))
    }

    /// Of this key, column or option.
    #[must_use]
    pub fn key(self, key: impl Into<String>) -> Self {
        let key = key.into();
        Problem { key, ..self }
    }

    /// With this offending value.
    #[must_use]
    pub fn value(self, value: impl Into<String>) -> Self {
        let value = value.into();
        Problem { value, ..self }
    }

    /// With the accepted values.
    #[must_use]
    pub fn allowed(self, allowed: impl Into<String>) -> Self {
        let allowed = allowed.into();
        Problem { allowed, ..self }
    }

    /// With another message.
    #[must_use]
    pub fn message(self, message: impl Into<String>) -> Self {
        let message = message.into();
        Problem { message, ..self }
    }

    /// With the context in which it was found at the beginning of its message.
    #[must_use]
    pub fn with_context(self, context: &str) -> Self {
        let message = format!("{context}{}", self.message);
        self.message(message)
    }

    /// With this hint.
    #[must_use]
    pub fn hint(self, hint: impl Into<String>) -> Self {
        let hint = hint.into();
        Problem { hint, ..self }
    }

    /// With known names that may have been meant.
    #[must_use]
    pub fn suggest(self, names: &[&str]) -> Self {
        let suggested = names.iter().map(|name| (*name).to_owned()).collect();
        Problem { suggested, ..self }
    }

    /// The last entry of a list that would be too long: how many more problems the file has.
    #[must_use]
    pub fn more(file: &str, count: usize) -> Self {
        let more = if count == 1 {
            "problem is"
        } else {
            "problems are"
        };
        Problem::new(
            ProblemKind::NotShown(count),
            format!("{count} more {more} not shown"),
        )
        .in_file(file)
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

impl fmt::Display for Problem {
    /// One line: place, message, hint.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { file, line, .. } = &self.place;
        match (file.as_str(), *line) {
            ("", _) => {}
            (file, 0) => write!(f, "{file}: ")?,
            (file, line) => write!(f, "{file}:{line}: ")?,
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

/// All problems of an input; the error of what reads or checks one.
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

    /// Adds one, whatever their number.
    pub fn push(&mut self, problem: Problem) {
        self.0.push(problem);
    }

    /// Keeps those for which `keep` is true.
    pub fn retain(&mut self, keep: impl FnMut(&Problem) -> bool) {
        self.0.retain(keep);
    }

    /// Removes the one at `index`, which is below their number.
    pub fn remove(&mut self, index: usize) -> Problem {
        self.0.remove(index)
    }

    /// Removes the last one.
    pub fn pop(&mut self) -> Option<Problem> {
        self.0.pop()
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
                    rest = Some(Problem::more(
                        &problem.place.file,
                        before + count.unwrap_or(1),
                    ));
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
    type Target = [Problem];

    fn deref(&self) -> &[Problem] {
        &self.0
    }
}

impl DerefMut for Problems {
    fn deref_mut(&mut self) -> &mut [Problem] {
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

impl From<Problems> for Vec<Problem> {
    fn from(problems: Problems) -> Self {
        problems.0
    }
}

impl FromIterator<Problem> for Problems {
    fn from_iter<I: IntoIterator<Item = Problem>>(problems: I) -> Self {
        Problems(problems.into_iter().collect())
    }
}

impl Extend<Problem> for Problems {
    fn extend<I: IntoIterator<Item = Problem>>(&mut self, problems: I) {
        self.0.extend(problems);
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
        for (k, problem) in self.iter().enumerate() {
            if k > 0 {
                f.write_str("\n")?;
            }
            problem.fmt(f)?;
        }
        Ok(())
    }
}

impl std::error::Error for Problems {}

/// A number for a sentence: so many decimals, and with a power of ten where the figures before the point would be no help.
pub fn readable(x: f64, decimals: usize) -> String {
    if x.abs() < 1e6 {
        format!("{x:.decimals$}")
    } else {
        format!("{x:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some(count: usize) -> Problems {
        (0..count)
            .map(|_| Problem::invalid("no").in_file("f"))
            .collect()
    }

    #[test]
    fn problems_beyond_some_number_are_counted_together() {
        let mut all = Problems::new();
        all.append(some(MAX_DESCRIBED - 1));
        assert_eq!(all.len(), MAX_DESCRIBED - 1);
        all.append(some(2));
        assert_eq!(all[MAX_DESCRIBED].message, "1 more problem is not shown");
        let mut found = some(3);
        found.push(Problem::more("f", 70));
        all.append(found);
        all.append(Problems::new());
        assert_eq!(
            (all.len(), &all[MAX_DESCRIBED]),
            (MAX_DESCRIBED + 1, &Problem::more("f", 74))
        );
        assert!(
            all[..MAX_DESCRIBED]
                .iter()
                .all(|problem| problem.not_shown().is_none())
        );
        let mut short = some(1);
        short.append(Problem::more("g", 5).into());
        short.append(some(1));
        assert_eq!((short.len(), short[2].not_shown()), (3, Some(5)));
        assert_eq!(short.iter().filter_map(Problem::not_shown).count(), 1);
    }

    #[test]
    fn problems_are_an_error_with_text() {
        let mut problems = some(1);
        problems.push(Problem::missing("no mass").hint("add it"));
        let error: Box<dyn std::error::Error> = Box::new(problems);
        assert_eq!(error.to_string(), "f: no\nno mass (add it)");
    }
}
