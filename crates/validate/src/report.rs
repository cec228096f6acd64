//! A report as JSON, CSV and Markdown, and its words for people.

use cvtcycle_output::escape;
use cvtcycle_output::number::exact;
use cvtcycle_output::record::Manifest;
use cvtcycle_output::table::CsvWriter;
use serde::Serialize;
use serde_json::{Value, json as object};

use super::expr::{Computed, short};
use super::judge::{Judged, Report};
use super::rule::{Group, Printed, Verdict};

/// Version of the JSON object; a new number when a name goes or changes its meaning.
const SCHEMA: u32 = 2;

/// Rows by verdict.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Counts {
    /// Computed as printed.
    pub agrees: usize,
    /// As printed because a parameter was fitted to it.
    pub fit: usize,
    /// As printed, and unable to come out otherwise.
    pub identity: usize,
    /// Otherwise.
    pub differs: usize,
    /// Nothing to compare.
    pub not_comparable: usize,
    /// Cannot be computed for this car.
    pub not_computed: usize,
}

impl Counts {
    /// Counts of some rows.
    pub fn of<'a>(rows: impl Iterator<Item = &'a Judged> + Clone) -> Self {
        let count = |verdict: Verdict| rows.clone().filter(|row| row.verdict == verdict).count();
        Counts {
            agrees: count(Verdict::Agrees),
            fit: count(Verdict::Fit),
            identity: count(Verdict::Identity),
            differs: count(Verdict::Differs),
            not_computed: count(Verdict::NotComputed),
            not_comparable: count(Verdict::NotComparable),
        }
    }
}

/// A report as one JSON object.
#[must_use]
pub fn json(report: &Report) -> Value {
    let group = |group: Group| {
        let found = object!({
            "counts": Counts::of(report.of_group(group)),
            "held_out": report.held_out(group),
        });
        (group.word().to_owned(), found)
    };
    let rest = object!({
        "vehicle": report.candidate.vehicle,
        "set": report.candidate.set,
        "counts": Counts::of(report.rows.iter()),
        "groups": report.groups().into_iter().map(group).collect::<serde_json::Map<_, _>>(),
        "moved": report.moved().map(|row| row.row.id.as_str()).collect::<Vec<_>>(),
        "rows": report.rows.iter().map(row_of).collect::<Vec<_>>(),
    });
    Manifest::new(SCHEMA).for_run(&rest).with(&rest)
}

/// A row as a JSON object; no number and an infinite one are null.
fn row_of(judged: &Judged) -> Value {
    let row = &judged.row;
    let computed = judged.computed.as_ref();
    let [low, high] = computed.map_or([f64::NAN; 2], ends);
    let [cause_low, cause_high] = judged.cause.as_ref().map_or([f64::NAN; 2], ends);
    let [printed_low, printed_high] = match row.printed {
        Some(Printed::Range(low, high)) => [low, high],
        _ => [f64::NAN; 2],
    };
    let toleranced = (!row.tolerance.is_empty()).then_some(row);
    let holds = computed.and_then(|computed| match computed {
        Computed::Truth(holds, _) => Some(holds),
        _ => None,
    });
    object!({
        "id": row.id,
        "file": judged.file,
        "group": judged.group.word(),
        "chapter": row.chapter,
        "mechanism": row.mechanism,
        "kind": row.kind,
        "what": row.what,
        "condition": row.condition,
        "printed": row.printed_text,
        "unit": row.unit,
        "printed_low": printed_low,
        "printed_high": printed_high,
        "tolerance": toleranced.map(|row| &row.tolerance),
        "tolerance_below": toleranced.map(|row| row.tolerance_widths[0]),
        "tolerance_above": toleranced.map(|row| row.tolerance_widths[1]),
        "mean": judged.fleet().map(|fleet| fleet.mean),
        "sd": judged.fleet().map(|fleet| fleet.sd),
        "n": judged.fleet().map(|fleet| fleet.n),
        "z": judged.z(),
        "data": (!row.data.is_empty()).then_some(&row.data),
        "computed_low": low,
        "computed_high": high,
        "holds": holds,
        "computed": computed_text(judged),
        "verdict": judged.verdict.word(),
        "recorded": row.recorded.map(Verdict::word),
        "moved": judged.moved,
        "fitted_to": row.fitted_to,
        "held_out": row.is_held_out(),
        "off_by_tolerances": judged.off(),
        "reason": row.reason,
        "cause": row.cause.as_ref().map(|cause| &cause.what),
        "cause_low": cause_low,
        "cause_high": cause_high,
        "cause_unit": row.cause.as_ref().map(|cause| &cause.unit),
        "failure": judged.failure,
        "cause_failure": judged.cause_failure,
        "remark": row.remark,
        "compute": row.compute_text,
        "gross_slip_left_out": judged.left_out,
        "outside_validity": judged.outside,
    })
}

/// Smallest and largest number; NaN for a truth.
fn ends(computed: &Computed) -> [f64; 2] {
    match computed {
        Computed::Number(x) => [*x, *x],
        Computed::Range(low, high) => [*low, *high],
        Computed::Truth(..) => [f64::NAN; 2],
    }
}

