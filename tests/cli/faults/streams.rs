//! Standard output that is full, closed, or read for one line only.

use std::fs::OpenOptions;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use super::{bin, made, program, stderr, words};

/// Commands that print.
const PRINTERS: [&str; 23] = [
    "run --cycle minute.csv",
    "run --cycle minute.csv --json",
    "run --cycle minute.csv --sensitivity never --force --out again",
    "study plan.toml",
    "study plan.toml --json",
    "study show made_study",
    "study export made_study --force --out again.csv",
    "report made_run --force --json",
    "validate --chapter 8",
    "validate --chapter 8 --json",
    "validate --chapter 8 --format html",
    "losses --format csv",
    "losses --json",
    "rig variator --ratio low --format csv",
    "rig transmission --test strip_down",
    "belt --points many.csv",
    "belt --points many.csv --json",
    "list cycles",
    "show rover_216_cvt",
    "explain SL-8",
    "check minute.csv",
    "schema vehicle",
    "assumptions",
];

/// Code 2 and a message on standard error; requested files are written nevertheless.
#[test]
fn a_full_standard_output_is_reported() {
    let dir = made();
    for line in PRINTERS {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = program(dir.path(), &words(line))
            .stdout(full)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}: {}", stderr(&output));
        assert!(
            stderr(&output).contains("standard output: cannot write: No space left"),
            "{line}: {}",
            stderr(&output)
        );
    }
    assert!(
        dir.path().join("again/summary.json").is_file() && dir.path().join("again.csv").is_file()
    );
}

/// `| head -1`, and a reader that is gone before any output: no error, no message.
#[test]
fn a_reader_that_closes_early_is_no_error() {
    let dir = made();
    for line in PRINTERS {
        for reads in [true, false] {
            let mut child = program(dir.path(), &words(line))
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            let mut out = BufReader::with_capacity(16, child.stdout.take().unwrap());
            let mut first = String::new();
            if reads {
                out.read_line(&mut first).unwrap();
                assert!(!first.is_empty(), "{line}");
            }
            drop(out);
            let output = child.wait_with_output().unwrap();
            let messages = stderr(&output);
            // A slow machine sees the progress of a long command.
            let other = messages.lines().find(|line| !line.contains(" runs/s, "));
            assert_eq!((output.status.code(), other), (Some(0), None), "{line}");
        }
    }
}

/// Without streams the exit code is all that is left.
#[test]
fn closed_streams_are_no_error() {
    let dir = made();
    for (line, code) in PRINTERS
        .iter()
        .map(|line| (*line, 0))
        .chain([("run --cycle nowhere.csv", 2), ("belt", 2)])
    {
        let command = format!("exec '{}' {line} <&- >&- 2>&-", bin().display());
        let status = Command::new("sh")
            .args(["-c", &command])
            .current_dir(dir.path())
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(code), "{line}");
    }
}

/// Messages without a reader do not change the exit code.
#[test]
fn a_full_or_closed_standard_error_does_not_change_the_code() {
    let dir = made();
    for (line, code) in [
        ("run --cycle nowhere.csv", 2),
        ("study plan.toml", 0),
        ("run --cycle us06 --set road_load.mass_kg=3500", 1),
    ] {
        let full = OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = program(dir.path(), &words(line))
            .stderr(full)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(code), "{line}");
        let mut child = program(dir.path(), &words(line))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stderr.take());
        assert_eq!(child.wait().unwrap().code(), Some(code), "{line}");
    }
}
