//! `fleet`: cars of a table.
//!
//! Truth: each car made by `new` and driven by `run`; the errors worked out by hand; refused rows by what is wrong in them.

use super::{json, run, stdout};
use std::fs;

/// Rows of a table of one's own: good ones, and one of each kind of bad row.
const TABLE: &str =
    "carid,mass [lb],f0,displacement,power,engine.electrical_w,hwfet_l_per_100km,note
good,3000,100,1.8l,104kW,400,5.5,x
other,1300kg,100,1800,140hp,,,x
double,3000,100,1.8l,104kW,,,x
double,3000,100,1.8l,104kW,,,x
,3000,100,1.8l,104kW,,,x
no_power,3000,100,1.8l,,,,x
no_mass,,100,1.8l,104kW,,,x
comma,\"3,000\",100,1.8l,104kW,,,x
no_unit,3000,100,1.8l,104,,,x
light,-5,100,1.8l,104kW,,,x
load,3000,100,1.8l,104kW,99999,,x
measured,3000,100,1.8l,104kW,,40mpg,x
mpg,3000,100,1.8l,104kW,,120,x
short,3000,100
";

fn table(text: &str) -> (tempfile::TempDir, String) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("cars.csv");
    fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap().to_owned();
    (dir, path)
}

#[test]
fn bad_rows_are_refused_by_name_and_the_rest_is_driven() {
    let (dir, path) = table(TABLE);
    let out = dir.path().join("out");
    let output = run(&[
        "fleet",
        &path,
        "--test",
        "hwfet",
        "--out",
        out.to_str().unwrap(),
        "--quiet",
    ]);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("column `note` is not read"), "{text}");
    let rows = csv::Reader::from_path(out.join("fleet.csv"))
        .unwrap()
        .into_records();
    let rows: Vec<csv::StringRecord> = rows.map(Result::unwrap).collect();
    assert_eq!(rows.len(), 14, "every row is in the file");
    let reason = |id: &str| {
        let of = rows.iter().filter(|row| &row[0] == id);
        of.map(|row| row[row.len() - 1].to_owned())
            .collect::<Vec<_>>()
            .join("|")
    };
    assert_eq!(
        (reason("good"), reason("other")),
        (String::new(), String::new())
    );
    assert_eq!(reason("double"), "|carid: an earlier row has this name");
    for (id, words) in [
        ("no_power", "power"),
        ("no_mass", "mass: the cell is empty"),
        ("comma", "decimal point"),
        ("no_unit", "unit"),
        ("light", "mass"),
        ("load", "engine.electrical_w"),
        ("measured", "hwfet_l_per_100km: `40mpg` is no number"),
        ("mpg", "another unit"),
    ] {
        assert!(reason(id).contains(words), "{id}: {}", reason(id));
    }
    let nameless: Vec<_> = rows
        .iter()
        .filter(|row| row[0].is_empty())
        .map(|row| row[row.len() - 1].to_owned())
        .collect();
    assert!(
        nameless.iter().any(|reason| reason.contains("no name")),
        "{nameless:?}"
    );
    assert!(
        nameless
            .iter()
            .any(|reason| reason == "3 cells in a table of 8 columns"),
        "{nameless:?}"
    );
}

