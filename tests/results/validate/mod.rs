//! `cvtcycle validate`: shipped rows, verdicts, users' rows, every form of the output. The rows contain their own truth.
#![allow(clippy::unwrap_used, reason = "tests say what they found")]

mod fleet;
mod own_rows;
mod power;

use std::collections::BTreeSet;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;

fn cvtcycle(args: &[&str]) -> std::process::Output {
    Command::cargo_bin("cvtcycle")
        .unwrap()
        .args(args)
        .env("NO_COLOR", "1")
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn json(args: &[&str]) -> (Option<i32>, Value) {
    let output = cvtcycle(args);
    let value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|e| panic!("{e}: {}", text(&output.stderr)));
    (output.status.code(), value)
}

/// Rows of a user's file, as in `validate --only-rows --json`.
struct UserRows {
    dir: tempfile::TempDir,
}

impl UserRows {
    fn new(toml: &str) -> Self {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("own.toml"), toml).unwrap();
        UserRows { dir }
    }

    fn path(&self) -> String {
        self.dir
            .path()
            .join("own.toml")
            .to_string_lossy()
            .into_owned()
    }

    fn run(&self, more: &[&str]) -> std::process::Output {
        let path = self.path();
        let args: Vec<&str> = ["validate", "--only-rows", "--rows", &path]
            .into_iter()
            .chain(more.iter().copied())
            .collect();
        cvtcycle(&args)
    }
}

/// Row without any source; `more` are further keys.
fn row(id: &str, more: &str) -> String {
    format!(
        "[[row]]\nid = \"{id}\"\nchapter = \"own\"\nmechanism = \"user\"\nwhat = \"a number\"\nprinted = \"3\"\n{more}\n"
    )
}

#[test]
fn every_statement_of_the_thesis_has_a_row() {
    let (_, all) = json(&["validate", "--json"]);
    let stem = |id: &str| {
        id.trim_end_matches(|c: char| c.is_ascii_lowercase())
            .to_owned()
    };
    let rows: BTreeSet<String> = all["rows"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| stem(row["id"].as_str().unwrap()))
        .collect();
    let ids = include_str!("../../golden/statement_ids.txt");
    assert_eq!(ids.lines().count(), 171);
    let missing: Vec<&str> = ids.lines().filter(|id| !rows.contains(*id)).collect();
    assert!(missing.is_empty(), "no row for {missing:?}");
}

#[test]
fn the_shipped_rows_keep_their_recorded_verdicts() {
    let output = cvtcycle(&["validate", "--json"]);
    let (code, all) = (
        output.status.code(),
        serde_json::from_slice::<Value>(&output.stdout).unwrap(),
    );
    assert_eq!(
        all["moved"],
        Value::Array(Vec::new()),
        "{}",
        text(&output.stderr)
    );
    assert_eq!(code, Some(0), "{}", text(&output.stderr));
    for row in all["rows"].as_array().unwrap() {
        assert!(
            row["recorded"].is_string(),
            "{}: no recorded verdict",
            row["id"]
        );
        if row["verdict"] == "differs" {
            assert!(
                !row["reason"].as_str().unwrap().is_empty() && row["cause"].is_string(),
                "{}",
                row["id"]
            );
        }
        if row["verdict"] == "fit" {
            assert!(
                !row["fitted_to"].as_array().unwrap().is_empty(),
                "{}",
                row["id"]
            );
        }
    }
}

/// Truth: the definition of the tolerance `indicative`. A size that the thesis quotes of another car, box or fluid has this tolerance, whatever its verdict. A bound or an identity
/// may have a narrower one, and two rows compare the project's own cars.
#[test]
fn quoted_sizes_have_the_indicative_tolerance() {
    let (_, all) = json(&["validate", "--json", "--all"]);
    let mut seen = 0;
    for row in all["rows"].as_array().unwrap() {
        if row["kind"] != "L" || row["tolerance"].as_str().is_none_or(str::is_empty) {
            continue;
        }
        let tolerance = row["tolerance"].as_str().unwrap();
        let own_cars = ["3.04b", "3.05b"].contains(&row["id"].as_str().unwrap());
        assert!(
            own_cars || tolerance == "indicative" || tolerance == "exact",
            "{}: {tolerance}",
            row["id"]
        );
        seen += usize::from(tolerance == "indicative");
    }
    assert!(seen >= 15, "{seen}");
}

