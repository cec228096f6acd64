//! `optimum`: text, files, the line as a vehicle, and refused options.

use super::*;

const QUICK: [&str; 8] = [
    "optimum", "--cycle", "ece15", "--grid", "49", "--dt", "0.25", "--start",
];

/// Truth: `run` with the written vehicle file burns the printed fuel, and no drive is below the bound.
#[test]
fn the_line_is_a_vehicle_file_with_the_printed_fuel() {
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
    let burnt = driven(dir.path(), "best/rover_216_cvt_line.toml", "80");
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
    assert_eq!(
        names,
        ["map", "torque_following", "slip_limited", "free", "map"]
    );
    assert_eq!(bounds[4]["launch"], "idle");
    for bound in bounds {
        let number = |key: &str| bound[key].as_f64();
        let least = number("bound_l_per_100km").unwrap();
        for key in ["own_l_per_100km", "line_l_per_100km", "driven_l_per_100km"] {
            assert!(
                number(key).is_none_or(|litres| litres >= least),
                "{key} {bound}"
            );
        }
        assert!(number("gap_percent").unwrap() < 0.5);
    }
    // The note appears if a law burns less than a free clamp, at lower safety.
    let least = |k: usize| bounds[k]["bound_l_per_100km"].as_f64().unwrap();
    assert_eq!(
        text.contains("`slip limited` clamps with a safety factor down to"),
        least(2) < least(3)
    );
    // Torque following with a factor of 1.3 is one of the free clamps where its slip is within their limit: else it may be below by what the grid
    // leaves. A launch at idle burns less than one by LC-1.
    let grid = bounds[3]["tolerance_l_per_100km"].as_f64().unwrap();
    assert!(least(3) <= least(1) + grid, "{bounds:?}");
    assert!(least(4) < least(0), "{bounds:?}");
    for part in ["idle launch", "launch law", "s below the least speed"] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    let path = file("path.csv");
    assert!(path.starts_with("time_s,speed_kmh,wheel_power_w,belt_ratio,engine_speed_rpm,"));
    assert_eq!(file("least_speed.csv").lines().count(), 6);
    assert_eq!(file("bound.csv").lines().count(), 6);
}

/// Fuel of a vehicle file on ECE15 with the start of a test, L/100 km.
fn driven(dir: &Path, vehicle: &str, start: &str) -> f64 {
    let run = [
        "run",
        "--cycle",
        "ece15",
        "--dt",
        "0.25",
        "--start",
        start,
        "--baseline",
        "none",
        "--price",
        "never",
        "--json",
        "--vehicle",
        vehicle,
    ];
    let run: Value = serde_json::from_str(&stdout(&run_in(dir, &run))).unwrap();
    run["runs"][0]["fuel_l_per_100km"].as_f64().unwrap()
}

/// Truth: `run` with nothing but the written file, which contains the changes of `--set` and inherits from a file by a relative path that may be
/// moved; from the warm start of `run`.
#[test]
fn the_written_car_burns_the_printed_fuel() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    fs::create_dir_all(at("all/cars")).unwrap();
    let car =
        "[vehicle]\ntitle = \"mine\"\nlike = \"rover_216_cvt\"\n[road_load]\nmass_kg = 1200\n";
    fs::write(at("all/cars/mine.toml"), car).unwrap();
    let words = [
        &QUICK[..],
        &[
            "warm",
            "--own-clamp",
            "--prove",
            "none",
            "--out",
            "all/best",
        ],
        &["--vehicle", "all/cars/mine.toml"],
        &["--set", "transmission.cvt.pump.displacement_cc_rev*=1.3"],
        &["--set", "transmission.cvt.ratio.up_per_s=0.7"],
    ]
    .concat();
    let output = run_in(dir.path(), &words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let file = fs::read_to_string(at("all/best/mine_line.toml")).unwrap();
    assert!(file.contains("like = \"../cars/mine.toml\""), "{file}");
    assert!(!file.contains(&*dir.path().to_string_lossy()), "{file}");
    let summary = fs::read_to_string(at("all/best/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let said = summary["line"]["l_per_100km"].as_f64().unwrap();
    assert_eq!(summary["line"]["again"], Value::Array(Vec::new()));
    fs::rename(at("all"), at("moved")).unwrap();
    let burnt = driven(dir.path(), "moved/best/mine_line.toml", "warm");
    assert!((burnt / said - 1.0).abs() < 1e-12, "{burnt} {said}");
    let own = driven(dir.path(), "moved/cars/mine.toml", "warm");
    assert!((own / said - 1.0).abs() > 0.01, "{own} {said}");
    let message = stderr(&run_in(dir.path(), &["report", "moved/best"]));
    assert!(message.contains("`cvtcycle optimum`"), "{message}");
}

/// A car with a torque converter and start-stop has a bound and a line file. Columns apply to a file of `--prove` too.
#[test]
fn a_converter_car_has_its_bound() {
    let dir = tempfile::tempdir().unwrap();
    let trace = "Clock,Pace\n0,0\n20,40\n60,40\n80,0\n90,0\n";
    fs::write(dir.path().join("own.csv"), trace).unwrap();
    let words = [
        &QUICK[..],
        &[
            "60",
            "--own-clamp",
            "--vehicle",
            "civic_20_cvt",
            "--out",
            "o",
        ],
        &["--set", "engine.start_stop.min_run_s=10"],
        &[
            "--columns",
            "time=Clock:s,speed=Pace:km/h",
            "--prove",
            "own.csv",
        ],
    ]
    .concat();
    let output = run_in(dir.path(), &words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let summary = fs::read_to_string(dir.path().join("o/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let said = summary["line"]["l_per_100km"].as_f64().unwrap();
    let burnt = driven(dir.path(), "o/civic_20_cvt_line.toml", "60");
    assert!((burnt / said - 1.0).abs() < 1e-12, "{burnt} {said}");
    assert_eq!(summary["line"]["elsewhere"][0]["cycle"], "own");
    assert!(summary["lock_floor"]["least_rpm"].as_f64() > Some(900.0));
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
fn an_infeasible_limit_is_named_with_its_place() {
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

/// Two infeasible limits are named, each with its own place. With a warm start the line begins at the temperatures of the unchanged car.
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
