//! Parquet files whose footers lie: about their rows, about the place of a column, about their own length.

use std::fs::{self, File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use cvtcycle::config::Problem;
use cvtcycle::study::store::{Head, Kind, Rows, Values};
use cvtcycle::study::store::{ParquetFile, read_trace_parquet, sha256, write_parquet};
use parquet::file::metadata::{
    FileMetaData, ParquetMetaData, ParquetMetaDataWriter, RowGroupMetaData,
};
use parquet::file::reader::{FileReader, SerializedFileReader};
use tempfile::TempDir;

use super::{folder, refused, short_run, sparse};

const DAMAGED: &str =
    "the file is damaged: it is shorter than it says, or longer than any of this program";

/// A file with one column of that many equal numbers.
fn table(dir: &TempDir, rows: usize) -> PathBuf {
    let path = dir.path().join("table.parquet");
    let column = Head {
        name: "time_s".to_owned(),
        unit: "s".to_owned(),
        doc: "time".to_owned(),
        kind: Kind::Number,
    };
    let rows = Rows {
        values: vec![Values::Number(vec![1.0; rows])],
    };
    write_parquet(File::create(&path).unwrap(), &[column], &rows, &[]).unwrap();
    path
}

/// Puts another footer behind the old one: the last one counts. The library writes the sum of the groups' rows as those of the file.
fn forge(path: &Path, group: impl Fn(RowGroupMetaData) -> RowGroupMetaData) {
    let found = SerializedFileReader::new(File::open(path).unwrap()).unwrap();
    let old = found.metadata().file_metadata();
    let (pairs, schema) = (old.key_value_metadata().cloned(), old.schema_descr_ptr());
    let new = FileMetaData::new(
        old.version(),
        old.num_rows(),
        old.created_by().map(str::to_owned),
        pairs,
        schema,
        None,
    );
    let metadata = ParquetMetaData::new(
        new,
        found
            .metadata()
            .row_groups()
            .iter()
            .cloned()
            .map(group)
            .collect(),
    );
    let mut bytes = Vec::new();
    ParquetMetaDataWriter::new(&mut bytes, &metadata)
        .finish()
        .unwrap();
    OpenOptions::new()
        .append(true)
        .open(path)
        .unwrap()
        .write_all(&bytes)
        .unwrap();
}

/// What reading says; the checksum is that of the file as it is.
fn read(path: &Path) -> Result<Rows, Problem> {
    let file = ParquetFile::open(path, &sha256(&fs::read(path).unwrap()))?;
    file.read(&["time_s"])
}

#[test]
fn rows_that_are_not_there_make_no_room() {
    let dir = tempfile::tempdir().unwrap();
    let path = table(&dir, 3);
    assert!(read(&path).is_ok());
    forge(&path, |group| group);
    assert!(read(&path).is_ok(), "a footer as it was");
    for (rows, words) in [
        (i64::MAX, DAMAGED),
        (1 << 40, DAMAGED),
        (16_000_001, DAMAGED),
        (-1, DAMAGED),
        (16_000_000, "a column is shorter than the table"),
        (2, "a column is longer than the table"),
    ] {
        let path = table(&dir, 3);
        forge(&path, |group| {
            group.into_builder().set_num_rows(rows).build().unwrap()
        });
        let printed = read(&path).unwrap_err().message;
        assert!(printed.contains(words), "{rows}: {printed}");
    }
}

#[test]
fn a_column_beyond_the_end_of_the_file_is_not_read() {
    let dir = tempfile::tempdir().unwrap();
    for (size, offset) in [
        (1 << 40, None),
        (i64::MAX, None),
        (-1, None),
        (60, Some(i64::MAX - 30)),
        (60, Some(-1)),
        (60, Some(1 << 31)),
    ] {
        let path = table(&dir, 3);
        forge(&path, |group| {
            let mut column = group
                .column(0)
                .clone()
                .into_builder()
                .set_total_compressed_size(size);
            if let Some(offset) = offset {
                column = column
                    .set_data_page_offset(offset)
                    .set_dictionary_page_offset(None);
            }
            group
                .into_builder()
                .set_column_metadata(vec![column.build().unwrap()])
                .build()
                .unwrap()
        });
        assert_eq!(
            read(&path).unwrap_err().message,
            DAMAGED,
            "{size} {offset:?}"
        );
    }
}

#[test]
fn a_trace_has_a_bounded_number_of_steps() {
    let dir = tempfile::tempdir().unwrap();
    let printed = read_trace_parquet(&table(&dir, 2_000_001)).unwrap_err();
    assert_eq!(
        (printed.len(), printed[0].allowed.as_str()),
        (1, "up to 2000000"),
        "{printed:?}"
    );
    assert!(
        printed[0]
            .message
            .contains("the file says that it has 2000001 rows"),
        "{printed:?}"
    );
    // So many are read; what else a trace has is missing.
    assert!(
        read_trace_parquet(&table(&dir, 2_000_000))
            .unwrap_err()
            .iter()
            .all(|problem| problem.message.contains("missing"))
    );
}

#[test]
fn a_footer_as_long_as_the_file_is_not_read() {
    let dir = folder();
    short_run(dir.path());
    fs::remove_file(dir.path().join("made/trace_rover_216_cvt.csv")).unwrap();
    let path = dir.path().join("made/trace_rover_216_cvt.parquet");
    sparse(&path, 1 << 31);
    let mut file = OpenOptions::new().write(true).open(&path).unwrap();
    file.seek(SeekFrom::End(-8)).unwrap();
    file.write_all(&(0x7000_0000_u32).to_le_bytes()).unwrap();
    file.write_all(b"PAR1").unwrap();
    let printed = refused(dir.path(), 64, "report made --out r.html");
    assert!(printed.contains(DAMAGED), "{printed}");
}
