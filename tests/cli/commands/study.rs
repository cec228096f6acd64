//! `study`: printed results of each design.

use super::*;

/// Truth: one cell driven by `run`.
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
    assert!(
        file.starts_with("output,unit,car,row_factor,row,column_factor,column,value,low,high\n")
    );
    assert_eq!((file.lines().count() - 1) % 35, 0);
}

/// Truth: two runs at one temperature. The shipped plan prints one matrix with the minimum of each temperature marked, and notes which friction
/// was not measured with the oils.
#[test]
fn the_plan_of_five_fluids_is_one_matrix() {
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
        [
            "cvtf_ezl799_class",
            "dexron_ii",
            "dexron_iii",
            "cvt_blend_low_friction",
            "cvt_blend_high_friction"
        ]
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
    // GF-1 once more: each contact alone at the ends of what is known of it, the root of the sum of the squares. The reference has no range.
    let place = |contact: &str, place: &str| {
        let set = format!("lubricant.friction.{contact}.place={place}");
        100.0 * (fuel(&["--lubricant", "dexron_iii", "--set", &set]) / fuel(&[]) - 1.0) - by_hand
    };
    let mut sums = [0.0_f64; 2];
    for contact in ["bands", "micro_slip", "macro_slip"] {
        let ends = ["-1", "1"].map(|end| place(contact, end));
        let least = ends.into_iter().fold(0.0, f64::min);
        let largest = ends.into_iter().fold(0.0, f64::max);
        sums = [sums[0] + least * least, sums[1] + largest * largest];
    }
    let end = |oil: usize, k: usize| matrix["ends"][1][oil][k].as_f64().unwrap();
    assert!((end(2, 0) - (by_hand - sums[0].sqrt())).abs() < 1e-9);
    assert!((end(2, 1) - (by_hand + sums[1].sqrt())).abs() < 1e-9);
    assert!(end(2, 0) < cell && cell < end(2, 1));
    assert_eq!([end(0, 0), end(0, 1)].map(f64::to_bits), [0; 2]);
    let notes = found["notes"].as_array().unwrap();
    let of_two = "oil dexron_ii, dexron_iii: friction not measured with this fluid: bands";
    assert!(
        notes
            .iter()
            .any(|note| note.as_str().unwrap().starts_with(of_two))
    );
    // The car's own oil as the replacement.
    assert!(
        matrix["cells"]
            .as_array()
            .unwrap()
            .iter()
            .all(|row| row[0].as_f64() == Some(0.0))
    );
    // The blends have friction of their own on pulleys, so that the comparison moves more than viscosity.
    let notes: Vec<&str> = notes.iter().filter_map(Value::as_str).collect();
    let own = "has the friction of the vehicle's own one";
    assert!(!notes.iter().any(|note| note.contains(own)), "{notes:?}");
    let of_blends = "oil cvt_blend_low_friction, cvt_blend_high_friction: friction not measured";
    let blends = notes.iter().find(|note| note.starts_with(of_blends));
    let blends = blends.unwrap_or_else(|| panic!("{notes:?}"));
    assert!(blends.contains("bands on shoulders") && !blends.contains("pulleys"));
    let shown = stdout(&run(&["study", "fluids_by_ambient"]));
    assert!(
        shown.contains("* least of its row") && shown.contains("note: oil "),
        "{shown}"
    );
}

/// Plan of 64 points.
const SHARED: &str = "[study]\ncycle = \"ece15\"\nbaselines = []\ndesign = \"grid\"\n[[factor]]\nkey = \"ambient_degc\"\n\
    range = { from = -10, to = 53, step = 1 }\n";

/// Property: merged shards equal the study of one process byte for byte. Missing, duplicate, foreign or damaged parts are named, and
/// nothing is written.
#[test]
fn shards_make_the_study_of_one_process() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    fs::write(at("plan.toml"), SHARED).unwrap();
    let all = |line: &str| run_in(dir.path(), &words(line));
    let good = |line: &str| assert_eq!(all(line).status.code(), Some(0), "{line}");
    good("study plan.toml --out whole --quiet");
    good("study plan.toml --out s_0 --shard 0/3 --quiet");
    good("study plan.toml --out s_1 --shard 1/3 --quiet");
    let refused = |line: &str, says: &[&str]| {
        let output = all(line);
        assert_eq!(output.status.code(), Some(2), "{line}");
        for words in says {
            assert!(
                stderr(&output).contains(words),
                "{line}: {}",
                stderr(&output)
            );
        }
        assert!(!at("merged").exists(), "{line}");
    };
    refused(
        "study merge merged s_0 s_1",
        &["11 of 32 parts are in no shard: 21..32"],
    );
    good("study plan.toml --out s_2 --parts 21..32 --quiet");
    refused(
        "study merge merged s_0 s_1 s_2 s_0",
        &["s_0 is named twice"],
    );
    refused("study merge merged s_0 s_1 s_2 nothing", &["nothing"]);
    fs::write(at("other.toml"), SHARED.replace("ece15", "eudc")).unwrap();
    good("study other.toml --out foreign --parts 0..1 --quiet");
    refused(
        "study merge merged s_0 s_1 s_2 foreign",
        &["foreign", "another one", "cycle"],
    );
    let part = at("s_2/parts/runs_00030.parquet");
    let bytes = fs::read(&part).unwrap();
    fs::write(&part, &bytes[1..]).unwrap();
    refused(
        "study merge merged s_0 s_1 s_2",
        &["part 30 in s_2 is damaged"],
    );
    fs::write(&part, bytes).unwrap();
    good("study merge merged s_2 s_0 s_1 --quiet");
    for folder in ["", "parts"] {
        for entry in fs::read_dir(at("whole").join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                let own = at("merged").join(folder).join(path.file_name().unwrap());
                assert!(
                    fs::read(&path).unwrap() == fs::read(&own).unwrap(),
                    "{own:?}"
                );
            }
        }
    }
    for bad in ["--shard 3/3", "--shard x", "--parts 5..4", "--parts 0..33"] {
        let line = format!("study plan.toml --out no {bad}");
        assert_eq!(all(&line).status.code(), Some(2), "{line}");
        assert!(!at("no").exists(), "{line}");
    }
    let output = all("study plan.toml --dry-run --json");
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (found["points"].as_u64(), found["parts"].as_u64()),
        (Some(64), Some(32))
    );
    assert!(found["bytes"].as_u64() > Some(32 * 1000) && found["cpu_s"].as_f64() > Some(0.0));
}
