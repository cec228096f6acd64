//! `report`: the page has the numbers of the results, and names missing ones. tools/browser tests the page in a browser.
#![allow(clippy::unwrap_used, missing_docs, reason = "a test may stop at once")]

mod forms;
mod joined;
mod refused;

use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// Runs the program in a temporary directory.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Place(tempfile::tempdir().unwrap())
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn cvtcycle(&self, words: &[&str]) -> Output {
        Command::cargo_bin("cvtcycle")
            .unwrap()
            .current_dir(self.path())
            .args(words)
            .output()
            .unwrap()
    }

    /// Runs a command that must succeed.
    fn done(&self, words: &[&str]) -> String {
        let out = self.cvtcycle(words);
        assert_eq!(
            out.status.code(),
            Some(0),
            "{words:?}: {}",
            String::from_utf8_lossy(&out.stderr)
        );
        String::from_utf8(out.stdout).unwrap()
    }

    /// Runs a command that must fail with an exit code and messages.
    fn refused(&self, words: &[&str], code: i32, said: &[&str]) {
        let out = self.cvtcycle(words);
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(code), "{words:?}: {stderr}");
        for part in said {
            assert!(
                stderr.contains(part),
                "{words:?} does not say `{part}`: {stderr}"
            );
        }
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path().join(name)).unwrap()
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path().join(name), text).unwrap();
    }

    fn has(&self, name: &str) -> bool {
        self.path().join(name).exists()
    }
}

/// Quick run of two cars.
fn run(place: &Place, dir: &str, more: &[&str]) {
    let words = [
        "run",
        "--cycle",
        "ece15",
        "--ambient",
        "-10",
        "--baseline",
        "rover_216_5mt",
        "--sensitivity",
        "never",
        "--quiet",
        "--out",
        dir,
    ];
    place.done(&[&words[..], more].concat());
}

/// Run at low temperature with its report.
fn reported() -> Place {
    let place = Place::new();
    run(&place, "cold", &[]);
    place.done(&["report", "cold"]);
    place
}

/// Ambient matrix of the same cycle.
fn matrix(place: &Place, dir: &str) {
    place.done(&[
        "study", "ambient", "--cycle", "ece15", "--quiet", "--out", dir,
    ]);
}

