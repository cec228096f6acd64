//! The table of runs by car and point, a column at a time.

use std::sync::Arc;

use super::column::{Column, Gathering};
use crate::execute::manifest::{RUNS, StudyManifest, TRACES};
use crate::store::{self, Values};
use cvtcycle_config::Problem;

/// Whatever holds the parts of a study's table of runs.
pub trait TableSource {
    /// Indices of the parts that are there, ascending.
    fn parts(&self) -> Vec<u64>;

    /// The cells of some columns in one part.
    ///
    /// # Errors
    /// A part that cannot be read.
    fn columns(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem>;

    /// The cells of some columns of the table of traces in one part.
    ///
    /// # Errors
    /// A part that cannot be read, or that has no traces.
    fn traces(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem>;
}

impl TableSource for store::Study {
    fn parts(&self) -> Vec<u64> {
        self.present().iter().map(|part| *part as u64).collect()
    }

    fn columns(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem> {
        self.part(usize::try_from(part).unwrap_or(usize::MAX), RUNS)?
            .read(names)
            .map(|rows| rows.values)
    }

    fn traces(&self, part: u64, names: &[&str]) -> Result<Vec<Values>, Problem> {
        self.part(usize::try_from(part).unwrap_or(usize::MAX), TRACES)?
            .read(names)
            .map(|rows| rows.values)
    }
}

/// A study's table, seen by car and point. Points of parts that are not there have no numbers. No column is held, but those that are asked for.
pub struct StudyTable<'a> {
    /// What the table is.
    pub outline: &'a StudyManifest,
    source: &'a dyn TableSource,
    /// Runs of each car that ended, by how.
    ended: Vec<[u64; 3]>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Fine.
    Ok,
    /// A check failed.
    Failed,
    /// Its values do not go together.
    NotRun,
    /// Its part is not there.
    Missing,
}

/// Rows of one part.
struct PartRows {
    /// Its first point.
    first: usize,
    /// Its points; a damaged part may have more rows.
    points: usize,
    /// Cells of the columns, car by car at each point.
    values: Vec<Values>,
}

impl PartRows {
    /// How the runs ended, where the first column says so.
    fn status(&self) -> &[Arc<str>] {
        match self.values.first() {
            Some(Values::Text(words)) => words,
            _ => &[],
        }
    }
}

impl Status {
    fn of(word: &str) -> Self {
        match word {
            "ok" => Status::Ok,
            "failed" => Status::Failed,
            _ => Status::NotRun,
        }
    }

    /// Whether there is no result to be trusted.
    pub fn is_bad(self) -> bool {
        matches!(self, Status::Failed | Status::NotRun)
    }
}

impl<'a> StudyTable<'a> {
    /// Counts how the runs ended.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn new(outline: &'a StudyManifest, source: &'a dyn TableSource) -> Result<Self, Problem> {
        let mut frame = StudyTable {
            outline,
            source,
            ended: Vec::new(),
        };
        let mut ended = vec![[0; 3]; frame.cars()];
        frame.each(&["status"], |part| {
            let cars = ended.len();
            for (k, word) in part.status().iter().enumerate().take(part.points * cars) {
                ended[k % cars][Status::of(word) as usize] += 1;
            }
            Ok(())
        })?;
        frame.ended = ended;
        Ok(frame)
    }

    fn cars(&self) -> usize {
        self.outline.cars.len()
    }

    /// Number of points.
    pub(super) fn points(&self) -> usize {
        usize::try_from(self.outline.points).unwrap_or(usize::MAX)
    }

    /// Hands on some columns part by part.
    fn each(
        &self,
        names: &[&str],
        mut f: impl FnMut(&PartRows) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        let per_part = usize::try_from(self.outline.points_per_part).unwrap_or(usize::MAX);
        for part in self.source.parts() {
            let part = usize::try_from(part).unwrap_or(usize::MAX);
            let first = part.saturating_mul(per_part);
            let points = self.points().saturating_sub(first).min(per_part);
            if points > 0 {
                let values = self.source.columns(part as u64, names)?;
                f(&PartRows {
                    first,
                    points,
                    values,
                })?;
            }
        }
        Ok(())
    }

    /// Some columns of the traces, part after part: points, cars and the cells of the columns.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn each_trace(
        &self,
        names: &[&str],
        mut f: impl FnMut(&[i64], &[Arc<str>], &[Values]),
    ) -> Result<(), Problem> {
        let wanted: Vec<&str> = ["point", "vehicle"].iter().chain(names).copied().collect();
        for part in self.source.parts() {
            let values = self.source.traces(part, &wanted)?;
            if let [Values::Count(points), Values::Text(cars), rest @ ..] = &values[..] {
                f(points, cars, rest);
            }
        }
        Ok(())
    }

    /// Number of runs that ended so.
    pub fn count(&self, status: Status) -> usize {
        let of_cars = (0..self.cars()).map(|car| self.count_of(car, status));
        of_cars.sum()
    }