#[test]
fn a_row_is_the_car_of_new() {
    let (dir, path) =
        table("carid,mass,displacement,power,engine.electrical_w\none,1300,1.8l,104kW,400\n");
    let out = dir.path().join("out");
    stdout(&run(&[
        "fleet",
        &path,
        "--test",
        "cold_ftp",
        "--out",
        out.to_str().unwrap(),
    ]));
    let car = dir.path().join("one.toml");
    let car = car.to_str().unwrap();
    stdout(&run(&[
        "new",
        "one",
        "--mass",
        "1300",
        "--displacement",
        "1.8l",
        "--power",
        "104kW",
        "--out",
        car,
    ]));
    // TE-2: 10 % more road load and 100 W of blower; the row's own load in place of the class's.
    let own = json(&[
        "run",
        "--vehicle",
        car,
        "--cycle",
        "ftp75",
        "--ambient",
        "-6.7",
        "--baseline",
        "none",
        "--price",
        "never",
        "--set",
        "engine.electrical_w=500",
        "--set",
        "road_load.load_factor=1.1",
        "--json",
    ]);
    let mut reader = csv::Reader::from_path(out.join("fleet.csv")).unwrap();
    let at = reader
        .headers()
        .unwrap()
        .iter()
        .position(|name| name == "cold_ftp_l_per_100km")
        .unwrap();
    let row = reader.records().next().unwrap().unwrap();
    let fuel: f64 = row[at].parse().unwrap();
    // TE-3 by hand: 43.2 MJ/kg of 0.745 kg/L against 31.78 MJ/L.
    let stated = 0.4 + 0.6 * 43.2 * 0.745 / 31.78;
    let truth = stated
        * own["runs"][0]["weighted_fuel_l_per_100km"]
            .as_f64()
            .unwrap();
    assert!((fuel - truth).abs() <= 5e-5, "{fuel} {truth}");
}

/// Errors of two cars whose measured fuel is the computed one and that over 1.1: 0 and 10 %, mean 5, rms sqrt(50).
#[test]
fn errors_by_hand() {
    let head = "carid,mass,displacement,power";
    let (dir, path) = table(&format!(
        "{head}\none,1300,1.8l,104kW\ntwo,1500,2.0l,110kW\n"
    ));
    let out = dir.path().join("out");
    stdout(&run(&[
        "fleet",
        &path,
        "--test",
        "hwfet",
        "--out",
        out.to_str().unwrap(),
    ]));
    let mut reader = csv::Reader::from_path(out.join("fleet.csv")).unwrap();
    let fuel: Vec<f64> = reader
        .records()
        .map(|row| row.unwrap()[2].parse().unwrap())
        .collect();
    let text = format!(
        "{head},hwfet_l_per_100km\none,1300,1.8l,104kW,{}\ntwo,1500,2.0l,110kW,{}\n",
        fuel[0],
        fuel[1] / 1.1
    );
    let (_dir, path) = table(&text);
    let found = json(&["fleet", &path, "--test", "hwfet", "--json"]);
    let errors = &found["errors"][0];
    let near = |name: &str, value: f64| {
        let own = errors[name].as_f64().unwrap();
        assert!((own - value).abs() < 2e-3, "{name} {own} {value}");
    };
    near("mean_percent", 5.0);
    near("rms_percent", 50.0_f64.sqrt());
    near("sd_percent", 50.0_f64.sqrt());
    near("within_5_percent", 50.0);
    assert_eq!(errors["worst_car"], "two");
}

/// The cars of the repository are all driven, none with a failed check in the city or on the highway.
#[test]
fn the_measured_cars_pass_their_tests() {
    let found = json(&[
        "fleet",
        "validation/fleet/us_cars.csv",
        "--map",
        "epa",
        "--test",
        "ftp75,hwfet",
        "--json",
    ]);
    assert_eq!(
        (found["driven"].as_u64(), found["refused"].as_u64()),
        (Some(88), Some(0))
    );
    assert_eq!(found["cars_with_failed_checks"].as_u64(), Some(0));
}

/// Truth: fuel that is 1 + 2 m in tonnes of mass, which the regression on the mass finds from any of the cars; the mean of the others does not.
#[test]
fn a_regression_finds_its_own_law() {
    let row = |k: usize| {
        let mass_kg = 1000 + 100 * k;
        let fuel = 1.0 + 2.0 * mass_kg as f64 / 1e3;
        format!("car{k},{mass_kg},1.8l,104kW,{fuel}\n")
    };
    let rows: String = (0..8).map(row).collect();
    let (_dir, path) = table(&format!(
        "carid,mass,displacement,power,hwfet_l_per_100km\n{rows}"
    ));
    let found = json(&["fleet", &path, "--test", "hwfet", "--quiet", "--json"]);
    let rms = |knows: &str| {
        let mut all = found["baselines"].as_array().unwrap().iter();
        let own = all.find(|own| own["knows"] == knows).unwrap();
        own["rms_percent"].as_f64().unwrap()
    };
    assert!(rms("mass") < 1e-6, "{}", rms("mass"));
    assert!(rms("mean") > 5.0, "{}", rms("mean"));
}