/// Text of a page without markup.
fn words_of(page: &str) -> String {
    // A possible line break within a key is not a space.
    let page = page.replace("<wbr>", "");
    let body = &page[page.find("<main").unwrap()..page.find("</main>").unwrap()];
    let mut text = String::new();
    let mut inside = false;
    for c in body.chars() {
        match c {
            '<' => {
                inside = true;
                text.push(' ');
            }
            '>' => inside = false,
            c if !inside => text.push(if c == '\u{a0}' { ' ' } else { c }),
            _ => {}
        }
    }
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Drawing of each figure, from its page; without those for a narrow screen.
fn drawings(page: &str) -> Vec<&str> {
    page.match_indices("<svg")
        .filter(|(at, _)| {
            let before = page[..*at].rsplit("class=\"drawing").next();
            before.is_some_and(|rest| !rest.starts_with(" narrow"))
        })
        .map(|(at, _)| &page[at..at + page[at..].find("</svg>").unwrap() + 6])
        .collect()
}

#[test]
fn the_page_says_what_the_summary_says() {
    let place = Place::new();
    run(&place, "cold", &[]);
    let said = place.done(&["report", "cold", "--full"]);
    assert!(said.contains("cold/report.html"));
    let page = place.text("cold/report.html");
    let words = words_of(&page);
    let summary: Value = serde_json::from_str(&place.text("cold/summary.json")).unwrap();
    let number = |value: &Value, decimals: usize| format!("{:.decimals$}", value.as_f64().unwrap());
    for run in summary["runs"].as_array().unwrap() {
        for (key, decimals) in [("fuel_l_per_100km", 2), ("distance_km", 3)] {
            assert!(words.contains(&number(&run[key], decimals)), "{key}");
        }
        for (name, kj) in run["loss_kj"].as_object().unwrap() {
            if kj.as_f64().is_some_and(|kj| kj < 999.0)
                && !["accessories", "brake"].contains(&name.as_str())
            {
                assert!(words.contains(&number(kj, 1)), "{name} {kj}");
            }
        }
        for degc in run["end_degc"]
            .as_object()
            .unwrap()
            .values()
            .filter(|x| x.is_number())
        {
            assert!(
                words.contains(&number(degc, 1).replace('-', "\u{2212}")),
                "{degc}"
            );
        }
    }
    let percent = summary["comparison"][0]["fuel_percent"].as_f64().unwrap();
    assert!(
        percent > 0.0 && words.contains(&format!("{percent:.1} % more than")),
        "{percent}"
    );
    assert!(
        words.contains("cvtcycle run --cycle ece15 --ambient -10"),
        "the exact command"
    );
    for hash in page.match_indices("SHA-256").map(|(at, _)| at).take(1) {
        assert!(
            page[hash..]
                .replace("<wbr>", "")
                .contains("embedded:rover_216_cvt.toml")
        );
    }
}

/// Cars with equal short names keep the names of their files, since equal table heads are ambiguous.
#[test]
fn cars_have_short_names_if_these_are_unique() {
    let place = reported();
    let page = place.text("cold/report.html");
    assert!(
        page.contains(">CVT</th>") || page.contains(">CVT <"),
        "a head of a column"
    );
    assert!(!words_of(&page).contains("rover_216_cvt uses"));
    let car = fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/vehicles/rover_216_5mt.toml"
    ));
    place.write("twice.toml", &car.unwrap());
    run(&place, "two", &["--baseline", "twice.toml"]);
    let summary: Value = serde_json::from_str(&place.text("two/summary.json")).unwrap();
    let shorts: Vec<&str> = (0..3)
        .map(|k| summary["runs"][k]["short"].as_str().unwrap())
        .collect();
    assert_eq!(shorts, ["CVT", "rover_216_5mt", "twice"]);
}

/// Numbers of a sentence with their decimals, without those in names such as 5-speed or ECE15.
fn numbers_of(sentence: &str) -> Vec<(f64, usize)> {
    let words = sentence.split([' ', '\u{a0}', ':', ';', '(', ')', '%', '/']);
    let words = words.map(|word| word.trim_matches([',', '.', '+']).replace('\u{2212}', "-"));
    let number = |word: String| {
        let decimals = word.split_once('.').map_or(0, |(_, rest)| rest.len());
        Some((word.replace('\u{202f}', "").parse().ok()?, decimals))
    };
    words.filter_map(number).collect()
}

/// The title of a waterfall has the two largest changes of its table, each with its sign.
fn names_the_largest_terms(title: &str, table: &str) {
    let rows = table.split("<tr>").skip(1);
    let cells = rows.map(|row| {
        let cells = row.split("<t").skip(1);
        let texts = cells.map(|cell| cell.split(['>', '<']).nth(1).unwrap().trim());
        texts.collect::<Vec<_>>()
    });
    let change = |cells: Vec<&str>| {
        let change: f64 = cells[1].replace('\u{2212}', "-").parse().ok()?;
        Some((cells[0].to_owned(), change))
    };
    // The last row is the fuel of the subject, with the sum of all changes.
    let mut changes: Vec<(String, f64)> = cells.filter_map(change).collect();
    changes.pop().unwrap();
    changes.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let named = changes.iter().take(2).map(|(name, change)| {
        let word = if *change < 0.0 { "less" } else { "more" };
        format!("{word} for {name}")
    });
    let named = named.collect::<Vec<_>>().join(" and ");
    assert!(
        title.ends_with(&format!(": {named}")),
        "{title}: {changes:?}"
    );
}

