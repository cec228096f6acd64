//! The table of runs by car and point, a column at a time.

use std::sync::Arc;

use super::manifest::StudyManifest;
use super::table::Values;
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
            if let Values::Text(words) = values {
                for (cell, word) in status.iter_mut().skip(at).zip(words) {
                    *cell = match &*word {
                        "ok" => Status::Ok,
                        "failed" => Status::Failed,
                        _ => Status::NotRun,
                    };
                }
            }
        })?;
        frame.status = status;
        Ok(frame)
    }

    fn cells(&self) -> usize {
        usize::try_from(self.outline.points)
            .unwrap_or(usize::MAX)
            .saturating_mul(self.outline.cars.len())
    }

    fn each(&self, name: &str, mut f: impl FnMut(usize, Values)) -> Result<(), Problem> {
        let per_part = usize::try_from(self.outline.points_per_part).unwrap_or(usize::MAX)
            * self.outline.cars.len();
        for part in self.source.parts() {
            let values = self.source.columns(part, &[name])?;
            let at = usize::try_from(part)
                .unwrap_or(usize::MAX)
                .saturating_mul(per_part);
            if let (Some(values), true) = (values.into_iter().next(), at < self.cells()) {
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
    #[must_use]
    pub fn count(&self, status: Status) -> usize {
        self.status.iter().filter(|s| **s == status).count()
    }

    /// How the runs of a car ended, by point.
    pub fn status(&self, car: usize) -> impl Iterator<Item = Status> {
        self.status
            .iter()
            .skip(car)
            .step_by(self.outline.cars.len())
            .copied()
    }

    /// A number of a car at each point; NaN where its run was not ok (or, for what compares it with the subject, the subject's was not).
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn numbers(&self, name: &str, car: usize) -> Result<Vec<f64>, Problem> {
        self.numbers_where(name, car, true)
    }

    /// A number of a car at each point, whatever its run's status.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn all_numbers(&self, name: &str, car: usize) -> Result<Vec<f64>, Problem> {
        self.numbers_where(name, car, false)
    }

    fn numbers_where(&self, name: &str, car: usize, only_ok: bool) -> Result<Vec<f64>, Problem> {
        let cars = self.outline.cars.len();
        let mut numbers =
            vec![f64::NAN; usize::try_from(self.outline.points).unwrap_or(usize::MAX)];
        let compares = name.starts_with("subject_excess_");
        self.each(name, |at, values| {
            let Values::Number(cells) = values else {
                return;
            };
            for (k, x) in cells.into_iter().enumerate().skip(car).step_by(cars) {
                let cell = at + k;
                if cell >= self.status.len() {
                    break; // more rows than the study has points
                }
                let subject = cell / cars * cars;
                let good = self.status[cell] == Status::Ok
                    && (!compares || self.status[subject] == Status::Ok);
                if good || !only_ok {
                    numbers[cell / cars] = x;
                }
            }
        })?;
        Ok(numbers)
    }

    /// A word of a car at each point; empty where there is none.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn words(&self, name: &str, car: usize) -> Result<Vec<Arc<str>>, Problem> {
        let cars = self.outline.cars.len();
        let empty: Arc<str> = "".into();
        let mut words = vec![empty; usize::try_from(self.outline.points).unwrap_or(usize::MAX)];
        self.each(name, |at, values| {
            if let Values::Text(cells) = values {
                for (k, word) in cells.into_iter().enumerate().skip(car).step_by(cars) {
                    if let Some(cell) = words.get_mut((at + k) / cars) {
                        *cell = word;
                    }
                }
            }
        })?;
        Ok(words)
    }
}
