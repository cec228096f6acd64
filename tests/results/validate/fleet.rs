//! Fleets, groups, and rows without a value for the vehicle. Truth: means, deviations and counts computed here from `validation/outside`.

use super::*;
use std::collections::BTreeMap;

type Line = BTreeMap<String, String>;

/// Lines of a file in `validation/outside`.
fn lines(name: &str) -> Vec<Line> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("validation/outside")
        .join(name);
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(file)
        .unwrap();
    let names = reader.headers().unwrap().clone();
    let line = |record: csv::StringRecord| {
        let cells = names.iter().zip(record.iter());
        cells
            .map(|(name, cell)| (name.to_owned(), cell.to_owned()))
            .collect()
    };
    reader.records().map(Result::unwrap).map(line).collect()
}

fn number(line: &Line, name: &str) -> f64 {
    line[name].parse().unwrap()
}

/// Mean, standard deviation of a single value, and count.
fn fleet(numbers: &[f64]) -> [f64; 3] {
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    let squares: f64 = numbers.iter().map(|x| (x - mean).powi(2)).sum();
    [mean, (squares / (n - 1.0)).sqrt(), n]
}

/// First bag over third, for a transmission type at an ambient temperature.
fn first_over_third(kind: &str, ambient: &str) -> [f64; 3] {
    let tests = lines("us_ftp_bags.csv");
    let own = tests
        .iter()
        .filter(|t| t["box"] == kind && t["ambient_degc"] == ambient);
    let bag = |t: &Line, k: u8| number(t, &format!("bag{k}_l_per_100km"));
    fleet(
        &own.map(|t| 100.0 * (bag(t, 1) / bag(t, 3) - 1.0))
            .collect::<Vec<_>>(),
    )
}

/// Bag at -6.7 over 24 degC, for the engines of a transmission type tested at both.
fn cold_over_mild(kind: &str, bag: char) -> [f64; 3] {
    let tests = lines("us_ftp_bags.csv");
    let key = |t: &Line| ["make", "displacement_l", "rated_hp"].map(|name| t[name].clone());
    let own = |ambient: &str| -> BTreeMap<[String; 3], f64> {
        let own = tests
            .iter()
            .filter(|t| t["box"] == kind && t["ambient_degc"] == ambient);
        own.map(|t| (key(t), number(t, &format!("bag{bag}_l_per_100km"))))
            .collect()
    };
    let (cold, mild) = (own("-6.7"), own("24"));
    let both = cold
        .iter()
        .filter_map(|(key, cold)| Some(100.0 * (cold / mild.get(key)? - 1.0)));
    fleet(&both.collect::<Vec<_>>())
}

/// Column of the starts at 21 to 32 degC.
fn starts(column: &str) -> [f64; 3] {
    let starts = lines("engine_starts_driving.csv");
    let is_mild = |s: &&Line| (21.0..=32.0).contains(&number(s, "coolant_at_start_degc"));
    fleet(
        &starts
            .iter()
            .filter(is_mild)
            .map(|s| number(s, column))
            .collect::<Vec<_>>(),
    )
}

/// Differences of pairs with front drive, of the early years or of those from 2012 with equal stop-start.
fn pairs(column: &str, is_early: bool) -> [f64; 3] {
    let pairs = lines("cvt_manual_pairs.csv");
    let is_meant = |p: &&Line| {
        let year = number(p, "year");
        let equal = p["cvt_startstop"] == p["manual_startstop"];
        p["drive"].starts_with("Front")
            && if is_early {
                year <= 2003.0
            } else {
                year >= 2012.0 && equal
            }
    };
    fleet(
        &pairs
            .iter()
            .filter(is_meant)
            .map(|p| number(p, column))
            .collect::<Vec<_>>(),
    )
}

/// Recomputes a fleet from the data that a row cites.
fn truth(data: &str) -> [f64; 3] {
    let word = |after: &str| {
        let rest = data.split_once(after).map(|(_, rest)| rest);
        rest.and_then(|rest| rest.split([',', ':', ' ']).next())
            .unwrap_or_default()
    };
    let column = data.rsplit(' ').next().unwrap();
    match data.split(':').next().unwrap() {
        "us_ftp_bags.csv" if data.contains("both ambients") => {
            cold_over_mild(word("box "), word("(bag ").chars().next().unwrap())
        }
        "us_ftp_bags.csv" => first_over_third(word("box "), word("ambient ")),
        "engine_starts_driving.csv" => starts(column),
        "cvt_manual_pairs.csv" => pairs(column, data.contains("up to 2003")),
        other => panic!("{other}"),
    }
}

