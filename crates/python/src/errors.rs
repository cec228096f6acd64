//! Converts problems of the library to the Python exception `InputError`, with one dict for each.

use cvtcycle::config::{Bound as Range, Input, Problem, Problems, render};
use pyo3::import_exception;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

import_exception!(cvtcycle._errors, InputError);

/// Exception for problems.
pub fn refused(problems: impl Into<Problems>) -> PyErr {
    let problems = problems.into();
    let mut text = render(&problems, false);
    let columns = problems.iter().map(Problem::proposed);
    if let Some(columns) = columns.max().filter(|columns| !columns.is_empty()) {
        text = format!("{}\ntry: columns={columns:?}", text.trim_end());
    }
    Python::attach(|py| match dicts(py, &problems) {
        Ok(list) => InputError::new_err((text.trim_end().to_owned(), list.unbind())),
        Err(error) => error,
    })
}

/// Exception for a Python argument.
pub fn bad(argument: &str, value: &str, allowed: &str, message: &str) -> PyErr {
    let problem = Problem::invalid(message).key(argument).value(value);
    refused(problem.allowed(allowed))
}

/// Checks that an argument is finite and in its range.
/// # Errors
/// The exception of the argument.
pub fn number(argument: &str, x: f64, range: Range, unit: &str) -> PyResult<f64> {
    match range.contains(x) {
        true => Ok(x),
        false => {
            let message = format!("{x} is out of range");
            Err(bad(
                argument,
                &x.to_string(),
                &range.in_unit(unit),
                &message,
            ))
        }
    }
}

fn dicts<'py>(py: Python<'py>, problems: &Problems) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for problem in problems {
        list.append(dict(py, problem)?)?;
    }
    Ok(list)
}

fn dict<'py>(py: Python<'py>, problem: &Problem) -> PyResult<Bound<'py, PyDict>> {
    let place = &problem.place;
    let (file, over, argument) = match &place.input {
        Input::File(name) => (
            Some(name.as_str()).filter(|name| !name.is_empty()),
            None,
            None,
        ),
        Input::Override(text) => (None, Some(text.as_str()), None),
        Input::Argument(argument) => (None, None, Some(argument.name())),
    };
    let counted = |n: usize| Some(n).filter(|n| *n > 0);
    let kind = serde_json::to_value(problem.kind).unwrap_or_default();
    let kind = match &kind {
        serde_json::Value::String(word) => word.clone(),
        other => other.to_string(),
    };
    let dict = PyDict::new(py);
    dict.set_item("kind", kind)?;
    dict.set_item("file", file)?;
    dict.set_item("line", counted(place.line))?;
    dict.set_item("column", counted(place.column))?;
    dict.set_item("override", over)?;
    dict.set_item("argument", argument)?;
    for (name, text) in [
        ("key", &problem.key),
        ("value", &problem.value),
        ("allowed", &problem.allowed),
        ("message", &problem.message),
        ("hint", &problem.hint),
    ] {
        dict.set_item(name, text)?;
    }
    dict.set_item("suggested", problem.suggested.to_vec())?;
    Ok(dict)
}
