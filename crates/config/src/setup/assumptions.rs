//! The book of assumptions: where every value and every equation comes from, as Markdown.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::catalogue::{self, File};
use crate::KeyInfo;
use cvtcycle_model::equations::Equation;

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
    let files = catalogue::files();
    let mut text = "# Book of assumptions\n\n\
        Printed by `cvtcycle assumptions` from the vehicle files, the lubricant files, the rig files and the heads of the model files; do not \
        edit it by hand.\n\n"
        .to_owned();
    // Writing into a String cannot fail.
    for (status, words) in STATUSES {
        let _ = writeln!(text, "- **{status}**: {words}");
    }
    text.push_str("- **default**: no file gives it; the program's own value\n\n");
    text.push_str("How far the assumed and fitted values may be off, and what that does to the comparison: `docs/uncertainty.md`.\n\n");
    counts(&mut text, &files);
    for file in &files {
        of_file(&mut text, file);
    }
    defaults(&mut text, &files);
    of_equations(&mut text, equations);
    text
}

fn counts(text: &mut String, files: &[File]) {
    text.push_str("| file | assumed | fitted | derived | source | default |\n|---|---:|---:|---:|---:|---:|\n");
    for file in files {
        let _ = write!(text, "| {} |", file.name);
        for status in STATUSES
            .iter()
            .map(|(status, _)| *status)
            .chain(["default"])
        {
            let _ = write!(
                text,
                " {} |",
                file.keys
                    .iter()
                    .filter(|info| info.status == status)
                    .count()
            );
        }
        text.push('\n');
    }
}

fn of_file(text: &mut String, file: &File) {
    let title = file
        .keys
        .iter()
        .find(|info| info.key.ends_with("title"))
        .map_or("", |info| &info.value);
    let mut kind = file.kind.word().to_owned();
    kind[..1].make_ascii_uppercase();
    let _ = writeln!(text, "\n## {kind} `{}`: {title}", file.name);
    for (status, _) in STATUSES {
        let keys: Vec<&KeyInfo> = file
            .keys
            .iter()
            .filter(|info| info.status == status && !info.key.ends_with("title"))
            .collect();
        if !keys.is_empty() {
            let _ = writeln!(
                text,
                "\n### {status}\n\n| key | value | source | note | meaning |\n|---|---|---|---|---|"
            );
        }
        for info in keys {
            let value = value(info);
            let _ = writeln!(
                text,
                "| `{}` | {} | {} | {} | {} |",
                info.key,
                cell(&value),
                cell(&info.source),
                cell(&info.note),
                cell(&info.doc)
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
            let key = file.full_key(&info.key);
            if seen.insert(key.clone()) {
                let _ = writeln!(
                    text,
                    "| `{key}` | {} | {} |",
                    cell(&value(info)),
                    cell(&info.doc)
                );
            }
        }
    }
}

fn of_equations(text: &mut String, equations: &[Equation]) {
    text.push_str("\n## Equations and what is built into them\n");
    let fitted = |e: &Equation| !is_assumed(e) && e.status.contains("fitted");
    let all = || equations.iter().copied();
    group(text, "with an assumed part", all().filter(is_assumed));
    group(text, "with a fitted part", all().filter(fitted));
    group(
        text,
        "source or derived",
        all().filter(|e| !is_assumed(e) && !fitted(e)),
    );
}

fn group(text: &mut String, title: &str, list: impl Iterator<Item = Equation>) {
    let _ = writeln!(
        text,
        "\n### {title}\n\n| label | statement | status | module |\n|---|---|---|---|"
    );
    for e in list {
        // Statements come out of a Markdown table: their bars are escaped already.
        let _ = writeln!(
            text,
            "| {} | {} | {} | `{}` |",
            e.label, e.statement, e.status, e.module
        );
    }
}

fn is_assumed(equation: &Equation) -> bool {
    equation.status.contains("ASSUMED") || equation.statement.contains("ASSUMED")
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

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}
