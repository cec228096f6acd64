//! Directories without a report, and mismatched results.

use super::*;

#[test]
fn a_report_names_missing_results_and_shows_the_rest() {
    let place = Place::new();
    run(&place, "cold", &[]);
    fs::remove_file(place.path().join("cold/trace_rover_216_cvt.csv")).unwrap();
    place.refused(
        &["report", "cold", "--full"],
        1,
        &["trace of rover_216_cvt is not there"],
    );
    let page = place.text("cold/report.html");
    assert!(words_of(&page).contains("trace of rover_216_cvt is not there"));
    assert!(
        page.contains("fig-driveline_rover_216_5mt")
            && !page.contains("fig-driveline_rover_216_cvt")
    );
    fs::remove_file(place.path().join("cold/inputs.json")).unwrap();
    place.refused(
        &["report", "cold", "--full", "--force"],
        1,
        &["inputs.json is not there"],
    );
    assert!(
        place
            .text("cold/report.html")
            .contains("energy_flow_rover_216_cvt")
    );
}

#[test]
fn a_directory_without_a_run_is_refused_with_a_hint() {
    let place = Place::new();
    run(&place, "cold", &[]);
    fs::create_dir(place.path().join("empty")).unwrap();
    place.refused(&["report", "nowhere"], 2, &["nowhere", "check the path"]);
    place.refused(
        &["report", "empty"],
        2,
        &["neither summary.json nor study.json", "cvtcycle run"],
    );
    place.refused(&["report", "cold/summary.json"], 2, &["name the directory"]);
    place.refused(&["report", "cold", "empty"], 2, &["neither"]);
    place.refused(
        &["report", "cold", "--with", "empty"],
        2,
        &["neither a study nor a validation"],
    );
    place.refused(
        &["report", "cold", "--format", "pdf"],
        2,
        &["pdf", "html, md"],
    );
    place.refused(
        &["report", "cold", "--out", "no/such/report.html"],
        2,
        &["no directory"],
    );
    place.refused(&["report", "cold", "--out", "cold"], 2, &["is a directory"]);
    place.refused(
        &["report", "cold", "--cover", "none.toml"],
        2,
        &["none.toml"],
    );

    let summary = place.text("cold/summary.json");
    place.write(
        "cold/summary.json",
        &summary.replacen("\"schema\": 1", "\"schema\": 9", 1),
    );
    place.refused(
        &["report", "cold"],
        2,
        &["schema 9", "reads schema 1", "the program that wrote it"],
    );
    place.write("cold/summary.json", &summary[..summary.len() / 2]);
    place.refused(&["report", "cold"], 2, &["no whole JSON", "damaged"]);
    place.write(
        "cold/summary.json",
        &summary.replace("rover_216_5mt", "../../etc/passwd"),
    );
    place.refused(&["report", "cold"], 2, &["cannot be the name of a vehicle"]);
    place.write("cold/summary.json", &summary);
    let trace = place.text("cold/trace_rover_216_cvt.csv");
    place.write(
        "cold/trace_rover_216_cvt.csv",
        &trace.replacen("\n2,", "\n1x,", 1),
    );
    place.refused(
        &["report", "cold"],
        2,
        &["trace_rover_216_cvt.csv", "1x", "time_s"],
    );
    assert!(!place.has("cold/report.html") && !place.has("cold/report_figures"));
    place.write("cold/trace_rover_216_cvt.csv", &trace);
    place.done(&["report", "cold"]);
}

#[test]
fn nothing_but_a_report_is_replaced() {
    let place = Place::new();
    run(&place, "cold", &[]);
    let before = place.text("cold/summary.json");
    place.refused(
        &["report", "cold", "--out", "cold/summary.json", "--force"],
        2,
        &["ending", "html"],
    );
    place.write("notes.html", "<p>mine</p>");
    place.refused(
        &["report", "cold", "--out", "notes.html", "--force"],
        2,
        &["no report of this program"],
    );
    assert_eq!(
        (place.text("cold/summary.json"), place.text("notes.html")),
        (before, "<p>mine</p>".to_owned())
    );
    // The extension determines the form.
    place.done(&["report", "cold", "--out", "a b.md"]);
    place.done(&["report", "cold", "--out", "a b.md", "--force"]);
    assert!(
        place.text("a b.md").contains("](a%20b_figures/") && place.text("a b.md").starts_with("# ")
    );
}

