//! `study`: what it prints of a design.

use super::*;

/// Truth: the run of one cell by hand.
#[test]
fn a_grid_of_two_factors_prints_its_matrix() {
    let dir = tempfile::tempdir().unwrap();
    let output = run_in(
        dir.path(),
        &["study", "pump_and_offset", "--out", "grid", "--json"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let fuel = found["outputs"]
        .as_array()
        .unwrap()
        .iter()
        .find(|o| o["output"] == "headline_fuel_l_per_100km" && o["car"] == "rover_216_cvt");
    let matrix = &fuel.unwrap()["matrix"];
    let words = |name: &str| matrix[name].as_array().unwrap().clone();
    assert_eq!((words("rows").len(), words("columns").len()), (5, 7));
    assert!(
        words("columns")[1].as_str().unwrap().starts_with("2 "),
        "{:?}",
        words("columns")
    );
    let sets = [
        "transmission.cvt.pump.displacement_cc_rev=7",
        "transmission.cvt.belt.band_offset_mm=2",
    ];
    let by_hand = json(&[
        "run",
        "--ambient",
        "-10",
        "--baseline",
        "none",
        "--price",
        "never",
        "--json",
        "--set",
        sets[0],
        "--set",
        sets[1],
    ]);
    let by_hand = by_hand["runs"][0]["fuel_l_per_100km"].as_f64().unwrap();
    let cell = matrix["cells"][1][1].as_f64().unwrap();
    assert!((cell / by_hand - 1.0).abs() < 1e-12, "{cell} {by_hand}");
    let shown = stdout(&run_in(dir.path(), &["study", "show", "grid"]));
    assert!(
        shown.contains(&format!("{by_hand:.3}")) && shown.contains("* least"),
        "{shown}"
    );
    let file = fs::read_to_string(dir.path().join("grid/matrix.csv")).unwrap();
    assert!(file.starts_with("output,unit,car,row_factor,row,column_factor,column,value\n"));
    assert_eq!((file.lines().count() - 1) % 35, 0);
}

/// Truth: two runs by hand at one temperature. The answer of the shipped plan is one matrix, with the least of each temperature marked, and it
/// says that no friction of the oils was known.
#[test]
fn the_plan_of_three_fluids_is_one_matrix() {
    let output = run(&["study", "fluids_by_ambient", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let matrix = &found["outputs"][0]["matrix"];
    assert_eq!(found["outputs"][0]["output"], "subject_excess_percent");
    let words = |name: &str| -> Vec<&str> {
        let list = matrix[name].as_array().unwrap();
        list.iter().map(|word| word.as_str().unwrap()).collect()
    };
    assert_eq!(
        words("columns"),
        ["cvtf_ezl799_class", "dexron_ii", "dexron_iii"]
    );
    let ambients = words("rows");
    assert!(ambients.len() == 8 && ambients[0].starts_with("-30") && ambients[7].starts_with("40"));
    assert_eq!(matrix["least_of"], "row");
    assert_eq!(matrix["least"].as_array().unwrap().len(), 8);
    let fuel = |oil: &[&str]| {
        let words = [
            &[
                "run",
                "--ambient",
                "-20",
                "--baseline",
                "none",
                "--price",
                "never",
                "--json",
            ],
            oil,
        ];
        json(&words.concat())["runs"][0]["fuel_l_per_100km"]
            .as_f64()
            .unwrap()
    };
    let by_hand = 100.0 * (fuel(&["--lubricant", "dexron_iii"]) / fuel(&[]) - 1.0);
    let cell = matrix["cells"][1][2].as_f64().unwrap();
    assert!((cell - by_hand).abs() < 1e-9, "{cell} {by_hand}");
    // Its own oil against itself.
    assert!(
        matrix["cells"]
            .as_array()
            .unwrap()
            .iter()
            .all(|row| row[0].as_f64() == Some(0.0))
    );
    let note = found["notes"][0].as_str().unwrap();
    assert!(
        note.contains("has the friction of the vehicle's own one"),
        "{note}"
    );
    let shown = stdout(&run(&["study", "fluids_by_ambient"]));
    assert!(
        shown.contains("* least of its row") && shown.contains("note: oil: "),
        "{shown}"
    );
}