#[test]
fn groups_count_their_verdicts() {
    let (_, all) = json(&["validate", "--json"]);
    let rows = all["rows"].as_array().unwrap();
    for verdict in ["agrees", "fit", "identity", "differs", "not comparable"] {
        let is_counted = |row: &&Value| row["group"] == "thesis" && row["verdict"] == verdict;
        let count = rows.iter().filter(is_counted).count();
        let word = verdict.replace(' ', "_");
        assert_eq!(all["groups"]["thesis"]["counts"][&word], count, "{word}");
    }
}

#[test]
fn another_parameter_moves_rows_and_fails() {
    for set in [
        "transmission.cvt.pump.displacement_cc_rev=11.7",
        "lubricant.friction.band=0.1",
    ] {
        let output = cvtcycle(&["validate", "--json", "--set", set]);
        let all: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(1), "{set}");
        let moved = all["moved"].as_array().unwrap();
        assert!(!moved.is_empty());
        for id in moved {
            assert!(
                text(&output.stderr).contains(&format!("row {}: ", id.as_str().unwrap())),
                "{set}: {id}"
            );
        }
    }
}

#[test]
fn the_verdict_follows_from_the_rule() {
    let verdicts = |more: &str, verdict: &str| {
        let own = UserRows::new(&format!(
            "[tolerances.t]\nwidth = 0.5\nfrom = \"test\"\n{}",
            row("a", more)
        ));
        let output = own.run(&["--json"]);
        let all: Value = serde_json::from_slice(&output.stdout)
            .unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
        assert_eq!(all["rows"][0]["verdict"], verdict, "{more}");
        assert_eq!(
            output.status.code(),
            Some(0),
            "{more}: no verdict is recorded"
        );
    };
    verdicts("value = 3\ntolerance = \"t\"\ncompute = \"3.5\"", "agrees");
    verdicts(
        "value = 3\ntolerance = \"t\"\ncompute = \"3.51\"",
        "differs",
    );
    verdicts("low = 3\ntolerance = \"t\"\ncompute = \"1000\"", "agrees");
    verdicts(
        "low = 1\nhigh = 3\ntolerance = \"t\"\ncompute = \"span(x in 0.6, 3.4: x)\"",
        "agrees",
    );
    verdicts(
        "low = 1\nhigh = 3\ntolerance = \"t\"\ncompute = \"span(x in 0.4, 3.4: x)\"",
        "differs",
    );
    verdicts("compute = \"3 > 2\"", "agrees");
    verdicts("compute = \"2 > 3\"", "differs");
    verdicts("expect = false\ncompute = \"2 > 3\"", "agrees");
    let fitted = "fitted_to = [\"transmission.cvt.pump.displacement_cc_rev\"]\n";
    verdicts(
        &format!("{fitted}value = 3\ntolerance = \"t\"\ncompute = \"3\""),
        "fit",
    );
    verdicts(
        &format!("{fitted}value = 3\ntolerance = \"t\"\ncompute = \"4\""),
        "differs",
    );
}

#[test]
fn a_recorded_verdict_that_no_longer_holds_is_exit_1() {
    let own = UserRows::new(&row(
        "a",
        "value = 3\ntolerance = \"exact\"\ncompute = \"3.1\"\nverdict = \"agrees\"",
    ));
    let output = own.run(&[]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text(&output.stderr).contains("row a: `agrees` recorded, now `differs`"),
        "{}",
        text(&output.stderr)
    );
    let quiet = own.run(&["--quiet"]);
    assert!(quiet.stdout.is_empty() && text(&quiet.stderr).contains("row a"));
}

