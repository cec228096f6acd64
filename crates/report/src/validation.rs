//! Results of `validate`: as a section of a report, and as a separate HTML page: one file, readable without scripts, on paper and in dark mode.

use askama::Template;
use serde_json::Value;

use super::charts::decision::{CheckedNumber, agreement};
use super::document::{ReportTable, Section};
use cvtcycle_config::Override;
use cvtcycle_output::table::distinct;
use cvtcycle_validate::expr::short;
use cvtcycle_validate::judge::{Judged, Report};
use cvtcycle_validate::report::{Counts, computed_text, notes, unit_text};
use cvtcycle_validate::rule::{Group, Verdict};

/// Formats the counts of the verdicts in words.
fn counts_in_words(counts: &Value) -> String {
    let verdicts = [
        "agrees",
        "fit",
        "identity",
        "differs",
        "not_comparable",
        "not_computed",
    ];
    let counts = verdicts.map(|verdict| counts[verdict].as_u64().unwrap_or(0));
    let [agree, fit, identity, differ, not, failed] = counts;
    let total: u64 = counts.iter().sum();
    let failed = match failed {
        0 => String::new(),
        n => format!("; {n} cannot be computed for this car"),
    };
    format!(
        "of {total} printed numbers {agree} agree, {fit} were fitted to, {identity} cannot fail, {differ} differ, and {not} are not comparable{failed}"
    )
}

/// Formats groups of rows with their counts: "thesis: of 300 printed numbers ...".
fn groups_in_words(value: &Value) -> String {
    let groups = value["groups"].as_object().into_iter().flatten();
    let groups =
        groups.map(|(name, found)| format!("{name}: {}", counts_in_words(&found["counts"])));
    groups.collect::<Vec<_>>().join("; ")
}

/// Formats the verdicts in one line.
pub fn doubt(value: &Value) -> String {
    format!(
        "Held against published numbers, {}.",
        groups_in_words(value)
    )
}

/// Lists the rows of a validation: differing ones first, all others collapsed.
pub fn section(value: &Value) -> Section {
    let mut section = Section::new("validation", "Validation");
    let text = |key: &str| value[key].as_str().unwrap_or_default().to_owned();
    let set = value["set"].as_array().into_iter().flatten();
    let set: Vec<&str> = set.filter_map(Value::as_str).collect();
    let with = match set.as_slice() {
        [] => String::new(),
        set => format!(" with {}", set.join(", ")),
    };
    section.text(format!("Vehicle {}{with}, {}: {}. A number agrees when it lies within what is printed and the tolerance of the measurement; a row to which a parameter was fitted is called a fit, never an agreement.", text("vehicle"), text("program"), groups_in_words(value)));
    let rows = value["rows"].as_array().into_iter().flatten();
    let numbers: Vec<CheckedNumber> = rows.clone().filter_map(checked).collect();
    let subject = format!(
        "Vehicle {}, by chapter of the thesis and file of other sources",
        text("vehicle")
    );
    let caption = "Published numbers that nothing was fitted to against those of the program.";
    section.figure("agreement", caption, agreement(&subject, &numbers));
    let differs = |row: &&Value| row["verdict"].as_str() == Some("differs");
    let (differing, others): (Vec<&Value>, Vec<&Value>) = rows.partition(differs);
    // Rows on whole cars come first, as the subject of the report.
    let (cars, parts): (Vec<&Value>, Vec<&Value>) = differing
        .into_iter()
        .partition(|row| row["mechanism"] == CAR);
    let (near, rest) = cars.split_at(cars.len().min(SHOWN));
    section.table(table("Rows on whole cars that differ", near, "Reason"));
    let mut more = Section::default();
    more.table(table(
        "All other rows that differ",
        &[rest, &parts].concat(),
        "Reason",
    ));
    more.folded(table("Rows that do not differ", &others, "Verdict"));
    section.more = more.blocks;
    section
}

/// Maximum number of rows of a table in the body; mechanism of rows on whole cars.
const SHOWN: usize = 8;
const CAR: &str = "vehicle";

/// Number that nothing was fitted to, with its distance from the published one.
fn checked(row: &Value) -> Option<CheckedNumber> {
    let number = |key: &str| row[key].as_f64();
    let [low, high] = [number("printed_low")?, number("printed_high")?];
    let [from, to] = [number("computed_low")?, number("computed_high")?];
    let held_out = row["held_out"].as_bool() == Some(true);
    let width = |key: &str| number(key).filter(|width| *width > 1e-9);
    let off = match (to > high, from < low) {
        (true, _) => (to - high) / width("tolerance_above")?,
        (false, true) => (from - low) / width("tolerance_below")?,
        (false, false) => 0.0,
    };
    held_out.then(|| CheckedNumber {
        part: match row["group"].as_str() {
            Some("thesis") => chapter_title(row["chapter"].as_str().unwrap_or_default()),
            _ => "other sources".to_owned(),
        },
        off,
        agrees: row["verdict"].as_str() == Some("agrees"),
    })
}

