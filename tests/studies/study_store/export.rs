//! A study as one file.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use cvtcycle::config::ProblemKind;
use cvtcycle::output::file::OutputFile;
use cvtcycle::study::store::{Exported, Format, export};
use cvtcycle::study::store::{Kind, Rows, Values};
use cvtcycle::study::store::{ParquetFile, Study, StudyDir, sha256};
use tempfile::TempDir;

use crate::parts::write_runs;

use super::{PLAN, RUN, head, heads, manifest, manifest_of, rows, whole, write_part};

const PARTS: usize = 3;
/// Names of its columns with their units.
const HEADER: [&str; 5] = [
    "run",
    "vehicle",
    "fuel_l_per_100km [L/100 km]",
    "transmission.cvt.belt.band_offset_mm [mm]",
    "reason",
];

fn exported(study: &Path, table: &str, to: &Path) -> Result<Exported, cvtcycle::config::Problem> {
    let format = Format::of(to)?;
    let mut out = OutputFile::create(to, true)?;
    let exported = export(&Study::open(study)?, table, format, &mut out)?;
    out.commit()?;
    Ok(exported)
}

/// A study of three parts, exported.
fn to(name: &str) -> (TempDir, PathBuf) {
    let dir = TempDir::new().unwrap();
    let study = dir.path().join("study");
    whole(&study, PARTS);
    let file = dir.path().join(name);
    let exported = exported(&study, "runs", &file).unwrap();
    assert_eq!(
        (exported.rows, exported.status.is_complete()),
        (3 + 4 + 5, true)
    );
    (dir, file)
}

/// All cells as they are in CSV.
fn cells() -> Vec<Vec<String>> {
    let row = |rows: &Rows, k: usize| {
        let cell = |values: &Values| match values {
            Values::Number(x) if x[k].is_nan() => String::new(),
            Values::Number(x) => x[k].to_string(),
            Values::Count(n) => n[k].to_string(),
            Values::Text(words) => words[k].to_string(),
        };
        rows.values.iter().map(cell).collect::<Vec<_>>()
    };
    (0..PARTS)
        .map(rows)
        .flat_map(|rows| (0..rows.len()).map(|k| row(&rows, k)).collect::<Vec<_>>())
        .collect()
}

#[test]
fn csv_has_units_in_its_header_and_all_rows() {
    let (_dir, file) = to("runs.csv");
    let text = fs::read(&file).unwrap();
    let mut reader = csv::Reader::from_reader(&text[..]);
    assert_eq!(reader.headers().unwrap(), &HEADER[..]);
    let found: Vec<Vec<String>> = reader
        .records()
        .map(|record| record.unwrap().iter().map(str::to_owned).collect())
        .collect();
    assert_eq!(found, cells());
}

#[test]
fn a_byte_order_mark_is_written_where_a_letter_is_beyond_ascii() {
    let dir = TempDir::new().unwrap();
    for (name, word, marked) in [("plain", "a", false), ("umlaut", "Öl", true)] {
        let columns = [head("word", "", Kind::Text)];
        let path = dir.path().join(name);
        let study =
            StudyDir::create(&path, &manifest_of(1, &["runs"], false), PLAN, false).unwrap();
        let rows = Rows {
            values: vec![Values::Text(vec!["x".into(), word.into()])],
        };
        write_runs(&study, 0, &columns, &rows);
        exported(&path, "runs", &path.join("out.csv")).unwrap();
        let bytes = fs::read(path.join("out.csv")).unwrap();
        assert_eq!(bytes.starts_with(b"\xEF\xBB\xBFword\n"), marked, "{name}");
        assert!(
            String::from_utf8(bytes)
                .unwrap()
                .ends_with(&format!("x\n{word}\n"))
        );
    }
}

#[test]
fn parquet_has_a_row_group_a_part_and_the_manifest() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    let (dir, file) = to("runs.parquet");
    let bytes = fs::read(&file).unwrap();
    let groups = SerializedFileReader::new(File::open(&file).unwrap()).unwrap();
    let sizes: Vec<i64> = groups
        .metadata()
        .row_groups()
        .iter()
        .map(|group| group.num_rows())
        .collect();
    assert_eq!(sizes, [3, 4, 5]);
    let table = ParquetFile::open(&file, &sha256(&bytes)).unwrap();
    assert_eq!(table.columns(), heads());
    let manifest = String::from_utf8(super::manifest(PARTS)).unwrap();
    let own = [("cvtcycle.run", RUN), ("cvtcycle.manifest", &*manifest)];
    let own = own.map(|(key, value)| (key.to_owned(), value.to_owned()));
    assert_eq!(table.metadata()[..2], own);
    let part = dir.path().join("study/parts/runs_00000.parquet");
    let part = ParquetFile::open(&part, &sha256(&fs::read(&part).unwrap())).unwrap();
    assert_eq!(part.metadata()[0], own[0]);
    let all = Study::open(dir.path().join("study"))
        .unwrap()
        .read("runs", &["run", "reason", "vehicle"])
        .unwrap();
    assert_eq!(table.read(&["run", "reason", "vehicle"]).unwrap(), all);
}

#[test]
fn the_ending_says_the_format_and_a_partial_study_is_exported_as_far_as_it_is() {
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("study");
    let study = StudyDir::create(&path, &manifest(PARTS), PLAN, false).unwrap();
    let problem = exported(&path, "runs", &dir.path().join("a.csv")).unwrap_err();
    assert!(
        problem.message.contains("no rows yet"),
        "{}",
        problem.message
    );
    write_part(&study, 1);
    for ending in ["csv", "CSV", "parquet"] {
        let exported = exported(&path, "trace", &dir.path().join(format!("a.{ending}"))).unwrap();
        assert_eq!(
            (
                exported.rows,
                exported.status.present,
                exported.status.is_complete()
            ),
            (4, 1, false),
            "{ending}"
        );
    }
    for name in ["a", "a.xlsx", "a.csv.gz", "csv"] {
        let problem = Format::of(Path::new(name)).unwrap_err();
        assert!(problem.allowed.contains(".parquet"), "{name}");
    }
    let spoiled = path.join("parts/trace_00001.parquet");
    fs::write(&spoiled, "no").unwrap();
    for ending in ["csv", "parquet"] {
        let to = dir.path().join(format!("b.{ending}"));
        let problem = exported(&path, "trace", &to).unwrap_err();
        assert_eq!(problem.kind, ProblemKind::Damaged);
        assert!(!to.exists());
    }
}