#[test]
fn a_table_or_a_map_that_is_none_is_refused() {
    let (dir, path) = table("name,mass\none,1300\n");
    let text = super::refused(&["fleet", &path]);
    assert!(text.contains("no column `carid`"), "{text}");
    let text = super::refused(&["fleet", &path, "--map", "epb"]);
    assert!(text.contains("there is no map named `epb`"), "{text}");
    let map = dir.path().join("map.toml");
    fs::write(&map, "id = \"name\"\n[new]\nmess = \"{mass}kg\"\n").unwrap();
    let text = super::refused(&["fleet", &path, "--map", map.to_str().unwrap()]);
    assert!(text.contains("no option `mess`"), "{text}");
    let (_dir, path) = table("carid,mass,mass\none,1300,1300\n");
    let text = super::refused(&["fleet", &path]);
    assert!(text.contains("two columns are named `mass`"), "{text}");
}

/// Cars on the highway with a column that an expression reads, one of them with an empty cell and one with a manual box.
const BY_COLUMN: &str = "carid,mass,displacement,power,box,make,seats,hwfet_l_per_100km
one,1300,1.8l,104kW,box_cvt_converter,A,2,5.6
two,1400,1.8l,104kW,box_cvt_converter,A,5,5.8
three,1500,2.0l,120kW,box_cvt_converter,B,4,6.4
four,1600,2.4l,125kW,box_cvt_converter,B,,7.0
five,1350,1.8l,104kW,box_manual_6,C,5,5.5
";

/// Fuel of the cars of a table on the highway by column of `fleet.csv`, with some options.
fn highway(path: &str, out: &std::path::Path, options: &[&str], column: &str) -> Vec<f64> {
    let words = [
        "fleet",
        path,
        "--test",
        "hwfet",
        "--by",
        "make,seats",
        "--force",
        "--out",
        out.to_str().unwrap(),
    ];
    stdout(&run(&[&words[..], options].concat()));
    let mut reader = csv::Reader::from_path(out.join("fleet.csv")).unwrap();
    let at = reader
        .headers()
        .unwrap()
        .iter()
        .position(|name| name == column)
        .unwrap();
    let rows = reader.records().map(Result::unwrap);
    rows.map(|row| row[at].parse().unwrap_or(f64::NAN))
        .collect()
}

