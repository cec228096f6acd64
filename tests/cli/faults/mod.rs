//! Faults around the program: full and read-only disks, readers that go away, signals, clocks, threads, bare environments, names
//! that are not text, and names in files that point elsewhere. Nothing is lost, no partial file has a final name, and the exit code
//! is right.
//! Full and read-only places are tmpfs mounts for the child only. Where mounting is not allowed, those tests print that
//! they are skipped, and fail if CVTCYCLE_REQUIRE_FULL_DISK is set.
#![cfg(target_os = "linux")]
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "helpers of tests; a test that is skipped says so"
)]

mod environment;
mod names;
mod places;
mod processes;
mod signals;
mod streams;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::tree::{same, tree};
use tempfile::TempDir;

const CYCLE: &str =
    "time_s,speed_kmh,phase\n0,0,town\n4,0,town\n14,32,town\n24,32,town\n34,0,road\n60,60,road\n";
const PLAN: &str = "[study]\ntitle = \"t\"\nbaselines = [\"rover_216_5mt\"]\ncycle = \"minute.csv\"\nkeep = [\"time_s\", \"gear\"]\n\
    [study.design.monte_carlo]\nsamples = 120\n[[factor]]\nkey = \"engine.electrical_w\"\ncars = \"all\"\nstatus = \"assumed\"\n\
    distribution.uniform = { low = 100, high = 500 }\n";
const POINTS: &str = "ratio,input_speed_rpm,secondary_pressure_bar,output_torque_nm\n2.4,2000,30,60\n0.5,3000,12,40\n";

/// Commands that write to `OUT`; then directories of a finished run and study.
const WRITERS: [&str; 12] = [
    "run --cycle minute.csv --sensitivity never --quiet --out OUT",
    "run --cycle minute.csv --sensitivity never --quiet --format both --out OUT",
    "study plan.toml --quiet --out OUT",
    "study export made_study --quiet --out OUT.csv",
    "study export made_study --quiet --out OUT.parquet",
    "study export made_study --quiet --table traces --out OUT.parquet",
    "report made_run --quiet --out OUT.html",
    "report made_run --quiet --out OUT.md",
    "validate --chapter 8 --quiet --out OUT",
    "losses --ratio low --speed 1000..4000:500 --temp 25,80 --quiet --out OUT",
    "rig variator --ratio low --quiet --out OUT",
    "belt --points many.csv --quiet --out OUT.csv",
];

/// Path of the program, for shell scripts.
fn bin() -> PathBuf {
    assert_cmd::cargo::cargo_bin("cvtcycle")
}

fn program(dir: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(bin());
    command.current_dir(dir).args(words);
    command
}

fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs a command and checks its exit code.
fn ends(dir: &Path, line: &str, code: i32) -> Output {
    let output = program(dir, &words(line)).output().unwrap();
    assert_eq!(
        output.status.code(),
        Some(code),
        "{line}: {}",
        stderr(&output)
    );
    output
}

/// Creates a folder with a cycle, a plan and points.
fn folder() -> TempDir {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("minute.csv", CYCLE),
        ("plan.toml", PLAN),
        ("points.csv", POINTS),
    ] {
        fs::write(dir.path().join(name), text).unwrap();
    }
    let rows: Vec<&str> = POINTS.lines().collect();
    fs::write(
        dir.path().join("many.csv"),
        format!("{}\n{}", rows[0], format!("{}\n", rows[1]).repeat(2000)),
    )
    .unwrap();
    dir
}

/// Creates the same folder with a finished run and a finished study.
fn made() -> TempDir {
    let dir = folder();
    ends(
        dir.path(),
        "run --cycle minute.csv --sensitivity never --quiet --out made_run",
        0,
    );
    ends(dir.path(), "study plan.toml --quiet --out made_study", 0);
    dir
}

/// Runs a script with its own mounts in a folder; false if mounting is not allowed.
fn with_mounts(dir: &Path, script: &str) -> bool {
    let status = Command::new("unshare")
        .args(["-rm", "sh", "-c", script])
        .current_dir(dir)
        .status();
    let done = status.is_ok_and(|status| status.success());
    assert!(
        done || std::env::var_os("CVTCYCLE_REQUIRE_FULL_DISK").is_none(),
        "no small file system can be mounted here"
    );
    if !done {
        eprintln!("skipped: no small file system can be mounted here");
    }
    done
}
