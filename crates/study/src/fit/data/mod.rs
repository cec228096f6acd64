//! Measured CSV files to numbers, with the place of each.
//!
//! | file | columns |
//! |---|---|
//! | `points` | settings of the bench, then measured columns of it |
//! | `trace` | `time_s`, then measured columns of the trace |
//! | `scalars` | `quantity`, `value`, `sd`, `phase` |
//!
//! Every column's unit is in its name. A measured column may have its standard deviation in `sd_COLUMN`; an empty cell was not
//! measured.

pub(super) mod points;
pub(super) mod scalars;
pub(super) mod sheet;
pub(super) mod trace;

use crate::check::source::Kind;
use crate::check::tables;
use cvtcycle_config::{Place, Problem, Problems, bounded};

/// Forms of a measured file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Points of a bench.
    Points,
    /// A trace over time.
    Trace,
    /// Single numbers of a run.
    Scalars,
}

impl Form {
    /// All of them.
    pub const ALL: [Form; 3] = [Form::Points, Form::Trace, Form::Scalars];
}

/// Reads a measured file by itself, without the plan that says what it is of; the number of its rows.
///
/// # Errors
/// All problems of the file.
///
/// ```
/// use cvtcycle_study::fit::data::{Form, check};
/// let text = "ratio,speed_rpm,temp_degc,total_nm\n2.417,1000,30,8.6\n";
/// assert_eq!(check(Form::Points, "spin.csv", text.as_bytes())?, 1);
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn check(form: Form, file: &str, bytes: &[u8]) -> Result<usize, Problems> {
    let (sheet, problems) = match form {
        Form::Points => points::read(file, bytes),
        Form::Trace => trace::read(file, bytes, &tables::columns(Kind::Run, false)),
        Form::Scalars => scalars::read(file, bytes, &tables::columns(Kind::Run, true), None),
    };
    if problems.is_empty() {
        Ok(sheet.map_or(0, |sheet| sheet.rows.len()))
    } else {
        Err(problems)
    }
}

/// Reads a file that a plan names, relative to the plan.
///
/// # Errors
/// The operating system's words, or more bytes than a table may have, at the place in the plan.
pub(super) fn bytes_of(path: &str, place: &Place, key: &str) -> Result<Vec<u8>, Problems> {
    bounded::read_file(path, bounded::TABLE).map_err(|error| {
        Problem::unreadable(format!("cannot read `{path}`: {error}"))
            .at(place.clone())
            .key(key)
            .value(path)
            .allowed(error.allowed("a readable CSV file"))
            .hint(error.hint("check the name; a path is relative to the folder of the plan"))
            .into()
    })
}
