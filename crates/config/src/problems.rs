//! All problems of an input, which are collected before any is shown.

use std::fmt;
use std::ops::{Deref, DerefMut};

use serde::Serialize;

use super::problem::Problem;

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
