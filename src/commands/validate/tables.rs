//! A validation as tables.

use cvtcycle::report::validation_page::chapter_title;
use cvtcycle::study::check::{Judged, Report, Verdict, computed_text, notes_line, unit_text};

use crate::print::colour::Paint;
use crate::print::table::{TextColumns, TextTable, cut};

/// Longest text of a value; longer ones are cut, and complete in the other forms.
const MAX_VALUE_LEN: usize = 20;

/// A table for each chapter with its notes, and counts at the end.
pub fn tables(report: &Report, paint: Paint) -> String {
    let candidate = &report.candidate;
    let heading = paint.heading("Published values compared with the model");
    let mut text = format!("{heading}  {}\n", candidate.vehicle);
    text.extend(candidate.set.iter().map(|set| format!("--set {set}\n")));
    let mut chapters: Vec<&str> = Vec::new();
    for judged in &report.rows {
        if !chapters.contains(&judged.row.chapter.as_str()) {
            chapters.push(&judged.row.chapter);
        }
    }
    for name in chapters {
        let rows = report
            .rows
            .iter()
            .filter(|judged| judged.row.chapter == name);
        let heading = paint.heading(&chapter_title(name));
        text += &format!("\n{heading}\n{}", chapter(&rows.collect::<Vec<_>>()));
    }
    let held_out_title =
        paint.heading("Held out: rows that no calibration uses, without constants");
    text + &format!(
        "\n{}\n{}\n{held_out_title}\n{}",
        paint.heading("Rows by verdict"),
        counts(report),
        held_out(report)
    )
}

fn chapter(rows: &[&Judged]) -> String {
    let mark = |judged: &Judged| if judged.moved { " !" } else { "" };
    let columns = TextColumns::new()
        .left("row", |j: &&Judged| j.row.id.clone())
        .left("verdict", |j| format!("{}{}", j.verdict.word(), mark(j)))
        .left("printed", |j| cut(&j.row.printed_text, MAX_VALUE_LEN))
        .left("computed", |j| cut(&computed_text(j), MAX_VALUE_LEN))
        .left("unit", |j| unit_text(&j.row.unit))
        .left("what", |j| j.row.what.clone());
    let mut text = columns.table(rows).indented().text();
    let noted = |judged: &&&Judged| {
        judged.verdict == Verdict::Differs || judged.moved || judged.left_out + judged.outside > 0
    };
    let notes = rows
        .iter()
        .filter(noted)
        .map(|judged| (&judged.row.id, notes_line(judged)));
    let notes: Vec<(&String, String)> = notes.filter(|(_, notes)| !notes.is_empty()).collect();
    if !notes.is_empty() {
        let mut list = TextTable::new("ll").indented();
        notes.iter().for_each(|(id, notes)| list.row([id, notes]));
        text += &format!("\n{}", list.text());
    }
    text
}

fn list(lines: impl IntoIterator<Item = (&'static str, String)>) -> String {
    let mut table = TextTable::new("lr").indented();
    lines
        .into_iter()
        .for_each(|(name, value)| table.row([name, &value]));
    table.text()
}

fn counts(report: &Report) -> String {
    let of = |verdict: Verdict| (verdict.word(), report.count(verdict).to_string());
    list(
        Verdict::ALL
            .into_iter()
            .map(of)
            .chain([("total", report.rows.len().to_string())]),
    )
}

fn held_out(report: &Report) -> String {
    let found = report.held_out();
    let median = found.median_off.map(|median| {
        let name = "median distance from the printed value, in tolerances";
        (name, format!("{median:.2}"))
    });
    let lines = [
        ("rows", found.rows),
        ("agree", found.agree),
        ("numbers among them", found.numbers),
        ("numbers that agree", found.numbers_agree),
    ];
    list(
        lines
            .map(|(name, n)| (name, n.to_string()))
            .into_iter()
            .chain(median),
    )
}

/// One line for each row whose verdict is not the recorded one.
pub fn changed_verdicts(report: &Report) -> Vec<String> {
    let line = |judged: &Judged| {
        let (row, unit) = (&judged.row, unit_text(&judged.row.unit));
        format!(
            "row {}: `{}` recorded, now `{}`: computed {} {unit}, printed {} ({} line {})",
            row.id,
            row.recorded.map_or("", Verdict::word),
            judged.verdict.word(),
            computed_text(judged),
            row.printed_text,
            row.place.input,
            row.place.line
        )
    };
    report.moved().map(line).collect()
}