/// Entries of a row in the CSV file, by their names in the JSON object.
const CSV_COLUMNS: &str = "id chapter mechanism kind what condition printed unit printed_low printed_high \
    tolerance tolerance_below tolerance_above computed_low computed_high computed verdict recorded \
    fitted_to reason cause remark group mean sd n z";

/// A report as CSV, a line a row; the cause in words with its number.
#[must_use]
pub fn csv(report: &Report) -> String {
    let names: Vec<&str> = CSV_COLUMNS.split_whitespace().collect();
    let mut bytes = Vec::new();
    let written = CsvWriter::new(&mut bytes, &names).and_then(|mut csv| {
        for judged in &report.rows {
            let mut row = row_of(judged);
            row["cause"] = cause_text(judged).into();
            csv.row(&names, |name, text| text.push_str(&cell(&row[*name])))?;
        }
        csv.finish()
    });
    debug_assert!(written.is_ok(), "writing into memory cannot fail");
    String::from_utf8(bytes).unwrap_or_default()
}

/// A JSON value in a CSV cell: lists separated by spaces, null empty.
fn cell(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(list) => list.iter().map(cell).collect::<Vec<_>>().join(" "),
        other => other.as_f64().map(exact).unwrap_or_default(),
    }
}

/// A report as a Markdown table, without headings, for inclusion in a page.
#[must_use]
pub fn markdown(report: &Report) -> String {
    if report.rows.is_empty() {
        return "The thesis prints no number that is held against this page.\n".to_owned();
    }
    let mut text =
        "| row | what | printed | computed | verdict |\n|---|---|---|---|---|\n".to_owned();
    let mut notes = String::new();
    for judged in &report.rows {
        let row = &judged.row;
        let mut what = row.what.clone();
        if !row.condition.is_empty() {
            what += &format!("; {}", row.condition);
        }
        let mut computed = computed_text(judged);
        if !matches!(judged.computed, None | Some(Computed::Truth(..))) {
            computed = format!("{computed} {}", unit_text(&row.unit));
        }
        let verdict = judged.verdict.word();
        let cells =
            [&row.id, &what, &row.printed_text, computed.trim(), verdict].map(escape::markdown);
        text += &format!("| {} |\n", cells.join(" | "));
        let line = notes_line(judged);
        if !line.is_empty() {
            notes += &format!(
                "- **{}**: {}\n",
                escape::markdown(&row.id),
                escape::markdown(&line)
            );
        }
    }
    if !notes.is_empty() {
        text.push('\n');
    }
    text + &notes
}

/// A computed result for people, without its unit.
fn text_of(computed: &Computed) -> String {
    match computed {
        Computed::Number(x) => short(*x),
        Computed::Range(low, high) => format!("{} to {}", short(*low), short(*high)),
        Computed::Truth(holds, behind) => {
            format!("{}: {behind}", if *holds { "yes" } else { "no" })
        }
    }
}

/// The computed result of a row for people; empty where there is none.
#[must_use]
pub fn computed_text(judged: &Judged) -> String {
    judged.computed.as_ref().map(text_of).unwrap_or_default()
}

/// Number, unit and name of the cause; empty where there is none.
fn cause_text(judged: &Judged) -> String {
    if let Some((cause, why)) = judged.row.cause.as_ref().zip(judged.cause_failure.as_ref()) {
        return format!("Cause: {} cannot be computed: {why}", cause.what);
    }
    let Some((cause, computed)) = judged.row.cause.as_ref().zip(judged.cause.as_ref()) else {
        return String::new();
    };
    let number = format!("{} {}", text_of(computed), unit_text(&cause.unit));
    format!("Cause: {} = {}", cause.what, number.trim_end())
}

/// Reason, cause, fitted parameters and remark of a row as sentences.
#[must_use]
pub fn notes(judged: &Judged) -> Vec<String> {
    let row = &judged.row;
    let mut notes = Vec::new();
    notes.extend(judged.failure.clone());
    if matches!(judged.verdict, Verdict::Differs | Verdict::NotComparable) {
        notes.extend([row.reason.clone(), cause_text(judged)]);
    }
    if let Some((z, fleet)) = judged.z().zip(judged.fleet()) {
        let (sd, n) = (short(fleet.sd), fleet.n);
        notes.push(format!("z = {z:.1} (sd {sd}, {n} cars: {})", row.data));
    }
    if !row.fitted_to.is_empty() {
        notes.push(format!("fitted to it: {}", row.fitted_to.join(", ")));
    }
    notes.push(row.remark.clone());
    for (count, what) in [
        (judged.left_out, "at gross slip left out"),
        (judged.outside, "outside the validity of a model"),
    ] {
        if count > 0 {
            notes.push(format!("{count} points {what}"));
        }
    }
    if let Some(recorded) = row.recorded.filter(|_| judged.moved) {
        notes.push(format!("recorded: {}", recorded.word()));
    }
    notes.retain(|note| !note.trim().is_empty());
    notes
}

/// Notes in one line.
#[must_use]
pub fn notes_line(judged: &Judged) -> String {
    let join = |line: String, note: String| {
        let between = if line.ends_with('.') { " " } else { "; " };
        line + between + &note
    };
    notes(judged).into_iter().reduce(join).unwrap_or_default()
}

/// Unit for people; nothing for plain numbers.
#[must_use]
pub fn unit_text(unit: &str) -> &str {
    if unit == "-" { "" } else { unit }
}
