//! `optimum`: its text, its files, the line as a vehicle, and what it refuses.

use super::*;

const QUICK: [&str; 8] = [
    "optimum", "--cycle", "ece15", "--grid", "49", "--dt", "0.25", "--start",
];

/// Truth: `run` with the vehicle file that `optimum` wrote burns what it says, and nothing driven is below the bound.
#[test]
fn the_line_is_a_vehicle_file_that_burns_what_is_said() {
    let dir = tempfile::tempdir().unwrap();
    let words = [&QUICK[..], &["80", "--out", "best", "--prove", "10-15"]].concat();
    let output = run_in(dir.path(), &words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in [
        "No controller of the ratio",
        "with any clamp",
        "Fuel by clamp law",
        "torque following",
        "Least fuel by least engine speed",
        "What the limits cost",
        "49 ratios",
        "Operating line",
        "The line on other cycles",
        "rover_216_cvt_line.toml",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    let file = |name: &str| fs::read_to_string(dir.path().join("best").join(name)).unwrap();
    let summary: Value = serde_json::from_str(&file("summary.json")).unwrap();
    let number = |path: &str| summary.pointer(path).and_then(Value::as_f64).unwrap();
    let said = number("/line/l_per_100km");
    let run = [
        "run",
        "--cycle",
        "ece15",
        "--dt",
        "0.25",
        "--start",
        "80",
        "--baseline",
        "none",
        "--price",
        "never",
        "--json",
        "--vehicle",
        "best/rover_216_cvt_line.toml",
    ];
    let run: Value = serde_json::from_str(&stdout(&run_in(dir.path(), &run))).unwrap();
    let burnt = run["runs"][0]["fuel_l_per_100km"].as_f64().unwrap();
    assert!((burnt / said - 1.0).abs() < 1e-12, "{burnt} {said}");
    let elsewhere = summary["line"]["elsewhere"].as_array().unwrap();
    assert_eq!(elsewhere.len(), 1, "{elsewhere:?}");
    assert_eq!(elsewhere[0]["cycle"], "jp_10_15_mode");
    assert!(elsewhere[0]["line_l_per_100km"].as_f64() > Some(3.0));
    let bounds = summary["bounds"].as_array().unwrap();
    let names: Vec<&str> = bounds
        .iter()
        .map(|b| b["clamp"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["map", "torque_following", "slip_limited", "free"]);
    for bound in bounds {
        let number = |key: &str| bound[key].as_f64();
        let least = number("least_l_per_100km").unwrap() - number("tolerance_l_per_100km").unwrap();
        for key in ["own_l_per_100km", "line_l_per_100km", "driven_l_per_100km"] {
            assert!(
                number(key).is_none_or(|litres| litres >= least),
                "{key} {bound}"
            );
        }
        assert!(number("gap_percent").unwrap() < 0.5);
    }
    // The note is there where a law does with less safety what a free clamp may not.
    let least = |k: usize, key: &str| bounds[k][key].as_f64().unwrap();
    let free = least(3, "least_l_per_100km") - least(3, "tolerance_l_per_100km");
    let below = least(2, "least_l_per_100km") < free;
    assert_eq!(
        text.contains("`slip limited` clamps with a safety factor below 1.3"),
        below
    );
    let path = file("path.csv");
    assert!(path.starts_with("time_s,speed_kmh,wheel_power_w,belt_ratio,engine_speed_rpm,"));
    assert_eq!(file("least_speed.csv").lines().count(), 6);
    assert_eq!(file("bound.csv").lines().count(), 5);
}

#[test]
fn all_problems_of_the_limits_at_once() {
    let message = refused(&[
        "optimum",
        "--least-rpm",
        "700",
        "--reserve",
        "95",
        "--grid",
        "50",
        "--safety",
        "0",
        "--max-slip",
        "x",
    ]);
    for part in [
        "--least-rpm",
        "--reserve",
        "--grid",
        "--safety",
        "--max-slip",
        "four times a number, and one",
    ] {
        assert!(message.contains(part), "{part} is not in\n{message}");
    }
    let message = refused(&["optimum", "--vehicle", "rover_216_5mt"]);
    assert!(message.contains("manual"), "{message}");
}

#[test]
fn a_limit_that_cannot_be_held_is_named_with_its_place() {
    let words = [
        &QUICK[..],
        &["80", "--reserve", "85", "--own-clamp", "--no-line"],
    ]
    .concat();
    let message = refused(&words);
    assert!(
        message.contains("no ratio holds this limit at"),
        "{message}"
    );
    assert!(
        message.contains("km/h") && message.contains("at most"),
        "{message}"
    );
}

/// Two limits that cannot be held, each with its own place; a warm start, whose line begins where the car as it is begins.
#[test]
fn both_limits_are_named_and_a_warm_start_is_proven() {
    let words = [
        "--own-clamp",
        "--no-line",
        "--reserve",
        "85",
        "--least-rpm",
        "5500",
    ];
    let message = refused(&[&QUICK[..], &["80"], &words].concat());
    for part in ["--reserve", "--least-rpm", "at most", "2 problems"] {
        assert!(message.contains(part), "{part} is not in\n{message}");
    }
    let output = run(&[&QUICK[..], &["warm", "--own-clamp", "--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let summary: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(summary["line"]["proven"], true);
}
