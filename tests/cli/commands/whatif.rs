//! `whatif` and `report --live`: the page, its embedded files, and refused input.
//!
//! Truth: the files themselves, and `run`, which prints the first answer of the page. `tools/browser/live.test.mjs` tests the page in a browser.

use super::{one_line, run_in, stderr, stdout};
use std::fs;
use std::path::Path;

/// Removes tags from HTML, and converts signs to those of the terminal.
fn plain(html: &str) -> String {
    let mut text = String::new();
    let mut inside = false;
    for c in html.chars() {
        match c {
            '<' => inside = true,
            '>' => inside = false,
            '\u{2212}' if !inside => text.push('-'),
            '\u{a0}' if !inside => text.push(' '),
            c if !inside => text.push(c),
            _ => {}
        }
    }
    text
}

/// The page begins with the sentence of the run, and embeds the files of its car: a measured map, by the path in the vehicle file.
#[test]
fn a_page_of_a_users_car_has_its_files_and_begins_with_the_run() {
    let dir = tempfile::tempdir().unwrap();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/own_tables");
    for file in ["box.toml", "box_loss.csv"] {
        fs::copy(source.join(file), dir.path().join(file)).unwrap();
    }
    let car = ["--ambient", "5", "--baseline", "twin", "--cycle", "ece15"];
    let made = run_in(dir.path(), &[&["whatif", "box.toml"], &car[..]].concat());
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    assert_eq!(stdout(&made), "whatif.html\n");
    let page = fs::read_to_string(dir.path().join("whatif.html")).unwrap();
    let (_, scene) = page.split_once("id=\"live-scene\">").unwrap();
    let scene = scene.split_once("</script>").unwrap().0;
    let scene: serde_json::Value = serde_json::from_str(scene).unwrap();
    let files = scene["files"].as_object().unwrap();
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    assert_eq!(names, ["box.toml", "box_loss.csv"]);
    let words = [
        "run",
        "--vehicle",
        "box.toml",
        "--draws",
        "256",
        "--price",
        "never",
    ];
    let printed = stdout(&run_in(dir.path(), &[&words[..], &car[..]].concat()));
    let printed = one_line(printed.split("\n\n").next().unwrap());
    let (_, lead) = page.split_once("<p class=\"lead\">").unwrap();
    let lead = one_line(&plain(lead.split_once("</p>").unwrap().0));
    let numbers = |text: &str| -> Vec<String> {
        let words = text
            .split(' ')
            .map(|word| word.trim_matches(|c: char| !c.is_ascii_digit()));
        words
            .filter(|word| word.parse::<f64>().is_ok())
            .map(str::to_owned)
            .collect()
    };
    let printed = printed.split(". ").next().unwrap();
    assert!(numbers(&lead).len() >= 5, "{lead}");
    assert_eq!(numbers(&lead), numbers(printed), "{lead}\n{printed}");
}

/// As `report`: similar names for unknown ones, no replacement without --force, and only pages of this program are replaced.
#[test]
fn bad_input_leaves_no_page() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("there.html"), "mine").unwrap();
    for (words, says) in [
        (&["whatif", "rover_216_cv"][..], "rover_216_cvt"),
        (&["whatif", "--out", "there.html"], "there already"),
        (
            &["whatif", "--out", "there.html", "--force"],
            "is no report",
        ),
        (&["whatif", "--out", "page.txt"], ".html"),
        (&["whatif", "--ambient", "70"], "-40 to 60"),
        (&["whatif", "--set", "engine.nothing=1"], "engine.nothing"),
        (&["whatif", "--cycle", "ece15_euc"], "ece15_eudc"),
    ] {
        let refused = run_in(dir.path(), words);
        assert_eq!(refused.status.code(), Some(2), "{words:?}");
        assert!(
            stderr(&refused).contains(says),
            "{words:?}: {}",
            stderr(&refused)
        );
        assert_eq!(stdout(&refused), "");
    }
    let left: Vec<_> = fs::read_dir(dir.path()).unwrap().collect();
    assert_eq!(left.len(), 1);
    assert_eq!(
        fs::read_to_string(dir.path().join("there.html")).unwrap(),
        "mine"
    );
}

/// The live section of a report has the run's own car and conditions. A car file changed since the run is refused.
#[test]
fn a_report_is_driven_again_with_the_cars_of_its_run() {
    let dir = tempfile::tempdir().unwrap();
    let car = Path::new(env!("CARGO_MANIFEST_DIR")).join("vehicles/rover_216_cvt.toml");
    fs::copy(&car, dir.path().join("own.toml")).unwrap();
    let run = [
        "run",
        "--vehicle",
        "own.toml",
        "--cycle",
        "ece15",
        "--ambient",
        "-7",
        "--out",
        "cold",
    ];
    let more = [
        "--set",
        "road_load.mass_kg=1200",
        "--sensitivity",
        "never",
        "--price",
        "never",
    ];
    let driven = run_in(dir.path(), &[&run[..], &more[..]].concat());
    assert_eq!(driven.status.code(), Some(0), "{}", stderr(&driven));
    let report = ["report", "cold", "--stored", "--live", "--out", "cold.html"];
    let made = run_in(dir.path(), &report);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let page = fs::read_to_string(dir.path().join("cold.html")).unwrap();
    let (_, command) = page.split_once("id=\"live-command\">").unwrap();
    let command = command.split_once('<').unwrap().0;
    for part in [
        "--vehicle own.toml",
        "--cycle ece15",
        "--ambient -7",
        "--set road_load.mass_kg=1200",
    ] {
        assert!(command.contains(part), "{command}");
    }
    let text = fs::read_to_string(&car).unwrap();
    fs::write(dir.path().join("own.toml"), text.replace("1130", "1131")).unwrap();
    let refused = run_in(dir.path(), &[&report[..], &["--force"]].concat());
    assert_eq!(
        refused.status.code(),
        Some(0),
        "the mass is set, so that the car is the same"
    );
    fs::write(
        dir.path().join("own.toml"),
        fs::read_to_string(&car).unwrap().replace(
            "displacement_cc_rev = {",
            "displacement_cc_rev = { value = 7.0 } # {",
        ),
    )
    .unwrap();
    let refused = run_in(dir.path(), &[&report[..], &["--force"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert!(one_line(&stderr(&refused)).contains("not found again as it was driven"));
    let markdown = run_in(dir.path(), &["report", "cold", "--live", "--format", "md"]);
    assert_eq!(markdown.status.code(), Some(2));
    assert!(stderr(&markdown).contains("--live"));
}
