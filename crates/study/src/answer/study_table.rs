//! The table of runs by car and point, a column at a time.

use std::sync::Arc;

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

/// A study's table, seen by car and point. Points of parts that are not there have no numbers.
pub struct StudyTable<'a> {
    /// What the table is.
    pub outline: &'a StudyManifest,
    source: &'a dyn TableSource,
    status: Vec<Status>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Its part is not there.
    Missing,
    /// Fine.
    Ok,
    /// A check failed.
    Failed,
    /// Its values do not go together.
    NotRun,
}

impl<'a> StudyTable<'a> {
    /// Reads how the runs ended.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn new(outline: &'a StudyManifest, source: &'a dyn TableSource) -> Result<Self, Problem> {
        let mut frame = StudyTable {
            outline,
            source,
            status: Vec::new(),
        };
        let mut status = vec![Status::Missing; frame.cells()];
        frame.each("status", |at, values| {
            let Values::Text(words) = values else {
                return;
            };
            for (cell, word) in status.iter_mut().skip(at).zip(words) {
                *cell = match &*word {
                    "ok" => Status::Ok,
                    "failed" => Status::Failed,
                    _ => Status::NotRun,
                };
            }
        })?;
        frame.status = status;
        Ok(frame)
    }

    fn points(&self) -> usize {
        usize::try_from(self.outline.points).unwrap_or(usize::MAX)
    }

    fn cells(&self) -> usize {
        self.points().saturating_mul(self.outline.cars.len())
    }

    /// Hands on the cells of a column part by part, with the index of the first one.
    fn each(&self, name: &str, mut f: impl FnMut(usize, Values)) -> Result<(), Problem> {
        let per_part = self
            .outline
            .points_per_part
            .saturating_mul(self.outline.cars.len() as u64);
        for part in self.source.parts() {
            let values = self.source.columns(part, &[name])?.into_iter().next();
            let at = usize::try_from(part.saturating_mul(per_part)).unwrap_or(usize::MAX);
            if let Some(values) = values.filter(|_| at < self.cells()) {
                f(at, values);
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
        self.status.iter().filter(|s| **s == status).count()
    }

    /// How the runs of a car ended, by point.
    pub fn status(&self, car: usize) -> impl Iterator<Item = Status> {
        let cars = self.outline.cars.len();
        self.status.iter().skip(car).step_by(cars).copied()
    }

    /// A number of a car at each point; NaN where its run was not ok (or, for what compares it with the subject, the subject's was not).
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn numbers(&self, name: &str, car: usize) -> Result<Vec<f64>, Problem> {
        let mut numbers = self.all_numbers(name, car)?;
        let compares = name.starts_with("subject_excess_");
        for ((x, own), subject) in numbers.iter_mut().zip(self.status(car)).zip(self.status(0)) {
            if own != Status::Ok || (compares && subject != Status::Ok) {
                *x = f64::NAN;
            }
        }
        Ok(numbers)
    }

    /// A number of a car at each point, whatever its run's status.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn all_numbers(&self, name: &str, car: usize) -> Result<Vec<f64>, Problem> {
        let cells = |values| match values {
            Values::Number(cells) => cells,
            _ => Vec::new(),
        };
        self.of_car(name, car, f64::NAN, cells)
    }

    /// Numbers of all cars at each point, by name and car; NaN where its run was not ok. Reads each part once.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn by_car(&self, names: &[&str]) -> Result<Vec<Vec<Vec<f64>>>, Problem> {
        let cars = self.outline.cars.len();
        let mut all = vec![vec![vec![f64::NAN; self.points()]; cars]; names.len()];
        let per_part = usize::try_from(self.outline.points_per_part).unwrap_or(usize::MAX);
        for part in self.source.parts() {
            let first = usize::try_from(part)
                .unwrap_or(usize::MAX)
                .saturating_mul(per_part);
            let columns = self.source.columns(part, names)?;
            for (into, values) in all.iter_mut().zip(columns) {
                let Values::Number(cells) = values else {
                    continue;
                };
                for (k, cell) in cells.into_iter().enumerate() {
                    let point = first + k / cars;
                    let is_ok = self.status.get(point * cars + k % cars) == Some(&Status::Ok);
                    if let Some(into) = into[k % cars].get_mut(point).filter(|_| is_ok) {
                        *into = cell;
                    }
                }
            }
        }
        Ok(all)
    }

    /// A word of a car at each point; empty where there is none.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn words(&self, name: &str, car: usize) -> Result<Vec<Arc<str>>, Problem> {
        let cells = |values| match values {
            Values::Text(cells) => cells,
            _ => Vec::new(),
        };
        self.of_car(name, car, "".into(), cells)
    }

    /// The cells of a car at each point.
    fn of_car<T: Clone>(
        &self,
        name: &str,
        car: usize,
        missing: T,
        cells: impl Fn(Values) -> Vec<T>,
    ) -> Result<Vec<T>, Problem> {
        let cars = self.outline.cars.len();
        let mut all = vec![missing; self.points()];
        self.each(name, |at, values| {
            // A damaged part may have more rows than the study has points.
            let into = all.iter_mut().skip(at / cars);
            let of_car = cells(values).into_iter().skip(car).step_by(cars);
            into.zip(of_car).for_each(|(into, cell)| *into = cell);
        })?;
        Ok(all)
    }
}
