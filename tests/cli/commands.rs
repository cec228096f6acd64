//! The real program in a directory of its own: exit codes, streams, files.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]
use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};

use assert_cmd::Command;
use serde_json::Value;

fn program() -> Command {
    let mut command = Command::cargo_bin("cvtcycle").unwrap();
    command.env_remove("NO_COLOR");
    command
}

fn run(words: &[&str]) -> Output {
    program().args(words).output().unwrap()
}

fn run_in(dir: &Path, words: &[&str]) -> Output {
    program().current_dir(dir).args(words).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The one JSON object on standard output of a command that ends well.
fn json(words: &[&str]) -> Value {
    let output = run(words);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{words:?}: {}",
        stderr(&output)
    );
    assert_eq!(stderr(&output), "", "{words:?}");
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(value.is_object(), "{words:?}");
    value
}

/// A command that must refuse its input: exit code 2, nothing on standard output.
fn refused(words: &[&str]) -> String {
    let output = run(words);
    assert_eq!(output.status.code(), Some(2), "{words:?}");
    assert_eq!(stdout(&output), "", "{words:?}");
    stderr(&output)
}

fn keys(value: &Value) -> Vec<&str> {
    value
        .as_object()
        .unwrap()
        .keys()
        .map(String::as_str)
        .collect()
}