#[test]
fn a_trace_has_to_be_that_of_the_summary() {
    let place = Place::new();
    run(&place, "cold", &[]);
    run(&place, "warm", &["--start", "warm"]);
    let trace = place.text("cold/trace_rover_216_cvt.csv");
    let half: Vec<&str> = trace.lines().take(100).collect();
    place.write("cold/trace_rover_216_cvt.csv", &(half.join("\n") + "\n"));
    place.refused(
        &["report", "cold"],
        2,
        &["not that of the summary", "time of 99"],
    );
    place.write(
        "cold/trace_rover_216_cvt.csv",
        &place.text("warm/trace_rover_216_cvt.csv"),
    );
    place.refused(
        &["report", "cold"],
        2,
        &["not that of the summary", "fuel of"],
    );
    place.write(
        "cold/trace_rover_216_cvt.csv",
        &trace.replacen("pump_loss_w", "plump_loss_w", 1),
    );
    place.refused(
        &["report", "cold"],
        2,
        &["losses of the transmission", "trace_rover_216_cvt.csv"],
    );
    place.write("cold/trace_rover_216_cvt.csv", &trace);
    let summary = place.text("cold/summary.json");
    let fuel = summary
        .lines()
        .find(|line| line.contains("\"fuel_l_per_100km\""))
        .unwrap()
        .to_owned();
    place.write(
        "cold/summary.json",
        &summary.replacen(&fuel, "\"fuel_l_per_100km\": 5.0,", 1),
    );
    place.refused(&["report", "cold"], 2, &["do not agree with each other"]);
    assert!(!place.has("cold/report.html"));
}

/// Files of two runs are never mixed, in either direction.
#[test]
fn files_of_two_runs_are_never_one() {
    let place = Place::new();
    run(&place, "one", &["--strict"]);
    run(&place, "two", &[]);
    // Both have equal numbers and traces; only the settings differ.
    let names = ["summary.json", "inputs.json"];
    for name in names {
        let own = place.text(&format!("one/{name}"));
        place.write(&format!("one/{name}"), &place.text(&format!("two/{name}")));
        place.refused(
            &["report", "one"],
            2,
            &["inputs.json in one is of another run than summary.json"],
        );
        place.write(&format!("one/{name}"), &own);
    }
    // A single number of one file that no sum depends on.
    let change = |name: &str, from: &str, to: &str, said: &str| {
        let own = place.text(name);
        assert!(own.contains(from), "{name}: {from}");
        place.write(name, &own.replacen(from, to, 1));
        place.refused(&["report", "one"], 2, &[said]);
        place.write(name, &own);
    };
    change(
        "one/summary.json",
        "\"ambient_degc\": -10.0",
        "\"ambient_degc\": -11.0",
        "summary.json in one is not the file that was written with inputs.json",
    );
    let trace = place.text("one/trace_rover_216_5mt.csv");
    let last = trace.lines().last().unwrap();
    change(
        "one/trace_rover_216_5mt.csv",
        &format!("{last}\n"),
        last,
        "trace_rover_216_5mt.csv in one is not the file that was written with summary.json",
    );
    place.done(&["report", "one"]);
    // A trace of an earlier run in another format is ignored.
    run(&place, "two", &["--format", "parquet", "--force"]);
    place.write("two/trace_rover_216_cvt.csv", "of an earlier run");
    place.done(&["report", "two"]);
    // Files without the identifying word are read, but not vouched for.
    for name in names {
        let text = place.text(&format!("one/{name}"));
        let lines = text.lines().filter(|line| !line.starts_with("  \"run\":"));
        place.write(
            &format!("one/{name}"),
            &lines.collect::<Vec<_>>().join("\n"),
        );
    }
    let listed = place
        .text("one/inputs.json")
        .replace("\"files\"", "\"old\"");
    place.write("one/inputs.json", &listed);
    place.refused(
        &["report", "one", "--force"],
        1,
        &["the files have no word for their run"],
    );
}

#[test]
fn a_study_of_another_case_stays_out_of_the_answer() {
    let place = Place::new();
    run(&place, "cold", &[]);
    matrix(&place, "cold/matrix");
    place.done(&[
        "run",
        "--cycle",
        "eudc",
        "--sensitivity",
        "never",
        "--quiet",
        "--out",
        "other",
    ]);
    place.done(&[
        "report",
        "other",
        "--with",
        "cold/matrix",
        "--with",
        "cold/matrix",
    ]);
    let words = words_of(&place.text("other/report.html"));
    let answer = &words[..words.find("What to doubt").unwrap()];
    assert!(
        answer.contains("is of another case: cycle ece15 instead of eudc")
            && !answer.contains("Fuel of CVT over")
    );
    // Its own range is that of measured cars.
    assert!(words.contains("computed against measured cars"));
    assert_eq!(
        place
            .text("other/report.html")
            .matches("id=\"fig-ambient_penalty\"")
            .count(),
        1,
        "named twice, shown once"
    );
    place.done(&["report", "cold"]);
    assert!(words_of(&place.text("cold/report.html")).contains("Fuel of CVT over 5-speed"));
    place.refused(
        &["report", "cold", "other", "--with", "cold/matrix"],
        2,
        &["not of several"],
    );
}
