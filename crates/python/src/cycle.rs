//! Drive cycles.

use std::path::PathBuf;
use std::sync::Arc;

use cvtcycle::config::channel::Repairs;
use cvtcycle::config::csv::Columns;
use cvtcycle::config::cycle::{self, Cycle as CoreCycle, Repair};
use pyo3::prelude::*;

use crate::car::Car;
use crate::errors::refused;

/// Validated cycle.
#[pyclass(frozen)]
pub struct Cycle {
    pub cycle: Arc<CoreCycle>,
    /// Name or path of the cycle; None for a table of bytes.
    word: Option<String>,
}

fn columns(text: Option<&str>, repair: Option<&str>) -> PyResult<Columns> {
    let columns = text.map(Columns::parse).transpose().map_err(refused)?;
    let repairs = repair.map(Repairs::parse).transpose().map_err(refused)?;
    let columns = columns.unwrap_or_default();
    Ok(columns.with_repairs(repairs.unwrap_or_default()))
}

impl Cycle {
    /// Cycle for a car: its class selects the WLTC.
    pub fn for_car(&self, car: &Car) -> Arc<CoreCycle> {
        match &self.word {
            Some(word) if self.cycle.is_wltc => {
                let own = cycle::for_car(word, (*self.cycle).clone(), &car.setup);
                Arc::new(own)
            }
            _ => Arc::clone(&self.cycle),
        }
    }
}

#[pymethods]
impl Cycle {
    #[new]
    #[pyo3(signature = (word, columns=None, repair=None))]
    fn new(
        py: Python<'_>,
        word: PathBuf,
        columns: Option<&str>,
        repair: Option<&str>,
    ) -> PyResult<Self> {
        let word = word.to_string_lossy().into_owned();
        let columns = self::columns(columns, repair)?;
        let found = py
            .detach(|| cycle::open(&word, &columns))
            .map_err(refused)?;
        Ok(Cycle {
            cycle: Arc::new(found),
            word: Some(word),
        })
    }

    /// Reads the bytes of a table. Problems cite it as `name`.
    #[staticmethod]
    #[pyo3(signature = (name, text, columns=None, repair=None))]
    fn from_bytes(
        py: Python<'_>,
        name: &str,
        text: &[u8],
        columns: Option<&str>,
        repair: Option<&str>,
    ) -> PyResult<Self> {
        let columns = self::columns(columns, repair)?;
        let found = py
            .detach(|| cycle::read_columns(name, text, &columns))
            .map_err(refused)?;
        Ok(Cycle {
            cycle: Arc::new(found),
            word: None,
        })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.cycle.name
    }

    #[getter]
    fn title(&self) -> &str {
        &self.cycle.title
    }

    #[getter]
    fn read_as(&self) -> Option<&str> {
        self.cycle.read_as.as_deref()
    }

    /// Name, count and meaning of each repair of its recording.
    #[getter]
    fn repairs(&self) -> Vec<(String, usize, String)> {
        let recording = self.cycle.recording.as_deref();
        let repairs = recording.map_or(&[][..], |own| &own.repairs);
        let parts = |own: &Repair| (own.name.clone(), own.count, own.what.clone());
        repairs.iter().map(parts).collect()
    }

    /// Doubts about its recording.
    #[getter]
    fn doubts(&self) -> Vec<String> {
        let recording = self.cycle.recording.as_deref();
        recording.map_or_else(Vec::new, |own| own.doubts.clone())
    }

    #[getter]
    fn phases(&self) -> Vec<String> {
        self.cycle.phases.clone()
    }

    #[getter]
    fn duration_s(&self) -> f64 {
        self.cycle.trace_for(true).duration_s()
    }

    #[getter]
    fn distance_m(&self) -> f64 {
        self.cycle.trace_for(true).distance_m()
    }
}
