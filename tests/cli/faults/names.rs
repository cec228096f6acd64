//! Names: files whose names are not text, and names in files that point elsewhere.

use std::ffi::OsString;
use std::fs;
use std::os::unix::ffi::OsStringExt;
use std::path::Path;
use std::process::{Command, Output};

use super::{CYCLE, PLAN, WRITERS, bin, ends, folder, made, stderr, tree};

/// Name that is not UTF-8.
fn odd(before: &str, after: &str) -> OsString {
    OsString::from_vec([before.as_bytes(), b"\xff\xfe", after.as_bytes()].concat())
}

/// Runs a line with that name in place of `ODD`.
fn with_odd(dir: &Path, line: &str) -> Output {
    let words = line
        .split_whitespace()
        .map(|word| match word.split_once("ODD") {
            Some((before, after)) => odd(before, after),
            None => OsString::from(word),
        });
    Command::new(bin())
        .current_dir(dir)
        .args(words)
        .output()
        .unwrap()
}

/// Output may have any name that the system allows: all of --out work and can be read again.
#[test]
fn outputs_may_have_names_that_are_no_text() {
    for line in WRITERS {
        let line = line.replace("OUT", "ODD");
        let dir = made();
        let output = with_odd(dir.path(), &line);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", stderr(&output));
    }
    let dir = made();
    for line in [
        "run --cycle minute.csv --sensitivity never --json --out rODD",
        "report rODD --json",
        "study plan.toml --out sODD --json",
    ] {
        let output = with_odd(dir.path(), line);
        assert_eq!(output.status.code(), Some(0), "{line}: {}", stderr(&output));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap();
    }
    for line in [
        "study show sODD",
        "study export sODD --out eODD.csv",
        "study plan.toml --out sODD --resume --quiet",
    ] {
        assert_eq!(with_odd(dir.path(), line).status.code(), Some(0), "{line}");
    }
}

/// Names of inputs must be text: others are refused by name, and nothing is written.
#[test]
fn inputs_with_names_that_are_no_text_are_refused() {
    let dir = made();
    let car = concat!(env!("CARGO_MANIFEST_DIR"), "/vehicles/rover_216_cvt.toml");
    fs::copy(car, dir.path().join(odd("car", ".toml"))).unwrap();
    fs::write(dir.path().join(odd("cycle", ".csv")), CYCLE).unwrap();
    fs::write(dir.path().join(odd("plan", ".toml")), PLAN).unwrap();
    let before = tree(dir.path());
    for line in [
        "run --cycle cycleODD.csv --out new",
        "run --vehicle carODD.toml",
        "run --set engineODD=3",
        "study planODD.toml --out new",
        "report made_run --cover coverODD.toml --out new.html",
        "validate --rows rowsODD.toml",
        "belt --points pointsODD.csv",
        "check carODD.toml",
        "show carODD.toml",
        "explain keyODD",
    ] {
        let output = with_odd(dir.path(), line);
        let message = stderr(&output);
        assert_eq!(
            (output.status.code(), output.stdout.len()),
            (Some(2), 0),
            "{line}: {message}"
        );
        assert!(
            message.contains("is not UTF-8") && message.contains("= help: "),
            "{line}: {message}"
        );
    }
    assert_eq!(tree(dir.path()), before);
}

/// Below a folder whose name is not text, relative names work.
#[test]
fn folders_may_have_names_that_are_no_text() {
    let dir = folder();
    let inner = dir.path().join(odd("in", ""));
    fs::create_dir(&inner).unwrap();
    for name in ["minute.csv", "plan.toml"] {
        fs::copy(dir.path().join(name), inner.join(name)).unwrap();
    }
    ends(
        &inner,
        "run --cycle ./minute.csv --sensitivity never --quiet --out run",
        0,
    );
    ends(&inner, "study ./plan.toml --quiet --out study", 0);
    ends(&inner, "report run --quiet", 0);
}

