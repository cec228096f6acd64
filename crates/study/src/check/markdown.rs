//! A report as Markdown.

use super::expr::Computed;
use super::judge::Report;
use super::report::{computed_text, notes_line, unit_text};

/// A report as a Markdown table, without headings, for inclusion in a page.
#[must_use]
pub fn markdown(report: &Report) -> String {
    if report.rows.is_empty() {
        return "The thesis prints no number that is held against this page.\n".to_owned();
    }
    let mut text =
        "| row | what | printed | computed | verdict |\n|---|---|---|---|---|\n".to_owned();
    for judged in &report.rows {
        let row = &judged.row;
        let what = [row.what.as_str(), row.condition.as_str()]
            .into_iter()
            .filter(|part| !part.is_empty())
            .collect::<Vec<_>>()
            .join("; ");
        let unit = unit_text(&row.unit);
        let computed = computed_text(judged);
        let with_unit = |text: &str| {
            if text.is_empty() || unit.is_empty() {
                text.to_owned()
            } else {
                format!("{text} {unit}")
            }
        };
        let computed = if matches!(judged.computed, Some(Computed::Truth(..))) {
            computed
        } else {
            with_unit(&computed)
        };
        let cells = [
            &row.id,
            &what,
            &row.printed_text,
            &computed,
            judged.verdict.word(),
        ]
        .map(cell);
        text += &format!("| {} |\n", cells.join(" | "));
    }
    let with_notes: Vec<(&str, String)> = report
        .rows
        .iter()
        .map(|judged| (judged.row.id.as_str(), notes_line(judged)))
        .filter(|(_, notes)| !notes.is_empty())
        .collect();
    if !with_notes.is_empty() {
        text.push('\n');
        for (id, notes) in with_notes {
            text += &format!("- **{}**: {}\n", cell(id), cell(&notes));
        }
    }
    text
}

/// Text in a Markdown table: nothing that ends the cell or begins markup.
fn cell(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '\n' | '\r' => out.push(' '),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '|' | '*' | '_' | '`' | '[' | ']' | '\\' | '$' => {
                out.push('\\');
                out.push(c);
            }
            _ => out.push(c),
        }
    }
    out
}
