//! Tables as Parquet: the same table gives the same bytes.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};
use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type};
use serde_json::{Value, json};

use super::table::{Head, Kind, Rows, Values};
use super::{RowWriter, check_shape};

/// Key of the metadata of the heads of the columns, as JSON.
pub const COLUMNS_KEY: &str = "cvtcycle.columns";
/// Key of the metadata of the word of the run or study.
pub const RUN_KEY: &str = "cvtcycle.run";

/// The word of the run or study in its manifest, where there is one.
pub(super) fn run_of(manifest: &Value) -> Option<String> {
    manifest["run"].as_str().map(str::to_owned)
}
/// Writer of the files, as Parquet's own field says it.
const CREATED_BY: &str = cvtcycle_output::PROGRAM;
/// A dictionary is kept where values are repeated at least so often on average.
const REPEATED: usize = 4;
/// Values of a column, from its first one, that this is judged by.
const LOOKED_AT: usize = 8192;

/// A Parquet table that is written piece by piece, a row group each.
///
/// Numbers are optional DOUBLEs, null where they are not finite; minus zero is written as zero, as in CSV. Counts are required INT64s,
/// words optional UTF-8 strings, null where they are empty. Name, unit and meaning of the columns are in the metadata under
/// `cvtcycle.columns`.
pub struct ParquetTable<W: Write + Send> {
    file: SerializedFileWriter<W>,
    columns: Vec<Head>,
}

impl<W: Write + Send> ParquetTable<W> {
    /// Begins a file. `metadata` are pairs of the caller's; `first` are the first rows, which decide where a dictionary helps.
    ///
    /// # Errors
    /// Whatever `out` reports; [`io::ErrorKind::InvalidInput`] for rows of another table, without columns, or with two of one name.
    pub fn new(
        out: W,
        columns: &[Head],
        metadata: &[(&str, &str)],
        first: &Rows,
    ) -> io::Result<Self> {
        check_shape(columns, first)?;
        let mut names = HashSet::new();
        if columns.is_empty() || !columns.iter().all(|column| names.insert(&column.name)) {
            let message = "a table needs columns, each with a name of its own";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        let schema = Arc::new(schema(columns).map_err(io_error)?);
        let properties = Arc::new(properties(columns, metadata, first));
        let file = SerializedFileWriter::new(out, schema, properties);
        Ok(ParquetTable {
            file: file.map_err(io_error)?,
            columns: columns.to_vec(),
        })
    }
}

/// Some rows are a row group; none are no group.
impl<W: Write + Send> RowWriter for ParquetTable<W> {
    fn write(&mut self, rows: &Rows) -> io::Result<()> {
        check_shape(&self.columns, rows)?;
        if rows.is_empty() {
            return Ok(());
        }
        write_group(&mut self.file, rows).map_err(io_error)
    }

