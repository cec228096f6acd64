//! Cycles of other programs, their conversion, and cycles that depend on the car. Truth: the same cycle by the program's own name.

use super::{json, run, run_in, stderr, stdout};
use serde_json::Value;

const LOG: &str = "Time_ADC;VehSpd;Temp\n0;0;warm\n10;13,5;\n20;13,5;\n30;0;x\n";
const COLUMNS: &str = "time=Time_ADC:s,speed=VehSpd:mph";

#[test]
fn a_logger_s_table_is_driven_by_its_named_columns() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("log.csv"), LOG).unwrap();
    let drive = [
        "run",
        "--cycle",
        "log.csv",
        "--price",
        "never",
        "--baseline",
        "none",
    ];
    let refused = run_in(dir.path(), &drive);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        stderr(&refused)
            .contains("try: cvtcycle run --cycle log.csv --price never --baseline none --columns"),
        "{}",
        stderr(&refused)
    );
    let words = [&drive[..], &["--columns", COLUMNS, "--json"]].concat();
    let driven = run_in(dir.path(), &words);
    let summary: Value = serde_json::from_slice(&driven.stdout).unwrap();
    assert_eq!(
        summary["read_as"],
        "semicolons, decimal commas, \"Time_ADC\" as time in s, \"VehSpd\" as speed in mph, 2 of 3 columns"
    );
    // 13.5 mph are 6.035 m/s: ten seconds accelerating, ten at constant speed, ten decelerating.
    let km = summary["runs"][0]["distance_km"].as_f64().unwrap();
    assert!((km - 0.120_700_8).abs() < 1e-9, "{km}");
    let text = stdout(&run_in(dir.path(), &words[..words.len() - 1]));
    assert!(
        text.contains("read as: semicolons, decimal commas"),
        "{text}"
    );
    let checked = run_in(dir.path(), &["check", "log.csv", "--columns", COLUMNS]);
    assert!(
        stdout(&checked).contains("read as: semicolons"),
        "{}",
        stdout(&checked)
    );
    let wrong = run_in(
        dir.path(),
        &[
            "check",
            "log.csv",
            "--columns",
            "time=Time_ADC:s,speed=VehSped:mph",
        ],
    );
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        stderr(&wrong).contains("--columns") && stderr(&wrong).contains("did you mean `VehSpd`?"),
        "{}",
        stderr(&wrong)
    );
    let named = run(&["show", "ece15", "--columns", "time:s"]);
    assert!(
        stderr(&named).contains("`ece15` is no file whose columns could be named"),
        "{}",
        stderr(&named)
    );
}

#[test]
fn convert_lists_the_columns_it_read_and_dropped() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(
        dir.path().join("lap.vdri"),
        "<s>,<v>,<grad>,<stop>\n0,0,0,3\n500,50,1,0\n900,0,0,2\n",
    )
    .unwrap();
    let written = run_in(
        dir.path(),
        &["convert", "cycle", "lap.vdri", "--out", "lap.csv"],
    );
    assert_eq!(written.status.code(), Some(0), "{}", stderr(&written));
    assert!(
        stderr(&written).contains("read as: \"<s>\" as distance_m"),
        "{}",
        stderr(&written)
    );
    let shown = run_in(dir.path(), &["show", "lap.csv", "--json"]);
    let shown: Value = serde_json::from_slice(&shown.stdout).unwrap();
    assert!(
        (shown["distance_km"].as_f64().unwrap() - 0.9).abs() < 1e-9,
        "{shown}"
    );
    assert!(shown["read_as"].is_null());
    let again = run_in(
        dir.path(),
        &["convert", "cycle", "lap.vdri", "--out", "lap.csv"],
    );
    assert_eq!(again.status.code(), Some(2));
    let epa = run(&["convert", "cycle", "nedc", "--to", "epa"]);
    assert!(
        stdout(&epa).starts_with("ECE15_EUDC.TXT\tNEDC"),
        "{}",
        stdout(&epa)
    );
    assert!(
        stderr(&epa).contains("left out: phases, gears"),
        "{}",
        stderr(&epa)
    );
    let csv = stdout(&run(&["show", "ece15", "--csv"]));
    assert_eq!(csv, stdout(&run(&["convert", "cycle", "ece15"])));
    assert!(csv.starts_with("time_s,speed_kmh"), "{csv}");
    for (words, part) in [
        (&["show", "rover_216_cvt", "--csv"][..], "is no cycle"),
        (
            &["convert", "cycle", "udds", "--gears", "rover_216_5mt"],
            "chooses its gears while it drives",
        ),
        (
            &["convert", "cycle", "wltc", "--gears", "rover_216_cvt"],
            "has a CVT",
        ),
        (
            &["convert", "cycle", "ece15", "--to", "vdry"],
            "did you mean `vdri`?",
        ),
    ] {
        let refused = run(words);
        assert_eq!(refused.status.code(), Some(2), "{words:?}");
        assert!(
            stderr(&refused).contains(part),
            "{words:?}: {}",
            stderr(&refused)
        );
    }
}

#[test]
fn the_wltc_and_its_gears_depend_on_the_car() {
    let words = [
        "run",
        "--cycle",
        "wltp",
        "--vehicle",
        "rover_216_5mt",
        "--baseline",
        "none",
        "--price",
        "never",
    ];
    let text = stdout(&run(&words));
    // 82 kW over 1130 kg.
    assert!(
        text.contains("wltc_class3b")
            && text.contains("the car has 72.6 W/kg and reaches 120 km/h"),
        "{text}"
    );
    assert!(text.contains("gears by UN GTR 15, Annex 2"), "{text}");
    let shifted = run(&["convert", "cycle", "wltc", "--gears", "rover_216_5mt"]);
    assert!(
        stderr(&shifted).contains("gears by UN GTR 15, Annex 2"),
        "{}",
        stderr(&shifted)
    );
    let gears = stdout(&shifted);
    assert!(
        gears.starts_with("time_s,speed_kmh,phase,gear,gear_note\n"),
        "{}",
        &gears[..60]
    );
    let fifth = gears.lines().filter(|line| line.ends_with(",5,")).count();
    // UN GTR 15, Annex 2, has the car in fifth gear for 772 s; the last row repeats the one above.
    assert!((771..=773).contains(&fifth), "{fifth}");
}

#[test]
fn other_names_are_listed() {
    let cycles = json(&["list", "cycles", "--json"]);
    let nedc = cycles["cycles"]
        .as_array()
        .unwrap()
        .iter()
        .find(|cycle| cycle["name"] == "ece15_eudc");
    assert_eq!(
        nedc.unwrap()["aliases"],
        serde_json::json!(["nedc", "mvegb"])
    );
    let columns = json(&["list", "columns", "--json"]);
    let speed = &columns["columns"][1];
    assert_eq!(
        (speed["name"].as_str(), speed["headings"][0].as_str()),
        (Some("speed_kmh"), Some("<v>"))
    );
    let text = stdout(&run(&["list", "columns"]));
    assert!(
        text.contains("vehicle_speed") && text.contains("--columns"),
        "{text}"
    );
}
