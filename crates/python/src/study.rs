//! Studies: points computed in whole parts, on disk or in memory, and their results.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use cvtcycle::config::{Bound as Range, Problem, Problems};
use cvtcycle::output::escape::json_text;
use cvtcycle::report::results::StudyResults;
use cvtcycle::report::study_pictures::study_files;
use cvtcycle::study::execute::DirWriter;
use cvtcycle::study::plan::Plan;
use cvtcycle::study::statistics::Confidence;
use cvtcycle::study::store::{RUNS, Rows, Study as Store, StudyDir};
use cvtcycle::study::{PartWriter, Study as CoreStudy};
use pyo3::prelude::*;

use crate::errors::{bad, number, refused};
use crate::job::{Interrupted, Stop, job};
use crate::table::{Table, TableColumn};

/// Plan with its cars loaded and every value tried.
#[pyclass(frozen)]
pub struct Study(Arc<CoreStudy>);

/// Collects parts in memory.
#[derive(Default)]
struct MemorySink(Mutex<BTreeMap<u64, Rows>>);

impl PartWriter for MemorySink {
    fn write(&self, part: u64, runs: &Rows, _: Option<&Rows>) -> Result<(), Problem> {
        let mut parts = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        parts.insert(part, runs.clone());
        Ok(())
    }
}

impl Study {
    /// Checks a range of parts and returns it.
    fn part_range(&self, (from, to): (u64, u64)) -> PyResult<BTreeSet<u64>> {
        let all = self.0.parts();
        if from <= to && to <= all {
            return Ok((from..to).collect());
        }
        let (value, allowed) = (format!("{from}..{to}"), format!("0..{all}"));
        Err(bad(
            "parts",
            &value,
            &allowed,
            "the study has no such parts",
        ))
    }
}

#[pymethods]
impl Study {
    /// Reads the name or path of a plan, or a text cited as `word`.
    #[new]
    fn new(
        py: Python<'_>,
        word: PathBuf,
        text: Option<String>,
        samples: Option<u64>,
        seed: Option<u64>,
    ) -> PyResult<Self> {
        let word = word.to_string_lossy().into_owned();
        let prepare = move |_: &Stop| -> Result<CoreStudy, Problems> {
            let mut plan = match text {
                Some(text) => Plan::read(&word, &text)?,
                None => Plan::open(&word)?,
            };
            plan.design = plan.design.changed(samples, seed)?;
            CoreStudy::prepare(plan)
        };
        let study = job(py, None, Interrupted::Detaches, prepare)?.map_err(refused)?;
        Ok(Study(Arc::new(study)))
    }

    #[getter]
    fn title(&self) -> &str {
        &self.0.plan.title
    }

    #[getter]
    fn points(&self) -> u64 {
        self.0.points
    }

    #[getter]
    fn runs(&self) -> u64 {
        self.0.runs()
    }

    #[getter]
    fn parts(&self) -> u64 {
        self.0.parts()
    }

    #[getter]
    fn points_per_part(&self) -> u64 {
        self.0.points_per_part()
    }

    /// Drives the points of some parts and returns their runs.
    fn run(&self, py: Python<'_>, parts: (u64, u64), threads: Option<usize>) -> PyResult<Table> {
        let (study, wanted) = (Arc::clone(&self.0), self.part_range(parts)?);
        let drive = move |stop: &Stop| -> Result<Rows, Problem> {
            let done = (0..study.parts())
                .filter(|part| !wanted.contains(part))
                .collect();
            let shelf = MemorySink::default();
            study.execute(&done, &shelf, stop)?;
            let parts = shelf.0.into_inner().unwrap_or_else(PoisonError::into_inner);
            let mut all = Rows::with_capacity(&study.columns, 0);
            parts.into_values().for_each(|rows| all.append(rows));
            Ok(all)
        };
        let rows = job(py, threads, Interrupted::Stops, drive)?.map_err(refused)?;
        Ok(Table::new(TableColumn::from_study(&self.0.columns, rows)))
    }

