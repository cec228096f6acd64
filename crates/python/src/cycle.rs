//! Drive cycles.

use std::path::PathBuf;
use std::sync::Arc;

use cvtcycle::config::csv::Columns;
use cvtcycle::config::cycle::{self, Cycle as CoreCycle};
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

fn columns(text: Option<&str>) -> PyResult<Columns> {
    match text {
        None => Ok(Columns::default()),
        Some(text) => Columns::parse(text).map_err(refused),
    }
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
    #[pyo3(signature = (word, columns=None))]
    fn new(py: Python<'_>, word: PathBuf, columns: Option<&str>) -> PyResult<Self> {
        let (word, columns) = (word.to_string_lossy().into_owned(), self::columns(columns)?);
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
    #[pyo3(signature = (name, text, columns=None))]
    fn from_bytes(
        py: Python<'_>,
        name: &str,
        text: &[u8],
        columns: Option<&str>,
    ) -> PyResult<Self> {
        let columns = self::columns(columns)?;
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
