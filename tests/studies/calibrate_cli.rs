//! `cvtcycle calibrate` from plan to files, with the synthetic example and the examples of docs/calibration.md.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use cvtcycle::calibrate::plan;
use serde_json::Value;

const PAGE: &str = include_str!("../../docs/calibration.md");

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/calibration_example/plan.toml")
}

fn cvtcycle() -> Command {
    let mut command = Command::cargo_bin("cvtcycle").unwrap();
    command
        .arg("calibrate")
        .env("SOURCE_DATE_EPOCH", "1709164800"); // 29 February 2024
    command
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Truth: the values in docs/calibration_example/make, which made the data.
#[test]
fn val_the_example_finds_the_values_that_made_its_data_and_writes_every_file() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("fitted");
    let run = cvtcycle()
        .arg(example())
        .args(["--json", "--out"])
        .arg(&out)
        .assert()
        .success();
    let printed: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    let read = |name: &str| fs::read_to_string(out.join(name)).unwrap();
    assert_eq!(
        printed,
        serde_json::from_str::<Value>(&read("calibration.json")).unwrap()
    );
    let word = printed["run"].as_str().unwrap();
    assert!(word.len() == 16 && word.bytes().all(|byte| byte.is_ascii_hexdigit()));
    for (p, truth) in printed["parameters"]
        .as_array()
        .unwrap()
        .iter()
        .zip([7.5, 4.0, 1.5])
    {
        let (value, error) = (number(&p["value"]), number(&p["standard_error"]));
        assert!(
            (value - truth).abs() < 3.0 * error && error < 0.25 * truth,
            "{p}: {truth}"
        );
    }
    assert_eq!(printed["folds"].as_array().unwrap().len(), 3);
    assert_eq!(read("plan.toml"), fs::read_to_string(example()).unwrap());
    for name in [
        "measured_computed.svg",
        "residuals.svg",
        "parameters.svg",
        "correlation.svg",
        "residuals.csv",
        "correlation.csv",
    ] {
        assert!(!read(name).is_empty(), "{name}");
    }
    assert_eq!(read("parameters.csv").lines().count(), 4);
    let fitted = read("rover_216_cvt_fitted.toml");
    assert!(fitted.contains("on 2024-02-29; standard error"), "{fitted}");
    let mut check = Command::cargo_bin("cvtcycle").unwrap();
    check
        .arg("check")
        .arg(out.join("rover_216_cvt_fitted.toml"))
        .assert()
        .success();
    // Repeating gives the same bytes. Without --force nothing is changed.
    let again = cvtcycle()
        .arg(example())
        .arg("--quiet")
        .arg("--out")
        .arg(&out)
        .assert()
        .code(2);
    assert!(String::from_utf8_lossy(&again.get_output().stderr).contains("--force"));
    let bytes = read("calibration.json");
    cvtcycle()
        .arg(example())
        .args(["--quiet", "--threads", "1", "--force", "--out"])
        .arg(&out)
        .assert()
        .success()
        .stdout("");
    assert_eq!(read("calibration.json"), bytes);
}

#[test]
fn without_folds_nothing_is_predicted_and_starts_and_seed_are_obeyed() {
    let run = cvtcycle()
        .arg(example())
        .args(["--json", "--no-folds", "--starts", "2"])
        .assert()
        .success();
    let printed: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    assert!(printed["folds"].as_array().unwrap().is_empty());
    assert!(
        printed["residuals"]
            .as_array()
            .unwrap()
            .iter()
            .all(|r| r["left_out"].is_null())
    );
    assert_eq!(printed["starts"].as_array().unwrap().len(), 2);
    let other = cvtcycle()
        .arg(example())
        .args(["--json", "--no-folds", "--starts", "2", "--seed", "7"])
        .assert()
        .success();
    let other: Value = serde_json::from_slice(&other.get_output().stdout).unwrap();
    assert_eq!(printed["starts"][0]["from"], other["starts"][0]["from"]);
    assert_ne!(printed["starts"][1]["from"], other["starts"][1]["from"]);
    assert_ne!(printed["run"], other["run"]);
}

