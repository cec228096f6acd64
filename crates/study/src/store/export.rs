//! A table of a study as one file: CSV or Parquet.
//!
//! | format | for | what to know |
//! |---|---|---|
//! | `.csv` | anything | names with units; begins with a byte order mark if and only if there is a letter beyond ASCII, since Excel takes such a file for another encoding without it; pandas, polars, DuckDB and Excel skip the mark |
//! | `.parquet` | programs | names without units, which are in the metadata with the manifest; a row group a part |

use std::io::{self, Write};
use std::path::Path;

use super::RowWriter;
use super::csv::{CsvTable, Header};
use super::parquet::{ParquetTable, RUN_KEY, run_of};
use super::read::{Status, Study};
use super::table::{Head, Kind, Rows, Values};
use cvtcycle_config::{Problem, Setting};
use cvtcycle_output::file::OutputFile;
use cvtcycle_output::files::problem;

/// Byte order mark, as UTF-8.
const BOM: &[u8] = b"\xEF\xBB\xBF";

/// A format of one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values, UTF-8.
    Csv,
    /// Parquet.
    Parquet,
}

impl Format {
    /// Formats by the ending of a file.
    pub const NAMES: [(&'static str, Format); 2] =
        [("csv", Format::Csv), ("parquet", Format::Parquet)];

    /// The format of the ending of a file's name.
    ///
    /// # Errors
    /// A problem of `--out` that names the endings.
    pub fn of(path: &Path) -> Result<Self, Problem> {
        let ending = path.extension().unwrap_or_default();
        let ending = ending.to_string_lossy().to_lowercase();
        let known = Self::NAMES.iter().find(|(name, _)| *name == ending);
        known.map(|(_, format)| *format).ok_or_else(|| {
            let path_name = path.display();
            let message =
                format!("the ending of {path_name} does not say in which format to write");
            problem(path, &message, "for example runs.csv")
                .allowed("a name that ends in .csv or .parquet")
        })
    }
}

/// What was exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exported {
    /// Rows without the header.
    pub rows: u64,
    /// How far the study had come.
    pub status: Status,
}

/// Writes all rows of a table that are there, in the order of the parts; one part is in memory at a time. The caller commits the file.
///
/// # Errors
/// A problem: no part is there yet, a part is damaged, or the error of the operating system.
pub fn export(
    study: &Study,
    table: &str,
    format: Format,
    out: &mut OutputFile,
) -> Result<Exported, Problem> {
    let status = study.status();
    let heads = study.heads(table)?;
    if heads.is_empty() {
        let message = format!(
            "the study in {} has no rows yet: none of its {} parts is whole",
            study.path().display(),
            status.expected
        );
        let problem = problem(study.path(), &message, "continue it");
        return Err(problem.settings(&[Setting::Resume]));
    }
    let rows = study.rows(table)?;
    let bom = format == Format::Csv && beyond_ascii(study, table, &heads)?;
    let (run, manifest) = (run_of(study.manifest()), study.manifest().to_string());
    let file = &mut *out;
    let begin = |first: &Rows| -> io::Result<Box<dyn RowWriter + '_>> {
        Ok(match format {
            Format::Csv => {
                file.write_all(if bom { BOM } else { b"" })?;
                Box::new(CsvTable::new(file, &heads, Header::Units)?)
            }
            Format::Parquet => {
                let run = run.iter().map(|run| (RUN_KEY, run.as_str()));
                let own = [("cvtcycle.manifest", manifest.as_str())];
                let metadata: Vec<_> = run.chain(own).collect();
                Box::new(ParquetTable::new(file, &heads, &metadata, first)?)
            }
        })
    };
    let written = copy(study, table, &heads, begin)?;
    written.map_err(|error| out.cannot_write(&error))?;
    study.unchanged()?;
    Ok(Exported { rows, status })
}

/// Writes all parts to a table that is begun with the rows of the first one: a problem of reading them, or an error of the table.
fn copy<'a>(
    study: &Study,
    table: &str,
    heads: &[Head],
    begin: impl FnOnce(&Rows) -> io::Result<Box<dyn RowWriter + 'a>>,
) -> Result<io::Result<()>, Problem> {
    let names: Vec<&str> = heads.iter().map(|head| head.name.as_str()).collect();
    let read = |&index: &usize| study.part(index, table)?.read(&names);
    let mut parts = study.present().iter().map(read);
    let first = parts.next().unwrap_or_else(|| Ok(Rows::default()))?;
    let mut writer = match begin(&first) {
        Ok(writer) => writer,
        Err(error) => return Ok(Err(error)),
    };
    for rows in std::iter::once(Ok(first)).chain(parts) {
        if let Err(error) = writer.write(&rows?) {
            return Ok(Err(error));
        }
    }
    Ok(writer.finish())
}

/// True if a head or a cell has a letter beyond ASCII.
fn beyond_ascii(study: &Study, table: &str, heads: &[Head]) -> Result<bool, Problem> {
    let is_ascii = |head: &Head| head.name.is_ascii() && head.unit.is_ascii();
    let words = heads.iter().filter(|head| head.kind == Kind::Text);
    let words: Vec<&str> = words.map(|head| head.name.as_str()).collect();
    let mut beyond = !heads.iter().all(is_ascii);
    for &index in study.present() {
        if beyond {
            break;
        }
        let rows = study.part(index, table)?.read(&words)?;
        let is_ascii = |values: &Values| matches!(values, Values::Text(words) if words.iter().all(|word| word.is_ascii()));
        beyond = !rows.values.iter().all(is_ascii);
    }
    Ok(beyond)
}