/// Sentence on the number of comparable published numbers that differ.
pub fn differing(value: &Value) -> String {
    let count = |verdict: &str| value["counts"][verdict].as_u64().unwrap_or(0);
    let all: u64 = ["agrees", "fit", "differs"].map(count).iter().sum();
    format!(
        "{} of the {all} published numbers that can be compared with the model differ from it.",
        count("differs")
    )
}

/// Table of rows; `last` is the heading of the last column and, in lower case, its key.
fn table(caption: &str, rows: &[&Value], last: &str) -> ReportTable {
    let columns = ["Row", "What", "Printed", "Computed", "Unit", last];
    let mut table = ReportTable::textual(caption, &columns);
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

#[derive(Template)]
#[template(path = "validation.html")]
struct Page {
    program: &'static str,
    vehicle: String,
    set: Vec<Override>,
    groups: Vec<GroupLine>,
    moved: Vec<String>,
    chapters: Vec<Chapter>,
}

struct GroupLine {
    name: &'static str,
    total: usize,
    counts: Counts,
}

struct Chapter {
    title: String,
    anchor: String,
    counts: Counts,
    rows: Vec<Line>,
}

struct Line {
    id: String,
    what: String,
    condition: String,
    printed: String,
    tolerance: String,
    computed: String,
    unit: String,
    verdict: &'static str,
    class: &'static str,
    notes: Vec<String>,
}

/// Renders a report as an HTML page.
///
/// # Errors
/// Never for the templates of this program.
pub fn page(report: &Report) -> Result<String, String> {
    let group = |group: Group| GroupLine {
        name: group.word(),
        total: report.of_group(group).count(),
        counts: Counts::of(report.of_group(group)),
    };
    let page = Page {
        program: cvtcycle_output::PROGRAM,
        vehicle: report.candidate.vehicle.clone(),
        set: report.candidate.set.clone(),
        groups: report.groups().into_iter().map(group).collect(),
        moved: report.moved().map(|judged| judged.row.id.clone()).collect(),
        chapters: chapters(report),
    };
    page.render().map_err(|e| e.to_string())
}

/// Groups rows by chapter, in the order of their first rows.
fn chapters(report: &Report) -> Vec<Chapter> {
    let names = distinct(report.rows.iter().map(|judged| judged.row.chapter.as_str()));
    let chapter = |(k, name): (usize, &&str)| {
        let rows = report.rows.iter();
        let own = rows.filter(|judged| judged.row.chapter == *name);
        Chapter {
            title: chapter_title(name),
            anchor: format!("part-{}", k + 1),
            counts: Counts::of(own.clone()),
            rows: own.map(line).collect(),
        }
    };
    names.iter().enumerate().map(chapter).collect()
}

/// "Chapter 5", "Appendix C", or the user's own word.
pub fn chapter_title(name: &str) -> String {
    match name {
        "C" => "Appendix C".to_owned(),
        name if name.parse::<u32>().is_ok() => format!("Chapter {name}"),
        name => name.to_owned(),
    }
}

/// Tolerance on both sides of the printed number; empty if absent or negligible.
fn tolerance(judged: &Judged) -> String {
    let [below, above] = judged.row.tolerance_widths;
    let widest = if below > above { below } else { above };
    if judged.row.tolerance.is_empty() || widest < 1e-3 {
        String::new()
    } else if (below - above).abs() <= 1e-9 * widest {
        format!("± {}", short(above))
    } else {
        format!("-{}, +{}", short(below), short(above))
    }
}

fn line(judged: &Judged) -> Line {
    let row = &judged.row;
    let class = match judged.verdict {
        Verdict::Agrees => "agrees",
        Verdict::Fit => "fit",
        Verdict::Differs | Verdict::NotComputed => "differs",
        Verdict::Identity | Verdict::NotComparable => "none",
    };
    Line {
        id: row.id.clone(),
        what: row.what.clone(),
        condition: row.condition.clone(),
        printed: row.printed_text.clone(),
        tolerance: tolerance(judged),
        computed: computed_text(judged),
        unit: unit_text(&row.unit).to_owned(),
        verdict: judged.verdict.word(),
        class,
        notes: notes(judged),
    }
}