#[test]
fn json_of_a_run_has_every_key_of_the_contract() {
    let summary = json(&["run", "--ambient", "-10", "--json"]);
    for key in [
        "schema",
        "program",
        "cycle",
        "ambient_degc",
        "start",
        "runs",
    ] {
        assert!(keys(&summary).contains(&key), "{key}");
    }
    assert_eq!(summary["schema"], 1);
    assert_eq!(
        summary["program"],
        concat!("cvtcycle ", env!("CARGO_PKG_VERSION"))
    );
    assert_eq!(summary["start"], "soak");
    assert_eq!(summary["ambient_degc"], -10.0);
    let run_keys = "vehicle role transmission distance_km duration_s fuel_l_per_100km co2_g_per_km phases wheel_work_positive_kj \
        wheel_work_negative_kj fuel_energy_kj loss_kj kinetic_kj standstill_fuel_g min_clamp_safety at_ratio_limit_s end_degc \
        ledger_error trace_missed_s outside_validity_s";
    let runs = summary["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 3);
    for run in runs {
        for key in run_keys.split_whitespace() {
            assert!(keys(run).contains(&key), "{key}");
        }
        assert_eq!(run["phases"][0]["name"], "ece15");
        assert_eq!(run["phases"][1]["name"], "eudc");
        assert_eq!(run["phases"].as_array().unwrap().len(), 2);
        for key in ["transmission_sump", "engine_oil", "coolant"] {
            assert!(run["end_degc"][key].is_number(), "{key}");
        }
        assert!(
            run["ledger_error"].as_f64().unwrap() < 1e-9
                && run["run_ledger_error"].as_f64().unwrap() < 1e-9
        );
    }
    let cvt = "launch_clutch pump input_shaft clutch_drag belt_band belt_film belt_slip belt_wedge belt_penetration final_drive \
        accessories brake";
    let manual = "launch_clutch gear_mesh bearing churning seal accessories brake";
    assert_eq!(
        keys(&runs[0]["loss_kj"]),
        cvt.split_whitespace().collect::<Vec<_>>()
    );
    assert_eq!(
        keys(&runs[1]["loss_kj"]),
        manual.split_whitespace().collect::<Vec<_>>()
    );
    assert_eq!(
        (&runs[0]["role"], &runs[1]["role"]),
        (&Value::from("subject"), &Value::from("baseline"))
    );
    assert_eq!(runs[1]["min_clamp_safety"], Value::Null);
    assert_eq!(runs[1]["at_ratio_limit_s"], Value::Null);
}

#[test]
fn numbers_of_the_summary_belong_together() {
    for formulation in ["smooth", "appendix_c", "chapter_8"] {
        // Whether the solve converges everywhere in a verification formulation is not asked here.
        let output = run(&[
            "run",
            "--json",
            "--ambient",
            "0",
            "--formulation",
            formulation,
        ]);
        let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
        for run in summary["runs"].as_array().unwrap() {
            let losses = run["loss_kj"].as_object().unwrap();
            let own = losses
                .iter()
                .filter(|(name, _)| !["accessories", "brake"].contains(&name.as_str()));
            let sum: f64 = own.filter_map(|(_, kj)| kj.as_f64()).sum();
            let ledger = run["ledger_kj"]["losses"].as_f64().unwrap();
            assert!(
                (sum / ledger - 1.0).abs() < 1e-9,
                "{formulation}: {sum} {ledger}"
            );
            let l = run["fuel_l"].as_f64().unwrap() / run["distance_km"].as_f64().unwrap() * 100.0;
            assert!((l / run["fuel_l_per_100km"].as_f64().unwrap() - 1.0).abs() < 1e-12);
            assert!((run["mpg_us"].as_f64().unwrap() * l - 235.215).abs() < 1e-9);
            assert!((run["mpg_uk"].as_f64().unwrap() * l - 282.481).abs() < 1e-9);
            let parts: f64 = run["phases"]
                .as_array()
                .unwrap()
                .iter()
                .map(|p| p["fuel_kg"].as_f64().unwrap())
                .sum();
            assert!((parts / run["fuel_kg"].as_f64().unwrap() - 1.0).abs() < 1e-12);
        }
        let film = &summary["runs"][0]["loss_kj"]["belt_film"];
        assert_eq!(film.is_null(), formulation != "smooth", "{formulation}");
        let fuel = |k: usize| summary["runs"][k]["fuel_l_per_100km"].as_f64().unwrap();
        for (k, comparison) in summary["comparison"].as_array().unwrap().iter().enumerate() {
            let percent = comparison["fuel_percent"].as_f64().unwrap();
            assert!((percent - (fuel(0) / fuel(k + 1) - 1.0) * 100.0).abs() < 1e-9);
        }
    }
}

/// 40 CFR 86.144 by hand: Y = 0.43 (Y_ct + Y_s)/(D_ct + D_s) + 0.57 (Y_ht + Y_s)/(D_ht + D_s).
#[test]
fn val_ftp75_is_weighted_by_bag() {
    let summary = json(&["run", "--cycle", "ftp75", "--json", "--baseline", "none"]);
    let run = &summary["runs"][0];
    let phases = run["phases"].as_array().unwrap();
    let bag = |name: &str| {
        let phase = phases.iter().find(|p| p["name"] == name).unwrap();
        (
            phase["fuel_kg"].as_f64().unwrap() / 0.745,
            phase["distance_km"].as_f64().unwrap(),
        )
    };
    let (ct, s, ht) = (
        bag("cold_transient"),
        bag("stabilised"),
        bag("hot_transient"),
    );
    let y = 0.43 * (ct.0 + s.0) / (ct.1 + s.1) + 0.57 * (ht.0 + s.0) / (ht.1 + s.1);
    assert!((run["weighted_fuel_l_per_100km"].as_f64().unwrap() / (100.0 * y) - 1.0).abs() < 1e-12);
    let soak = phases.iter().find(|p| p["name"] == "hot_soak").unwrap();
    assert_eq!(
        (soak["fuel_kg"].as_f64(), &soak["fuel_l_per_100km"]),
        (Some(0.0), &Value::Null)
    );
    assert_eq!(summary["comparison"], Value::Array(Vec::new()));
    assert!(!keys(&json(&["run", "--json"])["runs"][0]).contains(&"weighted_fuel_l_per_100km"));
}

#[test]
fn the_table_has_the_fuel_of_every_car() {
    let text = stdout(&run(&["run", "--ambient", "-10"]));
    for part in [
        "rover_216_cvt",
        "total",
        "L/100 km",
        "mpg (UK)",
        "mpg (US)",
        "g/km",
        "10.937",
        "11.028",
        "rover_216_cvt uses",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    assert!(!text.contains("NaN") && !text.contains("inf") && !text.contains('\u{1b}'));
    assert_eq!(stdout(&run(&["run", "--quiet"])), "");
}

#[test]
fn all_bad_inputs_are_reported_at_once() {
    let message = refused(&[
        "run",
        "--cycle",
        "ece15_euds",
        "--vehicle",
        "rover_216_cvtt",
        "--ambient",
        "hot",
        "--start",
        "wam",
        "--dt",
        "0",
        "--formulation",
        "smoth",
        "--lubricant",
        "dexron_iv",
        "--set",
        "nonsense",
        "--baseline",
        "mondeo",
    ]);
    let parts = [
        "--cycle: there is no cycle named `ece15_euds`",
        "did you mean `ece15_eudc",
        "did you mean `rover_216_cvt",
        "--ambient: `hot`",
        "-40 to 60",
        "did you mean `warm",
        "--dt: `0` is out of range",
        "0.01 to 10 s",
        "did you mean `smooth",
        "did you mean `dexron_ii",
        "--set nonsense",
        "there is no vehicle named `mondeo`",
        "9 problems in",
    ];
    for part in parts {
        assert!(message.contains(part), "{part} is not in\n{message}");
    }
}

#[test]
fn unknown_and_impossible_overrides_name_the_key() {
    let message = refused(&[
        "run",
        "--set",
        "transmission.cvt.belt.band_ofset_mm=2",
        "--set",
        "road_load.mass_kg=nan",
    ]);
    assert!(
        message.contains("transmission.cvt.belt.band_offset_mm")
            && message.contains("road_load.mass_kg"),
        "{message}"
    );
    let message = refused(&[
        "run",
        "--set-all",
        "transmission.cvt.pump.displacement_cc_rev=8",
    ]);
    assert!(
        message.contains("--set-all transmission.cvt") && message.contains("rover_216_5mt"),
        "{message}"
    );
    for bad in ["nan", "inf", "-273", "20,5", "", "20C"] {
        let message = refused(&["run", "--ambient", bad]);
        assert!(
            message.contains("--ambient") && message.contains("-40 to 60"),
            "{message}"
        );
    }
    assert!(
        refused(&["run", "--baseline", "none", "--baseline", "mondeo_20_5mt"]).contains("none")
    );
    assert!(refused(&["run", "--nonsense"]).contains("--nonsense"));
}

#[test]
fn overrides_and_fluids_reach_the_cars_they_are_meant_for() {
    let fuel = |words: &[&str]| {
        let all = json(
            &[
                &[
                    "run",
                    "--json",
                    "--ambient",
                    "-10",
                    "--baseline",
                    "rover_216_5mt",
                ],
                words,
            ]
            .concat(),
        );
        let of = |k: usize| all["runs"][k]["fuel_kg"].clone();
        (of(0), of(1))
    };
    let plain = fuel(&[]);
    let subject = |changed: (Value, Value)| changed.0 != plain.0 && changed.1 == plain.1;
    let both = |changed: (Value, Value)| changed.0 != plain.0 && changed.1 != plain.1;
    assert!(subject(fuel(&["--set", "road_load.mass_kg=1250"])));
    assert!(both(fuel(&["--set-all", "road_load.mass_kg=1250"])));
    assert!(subject(fuel(&["--lubricant", "dexron_ii"])));
    assert!(both(fuel(&["--engine-oil", "engine_5w30"])));
    assert!(both(fuel(&["--start", "60"])));
    // What is set for the subject alone goes before what is set for all.
    let mixed = fuel(&[
        "--set-all",
        "road_load.mass_kg=1250",
        "--set",
        "road_load.mass_kg=1130",
    ]);
    assert!(mixed.0 == plain.0 && mixed.1 != plain.1);
}

#[test]
fn a_car_may_be_compared_with_itself() {
    let words = [
        "run",
        "--json",
        "--set",
        "transmission.cvt.pump.displacement_cc_rev=8",
        "--baseline",
        "rover_216_cvt",
    ];
    let summary: Value = serde_json::from_slice(&run(&words).stdout).unwrap();
    assert_eq!(summary["runs"][1]["vehicle"], "rover_216_cvt_2");
    assert!(summary["comparison"][0]["fuel_percent"].as_f64().unwrap() < 0.0);
    assert_eq!(summary["settings"]["set"][0], words[3]);
}

#[test]
fn a_missed_trace_is_exit_code_1() {
    let words = ["run", "--cycle", "us06", "--set", "road_load.mass_kg=3500"];
    let output = run(&words);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("rover_216_cvt misses the trace for"),
        "{}",
        stderr(&output)
    );
    let output = run(&[&words[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(1));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let run = &summary["runs"][0];
    assert_eq!(run["failed_checks"][0], "missed_trace");
    assert!(run["trace_missed_s"].as_f64().unwrap() > 0.0);
    assert!(
        run["worst_deficit"]["power_w"].as_f64().unwrap() > 0.0
            && run["worst_deficit"]["at_s"].is_number()
    );
    assert!(stderr(&output).contains("misses the trace"));
}

#[test]
fn files_appear_together_and_are_not_overwritten() {
    let dir = tempfile::tempdir().unwrap();
    let words = [
        "run",
        "--cycle",
        "ece15",
        "--baseline",
        "rover_216_5mt",
        "--out",
        "cold",
    ];
    let output = run_in(dir.path(), &words);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let names = "summary.json inputs.json fuel_comparison.svg trace_rover_216_cvt.csv driveline_rover_216_cvt.svg pressure_rover_216_cvt.svg \
        temperatures_rover_216_cvt.svg losses_rover_216_cvt.svg operating_points_rover_216_cvt.svg trace_rover_216_5mt.csv \
        driveline_rover_216_5mt.svg temperatures_rover_216_5mt.svg losses_rover_216_5mt.svg operating_points_rover_216_5mt.svg";
    let out = dir.path().join("cold");
    for name in names.split_whitespace() {
        assert!(
            out.join(name).is_file() && stdout(&output).contains(name),
            "{name}"
        );
    }
    assert_eq!(
        fs::read_dir(&out).unwrap().count(),
        names.split_whitespace().count()
    );
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["cycle"], "ece15");
    let trace = fs::read_to_string(out.join("trace_rover_216_cvt.csv")).unwrap();
    assert_eq!(trace.lines().count(), 196);
    let before = fs::read(out.join("summary.json")).unwrap();
    let again = run_in(dir.path(), &[&words[..], &["--ambient", "0"]].concat());
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("--force"), "{}", stderr(&again));
    assert_eq!(fs::read(out.join("summary.json")).unwrap(), before);
    let forced = run_in(
        dir.path(),
        &[&words[..], &["--ambient", "0", "--force", "--json"]].concat(),
    );
    assert_eq!(forced.status.code(), Some(0), "{}", stderr(&forced));
    assert_eq!(fs::read(out.join("summary.json")).unwrap(), forced.stdout);
}

#[test]
fn nothing_is_left_after_a_failure() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("file"), "").unwrap();
    let message = stderr(&run_in(dir.path(), &["run", "--out", "file/below"]));
    assert!(message.contains("--out"), "{message}");
    let output = run_in(
        dir.path(),
        &["run", "--out", "new/run", "--vehicle", "no_such_car"],
    );
    assert_eq!(output.status.code(), Some(2));
    let left: Vec<_> = fs::read_dir(dir.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(left, ["file"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported() {
    for words in [
        &["run"][..],
        &["list", "cycles"],
        &["--help"],
        &["assumptions"],
    ] {
        let full = fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("cvtcycle"));
        let output = command
            .args(words)
            .stdout(full)
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
            .wait_with_output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(
            stderr(&output).contains("standard output: cannot write"),
            "{}",
            stderr(&output)
        );
    }
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    for words in [&["assumptions"][..], &["run"], &["--help"]] {
        let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin("cvtcycle"));
        let mut child = command
            .args(words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(
            (output.status.code(), stderr(&output)),
            (Some(0), String::new()),
            "{words:?}"
        );
    }
}

#[test]
fn colours_are_for_terminals_and_for_those_who_ask() {
    let coloured = |words: &[&str], no_color: bool| {
        let mut command = program();
        if no_color {
            command.env("NO_COLOR", "1");
        }
        let output = command.args(words).output().unwrap();
        (stdout(&output) + &stderr(&output)).contains('\u{1b}')
    };
    for words in [
        &["run"][..],
        &["--help"],
        &["run", "--cycle", "x"],
        &["list", "vehicles"],
        &["--nonsense"],
    ] {
        assert!(
            !coloured(words, false) && !coloured(words, true),
            "{words:?}"
        );
        assert!(
            !coloured(&[words, &["--color", "never"]].concat(), false),
            "{words:?}"
        );
    }
    for words in [
        &["run", "--color=always"][..],
        &["run", "--color", "always", "--help"],
        &["--color=always", "run", "--cycle", "x"],
    ] {
        assert!(coloured(words, true), "{words:?}");
    }
    assert!(!coloured(&["run", "--json", "--color=always"], false));
}

#[test]
fn lists_name_what_can_be_driven() {
    let cycles = json(&["list", "cycles", "--json"]);
    let nedc = cycles["cycles"]
        .as_array()
        .unwrap()
        .iter()
        .find(|c| c["name"] == "ece15_eudc")
        .unwrap();
    assert_eq!(
        (
            nedc["duration_s"].as_f64(),
            nedc["max_speed_kmh"].as_f64().map(f64::round)
        ),
        (Some(1180.0), Some(120.0))
    );
    assert!((nedc["distance_km"].as_f64().unwrap() - 11.028).abs() < 1e-3);
    assert!((nedc["distance_automatic_km"].as_f64().unwrap() - 10.937).abs() < 1e-3);
    assert_eq!(
        json(&["list", "vehicles", "--json"])["vehicles"]
            .as_array()
            .unwrap()
            .len(),
        3
    );
    assert_eq!(
        json(&["list", "lubricants", "--json"])["lubricants"]
            .as_array()
            .unwrap()
            .len(),
        6
    );
    for what in ["cycles", "vehicles", "lubricants"] {
        let text = stdout(&run(&["list", what]));
        assert!(
            text.lines().count() > 4 && text.lines().all(|line| line.chars().count() <= 120),
            "{text}"
        );
    }
}

#[test]
fn show_prints_values_with_status_and_source() {
    let shown = json(&["show", "rover_216_cvt", "--json", "--status", "assumed"]);
    let keys = shown["keys"].as_array().unwrap();
    assert!(keys.len() > 20 && keys.iter().all(|key| key["status"] == "assumed"));
    let text = stdout(&run(&["show", "rover_216_cvt"]));
    for part in [
        "[transmission.cvt.belt]",
        "band_offset_mm",
        "3 mm",
        "source",
        "thesis App. C",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(stdout(&run(&["show", "dexron_iii"])).contains("kv40_mm2_s"));
    assert!(stdout(&run(&["show", "ece15_eudc"])).contains("eudc"));
    assert!(refused(&["show", "dexron_4"]).contains("did you mean `dexron_ii"));
}

#[test]
fn explain_knows_keys_columns_flags_and_equations() {
    let whole = stdout(&run(&["explain", "transmission.cvt.belt.band_offset_mm"]));
    for part in [
        "0 to 20 mm",
        "BT-1",
        "rover_216_cvt",
        "3 mm",
        "thesis App. C",
    ] {
        assert!(whole.contains(part), "{part} is not in\n{whole}");
    }
    assert_eq!(stdout(&run(&["explain", "band_offset_mm"])), whole);
    let oil = json(&["explain", "engine_oil.kv40_mm2_s", "--json"]);
    assert_eq!(oil["keys"][0]["values"].as_array().unwrap().len(), 6);
    // An option that no embedded vehicle chooses.
    assert!(
        stdout(&run(&["explain", "dual_cavity"])).contains("share")
            || run(&["explain", "kind.dual_cavity.share"]).status.success()
    );
    for word in [
        "clamp_safety",
        "gross_slip",
        "SL-8",
        "transmission.cvt.pump",
        "missed_trace",
    ] {
        assert_eq!(run(&["explain", word]).status.code(), Some(0), "{word}");
    }
    assert!(
        refused(&["explain", "band_ofset_mm"]).contains("transmission.cvt.belt.band_offset_mm")
    );
    let starts = stdout(&run(&["explain", "calibration.starts"]));
    assert!(starts.contains("integer from 1 to 1000"), "{starts}");
    assert!(refused(&["explain", "gros_slip"]).contains("gross_slip"));
}

/// Terms of the field are found under any spelling, with every name that belongs to them; so are columns of the summary.
#[test]
fn explain_knows_the_terms_of_the_field_and_the_summary() {
    for (term, name) in [
        ("clamping force", "transmission.cvt.clamp"),
        ("spin-loss", "pump_loss_w"),
        ("drag_torque", "transmission.cvt.reverse_clutch.drag_nm"),
        ("Road load", "road_load.mass_kg"),
        ("coast-down", "road_load.form.coefficients.f0_n"),
        ("torque capacity", "min_clamp_safety"),
        ("variogram", "transmission.cvt.ratio.low"),
        ("ratio-span", "transmission.cvt.ratio.high"),
        ("slip", "slip_percent"),
        ("fuel_l_per_100km", "column of the summary"),
        ("subject_excess_percent", "column of the summary"),
        ("loss_pump_kj", "column of the summary"),
    ] {
        let text = stdout(&run(&["explain", term]));
        assert!(
            text.contains(name),
            "{name} is not in the explanation of {term}:\n{text}"
        );
    }
    // Every name of the table is explained.
    let table = include_str!("../../src/commands/explain/terms.txt");
    for line in table.lines() {
        let (terms, names) = line.split_once(':').unwrap();
        let term = terms.split(',').next().unwrap();
        let text = stdout(&run(&["explain", term]));
        for name in names.split(',').map(str::trim) {
            assert!(text.contains(name), "{term}: {name} is not in\n{text}");
        }
    }
}

#[test]
fn check_reports_every_file() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(dir.path().join(name), bytes).unwrap();
    let embedded = |name: &str| fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap();
    write("car.toml", &embedded("vehicles/rover_216_cvt.toml"));
    write("oil.toml", &embedded("lubricants/dexron_ii.toml"));
    write("town.csv", b"time_s,speed_kmh\n0,0\n1,3\n2,0\n");
    let good = run_in(dir.path(), &["check", "car.toml", "oil.toml", "town.csv"]);
    assert_eq!(good.status.code(), Some(0), "{}", stderr(&good));
    assert_eq!(
        stdout(&good),
        "ok  car.toml (vehicle)\nok  oil.toml (lubricant)\nok  town.csv (cycle)\n"
    );
    write("semicolons.csv", b"time_s;speed_kmh\n0;0\n1;3\n");
    write("back.csv", b"time_s,speed_kmh\n0,0\n2,3\n1,-4\n3,nan\n");
    write("empty.toml", b"");
    write("binary.toml", &[0, 159, 146, 150]);
    write("other.toml", b"[package]\nname = 'x'\n");
    write(
        "thin.toml",
        b"kv40_mm2_s = -3\nkv100_mm2_s = 7.2\ndensity15_kg_m3 = 865\n",
    );
    let files = [
        "semicolons.csv",
        "back.csv",
        "empty.toml",
        "binary.toml",
        "other.toml",
        "thin.toml",
        "none.toml",
        ".",
    ];
    let bad = run_in(dir.path(), &[&["check", "car.toml"], &files[..]].concat());
    assert_eq!(
        (bad.status.code(), stdout(&bad).as_str()),
        (Some(2), "ok  car.toml (vehicle)\n")
    );
    let message = stderr(&bad);
    let parts = [
        "semicolons.csv:1",
        "back.csv:4",
        "back.csv:5",
        "empty",
        "binary file",
        "neither",
        "1.5 to 5000 mm²/s",
        "cannot read `none.toml`",
        "name a file in that directory",
    ];
    for part in parts {
        assert!(message.contains(part), "{part} is not in\n{message}");
    }
    let listed = run_in(dir.path(), &["check", "--json", "car.toml", "back.csv"]);
    let listed: Value = serde_json::from_slice(&listed.stdout).unwrap();
    assert_eq!(
        (&listed["files"][0]["ok"], &listed["files"][1]["ok"]),
        (&Value::from(true), &Value::from(false))
    );
    assert!(listed["files"][1]["problems"].as_array().unwrap().len() >= 3);
}

#[test]
fn check_knows_the_plan_of_a_calibration() {
    let good = run(&["check", "rover_216_warm_up", "rover_216_cvt"]);
    assert_eq!(
        (good.status.code(), stdout(&good).as_str()),
        (
            Some(0),
            "ok  rover_216_warm_up (calibration)\nok  rover_216_cvt (vehicle)\n"
        )
    );
    // By its other tables, though the first is misspelt and a vehicle is named below it.
    let folder = tempfile::tempdir().unwrap();
    let plan = folder.path().join("plan.toml");
    let text =
        "[calibratoin]\nvehicle = \"rover_216_cvt\"\n[[parameters]]\nlow = 5\n[[date]]\nsd = 0.1\n";
    fs::write(&plan, text).unwrap();
    let bad = run(&["check", plan.to_str().unwrap()]);
    assert_eq!((bad.status.code(), stdout(&bad).as_str()), (Some(2), ""));
    assert!(
        stderr(&bad).contains("did you mean [calibration]?"),
        "{}",
        stderr(&bad)
    );
    assert!(refused(&["show", "rover_216_warm_up"]).contains("the plan of a calibration"));
}

#[test]
fn check_knows_the_plan_of_a_study() {
    let good = run(&["check", "plans/uncertainty_rover.toml", "pump_and_offset"]);
    assert_eq!(
        (good.status.code(), stdout(&good).as_str()),
        (
            Some(0),
            "ok  plans/uncertainty_rover.toml (study)\nok  pump_and_offset (study)\n"
        )
    );
    // The first by its other tables, though a vehicle is named; a key that no car has shows only where the cars are read.
    let dir = tempfile::tempdir().unwrap();
    let text = fs::read_to_string("plans/pump_and_offset.toml").unwrap();
    fs::write(
        dir.path().join("head.toml"),
        text.replace("[study]", "[stdy]"),
    )
    .unwrap();
    fs::write(
        dir.path().join("key.toml"),
        text.replace("belt.band_offset_mm", "belt.band_ofset_mm"),
    )
    .unwrap();
    for (file, message) in [
        ("head.toml", "did you mean `study`?"),
        ("key.toml", "did you mean"),
    ] {
        let bad = run_in(dir.path(), &["check", file]);
        assert_eq!((bad.status.code(), stdout(&bad).as_str()), (Some(2), ""));
        assert!(
            stderr(&bad).contains(message),
            "{message} is not in\n{}",
            stderr(&bad)
        );
    }
    assert!(refused(&["show", "pump_and_offset"]).contains("the plan of a study"));
}

#[test]
fn check_tells_what_cannot_be_read_before_what_is_not_known() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(
        dir.path().join("deep.toml"),
        format!("a = {}1{}\n", "[".repeat(500), "]".repeat(500)),
    )
    .unwrap();
    fs::write(dir.path().join("open.toml"), "x = [1, 2\ny = \"\n").unwrap();
    let bad = run_in(dir.path(), &["check", "deep.toml", "open.toml"]);
    assert_eq!(bad.status.code(), Some(2));
    for part in ["deep.toml:1", "nested", "open.toml:"] {
        assert!(
            stderr(&bad).contains(part),
            "{part} is not in\n{}",
            stderr(&bad)
        );
    }
}

#[test]
fn a_users_own_files_can_be_run() {
    let dir = tempfile::tempdir().unwrap();
    let car = Path::new(env!("CARGO_MANIFEST_DIR")).join("vehicles/rover_216_5mt.toml");
    fs::copy(car, dir.path().join("my_car.toml")).unwrap();
    fs::write(
        dir.path().join("town.csv"),
        "time_s,speed_kmh\n0,0\n10,36\n20,36\n30,0\n",
    )
    .unwrap();
    let output = run_in(
        dir.path(),
        &[
            "run",
            "--cycle",
            "town.csv",
            "--vehicle",
            "./my_car.toml",
            "--baseline",
            "none",
            "--json",
        ],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&summary["cycle"], &summary["runs"][0]["vehicle"]),
        (&Value::from("town"), &Value::from("my_car"))
    );
    // By hand: 50 m, 100 m and 50 m.
    assert!((summary["runs"][0]["distance_km"].as_f64().unwrap() - 0.2).abs() < 1e-12);
}

