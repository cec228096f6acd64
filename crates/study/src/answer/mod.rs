//! From a study's table to what it says: each output described, the subject held against its baselines, and which factor decides.

pub mod ambient;
mod column;
mod grid;
mod information;
mod levels;
mod output;
mod range;
mod study_table;
mod tables;

pub use column::Column;
pub use grid::{ChoicePair, GridMatrix, MinimumOver};
pub use information::{Information, KnownFactor};
pub use output::{OutputAnswer, Ranked};
pub use range::Range;
pub use study_table::{StudyTable, TableSource};
pub use tables::tables;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::design::{Role, saltelli_role};
use crate::execute::outputs::EXCESS;
use crate::plan::Design;
use crate::statistics::{Confidence, Share, Summary};
use ambient::{Matrix, matrix};
use cvtcycle_config::Problem;
use output::output;
pub use study_table::Status;

/// Version of an [`Answer`] as JSON. 2: intervals of any confidence under one name, ends in place of moments where the points are no sample.
const SCHEMA: u32 = 2;

/// Statistics of a study's results.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Version of this object.
    pub schema: u32,
    /// Name of the study.
    pub title: String,
    /// The question; may be empty.
    pub question: String,
    /// Limits of the results, a sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Points of the design.
    pub points: u64,
    /// Points whose runs are there.
    pub points_done: u64,
    /// Cars, the subject first.
    pub cars: Vec<String>,
    /// How the runs ended.
    pub runs: Ended,
    /// Samples that are described: of a Saltelli design A and B alone.
    pub described: &'static str,
    /// Confidence of all intervals.
    pub confidence: Confidence,
    /// The subject against each baseline.
    pub comparisons: Vec<Comparison>,
    /// Each analysed output of each car.
    pub outputs: Vec<OutputAnswer>,
    /// The matrix, where the study is one of ambient temperatures and starts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matrix: Option<Matrix>,
}

/// How the runs of a study ended.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Ended {
    /// Fine.
    pub ok: usize,
    /// A check failed.
    pub failed: usize,
    /// The values do not go together.
    pub not_run: usize,
    /// Not there yet.
    pub missing: usize,
    /// First words of the reasons with their counts, the commonest first.
    pub reasons: Vec<(String, usize)>,
}

/// The subject against one baseline.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Name of the baseline.
    pub baseline: String,
    /// Excess of the subject's fuel, per cent, over draws.
    pub excess_percent: Option<Summary>,
    /// Lowest and highest excess, where the points are not a sample.
    pub excess_range: Option<Range>,
    /// Pairs in which the subject uses more.
    pub worse: Share,
}

