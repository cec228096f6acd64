//! Tables of a study on disk: whole parts only, nothing lost, the same bytes on every machine.
//!
//! ```text
//! DIR/study.json                 manifest; marks the directory as a study, written before anything else
//! DIR/plan.toml                  the plan, byte for byte
//! DIR/parts/runs_00000.parquet   a table of a part; also `.csv` where the format is CSV; `trace_00000...` where traces are kept
//! DIR/parts/part_00000.sha256    checksums of the files of a part; written last, marks the part as whole
//! DIR/statistics.json, ...       results over all parts, at the end
//! DIR/results.sha256             checksums of the results; written last, marks the study as finished
//! ```
//!
//! The process that writes locks the directory ([`DirLock`](cvtcycle_output::files::DirLock)).
//!
//! A part counts only if its marked files are all there with these checksums, so that neither a killed process nor a damaged disk
//! leaves rows that are believed. The lists have the format of `sha256sum` and can be checked with `sha256sum -c`. Parquet is read only
//! after its checksum was found right: the reader of the library trusts the lengths in a file.
//!
//! Names are never taken from a file's contents, but for the list of results, where only plain names in DIR itself are accepted.

mod csv;
mod dir;
mod export;
mod files;
mod footer;
mod manifest;
mod merge;
mod names;
mod parquet;
mod parquet_read;
mod read;
mod table;
mod trace;

pub use csv::{CsvTable, Header, write_csv};
pub use dir::{PartTable, StudyDir};
pub use export::{Exported, Format, export};
pub use files::{Checksums, sha256};
pub(crate) use names::TRACE_ROWS;
pub use names::{Layout, RUNS, TRACES, is_study};
pub use parquet::{ParquetTable, write_parquet};
pub use parquet_read::ParquetFile;
pub use read::{Status, Study};
pub use table::{Head, Kind, Rows, Values};
pub(crate) use trace::SharedWords;
pub use trace::{read_trace_parquet, write_trace_parquet};

use std::fmt::Display;
use std::io;
use std::path::Path;

use cvtcycle_config::{Problem, ProblemKind};

/// A table in some format, written piece by piece.
pub trait RowWriter {
    /// Writes some rows.
    ///
    /// # Errors
    /// Those of the file; [`io::ErrorKind::InvalidInput`] for rows of another table, or that the format cannot hold.
    fn write(&mut self, rows: &Rows) -> io::Result<()>;

    /// Writes the end of the file and hands everything on.
    ///
    /// # Errors
    /// Those of the file.
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// A problem of a file or directory of a study.
fn file_problem(kind: ProblemKind, path: &Path, message: impl Display, hint: &str) -> Problem {
    Problem::new(kind, message.to_string())
        .in_file(path.display().to_string())
        .value(path.display().to_string())
        .hint(hint)
}

/// Checks that rows fit under their heads.
fn check_shape(columns: &[Head], rows: &Rows) -> io::Result<()> {
    let fits =
        |(head, values): (&Head, &Values)| head.kind == values.kind() && values.len() == rows.len();
    if columns.len() == rows.values.len() && columns.iter().zip(&rows.values).all(fits) {
        return Ok(());
    }
    let message = "rows do not fit under the heads of their table";
    Err(io::Error::new(io::ErrorKind::InvalidInput, message))
}
