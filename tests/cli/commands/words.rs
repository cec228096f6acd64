//! The first lines of a run: published numbers that it contradicts, and how sure its differences are.

use super::*;
use cvtcycle::study::check::{
    COMMON, CandidateVehicle, Computed, Verdict, embedded_rows, judge, read,
};
use cvtcycle::study::words::intervals::{CASES, draw, line};

/// The words of a run of a case, without prices.
fn of_case<'a>(cars: &[&'a str], cycle: &'a str, ambient: &'a str, start: &'a str) -> Vec<&'a str> {
    let mut words = vec![
        "run",
        "--vehicle",
        cars[0],
        "--cycle",
        cycle,
        "--ambient",
        ambient,
    ];
    words.extend(["--start", start, "--price", "never"]);
    let baseline = cars.get(1).copied().unwrap_or("none");
    words.extend(["--baseline", baseline]);
    words
}

/// A text without its line breaks.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Truth: `validate`, which computes each row by its own expression. A row that says of which run it is is contradicted by that run with the same
/// number exactly where it differs, and the text of the run says so.
#[test]
fn every_row_that_differs_is_in_the_text_of_its_run() {
    let files: Vec<(String, String)> = embedded_rows()
        .iter()
        .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()))
        .collect();
    let files = read(COMMON, &files).unwrap();
    let candidate = CandidateVehicle {
        vehicle: "rover_216_cvt".to_owned(),
        ..CandidateVehicle::default()
    };
    let report = judge(&files, &candidate, |row| row.about.is_some()).unwrap();
    assert!(report.rows.len() >= 11, "{}", report.rows.len());
    let mut differing = 0;
    for judged in &report.rows {
        let (id, about) = (&judged.row.id, judged.row.about.as_ref().unwrap());
        let ambient = about.ambient_degc.to_string();
        let cars: Vec<&str> = [Some(about.subject.as_str()), about.baseline.as_deref()]
            .into_iter()
            .flatten()
            .collect();
        let words = of_case(&cars, &about.cycle, &ambient, &about.start);
        let found = json(&[&words[..], &["--json"]].concat());
        let none = Vec::new();
        let said = found["contradicted"].as_array().unwrap_or(&none);
        let own = said.iter().find(|row| row["row"] == *id);
        let differs = judged.verdict == Verdict::Differs;
        assert_eq!(own.is_some(), differs, "{id}: {said:?}");
        let Some(own) = own else { continue };
        differing += 1;
        let Some(Computed::Number(computed)) = &judged.computed else {
            panic!("{id} is no number");
        };
        let of_run = own["computed"].as_f64().unwrap();
        assert!(
            (of_run - computed).abs() < 1e-6 * computed.abs(),
            "{id}: {of_run} {computed}"
        );
        let text = flat(&stdout(&run(&words)));
        let row = format!("row {id} of `cvtcycle validate`");
        assert!(
            text.contains(&row) && text.contains(&flat(&judged.row.printed_text)),
            "{text}"
        );
    }
    assert!(differing >= 4, "{differing}");
}

/// A changed car is another one than that of the print; a file of the same values under another name is not known to be.
#[test]
fn a_changed_car_contradicts_nothing() {
    let words = of_case(
        &["rover_216_cvt", "mondeo_20_5mt"],
        "ece15_eudc",
        "25",
        "soak",
    );
    let said =
        |more: &[&str]| json(&[&words[..], &["--json"], more].concat())["contradicted"].clone();
    assert!(said(&[]).as_array().is_some_and(|rows| rows.len() == 3));
    for more in [
        ["--set", "transmission.cvt.belt.band_offset_mm=2"],
        ["--set-all", "engine.electrical_w=250"],
        ["--lubricant", "dexron_ii"],
        ["--dt", "0.5"],
        ["--formulation", "chapter_8"],
    ] {
        assert!(said(&more).is_null(), "{more:?}: {}", said(&more));
    }
    // A value set to what it is anyway changes nothing.
    let same = said(&["--set", "transmission.cvt.belt.band_offset_mm=3"]);
    assert!(
        same.as_array().is_some_and(|rows| rows.len() == 3),
        "{same}"
    );
    // 5 K away it still holds, 6 K away no more.
    let at = |degc| {
        of_case(
            &["rover_216_cvt", "mondeo_20_5mt"],
            "ece15_eudc",
            degc,
            "soak",
        )
    };
    let rows = |degc| json(&[&at(degc)[..], &["--json"]].concat())["contradicted"].clone();
    assert!(rows("30").is_array() && rows("31").is_null());
}

/// Truth: the draws themselves, once more. Every case of the file is one that a run finds.
#[test]
fn intervals_are_those_of_the_draws() {
    let case = CASES[1];
    assert_eq!(draw(case).unwrap(), format!("{}\n", line(case).unwrap()));
    for case in CASES {
        let line = line(case).unwrap_or_else(|| panic!("{case:?} is not in the file"));
        let cells: Vec<&str> = line.split(',').collect();
        let (cycle, ambient, start) = case;
        let ambient = ambient.to_string();
        let words = of_case(&["rover_216_cvt", "rover_216_5mt"], cycle, &ambient, start);
        let found = json(&[&words[..], &["--json"]].concat());
        let of = &found["comparison"][0]["interval"];
        assert_eq!(of["draws"].to_string(), cells[7], "{case:?}: {found}");
        assert_eq!(
            of["percent"][2].as_f64().unwrap().to_string(),
            cells[11].parse::<f64>().unwrap().to_string()
        );
        // The car of the files is one of those that are possible.
        let own = found["comparison"][0]["fuel_percent"].as_f64().unwrap();
        let [low, high] = [0, 2].map(|k| of["percent"][k].as_f64().unwrap());
        assert!(
            low - 2.0 < own && own < high + 2.0,
            "{case:?}: {own} of {low} to {high}"
        );
    }
    let words = of_case(
        &["rover_216_cvt", "rover_216_5mt"],
        "ece15_eudc",
        "-10",
        "soak",
    );
    let text = flat(&stdout(&run(&words)));
    assert!(
        text.contains(" than rover_216_5mt (90 % of 256 draws: "),
        "{text}"
    );
    let changed = [&words[..], &["--set", "engine.electrical_w=250"]].concat();
    let text = flat(&stdout(&run(&changed)));
    assert!(text.contains(" than rover_216_5mt (no interval)"), "{text}");
}
