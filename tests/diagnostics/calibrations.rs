//! Bad plans of calibrations, bad data files, and valid plans whose fit fails.

use cvtcycle::calibrate;
use cvtcycle::config::Problems;
use cvtcycle::config::setup::{self, Options};

use super::kinds::{made_file, rendered};

/// Reads a data file, named by a valid plan in the same folder.
pub fn data(kind: &str, case: &str) -> Option<Problems> {
    let (folder, name) = case.rsplit_once('/').unwrap();
    let way = kind.trim_start_matches("calibration_");
    let about = if way == "points" {
        "sd = 0.1"
    } else {
        "source = \"cold\""
    };
    let plan = format!(
        "[calibration]\nvehicle = \"rover_216_cvt\"\n[sources.cold]\nsource = \"run\"\n[[parameter]]\n\
         key = \"transmission.cvt.pump.displacement_cc_rev\"\nlow = 5\nhigh = 20\n[[data]]\nfrom = \"a test\"\n{way} = \"{name}\"\n{about}\n"
    );
    calibrate::plan::read(&format!("{folder}/plan.toml"), &plan).err()
}

/// Runs a valid plan with a failing fit: exit code 1, and all files are written with the best point so far.
pub fn ran(case: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let command = ["calibrate", "--quiet", "--threads", "1", case, "--out"];
    let output = assert_cmd::Command::cargo_bin("cvtcycle")
        .unwrap()
        .args(command)
        .arg(folder.path())
        .output()
        .unwrap();
    let shown = String::from_utf8(output.stderr).unwrap();
    if case.contains("no_answer") {
        assert_eq!(output.status.code(), Some(2), "{case}: {shown}");
        assert_eq!(
            std::fs::read_dir(folder.path()).unwrap().count(),
            0,
            "{case}"
        );
        return shown;
    }
    assert_eq!(output.status.code(), Some(1), "{case}: {shown}");
    let text = std::fs::read_to_string(folder.path().join("calibration.json")).unwrap();
    let outcome: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        outcome["converged"],
        !shown.contains("did not converge"),
        "{case}"
    );
    let best = outcome["parameters"][0]["value"].as_f64().unwrap();
    let key = outcome["parameters"][0]["name"].as_str().unwrap();
    let fitted = folder.path().join("rover_216_cvt_fitted.toml");
    let setup = setup::load(fitted.to_str().unwrap(), &Options::default()).unwrap();
    let written: f64 = setup
        .keys
        .iter()
        .find(|info| info.key == key)
        .unwrap()
        .value
        .parse()
        .unwrap();
    assert!(
        (written - best).abs() <= 1e-6 * best.abs(),
        "{case}: {written} in place of {best}"
    );
    assert!(
        outcome["cost_after"].as_f64().unwrap() <= outcome["cost_before"].as_f64().unwrap(),
        "{case}"
    );
    shown
}

/// Files that are not text, or too large to be kept: name and message.
pub fn made(kind: &str) -> Vec<(String, String)> {
    if kind == "calibration" {
        return plans();
    }
    let files: [(&str, &[u8]); 5] = [
        ("empty.csv", b"\xef\xbb\xbf\r\n\n"),
        ("utf16.csv", b"\xff\xfer\0a\0"),
        ("binary.csv", b"PK\x03\x04\n\0\x9f"),
        ("latin1.csv", b"time_s,comment\n1,\xe9\n"),
        ("old_line_ends.csv", b"time_s,total_nm\r1,2\r"),
    ];
    let open = |path: &str, _: &[u8]| rendered(data(kind, path));
    let mut all: Vec<(String, String)> = files
        .into_iter()
        .map(|(name, bytes)| made_file(name, bytes, open))
        .collect();
    if kind == "calibration_points" {
        let text = format!(
            "ratio,speed_rpm,temp_degc,total_nm\n{}",
            "1,2000,80,5\n".repeat(125_001)
        );
        all.push(made_file("too_many_values.csv", text.as_bytes(), open));
    }
    if kind == "calibration_trace" {
        let text: String = (0..200).rev().map(|k| format!("{k},20,0.5\n")).collect();
        let text = format!("time_s,transmission_sump_degc,sd_transmission_sump_degc\n{text}");
        all.push(made_file("upside_down.csv", text.as_bytes(), open));
    }
    all
}

fn plans() -> Vec<(String, String)> {
    let named = |name: &str, word: &str| {
        (
            format!("made_{name}"),
            rendered(calibrate::open(word).err()),
        )
    };
    let mut all = vec![
        named("no_such_name.toml", "rover_216_transmision"),
        named(
            "no_such_file.toml",
            "tests/diagnostics/calibration/nowhere.toml",
        ),
    ];
    let binary: [(&str, &[u8]); 4] = [
        ("empty.toml", b""),
        ("utf16.toml", b"\xff\xfe[\0c\0"),
        ("binary.toml", b"PK\x03\x04\0\x9f"),
        ("latin1.toml", b"# \xe9\n"),
    ];
    let open = |path: &str, _: &[u8]| rendered(calibrate::open(path).err());
    all.extend(
        binary
            .into_iter()
            .map(|(name, bytes)| made_file(name, bytes, open)),
    );
    all
}
