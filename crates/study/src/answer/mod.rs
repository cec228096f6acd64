//! From a study's table to what it says: each output described, the subject held against its baselines, and which factor decides.

pub mod ambient;
mod column;
mod grid;
mod information;
mod range;
mod study_table;
mod tables;

pub use column::Column;
pub use grid::{GridMatrix, LeastOf};
pub use information::{Information, KnownFactor};
pub use range::Range;
pub use study_table::{StudyTable, TableSource};
pub use tables::tables;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;

use crate::design::{Role, saltelli_role};
use crate::execute::outputs::EXCESS;
use crate::plan::{Design, Factor, FactorValue, Plan};
use crate::statistics::{
    Blocks, Bootstrap, Confidence, Groups, RankSensitivity, Share, SobolIndices, Summary, Tornado,
    TornadoInput, group_means_over, rank_sensitivity, sobol_convergence, tornado,
};
use ambient::{Matrix, matrix};
use cvtcycle_config::Problem;
pub(crate) use study_table::Status;

/// Version of an [`Answer`] as JSON. 2: intervals of any confidence under one name, ends in place of moments where the points are no sample.
const SCHEMA: u32 = 2;

/// What a study says.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// Version of this object.
    pub schema: u32,
    /// Name of the study.
    pub title: String,
    /// The question; may be empty.
    pub question: String,
    /// What the results do not show, a sentence each.
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
    /// Of all intervals.
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
    /// Its ends, where the points are no sample.
    pub excess_range: Option<Range>,
    /// Pairs in which the subject uses more.
    pub worse: Share,
}

/// One output of one car.
#[derive(Clone, Debug, Serialize)]
pub struct OutputAnswer {
    /// Column.
    pub output: String,
    /// Its unit.
    pub unit: String,
    /// Car; for an excess the baseline.
    pub car: String,
    /// Description of draws; none where the points are no sample.
    pub summary: Option<Summary>,
    /// Ends of points that are no sample.
    pub range: Option<Range>,
    /// Sobol indices of growing numbers of samples, the last of all; of a Saltelli design.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sobol: Vec<SobolIndices>,
    /// What knowing each factor would leave of the spread; of designs that sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub information: Option<Information>,
    /// Of a one-at-a-time design.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tornado: Option<Tornado>,
    /// Of factors that are numbers, in designs that sample.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rank: Option<Ranked>,
    /// Means at the levels of factors: in grids of all, else of words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<(String, Groups)>,
    /// Of a grid of two factors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matrix: Option<GridMatrix>,
}

impl OutputAnswer {
    /// Numbers of values and of points without one.
    pub fn counts(&self) -> [u64; 2] {
        let of_draws = self.summary.as_ref().map(|s| [s.n, s.missing]);
        let counts = of_draws.or(self.range.as_ref().map(|r| [r.n, r.missing]));
        counts.unwrap_or_default().map(|n| n as u64)
    }
}

/// Rank correlations with the factors that are drawn numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Ranked {
    /// Names of the factors.
    pub factors: Vec<String>,
    /// Correlations, in their order.
    pub of: RankSensitivity,
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
/// use cvtcycle_study::{NoProgress, PartWriter, Study, StudyManifest, StudyTable, TableSource, answer};
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
/// let manifest = StudyManifest::of(&study);
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
            excess_range: Range::of(&outline.plan, &excess)?,
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

/// Of numbers that are a sample.
fn summary(numbers: &Column, sample: Option<Confidence>) -> Result<Option<Summary>, Problem> {
    let over = |confidence| Summary::over(numbers, confidence);
    sample.map(over).transpose()
}

