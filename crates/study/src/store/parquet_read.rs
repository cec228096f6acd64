//! Parquet files of this program, read by column.

use std::collections::HashSet;
use std::fmt;
use std::fs::File;
use std::io;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::file_problem;
use super::files::{Sum, sum_of};
use super::footer;
use super::names::MAX_PART_ROWS;
use super::parquet::{COLUMNS_KEY, io_error};
use super::table::{Head, Rows, Values};
use cvtcycle_config::Problem;
use cvtcycle_config::ProblemKind::{Damaged, Syntax, UnknownKey, Unreadable};
use cvtcycle_config::bounded::{self, ReadError};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType};
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, KeyValue};
use parquet::file::reader::{FileReader, SerializedFileReader};

/// Advice for a damaged file.
pub(super) const MEND: &str = "a study computes its damaged parts anew when it is continued";

/// Bytes that a byte of a column can become at most: a copy of Snappy's takes three bytes for up to 64. Small columns have a head in addition.
const MAX_UNPACKED: u64 = 32;
const HEAD: u64 = 1 << 16;
/// Cells for which room is made at once; a file may name any number.
const ROOM: usize = 1 << 16;

/// A Parquet file that this program has written and that is as it was.
pub struct ParquetFile {
    path: PathBuf,
    file: SerializedFileReader<File>,
    columns: Vec<Head>,
}

impl fmt::Debug for ParquetFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = &mut f.debug_struct("ParquetFile");
        file.field("path", &self.path).finish_non_exhaustive()
    }
}

impl ParquetFile {
    /// Opens a file after its checksum was found right.
    ///
    /// # Errors
    /// A problem that names the file: it cannot be read, has other bytes than it had, or is no table of this program.
    pub fn open(path: &Path, sum: &Sum) -> Result<Self, Problem> {
        let file = bounded::open_file(path).map_err(|error| unreadable(path, &error))?;
        check_sum(path, &file, sum)?;
        Self::open_known(path, file)?.with_rows(&(0..=MAX_PART_ROWS))
    }

    /// Refuses a file with another number of rows: a few bytes can encode any number of equal ones.
    pub(super) fn with_rows(self, due: &RangeInclusive<u64>) -> Result<Self, Problem> {
        let (rows, most) = (self.rows(), due.end());
        if due.contains(&rows) {
            return Ok(self);
        }
        let due = if due.start() == most {
            format!("{most} are due")
        } else {
            format!("up to {most} are due")
        };
        let message = format!("the file is damaged: it has {rows} rows, {due}");
        Err(file_problem(Damaged, &self.path, message, MEND))
    }

    /// Opens a file whose bytes are known to be those that were written.
    pub(super) fn open_known(path: &Path, mut file: File) -> Result<Self, Problem> {
        const DAMAGED: &str =
            "the file is damaged: it is shorter than it says, or longer than any of this program";
        let refused = |error: io::Error| unreadable(path, &error.into());
        let is_sound = footer::is_sound(&mut file).map_err(refused)?;
        let bytes = file.metadata().map_err(refused)?.len();
        let reader = is_sound.then(|| SerializedFileReader::new(file));
        let reader = reader
            .transpose()
            .map_err(|error| refused(io_error(error)))?;
        let file = reader.filter(|reader| fits(reader, bytes));
        let file = file.ok_or_else(|| file_problem(Damaged, path, DAMAGED, MEND))?;
        let columns = heads(&file).ok_or_else(|| {
            file_problem(Syntax, path, "the file is no table of this program", "")
        })?;
        Ok(ParquetFile {
            path: path.to_path_buf(),
            file,
            columns,
        })
    }

    /// Heads of its columns.
    pub fn columns(&self) -> &[Head] {
        &self.columns
    }

    /// Number of its rows.
    pub fn rows(&self) -> u64 {
        u64::try_from(self.file.metadata().file_metadata().num_rows()).unwrap_or(0)
    }

    /// Pairs of its metadata, in their order.
    pub fn metadata(&self) -> Vec<(String, String)> {
        let pairs = self.file.metadata().file_metadata().key_value_metadata();
        let pair = |pair: &KeyValue| (pair.key.clone(), pair.value.clone().unwrap_or_default());
        pairs.into_iter().flatten().map(pair).collect()
    }

    /// All rows of some columns, in the order of the names.
    ///
    /// # Errors
    /// A problem that names the file, for a column that it does not have or a file that cannot be read.
    pub fn read(&self, names: &[&str]) -> Result<Rows, Problem> {
        let read = |name: &&str| {
            let found = self.columns.iter().position(|column| column.name == *name);
            let unknown = || format!("the table has no column `{name}`");
            let index = found.ok_or_else(|| file_problem(UnknownKey, &self.path, unknown(), ""))?;
            let column = self.column(index);
            column.map_err(|error| unreadable(&self.path, &io_error(error).into()))
        };
        let values = names.iter().map(read).collect::<Result<_, _>>()?;
        Ok(Rows { values })
    }