/// Truth: the same values written in a column of the table; errors before and after by hand.
#[test]
fn an_expression_is_its_value_in_each_row() {
    let (dir, path) = table(BY_COLUMN);
    let out = dir.path().join("out");
    let fuel = "hwfet_l_per_100km";
    let set = ["--set", "engine.electrical_w = max(300, 100*seats) + 50"];
    let by_expression = highway(&path, &out, &set, fuel);
    let before = highway(&path, &out, &set, "hwfet_l_per_100km_before");
    let plain = highway(&path, &out, &[], fuel);
    assert_eq!(before, plain);
    let watts = [350, 550, 450, 0, 550];
    let text: String = BY_COLUMN
        .lines()
        .zip(
            ["engine.electrical_w".to_owned()]
                .into_iter()
                .chain(watts.map(|w| if w > 0 { w.to_string() } else { String::new() })),
        )
        .map(|(line, cell)| format!("{line},{cell}\n"))
        .collect();
    let (_own, other) = table(&text);
    let written = highway(&other, &out, &[], fuel);
    assert_eq!(by_expression, written);
    // A car with an empty cell keeps its value.
    assert_eq!(by_expression[3..4], plain[3..4]);
    assert!(
        by_expression[0] < plain[0] && by_expression[1] > plain[1],
        "522 W as made"
    );
    // FE-3 by hand, of the four CVT cars.
    let found = json(
        &[
            &[
                "fleet",
                &path,
                "--test",
                "hwfet",
                "--by",
                "make,seats",
                "--json",
            ][..],
            &set,
        ]
        .concat(),
    );
    let change = &found["changes"][0];
    let measured = [5.6, 5.8, 6.4, 7.0];
    let errors = |fuel: &[f64]| -> Vec<f64> {
        fuel.iter()
            .zip(measured)
            .map(|(f, m)| 100.0 * (f / m - 1.0))
            .collect()
    };
    let (first, second) = (errors(&plain[..4]), errors(&by_expression[..4]));
    let rms = |e: &[f64]| (e.iter().map(|x| x * x).sum::<f64>() / 4.0).sqrt();
    let mean = |e: &[f64]| e.iter().sum::<f64>() / 4.0;
    for (name, k, value) in [
        ("rms_percent", 0, rms(&first)),
        ("rms_percent", 1, rms(&second)),
        ("mean_percent", 0, mean(&first)),
        ("mean_percent", 1, mean(&second)),
    ] {
        let own = change[name][k].as_f64().unwrap();
        assert!((own - value).abs() < 2e-3, "{name} {k}: {own} {value}");
    }
    assert_eq!(
        (change["n"].as_u64(), change["cars"][1].as_u64()),
        (Some(4), Some(4))
    );
    // A key of the other box leaves the manual car as it is.
    let belt = highway(
        &path,
        &out,
        &[
            "--set",
            "transmission.cvt.pump.displacement_cc_rev *= 1 + seats/10",
        ],
        fuel,
    );
    assert_eq!(belt[4..], plain[4..]);
    assert!(belt[1] > plain[1]);
}

/// Property: what cannot be is one problem with the place, and what it may be.
#[test]
fn settings_and_fits_that_cannot_be_are_refused() {
    let (_dir, path) = table(BY_COLUMN);
    for (option, value, words) in [
        (
            "--set",
            "engine.electrical_w = 100*seat",
            "the column `seat` is not known",
        ),
        (
            "--set",
            "engine.electrical = 100*seats",
            "unknown key `engine.electrical`",
        ),
        (
            "--set",
            "engine.electrical_w = seats > 2",
            "gives a condition, not a number",
        ),
        ("--set", "engine.electrical_w = 100*(seats", "expected"),
        ("--set", "engine.electrical_w = max(rig: seats)", "rig"),
        (
            "--fit",
            "engine.electrical",
            "unknown key `engine.electrical`",
        ),
        ("--fit", "engine.model", "holds no single number"),
        ("--fit", "engine.electrical_w=600..400", "no range"),
        ("--fit", "engine.electrical_w=0..9000", "no range"),
        ("--by", "seat", "no column `seat`"),
    ] {
        let output = run(&["fleet", &path, "--test", "hwfet", option, value]);
        assert_eq!(output.status.code(), Some(2), "{option} {value}");
        let text = String::from_utf8(output.stderr).unwrap();
        assert!(
            text.contains(words) && text.contains("1 problem"),
            "{option} {value}: {text}"
        );
    }
    let words = [
        "fleet",
        &path,
        "--test",
        "hwfet",
        "--fit",
        "engine.electrical_w",
        "--leave-out",
        "none",
    ];
    assert_eq!(run(&words).status.code(), Some(2));
    // A cell that is no number refuses its row.
    let output = run(&[
        "fleet",
        &path,
        "--test",
        "hwfet",
        "--set",
        "engine.electrical_w = 100*make",
    ]);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(
        text.contains("`A` in the column make is no number"),
        "{text}"
    );
}

