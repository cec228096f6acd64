//! Reports of several results: two runs, a run with studies and validation. Truth: their summaries.

use super::*;

/// Independent truth: the difference of the two summaries.
#[test]
fn val_two_runs_differ_by_what_their_summaries_differ() {
    let place = Place::new();
    run(&place, "a", &[]);
    run(
        &place,
        "b",
        &["--set", "transmission.cvt.pump.displacement_cc_rev=12"],
    );
    place.done(&["report", "a", "b", "--out", "ab.html"]);
    let page = place.text("ab.html");
    let words = words_of(&page);
    let fuel = |dir: &str| -> f64 {
        let summary: Value =
            serde_json::from_str(&place.text(&format!("{dir}/summary.json"))).unwrap();
        summary["runs"][0]["fuel_l_per_100km"].as_f64().unwrap()
    };
    let (a, b) = (fuel("a"), fuel("b"));
    assert!(
        b > a
            && words.contains(&format!("{:.3} L/100 km or", b - a))
            && words.contains("more than that of a"),
        "{a} {b}"
    );
    assert!(words.contains("transmission.cvt.pump.displacement_cc_rev") && words.contains(" 12 "));
    // The terms in the table below the bars add up to the difference of fuel in kJ.
    let figure = &page[page.find("id=\"fig-difference\"").unwrap()..];
    let table = &figure[figure.find("<tbody>").unwrap()..figure.find("</tbody>").unwrap()];
    assert!(
        table.matches("<tr").count() > 12,
        "every component and term has a row"
    );

    place.done(&[
        "run",
        "--cycle",
        "eudc",
        "--baseline",
        "none",
        "--sensitivity",
        "never",
        "--quiet",
        "--out",
        "other",
    ]);
    place.refused(
        &["report", "a", "other"],
        2,
        &["ece15", "eudc", "runs of one cycle"],
    );
    matrix(&place, "matrix");
    place.refused(&["report", "a", "matrix"], 2, &["not all runs", "--with"]);
}

#[test]
fn studies_and_validation_come_into_the_report_of_a_run() {
    let place = Place::new();
    run(&place, "cold", &[]);
    matrix(&place, "cold/matrix");
    place.done(&["validate", "--chapter", "C", "--quiet", "--out", "check"]);
    place.done(&["report", "cold", "--with", "check"]);
    let words = words_of(&place.text("cold/report.html"));
    assert!(
        words.contains("Ambient temperatures")
            && words.contains("Validation")
            && words.contains("printed numbers")
    );
    place.refused(&["report", "check"], 2, &["cvtcycle validate", "--with"]);

    place.done(&["report", "cold/matrix"]);
    assert!(drawings(&place.text("cold/matrix/report.html")).len() >= 3);
    // Half a study is reported with its finished parts.
    let mark = fs::read_dir(place.path().join("cold/matrix/parts"))
        .unwrap()
        .map(|e| e.unwrap().path());
    let mark = mark
        .filter(|path| path.extension().is_some_and(|e| e == "sha256"))
        .max()
        .unwrap();
    fs::remove_file(mark).unwrap();
    place.refused(&["report", "cold/matrix", "--force"], 1, &["not finished"]);
    assert!(words_of(&place.text("cold/matrix/report.html")).contains("is not finished"));
}
