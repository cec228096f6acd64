//! `calibrate` on logs: what they tell of a car.

use super::log::{fuel, path, run_of, summary_of};
use super::{one_line, run, run_in, stdout};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Output;

const CAR: &str = "civic_20_cvt";

/// Values of a car that differ from those of its file.
const TRUTH: [(&str, f64); 12] = [
    ("engine.idle.hot_rpm", 820.0),
    ("engine.idle.cold_rpm", 1150.0),
    ("engine.fuel.cut_above_rpm", 1250.0),
    ("engine.fuel.fuel_back_rpm", 1150.0),
    ("transmission.cvt.ratio.gentle_rpm", 1400.0),
    ("transmission.cvt.ratio.overrun_rpm", 1350.0),
    ("thermal.engine.block_kj_k", 80.0),
    ("thermal.radiator.thermostat_from_degc", 76.0),
    ("thermal.radiator.thermostat_to_degc", 88.0),
    ("transmission.cvt.ratio.high", 0.45),
    (
        "transmission.cvt.launch.torque_converter.lockup.from_kmh",
        20.0,
    ),
    (
        "transmission.cvt.launch.torque_converter.lockup.until_kmh",
        14.0,
    ),
];

/// Arguments that set them.
fn truth() -> Vec<String> {
    let set = TRUTH
        .iter()
        .map(|(key, value)| format!("--set={key}={value}"));
    set.collect()
}

