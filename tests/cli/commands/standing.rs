//! Drives without way, and starts with temperatures of single nodes.

use std::fs;
use std::path::Path;

use super::{json, one_line, refused, run, run_in, stderr, stdout};
use serde_json::Value;

/// A cycle of 600 s in which the car creeps over some metres at its end; none for 0.
fn standing(dir: &Path, metres: f64) {
    // A triangle of 20 s: as high as a tenth of the way in m/s.
    let top = 0.1 * metres * 3.6;
    let text = format!("time_s,speed_kmh\n0,0\n580,0\n590,{top}\n600,0\n");
    fs::write(dir.join("standing.csv"), text).unwrap();
}

fn driven(dir: &Path, more: &[&str]) -> (Value, String) {
    let words = [
        "run",
        "--cycle",
        "./standing.csv",
        "--start",
        "85",
        "--price",
        "never",
    ];
    let words = [&words[..], more].concat();
    let json = run_in(dir, &[&words[..], &["--json"]].concat());
    assert_eq!(json.status.code(), Some(0), "{}", stderr(&json));
    let text = one_line(&stdout(&run_in(dir, &words)));
    (serde_json::from_slice(&json.stdout).unwrap(), text)
}

/// Truth: definition. L/h by hand from mass, density and time; no L/100 km below 10 m and below 1 km/h on the whole (167 m in 600 s); both above. Nothing
/// printed is NaN.
#[test]
fn fuel_of_a_drive_without_way_is_in_litres_an_hour() {
    let dir = tempfile::tempdir().unwrap();
    for (metres, way) in [(0.0, false), (4.0, false), (30.0, false), (60.0, false)] {
        standing(dir.path(), metres);
        let (found, text) = driven(dir.path(), &["--baseline", "rover_216_5mt"]);
        let own = &found["runs"][0];
        let number = |key: &str| own[key].as_f64().unwrap();
        let by_hand = number("fuel_kg") / 745.0 * 1000.0 * 6.0;
        assert!((number("fuel_l_per_h") / by_hand - 1.0).abs() < 1e-12);
        assert!((number("fuel_g") / number("fuel_kg") - 1000.0).abs() < 1e-9);
        assert!((number("fuel_kg_per_h") / number("fuel_kg") - 6.0).abs() < 1e-9);
        assert_eq!(own["fuel_l_per_100km"].is_number(), way, "{metres} m");
        assert_eq!(own["co2_g_per_km"].is_number(), way);
        assert!(
            text.contains("L/h") && !text.contains("NaN") && !text.contains("nan"),
            "{text}"
        );
        let first = text.split(". ").next().unwrap();
        assert!(
            first.contains("rover_216_cvt: ") && first.contains(" L/h"),
            "{text}"
        );
        // The difference is that of the fuel in the same time.
        let other = &found["runs"][1]["fuel_l_per_h"];
        let percent = 100.0 * (number("fuel_l_per_h") / other.as_f64().unwrap() - 1.0);
        let said = found["comparison"][0]["fuel_percent"].as_f64().unwrap();
        assert!(
            (said - percent).abs() < 1e-9 && first.contains("rover_216_5mt"),
            "{text}"
        );
        if metres <= 0.0 {
            assert!((0.8..1.05).contains(&number("fuel_l_per_h")), "{own}");
        }
    }
    // A cycle with a way has both.
    let ece = &json(&["run", "--cycle", "ece15", "--baseline", "none", "--json"])["runs"][0];
    let [hour, way] = ["fuel_l_per_h", "fuel_l_per_100km"].map(|key| ece[key].as_f64().unwrap());
    let kmh = ece["distance_km"].as_f64().unwrap() / ece["duration_s"].as_f64().unwrap() * 3600.0;
    assert!((hour / (way * kmh / 100.0) - 1.0).abs() < 1e-9);
}

