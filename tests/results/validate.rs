//! `cvtcycle validate`: the shipped rows, the rule, users' rows, every form of the output. The truths are in the rows themselves.
#![allow(clippy::unwrap_used, reason = "tests say what they found")]

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

/// Rows of a file of our own, as `validate --only-rows --json` has them.
struct Own {
    dir: tempfile::TempDir,
}

impl Own {
    fn new(toml: &str) -> Self {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("own.toml"), toml).unwrap();
        Own { dir }
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

/// A row that is computed without any source; `more` are further keys.
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
    let ids = include_str!("../golden/statement_ids.txt");
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

#[test]
fn the_readme_counts_the_verdicts_of_today() {
    let (_, all) = json(&["validate", "--json"]);
    let rows = all["rows"].as_array().unwrap();
    let of = |verdict: &str| rows.iter().filter(|row| row["verdict"] == verdict).count();
    let readme = include_str!("../../README.md").replace('\n', " ");
    let readme = readme.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        format!(
            "{} in all: {} agree, {} are fits",
            rows.len(),
            of("agrees"),
            of("fit")
        ),
        format!(
            "{} differ, each with reason and computed cause, {} cannot be compared",
            of("differs"),
            of("not comparable")
        ),
    ] {
        assert!(readme.contains(&words), "README.md should say: {words}");
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
        let own = Own::new(&format!(
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
    let own = Own::new(&row(
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

const SOURCES: &str = r#"
[tolerances.wide]
width = 100
from = "test"

[sources.box]
source = "bench"
ratio = [2.4, 1.0]
speed_rpm = "1000..2000:500"
temp_degc = 80

[sources.colder]
like = "box"
temp_degc = 20
set = ["lubricant.friction.band=0.1"]

[sources.grip]
source = "belt"
ratio = 2.4
speed_rpm = 2000
pressure_bar = 10
torque_nm = [20, 2000]

[sources.trip]
source = "run"
points = [[0, 0], [10, 30], [60, 30]]

[sources.oil]
source = "fluid"
temp_degc = [40, 100]
"#;

#[test]
fn users_rows_reach_every_source() {
    let wide = "low = -1000\nhigh = 1000\ntolerance = \"wide\"\ncompute = ";
    let computes = [
        ("bench", "count(box: total_nm > 0)"),
        (
            "like",
            "one(colder: total_nm where ratio == 1 and speed_rpm == 1500) - one(box: total_nm where ratio == 1 and speed_rpm == 1500)",
        ),
        ("belt", "max(grip: torque_nm)"),
        ("run", "100 * total(trip: fuel_kg)"),
        ("fluid", "one(oil: kinematic_mm2_s where temp_degc == 100)"),
        ("key", "key(transmission.cvt.belt.band_offset_mm)"),
    ];
    let rows: String = computes
        .iter()
        .map(|(id, compute)| row(id, &format!("{wide}\"{compute}\"")))
        .collect();
    let own = Own::new(&(SOURCES.to_owned() + &rows));
    let output = own.run(&["--json"]);
    let all: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    let computed = |k: usize| all["rows"][k]["computed_low"].as_f64().unwrap();
    assert!(
        (computed(0) - 6.0).abs() < 1e-12,
        "two ratios, three speeds: {}",
        computed(0)
    );
    assert!(
        computed(1).abs() > 0.1,
        "another temperature and friction: {}",
        computed(1)
    );
    assert!(
        (computed(2) - 20.0).abs() < 1e-12,
        "2000 Nm are gross slip: {}",
        computed(2)
    );
    assert_eq!(all["rows"][2]["gross_slip_left_out"], 1);
    assert!(computed(3) > 0.0);
    assert!(
        (computed(4) - 7.2).abs() < 1e-9,
        "the shipped fluid's KV100: {}",
        computed(4)
    );
    assert!((computed(5) - 3.0).abs() < 1e-12);
    // A vehicle file of the user in the folder of the rows.
    let car = include_str!("../../vehicles/rover_216_cvt.toml").replace(
        "band_offset_mm = { value = 3.0",
        "band_offset_mm = { value = 2.0",
    );
    let of_car = row(
        "own",
        &format!("{wide}\"key(mine: transmission.cvt.belt.band_offset_mm)\""),
    );
    let mine = Own::new(&format!(
        "{SOURCES}\n[sources.mine]\nsource = \"vehicle\"\nvehicle = \"car.toml\"\n{of_car}"
    ));
    std::fs::write(mine.dir.path().join("car.toml"), car).unwrap();
    let output = mine.run(&["--json"]);
    let found: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    assert!((found["rows"][0]["computed_low"].as_f64().unwrap() - 2.0).abs() < 1e-12);
    let added = cvtcycle(&["validate", "--json", "--rows", &own.path()]);
    let added: Value = serde_json::from_slice(&added.stdout).unwrap();
    assert!(added["rows"].as_array().unwrap().len() > 100);
}

#[test]
fn all_problems_of_a_file_are_named_at_once() {
    let bad = r#"
[tolerances.both]
width = 1
share = 0.1
from = "x"

[sources.odd]
source = "bnch"

[sources.bare]
source = "bench"
ratio = "4..2"

[sources.lost]
like = "no_such_form"
"#;
    let rows = [
        row("a", "value = 3\ncompute = \"1 + max(lwo: y)\""),
        row(
            "b",
            "value = 3\ntolerance = \"exct\"\ncompute = \"max(low: totl_nm)\"",
        ),
        row(
            "c",
            "value = 3\ntolerance = \"exact\"\ncompute = \"3\"\nverdict = \"differs\"",
        ),
        row("d", "verdict = \"not comparable\""),
        row(
            "e",
            "value = 3\ntolerance = \"exact\"\ncompute = \"3\"\nverdict = \"agree\"\nfitted_to = [\"pump.size\"]",
        ),
        row("f", "compute = \"3\"\nuint = \"Nm\""),
        row("a", "compute = \"3 > 2\""),
        row(
            "g",
            "low = 4\nhigh = 3\ntolerance = \"exact\"\ncompute = \"3 > 2\"",
        ),
        row(
            "h",
            "value = 3\ntolerance = \"totals\"\nunit = \"bar\"\ncompute = \"3\"",
        ),
    ];
    let own = Own::new(&(bad.to_owned() + &rows.concat()));
    let output = own.run(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    let said = text(&output.stderr);
    for part in [
        "needs either `width` or `share`",
        "`bnch` is not known for `sources.odd.source`",
        "`4..2` is no range",
        "no such source to continue",
        "row a: `compute`: the source `lwo` is not known",
        "row a: missing key `tolerance`",
        "there is no tolerance `exct`",
        "the column `totl_nm` is not known",
        "did you mean `total_nm`",
        "row c: the verdict needs a reason",
        "needs its computed cause",
        "row d: the verdict needs a reason",
        "`agree` is not known for `verdict`",
        "there is no parameter `pump.size`",
        "row f: unknown key `uint`",
        "but none is printed",
        "the id `a` was used before",
        "`low` is above `high`",
        "but a number is printed",
        "tolerance `totals` is in Nm, the row in bar",
        "own.toml:",
    ] {
        assert!(said.contains(part), "`{part}` is not in\n{said}");
    }
}

#[test]
fn what_cannot_be_computed_is_a_problem_and_no_verdict() {
    let wide = "low = 0\ntolerance = \"wide\"\ncompute = ";
    for (compute, why) in [
        ("one(box: total_nm)", "6 rows where one was expected"),
        (
            "max(grip: slip_percent where torque_nm == 2000)",
            "gross slip",
        ),
        ("key(transmission.manual.seal_nm)", "not known"),
    ] {
        let own = Own::new(&(SOURCES.to_owned() + &row("a", &format!("{wide}\"{compute}\""))));
        let output = own.run(&[]);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{compute}: {said}");
        assert!(
            said.contains("row a") && said.contains(why),
            "{compute}: {said}"
        );
    }
    let own = Own::new(&format!(
        "{SOURCES}\n[sources.worse]\nlike = \"box\"\nset = [\"transmission.cvt.belt.band_ofset_mm=3\"]\n"
    ));
    let output = own.run(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        text(&output.stderr).contains("source `worse`: ")
            && text(&output.stderr).contains("band_offset_mm"),
        "{}",
        text(&output.stderr)
    );
}

/// A ratio that the box does not have is computed and reported.
#[test]
fn points_outside_validity_are_reported() {
    let source =
        "[sources.b]\nsource = \"bench\"\nratio = [2.4, 2.9]\nspeed_rpm = 2000\ntemp_degc = 80\n";
    let own = Own::new(
        &(source.to_owned()
            + &row(
                "a",
                "low = 0\ncompute = \"mean(b: total_nm)\"\ntolerance = \"exact\"",
            )),
    );
    let message: Value = serde_json::from_slice(&own.run(&["--json"]).stdout).unwrap();
    assert_eq!(message["rows"][0]["outside_validity"], 1, "{message}");
    assert!(text(&own.run(&[]).stdout).contains("1 points outside the validity"));
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
    let own = Own::new(&row("a", wild).replace("\"own\"", "\"<b>own</b>\""));
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

/// One problem, not one for every key that a manual box does not have; own rows may look into it.
#[test]
fn the_programs_rows_need_a_cvt() {
    let output = cvtcycle(&["validate", "--vehicle", "rover_216_5mt"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(
        message.contains("manual gearbox")
            && message.contains("--only-rows")
            && message.contains("1 problem in --vehicle"),
        "{message}"
    );
    let own = Own::new(&row("own.1", "kind = \"O\"\ncompute = \"2 > 1\""));
    assert_eq!(
        own.run(&["--vehicle", "rover_216_5mt"]).status.code(),
        Some(0)
    );
}

/// The page says how wide "agrees" is: 3 to 4 within 0.5 on both sides, a share of each end for itself.
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
        &Own::new(&format!("{head}{one}{two}"))
            .run(&["--format", "html"])
            .stdout,
    );
    assert!(
        page.contains("(± 0.5)") && page.contains("(-0.2, +0.4)"),
        "{page}"
    );
}
