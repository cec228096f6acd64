//! Every printed number of the thesis, and of the user's own files, against this program.
//!
//! Rows are data: `validation/*.toml`, described in `docs/validation_format.md`. A file has named tolerances and sources at its head and
//! then its rows; a row says what is printed, how it is computed (an expression over sources) and which verdict is recorded. The verdict
//! follows from one rule (module `rule`) for all rows; no row has code of its own.
//!
//! | file | what stands there |
//! |---|---|
//! | `expr` | the expressions: words, parsing, computing |
//! | `source` | sources as read; `tables` turns them into tables of numbers |
//! | `row`, `checks` | files and rows as read |
//! | `store` | sources computed once, as expressions see them |
//! | `judge` | rows judged |
//! | `rule` | computed against printed: the verdict |
//! | `report`, `markdown`, `html` | JSON, CSV, Markdown, the HTML page |

mod checks;
pub mod expr;
pub mod judge;
mod markdown;
pub mod names;
pub mod report;
mod row;
pub mod rule;
pub mod source;
pub mod store;
pub mod tables;

pub use checks::MECHANISMS;
pub use cvtcycle_config::embedded::rows as embedded_rows;

/// The file whose tolerances and sources all files may use: name and text.
pub const COMMON: (&str, &str) = cvtcycle_config::embedded::common_rows()[0];
pub use expr::Computed;
pub use judge::{HeldOut, Judged, Report, Subject, judge};
pub use markdown::markdown;
pub use report::{Json, computed_text, csv, json, notes_line, unit_text};
pub use row::within;
pub use row::{Cause, File, Row, Tolerance, read};
pub use rule::{Printed, Verdict};