/// Every number of a title is one of the numbers of its figure, rounded.
#[test]
fn titles_have_the_numbers_of_their_tables() {
    let place = Place::new();
    place.done(&[
        "run",
        "--ambient",
        "-10",
        "--baseline",
        "rover_216_5mt",
        "--baseline",
        "mondeo_20_5mt",
        "--sensitivity",
        "never",
        "--quiet",
        "--out",
        "cold",
    ]);
    place.done(&[
        "levers",
        "--ambient",
        "-10",
        "--samples",
        "8",
        "--quiet",
        "--out",
        "cold/levers",
    ]);
    place.done(&[
        "validate",
        "--chapter",
        "3",
        "--quiet",
        "--out",
        "cold/check",
    ]);
    place.done(&["report", "cold", "--quiet"]);
    let page = place.text("cold/report.html");
    for id in [
        "answer",
        "options",
        "waterfall",
        "waterfall_rover_216_5mt",
        "repeats",
        "repeats_mondeo_20_5mt",
        "price_rover_216_cvt",
        "agreement",
    ] {
        let figure = page.split(&format!("id=\"fig-{id}\"")).nth(1).unwrap();
        let figure = &figure[..figure.find("</figure>").unwrap()];
        // Sentence without the line below it that has car and condition.
        let texts = figure.split("<text ").skip(1);
        let bold = texts.take_while(|text| text.split('>').next().unwrap().contains("bold"));
        let lines = bold.map(|text| text.split(['>', '<']).nth(1).unwrap());
        let title = &lines.collect::<Vec<_>>().join(" ");
        let table = &figure[figure.find("<tbody>").unwrap()..];
        let cells = table
            .split(['<', '>'])
            .map(|cell| cell.replace('\u{2212}', "-"));
        let cells: Vec<f64> = cells.filter_map(|cell| cell.parse().ok()).collect();
        let found = numbers_of(title);
        // The difference of two cars has a range, which is with the answer: a waterfall names its largest terms and their signs.
        if id.starts_with("waterfall") {
            assert!(found.is_empty(), "{id}: {title}");
            names_the_largest_terms(title, table);
            continue;
        }
        assert!(!found.is_empty(), "{id}: {title}");
        for (x, decimals) in found {
            let close = 0.5 * 10f64.powi(-(decimals as i32)) + 0.051;
            let is_there = |cell: &f64| (cell.abs() - x.abs()).abs() <= close;
            assert!(
                cells.iter().any(is_there),
                "{id}: {x} of {title:?} is not in {cells:?}"
            );
        }
    }
    // The body is short; the full report has the rest.
    let others = page.matches("<details class=\"view").count();
    let count = drawings(&page).len() - others;
    assert!(others >= 5, "the same figures of other cars: {others}");
    place.done(&["report", "cold", "--full", "--quiet", "--out", "full.html"]);
    assert!(
        count <= 10 && drawings(&place.text("full.html")).len() > 2 * count,
        "{count}"
    );
}