#[test]
fn packagers_get_completions_and_manual_pages() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = stdout(&run(&["completions", shell]));
        assert!(script.contains("ambient"), "{shell}");
        // The generators for the other two leave values out.
        let values = ["bash", "zsh", "fish"].contains(&shell);
        assert_eq!(
            script.contains("ece15_eudc") && script.contains("rover_216_cvt"),
            values,
            "{shell}"
        );
    }
    assert!(stdout(&run(&["man"])).contains(".TH"));
    assert!(stdout(&run(&["man", "run"])).contains("ambient"));
    assert!(refused(&["man", "rum"]).contains("did you mean `run"));
}

#[test]
fn assumptions_has_every_value_of_the_shipped_files() {
    let printed = stdout(&run(&["assumptions"]));
    for vehicle in ["rover_216_cvt", "rover_216_5mt", "mondeo_20_5mt"] {
        let shown = stdout(&run(&["show", vehicle, "--status", "assumed", "--json"]));
        let shown: Value = serde_json::from_str(&shown).unwrap();
        let keys = shown["keys"].as_array().unwrap();
        assert!(keys.len() > 40, "{vehicle}: {}", keys.len());
        for value in keys {
            let row = format!("| `{}` |", value["key"].as_str().unwrap());
            assert!(printed.contains(&row), "{vehicle}: {row}");
        }
    }
}