    /// Number of runs of a car that ended so.
    pub fn count_of(&self, car: usize, status: Status) -> usize {
        let counts = self.ended.get(car).copied().unwrap_or_default();
        let there = || counts.iter().sum::<u64>();
        let count = match status {
            Status::Missing => self.outline.points.saturating_sub(there()),
            _ => counts[status as usize],
        };
        usize::try_from(count).unwrap_or(usize::MAX)
    }

    /// How the runs of a car ended, by point.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn status(&self, car: usize) -> Result<Vec<Status>, Problem> {
        let of = |word: &Arc<str>| Status::of(word);
        self.of_car("status", car, Status::Missing, |values| match values {
            Values::Text(words) => words.iter().map(of).collect(),
            _ => Vec::new(),
        })
    }

    /// A number of a car at some of the points, in their order; NaN where its run was not ok (or, for what compares it with the subject, the
    /// subject's was not). The column is not held beyond a length.
    ///
    /// # Errors
    /// A part that cannot be read, or no room for a temporary file.
    pub fn column(
        &self,
        name: &str,
        car: usize,
        is_wanted: impl Fn(u64) -> bool,
    ) -> Result<Column, Problem> {
        let cars = self.cars();
        let compares = name.starts_with("subject_excess_");
        let (mut gathering, mut next) = (Gathering::default(), 0);
        let mut push = |point: usize, x: f64| match is_wanted(point as u64) {
            true => gathering.push(x),
            false => Ok(()),
        };
        self.each(&["status", name], |part| {
            let missing = next..part.first;
            missing
                .into_iter()
                .try_for_each(|point| push(point, f64::NAN))?;
            let cells = match part.values.get(1) {
                Some(Values::Number(cells)) => cells.as_slice(),
                _ => &[],
            };
            for k in 0..part.points {
                let status = |car: usize| part.status().get(k * cars + car);
                let is_ok = |car: usize| status(car).is_some_and(|word| **word == *"ok");
                let is_known = is_ok(car) && (!compares || is_ok(0));
                let cell = cells.get(k * cars + car).filter(|_| is_known);
                push(part.first + k, cell.copied().unwrap_or(f64::NAN))?;
            }
            next = part.first + part.points;
            Ok(())
        })?;
        (next..self.points()).try_for_each(|point| push(point, f64::NAN))?;
        gathering.finish()
    }

    /// A number of a car at each point, whatever its run's status.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn all_numbers(&self, name: &str, car: usize) -> Result<Vec<f64>, Problem> {
        self.of_car(name, car, f64::NAN, |values| match values {
            Values::Number(cells) => cells.clone(),
            _ => Vec::new(),
        })
    }

    /// Numbers of all cars at each point, by name and car; NaN where its run was not ok. Reads each part once.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn by_car(&self, names: &[&str]) -> Result<Vec<Vec<Vec<f64>>>, Problem> {
        let cars = self.cars();
        let mut all = vec![vec![vec![f64::NAN; self.points()]; cars]; names.len()];
        let with_status: Vec<&str> = ["status"].iter().chain(names).copied().collect();
        self.each(&with_status, |part| {
            for (into, values) in all.iter_mut().zip(part.values.iter().skip(1)) {
                let Values::Number(cells) = values else {
                    continue;
                };
                for (k, (cell, word)) in cells.iter().zip(part.status()).enumerate() {
                    let into = into[k % cars].get_mut(part.first + k / cars);
                    if let Some(into) = into.filter(|_| **word == *"ok") {
                        *into = *cell;
                    }
                }
            }
            Ok(())
        })?;
        Ok(all)
    }

    /// A word of a car at each point; empty where there is none.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn words(&self, name: &str, car: usize) -> Result<Vec<Arc<str>>, Problem> {
        self.of_car(name, car, "".into(), |values| match values {
            Values::Text(cells) => cells.clone(),
            _ => Vec::new(),
        })
    }

    /// Hands on how each run ended that is bad, and the reason.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn each_reason(&self, mut f: impl FnMut(Status, &str)) -> Result<(), Problem> {
        if self.count(Status::Failed) + self.count(Status::NotRun) == 0 {
            return Ok(());
        }
        self.each(&["status", "reason"], |part| {
            let Some(Values::Text(reasons)) = part.values.get(1) else {
                return Ok(());
            };
            let pairs = part.status().iter().zip(reasons);
            for (word, reason) in pairs.take(part.points * self.cars()) {
                let status = Status::of(word);
                if status.is_bad() {
                    f(status, reason);
                }
            }
            Ok(())
        })
    }

    /// The cells of a car at each point.
    fn of_car<T: Clone>(
        &self,
        name: &str,
        car: usize,
        missing: T,
        cells: impl Fn(&Values) -> Vec<T>,
    ) -> Result<Vec<T>, Problem> {
        let cars = self.cars();
        let mut all = vec![missing; self.points()];
        self.each(&[name], |part| {
            let into = all.iter_mut().skip(part.first);
            let of_car = part.values.first().map(&cells).unwrap_or_default();
            let of_car = of_car.into_iter().skip(car).step_by(cars);
            into.zip(of_car).for_each(|(into, cell)| *into = cell);
            Ok(())
        })?;
        Ok(all)
    }
}