#[test]
fn csv_json_and_html_have_the_same_rows() {
    let (_, all) = json(&["validate", "--chapter", "8", "--json"]);
    let rows = all["rows"].as_array().unwrap();
    let csv = cvtcycle(&["validate", "--chapter", "8", "--format", "csv"]).stdout;
    let mut reader = csv::Reader::from_reader(csv.as_slice());
    let header = reader.headers().unwrap().clone();
    let place = |name: &str| header.iter().position(|h| h == name).unwrap();
    let records: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(records.len(), rows.len());
    for (record, row) in records.iter().zip(rows) {
        assert_eq!(&record[place("id")], row["id"].as_str().unwrap());
        assert_eq!(&record[place("verdict")], row["verdict"].as_str().unwrap());
        let number = record[place("computed_low")].parse::<f64>().ok();
        let near = match (number, row["computed_low"].as_f64()) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-12 * b.abs(),
            (a, b) => a.is_none() && b.is_none(),
        };
        assert!(near, "{}: {number:?} {}", row["id"], row["computed_low"]);
    }
    let html = text(&cvtcycle(&["validate", "--chapter", "8", "--format", "html"]).stdout);
    let options = roxmltree::ParsingOptions {
        allow_dtd: true,
        ..Default::default()
    };
    let document = roxmltree::Document::parse_with_options(&html, options).unwrap();
    let ids: Vec<&str> = document
        .descendants()
        .filter(|n| n.has_tag_name("th") && n.attribute("scope") == Some("row"))
        .filter_map(|n| n.text())
        .collect();
    assert_eq!(
        ids,
        rows.iter()
            .map(|row| row["id"].as_str().unwrap())
            .collect::<Vec<_>>()
    );
    for never in ["<script", "http:", "https:", "<link", "<img"] {
        assert!(!html.contains(never), "{never}: the page loads nothing");
    }
    for word in [
        "prefers-color-scheme: dark",
        "@media print",
        "agrees",
        "differs",
    ] {
        assert!(html.contains(word), "{word}");
    }
}

#[test]
fn html_and_markdown_escape_what_users_write() {
    let wild = "value = 3\ntolerance = \"exact\"\ncompute = \"3\"\nremark = \"<script>alert('x')</script> & | *so*\"\ncondition = \"a < b | c\"";
    let own = UserRows::new(&row("a", wild).replace("\"own\"", "\"<b>own</b>\""));
    let html = text(&own.run(&["--format", "html"]).stdout);
    assert!(
        !html.contains("<script") && !html.contains("<b>own"),
        "{html}"
    );
    let options = roxmltree::ParsingOptions {
        allow_dtd: true,
        ..Default::default()
    };
    let document = roxmltree::Document::parse_with_options(&html, options).unwrap();
    assert!(document.descendants().any(|n| {
        n.text()
            .is_some_and(|t| t.contains("<script>alert('x')</script> & | *so*"))
    }));
    let markdown = text(&own.run(&["--format", "md"]).stdout);
    assert!(
        !markdown.contains("<script")
            && markdown.contains("a &lt; b \\| c")
            && markdown.contains("\\*so\\*"),
        "{markdown}"
    );
}