/// Independent truth: a second XML parser, and the table of a figure against its trace.
#[test]
fn val_figures_are_whole_and_their_tables_are_the_trace() {
    let place = Place::new();
    run(&place, "cold", &[]);
    place.done(&["report", "cold", "--quiet", "--full"]);
    let page = place.text("cold/report.html");
    let drawings = drawings(&page);
    let files: Vec<_> = fs::read_dir(place.path().join("cold/report_figures"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    assert!(
        drawings.len() >= 15 && drawings.len() == files.len(),
        "{} {}",
        drawings.len(),
        files.len()
    );
    for svg in drawings
        .iter()
        .copied()
        .map(str::to_owned)
        .chain(files.iter().map(|f| fs::read_to_string(f).unwrap()))
    {
        let document = roxmltree::Document::parse(&svg).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let root = document.root_element();
        assert!(
            root.children().any(|n| n.has_tag_name("title"))
                && root.children().any(|n| n.has_tag_name("desc"))
        );
        let width: f64 = root.attribute("width").unwrap().parse().unwrap();
        assert!(width <= 880.0, "{width} px is too wide for A4");
    }
    // Ids are unique in the page.
    let mut ids: Vec<&str> = page
        .match_indices(" id=\"")
        .map(|(at, _)| page[at + 5..].split('"').next().unwrap())
        .collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(count, ids.len());
    // Final sump temperature from the trace's last row, in the table of the warm-up figure.
    let trace = place.text("cold/trace_rover_216_cvt.csv");
    let mut reader = csv::Reader::from_reader(trace.as_bytes());
    let column = reader
        .headers()
        .unwrap()
        .iter()
        .position(|h| h == "transmission_sump_degc")
        .unwrap();
    let last: f64 = reader.records().last().unwrap().unwrap()[column]
        .parse()
        .unwrap();
    let figure = &page[page.find("id=\"fig-temperatures\"").unwrap()..];
    let table = &figure[figure.find("<tbody>").unwrap()..figure.find("</tbody>").unwrap()];
    let row = &table[table.rfind("<tr").unwrap()..];
    let shown: Vec<f64> = row
        .split(['<', '>'])
        .filter_map(|cell| cell.replace('\u{2212}', "-").parse().ok())
        .collect();
    assert!(
        shown.iter().any(|x| (x - last).abs() <= 0.051),
        "{last} in {shown:?}"
    );
}

#[test]
fn the_same_run_gives_the_same_page_and_is_not_in_the_way_of_the_next() {
    let place = reported();
    let first = place.text("cold/report.html");
    place.refused(&["report", "cold"], 2, &["is there already", "--force"]);
    place.done(&["report", "cold", "--force"]);
    assert_eq!(first, place.text("cold/report.html"));
    run(&place, "cold", &["--force"]);
    let said: Value =
        serde_json::from_str(&place.done(&["report", "cold", "--force", "--json"])).unwrap();
    assert_eq!(
        said["figures"].as_array().unwrap().len(),
        drawings(&first).len()
    );
    // First completes the pending commit of a killed command, then replaces the figures of an earlier report.
    let (page, summary) = (
        place.text("cold/report.html"),
        place.text("cold/summary.json"),
    );
    place.write("cold/report_figures/old.svg", "old");
    place.write("cold/.cvtcycle-0.tmp", &summary);
    place.write("cold/summary.json", "{}");
    place.write(
        "cold/.cvtcycle-commit.json",
        r#"{"schema":1,"build":"","files":[[".cvtcycle-0.tmp","summary.json"]],"remove":[]}"#,
    );
    place.done(&["report", "cold", "--force"]);
    assert_eq!(place.text("cold/report.html"), page);
    assert_eq!(place.text("cold/summary.json"), summary);
    for gone in [
        "report_figures/old.svg",
        ".cvtcycle-0.tmp",
        ".cvtcycle-commit.json",
    ] {
        assert!(!place.has(&format!("cold/{gone}")), "{gone}");
    }
    // A folder with another file of the user is kept.
    place.write("cold/report_figures/mine.txt", "x");
    place.refused(
        &["report", "cold", "--force"],
        2,
        &["something else than figures", "mine.txt"],
    );
    assert!(place.has("cold/report_figures/mine.txt"));
}

/// Names of files and phases that Markdown, HTML or a URL would misinterpret.
#[test]
fn every_link_of_a_markdown_report_names_a_file_that_is_there() {
    let place = Place::new();
    let car = fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/vehicles/rover_216_5mt.toml"
    ))
    .unwrap();
    for name in [
        "my car (v2)",
        "a<img src=x onerror=alert(1)>",
        "a b",
        "a_b",
        "ü%",
    ] {
        place.write(&format!("{name}.toml"), &car);
    }
    place.write(
        "short.csv",
        "time_s,speed_kmh,phase\n0,0,a](x)\n4,0,a](x)\n14,32,<b>\n24,32,<b>\n34,0,<b>\n",
    );
    let words = "run --cycle short.csv --sensitivity never --quiet --out run --vehicle";
    let mut words: Vec<&str> = words.split(' ').collect();
    words.push("my car (v2).toml");
    for name in [
        "a<img src=x onerror=alert(1)>.toml",
        "a b.toml",
        "a_b.toml",
        "ü%.toml",
    ] {
        words.extend(["--baseline", name]);
    }
    place.done(&words);
    place.done(&[
        "report",
        "run",
        "--quiet",
        "--full",
        "--out",
        "my (report) ü.md",
    ]);
    let text = place.text("my (report) ü.md");
    let links = text.match_indices("](");
    let links = links.filter(|(at, _)| !text[..*at].ends_with('\\'));
    let links = links.map(|(at, _)| text[at + 2..].split(')').next().unwrap());
    let links: Vec<&str> = links.collect();
    let files = fs::read_dir(place.path().join("my (report) ü_figures")).unwrap();
    assert_eq!(links.len(), files.count());
    for link in links {
        assert!(link.is_ascii(), "{link}");
        let mut pieces = link.split('%');
        let mut path = pieces.next().unwrap().as_bytes().to_vec();
        for piece in pieces {
            path.push(u8::from_str_radix(&piece[..2], 16).unwrap());
            path.extend(piece[2..].bytes());
        }
        let path = String::from_utf8(path).unwrap();
        assert!(place.has(&path), "{link} is not there");
    }
    assert!(!text.contains('<'), "markup is escaped");
}