/// Runs a command that succeeds.
fn done(dir: &Path, words: &[&str]) -> Output {
    let output = run_in(dir, words);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// Drives a car without others and without prices of its losses, with files in `out`.
fn drive_alone(dir: &Path, car: &str, cycle: &str, out: &str, set: &[String]) {
    let words = format!(
        "run --vehicle {car} --baseline none --cycle {cycle} --price never --sensitivity never --quiet --out {out}"
    );
    let set = set.iter().map(String::as_str);
    done(dir, &words.split(' ').chain(set).collect::<Vec<_>>());
}

/// The log that a car of the program writes of itself on a cycle.
fn own_log(dir: &Path, cycle: &str, set: &[String]) {
    drive_alone(dir, CAR, cycle, cycle, set);
    let trace = dir.join(cycle).join(format!("trace_{CAR}.csv"));
    fs::rename(trace, dir.join(format!("{cycle}.csv"))).unwrap();
}

/// Median slip of the belt at a demand in per cent of the rated power, a share: of the traces that are the logs, warm and off the ends of the ratio.
fn slip_of_belt(dir: &Path) -> impl Fn(f64) -> f64 {
    const RATED_W: f64 = 118e3;
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for cycle in ["ftp75", "us06", "hwfet"] {
        let mut reader = csv::Reader::from_path(dir.join(format!("{cycle}.csv"))).unwrap();
        let head = reader.headers().unwrap().clone();
        for row in reader.records() {
            let row = row.unwrap();
            let cell = |name: &str| &row[head.iter().position(|own| own == name).unwrap()];
            let number = |name: &str| cell(name).parse::<f64>().unwrap_or(f64::NAN);
            let is_warm = number("coolant_degc") >= 70.0 && number("speed_kmh") > 30.0;
            let share = 100.0 * number("wheel_power_w") / RATED_W;
            if is_warm && share > 0.0 && !cell("flags").contains("ratio_limit") {
                rows.push((share, number("slip_percent") / 100.0));
            }
        }
    }
    move |x| {
        let near = rows.iter().filter(|(share, _)| (share - x).abs() < 1.5);
        let mut slips: Vec<f64> = near.map(|(_, slip)| *slip).collect();
        slips.sort_by(f64::total_cmp);
        slips[slips.len() / 2]
    }
}

/// Truth: the car that wrote the logs, of which the estimate knows the file with other values in twelve keys.
#[test]
fn a_car_is_found_again_in_its_own_logs() {
    let dir = tempfile::tempdir().unwrap();
    let set = truth();
    for cycle in ["ftp75", "us06", "hwfet"] {
        own_log(dir.path(), cycle, &set);
    }
    let words = [
        "calibrate",
        "ftp75.csv",
        "us06.csv",
        "hwfet.csv",
        "--vehicle",
        CAR,
        "--json",
        "--out",
        "found",
    ];
    let output = done(dir.path(), &words);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let value = |key: &str| {
        let all = found["values"].as_array().unwrap();
        let own = all.iter().find(|own| own["key"] == key);
        own.unwrap_or_else(|| panic!("{key} in {all:?}")).clone()
    };
    // Slip of belt and tyres is in a ratio; an event lies within a second of a log at 1 Hz.
    for (key, within) in [
        ("engine.idle.hot_rpm", 1.0),
        ("engine.idle.cold_rpm", 15.0),
        ("engine.fuel.cut_above_rpm", 110.0),
        ("engine.fuel.fuel_back_rpm", 110.0),
        ("thermal.engine.block_kj_k", 4.0),
        ("thermal.radiator.thermostat_from_degc", 1.0),
        ("thermal.radiator.thermostat_to_degc", 1.0),
        ("transmission.cvt.ratio.high", 0.005),
        (
            "transmission.cvt.launch.torque_converter.lockup.from_kmh",
            4.0,
        ),
        (
            "transmission.cvt.launch.torque_converter.lockup.until_kmh",
            2.0,
        ),
    ] {
        let (_, truth) = TRUTH.iter().find(|(own, _)| *own == key).unwrap();
        let own = value(key)["value"].as_f64().unwrap();
        assert!((own - truth).abs() <= within, "{key}: {own} for {truth}");
    }
    // RC-1 and RC-2 of that car, at a demand in per cent: the control sees the pulleys, and the log the belt's slip as well.
    let slip = slip_of_belt(dir.path());
    for line in found["lines"].as_array().unwrap() {
        let overrun = line["label"] == "CL-13";
        for point in line["points"].as_array().unwrap() {
            let [x, rpm] = ["x", "rpm"].map(|key| point[key].as_f64().unwrap());
            let truth = match overrun {
                true => 1350.0,
                false => {
                    let target = 1350.0 + 50.0 * (x / 15.0).min(1.0) + 40.0 * (x - 15.0).max(0.0);
                    target * (1.0 + slip(x))
                }
            };
            // At high speed the ratio is at its end; high power goes by the full-load line (RC-3).
            let ends = x > if overrun { 70.0 } else { 22.0 };
            assert!(
                ends || (rpm / truth - 1.0).abs() < 0.01,
                "{x}: {rpm} for {truth}"
            );
        }
    }
    // With all of them the car burns what the one that wrote the logs does, on a cycle that no log has.
    let own = dir.path().join("found/car.toml");
    let of = |words: &[&str]| {
        fuel(&summary_of(
            "udds",
            &[&["--baseline", "none"], words].concat(),
        ))
    };
    let truth: Vec<&str> = ["--vehicle", CAR]
        .into_iter()
        .chain(set.iter().map(String::as_str))
        .collect();
    let (truth, before) = (of(&truth), of(&["--vehicle", CAR]));
    let made = of(&["--vehicle", own.to_str().unwrap()]);
    assert!((made / truth - 1.0).abs() < 0.005, "{made} for {truth}");
    assert!((before / truth - 1.0).abs() > 0.05, "{before} for {truth}");
    // Each range is a factor of a study, and in the words of the value.
    let ranges = fs::read_to_string(dir.path().join("found/ranges.toml")).unwrap();
    assert!(
        ranges.contains("key = \"thermal.engine.block_kj_k\"\n"),
        "{ranges}"
    );
    let text = fs::read_to_string(own).unwrap();
    assert!(
        text.contains("status = \"fitted\", source = \"ftp75.csv, us06.csv, hwfet.csv, "),
        "{text}"
    );
}

/// Truth: the log has no such channel, or the car in it has gears.
#[test]
fn a_log_says_what_it_cannot_tell() {
    let text = one_line(&stdout(&run(&["calibrate", &path("clean.csv")])));
    for part in [
        "idle, ratios, lock-up, fuel cut and lines: there is no channel of the engine's speed",
        "operating line and heat capacity: these need mass, road load and rated power of a car, and none is named",
        "torque of the engine, losses of the box",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let dir = tempfile::tempdir().unwrap();
    drive_alone(dir.path(), "civic_20_6mt", "ftp75", "manual", &[]);
    let log = dir.path().join("manual/trace_civic_20_6mt.csv");
    let text = one_line(&stdout(&run(&["calibrate", log.to_str().unwrap()])));
    assert!(
        text.contains("the gearbox has steps, and ratio, lock-up and lines are not those of a CVT"),
        "{text}"
    );
    for (words, part) in [
        (
            &["calibrate", "rover_216_warm_up", "--vehicle", CAR][..],
            "this is an option of logs",
        ),
        (
            &["calibrate", "rover_216_warm_up", "rover_216_transmission"][..],
            "a plan is given alone",
        ),
        (
            &["calibrate", "drive.csv", "--seed", "3"][..],
            "this is an option of plans",
        ),
    ] {
        let output = run(words);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// Truth: the first values of the log's channels.
#[test]
fn a_drive_starts_with_the_temperatures_of_its_log() {
    let dir = tempfile::tempdir().unwrap();
    let clean = fs::read_to_string(path("clean.csv")).unwrap();
    let rows = clean.lines().skip(1).map(|row| format!("{row},81,61\n"));
    let file = dir.path().join("log.csv");
    let text = format!(
        "time_s,speed_kmh,coolant [degC],transmission oil [degC]\n{}",
        rows.collect::<String>()
    );
    fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap();
    let alone = |more: &[&str]| summary_of(file, &[&["--baseline", "none"], more].concat());
    let own = alone(&[]);
    assert_eq!(own["start"]["coolant"], 81.0, "{}", own["start"]);
    assert_eq!(own["start"]["sump"], 61.0);
    let named = alone(&["--start", "coolant=81,sump=61"]);
    assert!((fuel(&own) - fuel(&named)).abs() < 1e-12);
    let soak = alone(&["--start", "soak"]);
    assert!(
        fuel(&soak) > 1.1 * fuel(&own),
        "{} {}",
        fuel(&soak),
        fuel(&own)
    );
    assert_eq!(soak["start"], "soak");
    let text = one_line(&stdout(&run(&[
        "run",
        "--cycle",
        file,
        "--baseline",
        "none",
        "--price",
        "never",
    ])));
    let words = "The drive starts as the log does: coolant (engine oil) at 81 degC, sump (metal, belt) at 61 degC";
    assert!(text.contains(words), "{text}");
    // A shipped cycle has no log.
    let output = run_of("udds", &["--baseline", "none"]);
    let plain: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(plain["start"], "soak");
}

/// Truth: the log of the car itself, so that both lines are one.
#[test]
fn a_report_draws_the_log_next_to_the_computed_car() {
    let dir = tempfile::tempdir().unwrap();
    own_log(dir.path(), "udds", &[]);
    drive_alone(dir.path(), CAR, "udds.csv", "again", &[]);
    assert!(dir.path().join(format!("again/log_{CAR}.svg")).exists());
    let summary = fs::read_to_string(dir.path().join("again/summary.json")).unwrap();
    let summary: Value = serde_json::from_str(&summary).unwrap();
    let measured = summary["recording"]["measured"].as_array().unwrap();
    let fuel = measured
        .iter()
        .find(|own| own["quantity"] == "fuel")
        .unwrap();
    let series = fuel["series"].as_array().unwrap();
    assert!((200..=300).contains(&series.len()), "{}", series.len());
    done(
        dir.path(),
        &["report", "again", "--stored", "--out", "page.html"],
    );
    let page = fs::read_to_string(dir.path().join("page.html")).unwrap();
    for part in ["The log next to the computed car", "Transmission sump"] {
        assert!(page.contains(part), "{part}");
    }
}
