//! README and docs against the program and the files: links point to files in git, and quoted results equal the program's.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use std::fs::read_to_string;
use std::path::{Component, Path, PathBuf};

use assert_cmd::Command;
use cvtcycle::output::number::signed;
use serde_json::Value;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(name: &str) -> String {
    let text = read_to_string(root().join(name));
    text.unwrap_or_else(|error| panic!("{name}: {error}"))
        .replace("\r\n", "\n")
}

/// Standard output of the program.
fn cvtcycle(args: &[&str]) -> String {
    let mut command = Command::cargo_bin("cvtcycle").unwrap();
    let output = command.args(args).current_dir(root()).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

fn run(args: &[&str]) -> Value {
    let text = cvtcycle(&[&["run", "--json", "--quiet"], args].concat());
    serde_json::from_str(&text).unwrap()
}

/// Documents with links: top level, `docs` and tools.
fn documents() -> Vec<PathBuf> {
    let mut list = Vec::new();
    for folder in ["", "docs", "tools/fuzz", "cycles", "tests/golden"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "md") {
                list.push(path.strip_prefix(root()).unwrap().to_owned());
            }
        }
    }
    list
}

/// Removes `.` and `..` from a path.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => assert!(normal.pop(), "{}", path.display()),
            Component::CurDir => {}
            part => normal.push(part),
        }
    }
    normal
}

/// Parses `.gitignore`, which has paths from the root only.
fn ignored() -> Vec<PathBuf> {
    let text = read(".gitignore");
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let path =
        |line: &str| PathBuf::from(line.strip_prefix('/').unwrap_or_else(|| panic!("{line}")));
    lines.map(path).collect()
}

