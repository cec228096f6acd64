//! The Python package `cvtcycle`: converts and checks arguments from Python, and converts results to Python objects.
//!
//! No physics and no reader of its own. Users see `python/cvtcycle`, a Python layer over this module.
//!
//! | module | contents |
//! |---|---|
//! | `errors` | problems of the library as the exception `InputError` |
//! | `job` | work without the lock of the interpreter, on threads, with Ctrl-C |
//! | `arrow`, `table` | tables of columns; the Arrow interface, the only `unsafe` code of the workspace |
//! | `car`, `cycle`, `run`, `family`, `rig`, `study` | objects of the library |
//! | `texts` | validation, calibration, explanations, schemas: their JSON |

mod arrow;
mod car;
mod cycle;
mod errors;
mod family;
mod fleet;
mod job;
mod rig;
mod run;
mod study;
mod table;
mod texts;

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the program with the words of a command line, starting with the program's name, and returns its exit code.
#[pyfunction]
fn program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| cvtcycle::program(words))
}

/// Native part of the package `cvtcycle`.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::{
        car::Car,
        cycle::Cycle,
        family::Family,
        fleet::fleet,
        program,
        rig::{belt, losses},
        run::{Run, run},
        study::{StoredStudy, Study},
        table::{Numbers, Table},
        texts::{calibrate, explain, names, schema, validate, version},
    };
}
