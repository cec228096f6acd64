//! Tables of columns.

use std::sync::Arc;

use cvtcycle::output::table::{Column, Head, Kind};
use cvtcycle::study::store::{Rows, Values};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList};

use crate::arrow;

/// Concatenated words.
#[derive(Debug, Default)]
pub struct Words {
    /// Offsets of the words, followed by the total length.
    pub ends: Vec<i64>,
    pub bytes: Vec<u8>,
}

/// Cells of a column, shared by reference counting.
#[derive(Clone, Debug)]
pub enum Cells {
    Number(Arc<Vec<f64>>),
    Count(Arc<Vec<i64>>),
    Text(Arc<Words>),
}

impl Words {
    fn new<S: AsRef<str>>(words: impl Iterator<Item = S>) -> Self {
        let mut made = Words {
            ends: vec![0],
            bytes: Vec::new(),
        };
        for word in words {
            made.bytes.extend_from_slice(word.as_ref().as_bytes());
            made.ends.push(made.bytes.len() as i64);
        }
        made
    }

    fn iter(&self) -> impl ExactSizeIterator<Item = &str> {
        let word = |ends: &[i64]| {
            let [from, to] = [ends[0], ends[1]].map(|end| usize::try_from(end).unwrap_or(0));
            std::str::from_utf8(&self.bytes[from..to]).unwrap_or("")
        };
        self.ends.windows(2).map(word)
    }
}

impl Cells {
    pub fn len(&self) -> usize {
        match self {
            Cells::Number(cells) => cells.len(),
            Cells::Count(cells) => cells.len(),
            Cells::Text(words) => words.ends.len() - 1,
        }
    }

    pub fn numbers(cells: Vec<f64>) -> Self {
        Cells::Number(Arc::new(cells))
    }

    pub fn text<S: AsRef<str>>(words: impl Iterator<Item = S>) -> Self {
        Cells::Text(Arc::new(Words::new(words)))
    }
}

/// Column with name, unit and meaning.
#[derive(Clone, Debug)]
pub struct TableColumn {
    pub name: String,
    pub unit: String,
    pub doc: String,
    pub cells: Cells,
}

impl TableColumn {
    pub fn new(head: Head, cells: Cells) -> Self {
        TableColumn {
            name: head.name,
            unit: head.unit,
            doc: head.doc,
            cells,
        }
    }

    /// Evaluates a column over rows. Non-finite numbers become NaN, which marks missing values.
    pub fn from_rows<R>(column: &Column<R>, rows: &[R], phases: &[String]) -> Self {
        let cells = match column.kind {
            Kind::Number => {
                let mut numbers = Vec::with_capacity(rows.len());
                column.numbers(rows, &mut numbers);
                let is_missing = |x: &&mut f64| !x.is_finite();
                numbers
                    .iter_mut()
                    .filter(is_missing)
                    .for_each(|x| *x = f64::NAN);
                Cells::numbers(numbers)
            }
            Kind::Count => {
                let count = |row| column.number_of(row) as i64;
                Cells::Count(Arc::new(rows.iter().map(count).collect()))
            }
            Kind::Text => Cells::text(rows.iter().map(|row| {
                let mut word = String::new();
                column.cell(row).push(&mut word, phases);
                word
            })),
        };
        TableColumn::new(column.head(), cells)
    }

    /// Converts the columns of a study.
    pub fn from_study(heads: &[Head], rows: Rows) -> Vec<Self> {
        let column = |(head, values): (&Head, Values)| {
            let cells = match values {
                Values::Number(cells) => Cells::numbers(cells),
                Values::Count(cells) => Cells::Count(Arc::new(cells)),
                Values::Text(cells) => Cells::text(cells.iter()),
            };
            TableColumn::new(head.clone(), cells)
        };
        heads.iter().zip(rows.values).map(column).collect()
    }
}

/// Columns of equal length.
#[pyclass(frozen)]
pub struct Table {
    columns: Arc<Vec<TableColumn>>,
}

impl Table {
    pub fn new(columns: Vec<TableColumn>) -> Self {
        Table {
            columns: Arc::new(columns),
        }
    }
}

/// Numbers of a column for `numpy.asarray`: a read-only view.
#[pyclass(frozen)]
pub struct Numbers {
    cells: Cells,
}

#[pymethods]
impl Numbers {
    /// Array interface of NumPy, version 3. The view keeps this object and its cells alive.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (at, kind) = match &self.cells {
            Cells::Number(cells) => (cells.as_ptr() as usize, "<f8"),
            Cells::Count(cells) => (cells.as_ptr() as usize, "<i8"),
            Cells::Text(words) => (words.bytes.as_ptr() as usize, "|u1"),
        };
        let dict = PyDict::new(py);
        dict.set_item("data", (at, true))?;
        dict.set_item("shape", (self.cells.len(),))?;
        dict.set_item("typestr", kind)?;
        dict.set_item("version", 3)?;
        Ok(dict)
    }

    fn __len__(&self) -> usize {
        self.cells.len()
    }

    fn tolist<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        match &self.cells {
            Cells::Number(cells) => PyList::new(py, cells.iter()),
            Cells::Count(cells) => PyList::new(py, cells.iter()),
            Cells::Text(words) => PyList::new(py, words.iter()),
        }
    }
}

#[pymethods]
impl Table {
    /// Name, unit and meaning of each column.
    #[getter]
    fn heads(&self) -> Vec<(String, String, String)> {
        let head = |c: &TableColumn| (c.name.clone(), c.unit.clone(), c.doc.clone());
        self.columns.iter().map(head).collect()
    }

    fn __len__(&self) -> usize {
        self.columns.first().map_or(0, |column| column.cells.len())
    }

    /// Numbers of a column, or its words as a list.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let column = self.columns.iter().find(|column| column.name == name);
        let column = column.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        let numbers = Numbers {
            cells: column.cells.clone(),
        };
        match &column.cells {
            Cells::Text(_) => Ok(numbers.tolist(py)?.into_any()),
            _ => Ok(Bound::new(py, numbers)?.into_any()),
        }
    }

    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A producer may ignore the request and keep its own types.
        drop(requested_schema);
        let stream = arrow::table_stream(Arc::clone(&self.columns));
        PyCapsule::new_with_value(py, stream, arrow::STREAM)
    }

    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        PyCapsule::new_with_value(py, arrow::table_schema(&self.columns), arrow::SCHEMA)
    }
}