/// Report and comparison of such runs: L/h, and no number that is none. Truth: definition.
#[test]
fn report_and_compare_are_in_litres_an_hour() {
    let dir = tempfile::tempdir().unwrap();
    standing(dir.path(), 0.0);
    let base = [
        "run",
        "--cycle",
        "./standing.csv",
        "--start",
        "85",
        "--price",
        "never",
        "--baseline",
        "rover_216_5mt",
    ];
    for (out, set) in [
        ("a", "engine.electrical_w=300"),
        ("b", "engine.electrical_w=900"),
    ] {
        let output = run_in(
            dir.path(),
            &[&base[..], &["--out", out, "--set", set]].concat(),
        );
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let output = run_in(dir.path(), &["compare", "a", "b", "--json"]);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let [a, b] = [0, 1].map(|k| found["runs"][k]["fuel_l_per_h"].as_f64().unwrap());
    assert!(b > a && found["runs"][1]["fuel_l_per_100km"].is_null());
    let percent = found["runs"][1]["difference_percent"].as_f64().unwrap();
    assert!((percent - 100.0 * (b / a - 1.0)).abs() < 1e-9);
    let text = stdout(&run_in(dir.path(), &["compare", "a", "b"]));
    assert!(
        text.contains("L/h") && text.contains("kJ/h") && !text.contains("km "),
        "{text}"
    );
    for words in [
        &["report", "a", "--out", "a.html"][..],
        &["report", "a", "b", "--out", "ab.html"],
    ] {
        let output = run_in(dir.path(), words);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let page = fs::read_to_string(dir.path().join(words.last().unwrap())).unwrap();
        assert!(page.contains("L/h"), "{words:?}");
        let visible = page.to_lowercase();
        assert!(
            !visible.contains("nan ") && !visible.contains(">nan<"),
            "{words:?}"
        );
    }
}

/// TH-10 through the program. Truth: definition; all nodes given alike are the start at one temperature, to the bit; a warmer box burns less.
#[test]
fn nodes_of_a_start() {
    let fuel = |start: &str| {
        let found = json(&[
            "run",
            "--cycle",
            "ece15",
            "--baseline",
            "none",
            "--price",
            "never",
            "--start",
            start,
            "--json",
        ]);
        (
            found["runs"][0]["fuel_kg"].as_f64().unwrap(),
            found["start"].clone(),
        )
    };
    let all = "coolant=60,engine_oil=60,sump=60,metal=60,belt=60,tyre=60";
    assert_eq!(fuel(all).0.to_bits(), fuel("60").0.to_bits());
    assert_eq!(fuel("coolant=25").0.to_bits(), fuel("soak").0.to_bits());
    assert_eq!(
        fuel("coolant=81,engine_oil=81,sump=60,metal=60,belt=60")
            .0
            .to_bits(),
        fuel("coolant=81,sump=60").0.to_bits()
    );
    let [cold_box, warm_box, cold_engine] =
        ["coolant=81", "coolant=81,sump=60", "sump=60"].map(|start| fuel(start).0);
    assert!(warm_box < cold_box && cold_box < cold_engine);
    assert_eq!(
        fuel("coolant=81,sump=60.5").1,
        serde_json::json!({"coolant": 81.0, "sump": 60.5})
    );
    let text = one_line(&stdout(&run(&[
        "run",
        "--start",
        "coolant=81,sump=60",
        "--price",
        "never",
    ])));
    assert!(text.contains("start with coolant (engine oil) at 81 degC, sump (metal, belt) at 60 degC, tyre at ambient"), "{text}");
    for (start, part) in [
        ("coolant=81,sumpf=60", "there is no node `sumpf`"),
        ("coolant=81,sump=200", "200 degC of `sump` is out of range"),
        ("coolant=81,coolant=80", "`coolant` is given twice"),
        ("coolant=warm", "not a number"),
        ("coolant=", "not a number"),
        ("coolant=81,", "there is no node"),
    ] {
        let text = one_line(&refused(&["run", "--start", start]));
        assert!(
            text.contains(part) && text.contains("1 problem in --start"),
            "{text}"
        );
        assert!(
            text.contains("nodes: coolant, engine_oil, sump, metal, belt, tyre"),
            "{text}"
        );
    }
}
