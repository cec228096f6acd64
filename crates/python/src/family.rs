//! A car with varied numbers, as a function of them.

use std::sync::Arc;

use cvtcycle::model::drive::MAX_TOGETHER;
use cvtcycle::output::progress::Progress;
use cvtcycle::study::family::{Family as CoreFamily, FamilyPoint};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::car::Car;
use crate::cycle::Cycle;
use crate::errors::{bad, refused};
use crate::job::{Interrupted, job};
use crate::run::RunArguments;
use crate::table::{Cells, Table, TableColumn};

/// Car, cycle, and the keys that are arguments.
#[pyclass(frozen)]
pub struct Family(Arc<CoreFamily>);

/// Converts bytes to doubles in native byte order.
/// # Errors
/// The exception of an argument whose length is not a multiple of 8.
pub fn doubles(argument: &str, bytes: &[u8]) -> PyResult<Vec<f64>> {
    let (whole, rest) = bytes.as_chunks::<8>();
    match rest.is_empty() {
        true => Ok(whole
            .iter()
            .map(|eight| f64::from_ne_bytes(*eight))
            .collect()),
        false => Err(bad(
            argument,
            "",
            "an array of doubles",
            "these are no whole doubles",
        )),
    }
}

#[pymethods]
impl Family {
    #[new]
    fn new(
        py: Python<'_>,
        car: &Car,
        cycle: &Cycle,
        keys: Vec<String>,
        ambient_degc: f64,
        start: &Bound<'_, PyAny>,
        dt_s: f64,
    ) -> PyResult<Self> {
        let arguments = RunArguments::new(ambient_degc, start, dt_s, false)?;
        let cycle = cycle.for_car(car);
        let made = py.detach(|| {
            let params = car.params.clone();
            CoreFamily::new(params, (*cycle).clone(), arguments.conditions, &keys)
        });
        made.map(|family| Family(Arc::new(family))).map_err(refused)
    }

    /// Key, unit and unchanged value of each argument.
    #[getter]
    fn arguments(&self) -> Vec<(String, &'static str, f64)> {
        let arguments = self.0.arguments().into_iter().zip(self.0.base());
        arguments
            .map(|((key, unit), base)| (key, unit, base))
            .collect()
    }

    /// Name, unit and meaning of each output.
    #[getter]
    fn outputs(&self) -> Vec<(String, String, String)> {
        let head = |head: cvtcycle::output::table::Head| (head.name, head.unit, head.doc);
        self.0.outputs().into_iter().map(head).collect()
    }

    /// Drives the car at points, rows of doubles. Returns a table of the outputs, with the column `reason`.
    fn points(
        &self,
        py: Python<'_>,
        numbers: &[u8],
        outputs: Vec<String>,
        threads: Option<usize>,
    ) -> PyResult<Table> {
        let numbers = doubles("X", numbers)?;
        let wanted = self.0.outputs_of(&outputs).map_err(refused)?;
        let width = self.0.arguments().len();
        if width == 0 || !numbers.len().is_multiple_of(width) {
            let allowed = format!("rows of {width} numbers, one for each key");
            return Err(bad("X", "", &allowed, "the numbers are no whole rows"));
        }
        let (family, places) = (Arc::clone(&self.0), wanted.clone());
        let drive = move |stop: &crate::job::Stop| -> Vec<FamilyPoint> {
            let some = |numbers: &[f64]| match stop.stopped() {
                // After an interruption the results are dropped.
                true => Vec::new(),
                false => family.points(numbers.chunks(width), &places),
            };
            numbers
                .par_chunks(width * MAX_TOGETHER)
                .map(some)
                .flatten_iter()
                .collect()
        };
        let points = job(py, threads, Interrupted::Stops, drive)?;
        let heads = self.0.outputs();
        let columns = wanted.iter().enumerate().map(|(k, place)| {
            let cells = points.iter().map(|point| point.numbers[k]).collect();
            TableColumn::new(heads[*place].clone(), Cells::numbers(cells))
        });
        let reasons = TableColumn {
            name: "reason".to_owned(),
            unit: String::new(),
            doc: "why the car was not driven, or which check its drive failed".to_owned(),
            cells: Cells::text(points.iter().map(|point| &point.reason)),
        };
        Ok(Table::new(columns.chain([reasons]).collect()))
    }
}
