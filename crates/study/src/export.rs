//! A table of a study as one file: CSV, Parquet, or a workbook for Excel.
//!
//! | format | for | what to know |
//! |---|---|---|
//! | `.csv` | anything | names with units; begins with a byte order mark if and only if there is a letter beyond ASCII, since Excel takes such a file for another encoding without it; pandas, polars, DuckDB and Excel skip the mark |
//! | `.parquet` | programs | names without units, which stand in the metadata with the manifest; a row group a part |
//! | `.xlsx` | Excel, LibreOffice | names with units, numbers as numbers whatever the decimal sign of the country; at most 1 048 575 rows, 16 384 columns and 5 000 000 cells |

mod xlsx;

use std::io::{self, Write};
use std::path::Path;

use super::store::{CsvTable, Header, ParquetTable, Status, Study};
use super::table::{Head, Kind, Rows, Values};
use cvtcycle_config::Problem;
use cvtcycle_output::file::OutputFile;
use cvtcycle_output::files::problem;
use xlsx::{MAX_CELLS, MAX_COLUMNS, MAX_ROWS, XlsxTable};

/// Byte order mark, as UTF-8.
const BOM: &[u8] = b"\xEF\xBB\xBF";

/// A format of one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values, UTF-8.
    Csv,
    /// Parquet.
    Parquet,
    /// Office Open XML workbook.
    Xlsx,
}

impl Format {
    /// Formats by the ending of a file.
    pub const NAMES: [(&'static str, Format); 3] = [
        ("csv", Format::Csv),
        ("parquet", Format::Parquet),
        ("xlsx", Format::Xlsx),
    ];

    /// The format of the ending of a file's name.
    ///
    /// # Errors
    /// A problem of `--out` that names the endings.
    pub fn of(path: &Path) -> Result<Self, Problem> {
        let ending = path
            .extension()
            .map(|ending| ending.to_string_lossy().to_lowercase())
            .unwrap_or_default();
        let known = Self::NAMES
            .iter()
            .find(|(name, _)| *name == ending)
            .map(|(_, format)| *format);
        known.ok_or_else(|| {
            let message = format!(
                "the ending of {} does not say in which format to write",
                path.display()
            );
            problem(path, &message, "for example --out runs.csv")
                .allowed("a name that ends in .csv, .parquet or .xlsx")
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
/// A problem: no part is there yet, a part is damaged, the rows do not fit into a workbook (found before anything is written), or the
/// words of the operating system.
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
        return Err(problem(study.path(), &message, "continue it with --resume"));
    }
    let rows = study.rows(table)?;
    let manifest = study.manifest().to_string();
    if format == Format::Xlsx {
        check_size(out.path(), rows, heads.len())?;
    }
    let bom = format == Format::Csv && beyond_ascii(study, table, &heads)?;
    let mut parts = Parts {
        study,
        table,
        heads: &heads,
    };
    let written = match format {
        Format::Csv => parts.write(&mut *out, |out, _| {
            out.write_all(if bom { BOM } else { b"" })?;
            CsvTable::new(out, &heads, Header::Units)
        }),
        Format::Parquet => parts.write(&mut *out, |out, first| {
            ParquetTable::new(out, &heads, &[("cvtcycle.manifest", &manifest)], first)
        }),
        Format::Xlsx => parts.write(&mut *out, |out, _| XlsxTable::new(out, table, &heads)),
    };
    written.map_err(|failure| match failure {
        Failure::Reading(problem) => *problem,
        // A cell that no workbook can hold.
        Failure::Writing(error) if error.kind() == io::ErrorKind::InvalidInput => problem(
            out.path(),
            &error.to_string(),
            "write .csv or .parquet, which have no such limit",
        ),
        Failure::Writing(error) => out.cannot_write(&error),
    })?;
    Ok(Exported { rows, status })
}

/// A table in any format.
trait Table {
    fn write(&mut self, rows: &Rows) -> io::Result<()>;
    fn finish(self) -> io::Result<()>;
}

macro_rules! table {
    ($name:ident, $($bound:tt)*) => {
        impl<W: $($bound)*> Table for $name<W> {
            fn write(&mut self, rows: &Rows) -> io::Result<()> {
                $name::write(self, rows)
            }

            fn finish(self) -> io::Result<()> {
                $name::finish(self)
            }
        }
    };
}

table!(CsvTable, Write);
table!(ParquetTable, Write + Send);
table!(XlsxTable, Write);

/// What went wrong, and on which side.
enum Failure {
    Reading(Box<Problem>),
    Writing(io::Error),
}

/// Where the rows come from.
struct Parts<'a> {
    study: &'a Study,
    table: &'a str,
    heads: &'a [Head],
}

impl Parts<'_> {
    /// Writes all parts to a table that is begun with the rows of the first one.
    fn write<'a, T: Table>(
        &mut self,
        out: &'a mut OutputFile,
        begin: impl FnOnce(&'a mut OutputFile, &Rows) -> io::Result<T>,
    ) -> Result<(), Failure> {
        let names: Vec<&str> = self
            .heads
            .iter()
            .map(|column| column.name.as_str())
            .collect();
        let read = |index| {
            self.study
                .part(index, self.table)
                .and_then(|part| part.read(&names))
                .map_err(|problem| Failure::Reading(Box::new(problem)))
        };
        let mut parts = self.study.present().iter().copied();
        let first = parts
            .next()
            .map_or_else(|| Ok(Rows::with_capacity(self.heads, 0)), read)?;
        let mut table = begin(out, &first).map_err(Failure::Writing)?;
        table.write(&first).map_err(Failure::Writing)?;
        drop(first);
        for index in parts {
            table.write(&read(index)?).map_err(Failure::Writing)?;
        }
        table.finish().map_err(Failure::Writing)
    }
}

/// Refuses what does not fit into a sheet, or into memory as a workbook.
fn check_size(path: &Path, rows: u64, columns: usize) -> Result<(), Problem> {
    let columns = columns as u64;
    let cells = rows.saturating_mul(columns);
    let message = if rows > MAX_ROWS {
        format!(
            "a sheet of Excel holds at most {MAX_ROWS} rows below its header, the study has {rows} rows"
        )
    } else if columns > MAX_COLUMNS {
        format!(
            "a sheet of Excel holds at most {MAX_COLUMNS} columns, the study has {columns} columns"
        )
    } else if cells > MAX_CELLS {
        format!(
            "a workbook is built in memory, with at most {MAX_CELLS} cells; the study has {rows} rows of {columns} columns, {cells} cells"
        )
    } else {
        return Ok(());
    };
    let hint = "write .csv or .parquet, which have no such limit";
    Err(problem(path, &message, hint))
}

/// True if a head or a cell has a letter beyond ASCII.
fn beyond_ascii(study: &Study, table: &str, heads: &[Head]) -> Result<bool, Problem> {
    if !heads
        .iter()
        .all(|column| column.name.is_ascii() && column.unit.is_ascii())
    {
        return Ok(true);
    }
    let words: Vec<&str> = heads
        .iter()
        .filter(|column| column.kind == Kind::Text)
        .map(|column| column.name.as_str())
        .collect();
    for &index in study.present() {
        let rows = study.part(index, table)?.read(&words)?;
        let ascii = |values: &Values| matches!(values, Values::Text(words) if words.iter().all(|word| word.is_ascii()));
        if !rows.values.iter().all(ascii) {
            return Ok(true);
        }
    }
    Ok(false)
}
