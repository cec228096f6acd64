//! Test benches, the belt command and tables of losses, through library and program.

#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/titles.rs"]
mod titles;

mod belt;
mod loss_columns;
mod loss_forms;
mod losses;
mod rig_transmission;
mod rig_variator;

use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;

/// Runs a command with options.
fn run(command: &[&str], words: &[&str]) -> Output {
    Command::cargo_bin("cvtcycle")
        .unwrap()
        .args(command)
        .args(words)
        .output()
        .unwrap()
}

/// Standard output of a command that must succeed.
fn printed(command: &[&str], words: &[&str]) -> String {
    let output = run(command, words);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{words:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Checks that CSV and JSON of a command have equal points; returns the columns and the JSON.
fn same_points(command: &[&str], words: &[&str]) -> (Vec<String>, Value) {
    let csv = printed(command, &[words, &["--format", "csv"]].concat());
    let json: Value =
        serde_json::from_str(&printed(command, &[words, &["--json"]].concat())).unwrap();
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let names: Vec<String> = reader
        .headers()
        .unwrap()
        .iter()
        .map(str::to_owned)
        .collect();
    let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let points = json["points"].as_array().unwrap();
    assert_eq!(
        (records.len(), json["count"].as_u64()),
        (points.len(), Some(points.len() as u64))
    );
    for (record, point) in records.iter().zip(points) {
        for (name, cell) in names.iter().zip(record) {
            match &point[name] {
                // The JSON reader may differ in the last bit.
                Value::Number(x) => {
                    let (a, b) = (cell.parse::<f64>().unwrap(), x.as_f64().unwrap());
                    assert!((a - b).abs() <= 4e-16 * a.abs(), "{name}: {a} {b}");
                }
                Value::Null => assert_eq!(cell, "", "{name}"),
                Value::String(word) => assert_eq!(cell, word),
                Value::Array(flags) => {
                    let flags: Vec<&str> = flags.iter().map(|f| f.as_str().unwrap()).collect();
                    assert_eq!(cell, flags.join("|"));
                }
                other => panic!("{name}: {other}"),
            }
        }
    }
    (names, json)
}
