//! Users' own rows.

use super::*;

const SOURCES: &str = r#"
[tolerances.wide]
width = 100
from = "test"

[sources.box]
source = "bench"
ratio = [2.4, 1.0]
speed_rpm = "1000..2000:500"
temp_degc = 80

[sources.colder]
like = "box"
temp_degc = 20
set = ["lubricant.friction.band=0.1"]

[sources.grip]
source = "belt"
ratio = 2.4
speed_rpm = 2000
pressure_bar = 10
torque_nm = [20, 2000]

[sources.trip]
source = "run"
points = [[0, 0], [10, 30], [60, 30]]

[sources.oil]
source = "fluid"
temp_degc = [40, 100]
"#;

#[test]
fn users_rows_reach_every_source() {
    let wide = "low = -1000\nhigh = 1000\ntolerance = \"wide\"\ncompute = ";
    let computes = [
        ("bench", "count(box: total_nm > 0)"),
        (
            "like",
            "one(colder: total_nm where ratio == 1 and speed_rpm == 1500) - one(box: total_nm where ratio == 1 and speed_rpm == 1500)",
        ),
        ("belt", "max(grip: torque_nm)"),
        ("run", "100 * total(trip: fuel_kg)"),
        ("fluid", "one(oil: kinematic_mm2_s where temp_degc == 100)"),
        ("key", "key(transmission.cvt.belt.band_offset_mm)"),
    ];
    let rows: String = computes
        .iter()
        .map(|(id, compute)| row(id, &format!("{wide}\"{compute}\"")))
        .collect();
    let own = UserRows::new(&(SOURCES.to_owned() + &rows));
    let output = own.run(&["--json"]);
    let all: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    let computed = |k: usize| all["rows"][k]["computed_low"].as_f64().unwrap();
    assert!(
        (computed(0) - 6.0).abs() < 1e-12,
        "two ratios, three speeds: {}",
        computed(0)
    );
    assert!(
        computed(1).abs() > 0.1,
        "another temperature and friction: {}",
        computed(1)
    );
    assert!(
        (computed(2) - 20.0).abs() < 1e-12,
        "2000 Nm are gross slip: {}",
        computed(2)
    );
    assert_eq!(all["rows"][2]["gross_slip_left_out"], 1);
    assert!(computed(3) > 0.0);
    assert!(
        (computed(4) - 7.2).abs() < 1e-9,
        "the shipped fluid's KV100: {}",
        computed(4)
    );
    assert!((computed(5) - 3.0).abs() < 1e-12);
    // User's vehicle file in the folder of the rows.
    let car = include_str!("../../../vehicles/rover_216_cvt.toml").replace(
        "band_offset_mm = { value = 3.0",
        "band_offset_mm = { value = 2.0",
    );
    let of_car = row(
        "own",
        &format!("{wide}\"key(mine: transmission.cvt.belt.band_offset_mm)\""),
    );
    let mine = UserRows::new(&format!(
        "{SOURCES}\n[sources.mine]\nsource = \"vehicle\"\nvehicle = \"car.toml\"\n{of_car}"
    ));
    std::fs::write(mine.dir.path().join("car.toml"), car).unwrap();
    let output = mine.run(&["--json"]);
    let found: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    assert!((found["rows"][0]["computed_low"].as_f64().unwrap() - 2.0).abs() < 1e-12);
    let added = cvtcycle(&["validate", "--json", "--rows", &own.path()]);
    let added: Value = serde_json::from_slice(&added.stdout).unwrap();
    assert!(added["rows"].as_array().unwrap().len() > 100);
}

