//! Include files: values of a page with their status, labels as in the code, validation rows.

use super::{PAGES, Page};
use cvtcycle::config::setup::assumptions::value;
use cvtcycle::config::setup::{Options, load};
use cvtcycle::config::{KeyInfo, render};
use cvtcycle::equations::by_label;
use std::fmt::Write as _;
use std::path::Path;

/// First line of the tables of labels.
const MADE_FROM_HEADS: &str =
    "<!-- Written by `tools/docs` from the heads of the model files. -->\n";

/// Labelled equation of a page: `**BT-3** (derived)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Labelled {
    /// Label of the equation or table.
    pub label: String,
    /// Status words in brackets.
    pub status: String,
    /// True if a displayed equation follows.
    pub displayed: bool,
}

/// Labelled equations of a page in order.
pub fn labelled(page: &str) -> Vec<Labelled> {
    let mut list = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        let Some((label, rest)) = line.strip_prefix("**").and_then(|l| l.split_once("** (")) else {
            continue;
        };
        let Some((status, _)) = rest.split_once(')') else {
            continue;
        };
        if label.len() < 4 || label.as_bytes()[2] != b'-' {
            continue;
        }
        let next = lines
            .clone()
            .take_while(|l| !l.starts_with("**") && !l.starts_with('#'))
            .any(|l| l.starts_with("$$"));
        list.push(Labelled {
            label: label.to_owned(),
            status: status.to_owned(),
            displayed: next,
        });
    }
    list
}

/// Tables of values and labels of every page.
pub fn files(source: &Path) -> Result<Vec<(String, String)>, String> {
    let mut files = Vec::new();
    for page in &PAGES {
        let path = source.join(format!("{}.md", page.stem));
        let text =
            std::fs::read_to_string(&path).map_err(|why| format!("{}: {why}", path.display()))?;
        let labels = labelled(&text);
        files.push((
            format!("generated/labels_{}.md", page.stem),
            label_table(&labels),
        ));
        files.push((
            format!("generated/values_{}.md", page.stem),
            value_table(page, &labels)?,
        ));
    }
    files.push(("generated/labels_all.md".to_owned(), index(source)?));
    Ok(files)
}

/// Table of all labels with their pages, in the order of the book.
fn index(source: &Path) -> Result<String, String> {
    let mut text = MADE_FROM_HEADS.to_owned()
        + "\n| label | page | statement in the code | status |\n|---|---|---|---|\n";
    for stem in PAGES.iter().map(|page| page.stem).chain([
        "accelerate",
        "attribution",
        "chain",
        "cold",
        "optimum",
        "cycles",
        "label",
        "levers",
        "one_sample",
        "forms",
        "physics_checks",
        "rigs",
        "start_stop",
        "starter_generator",
        "steps",
        "studies",
        "torque_converter",
        "two_ranges",
    ]) {
        let path = source.join(format!("{stem}.md"));
        let page =
            std::fs::read_to_string(&path).map_err(|why| format!("{}: {why}", path.display()))?;
        let title = page
            .lines()
            .next()
            .unwrap_or_default()
            .trim_start_matches("# ");
        for e in labelled(&page).iter().filter_map(|l| by_label(&l.label)) {
            // Writing to a String is infallible, here and below.
            let _ = writeln!(
                text,
                "| [{0}]({stem}.md#{0}) | {title} | {1} | {2} |",
                e.label,
                plain(e.statement),
                plain(e.status)
            );
        }
    }
    Ok(text)
}

/// Keys of the page in its vehicle.
pub fn keys(page: &Page, labels: &[Labelled]) -> Result<Vec<KeyInfo>, String> {
    let setup =
        load(page.vehicle, &Options::default()).map_err(|problems| render(&problems, false))?;
    let named = |key: &str| {
        page.keys.iter().any(|k| {
            key == *k
                || (k.ends_with('.') && key.starts_with(k))
                || key.starts_with(&format!("{k}.")) && *k != "transmission"
        })
    };
    let of_page = |info: &KeyInfo| labels.iter().any(|l| info.labels.contains(&&*l.label));
    // Leaves out the friction of the engine oil, which the belt does not use.
    let useful = |key: &str| !key.starts_with("engine_oil.friction");
    Ok(setup
        .keys
        .into_iter()
        .filter(|info| useful(&info.key) && (named(&info.key) || of_page(info)))
        .collect())
}

fn value_table(page: &Page, labels: &[Labelled]) -> Result<String, String> {
    let mut text = format!(
        "<!-- Written by `tools/docs` from vehicle `{}`. -->\n",
        page.vehicle
    );
    let keys = keys(page, labels)?;
    if keys.is_empty() {
        text += "\nNo values of its own.\n";
        return Ok(text);
    }
    text += "\n| key | value | status | source | meaning |\n|---|---|---|---|---|\n";
    for info in &keys {
        let source = [info.source.as_str(), info.note.as_str()]
            .iter()
            .filter(|s| !s.is_empty())
            .copied()
            .collect::<Vec<_>>()
            .join("; ");
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} | {} |",
            info.key,
            cell(&value(info)),
            info.status,
            cell(&source),
            cell(&info.doc)
        );
    }
    Ok(text)
}

fn label_table(labels: &[Labelled]) -> String {
    let mut text = MADE_FROM_HEADS.to_owned();
    if labels.is_empty() {
        text += "\nNo equations of its own.\n";
        return text;
    }
    text += "\n| label | statement in the code | status | module |\n|---|---|---|---|\n";
    for Labelled { label, .. } in labels {
        match by_label(label) {
            Some(e) => {
                // Bars are already escaped in the heads.
                let _ = writeln!(
                    text,
                    "| {} | {} | {} | `{}` |",
                    e.label,
                    plain(e.statement),
                    plain(e.status),
                    e.module
                );
            }
            None => {
                let _ = writeln!(text, "| {label} | not in the code | | |");
            }
        }
    }
    text
}

/// Escapes underlines, stars and angle brackets for Markdown.
fn plain(text: &str) -> String {
    text.replace('_', "\\_")
        .replace('*', "\\*")
        .replace('<', "&lt;")
        .replace('$', "\\$")
}

fn cell(text: &str) -> String {
    plain(text).replace('|', "\\|").replace('[', "\\[")
}
