//! Studies of the program: the same bytes under any disturbance, nothing lost, correct exit codes.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    clippy::too_many_lines,
    reason = "helpers and tables of tests; a test that is skipped says so"
)]

mod answers;
mod interrupted;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::Duration;

use crate::tree::{parts, same, tree};
use serde_json::Value;

/// A cycle of one minute, for short runs.
const CYCLE: &str = "time_s,speed_kmh,phase\n0,0,town\n4,0,town\n14,32,town\n24,32,town\n34,0,town\n36,0,road\n50,70,road\n56,70,road\n60,60,road\n";
/// A factor of the CVT only, and one of all cars.
const FACTORS: &str = r#"
[[factor]]
key = "transmission.cvt.pump.displacement_cc_rev"
name = "pump"
status = "assumed"
distribution.uniform = { low = 7, high = 11 }

[[factor]]
key = "engine.electrical_w"
name = "current"
cars = "all"
acts = "scale"
status = "assumed"
distribution.triangular = { low = 0.5, mode = 1.0, high = 2.0 }
"#;
/// 5000 Monte Carlo points of two cars: 32 parts.
static PLAN: LazyLock<String> = LazyLock::new(|| {
    format!(
        r#"
[study]
title = "kill me"
vehicle = "rover_216_cvt"
baselines = ["rover_216_5mt"]
cycle = "minute.csv"
ambient_degc = -10

[study.design.monte_carlo]
samples = 5000
seed = 7
{FACTORS}
[[factor]]
key = "lubricant"
values = ["dexron_ii", "cvtf_ezl799_class"]
"#
    )
});

fn folder(plan: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("minute.csv"), CYCLE).unwrap();
    fs::write(dir.path().join("plan.toml"), plan).unwrap();
    dir
}

fn program(dir: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin("cvtcycle"));
    command.current_dir(dir).args(words);
    command
}

