//! The book of assumptions: where every value and every equation comes from, as Markdown.

use std::collections::BTreeSet;

use super::catalogue::{self, File};
use crate::KeyInfo;
use cvtcycle_model::equations::Equation;
use cvtcycle_model::transmission::loss_factor;

/// Statuses in the order in which a reader should worry about them.
const STATUSES: [(&str, &str); 4] = [
    ("assumed", "not measured; a judgement, with its reason"),
    (
        "fitted",
        "chosen so that the model meets a measured statement",
    ),
    ("derived", "follows from sources by calculation"),
    ("source", "printed or published"),
];

/// The whole book, with these equations. The same program gives the same text.
#[must_use]
pub fn book(equations: &[Equation]) -> String {
    let mut files = catalogue::files();
    for file in &mut files {
        file.keys.retain(|info| !loss_factor::is_key(&info.key));
    }
    let mut text = "# Book of assumptions\n\n\
        Printed by `cvtcycle assumptions` from the vehicle files, the lubricant files, the rig files and the heads of the model files; do not \
        edit it by hand.\n\n"
        .to_owned();
    for (status, words) in STATUSES {
        text += &format!("- **{status}**: {words}\n");
    }
    text.push_str("- **default**: no file gives it; the program's own value\n\n");
    text.push_str("How far the assumed and fitted values may be off, and what that does to the comparison: `docs/uncertainty.md`.\n\n");
    counts(&mut text, &files);
    for file in &files {
        file_section(&mut text, file);
    }
    defaults(&mut text, &files);
    equations_section(&mut text, equations);
    text
}

/// A row of a table; bars in a cell are escaped.
fn row(text: &mut String, cells: &[&str]) {
    for cell in cells {
        *text += &format!("| {} ", cell.replace('|', "\\|"));
    }
    text.push_str("|\n");
}

fn counts(text: &mut String, files: &[File]) {
    text.push_str("| file | assumed | fitted | derived | source | default |\n|---|---:|---:|---:|---:|---:|\n");
    let statuses = STATUSES.iter().map(|(status, _)| *status);
    let statuses: Vec<&str> = statuses.chain(["default"]).collect();
    for file in files {
        let count = |status: &&str| {
            let keys = file.keys.iter().filter(|info| info.status == *status);
            keys.count().to_string()
        };
        let counts: Vec<String> = statuses.iter().map(count).collect();
        let cells = std::iter::once(file.name).chain(counts.iter().map(String::as_str));
        row(text, &cells.collect::<Vec<_>>());
    }
}

fn file_section(text: &mut String, file: &File) {
    let is_title = |info: &&KeyInfo| info.key.ends_with("title");
    let title = file.keys.iter().find(is_title);
    let title = title.map_or("", |info| &info.value);
    let mut kind = file.kind.word().to_owned();
    kind[..1].make_ascii_uppercase();
    *text += &format!("\n## {kind} `{}`: {title}\n", file.name);
    for (status, _) in STATUSES {
        let has_status = |info: &&KeyInfo| info.status == status && !is_title(info);
        let mut keys = file.keys.iter().filter(has_status).peekable();
        if keys.peek().is_some() {
            *text += &format!("\n### {status}\n\n");
            text.push_str("| key | value | source | note | meaning |\n|---|---|---|---|---|\n");
        }
        for info in keys {
            let (key, value) = (format!("`{}`", info.key), value(info));
            row(
                text,
                &[&key, &value, &info.source, &info.note, &info.meaning()],
            );
        }
    }
}

fn defaults(text: &mut String, files: &[File]) {
    text.push_str(
        "\n## Program defaults\n\nValues of keys that at least one embedded file leaves out.\n",
    );
    text.push_str("\n| key | value | meaning |\n|---|---|---|\n");
    let mut seen = BTreeSet::new();
    for file in files {
        for info in file.keys.iter().filter(|info| info.status == "default") {
            let key = format!("`{}`", file.full_key(&info.key));
            if seen.insert(key.clone()) {
                row(text, &[&key, &value(info), &info.meaning()]);
            }
        }
    }
}

const ASSUMED: &str = "with an assumed part";
const FITTED: &str = "with a fitted part";
const SOURCED: &str = "source or derived";

fn equations_section(text: &mut String, equations: &[Equation]) {
    text.push_str("\n## Equations and what is built into them\n");
    for title in [ASSUMED, FITTED, SOURCED] {
        *text += &format!("\n### {title}\n\n");
        text.push_str("| label | statement | status | module |\n|---|---|---|---|\n");
        for e in equations.iter().filter(|e| origin(e) == title) {
            // Statements come out of a Markdown table: their bars are escaped already.
            *text += &format!(
                "| {} | {} | {} | `{}` |\n",
                e.label, e.statement, e.status, e.module
            );
        }
    }
}

/// Basis of the equation, by the words of its status.
fn origin(equation: &Equation) -> &'static str {
    let says = |word| equation.status.contains(word);
    if says("ASSUMED") || equation.statement.contains("ASSUMED") {
        ASSUMED
    } else if says("fitted") {
        FITTED
    } else {
        SOURCED
    }
}

/// Value with its unit.
#[must_use]
pub fn value(info: &KeyInfo) -> String {
    match (info.value.as_str(), info.unit.as_str()) {
        ("", _) => "-".to_owned(),
        (value, "-" | "") => value.to_owned(),
        (value, unit) => format!("{value} {unit}"),
    }
}
