//! A report as JSON and CSV, and its words for people.

use cvtcycle_config::Override;
use cvtcycle_output::columns;
use cvtcycle_output::table::{Column, write_csv};
use serde::Serialize;

use super::expr::{Computed, short};
use super::judge::{HeldOut, Judged, Report};
use super::rule::{Printed, Verdict};

/// Version of the JSON object; a new number when a name goes or changes its meaning.
const SCHEMA: u32 = 1;

/// A report as one JSON object.
#[derive(Clone, Debug, Serialize)]
pub struct Json {
    schema: u32,
    program: &'static str,
    vehicle: String,
    set: Vec<Override>,
    counts: Counts,
    held_out: HeldOut,
    moved: Vec<String>,
    rows: Vec<JsonRow>,
}

/// Rows by verdict.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Counts {
    /// Computed as printed.
    pub agrees: usize,
    /// As printed because a parameter was fitted to it.
    pub fit: usize,
    /// Otherwise.
    pub differs: usize,
    /// Not computed.
    pub not_comparable: usize,
}

impl Counts {
    /// Counts of some rows.
    pub fn of<'a>(rows: impl Iterator<Item = &'a Judged> + Clone) -> Self {
        let count = |verdict: Verdict| rows.clone().filter(|row| row.verdict == verdict).count();
        Counts {
            agrees: count(Verdict::Agrees),
            fit: count(Verdict::Fit),
            differs: count(Verdict::Differs),
            not_comparable: count(Verdict::NotComparable),
        }
    }
}

#[derive(Clone, Debug, Serialize)]
struct JsonRow {
    id: String,
    file: String,
    chapter: String,
    mechanism: String,
    kind: String,
    what: String,
    condition: String,
    printed: String,
    unit: String,
    printed_low: Option<f64>,
    printed_high: Option<f64>,
    tolerance: Option<String>,
    tolerance_below: Option<f64>,
    tolerance_above: Option<f64>,
    computed_low: Option<f64>,
    computed_high: Option<f64>,
    holds: Option<bool>,
    computed: String,
    verdict: &'static str,
    recorded: Option<&'static str>,
    moved: bool,
    fitted_to: Vec<String>,
    held_out: bool,
    off_by_tolerances: Option<f64>,
    reason: String,
    cause: Option<String>,
    cause_low: Option<f64>,
    cause_high: Option<f64>,
    cause_unit: Option<String>,
    remark: String,
    compute: String,
    gross_slip_left_out: usize,
    outside_validity: usize,
}

/// A report as one JSON object.
#[must_use]
pub fn json(report: &Report) -> Json {
    Json {
        schema: SCHEMA,
        program: cvtcycle_output::PROGRAM,
        vehicle: report.candidate.vehicle.clone(),
        set: report.candidate.set.clone(),
        counts: Counts::of(report.rows.iter()),
        held_out: report.held_out(),
        moved: report.moved().map(|row| row.row.id.clone()).collect(),
        rows: report.rows.iter().map(json_row).collect(),
    }
}

fn json_row(judged: &Judged) -> JsonRow {
    let row = &judged.row;
    let (low, high) = judged.computed.as_ref().map_or((None, None), ends);
    let (printed_low, printed_high) = match row.printed {
        Some(Printed::Range(low, high)) => (finite(low), finite(high)),
        _ => (None, None),
    };
    let (cause_low, cause_high) = judged.cause.as_ref().map_or((None, None), ends);
    let has_tolerance = !row.tolerance.is_empty();
    JsonRow {
        id: row.id.clone(),
        file: judged.file.clone(),
        chapter: row.chapter.clone(),
        mechanism: row.mechanism.clone(),
        kind: row.kind.clone(),
        what: row.what.clone(),
        condition: row.condition.clone(),
        printed: row.printed_text.clone(),
        unit: row.unit.clone(),
        printed_low,
        printed_high,
        tolerance: has_tolerance.then(|| row.tolerance.clone()),
        tolerance_below: has_tolerance.then_some(row.tolerance_widths[0]),
        tolerance_above: has_tolerance.then_some(row.tolerance_widths[1]),
        computed_low: low,
        computed_high: high,
        holds: match judged.computed {
            Some(Computed::Truth(holds, _)) => Some(holds),
            _ => None,
        },
        computed: computed_text(judged),
        verdict: judged.verdict.word(),
        recorded: row.recorded.map(Verdict::word),
        moved: judged.moved,
        fitted_to: row.fitted_to.clone(),
        held_out: row.is_held_out(),
        off_by_tolerances: judged.off(),
        reason: row.reason.clone(),
        cause: row.cause.as_ref().map(|cause| cause.what.clone()),
        cause_low,
        cause_high,
        cause_unit: row.cause.as_ref().map(|cause| cause.unit.clone()),
        remark: row.remark.clone(),
        compute: row.compute_text.clone(),
        gross_slip_left_out: judged.left_out,
        outside_validity: judged.outside,
    }
}

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

