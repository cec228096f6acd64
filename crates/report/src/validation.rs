//! The results of `validate` as a section of a report.

use serde_json::Value;

use super::document::{ReportTable, Section};

/// Counts of the verdicts in words.
fn counts(value: &Value) -> String {
    let counts = ["agrees", "fit", "differs", "not_comparable"];
    let [agree, fit, differ, not] =
        counts.map(|verdict| value["counts"][verdict].as_u64().unwrap_or(0));
    let total = agree + fit + differ + not;
    format!(
        "of {total} printed numbers {agree} agree, {fit} were fitted to, {differ} differ, and {not} are not comparable"
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
    let set = value["set"].as_array().into_iter().flatten();
    let set: Vec<&str> = set.filter_map(Value::as_str).collect();
    let with = match set.as_slice() {
        [] => String::new(),
        set => format!(" with {}", set.join(", ")),
    };
    section.text(format!("Vehicle {}{with}, {}: {}. A number agrees when it lies within what is printed and the tolerance of the measurement; a row to which a parameter was fitted is called a fit, never an agreement.", text("vehicle"), text("program"), counts(value)));
    let rows = value["rows"].as_array().into_iter().flatten();
    let differs = |row: &&Value| row["verdict"].as_str() == Some("differs");
    let (differing, others): (Vec<&Value>, Vec<&Value>) = rows.partition(differs);
    section.table(table("Rows that differ", &differing, "Reason"));
    section.folded(table("All other rows", &others, "Verdict"));
    section
}

/// Rows with a last column, under the key of its name in small letters.
fn table(caption: &str, rows: &[&Value], last: &str) -> ReportTable {
    let columns = ["Row", "What", "Printed", "Computed", "Unit", last];
    let mut table = ReportTable::of_words(caption, &columns);
    for row in rows {
        let text = |key: &str| row[key].as_str().unwrap_or_default().to_owned();
        let what = match text("condition").as_str() {
            "" => text("what"),
            condition => format!("{} ({condition})", text("what")),
        };
        let numbers = ["printed", "computed", "unit", &last.to_lowercase()].map(text);
        table.row([text("id"), what].into_iter().chain(numbers));
    }
    table
}
