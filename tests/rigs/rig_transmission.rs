//! Transmission rig of thesis chapters 4 and 5: properties by construction, printed values (`val_`), the command.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests say what they found"
)]

use std::path::Path;

use crate::common::{RPM, car};
use crate::titles::title_of_file;
use assert_cmd::Command;
use cvtcycle::model::rig::{Bench, BenchPoint};
use serde_json::Value;

const CAR: &str = "rover_216_cvt";

// ---- The command

fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_cvtcycle"));
    command.env_remove("NO_COLOR");
    command
}

fn run(arguments: &[&str]) -> (i32, String, String) {
    let output = command()
        .args(["rig", "transmission"])
        .args(arguments)
        .output()
        .unwrap();
    (
        output.status.code().unwrap(),
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

#[test]
fn the_command_prints_every_test() {
    let (code, out, err) = run(&[]);
    assert_eq!((code, err.as_str()), (0, ""));
    for words in [
        "8.5 to 13",
        "9 to 13",
        "Its parts at 2500 rpm",
        "under load",
        "Strip-down",
        "interaction",
        "Transients",
        "Second box",
    ] {
        assert!(out.contains(words), "{words} in\n{out}");
    }
    assert!(out.lines().all(|line| line.chars().count() <= 100), "{out}");
    let (code, out, _) = run(&["--test", "second_box", "--ratio", "high"]);
    assert!(
        code == 0
            && out.contains("Second box")
            && !out.contains("Transients")
            && !out.contains("2.417"),
        "{out}"
    );
    assert_eq!(
        run(&["--quiet", "--test", "steady"]),
        (0, String::new(), String::new())
    );
}

#[test]
fn json_is_one_object_with_the_requested_points() {
    let (code, out, err) = run(&[
        "--json",
        "--ratio",
        "low,1",
        "--speed",
        "1000..3000:1000",
        "--temp",
        "-10,25",
        "--torque",
        "0,50",
    ]);
    assert_eq!((code, err.as_str()), (0, ""));
    let all: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(all["steady"]["points"].as_array().unwrap().len(), 2 * 3 * 2);
    assert_eq!(
        all["loaded"]["points"].as_array().unwrap().len(),
        2 * 3 * 2 * 2
    );
    assert_eq!(
        all["strip_down"]["points"].as_array().unwrap().len(),
        2 * 3 * 2
    );
    assert_eq!(all["transient"].as_array().unwrap().len(), 2);
    assert!(all["strip_down"]["largest_remainder_nm"].as_f64().unwrap() < 0.1);
    let point = &all["steady"]["points"][0];
    assert_eq!(
        (
            point["input_speed_rpm"].as_f64(),
            point["oil_degc"].as_f64()
        ),
        (Some(1000.0), Some(-10.0))
    );
    // Truth: the library.
    let set = BenchPoint {
        ratio: 2.417,
        input_rad_s: 1000.0 * RPM,
        sump_k: 263.15,
        ..BenchPoint::default()
    };
    let library = Bench::new(&car(CAR, &[])).solve(&set).total_nm();
    assert!(
        (point["torque_loss_nm"].as_f64().unwrap() - library).abs() < 1e-6,
        "{point} {library}"
    );
}

#[test]
fn overrides_reach_rig_oil_and_vehicle() {
    let total = |sets: &[&str]| {
        let sets: Vec<&str> = sets.iter().flat_map(|set| ["--set", set]).collect();
        let (code, out, err) = run(&[
            &[
                "--json", "--test", "steady", "--ratio", "high", "--speed", "2500", "--temp", "50",
            ],
            &sets[..],
        ]
        .concat());
        assert_eq!(code, 0, "{err}");
        serde_json::from_str::<Value>(&out).unwrap()["steady"]["points"][0]["torque_loss_nm"]
            .as_f64()
            .unwrap()
    };
    let plain = total(&[]);
    for set in [
        "rig.ratio.high=0.7",
        "lubricant.kv40_mm2_s=60",
        "transmission.cvt.pump.displacement_cc_rev=12",
        "rig.load.throttle_percent=50",
    ] {
        assert!((total(&[set]) - plain).abs() > 0.01, "{set}");
    }
}

#[test]
fn everything_wrong_is_reported_at_once_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let (code, stdout, err) = run(&[
        "--vehicle",
        "rover_216_5mt",
        "--test",
        "alll",
        "--ratio",
        "lo",
        "--speed",
        "9,2000",
        "--temp",
        "200",
        "--torque",
        "x",
        "--set",
        "rig.cooler.flow_l_min=0",
        "--set",
        "rig.coolr.flow=3",
        "--formulation",
        "smoth",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!((code, stdout.as_str()), (2, ""));
    for words in [
        "has a manual gearbox",
        "cvtcycle losses --vehicle rover_216_5mt",
        "--test: `alll`",
        "--speed: `9` is out of range",
        "--temp: `200`",
        "--torque: `x`",
        "rig.cooler.flow_l_min",
        "rig.coolr",
        "--formulation: `smoth`",
    ] {
        assert!(err.contains(words), "{words} in\n{err}");
    }
    assert!(!out.exists());
}

/// A belt that does not fit at a ratio is bad input, instead of an empty table.
#[test]
fn a_belt_that_does_not_fit_is_refused() {
    let mut arguments = vec!["--test", "steady", "--ratio", "1,3"];
    for set in [
        "transmission.cvt.belt.length_m=1.5",
        "transmission.cvt.ratio.low=1.1",
        "transmission.cvt.ratio.high=0.9",
    ] {
        arguments.extend(["--set", set]);
    }
    let (code, out, err) = run(&arguments);
    assert!(
        code == 2 && out.is_empty() && err.contains("the belt cannot reach this ratio"),
        "{code} {out} {err}"
    );
}

/// A point outside the models' validity is computed and flagged, in the tables and in the files.
/// Thesis 5.3.1 prints the range of 25 to 95 degC, so colder points are not compared with it.
#[test]
fn val_printed_totals_are_compared_at_their_own_temperatures() {
    let here = |temps: &str| {
        let (code, table, _) = run(&["--test", "steady", "--ratio", "low", "--temp", temps]);
        assert_eq!(code, 0);
        let line = table
            .lines()
            .find(|line| line.starts_with("low"))
            .unwrap()
            .to_owned();
        line.split("  ")
            .filter(|cell| !cell.is_empty())
            .last()
            .unwrap()
            .trim()
            .to_owned()
    };
    assert_eq!(here("-10,25,95"), here("25,95"));
}

#[test]
fn points_outside_validity_are_flagged() {
    let arguments = [
        "--ratio", "0.35", "--speed", "2000", "--temp", "50", "--test",
    ];
    for (test, rows) in [
        ("steady", "steady"),
        ("strip_down", "strip_down"),
        ("second_box", "second_box"),
    ] {
        let (code, out, err) = run(&[&arguments[..], &[test]].concat());
        assert!(code == 0 && out.contains("outside_validity"), "{out} {err}");
        let (_, out, _) = run(&[&arguments[..], &[test, "--json"]].concat());
        let all: Value = serde_json::from_str(&out).unwrap();
        assert_eq!(
            all[rows]["points"][0]["flags"][0], "outside_validity",
            "{out}"
        );
    }
    assert!(!run(&["--test", "steady"]).1.contains("outside_validity"));
}

/// Runs with a failed check.
#[test]
fn an_open_loop_is_exit_code_one() {
    let words = [
        "--test",
        "transient",
        "--ratio",
        "low",
        "--set",
        "rig.cooler.coolant_degc=19",
        "--set",
        "rig.transient.end_degc=60",
    ];
    let (code, out, err) = run(&words);
    assert!(
        code == 1 && err.contains("check failed: the transient at low stops on its way"),
        "{code} {out} {err}"
    );
    let (code, out, err) = run(&[&["--quiet"], &words[..]].concat());
    assert!(
        code == 1 && out.is_empty() && err.contains("check failed"),
        "{code} {out} {err}"
    );
}

fn lines(path: &Path) -> usize {
    std::fs::read_to_string(path).unwrap().lines().count()
}

#[test]
fn files_are_sound_and_named_after_their_tests() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("rig");
    let (code, stdout, err) = run(&["--out", out.to_str().unwrap()]);
    assert_eq!(code, 0, "{err}");
    assert!(stdout.contains("Files written"));
    for (name, rows) in [
        ("steady.csv", 92),
        ("loaded.csv", 460),
        ("strip_down.csv", 92),
        ("second_box.csv", 92),
    ] {
        assert_eq!(lines(&out.join(name)), rows + 1, "{name}");
    }
    assert!(lines(&out.join("transient.csv")) > 1000);
    let kinds = [
        "steady_loss",
        "steady_pressure",
        "loaded_loss",
        "strip_down",
        "contributions",
        "components",
        "transient",
        "second_box",
    ];
    for (kind, ratio) in kinds
        .iter()
        .flat_map(|kind| [(kind, "low"), (kind, "high")])
    {
        let svg = std::fs::read_to_string(out.join(format!("{kind}_{ratio}.svg"))).unwrap();
        let document = roxmltree::Document::parse(&svg).unwrap();
        assert!(
            document
                .descendants()
                .filter(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "path")))
                .count()
                > 1,
            "{kind}"
        );
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{kind}");
    }
    titles_are_those_of_the_tables(&out);
    // Again requires --force.
    assert_eq!(
        run(&["--test", "steady", "--out", out.to_str().unwrap()]).0,
        2
    );
    let (code, _, err) = run(&[
        "--test",
        "steady",
        "--force",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert!(
        code == 0 && err.contains("files of an earlier run were not replaced"),
        "{err}"
    );
}

/// Column of a file, for the rows at low ratio.
fn low(out: &Path, file: &str, column: &str) -> Vec<f64> {
    let mut reader = csv::Reader::from_path(out.join(file)).unwrap();
    let heads = reader.headers().unwrap().clone();
    let place = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let (ratio, own) = (place("ratio"), place(column));
    let rows = reader.records().map(Result::unwrap);
    let rows = rows.filter(|row| row[ratio].parse::<f64>().unwrap() > 1.0);
    rows.map(|row| row[own].parse().unwrap()).collect()
}

/// Compares the numbers in titles with the files of the run, and those of the thesis with the rows of `validate`.
fn titles_are_those_of_the_tables(out: &Path) {
    let ends = |values: &[f64]| {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        (least, values.iter().copied().fold(0.0, f64::max))
    };
    let (least, most) = ends(&low(out, "steady.csv", "torque_loss_nm"));
    let rows = cvtcycle::validate::with_ids(&["5.04a", "5.04b"]);
    let printed: Vec<&str> = rows.iter().map(|row| row.printed_text.as_str()).collect();
    assert_eq!(printed, ["8.5 Nm", "13 Nm"]);
    let said = format!(
        "Without load the box loses {least:.1} to {most:.1} N m in low; the thesis prints 8.5 to 13"
    );
    assert!(
        title_of_file(out, "steady_loss_low.svg").starts_with(&said),
        "{said}"
    );
    let (least, most) = ends(&low(out, "steady.csv", "secondary_pressure_bar"));
    let said = format!("Secondary pressure is {least:.1} to {most:.1} bar in low");
    assert!(
        title_of_file(out, "steady_pressure_low.svg").starts_with(&said),
        "{said}"
    );
    let [found, own] = ["final_drive_corrected_nm", "final_drive_true_nm"]
        .map(|column| low(out, "strip_down.csv", column));
    let more = found
        .iter()
        .zip(&own)
        .map(|(found, own)| found - own)
        .sum::<f64>();
    let said = format!("{:.2} N m too much in low", more / found.len() as f64);
    assert!(
        title_of_file(out, "components_low.svg").contains(&said),
        "{said}"
    );
    for (name, marks) in [
        ("steady_loss_low.svg", 1),
        ("components_low.svg", 4),
        ("transient_low.svg", 3),
        ("transient_high.svg", 2),
    ] {
        let svg = std::fs::read_to_string(out.join(name)).unwrap();
        assert_eq!(svg.matches("class=\"printed\"").count(), marks, "{name}");
    }
}

/// A custom ratio and a single speed still give pictures.
#[test]
fn unusual_plans_give_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("one");
    let (code, _, err) = run(&[
        "--ratio",
        "1.25",
        "--speed",
        "2000",
        "--temp",
        "60",
        "--torque",
        "-5",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(code, 0, "{err}");
    let svg = std::fs::read_to_string(out.join("steady_loss_1_25.svg")).unwrap();
    assert!(svg.contains("2000") && !svg.contains("NaN"), "{svg}");
}

#[test]
fn the_rigs_values_can_be_looked_up() {
    let text = |arguments: &[&str]| {
        String::from_utf8(command().args(arguments).output().unwrap().stdout).unwrap()
    };
    assert!(text(&["explain", "rig.pressure.second_box"]).contains("0.925"));
    assert!(text(&["explain", "RT-3"]).contains("thesis 5.4"));
    let shown = text(&["show", "rig_transmission", "--status", "assumed"]);
    assert!(
        shown.contains("final_drive_removed") && !shown.contains("second_box"),
        "{shown}"
    );
    assert!(
        text(&["rig", "transmission", "--help"])
            .contains("cvtcycle rig transmission --test strip_down")
    );
}