    fn finish(mut self: Box<Self>) -> io::Result<()> {
        // Flushes as well. Giving `out` back would turn its error into words.
        self.file.finish().map(drop).map_err(io_error)
    }
}

/// Writes a whole table as one row group.
///
/// # Errors
/// Those of [`ParquetTable`].
pub fn write_parquet<W: Write + Send>(
    out: W,
    columns: &[Head],
    rows: &Rows,
    metadata: &[(&str, &str)],
) -> io::Result<()> {
    let mut table = Box::new(ParquetTable::new(out, columns, metadata, rows)?);
    table.write(rows)?;
    table.finish()
}

fn schema(columns: &[Head]) -> Result<Type, ParquetError> {
    let field = |column: &Head| {
        let of = |kind| Type::primitive_type_builder(&column.name, kind);
        let field = match column.kind {
            Kind::Number => of(Physical::DOUBLE).with_repetition(Repetition::OPTIONAL),
            Kind::Count => of(Physical::INT64).with_repetition(Repetition::REQUIRED),
            Kind::Text => of(Physical::BYTE_ARRAY)
                .with_repetition(Repetition::OPTIONAL)
                .with_logical_type(Some(LogicalType::String)),
        };
        field.build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    Type::group_type_builder("schema")
        .with_fields(fields)
        .build()
}

fn properties(columns: &[Head], metadata: &[(&str, &str)], first: &Rows) -> WriterProperties {
    let heads = json!(columns).to_string();
    let pairs = metadata
        .iter()
        .copied()
        .chain([(COLUMNS_KEY, heads.as_str())]);
    let pairs = pairs.map(|(key, value)| KeyValue::new(key.to_owned(), value.to_owned()));
    let mut builder = WriterProperties::builder()
        .set_created_by(CREATED_BY.to_owned())
        .set_compression(Compression::SNAPPY)
        // Least and largest of each group; pages need none in groups of this size.
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_offset_index_disabled(true)
        // Groups of the file are exactly those given.
        .set_max_row_group_row_count(None)
        .set_key_value_metadata(Some(pairs.collect()));
    for (column, values) in columns.iter().zip(&first.values) {
        // A name with dots is one name.
        let path = ColumnPath::new(vec![column.name.clone()]);
        builder = builder.set_column_dictionary_enabled(path, dictionary_helps(values));
    }
    builder.build()
}

/// True if values repeat often enough for a dictionary to be shorter and quicker.
fn dictionary_helps(values: &Values) -> bool {
    let looked_at = values.len().min(LOOKED_AT);
    let most = looked_at / REPEATED;
    match values {
        Values::Number(numbers) => few(numbers[..looked_at].iter().map(|x| x.to_bits()), most),
        Values::Count(counts) => few(counts[..looked_at].iter().map(|n| n.cast_unsigned()), most),
        Values::Text(_) => true,
    }
}

/// True if there are at most `most` different values.
fn few(mut bits: impl Iterator<Item = u64>, most: usize) -> bool {
    let mut seen: HashSet<u64, BuildHasherDefault<Mixed>> = HashSet::default();
    bits.all(|bits| {
        seen.insert(bits);
        seen.len() <= most
    })
}

/// A hash of 64 bits that costs one multiplication. The numbers are our own: no collisions by intent.
#[derive(Default)]
struct Mixed(u64);

impl Hasher for Mixed {
    fn write(&mut self, bytes: &[u8]) {
        bytes
            .iter()
            .for_each(|byte| self.write_u64(u64::from(*byte)));
    }

    fn write_u64(&mut self, bits: u64) {
        // The upper half of the product depends on all bits: round numbers end in many zeros.
        let product = u128::from(self.0 ^ bits) * 0x9e37_79b9_7f4a_7c15;
        self.0 = (product >> 64) as u64 ^ product as u64;
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

fn write_group<W: Write + Send>(
    file: &mut SerializedFileWriter<W>,
    rows: &Rows,
) -> Result<(), ParquetError> {
    let mut group = file.next_row_group()?;
    for values in &rows.values {
        let missing =
            || ParquetError::General("fewer columns in the file than in the table".to_owned());
        let mut column = group.next_column()?.ok_or_else(missing)?;
        write_column(&mut column, values)?;
        column.close()?;
    }
    group.close()?;
    Ok(())
}

fn write_column(column: &mut SerializedColumnWriter, values: &Values) -> Result<(), ParquetError> {
    match values {
        Values::Number(numbers) => {
            let there: Vec<i16> = numbers.iter().map(|x| i16::from(x.is_finite())).collect();
            // Adding zero takes the sign from minus zero and changes nothing else. Where every number is there, none is looked at alone.
            let plain = numbers.iter().map(|x| x + 0.0);
            let numbers: Vec<f64> = match there.iter().all(|there| *there > 0) {
                true => plain.collect(),
                false => plain.filter(|x| x.is_finite()).collect(),
            };
            let column = column.typed::<DoubleType>();
            column.write_batch(&numbers, Some(&there), None)?;
        }
        Values::Count(counts) => {
            let column = column.typed::<Int64Type>();
            column.write_batch(counts, None, None)?;
        }
        Values::Text(words) => {
            let there = words.iter().map(|word| i16::from(!word.is_empty()));
            let there: Vec<i16> = there.collect();
            let mut known: HashMap<&str, ByteArray> = HashMap::new();
            let mut bytes = |word| {
                let known = known.entry(word).or_insert_with(|| ByteArray::from(word));
                known.clone()
            };
            let mut last: Option<(&Arc<str>, ByteArray)> = None;
            // Most words are the one before, often the very same.
            let mut next = |word| match &last {
                Some((before, bytes)) if Arc::ptr_eq(before, word) => bytes.clone(),
                _ => last.insert((word, bytes(&**word))).1.clone(),
            };
            let words = words.iter().filter(|word| !word.is_empty());
            let words: Vec<ByteArray> = words.map(&mut next).collect();
            let column = column.typed::<ByteArrayType>();
            column.write_batch(&words, Some(&there), None)?;
        }
    }
    Ok(())
}

/// The error of the operating system, where it is one: it says whether the disk is full.
pub(super) fn io_error(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(inner) => io::Error::other(inner),
        },
        other => io::Error::other(other),
    }
}