#[test]
fn filters_and_files() {
    let (code, pump) = json(&["validate", "--mechanism", "pump", "--json"]);
    assert_eq!(code, Some(0));
    let rows = pump["rows"].as_array().unwrap();
    assert!(rows.len() > 5 && rows.iter().all(|row| row["mechanism"] == "pump"));
    for args in [
        ["validate", "--chapter", "77"],
        ["validate", "--mechanism", "pmup"],
        ["validate", "--format", "pdf"],
    ] {
        let output = cvtcycle(&args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(text(&output.stderr).contains(args[2]), "{args:?}");
    }
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("report");
    let out_word = out.to_string_lossy().into_owned();
    assert_eq!(
        cvtcycle(&["validate", "--chapter", "7", "--quiet", "--out", &out_word])
            .status
            .code(),
        Some(0)
    );
    for name in [
        "summary.json",
        "validation.csv",
        "validation.html",
        "validation.md",
    ] {
        assert!(out.join(name).is_file(), "{name}");
    }
    assert_eq!(
        cvtcycle(&["validate", "--chapter", "7", "--quiet", "--out", &out_word])
            .status
            .code(),
        Some(2),
        "nothing is overwritten silently"
    );
    assert_eq!(
        cvtcycle(&[
            "validate",
            "--chapter",
            "7",
            "--quiet",
            "--force",
            "--out",
            &out_word
        ])
        .status
        .code(),
        Some(0)
    );
}

/// `tools/docs` writes `cvtcycle validate --format md --mechanism NAME` for every page of the book that includes such a table.
#[test]
fn the_book_shows_the_rows_of_every_mechanism() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/book/src");
    let mut included = BTreeSet::new();
    for entry in std::fs::read_dir(&folder).unwrap().map(Result::unwrap) {
        let path = entry.path();
        if path.extension().is_some_and(|ending| ending == "md") {
            let page = std::fs::read_to_string(path).unwrap();
            let names = page.split("{{#include generated/validation_").skip(1);
            included.extend(names.map(|rest| rest.split('.').next().unwrap().to_owned()));
        }
    }
    let ids = |output: &std::process::Output| -> Vec<String> {
        let lines = text(&output.stdout);
        let cells = lines.lines().filter_map(|line| line.strip_prefix("| "));
        let ids = cells.filter_map(|cells| cells.split(" | ").next());
        ids.skip(1).map(str::to_owned).collect()
    };
    let mut shown = Vec::new();
    for name in included.iter().filter(|name| *name != "all") {
        let printed = cvtcycle(&["validate", "--format", "md", "--mechanism", name]);
        assert_ne!(
            printed.status.code(),
            Some(2),
            "{name}: {}",
            text(&printed.stderr)
        );
        shown.extend(ids(&printed));
    }
    shown.sort();
    let mut all = ids(&cvtcycle(&[
        "validate",
        "--format",
        "md",
        "--mechanism",
        "all",
    ]));
    all.sort();
    assert!(included.contains("all") && all.len() > 300, "{}", all.len());
    assert_eq!(shown, all, "a row is on no page, or on two");
}

/// One problem instead of one for every key that a manual box lacks. Users' own rows may be about it.
#[test]
fn built_in_rows_need_a_cvt() {
    let output = cvtcycle(&["validate", "--vehicle", "rover_216_5mt"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("manual gearbox")
            && message.contains("--only-rows")
            && message.contains("1 problem in --vehicle"),
        "{message}"
    );
    let own = UserRows::new(&row("own.1", "kind = \"O\"\ncompute = \"2 > 1\""));
    assert_eq!(
        own.run(&["--vehicle", "rover_216_5mt"]).status.code(),
        Some(0)
    );
}

/// The page has the tolerance of "agrees": 3 to 4 within 0.5 on both sides, or a share of each end.
#[test]
fn the_page_shows_the_tolerance() {
    let head =
        "[tolerances.a]\nwidth = 0.5\nfrom = \"x\"\n[tolerances.b]\nshare = 0.1\nfrom = \"x\"\n";
    let one = row(
        "own.1",
        "kind = \"N\"\nvalue = 3\ntolerance = \"a\"\ncompute = \"3\"",
    );
    let two = row(
        "own.2",
        "kind = \"N\"\nlow = 2\nhigh = 4\ntolerance = \"b\"\ncompute = \"3\"",
    );
    let page = text(
        &UserRows::new(&format!("{head}{one}{two}"))
            .run(&["--format", "html"])
            .stdout,
    );
    assert!(
        page.contains("(± 0.5)") && page.contains("(-0.2, +0.4)"),
        "{page}"
    );
}