pub(crate) fn ended(frame: &StudyTable) -> Result<Ended, Problem> {
    let mut reasons = Counts::default();
    frame.each_reason(|status, reason| {
        for one in reason.split("; ") {
            // Of a failed check the name alone: what follows differs from run to run.
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
pub(crate) fn counted(words: impl Iterator<Item = String>) -> Vec<(String, usize)> {
    let mut counts = Counts::default();
    words.for_each(|word| counts.add(&word));
    counts.sorted()
}

/// Points from which rank correlations are computed at most: more would cost memory and tell nothing that can be seen.
const MAX_RANKED: usize = 1 << 16;

/// The values of a factor at the first points, as the design has them. They need no table: a design is a function of the point.
fn values(plan: &Plan, factor: usize, points: usize) -> impl Iterator<Item = Option<FactorValue>> {
    let level = move |point| plan.design.level(&plan.factors, point, factor);
    (0..points as u64).map(move |point| plan.factors[factor].value(level(point)))
}

/// Numbers of a factor.
fn numbers(plan: &Plan, factor: usize, points: usize) -> Vec<f64> {
    let number = |value: Option<FactorValue>| value.and_then(|x| x.number()).unwrap_or(f64::NAN);
    values(plan, factor, points).map(number).collect()
}

/// Words of a factor, or its numbers as words; every word is held once.
fn words(plan: &Plan, factor: usize, points: usize) -> impl Iterator<Item = Arc<str>> {
    let mut known: Vec<(Option<FactorValue>, Arc<str>)> = vec![(None, "".into())];
    let word = move |value: Option<FactorValue>| {
        if let Some((_, text)) = known.iter().find(|(other, _)| *other == value) {
            return text.clone();
        }
        let text: Arc<str> = value
            .iter()
            .map(|value| label(value, ""))
            .collect::<String>()
            .into();
        known.push((value, text.clone()));
        text
    };
    values(plan, factor, points).map(word)
}

fn output(
    frame: &StudyTable,
    (name, unit): &(String, String),
    car: usize,
    confidence: Confidence,
) -> Result<OutputAnswer, Problem> {
    let plan = &frame.outline.plan;
    let sample = plan.design.is_sampled().then_some(confidence);
    let points = frame.points();
    let drawn = described(frame, name, car)?;
    let mut answer = OutputAnswer {
        output: name.clone(),
        unit: unit.clone(),
        car: frame.outline.cars[car].clone(),
        summary: summary(&drawn, sample)?,
        range: Range::of(plan, &drawn)?,
        sobol: Vec::new(),
        information: None,
        tornado: None,
        rank: None,
        levels: Vec::new(),
        matrix: GridMatrix::of(plan, &drawn)?,
    };
    match plan.design {
        Design::Saltelli { .. } => {
            let found = frame.column(name, car, |_| true)?.all()?;
            answer.sobol = sobol(&found, plan.factors.len(), confidence);
            let of = answer.sobol.last().zip(Some(&drawn));
            let of = of.map(|(of, drawn)| Information::of_indices(plan, drawn, of, confidence));
            answer.information = of.transpose()?.flatten();
        }
        Design::OneAtATime { .. } => answer.tornado = Some(of_tornado(plan, &drawn.all()?)),
        _ => {
            let as_words =
                |f: &usize| plan.design == Design::Grid || !plan.factors[*f].values.are_numbers();
            let (levels, numbers): (Vec<usize>, Vec<usize>) =
                (0..plan.factors.len()).partition(as_words);
            let of = answer.summary.as_ref();
            let of = of.map(|of| Information::of_draws(plan, &drawn, of, confidence));
            answer.information = of.transpose()?.flatten();
            if !numbers.is_empty() {
                answer.rank = Some(ranked(plan, &numbers, &drawn, confidence)?);
            }
            for f in levels {
                let groups = group_means_over(|| words(plan, f, points), &drawn, sample)?;
                answer.levels.push((plan.factors[f].name.clone(), groups));
            }
        }
    }
    Ok(answer)
}

fn ranked(
    plan: &Plan,
    drawn: &[usize],
    found: &Column,
    confidence: Confidence,
) -> Result<Ranked, Problem> {
    let found = found.first(MAX_RANKED)?;
    let columns: Vec<Vec<f64>> = drawn
        .iter()
        .map(|&f| numbers(plan, f, found.len()))
        .collect();
    let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    Ok(Ranked {
        factors: drawn
            .iter()
            .map(|&f| plan.factors[f].name.clone())
            .collect(),
        of: rank_sensitivity(&columns, &found, confidence),
    })
}

/// Splits the points of a Saltelli design into its blocks.
fn sobol(numbers: &[f64], factors: usize, confidence: Confidence) -> Vec<SobolIndices> {
    let width = factors + 2;
    let column = |k: usize| numbers.iter().skip(k).step_by(width).copied().collect();
    let columns: Vec<Vec<f64>> = (0..width).map(column).collect();
    let blocks = Blocks {
        a: &columns[0],
        b: &columns[1],
        ab: columns[2..].iter().map(Vec::as_slice).collect(),
    };
    let bootstrap = Bootstrap {
        confidence,
        ..Bootstrap::default()
    };
    sobol_convergence(&blocks, bootstrap)
}

/// Point 0 is the base; the others follow factor by factor.
fn of_tornado(plan: &Plan, numbers: &[f64]) -> Tornado {
    let input = |(f, factor): (usize, &Factor)| {
        let points = values(plan, f, numbers.len()).zip(numbers).skip(1);
        let entry = |(value, number): (Option<FactorValue>, &f64)| {
            Some((label(&value?, &factor.unit), *number))
        };
        TornadoInput {
            name: factor.name.clone(),
            entries: points.filter_map(entry).collect(),
        }
    };
    let inputs: Vec<TornadoInput> = plan.factors.iter().enumerate().map(input).collect();
    tornado(numbers.first().copied().unwrap_or(f64::NAN), &inputs)
}

/// A value as a label: numbers with four figures and their unit.
fn label(value: &FactorValue, unit: &str) -> String {
    let x = match value {
        FactorValue::Word(word) => return word.to_string(),
        FactorValue::Number(x) => *x,
    };
    let digits = match x.abs() > 0.0 {
        true => (3 - x.abs().log10().floor() as i32)
            .clamp(0, 12)
            .unsigned_abs(),
        false => 0,
    };
    let mut text = format!("{x:.*}", digits as usize);
    if text.contains('.') {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    match unit {
        "" | "-" => text,
        unit => format!("{text} {unit}"),
    }
}