/// The fitted files contain the overrides of the plan, and files in the folder of the vehicle are found from anywhere: the fitted car has the same losses on
/// the bench as the plan's own car with overrides and fitted values.
#[test]
fn fitted_files_hold_what_the_plan_sets() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    let example = example();
    fs::copy(example.with_file_name("spin_loss.csv"), at("spin_loss.csv")).unwrap();
    let map = "[transmission.cvt.maps]\nclutch_drag = \"drag.csv\"\n";
    let car = fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("vehicles/rover_216_cvt.toml"),
    )
    .unwrap();
    fs::write(at("car.toml"), car + "\n" + map).unwrap();
    fs::write(
        at("drag.csv"),
        "input_speed_rpm,torque_loss_nm\n0,0.2\n7000,1.2\n",
    )
    .unwrap();
    fs::write(
        at("shaft.csv"),
        "input_speed_rpm,torque_loss_nm\n0,0.3\n7000,0.8\n",
    )
    .unwrap();
    let sets = [
        "road_load.mass_kg=1210",
        "lubricant.density15_kg_m3=870",
        "transmission.cvt.maps.input_shaft=shaft.csv",
    ];
    let head = format!("vehicle = \"car.toml\"\nset = {sets:?}");
    let plan = fs::read_to_string(example)
        .unwrap()
        .replace("vehicle = \"rover_216_cvt\"", &head);
    fs::write(at("plan.toml"), plan).unwrap();
    let out = at("elsewhere/fitted");
    fs::create_dir(at("elsewhere")).unwrap();
    let run = cvtcycle()
        .arg(at("plan.toml"))
        .args(["--json", "--no-folds", "--starts", "1", "--out"])
        .arg(&out)
        .assert()
        // The data are of the car without these changes: its model does not fit them, which the exit code says.
        .code(1);
    let printed: Value = serde_json::from_slice(&run.get_output().stdout).unwrap();
    let fitted = fs::read_to_string(out.join("car_fitted.toml")).unwrap();
    assert!(
        fitted.contains("value = 1210") && fitted.contains("set by"),
        "{fitted}"
    );
    let losses = |vehicle: PathBuf, sets: &[String]| {
        let mut command = Command::cargo_bin("cvtcycle").unwrap();
        command
            .current_dir(at("elsewhere"))
            .args([
                "losses",
                "--json",
                "--speed",
                "1000,3000",
                "--temp",
                "-10,80",
                "--vehicle",
            ])
            .arg(vehicle);
        for set in sets {
            command.args(["--set", set]);
        }
        let answer: Value =
            serde_json::from_slice(&command.assert().success().get_output().stdout).unwrap();
        answer["points"].clone()
    };
    let parameters = printed["parameters"].as_array().unwrap().iter();
    let values = parameters.map(|p| format!("{}={}", p["name"].as_str().unwrap(), p["value"]));
    let own = losses(
        at("car.toml"),
        &sets
            .map(str::to_owned)
            .into_iter()
            .chain(values)
            .collect::<Vec<_>>(),
    );
    let again = losses(out.join("car_fitted.toml"), &[]);
    assert_eq!(own.as_array().unwrap().len(), 4);
    for (own, again) in own
        .as_array()
        .unwrap()
        .iter()
        .zip(again.as_array().unwrap())
    {
        for (name, value) in own
            .as_object()
            .unwrap()
            .iter()
            .filter(|(_, value)| value.is_number())
        {
            let (own, again) = (number(value), number(&again[name]));
            assert!(
                (own - again).abs() <= 1e-5 * own.abs(),
                "{name}: {own}, fitted {again}"
            );
        }
    }
}

#[test]
fn a_parameter_that_moves_nothing_ends_with_code_1_and_everything_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let folder = example();
    fs::copy(
        folder.with_file_name("spin_loss.csv"),
        dir.path().join("spin_loss.csv"),
    )
    .unwrap();
    // The bench does not use the mass of the car.
    let dead = "\n[[parameter]]\nkey = \"road_load.mass_kg\"\nlow = 1000\nhigh = 1300\n";
    fs::write(
        dir.path().join("plan.toml"),
        fs::read_to_string(folder).unwrap() + dead,
    )
    .unwrap();
    let out = dir.path().join("out");
    let run = cvtcycle()
        .arg(dir.path().join("plan.toml"))
        .args(["--no-folds", "--starts", "1", "--out"])
        .arg(&out)
        .assert()
        .code(1);
    let (stdout, stderr) = (
        String::from_utf8_lossy(&run.get_output().stdout),
        String::from_utf8_lossy(&run.get_output().stderr),
    );
    assert!(
        stderr.contains("no observation depends on road_load.mass_kg"),
        "{stderr}"
    );
    assert!(
        stdout.contains("road_load.mass_kg moves no datum")
            && stdout.contains("A fit is no validation"),
        "{stdout}"
    );
    assert!(
        out.join("calibration.json").is_file() && out.join("rover_216_cvt_fitted.toml").is_file()
    );
}

#[test]
fn bad_input_is_reported_at_once_and_leaves_no_directory() {
    let dir = tempfile::tempdir().unwrap();
    let plan = dir.path().join("plan.toml");
    fs::write(
        &plan,
        "[calibration]\nstarts = 0\n[[parameter]]\nkey = \"x\"\nlow = 2\nhigh = 1\n",
    )
    .unwrap();
    let out = dir.path().join("out");
    let run = cvtcycle()
        .arg(&plan)
        .arg("--out")
        .arg(&out)
        .assert()
        .code(2)
        .stdout("");
    let stderr = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    for word in [
        "starts",
        "no dotted key",
        "`low` is not below `high`",
        "there are no data",
    ] {
        assert!(stderr.contains(word), "{word}: {stderr}");
    }
    assert!(!out.exists());
    let unknown = cvtcycle().arg("rover_216_warmup").assert().code(2);
    assert!(String::from_utf8_lossy(&unknown.get_output().stderr).contains("rover_216_warm_up"));
}

/// Fenced blocks of the page in a language.
fn blocks(language: &str) -> Vec<&'static str> {
    let fence = format!("```{language}\n");
    PAGE.split(fence.as_str())
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .collect()
}

#[test]
fn the_plan_and_the_files_of_the_page_can_be_read() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    let (plans, files) = (blocks("toml"), blocks("csv"));
    assert_eq!((plans.len(), files.len()), (1, 3));
    for (name, text) in ["spin_loss.csv", "warm_up.csv", "fuel.csv"]
        .into_iter()
        .zip(files)
    {
        fs::write(at(name), text).unwrap();
    }
    fs::copy(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("vehicles/rover_216_cvt.toml"),
        at("my_car.toml"),
    )
    .unwrap();
    fs::write(at("plan.toml"), plans[0]).unwrap();
    let plan = plan::load(at("plan.toml").to_str().unwrap()).unwrap();
    assert_eq!(
        (
            plan.parameters.len(),
            plan.groups.len(),
            plan.observations.len()
        ),
        (2, 3, 2 + 4 + 3)
    );
    assert_eq!(
        plan.folds.len(),
        1 + 2,
        "one temperature, one trace, one set of totals"
    );
}