#[test]
fn all_problems_of_a_file_are_named_at_once() {
    let bad = r#"
[tolerances.both]
width = 1
share = 0.1
from = "x"

[sources.odd]
source = "bnch"

[sources.bare]
source = "bench"
ratio = "4..2"

[sources.lost]
like = "no_such_form"
"#;
    let rows = [
        row("a", "value = 3\ncompute = \"1 + max(lwo: y)\""),
        row(
            "b",
            "value = 3\ntolerance = \"exct\"\ncompute = \"max(low: totl_nm)\"",
        ),
        row(
            "c",
            "value = 3\ntolerance = \"exact\"\ncompute = \"3\"\nverdict = \"differs\"",
        ),
        row("d", "verdict = \"not comparable\""),
        row(
            "e",
            "value = 3\ntolerance = \"exact\"\ncompute = \"3\"\nverdict = \"agree\"\nfitted_to = [\"pump.size\"]",
        ),
        row("f", "compute = \"3\"\nuint = \"Nm\""),
        row("a", "compute = \"3 > 2\""),
        row(
            "g",
            "low = 4\nhigh = 3\ntolerance = \"exact\"\ncompute = \"3 > 2\"",
        ),
        row(
            "h",
            "value = 3\ntolerance = \"totals\"\nunit = \"bar\"\ncompute = \"3\"",
        ),
    ];
    let own = UserRows::new(&(bad.to_owned() + &rows.concat()));
    let output = own.run(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    let said = text(&output.stderr);
    for part in [
        "needs either `width` or `share`",
        "`bnch` is not known for `sources.odd.source`",
        "`4..2` is no range",
        "no such source to continue",
        "row a: `compute`: the source `lwo` is not known",
        "row a: missing key `tolerance`",
        "there is no tolerance `exct`",
        "the column `totl_nm` is not known",
        "did you mean `total_nm`",
        "row c: the verdict needs a reason",
        "needs its computed cause",
        "row d: the verdict needs a reason",
        "`agree` is not known for `verdict`",
        "there is no parameter `pump.size`",
        "row f: unknown key `uint`",
        "but none is printed",
        "the id `a` was used before",
        "`low` is above `high`",
        "but a number is printed",
        "tolerance `totals` is in Nm, the row in bar",
        "own.toml:",
    ] {
        assert!(said.contains(part), "`{part}` is not in\n{said}");
    }
}

#[test]
fn a_row_without_a_value_has_its_own_verdict() {
    let wide = "low = 0\ntolerance = \"wide\"\ncompute = ";
    for (compute, why) in [
        ("one(box: total_nm)", "6 rows where one was expected"),
        (
            "max(grip: slip_percent where torque_nm == 2000)",
            "gross slip",
        ),
        (
            "key(transmission.manual.neutral_share)",
            "has no `transmission.manual.neutral_share`",
        ),
    ] {
        let rows = row("a", &format!("{wide}\"{compute}\"")) + &row("b", &format!("{wide}\"3\""));
        let own = UserRows::new(&(SOURCES.to_owned() + &rows));
        let output = own.run(&["--json"]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{compute}: {said}");
        assert!(
            said.contains("row a: `not computed`") && said.contains(why),
            "{compute}: {said}"
        );
        let all: Value = serde_json::from_slice(&output.stdout).unwrap();
        let verdicts = [0, 1].map(|k| all["rows"][k]["verdict"].as_str());
        assert_eq!(verdicts, [Some("not computed"), Some("agrees")]);
        assert!(all["rows"][0]["failure"].as_str().unwrap().contains(why));
        assert!(all["rows"][0]["computed_low"].is_null());
        assert_eq!(all["counts"]["not_computed"], 1);
        let page = text(&own.run(&["--format", "html"]).stdout);
        assert!(page.contains("1 cannot be computed for this") && page.contains(why));
    }
    // A `cause` without a value leaves the verdict unchanged.
    let cause = "verdict = \"differs\"\nreason = \"so.\"\ncause = { what = \"none\", compute = \"one(box: total_nm)\" }";
    let three = "value = 4\ntolerance = \"exact\"\ncompute = \"3\"\n";
    let own = UserRows::new(&(SOURCES.to_owned() + &row("a", &format!("{three}{cause}"))));
    let output = own.run(&["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let all: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(all["rows"][0]["verdict"], "differs");
    assert!(all["rows"][0]["cause_failure"].is_string());
    assert!(text(&own.run(&[]).stdout).contains("none cannot be computed: 6 rows"));
    let own = UserRows::new(&format!(
        "{SOURCES}\n[sources.worse]\nlike = \"box\"\nset = [\"transmission.cvt.belt.band_ofset_mm=3\"]\n"
    ));
    let output = own.run(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("source `worse`: ")
            && text(&output.stderr).contains("band_offset_mm"),
        "{}",
        text(&output.stderr)
    );
}

/// A ratio out of range is computed and flagged.
#[test]
fn points_outside_validity_are_reported() {
    let source =
        "[sources.b]\nsource = \"bench\"\nratio = [2.4, 2.9]\nspeed_rpm = 2000\ntemp_degc = 80\n";
    let own = UserRows::new(
        &(source.to_owned()
            + &row(
                "a",
                "low = 0\ncompute = \"mean(b: total_nm)\"\ntolerance = \"exact\"",
            )),
    );
    let message: Value = serde_json::from_slice(&own.run(&["--json"]).stdout).unwrap();
    assert_eq!(message["rows"][0]["outside_validity"], 1, "{message}");
    assert!(text(&own.run(&[]).stdout).contains("1 points outside the validity"));
}
