//! `--power`. Truth: the known value of each row, and the factors at which it leaves its range.

use super::*;
use std::collections::BTreeMap;

const SOURCES: &str = r#"
[tolerances.narrow]
width = 0.001
from = "test"

[sources.larger]
source = "vehicle"
vehicle = "mondeo_20_5mt"

[sources.own_offset]
source = "vehicle"
set = ["transmission.cvt.belt.band_offset_mm=2"]
"#;

const OFFSET: &str = "transmission.cvt.belt.band_offset_mm";

/// Rows named after the change that flips them. The offset is 3 mm with an allowed range of 0.5 to 10 mm, the band is 20 mm wide, the wedge angle is 11 degrees.
fn rows() -> String {
    let number = |id: &str, range: &str, compute: &str| {
        row(
            id,
            &format!("{range}\ntolerance = \"narrow\"\ncompute = \"{compute}\""),
        )
    };
    let three = format!(
        "key({OFFSET}) * key(transmission.cvt.belt.band_width_mm) * key(transmission.cvt.variator.half_wedge_deg)"
    );
    [
        number("weak", "value = 3", &format!("key({OFFSET})")),
        number("blunt", "low = 1\nhigh = 5", &format!("key({OFFSET})")),
        number("moved", "low = 0\nhigh = 20", &format!("key({OFFSET})")),
        number("set", "value = 2", &format!("key(own_offset: {OFFSET})")),
        number("constant", "value = 3", "1 + 2"),
        row(
            "larger",
            "compute = \"key(larger: road_load.mass_kg) > 1200\"",
        ),
        number("sharp", "value = 660", &three),
    ]
    .concat()
}

fn power(own: &UserRows, more: &[&str]) -> (Option<i32>, Value, String) {
    let args: Vec<&str> = ["--power", "--json", "--quiet"]
        .into_iter()
        .chain(more.iter().copied())
        .collect();
    let output = own.run(&args);
    let errors = text(&output.stderr);
    let value = serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {errors}"));
    (output.status.code(), value, errors)
}

#[test]
fn a_row_flips_by_what_it_depends_on() {
    let own = UserRows::new(&(SOURCES.to_owned() + &rows()));
    let (code, all, errors) = power(&own, &["--threads", "2"]);
    assert_eq!(code, Some(0), "{errors}");
    let found: BTreeMap<&str, &Value> = all["power"]["rows"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| (row["id"].as_str().unwrap(), row))
        .collect();
    let changes = |id: &str| -> Vec<&str> {
        let flips = found[id]["flips"].as_array().unwrap();
        flips
            .iter()
            .map(|flip| flip["change"].as_str().unwrap())
            .collect()
    };
    for (id, power, moved) in [
        ("weak", "weak", 2),
        ("blunt", "blunt", 4),
        ("moved", "never", 4),
        ("set", "never", 0),
        ("constant", "never", 0),
        ("larger", "weak", 2),
    ] {
        assert_eq!(found[id]["power"], power, "{id}: {:?}", changes(id));
        assert_eq!(found[id]["moved"], moved, "{id}");
    }
    let at = |size: &str| format!("{OFFSET} x{size}");
    assert_eq!(changes("weak"), [at("0.6"), at("1.5")]);
    assert_eq!(
        changes("blunt"),
        [at("0.1"), at("8")],
        "1.8 and 4.5 mm lie in the range"
    );
    assert_eq!(
        changes("larger"),
        ["road_load.mass_kg x0.6"],
        "a change goes to all cars"
    );
    assert_eq!(found["sharp"]["power"], "sharp");
    assert_eq!(all["power"]["counts"]["never"], 3);
    assert!(all["power"]["tried"].as_u64().unwrap() > 400);
    assert_eq!(all["power"], power(&own, &["--threads", "1"]).1["power"]);
}

#[test]
fn recorded_verdicts_that_changes_contradict_are_exit_1() {
    let number = |id: &str, value: &str, compute: &str, verdict: &str| {
        let more = format!(
            "{value}\ntolerance = \"narrow\"\ncompute = \"{compute}\"\nverdict = \"{verdict}\""
        );
        row(id, &more)
    };
    let offset = format!("key({OFFSET})");
    let good = [
        number("a", "value = 3", "1 + 2", "identity"),
        number("b", "value = 3", &offset, "agrees"),
        number("c", "low = 0\nhigh = 20", &offset, "agrees"),
    ];
    let good = UserRows::new(&(SOURCES.to_owned() + &good.concat()));
    let (code, _, errors) = power(&good, &[]);
    assert_eq!((code, errors.as_str()), (Some(0), ""));
    let bad = [
        number("a", "value = 3", "1 + 2", "agrees"),
        number("b", "value = 3", &offset, "identity"),
    ];
    let bad = UserRows::new(&(SOURCES.to_owned() + &bad.concat()));
    let (code, _, errors) = power(&bad, &[]);
    assert_eq!(code, Some(1));
    assert_eq!(
        errors,
        format!(
            "cvtcycle: row a: `agrees` recorded, but no change of the cars reaches its number: `identity`\n\
             cvtcycle: row b: `identity` recorded, but {OFFSET} x0.6 makes it `differs`\n"
        )
    );
}

#[test]
fn table_and_csv_name_the_changes() {
    let own = UserRows::new(&(SOURCES.to_owned() + &rows()));
    let table = text(&own.run(&["--power", "--quiet"]).stdout);
    assert_eq!(table, "", "--quiet");
    let table = text(&own.run(&["--power"]).stdout);
    for words in [
        "Changes of the cars that flip a verdict",
        "Rows that nothing flips, by verdict",
        "moved set constant",
        &format!("{OFFSET} x0.6 (differs)"),
    ] {
        assert!(table.contains(words), "{words}: {table}");
    }
    let dir = own.dir.path().join("out");
    let output = own.run(&[
        "--power",
        "--format",
        "csv",
        "--out",
        &dir.to_string_lossy(),
    ]);
    let csv = text(&output.stdout);
    assert_eq!(csv, std::fs::read_to_string(dir.join("power.csv")).unwrap());
    let mut lines = csv.lines();
    assert_eq!(
        lines.next(),
        Some("id,group,verdict,recorded,power,flips,moved,flipped_by")
    );
    let weak =
        format!("weak,own,agrees,,weak,2,2,{OFFSET} x0.6 (differs); {OFFSET} x1.5 (differs)");
    assert_eq!(lines.next(), Some(weak.as_str()));
    let refused = own.run(&["--threads", "2"]);
    assert_eq!(refused.status.code(), Some(2), "threads are for --power");
}
