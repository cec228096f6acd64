//! Variator rig: the thesis's breakpoints, slips and signs, the offset of the reading, limits, files, refused options.
#![allow(clippy::unwrap_used, reason = "tests")]

use std::collections::HashMap;
use std::path::Path;
use std::process::Output;

use crate::titles::{assert_number, title_of_file, written};
use serde_json::Value;

fn run(words: &[&str]) -> Output {
    crate::run(&["rig", "variator"], words)
}

fn good(words: &[&str]) -> String {
    crate::printed(&["rig", "variator"], words)
}

/// Hand calculation for 6.3.1: 100 turns of a belt of 0.6486 m at 30.419 mm and 2000 rpm last 64.86 / 6.371 = 10.18 s, in which the primary
/// turns 339.35 times; with 60 pulses a turn one pulse is 0.00491 %.
#[test]
fn val_counting_resolution() {
    let json: Value = serde_json::from_str(&good(&["--json", "--pressure", "30"])).unwrap();
    let curves = json["curves"].as_array().unwrap();
    assert_eq!(curves.len(), 2);
    let x = |k: usize, name: &str| curves[k][name].as_f64().unwrap();
    assert!(
        (x(0, "gate_s") - 10.18).abs() < 0.005
            && (x(0, "gate_primary_turns") - 339.35).abs() < 0.05
    );
    assert!((x(0, "slip_per_primary_pulse_percent") - 0.004_911).abs() < 1e-5);
    assert!(curves[0]["gate_segments"].is_null());
    // High: 10 s at 70.15 mm and 1500 rpm are 110.19 m, 75 475 segments of 1.46 mm, less the primary's slip at idle.
    assert!(
        (x(1, "gate_s") - 10.0).abs() < 1e-12
            && (75_000.0..75_475.0).contains(&x(1, "gate_segments")),
        "{}",
        x(1, "gate_segments")
    );
    assert!(
        (x(1, "input_speed_rpm") - 1500.0).abs() < 1e-9,
        "the secondary's limit of 3000 rpm"
    );
    assert!((x(0, "input_speed_rpm") - 2000.0).abs() < 1e-9);
}

/// CSV and JSON have equal points; files, pictures with breakpoints, and the table.
#[test]
fn csv_json_and_files_have_equal_points() {
    let words = [
        "--ratio",
        "low",
        "--torque",
        "0..200:50",
        "--pressure",
        "20,30",
    ];
    let (_, json) = crate::same_points(&["rig", "variator"], &words);
    assert_eq!(json["count"].as_u64(), Some(10));
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("rig");
    let table = good(&["--out", out.to_str().unwrap()]);
    for word in [
        "ratio 2.417, 2000 rpm, belt 85",
        "ratio 0.5, 1500 rpm",
        "78.8",
        "100 turns of the belt",
        "Files written in",
    ] {
        assert!(table.contains(word), "{word}: {table}");
    }
    for (name, breakpoints, lines) in [
        ("radii.svg", 0, 8),
        ("slip.svg", 5, 10),
        ("slip_speed.svg", 10, 20),
    ] {
        let text = std::fs::read_to_string(out.join(name)).unwrap();
        let svg = roxmltree::Document::parse(&text).unwrap();
        let count = |class: &str| {
            svg.descendants()
                .filter(|n| n.attribute("class") == Some(class))
                .count()
        };
        assert_eq!(
            count("mark"),
            breakpoints,
            "{name}: a breakpoint for each pressure in low"
        );
        assert_eq!(count("series"), lines, "{name}");
    }
    titles_are_those_of_the_files(&out);
    assert_eq!(
        std::fs::read_to_string(out.join("curves.csv"))
            .unwrap()
            .lines()
            .count(),
        11
    );
    assert_eq!(good(&["--quiet", "--ratio", "low"]), "");
}

/// Rows of a file by column name.
fn rows(file: &Path) -> Vec<HashMap<String, String>> {
    let mut reader = csv::Reader::from_path(file).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

/// Compares the numbers in titles with the files of the run: breakpoints and slip speeds of the curves in low, and the radius at the last point up
/// to 5 % slip.
fn titles_are_those_of_the_files(out: &Path) {
    let curves = rows(&out.join("curves.csv"));
    let x = |row: &HashMap<String, String>, name: &str| row[name].parse::<f64>().unwrap();
    let low: Vec<_> = curves
        .iter()
        .filter(|row| x(row, "belt_ratio") > 1.0)
        .collect();
    let title = title_of_file(out, "slip.svg");
    let ends = [low[0], low[low.len() - 1]];
    let wanted = ends.map(|row| [x(row, "breakpoint_nm"), x(row, "secondary_pressure_bar")]);
    for (said, wanted) in written(&title).iter().zip(wanted.concat()) {
        assert_number(said, wanted, &title);
    }
    let title = title_of_file(out, "slip_speed.svg");
    let at_30 = low
        .iter()
        .find(|row| row["secondary_pressure_bar"] == "30")
        .unwrap();
    let said = written(&title);
    assert_eq!(said[..2], ["30", "3"], "{title}");
    // The curve is found to a hundredth of its step, the title is between two points: 0.005 m/s is its last digit.
    for (said, name) in said[2..].iter().zip([
        "three_percent_primary_slip_m_s",
        "three_percent_secondary_slip_m_s",
    ]) {
        assert_number(said, x(at_30, name), &title);
    }
    let middle = low[low.len() / 2];
    let points = rows(&out.join("points.csv"));
    let own = points.iter().filter(|row| {
        let same = ["belt_ratio", "secondary_pressure_bar"]
            .iter()
            .all(|name| row[*name] == middle[*name]);
        same && x(row, "slip_percent").abs() <= 5.0 && !row["flags"].contains("gross_slip")
    });
    let last = own
        .max_by(|a, b| x(a, "output_torque_nm").total_cmp(&x(b, "output_torque_nm")))
        .unwrap();
    let change =
        100.0 * (x(last, "primary_pulse_radius_mm") / x(last, "primary_zeroed_radius_mm") - 1.0);
    let title = title_of_file(out, "radii.svg");
    for (said, wanted) in written(&title)
        .iter()
        .zip([x(last, "output_torque_nm"), change])
    {
        assert_number(said, wanted, &title);
    }
}

#[test]
fn bad_options_are_reported_at_once() {
    let refused = |words: &[&str]| {
        let output = run(words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(output.stdout.is_empty());
        String::from_utf8(output.stderr).unwrap()
    };
    let all = refused(&[
        "--ratio",
        "hi",
        "--pressure",
        "15..x",
        "--speed",
        "0",
        "--temp",
        "999",
        "--torque",
        "a",
        "--pulses",
        "0",
    ]);
    for word in [
        "low, high, or",
        "15..x",
        "--speed",
        "--temp",
        "--torque",
        "--pulses",
        "6 problems",
    ] {
        assert!(all.contains(word), "{word}: {all}");
    }
    assert!(refused(&["--vehicle", "rover_216_5mt"]).contains("has a manual gearbox"));
    assert!(refused(&["--formulation", "chapter8"]).contains("chapter_8"));
    assert!(refused(&["--torque", "0..400:0.001"]).contains("at most 1000000 points"));
}
