//! Runs the program in a temporary directory: exit codes, streams, files.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod accelerate;
mod attribute;
mod optimum;
mod out;
mod compare;
mod cycles;
mod fleet;
mod fmu;
mod inputs;
mod label;
mod levers;
mod log;
mod log_car;
mod log_table;
mod named;
mod new;
mod one_answer;
mod run;
mod standing;
mod streams;
mod study;
#[cfg(unix)]
mod terminal;
mod whatif;
mod words;

use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};

use assert_cmd::Command;
use serde_json::Value;

fn program() -> Command {
    let mut command = Command::cargo_bin("cvtcycle").unwrap();
    command.env_remove("NO_COLOR");
    command
}

fn run(words: &[&str]) -> Output {
    program().args(words).output().unwrap()
}

fn run_in(dir: &Path, words: &[&str]) -> Output {
    program().current_dir(dir).args(words).output().unwrap()
}

/// Undoes the line wrapping of a text.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn words(text: &str) -> Vec<&str> {
    text.split(' ').collect()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// Runs a successful command and parses the single JSON object on standard output.
fn json(words: &[&str]) -> Value {
    let output = run(words);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{words:?}: {}",
        stderr(&output)
    );
    assert_eq!(stderr(&output), "", "{words:?}");
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(value.is_object(), "{words:?}");
    value
}

/// Runs a command with bad input: exit code 2, empty standard output.
fn refused(words: &[&str]) -> String {
    let output = run(words);
    assert_eq!(output.status.code(), Some(2), "{words:?}");
    assert_eq!(stdout(&output), "", "{words:?}");
    stderr(&output)
}

fn keys(value: &Value) -> Vec<&str> {
    value
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect()
}

#[test]
fn a_users_own_files_can_be_run() {
    let dir = tempfile::tempdir().unwrap();
    let car = Path::new(env!("CARGO_MANIFEST_DIR")).join("vehicles/rover_216_5mt.toml");
    fs::copy(car, dir.path().join("my_car.toml")).unwrap();
    fs::write(
        dir.path().join("town.csv"),
        "time_s,speed_kmh\n0,0\n10,36\n20,36\n30,0\n",
    )
    .unwrap();
    let output = run_in(
        dir.path(),
        &[
            "run",
            "--cycle",
            "town.csv",
            "--vehicle",
            "./my_car.toml",
            "--baseline",
            "none",
            "--json",
        ],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&summary["cycle"], &summary["runs"][0]["vehicle"]),
        (&Value::from("town"), &Value::from("my_car"))
    );
    // By hand: 50 m, 100 m and 50 m.
    assert!((summary["runs"][0]["distance_km"].as_f64().unwrap() - 0.2).abs() < 1e-12);
}

#[test]
fn packagers_get_completions_and_manual_pages() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = stdout(&run(&["completions", shell]));
        assert!(script.contains("ambient"), "{shell}");
        // The generators for the other shells leave values out.
        let values = ["bash", "zsh", "fish"].contains(&shell);
        assert_eq!(
            script.contains("ece15_eudc") && script.contains("rover_216_cvt"),
            values,
            "{shell}"
        );
    }
    assert!(stdout(&run(&["man"])).contains(".TH"));
    assert!(stdout(&run(&["man", "run"])).contains("ambient"));
    assert!(refused(&["man", "rum"]).contains("did you mean `run"));
}

#[test]
fn assumptions_has_every_value_of_the_shipped_files() {
    let printed = stdout(&run(&["assumptions"]));
    for vehicle in ["rover_216_cvt", "rover_216_5mt", "mondeo_20_5mt"] {
        let shown = stdout(&run(&["show", vehicle, "--status", "assumed", "--json"]));
        let shown: Value = serde_json::from_str(&shown).unwrap();
        let keys = shown["keys"].as_array().unwrap();
        assert!(keys.len() > 40, "{vehicle}: {}", keys.len());
        for value in keys {
            let row = format!("| `{}` |", value["key"].as_str().unwrap());
            assert!(printed.contains(&row), "{vehicle}: {row}");
        }
    }
}

/// Every command's help ends with examples, which run as printed.
#[test]
fn the_examples_of_the_help_work() {
    let dir = tempfile::tempdir().unwrap();
    let mut count = 0;
    for command in [
        "",
        "run",
        "report",
        "list",
        "show",
        "explain",
        "check",
        "schema",
        "assumptions",
        "completions",
        "man",
    ] {
        let words: Vec<&str> = [command, "--help"]
            .into_iter()
            .filter(|word| !word.is_empty())
            .collect();
        let help = stdout(&run(&words));
        let lines = help.lines().filter_map(|line| {
            let line = line.trim_start().trim_start_matches("Example: ");
            line.strip_prefix("cvtcycle ")
                .map(|line| line.split(" > ").next().unwrap_or(line))
        });
        let examples: Vec<&str> = lines.filter(|line| !line.starts_with('[')).collect();
        assert!(!examples.is_empty(), "{command}:\n{help}");
        for example in examples {
            let mut words: Vec<&str> = example.split_whitespace().collect();
            // The report of one command computes its sample; that of each further example would take 10 s more.
            if words[0] == "report" && !words.contains(&"--vehicle") {
                words.push("--stored");
            }
            let output = run_in(dir.path(), &words);
            assert_eq!(
                output.status.code(),
                Some(0),
                "{example}: {}",
                stderr(&output)
            );
            count += 1;
        }
    }
    assert!(count > 15);
}

#[test]
fn the_files_that_a_vehicle_names_are_read_from_its_folder() {
    let dir = tempfile::tempdir().unwrap();
    let embedded = |name: &str| {
        fs::read_to_string(
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("vehicles")
                .join(name),
        )
        .unwrap()
    };
    let cars = dir.path().join("cars");
    fs::create_dir(&cars).unwrap();
    fs::write(cars.join("other.toml"), embedded("rover_216_5mt.toml")).unwrap();
    let car = embedded("rover_216_cvt.toml");
    fs::write(
        cars.join("good.toml"),
        car.replace("rover_216_5mt", "other.toml"),
    )
    .unwrap();
    fs::write(
        cars.join("bad.toml"),
        car.replace("rover_216_5mt", "no_such_car"),
    )
    .unwrap();
    let good = run_in(
        dir.path(),
        &[
            "run",
            "--cycle",
            "ece15",
            "--vehicle",
            "cars/good.toml",
            "--json",
        ],
    );
    let summary: Value = serde_json::from_slice(&good.stdout).unwrap();
    assert_eq!(summary["runs"][1]["vehicle"], "other");
    // A baseline that is the file of the car by another spelling is the car unchanged.
    let own = run_in(
        dir.path(),
        &[
            "run",
            "--cycle",
            "ece15",
            "--vehicle",
            "cars/good.toml",
            "--set",
            "road_load.mass_kg=1200",
            "--baseline",
            "./cars/good.toml",
            "--json",
        ],
    );
    let own: Value = serde_json::from_slice(&own.stdout).unwrap();
    assert_eq!(own["runs"][1]["role"], "unchanged");
    assert_eq!(own["runs"].as_array().map(Vec::len), Some(2));
    for words in [
        &["run", "--vehicle", "cars/bad.toml"][..],
        &["check", "cars/bad.toml"],
    ] {
        let bad = run_in(dir.path(), words);
        assert_eq!(bad.status.code(), Some(2));
        assert!(
            stderr(&bad).contains("cars/bad.toml: there is no vehicle named `no_such_car`"),
            "{}",
            stderr(&bad)
        );
    }
}
