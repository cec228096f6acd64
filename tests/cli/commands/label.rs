//! `label`: its drives, and the figures computed from them.
//!
//! Truth: each test driven by `run`. The sums of LB-1 are tested with the formulas.

use super::{json, refused, run, run_in, stdout};
use serde_json::Value;
use std::fs;

/// Truth: `run`, which fails a trace beyond its tolerance alone (TR-3): with 80 kW full load lacks torque in some rows of US06, and the car stays within
/// 2 mph of its trace; with 60 kW it does not.
#[test]
fn a_trace_within_its_tolerance_is_none_that_was_missed() {
    let dir = tempfile::tempdir().unwrap();
    for (power, code) in [("80kW", 0), ("60kW", 1)] {
        let words = [
            "new",
            "weak",
            "--force",
            "--mass",
            "1300",
            "--displacement",
            "1.4l",
            "--power",
            power,
            "--box",
            "box_cvt_converter",
        ];
        assert_eq!(run_in(dir.path(), &words).status.code(), Some(0));
        let words = [
            "run",
            "--vehicle",
            "weak.toml",
            "--baseline",
            "none",
            "--cycle",
            "us06",
            "--start",
            "warm",
            "--ambient",
            "24",
            "--price",
            "never",
            "--out",
            power,
            "--json",
        ];
        let output = run_in(dir.path(), &words);
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let missed_s = found["runs"][0]["trace_missed_s"].as_f64().unwrap();
        assert_eq!(missed_s > 0.0, code == 1, "{power}");
        let trace = fs::read_to_string(dir.path().join(power).join("trace_weak.csv")).unwrap();
        assert!(trace.contains("full_load"), "{power}");
        assert_eq!(output.status.code(), Some(code), "{power}");
        let output = run_in(dir.path(), &["label", "weak.toml", "--json"]);
        assert_eq!(output.status.code(), Some(code), "{power}");
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let missed = found["cars"][0]["missed_s"].as_array().unwrap();
        let us06 = missed.iter().find(|of| of[0] == "us06");
        assert_eq!(
            us06.map(|of| of[1].as_f64().unwrap()),
            (code == 1).then_some(missed_s)
        );
    }
}

/// Every test equals the run in its description, and both tables and notes are printed.
#[test]
fn tests_of_a_label_are_runs() {
    let label = json(&[
        "label",
        "civic_20_6mt",
        "--cold-w",
        "300",
        "--ac-w",
        "2000",
        "--json",
    ]);
    let tests = &label["cars"][0]["tests"];
    let driven = |words: &[&str]| {
        let car = [
            "run",
            "--vehicle",
            "civic_20_6mt",
            "--baseline",
            "none",
            "--price",
            "never",
        ];
        json(&[&car[..], words, &["--json"]].concat())["runs"][0].clone()
    };
    let same = |a: &Value, b: &Value, share: f64| {
        let (a, b) = (a.as_f64().unwrap(), share * b.as_f64().unwrap());
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    };
    // TE-3 by hand: 43.2 MJ/kg of 0.745 kg/L against 31.78 MJ/L.
    let near = |a: &Value, b: &Value| same(a, b, 0.4 + 0.6 * 43.2 * 0.745 / 31.78);
    let fuel = "fuel_l_per_100km";
    let ftp = driven(&["--cycle", "ftp75", "--ambient", "24"]);
    near(&tests["ftp75"], &ftp["weighted_fuel_l_per_100km"]);
    let cold = [
        "--cycle",
        "ftp75",
        "--ambient",
        "-6.7",
        "--set",
        "road_load.load_factor=1.1",
        "--set",
        "engine.electrical_w+=300",
    ];
    let cold = driven(&cold);
    for (bag, phase) in [0, 1, 3].into_iter().enumerate() {
        near(&tests["bags"][bag], &ftp["phases"][phase][fuel]);
        near(&tests["cold_bags"][bag], &cold["phases"][phase][fuel]);
    }
    let warm = |cycle, degc| driven(&["--cycle", cycle, "--ambient", degc, "--start", "warm"]);
    near(&tests["hwfet"], &warm("hwfet", "24")[fuel]);
    let us06 = warm("us06", "24");
    for part in us06["phases"].as_array().unwrap() {
        let place = usize::from(part["name"] == "highway");
        near(&tests["us06"][place], &part[fuel]);
    }
    let sc03 = [
        "--cycle",
        "sc03",
        "--ambient",
        "35",
        "--start",
        "warm",
        "--set",
        "engine.electrical_w+=2000",
    ];
    near(&tests["sc03"], &driven(&sc03)[fuel]);
    for (place, degc) in ["23", "14"].into_iter().enumerate() {
        let wltc = driven(&["--cycle", "wltc", "--ambient", degc]);
        same(
            &label["cars"][0]["wltp"][place]["co2_g_per_km"],
            &wltc["co2_g_per_km"],
            1.0,
        );
    }
    let text = stdout(&run(&["label", "civic_20_cvt", "civic_20_6mt"])).replace('\n', " ");
    for part in [
        "five cycles (LB-4), city",
        "CO2 at 14 over 23 degC",
        "without air conditioning",
        "without heating",
        "not for certification",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
}

#[test]
fn all_problems_of_a_label_at_once() {
    let message = refused(&[
        "label",
        "civic_20_cv",
        "rover_216_cvt",
        "--ac-w",
        "-1",
        "--cold-w",
        "x",
        "--set",
        "road_load.mass=1",
    ]);
    for part in ["civic_20_cvt", "--ac-w", "--cold-w", "road_load.mass_kg"] {
        assert!(message.contains(part), "{part}\n{message}");
    }
}