    /// Drives the points of missing parts, writes these parts into a folder, and returns the number of parts there.
    fn write_parts(
        &self,
        py: Python<'_>,
        parts: (u64, u64),
        folder: PathBuf,
        threads: Option<usize>,
    ) -> PyResult<u64> {
        let (study, wanted) = (Arc::clone(&self.0), self.part_range(parts)?);
        let write = move |stop: &Stop| -> Result<u64, Problem> {
            let (manifest, plan) = (study.manifest(false), study.plan.text.as_bytes());
            let dir = match folder.join("study.json").exists() {
                true => StudyDir::resume(&folder, manifest.as_bytes(), plan)?,
                false => StudyDir::create(&folder, manifest.as_bytes(), plan, false)?,
            };
            let missing: BTreeSet<u64> =
                dir.missing().into_iter().map(|part| part as u64).collect();
            let is_done = |part: &u64| !wanted.contains(part) || !missing.contains(part);
            let done = (0..study.parts()).filter(is_done).collect();
            study.execute(&done, &DirWriter::new(&study, &dir), stop)?;
            Ok(study.parts() - dir.missing().len() as u64)
        };
        job(py, threads, Interrupted::Stops, write)?.map_err(refused)
    }
}

/// Study in a folder, finished or not.
#[pyclass(frozen)]
pub struct StoredStudy(PathBuf);

#[pymethods]
impl StoredStudy {
    #[new]
    fn new(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        py.detach(|| StudyResults::stored(&folder))
            .map_err(refused)?;
        Ok(StoredStudy(folder))
    }

    /// Number of parts present, and in total.
    #[getter]
    fn parts(&self, py: Python<'_>) -> PyResult<(usize, usize)> {
        let store = py.detach(|| Store::open(&self.0)).map_err(refused)?;
        let status = store.status();
        Ok((status.present, status.expected))
    }

    /// Merges the parts of shards into a new folder, with the results over all of them.
    #[staticmethod]
    fn merge(py: Python<'_>, folder: PathBuf, shards: Vec<PathBuf>, force: bool) -> PyResult<Self> {
        let whole = folder.clone();
        let merge = move |_: &Stop| -> Result<(), Problems> {
            let dir = StudyDir::merge(&whole, &shards, force)?;
            let found = StudyResults::open(&whole, Confidence::default())?;
            dir.finish(&study_files(&found)?)?;
            Ok(())
        };
        job(py, None, Interrupted::Stops, merge)?.map_err(refused)?;
        Ok(StoredStudy(folder))
    }

    /// Results of the study, as the JSON of `study show --json`.
    fn answer(&self, py: Python<'_>, confidence: Option<f64>) -> PyResult<String> {
        let confidence = match confidence {
            None => Confidence::default(),
            Some(level) => {
                Confidence::of(number("confidence", level, Range::closed(0.5, 0.999), "")?)
            }
        };
        let folder = self.0.clone();
        let answer = move |_: &Stop| -> Result<String, Problems> {
            let found = StudyResults::open(&folder, confidence)?;
            json_text(&found.answer)
        };
        job(py, None, Interrupted::Detaches, answer)?.map_err(refused)
    }

    /// Runs of the parts present; some columns, or all.
    fn table(&self, py: Python<'_>, columns: Vec<String>) -> PyResult<Table> {
        let folder = self.0.clone();
        let read = move |_: &Stop| -> Result<_, Problem> {
            let store = Store::open(&folder)?;
            let heads = store.heads(RUNS)?;
            let names: Vec<&str> = match columns.is_empty() {
                true => heads.iter().map(|head| head.name.as_str()).collect(),
                false => columns.iter().map(String::as_str).collect(),
            };
            let wanted = names
                .iter()
                .filter_map(|name| heads.iter().find(|head| head.name == *name));
            let wanted: Vec<_> = wanted.cloned().collect();
            Ok((store.read(RUNS, &names)?, wanted))
        };
        let (rows, heads) = job(py, Some(1), Interrupted::Detaches, read)?.map_err(refused)?;
        Ok(Table::new(TableColumn::from_study(&heads, rows)))
    }
}
