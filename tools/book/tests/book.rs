//! The book in docs/book against the program: labels, status words, equations, figures, tables, links.
//!
//! Truth: the heads of the model files and the registry of keys. Figures and tables are not in git; `tools/docs` writes
//! them, and these tests generate them in memory.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs::read_to_string;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use cvtcycle::equations::{Equation, by_label, equations};

use cvtcycle_book::figures::tables::{keys, labelled};
use cvtcycle_book::figures::{PAGES, files};
use cvtcycle_book::latex;

/// Figures and tables as written by `tools/docs`: name below `src`, text.
static MADE: LazyLock<BTreeMap<String, String>> =
    LazyLock::new(|| files(&folder()).unwrap().into_iter().collect());

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/book/src")
}

fn text_of(name: &str) -> String {
    read_to_string(folder().join(name))
        .unwrap_or_else(|why| panic!("docs/book/src/{name}: {why}"))
        .replace("\r\n", "\n")
}

/// Pages by name, without the summary.
fn pages() -> BTreeMap<String, String> {
    let entries = std::fs::read_dir(folder()).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let pages = names.filter(|name| name.ends_with(".md") && name != "SUMMARY.md");
    pages.map(|name| (name.clone(), text_of(&name))).collect()
}

/// Targets of `](target)` in a text.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    text.match_indices("](")
        .filter_map(|(at, _)| text[at + 2..].split_once(')').map(|(target, _)| target))
}

/// Files included by a text.
fn includes(text: &str) -> impl Iterator<Item = &str> {
    text.match_indices("{{#include ").filter_map(|(at, mark)| {
        text[at + mark.len()..]
            .split_once("}}")
            .map(|(name, _)| name)
    })
}

/// Words of a status that the book repeats, in order.
fn words(status: &str) -> Vec<&'static str> {
    ["source", "derived", "fitted", "ASSUMED", "contract"]
        .into_iter()
        .filter(|word| status.contains(word))
        .collect()
}

/// Equations with a page; those of the fit are in `docs/calibration.md` in words.
fn in_book() -> impl Iterator<Item = Equation> {
    equations().filter(|equation| !equation.module.starts_with("calibrate"))
}

