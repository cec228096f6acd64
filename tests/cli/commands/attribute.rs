//! `attribute`, and the prices printed by `run`.

use super::*;

/// Number at a path of names and indices.
fn at(value: &Value, path: &str) -> f64 {
    let found = value.pointer(path);
    found
        .and_then(Value::as_f64)
        .unwrap_or_else(|| panic!("{path}"))
}

/// Truth: two runs by hand. `attribute`, `run` and the difference of two runs with and without a factor agree to the bit.
#[test]
fn removal_is_the_difference_of_two_runs() {
    for (vehicle, kind) in [("rover_216_cvt", "cvt"), ("rover_216_5mt", "manual")] {
        let own = ["--vehicle", vehicle, "--ambient", "-10", "--json"];
        let base = json(&[&["run", "--baseline", "none"][..], &own].concat());
        let attributed = json(&[&["attribute", "--pairs", "none"][..], &own].concat());
        let price = &attributed["conditions"][0]["runs"][0]["price"];
        let of_run = &base["runs"][0]["price"];
        for name in keys(&price["losses"]) {
            let set = format!("transmission.{kind}.loss_factor.{name}=0");
            let words = [
                "run",
                "--baseline",
                "none",
                "--price",
                "never",
                "--set",
                &set,
            ];
            let without = json(&[&words[..], &own].concat());
            assert_eq!(without["runs"][0]["price"], Value::Null);
            let fuel = |run: &Value| at(run, "/runs/0/fuel_l_per_100km");
            let by_hand = fuel(&base) - fuel(&without);
            let path = format!("/losses/{name}/l_per_100km");
            assert_eq!(by_hand.to_bits(), at(price, &path).to_bits(), "{name}");
            assert_eq!(by_hand.to_bits(), at(of_run, &path).to_bits(), "{name}");
            let note = without["runs"][0]["notes"].to_string();
            assert!(note.contains(&format!("loss_factor.{name} = 0")), "{note}");
        }
        assert_eq!(price["together"], of_run["together"]);
        assert_eq!(price["interaction"], of_run["interaction"]);
    }
}

#[test]
fn tables_and_files_of_an_attribution() {
    let dir = tempfile::tempdir().unwrap();
    let words = "attribute --ambient -10,25 --cycle ece15_eudc --pairs all --shapley --by-phase --baseline rover_216_5mt --out prices";
    let output = run_in(dir.path(), &words.split(' ').collect::<Vec<_>>());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in [
        "rover_216_cvt at -10 degC, soak",
        "rover_216_5mt at 25 degC, soak",
        "Without its transmission losses it would burn",
        "interaction",
        "Pairs",
        "Shapley",
        "By part of the cycle",
        "by ambient temperature",
        "bearings and seals",
        "Files written in",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    let file = |name: &str| fs::read_to_string(dir.path().join("prices").join(name)).unwrap();
    let prices = file("attribution.csv");
    assert!(prices.starts_with("vehicle,ambient_degc,phase,component,group,loss_kj,energy_percent,saved_l_per_100km,saved_percent,alone_l_per_100km\n"));
    // For each car and ambient: its losses, all together, interaction; for the whole and both parts of the cycle.
    assert_eq!(prices.lines().count(), 1 + 2 * 3 * (12 + 2 + 5 + 2));
    assert_eq!(file("pairs.csv").lines().count(), 1 + 2 * (66 + 10));
    assert_eq!(file("shapley.csv").lines().count(), 1 + 2 * (5 + 4));
    let summary: Value = serde_json::from_str(&file("summary.json")).unwrap();
    assert_eq!(summary["conditions"][1]["ambient_degc"], 25.0);
    assert!(file("price_rover_216_cvt_-10.svg").contains("Fuel saved without the loss"));
}

#[test]
fn a_run_prints_the_price_of_its_losses() {
    let text = stdout(&run(&["run", "--ambient", "-10"]));
    for part in [
        "Without its transmission losses it would burn",
        "fuel saved if the loss were zero",
        "together",
        "interaction",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    let without = stdout(&run(&["run", "--ambient", "-10", "--price", "never"]));
    assert!(!without.contains("interaction") && without.contains("transmission total"));
}

#[test]
fn a_loss_factor_in_a_file_is_reported() {
    let dir = tempfile::tempdir().unwrap();
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("vehicles/rover_216_cvt.toml");
    let text =
        fs::read_to_string(shipped).unwrap() + "\n[transmission.cvt.loss_factor]\npump = 0.8\n";
    fs::write(dir.path().join("car.toml"), text).unwrap();
    let output = run_in(dir.path(), &["check", "car.toml"]);
    assert!(
        stdout(&output).contains("loss_factor.pump = 0.8"),
        "{}",
        stdout(&output)
    );
    let assumptions = stdout(&run(&["assumptions"]));
    assert!(!assumptions.contains("`transmission.cvt.loss_factor.pump`"));
}

#[test]
fn bad_inputs_of_an_attribution() {
    let message = refused(&[
        "attribute",
        "--factor",
        "1",
        "--ambient",
        "-50",
        "--pairs",
        "some",
        "--cycle",
        "ece15x",
        "--dt",
        "0",
    ]);
    for part in [
        "with a factor of 1 nothing would change",
        "-50",
        "one of large, all, none",
        "there is no cycle named `ece15x`",
        "--dt",
    ] {
        assert!(message.contains(part), "{part} is not in\n{message}");
    }
    for bad in ["-0.1", "nan", "6"] {
        assert!(refused(&["attribute", "--factor", bad]).contains("0 to 5"));
    }
    let message = refused(&["attribute", "--ambient", "-40..60:0.5"]);
    assert!(
        message.contains("201 ambient temperatures are too many"),
        "{message}"
    );
    let set = "transmission.cvt.loss_factor.belt_map=0.5";
    let message = refused(&["attribute", "--set", set]);
    assert!(message.contains("belt_map"), "{message}");
    let set = "transmission.cvt.loss_factor.pump=7";
    assert!(refused(&["run", "--set", set]).contains("0 to 5"));
}