/// Every command's help ends with examples, and they work as they stand there.
#[test]
fn the_examples_of_the_help_work() {
    let dir = tempfile::tempdir().unwrap();
    let mut count = 0;
    for command in [
        "",
        "run",
        "report",
        "list",
        "show",
        "explain",
        "check",
        "schema",
        "assumptions",
        "completions",
        "man",
    ] {
        let words: Vec<&str> = [command, "--help"]
            .into_iter()
            .filter(|word| !word.is_empty())
            .collect();
        let help = stdout(&run(&words));
        let lines = help.lines().filter_map(|line| {
            let line = line.trim_start().trim_start_matches("Example: ");
            line.strip_prefix("cvtcycle ")
                .map(|line| line.split(" > ").next().unwrap_or(line))
        });
        let examples: Vec<&str> = lines.filter(|line| !line.starts_with('[')).collect();
        assert!(!examples.is_empty(), "{command}:\n{help}");
        for example in examples {
            let words: Vec<&str> = example.split_whitespace().collect();
            let output = run_in(dir.path(), &words);
            assert_eq!(
                output.status.code(),
                Some(0),
                "{example}: {}",
                stderr(&output)
            );
            count += 1;
        }
    }
    assert!(count > 15);
}

#[test]
fn the_files_that_a_vehicle_names_are_read_from_its_folder() {
    let dir = tempfile::tempdir().unwrap();
    let embedded = |name: &str| {
        fs::read_to_string(
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("vehicles")
                .join(name),
        )
        .unwrap()
    };
    let cars = dir.path().join("cars");
    fs::create_dir(&cars).unwrap();
    fs::write(cars.join("other.toml"), embedded("rover_216_5mt.toml")).unwrap();
    let car = embedded("rover_216_cvt.toml");
    fs::write(
        cars.join("good.toml"),
        car.replace("rover_216_5mt, mondeo_20_5mt", "other.toml"),
    )
    .unwrap();
    fs::write(
        cars.join("bad.toml"),
        car.replace("rover_216_5mt, mondeo_20_5mt", "no_such_car"),
    )
    .unwrap();
    let good = run_in(
        dir.path(),
        &[
            "run",
            "--cycle",
            "ece15",
            "--vehicle",
            "cars/good.toml",
            "--json",
        ],
    );
    let summary: Value = serde_json::from_slice(&good.stdout).unwrap();
    assert_eq!(summary["runs"][1]["vehicle"], "other");
    for words in [
        &["run", "--vehicle", "cars/bad.toml"][..],
        &["check", "cars/bad.toml"],
    ] {
        let bad = run_in(dir.path(), words);
        assert_eq!(bad.status.code(), Some(2));
        assert!(
            stderr(&bad).contains("cars/bad.toml: there is no vehicle named `no_such_car`"),
            "{}",
            stderr(&bad)
        );
    }
}