    fn column(&self, index: usize) -> Result<Values, ParquetError> {
        let total = usize::try_from(self.rows()).unwrap_or(0);
        let mut values = Values::with_capacity(self.columns[index].kind, total.min(ROOM));
        let mut words = HashSet::new();
        for group in 0..self.file.num_row_groups() {
            let reader = self.file.get_row_group(group)?.get_column_reader(index)?;
            let room = total - values.len();
            match (&mut values, reader) {
                (Values::Number(into), ColumnReader::DoubleColumnReader(reader)) => {
                    each(reader, room, |x| into.push(x.copied().unwrap_or(f64::NAN)))?;
                }
                (Values::Count(into), ColumnReader::Int64ColumnReader(reader)) => {
                    each(reader, room, |n| into.extend(n))?
                }
                (Values::Text(into), ColumnReader::ByteArrayColumnReader(reader)) => {
                    let mut wrong = None;
                    each(reader, room, |bytes| match word(bytes, &mut words) {
                        Ok(word) => into.push(word),
                        Err(error) => wrong = Some(error),
                    })?;
                    wrong.map_or(Ok(()), Err)?;
                }
                _ => return Err(damage("a column is not of the kind that its head says")),
            }
        }
        match values.len() == total {
            true => Ok(values),
            false => Err(damage("a column is shorter than the table")),
        }
    }
}

fn damage(message: &str) -> ParquetError {
    ParquetError::General(message.to_owned())
}

/// Checks that all offsets in the footer lie within the file: the library trusts them and allocates by them.
fn fits(file: &SerializedFileReader<File>, bytes: u64) -> bool {
    let metadata = file.metadata();
    let rows = u64::try_from(metadata.file_metadata().num_rows());
    let within = |column: &ColumnChunkMetaData| {
        let start = column.dictionary_page_offset();
        let start = start.unwrap_or(column.data_page_offset());
        let ends = (
            u64::try_from(start),
            u64::try_from(column.compressed_size()),
        );
        let (Ok(start), Ok(size)) = ends else {
            return false;
        };
        let unpacked = u64::try_from(column.uncompressed_size());
        let most = size.saturating_mul(MAX_UNPACKED).saturating_add(HEAD);
        start.checked_add(size).is_some_and(|end| end <= bytes)
            && unpacked.is_ok_and(|unpacked| unpacked <= most)
    };
    let mut columns = metadata
        .row_groups()
        .iter()
        .flat_map(|group| group.columns());
    rows.is_ok() && columns.all(within)
}

/// Hands on every cell of a column in a row group, none where it is null; `room` is how many there may be.
fn each<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    mut room: usize,
    mut cell: impl FnMut(Option<&T::T>),
) -> Result<(), ParquetError> {
    /// Cells at a time.
    const BATCH: usize = 8192;
    let (mut there, mut values) = (Vec::new(), Vec::new());
    loop {
        there.clear();
        values.clear();
        let (records, ..) = reader.read_records(BATCH, Some(&mut there), None, &mut values)?;
        if records == 0 {
            return Ok(());
        }
        // A few bytes can encode any number of equal cells.
        let left = room.checked_sub(records);
        room = left.ok_or_else(|| damage("a column is longer than the table"))?;
        if there.is_empty() {
            values.iter().for_each(|value| cell(Some(value)));
            continue;
        }
        let mut next = values.iter();
        for level in &there {
            cell(if *level > 0 { next.next() } else { None });
        }
    }
}

/// A cell as a word; words that come again share their memory.
fn word(
    bytes: Option<&ByteArray>,
    known: &mut HashSet<Arc<str>>,
) -> Result<Arc<str>, ParquetError> {
    let text = bytes.map_or(Ok(""), ByteArray::as_utf8)?;
    if let Some(word) = known.get(text) {
        return Ok(word.clone());
    }
    let word: Arc<str> = Arc::from(text);
    known.insert(word.clone());
    Ok(word)
}

/// The heads in the metadata; none if there are none or they are not those of the file's columns.
fn heads(file: &SerializedFileReader<File>) -> Option<Vec<Head>> {
    let metadata = file.metadata().file_metadata();
    let mut pairs = metadata.key_value_metadata()?.iter();
    let pair = pairs.find(|pair| pair.key == COLUMNS_KEY)?;
    let columns: Vec<Head> = serde_json::from_str(pair.value.as_ref()?).ok()?;
    let schema = metadata.schema_descr().columns().iter();
    let is_same = schema
        .map(|column| column.name())
        .eq(columns.iter().map(|head| &head.name));
    is_same.then_some(columns)
}

/// Checks that the bytes that are left to read of a file are those that were written.
pub(super) fn check_sum(path: &Path, file: &File, sum: &Sum) -> Result<(), Problem> {
    if sum_of(file).map_err(|error| unreadable(path, &error.into()))? == *sum {
        return Ok(());
    }
    let message = "the file is damaged: its checksum is not that of what was written";
    Err(file_problem(Damaged, path, message, MEND))
}

pub(super) fn unreadable(path: &Path, error: &ReadError) -> Problem {
    let hint = if error.kind() == io::ErrorKind::NotFound {
        MEND
    } else {
        error.hint("check the file and its permissions")
    };
    file_problem(
        Unreadable,
        path,
        format!("cannot read the file: {error}"),
        hint,
    )
    .allowed(error.allowed(""))
}