const UP: [&str; 5] = [
    "../../up",
    "/tmp/cvtcycle_up",
    "..",
    "a/../../../up",
    "C:\\up",
];

/// Titles, phases, factors, baselines and names of studies that look like paths: all files are written below --out.
#[test]
fn names_in_files_lead_nowhere() {
    for up in UP {
        let dir = tempfile::tempdir().unwrap();
        let work = dir.path().join("deep/inner");
        fs::create_dir_all(&work).unwrap();
        let quoted = up.replace('\\', "\\\\");
        let car = fs::read_to_string(concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/vehicles/rover_216_cvt.toml"
        ))
        .unwrap();
        let car = car.replace("Rover 216, 1.6 L, pushing-belt CVT", &quoted);
        fs::write(work.join("car.toml"), car).unwrap();
        fs::write(
            work.join("minute.csv"),
            CYCLE.replace("town", up).replace("road", "../road"),
        )
        .unwrap();
        let plan = PLAN.replace(
            "title = \"t\"",
            &format!("title = \"{quoted}\"\nquestion = \"{quoted}\"\nvehicle = \"car.toml\""),
        );
        let plan = plan.replace(
            "key = \"engine",
            &format!("name = \"{quoted}\"\nsource = \"{quoted}\"\nkey = \"engine"),
        );
        fs::write(work.join("plan.toml"), plan).unwrap();
        fs::write(
            work.join("cover.toml"),
            format!("title = \"{quoted}\"\nauthor = \"{quoted}\"\n"),
        )
        .unwrap();
        let before = tree(dir.path());
        for line in [
            "run --vehicle car.toml --cycle minute.csv --sensitivity never --quiet --format both --out out/run",
            "study plan.toml --quiet --format both --out out/study",
            "study export out/study --quiet --out out/runs.parquet",
            "report out/run --cover cover.toml --quiet --out out/report.html",
            "report out/study --quiet --out out/study.html",
            "losses --vehicle car.toml --quiet --out out/losses",
        ] {
            let output = super::program(&work, &super::words(line)).output().unwrap();
            // A name may be refused, but not followed.
            assert!(
                [Some(0), Some(2)].contains(&output.status.code()),
                "{line} with {up}: {}",
                stderr(&output)
            );
        }
        let out = Path::new("deep/inner/out");
        let new: Vec<_> = tree(dir.path())
            .into_keys()
            .filter(|path| !before.contains_key(path) && !path.starts_with(out))
            .collect();
        assert!(new.is_empty(), "{up}: {new:?}");
        assert!(!Path::new("/tmp/cvtcycle_up").exists());
        assert!(work.join("out/run/summary.json").is_file(), "{up}");
    }
}

/// Names of vehicle files become names of outputs: invalid ones are refused, others stay plain names.
#[test]
fn names_of_vehicle_files_become_plain_names() {
    let car = concat!(env!("CARGO_MANIFEST_DIR"), "/vehicles/rover_216_5mt.toml");
    for (name, code) in [
        ("a b.toml", 0),
        ("ü.toml", 0),
        ("a:b.toml", 2),
        ("a\\b.toml", 2),
        ("'quoted'.toml", 0),
        ("...toml", 0),
        ("-.toml", 0),
    ] {
        let dir = folder();
        fs::copy(car, dir.path().join(name)).unwrap();
        let word = format!("./{name}");
        let words = "run --cycle minute.csv --baseline none --sensitivity never --quiet --out o";
        let list = words.split(' ').chain(["--vehicle", &word]);
        let output = Command::new(bin())
            .current_dir(dir.path())
            .args(list)
            .output()
            .unwrap();
        assert_eq!(
            output.status.code(),
            Some(code),
            "{name}: {}",
            stderr(&output)
        );
        let outside: Vec<_> = tree(dir.path())
            .into_keys()
            .filter(|path| path.components().count() == 1)
            .collect();
        assert_eq!(outside.len(), 5, "{name}: {outside:?}");
        assert_eq!(dir.path().join("o").exists(), code == 0, "{name}");
    }
}