#[test]
fn a_year_of_traces_stays_small() {
    let place = Place::new();
    place.done(&[
        "run",
        "--cycle",
        "ftp75",
        "--sensitivity",
        "never",
        "--quiet",
        "--out",
        "ftp",
    ]);
    place.done(&["report", "ftp", "--quiet", "--full"]);
    let size = fs::metadata(place.path().join("ftp/report.html"))
        .unwrap()
        .len();
    assert!(size < 3_000_000, "{size} bytes");
    let words = words_of(&place.text("ftp/report.html"));
    assert!(
        words.contains("weighted") && words.contains("cold transient"),
        "bags and weighted fuel"
    );
}

#[test]
fn names_and_remarks_are_shown_as_text() {
    let place = Place::new();
    let vehicle = place.done(&["show", "rover_216_cvt", "--help"]);
    assert!(!vehicle.is_empty());
    let source = fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/vehicles/rover_216_cvt.toml"
    ))
    .unwrap();
    let line = source
        .lines()
        .find(|line| line.trim_start().starts_with("title"))
        .unwrap()
        .to_owned();
    place.write(
        "own.toml",
        &source.replace(&line, "title = \"<script>alert(1)</script> & <b>bold</b>\""),
    );
    place.write(
        "cover.toml",
        "author = \"<i>me</i>\"\n[remarks]\nanswer = \"<img src=x onerror=alert(2)> | *so*\"\n",
    );
    let words = "run --cycle ece15 --vehicle own.toml --baseline none --sensitivity never --quiet";
    let words: Vec<&str> = words.split(' ').chain(["--out", "own"]).collect();
    place.done(&words);
    place.done(&["report", "own", "--cover", "cover.toml"]);
    let page = place.text("own/report.html");
    for bad in ["<script>alert", "<b>bold", "<i>me", "<img src=x"] {
        assert!(!page.contains(bad), "{bad}");
    }
    let words = words_of(&page);
    assert!(
        words.contains("alert(1)") && words.contains("onerror=alert(2)"),
        "they are there, as text"
    );
    place.done(&["report", "own", "--cover", "cover.toml", "--format", "md"]);
    let text = place.text("own/report.md");
    assert!(!text.contains("<script>") && !text.contains("<img") && text.contains("\\| \\*so\\*"));
    assert_eq!(
        text.matches("](report_figures/").count(),
        drawings(&page).len()
    );
}