#[test]
fn links_point_to_files_in_git() {
    let (mut wrong, mut links) = (String::new(), 0);
    let ignored = ignored();
    for document in documents() {
        let text = read(document.to_str().unwrap());
        let targets = text
            .match_indices("](")
            .map(|(at, mark)| &text[at + mark.len()..]);
        for target in targets.filter_map(|rest| rest.split(')').next()) {
            let file = target.split('#').next().unwrap();
            if file.is_empty() || file.contains("://") {
                continue;
            }
            links += 1;
            let path = normal(&document.parent().unwrap().join(file));
            if !root().join(&path).exists() {
                wrong += &format!("{}: {target} does not exist\n", document.display());
            } else if ignored.iter().any(|ignored| path.starts_with(ignored)) {
                wrong += &format!("{}: {target} is not in git\n", document.display());
            }
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
    assert!(links > 30, "{links}");
}

/// Cells of the table below a line of a document, without its head.
fn table(text: &str, heading: &str) -> Vec<Vec<String>> {
    let (_, below) = text
        .split_once(heading)
        .unwrap_or_else(|| panic!("no {heading:?}"));
    let lines = below.lines().skip_while(|line| !line.starts_with('|'));
    let rows = lines.take_while(|line| line.starts_with('|')).skip(2);
    let cells = |row: &str| {
        row.trim_matches('|')
            .split('|')
            .map(|cell| cell.trim().to_owned())
            .collect()
    };
    rows.map(cells).collect()
}

fn percent(value: &Value) -> String {
    format!("{:+.1} %", value.as_f64().unwrap())
}

fn fuel(run: &Value, car: usize) -> f64 {
    run["runs"][car]["fuel_l_per_100km"].as_f64().unwrap()
}

#[test]
fn val_the_comparison_over_ambient_temperature_is_that_of_the_program() {
    let rows = table(
        &read("docs/results.md"),
        "## The comparison over ambient temperature",
    );
    assert_eq!(rows.len(), 10);
    for row in &rows {
        let (ambient, start) = row[0].split_once(" degC, ").unwrap();
        let run = run(&["--ambient", ambient, "--start", start]);
        let [manual, mondeo] = [0, 1].map(|car| &run["comparison"][car]);
        let sump = run["runs"][0]["end_degc"]["transmission_sump"]
            .as_f64()
            .unwrap();
        let computed = [
            row[0].clone(),
            format!("{:.2}", fuel(&run, 0)),
            format!("{:.2}", fuel(&run, 1)),
            percent(&manual["fuel_percent"]),
            percent(&manual["phases_percent"]["ece15"]),
            percent(&manual["phases_percent"]["eudc"]),
            percent(&mondeo["fuel_percent"]),
            format!("{sump:.0} degC"),
        ];
        assert_eq!(*row, computed);
    }
}

#[test]
fn val_the_effects_of_changes_are_those_of_the_program() {
    let rows = table(&read("docs/results.md"), "## What engineers ask first");
    assert_eq!(rows.len(), 13);
    for (column, ambient) in [(1, "-10"), (2, "25")] {
        let conditions = ["--ambient", ambient, "--baseline", "none"];
        let shipped = fuel(&run(&conditions), 0);
        for row in &rows {
            let change = row[0].split('`').nth(1).unwrap();
            let option = change.split_once(' ').unwrap_or(("--set", change));
            let changed = fuel(&run(&[&conditions[..], &[option.0, option.1]].concat()), 0);
            let effect = format!("{} %", signed(100.0 * (changed / shipped - 1.0), 1));
            assert_eq!(row[column], effect, "{change} at {ambient} degC");
        }
    }
}

#[test]
fn val_the_numbers_of_the_readme_are_those_of_the_program() {
    let readme = read("README.md").replace('\n', " ");
    let quoted = |text: String| assert!(readme.contains(&text), "README.md does not quote: {text}");
    let cold = run(&["--ambient", "-10"]);
    let [cvt, manual, mondeo] = [0, 1, 2].map(|car| fuel(&cold, car));
    quoted(format!(
        "Rover CVT {cvt:.2}, the same car with 5-speed {manual:.2}, Mondeo 2.0 {mondeo:.2}"
    ));
    let mild = &run(&["--ambient", "25"])["comparison"][0]["fuel_percent"];
    quoted(format!("{:.1} % at 25 degC", mild.as_f64().unwrap()));
    let validation: Value = serde_json::from_str(&cvtcycle(&["validate", "--json"])).unwrap();
    let groups = &validation["groups"];
    quoted(format!(
        "the {} that nothing was fitted to",
        groups["thesis"]["held_out"]["rows"]
    ));
    let outside = &groups["outside"]["held_out"];
    quoted(format!(
        "of its {} rows that nothing was fitted to {} agree",
        outside["rows"], outside["agree"]
    ));
}

/// The example in docs/calibration.md is what the program prints.
#[test]
fn val_the_calibration_example_is_what_the_program_prints() {
    let printed = cvtcycle(&["calibrate", "docs/calibration_example/plan.toml"]);
    let page = read("docs/calibration.md");
    let (_, example) = page
        .split_once("$ cvtcycle calibrate docs/calibration_example/plan.toml\n")
        .unwrap();
    let example = example.split("```").next().unwrap();
    for part in example.split("...\n") {
        assert!(
            printed.contains(part),
            "not printed:\n{part}\nprinted:\n{printed}"
        );
    }
    assert!(example.lines().count() > 15);
}

/// Splits a command at blanks, except between single quotes.
fn words(command: &str) -> Vec<String> {
    let (mut words, mut quoted) = (vec![String::new()], false);
    for letter in command.chars() {
        match letter {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            letter => words.last_mut().unwrap().push(letter),
        }
    }
    words
}

/// Runs the blocks of docs/book/src/your_car.md in order in an empty folder. A file begins with a line that names it; a command must end with exit code 0.
#[test]
fn the_commands_of_your_car_in_an_hour_run() {
    let page = read("docs/book/src/your_car.md");
    let folder = tempfile::tempdir().unwrap();
    let (mut files, mut commands) = (0, 0);
    // Every second part is a block: its language, then its lines.
    for block in page.split("```").skip(1).step_by(2) {
        let (language, text) = block.split_once('\n').unwrap();
        if language != "console" {
            let name = text.lines().next().unwrap();
            if let Some(name) = name.strip_prefix("# ") {
                std::fs::write(folder.path().join(name), text).unwrap();
                files += 1;
            }
            continue;
        }
        for line in text.lines() {
            let Some(line) = line.strip_prefix("$ cvtcycle ") else {
                continue;
            };
            let mut command = Command::cargo_bin("cvtcycle").unwrap();
            command.args(words(line)).current_dir(folder.path());
            let output = command.output().unwrap();
            let error = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(0), "{line}: {error}");
            commands += 1;
        }
    }
    assert!(files >= 6 && commands > 20, "{files} {commands}");
}