fn ends(computed: &Computed) -> (Option<f64>, Option<f64>) {
    match computed {
        Computed::Number(x) => (Some(*x), Some(*x)),
        Computed::Range(low, high) => (Some(*low), Some(*high)),
        Computed::Truth(..) => (None, None),
    }
}

/// A computed result for people, without its unit.
#[must_use]
pub fn text_of(computed: &Computed) -> String {
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
#[must_use]
pub fn cause_text(judged: &Judged) -> String {
    let Some((cause, computed)) = judged.row.cause.as_ref().zip(judged.cause.as_ref()) else {
        return String::new();
    };
    let unit = if cause.unit == "-" {
        String::new()
    } else {
        format!(" {}", cause.unit)
    };
    format!("Cause: {} = {}{unit}", cause.what, text_of(computed))
}

/// Reason, cause, fitted parameters and remark of a row as sentences.
#[must_use]
pub fn notes(judged: &Judged) -> Vec<String> {
    let row = &judged.row;
    let mut notes = Vec::new();
    if matches!(judged.verdict, Verdict::Differs | Verdict::NotComparable) {
        notes.extend([row.reason.clone(), cause_text(judged)]);
    }
    if !row.fitted_to.is_empty() {
        notes.push(format!("fitted to it: {}", row.fitted_to.join(", ")));
    }
    notes.push(row.remark.clone());
    if judged.left_out > 0 {
        notes.push(format!("{} points at gross slip left out", judged.left_out));
    }
    if judged.outside > 0 {
        notes.push(format!(
            "{} points outside the validity of a model",
            judged.outside
        ));
    }
    if judged.moved {
        notes.push(format!(
            "recorded: {}",
            row.recorded.map_or("", Verdict::word)
        ));
    }
    notes.retain(|note| !note.trim().is_empty());
    notes
}

/// Notes in one line.
#[must_use]
pub fn notes_line(judged: &Judged) -> String {
    let mut line = String::new();
    for note in notes(judged) {
        if !line.is_empty() {
            line.push_str(if line.ends_with('.') { " " } else { "; " });
        }
        line.push_str(&note);
    }
    line
}

/// Unit for people; nothing for plain numbers.
#[must_use]
pub fn unit_text(unit: &str) -> &str {
    if unit == "-" { "" } else { unit }
}

/// The columns of the CSV file: a row in JSON, and its cause as words.
fn columns() -> Vec<Column<(JsonRow, String)>> {
    columns! { (JsonRow, String);
        text "id", "", "", (r, _) => r.id.clone();
        text "chapter", "", "", (r, _) => r.chapter.clone();
        text "mechanism", "", "", (r, _) => r.mechanism.clone();
        text "kind", "", "", (r, _) => r.kind.clone();
        text "what", "", "", (r, _) => r.what.clone();
        text "condition", "", "", (r, _) => r.condition.clone();
        text "printed", "", "", (r, _) => r.printed.clone();
        text "unit", "", "", (r, _) => r.unit.clone();
        optional "printed_low", "", "", (r, _) => r.printed_low;
        optional "printed_high", "", "", (r, _) => r.printed_high;
        text "tolerance", "", "", (r, _) => r.tolerance.clone().unwrap_or_default();
        optional "tolerance_below", "", "", (r, _) => r.tolerance_below;
        optional "tolerance_above", "", "", (r, _) => r.tolerance_above;
        optional "computed_low", "", "", (r, _) => r.computed_low;
        optional "computed_high", "", "", (r, _) => r.computed_high;
        text "computed", "", "", (r, _) => r.computed.clone();
        text "verdict", "", "", (r, _) => r.verdict;
        text "recorded", "", "", (r, _) => r.recorded.unwrap_or_default();
        text "fitted_to", "", "", (r, _) => r.fitted_to.join(" ");
        text "reason", "", "", (r, _) => r.reason.clone();
        text "cause", "", "", (_, cause) => cause.clone();
        text "remark", "", "", (r, _) => r.remark.clone();
    }
}

/// A report as CSV, a line a row.
#[must_use]
pub fn csv(report: &Report) -> String {
    let rows = report
        .rows
        .iter()
        .map(|judged| (json_row(judged), cause_text(judged)));
    let mut bytes = Vec::new();
    // Writing into memory cannot fail.
    let _ = write_csv(&mut bytes, &columns(), rows, &[]);
    String::from_utf8(bytes).unwrap_or_default()
}
