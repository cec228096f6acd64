//! `compare`: runs next to each other.

use super::*;

/// Writes runs into directories; each is a name with its options.
fn runs(dir: &Path, list: &[(&str, &[&str])]) {
    for (name, words) in list {
        let own = [
            "run",
            "--cycle",
            "ece15",
            "--baseline",
            "none",
            "--price",
            "never",
            "--sensitivity",
            "never",
            "--quiet",
            "--out",
            name,
        ];
        let output = run_in(dir, &[&own[..], words].concat());
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
    }
}

const OFFSET: &str = "transmission.cvt.belt.band_offset_mm=";

/// Truth: the summaries of the runs.
#[test]
fn three_runs_are_compared_by_their_own_numbers() {
    let dir = tempfile::tempdir().unwrap();
    let [two, one] = [2, 1].map(|mm| format!("{OFFSET}{mm}"));
    runs(
        dir.path(),
        &[
            ("mm3", &[]),
            ("mm2", &["--set", &two]),
            ("mm1", &["--set", &one]),
        ],
    );
    let output = run_in(dir.path(), &["compare", "mm3", "mm2", "mm1", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (&found["reference"], &found["runs"][2]["name"]),
        (&"mm3".into(), &"mm1".into())
    );
    let summary = |name: &str| -> Value {
        let text = fs::read_to_string(dir.path().join(name).join("summary.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let number = |value: &Value, path: &str| value.pointer(path).and_then(Value::as_f64).unwrap();
    let fuel = |name: &str| number(&summary(name), "/runs/0/fuel_l_per_100km");
    for (k, name) in ["mm3", "mm2", "mm1"].into_iter().enumerate() {
        let own = |key: &str| number(&found, &format!("/runs/{k}/{key}"));
        assert_eq!(own("fuel_l_per_100km").to_bits(), fuel(name).to_bits());
        let apart = fuel(name) - fuel("mm3");
        assert_eq!(own("difference_l_per_100km").to_bits(), apart.to_bits());
        let run = &summary(name)["runs"][0];
        let bands = number(run, "/loss_kj/belt_band") / number(run, "/distance_km");
        assert!((own("loss_kj_per_km/belt_band") / bands - 1.0).abs() < 1e-12);
    }
    assert!(
        number(&found, "/runs/1/difference_percent") < 0.0,
        "a smaller offset saves fuel"
    );
    let components = found["components"].as_array().unwrap();
    assert!(components.contains(&"belt_band".into()) && components.len() < 12);
    let values = found["values"].as_array().unwrap();
    assert_eq!(values.len(), 1, "{values:?}");
    assert_eq!(values[0]["values"], serde_json::json!(["3", "2", "1"]));
    let text = stdout(&run_in(
        dir.path(),
        &["compare", "mm3", "mm2", "mm1", "--reference", "mm2"],
    ));
    for part in [
        "Against mm2",
        "band_offset_mm: 2, 3, 1 mm",
        "in one value alone",
        "belt band",
        "kJ/km",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

#[test]
fn runs_that_are_not_alike_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    runs(
        dir.path(),
        &[("warm", &[]), ("cold", &["--ambient", "-10"])],
    );
    let refused = |words: &[&str]| {
        let output = run_in(dir.path(), words);
        assert_eq!(
            (output.status.code(), stdout(&output)),
            (Some(2), String::new()),
            "{words:?}"
        );
        stderr(&output)
    };
    let message = refused(&["compare", "warm", "cold"]);
    assert!(
        message.contains("ambient temperature of warm is 25, of cold -10"),
        "{message}"
    );
    assert!(message.contains("--loosely"), "{message}");
    let loosely = stdout(&run_in(
        dir.path(),
        &["compare", "warm", "cold", "--loosely"],
    ));
    assert!(
        loosely.contains("not alike: ambient temperature: 25, -10"),
        "{loosely}"
    );
    assert!(
        loosely.contains("no value of the cars differs"),
        "{loosely}"
    );
    assert!(refused(&["compare", "warm"]).contains("2 to 20 directories"));
    let message = refused(&["compare", "warm", "cold", "--loosely", "--reference", "hot"]);
    assert!(message.contains("none of the runs is named `hot`") && message.contains("warm, cold"));
    let message = refused(&["compare", "nowhere", "warm", "neither"]);
    assert!(
        message.contains("nowhere") && message.contains("neither"),
        "{message}"
    );
}

/// Conservation: with start-stop, fuel energy also goes to the battery and the starter, so a report without them rejects the files as changed.
#[test]
fn runs_with_start_stop_are_reported_and_compared() {
    let dir = tempfile::tempdir().unwrap();
    let stops = ["--set", "engine.start_stop.delay_s=0.5"];
    for (out, more) in [("plain", &[][..]), ("stops", &stops)] {
        let words = "run --cycle ece15 --start 80 --baseline none --price never --out";
        let words: Vec<&str> = words.split(' ').chain([out]).collect();
        let output = run_in(dir.path(), &[&words[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let has_row = stdout(&output).contains("battery and starter");
        assert_eq!(has_row, out == "stops", "{}", stdout(&output));
    }
    for words in [
        &["report", "stops", "--stored", "--full"][..],
        &["compare", "plain", "stops"],
    ] {
        let output = run_in(dir.path(), words);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let page = fs::read_to_string(dir.path().join("stops/report.html")).unwrap();
    assert!(page.contains("Battery and starter"), "no row in the report");
}