#[test]
fn val_fleets_are_those_of_their_data() {
    let (_, all) = json(&["validate", "--chapter", "outside", "--json"]);
    let rows = all["rows"].as_array().unwrap();
    let fleets: Vec<&Value> = rows.iter().filter(|row| row["kind"] == "F").collect();
    assert!(fleets.len() > 25, "{}", fleets.len());
    for row in fleets {
        let data = row["data"].as_str().unwrap();
        let found = ["mean", "sd", "n"].map(|name| row[name].as_f64().unwrap());
        for (found, want) in found.into_iter().zip(truth(data)) {
            let digit = 10f64.powi(want.abs().log10().floor() as i32 - 3).max(0.005);
            assert!(
                (found - want).abs() <= 1.001 * digit.max(0.005),
                "{}: {found} instead of {want}: {data}",
                row["id"]
            );
        }
        // One more car compared with the mean of n.
        let [mean, sd, n] = found;
        let z = (row["computed_low"].as_f64().unwrap() - mean) / (sd * (1.0 + 1.0 / n).sqrt());
        assert!(
            (z - row["z"].as_f64().unwrap()).abs() < 1e-9,
            "{}",
            row["id"]
        );
        let agrees = row["verdict"] == "agrees" || row["verdict"] == "fit";
        assert_eq!(agrees, z.abs() <= 1.0, "{}: {z}", row["id"]);
    }
}

fn fleet_row(more: &str) -> String {
    row("a", &format!("kind = \"F\"\n{more}"))
}

/// 4 of 5 standard deviations 2 and 16 cars: 2 sqrt(17/16) = 2.0616 agree with z up to 1.
#[test]
fn the_verdict_of_a_fleet() {
    for (x, z, verdict) in [
        ("7.06", "", "agrees"),
        ("7.07", "", "differs"),
        ("2.93", "", "differs"),
        ("9.12", "z = 2", "agrees"),
    ] {
        let more = format!("mean = 5\nsd = 2\nn = 16\n{z}\ncompute = \"{x}\"");
        let output = UserRows::new(&fleet_row(&more)).run(&["--json"]);
        let all: Value = serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
        assert_eq!(all["rows"][0]["verdict"], verdict, "{x} {z}");
        assert_eq!(all["rows"][0]["group"], "own");
    }
    for (more, message) in [
        ("mean = 5\ncompute = \"3\"", "`mean`, `sd` and `n`"),
        (
            "mean = 5\nsd = 2\nn = 16\nvalue = 3\ncompute = \"3\"",
            "a fleet with `value`",
        ),
        (
            "mean = 5\nsd = 2\nn = 16\ncompute = \"3 > 2\"",
            "gives yes or no",
        ),
    ] {
        let output = UserRows::new(&fleet_row(more)).run(&[]);
        let said = text(&output.stderr);
        assert!(
            output.status.code() == Some(2) && said.contains(message),
            "{said}"
        );
    }
    let output = UserRows::new(&row("a", "mean = 5\nsd = 2\nn = 3\ncompute = \"3\"")).run(&[]);
    assert!(text(&output.stderr).contains("belong to a fleet"));
}

/// A row without a value for this vehicle gets a verdict of its own; the others keep theirs.
#[test]
fn one_row_without_a_value_leaves_the_others_unchanged() {
    let missing = "compute = \"key(transmission.manual.neutral_share) > 0\"";
    let own = UserRows::new(&(row("a", missing) + &row("b", "compute = \"2 > 1\"")));
    let output = own.run(&["--json"]);
    let all: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    assert_eq!(output.status.code(), Some(1));
    let verdicts = [0, 1].map(|k| all["rows"][k]["verdict"].clone());
    assert_eq!(verdicts, ["not computed", "agrees"]);
    let failed = all["rows"][0]["failure"].as_str().unwrap();
    assert!(
        failed.contains("has no `transmission.manual.neutral_share`"),
        "{failed}"
    );
    assert!(text(&own.run(&[]).stdout).contains("has no `transmission"));
    // Friction at which the cause of one row has no value: all rows have a verdict.
    let (code, all) = json(&[
        "validate",
        "--json",
        "--set",
        "lubricant.friction.band=0.195",
    ]);
    let (_, shipped) = json(&["validate", "--json"]);
    let count = |all: &Value| all["rows"].as_array().unwrap().len();
    assert_eq!((code, count(&all)), (Some(1), count(&shipped)));
}

/// A row recorded as an identity remains one while it holds, is counted separately, and differs when it fails.
#[test]
fn identities_count_apart() {
    let rows = row("a", "compute = \"2 > 1\"\nverdict = \"identity\"")
        + &row("b", "compute = \"2 < 1\"\nverdict = \"identity\"")
        + &row("c", "compute = \"2 > 1\"");
    let output = UserRows::new(&rows).run(&["--json"]);
    let all: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(all["moved"], serde_json::json!(["b"]));
    let own = &all["groups"]["own"];
    assert_eq!(
        (&own["counts"]["identity"], &own["counts"]["agrees"]),
        (&1.into(), &1.into())
    );
    assert_eq!(own["held_out"]["rows"], 1);
}
