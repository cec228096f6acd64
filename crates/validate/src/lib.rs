//! Comparison with published values: every printed number of the thesis, and of the user's own files.
//!
//! Rows are data: `validation/*.toml`, described in `docs/validation_format.md`. A file has named tolerances and sources at its head and
//! then its rows; a row says what is printed, how it is computed (an expression over sources) and which verdict is recorded. The verdict
//! follows from one rule (module `rule`) for all rows; no row has code of its own.
//!
//! | file | content |
//! |---|---|
//! | `expr` | the expressions: tokens, parsing, evaluation |
//! | `source` | sources as read; `tables` turns them into tables of numbers |
//! | `keys` | the keys of the files |
//! | `rows` | files and rows; `read` and `checks` read them |
//! | `store` | sources computed once, for all expressions |
//! | `judge` | the vehicle that is validated, and verdicts of the rows |
//! | `rule` | the rule from computed and printed to a verdict |
//! | `report` | JSON, CSV, Markdown |
//! | `published` | single rows: those that are the headline of a run, those with an id |
//! | `power` | which change of the cars flips the verdict of a row |

pub mod belt;
pub mod checks;
pub mod expr;
pub mod judge;
pub mod keys;
pub mod power;
mod perturbation;
mod published;
pub mod report;
mod read;
pub mod rows;
pub mod rule;
pub mod source;
pub mod store;
pub mod tables;

pub use cvtcycle_config::embedded::rows as embedded_rows;

use cvtcycle_config::Problems;

/// The file whose tolerances and sources all files may use: name and text.
pub const COMMON: (&str, &str) = cvtcycle_config::embedded::common_rows()[0];
/// The files of rows: those that the program carries, if they are wanted, then the user's own, names and texts.
///
/// # Errors
/// All problems of the files.
pub fn files(own: &[(String, String)], embedded: bool) -> Result<Vec<RowFile>, Problems> {
    let name = |name: &str| format!("embedded:{name}.toml");
    let carried = embedded_rows().iter().filter(|_| embedded);
    let carried = carried.map(|(file, text)| (name(file), (*text).to_owned()));
    let texts: Vec<(String, String)> = carried.chain(own.iter().cloned()).collect();
    read((&name(COMMON.0), COMMON.1), &texts)
}

pub use expr::Computed;
pub use judge::{CandidateVehicle, HeldOut, Judged, Report, judge};
pub use keys::MECHANISMS;
pub use power::{Perturbations, PowerReport, RowPower, Strength};
pub use published::{published, with_ids};
pub use read::read;
pub use report::{computed_text, csv, json, markdown, notes_line, unit_text};
pub use rows::{About, Cause, RowFile, Tolerance, ValidationRow};
pub use rule::{Fleet, Group, Printed, Verdict};
