//! `run --format`: traces as CSV, Parquet, or both.

use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use cvtcycle::study::store::{ParquetFile, sha256, write_csv};
use tempfile::TempDir;

fn run(words: &[&str]) -> Output {
    Command::cargo_bin("cvtcycle")
        .unwrap()
        .arg("run")
        .args(words)
        .output()
        .unwrap()
}

fn traces(dir: &Path) -> Vec<String> {
    let names = fs::read_dir(dir)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.starts_with("trace_")).collect();
    names.sort();
    names
}

#[test]
fn traces_are_written_in_the_chosen_format() {
    let dir = TempDir::new().unwrap();
    for (format, wanted) in [
        (None, &["trace_rover_216_cvt.csv"][..]),
        (Some("csv"), &["trace_rover_216_cvt.csv"][..]),
        (Some("parquet"), &["trace_rover_216_cvt.parquet"][..]),
        (
            Some("both"),
            &["trace_rover_216_cvt.csv", "trace_rover_216_cvt.parquet"][..],
        ),
    ] {
        let out = dir.path().join(format.unwrap_or("default"));
        let mut words = vec![
            "--cycle",
            "ece15_eudc",
            "--baseline",
            "none",
            "--out",
            out.to_str().unwrap(),
        ];
        words.extend(format.iter().flat_map(|format| ["--format", format]));
        let output = run(&words);
        assert_eq!(
            output.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        assert_eq!(traces(&out), wanted, "{format:?}");
    }
    let path = dir.path().join("both/trace_rover_216_cvt.parquet");
    let table = ParquetFile::open(&path, &sha256(&fs::read(&path).unwrap())).unwrap();
    let names: Vec<&str> = table
        .columns()
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    let mut csv = Vec::new();
    write_csv(&mut csv, table.columns(), &table.read(&names).unwrap()).unwrap();
    assert!(table.rows() > 1000);
    assert!(
        csv == fs::read(path.with_extension("csv")).unwrap(),
        "the CSV has other cells than the Parquet"
    );
    assert!(
        fs::read(&path).unwrap()
            == fs::read(dir.path().join("parquet/trace_rover_216_cvt.parquet")).unwrap()
    );
}

#[test]
fn a_format_is_one_of_three_and_needs_a_directory() {
    let dir = TempDir::new().unwrap();
    let out = dir.path().join("out");
    let output = run(&[
        "--out",
        out.to_str().unwrap(),
        "--format",
        "parket",
        "--ambient",
        "x",
    ]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0));
    assert!(
        said.contains("--format: `parket` is not known")
            && said.contains("did you mean `parquet`?")
            && said.contains("2 problems"),
        "{said}"
    );
    assert!(!out.exists());
    assert_eq!(run(&["--format", "parquet"]).status.code(), Some(2));
}