/// Computes what the study says from the parts that are there.
///
/// ```
/// use std::collections::BTreeSet;
/// use std::sync::Mutex;
///
/// use cvtcycle_config::{Problem, Problems};
/// use cvtcycle_study::plan::Plan;
/// use cvtcycle_study::statistics::Confidence;
/// use cvtcycle_study::store::{Rows, Values};
/// use cvtcycle_output::progress::NoProgress;
/// use cvtcycle_study::{PartWriter, Study, StudyManifest, StudyTable, TableSource, answer};
///
/// /// Keeps the table of runs in memory.
/// struct Memory<'s>(&'s Study, Mutex<Vec<(u64, Rows)>>);
///
/// impl PartWriter for Memory<'_> {
///     fn write(&self, part: u64, runs: &Rows, _: Option<&Rows>) -> Result<(), Problem> {
///         self.1.lock().expect("not poisoned").push((part, runs.clone()));
///         Ok(())
///     }
/// }
///
/// impl TableSource for Memory<'_> {
///     fn parts(&self) -> Vec<u64> {
///         (0..self.0.parts()).collect()
///     }
///     fn columns(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem> {
///         let parts = self.1.lock().expect("not poisoned");
///         let rows = parts.iter().find(|(index, _)| *index == part).expect("written");
///         let column = |name: &&str| self.0.columns.iter().position(|head| head.name == *name);
///         Ok(names.iter().filter_map(column).map(|k| rows.1.values[k].clone()).collect())
///     }
///     fn traces(&self, _: u64, _: &[&str]) -> Result<Vec<Values>, Problem> {
///         Ok(Vec::new())
///     }
/// }
///
/// let text = "study.cycle = \"constant_50\"\nstudy.baselines = []\nstudy.design = \"grid\"\n\
///     [[factor]]\nkey = \"ambient_degc\"\nvalues = [0, 25]\n";
/// let study = Study::prepare(Plan::read("plan.toml", text)?)?;
/// let table = Memory(&study, Mutex::default());
/// study.execute(&BTreeSet::new(), &table, &NoProgress)?;
/// let manifest = StudyManifest::new(&study);
/// let answer = answer(&StudyTable::new(&manifest, &table)?, Confidence::default())?;
/// let fuel = answer.outputs[0].range.as_ref().expect("a grid is no sample");
/// assert_eq!((answer.points, answer.runs.ok, fuel.n, fuel.least_at.as_str()), (2, 2, 2, "ambient_degc 25 °C"));
/// # Ok::<(), Problems>(())
/// ```
///
/// # Errors
/// A part that cannot be read.
pub fn answer(frame: &StudyTable, confidence: Confidence) -> Result<Answer, Problem> {
    let outline = frame.outline;
    let sample = outline.plan.design.is_sampled().then_some(confidence);
    let cars = 0..outline.cars.len();
    let compare = |car: usize| -> Result<Comparison, Problem> {
        let excess = described(frame, EXCESS, car)?;
        Ok(Comparison {
            baseline: outline.cars[car].clone(),
            worse: Share::over_zero(&excess, sample)?,
            excess_percent: summary(&excess, sample)?,
            excess_range: Range::from_points(&outline.plan, &excess)?,
        })
    };
    let mut outputs = Vec::new();
    for named in &outline.analysed {
        // The subject has no excess over itself.
        let first = usize::from(named.0.starts_with("subject_excess_"));
        for car in cars.clone().skip(first) {
            outputs.push(output(frame, named, car, confidence)?);
        }
    }
    let missing = frame.count_of(0, Status::Missing) as u64;
    Ok(Answer {
        schema: SCHEMA,
        title: outline.title.clone(),
        question: outline.question.clone(),
        notes: outline.notes.clone(),
        points: outline.points,
        points_done: outline.points - missing,
        cars: outline.cars.clone(),
        runs: ended(frame)?,
        described: match is_saltelli(frame) {
            true => "samples A and B",
            false => "all points",
        },
        confidence,
        comparisons: cars.skip(1).map(compare).collect::<Result<_, _>>()?,
        outputs,
        matrix: matrix(frame)?,
    })
}

fn is_saltelli(frame: &StudyTable) -> bool {
    matches!(frame.outline.plan.design, Design::Saltelli { .. })
}

/// The numbers of a car at the points that are independent draws: all, but of a Saltelli design A and B; nothing else says something of the
/// output's distribution.
///
/// # Errors
/// A part that cannot be read, or no room for a temporary file.
pub fn described(frame: &StudyTable, output: &str, car: usize) -> Result<Column, Problem> {
    let factors = frame.outline.plan.factors.len();
    let mixed = is_saltelli(frame);
    let is_drawn = |point| matches!(saltelli_role(factors, point).1, Role::A | Role::B);
    frame.column(output, car, |point| !mixed || is_drawn(point))
}

/// Summarizes numbers that are a sample.
fn summary(numbers: &Column, sample: Option<Confidence>) -> Result<Option<Summary>, Problem> {
    let over = |confidence| Summary::over(numbers, confidence);
    sample.map(over).transpose()
}

/// Counts how the runs of a study ended.
///
/// # Errors
/// The status column cannot be read.
pub fn ended(frame: &StudyTable) -> Result<Ended, Problem> {
    let mut reasons = Counts::default();
    frame.each_reason(|status, reason| {
        for one in reason.split("; ") {
            // A failed check is counted by its name: the text after it differs from run to run.
            let name = one.split(' ').next().unwrap_or_default();
            reasons.add(if status == Status::Failed { name } else { one });
        }
    })?;
    Ok(Ended {
        ok: frame.count(Status::Ok),
        failed: frame.count(Status::Failed),
        not_run: frame.count(Status::NotRun),
        missing: frame.count(Status::Missing),
        reasons: reasons.sorted(),
    })
}

/// Words with their counts.
#[derive(Default)]
struct Counts(BTreeMap<String, usize>);

impl Counts {
    fn add(&mut self, word: &str) {
        match self.0.get_mut(word) {
            Some(count) => *count += 1,
            None => drop(self.0.insert(word.to_owned(), 1)),
        }
    }

    /// The commonest first.
    fn sorted(self) -> Vec<(String, usize)> {
        let mut counts: Vec<(String, usize)> = self.0.into_iter().collect();
        counts.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
        counts
    }
}

/// Words with their counts, the commonest first.
pub fn counted(words: impl Iterator<Item = String>) -> Vec<(String, usize)> {
    let mut counts = Counts::default();
    words.for_each(|word| counts.add(&word));
    counts.sorted()
}
