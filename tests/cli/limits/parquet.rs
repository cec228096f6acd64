//! Parquet files with false footers: wrong numbers of rows, places of columns, footer lengths.

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

use super::{folder, refused, short_run, sparse, within};

const DAMAGED: &str =
    "the file is damaged: it is shorter than it says, or longer than any of this program";

/// Writes a file with one column of equal numbers.
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

/// Appends another footer, which readers use. The library writes the sum of the groups' rows as those of the file.
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

/// Reads a file, with its actual checksum.
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
        (i64::MAX, "rows, up to 2050000 are due"),
        (1 << 40, "it has 1099511627776 rows, up to 2050000 are due"),
        (2_050_001, "it has 2050001 rows, up to 2050000 are due"),
        (-1, DAMAGED),
        (2_050_000, "a column is shorter than the table"),
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
fn a_column_that_says_to_unpack_to_more_than_its_bytes_can_is_not_read() {
    let dir = tempfile::tempdir().unwrap();
    for (size, good) in [
        (1 << 16, true),
        (1 << 20, false),
        (1 << 31, false),
        (-1, false),
    ] {
        let path = table(&dir, 3);
        forge(&path, |group| {
            let column = group.column(0).clone().into_builder();
            let column = column.set_total_uncompressed_size(size).build().unwrap();
            let group = group.into_builder().set_column_metadata(vec![column]);
            group.build().unwrap()
        });
        assert_eq!(read(&path).is_ok(), good, "{size}");
    }
}

/// A part of another study is consistent by itself, so its rows are compared with the points of this study.
#[test]
fn a_part_has_the_rows_of_its_points() {
    let dir = folder();
    let plan = "[study]\ncycle = \"short.csv\"\nbaselines = []\ndesign = \"grid\"\n[[factor]]\nkey = \"ambient_degc\"\nvalues = [0, 20]\n";
    fs::write(dir.path().join("plan.toml"), plan).unwrap();
    let made = within(dir.path(), 1000, "study plan.toml --quiet --out made");
    assert_eq!(
        made.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    let parts = dir.path().join("made/parts");
    let file = parts.join("runs_00000.parquet");
    for rows in [0, 2, 2_000_000] {
        forge(&file, |group| {
            group.into_builder().set_num_rows(rows).build().unwrap()
        });
        let sum = sha256(&fs::read(&file).unwrap());
        let sum: String = sum.iter().map(|byte| format!("{byte:02x}")).collect();
        let list = format!("{sum}  runs_00000.parquet\n");
        fs::write(parts.join("part_00000.sha256"), list).unwrap();
        for line in [
            "study show made",
            "study export made --out a.csv --force",
            "report made --out r.html",
        ] {
            let printed = refused(dir.path(), 64, line);
            let words = format!("it has {rows} rows, 1 are due");
            assert!(printed.contains(&words), "{line}: {printed}");
        }
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
    // Reads that many steps; other columns of a trace are missing.
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
    // Without the record any trace is read.
    for name in ["trace_rover_216_cvt.csv", "inputs.json"] {
        fs::remove_file(dir.path().join("made").join(name)).unwrap();
    }
    let path = dir.path().join("made/trace_rover_216_cvt.parquet");
    sparse(&path, 1 << 31);
    let mut file = OpenOptions::new().write(true).open(&path).unwrap();
    file.seek(SeekFrom::End(-8)).unwrap();
    file.write_all(&(0x7000_0000_u32).to_le_bytes()).unwrap();
    file.write_all(b"PAR1").unwrap();
    let printed = refused(dir.path(), 64, "report made --out r.html");
    assert!(printed.contains(DAMAGED), "{printed}");
}