#[test]
fn every_label_of_the_code_is_one_equation_of_the_book() {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut wrong = Vec::new();
    for (name, text) in pages() {
        for l in labelled(&text) {
            if !l.displayed {
                wrong.push(format!("{name}: no equation follows label {}", l.label));
            }
            if by_label(&l.label).is_none() {
                wrong.push(format!("{name}: label {} is none of the code's", l.label));
            }
            found.entry(l.label).or_default().push(name.clone());
        }
    }
    for e in in_book() {
        match found.get(e.label).map(Vec::as_slice) {
            None => wrong.push(format!(
                "{} ({}: {}) is not in the book: add `**{}** ({})` and its equation to a page",
                e.label,
                e.module,
                e.statement,
                e.label,
                words(e.status).join(", ")
            )),
            Some([_]) => {}
            Some(places) => wrong.push(format!(
                "{} is there more than once: {}",
                e.label,
                places.join(", ")
            )),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(found.len() > 80, "{}", found.len());
}

#[test]
fn status_words_are_those_of_the_code() {
    let mut wrong = Vec::new();
    for (name, text) in pages() {
        for l in labelled(&text) {
            let Some(e) = by_label(&l.label) else {
                continue;
            };
            let expected = words(e.status).join(", ");
            if l.status != expected {
                wrong.push(format!(
                    "{name}: {} has ({}), the code ({expected}): {}",
                    l.label, l.status, e.status
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Lines of a table below its head.
fn rows(table: &str) -> Vec<&str> {
    let lines = table.lines().filter(|line| line.starts_with('|'));
    lines.skip(2).collect()
}

#[test]
fn tables_are_complete() {
    let mut labels = 0;
    for (name, text) in MADE.iter().filter(|(name, _)| name.ends_with(".md")) {
        assert!(text.starts_with("<!-- ") || text.starts_with('|'), "{name}");
        assert!(
            !text.contains("not in the code") && !text.contains("NaN"),
            "{name}"
        );
        let rows = rows(text);
        assert!(!rows.is_empty() || text.contains("of its own"), "{name}");
        let columns = |line: &str| line.replace("\\|", "").matches('|').count();
        let head = text
            .lines()
            .find(|line| line.starts_with('|'))
            .unwrap_or_default();
        assert!(
            rows.iter().all(|row| columns(row) == columns(head)),
            "{name}"
        );
        labels += if name.ends_with("labels_all.md") {
            rows.len()
        } else {
            0
        };
    }
    assert_eq!(
        labels,
        in_book().count(),
        "every equation has a line in labels_all.md"
    );
}

/// Anchors of a page: labels and headings, as mdBook makes them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text
        .lines()
        .filter(|line| line.starts_with('#'))
        .map(|line| {
            let title = line.trim_start_matches('#').trim().to_lowercase();
            title
                .chars()
                .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
                .collect::<String>()
                .replace(' ', "-")
        });
    headings
        .chain(labelled(text).into_iter().map(|l| l.label))
        .collect()
}

#[test]
fn links_pictures_and_includes_exist() {
    let pages = pages();
    let mut wrong = Vec::new();
    let mut pictures = BTreeSet::new();
    for (name, text) in &pages {
        for target in targets(text).filter(|target| !target.starts_with("http")) {
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let file = if file.is_empty() { name } else { file };
            if !folder().join(file).is_file() && !MADE.contains_key(file) {
                wrong.push(format!("{name}: {target} does not exist"));
            } else if !anchor.is_empty()
                && !pages
                    .get(file)
                    .is_some_and(|text| anchors(text).contains(anchor))
            {
                wrong.push(format!("{name}: {file} has no {anchor}"));
            }
            pictures.extend(file.strip_prefix("img/").map(str::to_owned));
        }
        // tests/results/validate.rs covers the tables of validation rows.
        let tables = includes(text).filter(|file| !file.starts_with("generated/validation_"));
        for file in tables.filter(|file| !pages.contains_key(*file) && !MADE.contains_key(*file)) {
            wrong.push(format!("{name}: include {file} does not exist"));
        }
    }
    let included: BTreeSet<&str> = pages.values().flat_map(|text| includes(text)).collect();
    for name in MADE.keys() {
        let picture = name.strip_prefix("img/");
        if !picture.map_or(included.contains(name.as_str()), |name| {
            pictures.contains(name)
        }) {
            wrong.push(format!("{name} is on no page"));
        }
    }
    let summary = text_of("SUMMARY.md");
    let linked: BTreeSet<&str> = targets(&summary).collect();
    for name in pages
        .keys()
        .filter(|name| !linked.contains(name.as_str()) && !included.contains(name.as_str()))
    {
        wrong.push(format!(
            "{name} is neither in SUMMARY.md nor included by a page"
        ));
    }
    wrong.extend(
        linked
            .iter()
            .filter(|name| !pages.contains_key(**name))
            .map(|name| format!("SUMMARY.md: {name} does not exist")),
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Mechanisms without published numbers of their own; their pages name the rows that include them.
const WITHOUT_ROWS: [&str; 3] = ["seal_ring", "pulley_bearing", "gear_train"];

#[test]
fn every_mechanism_has_its_parts() {
    for page in &PAGES {
        let (stem, text) = (page.stem, text_of(&format!("{}.md", page.stem)));
        assert!(
            text.contains("](img/") || text.contains("](drawings/"),
            "{stem}: no figure"
        );
        let headings = [
            "## Thesis and its program",
            "## Known gaps",
            "## Where each equation is from",
            "## Values of the ",
            "## Validation",
        ];
        let rule = if stem == "formulations" {
            "## What differs"
        } else {
            "## Validity"
        };
        for heading in headings
            .iter()
            .filter(|h| stem != "formulations" || !h.ends_with("program") && !h.ends_with("gaps"))
            .chain([&rule])
        {
            assert!(
                text.contains(&format!("\n{heading}")),
                "{stem}: no {heading}"
            );
        }
        let included: Vec<&str> = includes(&text).collect();
        let has_rows = !WITHOUT_ROWS.contains(&stem);
        for kind in ["labels", "values", "validation"] {
            let file = format!("generated/{kind}_{stem}.md");
            assert!(
                included.contains(&file.as_str()) == (has_rows || kind != "validation"),
                "{stem}: {file}"
            );
        }
        assert!(
            text.contains(&format!("<!-- validation:{stem} -->")) == has_rows,
            "{stem}: no place for its validation rows"
        );
    }
}

#[test]
fn every_value_of_the_car_is_on_a_page() {
    let mut shown: BTreeSet<String> = BTreeSet::new();
    for page in &PAGES {
        let text = text_of(&format!("{}.md", page.stem));
        shown.extend(
            keys(page, &labelled(&text))
                .unwrap()
                .into_iter()
                .map(|info| info.key),
        );
    }
    let setup = cvtcycle::config::setup::load(
        "rover_216_cvt",
        &cvtcycle::config::setup::Options::default(),
    )
    .unwrap();
    let all = setup
        .keys
        .iter()
        .filter(|info| !info.key.starts_with("engine_oil.friction"));
    let lost: Vec<&str> = all
        .filter(|info| !shown.contains(&info.key))
        .map(|info| info.key.as_str())
        .collect();
    assert!(lost.is_empty(), "on no page: {}", lost.join(", "));
}

#[test]
fn every_equation_becomes_sound_mathml() {
    let mut count = 0;
    for (name, text) in pages() {
        let page =
            latex::page(&text).unwrap_or_else(|problems| panic!("{name}: {}", problems.join("\n")));
        for (at, _) in page.match_indices("<math") {
            let math = &page[at..at + page[at..].find("</math>").unwrap() + 7];
            let document = roxmltree::Document::parse(math)
                .unwrap_or_else(|why| panic!("{name}: {why}: {math}"));
            assert!(
                document
                    .descendants()
                    .all(|node| !node.has_tag_name("merror")),
                "{name}: {math}"
            );
            // Characters that Markdown would interpret must be escaped.
            let bare = |c: char| {
                document
                    .descendants()
                    .filter_map(|n| n.text())
                    .any(|t| t.contains(c))
                    && math.contains(&format!(">{c}"))
            };
            assert!(
                !['*', '_', '|', '`'].into_iter().any(bare),
                "{name}: {math}"
            );
            count += 1;
        }
        for label in labelled(&text) {
            assert!(
                page.contains(&format!("<a id=\"{}\"></a>**", label.label)),
                "{name}: {}",
                label.label
            );
        }
    }
    assert!(count > 400, "{count}");
}

/// By hand: a fraction, a root, a subscript, Greek letters and cases become the elements of MathML.
#[test]
fn val_latex_turns_into_the_elements_of_mathml() {
    let page =
        latex::page("a $\\frac{\\alpha_p}{\\sqrt{x}}$, `$code$` and\n\n$$ \\begin{cases} 1 & I < 1 \\\\ 2 & I > 1 \\end{cases} $$\n")
            .unwrap();
    for part in [
        "<mfrac>",
        "<msqrt>",
        "<msub><mi>α</mi><mi>p</mi></msub>",
        "<mtable",
        "<mo>&lt;</mo>",
        "`$code$`",
        "display=\"block\"",
    ] {
        assert!(page.contains(part), "{part} in {page}");
    }
    assert!(
        latex::page("a $\\frac{1}{2$ b").is_err(),
        "a brace is missing"
    );
    assert!(latex::page("a $x b").is_err(), "no end");
}

#[test]
fn pictures_are_sound_and_say_what_they_show() {
    for (name, svg) in MADE.iter().filter(|(name, _)| name.ends_with(".svg")) {
        let document =
            roxmltree::Document::parse(svg).unwrap_or_else(|why| panic!("{name}: {why}"));
        let root = document.root_element();
        assert_eq!(root.attribute("role"), Some("img"), "{name}");
        for tag in ["title", "desc"] {
            let node = root.children().find(|node| node.tag_name().name() == tag);
            assert!(
                node.and_then(|node| node.text())
                    .is_some_and(|text| text.len() > 10),
                "{name}: {tag}"
            );
        }
        assert!(!svg.contains("NaN") && !svg.contains("href"), "{name}");
    }
}
