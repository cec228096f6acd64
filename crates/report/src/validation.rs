//! The results of `validate` as a section of a report.

use serde_json::Value;

use super::document::{ReportTable, Section};

fn count(value: &Value, verdict: &str) -> u64 {
    value["counts"][verdict].as_u64().unwrap_or(0)
}

/// Counts of the verdicts in words.
fn counts(value: &Value) -> String {
    let total: u64 = ["agrees", "fit", "differs", "not_comparable"]
        .iter()
        .map(|verdict| count(value, verdict))
        .sum();
    format!(
        "of {total} printed numbers {} agree, {} were fitted to, {} differ, and {} are not comparable",
        count(value, "agrees"),
        count(value, "fit"),
        count(value, "differs"),
        count(value, "not_comparable")
    )
}

/// The verdicts in one line.
#[must_use]
pub fn doubt(value: &Value) -> String {
    format!("Held against the thesis, {}.", counts(value))
}

/// The rows of a validation: those that differ first, all others folded away.
#[must_use]
pub fn section(value: &Value) -> Section {
    let mut section = Section::new("validation", "Validation");
    let text = |key: &str| value[key].as_str().unwrap_or_default().to_owned();
    let set: Vec<&str> = value["set"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    let with = if set.is_empty() {
        String::new()
    } else {
        format!(" with {}", set.join(", "))
    };
    section.text(format!("Vehicle {}{with}, {}: {}. A number agrees when it lies within what is printed and the tolerance of the measurement; a row to which a parameter was fitted is called a fit, never an agreement.", text("vehicle"), text("program"), counts(value)));
    let rows: Vec<&Value> = value["rows"].as_array().into_iter().flatten().collect();
    let differs = |row: &&&Value| row["verdict"].as_str() == Some("differs");
    section.table(table(
        "Rows that differ",
        rows.iter().filter(differs).copied(),
        true,
    ));
    section.folded(table(
        "All other rows",
        rows.iter().filter(|row| !differs(row)).copied(),
        false,
    ));
    section
}

fn table<'a>(caption: &str, rows: impl Iterator<Item = &'a Value>, reasons: bool) -> ReportTable {
    let mut columns = vec!["Row", "What", "Printed", "Computed", "Unit"];
    columns.push(if reasons { "Reason" } else { "Verdict" });
    let mut table = ReportTable::of_words(caption, &columns);
    for row in rows {
        let text = |key: &str| row[key].as_str().unwrap_or_default().to_owned();
        let condition = text("condition");
        let what = if condition.is_empty() {
            text("what")
        } else {
            format!("{} ({condition})", text("what"))
        };
        table.row([
            text("id"),
            what,
            text("printed"),
            text("computed"),
            text("unit"),
            text(if reasons { "reason" } else { "verdict" }),
        ]);
    }
    table
}