/// Truth: measured fuel that is the computed one with 450 W. The fit finds it, with all cars and without each group, whose prediction is then without error.
#[test]
fn a_fit_finds_the_value_that_the_measurements_were_made_with() {
    let (dir, path) = table(BY_COLUMN);
    let out = dir.path().join("out");
    let made = highway(
        &path,
        &out,
        &["--set", "engine.electrical_w=450"],
        "hwfet_l_per_100km",
    );
    let rows = BY_COLUMN.lines().skip(1).zip(&made);
    let rows = rows.map(|(line, fuel)| format!("{},{fuel}\n", line.rsplit_once(',').unwrap().0));
    let head = BY_COLUMN.lines().next().unwrap();
    let (_own, path) = table(&format!("{head}\n{}", rows.collect::<String>()));
    let words = [
        "fleet",
        &path,
        "--test",
        "hwfet",
        "--fit",
        "engine.electrical_w=300..700",
        "--by",
        "seats",
        "--leave-out",
        "make",
    ];
    let text = stdout(&run(&words));
    assert!(text.contains("all, each group by the others"), "{text}");
    let found = json(&[&words[..], &["--json"]].concat())["fit"].clone();
    let near = |x: &serde_json::Value, value: f64, by: f64| {
        let own = x.as_f64().unwrap();
        assert!((own - value).abs() < by, "{own} {value}: {found}");
    };
    near(&found["values"][0], 450.0, 2.0);
    near(&found["before"][0], 522.0, 1e-9);
    assert!(
        found["as_made"]["rms_percent"].as_f64().unwrap() > 0.3,
        "{found}"
    );
    let groups = found["groups"].as_array().unwrap();
    assert_eq!(groups.len(), 3);
    for group in groups {
        near(&group["values"][0], 450.0, 2.0);
        near(&group["predicted"]["rms_percent"], 0.0, 0.02);
    }
    near(&found["predicted"]["rms_percent"], 0.0, 0.02);
    // Bounds hold: with the least load out of reach the fit ends on it, and says so.
    let words = [
        "fleet",
        &path,
        "--test",
        "hwfet",
        "--fit",
        "engine.electrical_w=500..700",
        "--by",
        "seats",
        "--leave-out",
        "make",
    ];
    let text = stdout(&run(&words));
    assert!(
        text.contains("at an end of its range: engine.electrical_w"),
        "{text}"
    );
}

/// Truth: the numbers of `pairs.csv` and `fleet.csv`, which the tables of the pictures repeat; the twin by `run --baseline twin`.
#[test]
fn pictures_and_twins_of_a_fleet() {
    let head = "carid,mass,displacement,power,box,manual_carid,make,hwfet_l_per_100km";
    let (dir, path) = table(&format!(
        "{head}\none,1300,1.8l,104kW,box_cvt_converter,two,A,5.6\ntwo,1280,1.8l,104kW,box_manual_5,,A,5.9\n"
    ));
    let out = dir.path().join("out");
    stdout(&run(&[
        "fleet",
        &path,
        "--test",
        "hwfet",
        "--by",
        "make",
        "--out",
        out.to_str().unwrap(),
    ]));
    for (file, words) in [
        ("errors_by_make.svg", "Error by make"),
        (
            "errors_over_n_over_v.svg",
            "Error by engine speed over road speed",
        ),
        ("pairs.svg", "Difference to the same car with a manual box"),
    ] {
        let svg = fs::read_to_string(out.join(file)).unwrap();
        assert!(svg.contains(words) && !svg.contains("NaN"), "{file}");
    }
    let mut reader = csv::Reader::from_path(out.join("pairs.csv")).unwrap();
    let row = reader.records().next().unwrap().unwrap();
    let number = |k: usize| row[k].parse::<f64>().unwrap();
    assert!((number(3) - 100.0 * (5.6 / 5.9 - 1.0)).abs() < 1e-3);
    let car = dir.path().join("one.toml");
    let car = car.to_str().unwrap();
    let new = [
        "new",
        "one",
        "--mass",
        "1300",
        "--displacement",
        "1.8l",
        "--power",
        "104kW",
        "--box",
        "box_cvt_converter",
        "--out",
        car,
    ];
    stdout(&run(&new));
    let words = [
        "run",
        "--vehicle",
        car,
        "--baseline",
        "twin",
        "--cycle",
        "hwfet",
        "--ambient",
        "24",
        "--start",
        "warm",
        "--price",
        "never",
        "--json",
    ];
    let twin = json(&words)["comparison"][0]["fuel_percent"]
        .as_f64()
        .unwrap();
    assert!((number(6) - twin).abs() < 1e-3, "{} {twin}", number(6));
}