fn run(dir: &Path, words: &[&str]) -> Output {
    program(dir, words).output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn ends(dir: &Path, words: &[&str], code: i32) -> Output {
    let output = run(dir, words);
    assert_eq!(
        output.status.code(),
        Some(code),
        "{words:?}: {}",
        stderr(&output)
    );
    output
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Columns of the exported runs without units, and the rows.
fn exported(dir: &Path) -> (Vec<String>, Vec<csv::StringRecord>) {
    let words = ["study", "export", "out", "--out", "runs.csv"];
    ends(dir, &words, 0);
    let mut reader = csv::Reader::from_path(dir.join("runs.csv")).unwrap();
    let heads = reader.headers().unwrap().iter();
    let heads = heads.map(|head| head.split(" [").next().unwrap().to_owned());
    let heads = heads.collect();
    (heads, reader.records().map(Result::unwrap).collect())
}

/// Failed runs are rows with a reason, the study continues, the code is 1, and statistics exclude them.
#[test]
fn failed_runs_are_rows() {
    let plan = r#"
[study]
title = "too much"
vehicle = "rover_216_cvt"
baselines = ["rover_216_5mt"]
cycle = "minute.csv"
[study.design.grid]
[[factor]]
key = "road_load.payload_kg"
cars = "all"
values = [0, 400, 1900]
[[factor]]
key = "transmission.cvt.variator.stop_from_ratio"
values = [2.0, 2.3]
[[factor]]
key = "transmission.cvt.variator.stop_to_ratio"
values = [2.2, 2.417]
"#;
    let dir = folder(plan);
    let output = ends(
        dir.path(),
        &["study", "plan.toml", "--out", "out", "--json"],
        1,
    );
    let answer = json(&output);
    // 2.3 to 2.2 is a ramp that runs backward: one combination in four, at each of three loads.
    assert_eq!(answer["runs"]["not_run"], 3);
    assert!(
        answer["runs"]["failed"].as_u64().unwrap() >= 1,
        "a car with 1.9 t of load cannot follow: {}",
        answer["runs"]
    );
    let total: u64 = ["ok", "failed", "not_run"]
        .iter()
        .map(|k| answer["runs"][k].as_u64().unwrap())
        .sum();
    assert_eq!(total, 24);
    assert!(
        stderr(&output).contains("missed_trace"),
        "{}",
        stderr(&output)
    );
    let failed = answer["runs"]["failed"].as_u64().unwrap();
    let words = String::from_utf8(ends(dir.path(), &["study", "show", "out"], 1).stdout).unwrap();
    let message = format!(
        "{} runs are left out ({failed} failed a check, 3 could not be run)",
        failed + 3
    );
    assert!(words.contains(&message), "{message} is not in {words}");
    let (heads, records) = exported(dir.path());
    let at = |name: &str| {
        let place = heads.iter().position(|head| head == name);
        place.unwrap_or_else(|| panic!("{name} in {heads:?}"))
    };
    assert_eq!(records.len(), 24);
    for record in &records {
        let bad = record[at("role")] == *"subject"
            && record[at("transmission.cvt.variator.stop_from_ratio")] == *"2.3";
        let bad = bad && record[at("transmission.cvt.variator.stop_to_ratio")] == *"2.2";
        assert_eq!(&record[at("status")] == "not_run", bad, "{record:?}");
        assert_eq!(
            record[at("status")] == *"ok",
            record[at("reason")].is_empty()
        );
        assert_eq!(
            record[at("fuel_l_per_100km")].is_empty(),
            bad,
            "numbers of runs that ran are kept"
        );
        assert_eq!(
            record[at("transmission.cvt.variator.stop_to_ratio")].is_empty(),
            record[at("role")] == *"baseline"
        );
    }
}

/// An impossible run is a failed one, and excluded from means.
#[test]
fn impossible_runs_are_left_out() {
    let plan = |gains: &str| {
        format!(
            "[study]\ntitle = \"t\"\nvehicle = \"rover_216_cvt\"\nbaselines = []\ncycle = \"ece15\"\n[study.design.grid]\n\
             [[factor]]\nkey = \"transmission.cvt.launch.friction_clutch.gain_nm_per_rpm2\"\nvalues = [{gains}]\n"
        )
    };
    let good = "1.9e-5, 2.0e-5";
    let dir = folder(&plan(good));
    let alone = json(&ends(dir.path(), &["study", "plan.toml", "--json"], 0));
    fs::write(dir.path().join("plan.toml"), plan(&format!("1e-7, {good}"))).unwrap();
    let output = ends(dir.path(), &["study", "plan.toml", "--json"], 1);
    let answer = json(&output);
    assert_eq!(
        (&answer["runs"]["ok"], &answer["runs"]["failed"]),
        (&2.into(), &1.into())
    );
    assert!(stderr(&output).contains("overspeed"), "{}", stderr(&output));
    let range = |answer: &Value| answer["outputs"][0]["range"].clone();
    let mut expected = range(&alone);
    assert_eq!(
        (&expected["n"], &expected["missing"]),
        (&2.into(), &0.into())
    );
    expected["missing"] = 1.into();
    assert_eq!(range(&answer), expected);
}

/// A run of a study equals `run` under the same conditions bit by bit.
#[test]
fn rows_equal_the_numbers_of_run() {
    let plan = r#"
[study]
title = "one"
ambient_degc = 5
start = "warm"
set_all = ["engine.electrical_w=250"]
[study.design.grid]
[[factor]]
key = "transmission.cvt.belt.band_offset_mm"
values = [2, 3.5]
[[factor]]
key = "transmission.cvt.clamp"
values = ["torque_following", "map"]
[[factor]]
key = "lubricant"
values = ["dexron_iii"]
"#;
    let dir = folder(plan);
    ends(
        dir.path(),
        &["study", "plan.toml", "--out", "out", "--quiet"],
        0,
    );
    let (heads, records) = exported(dir.path());
    for (point, (offset, clamp)) in [
        ("2", "torque_following"),
        ("2", "map"),
        ("3.5", "torque_following"),
        ("3.5", "map"),
    ]
    .iter()
    .enumerate()
    {
        let words = [
            "run",
            "--ambient",
            "5",
            "--start",
            "warm",
            "--set-all",
            "engine.electrical_w=250",
            "--lubricant",
            "dexron_iii",
            "--json",
            "--set",
        ];
        let (offset, clamp) = (
            format!("transmission.cvt.belt.band_offset_mm={offset}"),
            format!("transmission.cvt.clamp={clamp}"),
        );
        let words: Vec<&str> = words
            .into_iter()
            .chain([offset.as_str(), "--set", clamp.as_str()])
            .collect();
        let summary = json(&ends(dir.path(), &words, 0));
        // The study has no car before its changes.
        let runs = summary["runs"].as_array().unwrap().iter();
        let runs = runs.filter(|run| run["role"] != "unchanged");
        for (k, run) in runs.enumerate() {
            let record = &records[2 * point + k];
            let cell = |name: &str| {
                record[heads.iter().position(|h| h == name).unwrap()]
                    .parse::<f64>()
                    .unwrap()
            };
            for (column, value) in [
                ("fuel_l_per_100km", &run["fuel_l_per_100km"]),
                (
                    "fuel_eudc_l_per_100km",
                    &run["phases"][1]["fuel_l_per_100km"],
                ),
                ("loss_accessories_kj", &run["loss_kj"]["accessories"]),
                ("end_engine_oil_degc", &run["end_degc"]["engine_oil"]),
                ("clutch_slipping_s", &run["flags_s"]["clutch_slipping"]),
            ] {
                assert_eq!(
                    cell(column).to_bits(),
                    value.as_f64().unwrap().to_bits(),
                    "{column} of {}",
                    run["vehicle"]
                );
            }
            if k > 0 {
                assert_eq!(
                    cell("subject_excess_percent").to_bits(),
                    summary["comparison"][k]["fuel_percent"]
                        .as_f64()
                        .unwrap()
                        .to_bits()
                );
            }
        }
    }
}

/// All problems of a plan are reported at once, with their lines, before the study starts.
#[test]
fn a_bad_plan_is_refused_with_all_its_problems() {
    let plan = r#"
[study]
title = "bad"
cycle = "minute.csv"
baselines = ["rover_216_5mt"]
[study.design.grid]
[[factor]]
key = "transmission.cvt.pump.displacement_cc_revs"
values = [7]
[[factor]]
key = "transmission.cvt.belt.band_offset_mm"
values = [2, 2000]
[[factor]]
key = "transmission.cvt.belt.mass_kg"
cars = "all"
values = [1]
"#;
    let dir = folder(plan);
    let message = stderr(&ends(
        dir.path(),
        &["study", "plan.toml", "--out", "out"],
        2,
    ));
    for words in [
        "displacement_cc_rev",
        "plan.toml:8",
        "2000",
        "plan.toml:12",
        "rover_216_5mt",
        "plan.toml:14",
    ] {
        assert!(message.contains(words), "{words} in\n{message}");
    }
    assert!(!dir.path().join("out").exists());
    let large = PLAN.replace("samples = 5000", "samples = 60000");
    let dir = folder(&large);
    let message = stderr(&ends(
        dir.path(),
        &["study", "plan.toml", "--out", "out"],
        2,
    ));
    assert!(
        message.contains("120000 runs") && message.contains("--yes"),
        "{message}"
    );
    assert!(!dir.path().join("out").exists());
}

/// Truth: `run` of the same cars. A study says of the same pair no other range of measured cars: it took a like car for any other one.
#[test]
fn a_pair_has_the_range_of_measured_cars_that_a_run_gives_it() {
    let dir = folder(&PLAN);
    let run = json(&ends(dir.path(), &["run", "--ambient", "-10", "--json"], 0));
    let fleet = &run["comparison"][0]["fleet"];
    let cars = fleet["cars"].as_u64().unwrap();
    let words = [
        "study",
        "uncertainty_rover",
        "--samples",
        "8",
        "--out",
        "out",
    ];
    let text = String::from_utf8(ends(dir.path(), &words, 0).stdout).unwrap();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let said = format!("by the error of the model on {cars} measured cars");
    assert!(text.contains(&said), "{said} in {text}");
    let stored = std::fs::read(dir.path().join("out/study.json")).unwrap();
    let stored: Value = serde_json::from_slice(&stored).unwrap();
    assert_eq!(stored["cars"][1]["like_for_like"], true);
    // The shown study reads it again.
    let shown = String::from_utf8(ends(dir.path(), &["study", "show", "out"], 0).stdout).unwrap();
    let shown = shown.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(shown.contains(&said), "{said} in {shown}");
}

/// Matrix of the thesis: 20 runs with the numbers of `run`, with pictures.
#[test]
fn the_ambient_matrix() {
    let dir = folder(&PLAN);
    let matrix = json(&ends(
        dir.path(),
        &["study", "ambient", "--json", "--out", "out"],
        0,
    ));
    assert_eq!(matrix["runs"]["ok"], 20);
    let fuel = &matrix["matrix"]["fuel"][0];
    for (start, word) in ["soak", "warm"].iter().enumerate() {
        for (ambient, degc) in ["-10", "0", "10", "25", "40"]
            .iter()
            .enumerate()
            .skip(3 * start)
        {
            let run = json(&ends(
                dir.path(),
                &["run", "--ambient", degc, "--start", word, "--json"],
                0,
            ));
            for car in 0..2 {
                assert_eq!(
                    fuel["l_per_100km"][car][start][ambient],
                    run["runs"][car]["fuel_l_per_100km"]
                );
            }
            assert_eq!(
                fuel["excess_percent"][0][start][ambient],
                run["comparison"][0]["fuel_percent"]
            );
        }
    }
    for name in [
        "ambient_fuel.svg",
        "ambient_penalty.svg",
        "warm_up_soak.svg",
        "warm_up_warm.svg",
    ] {
        let svg = fs::read_to_string(dir.path().join("out").join(name)).unwrap();
        roxmltree::Document::parse(&svg).unwrap();
        assert!(!svg.contains("NaN"), "{name}");
    }
    let message = stderr(&ends(
        dir.path(),
        &["study", "ambient", "--ambient", "-10,80", "--start", "cold"],
        2,
    ));
    assert!(
        message.contains("--ambient")
            && message.contains("80")
            && message.contains("--start")
            && message.contains("cold"),
        "{message}"
    );
}
