//! Explanations for people.

use cvtcycle::config::setup::assumptions::value;
use cvtcycle::config::setup::equations::{Equation, cited};

use super::{Found, Meanings};
use crate::print::colour::Paint;
use crate::print::grid::Grid;

/// All that bears the name, one paragraph each.
pub fn of(meanings: &Meanings, paint: Paint) -> String {
    let mut parts: Vec<String> = meanings
        .keys
        .iter()
        .map(|found| key(found, paint))
        .collect();
    if let Some(column) = meanings.column {
        let unit = if matches!(column.unit, "" | "-") {
            "none"
        } else {
            column.unit
        };
        parts.push(format!(
            "{}\n{}",
            paint.heading(&column.name),
            facts(&[
                ("what", "column of the trace"),
                ("meaning", &*column.doc),
                ("unit", unit)
            ])
        ));
    }
    if let Some((name, words)) = meanings.flag {
        let what = "flag of a row, in the column `flags`; seconds in `flags_s` of the summary";
        parts.push(format!(
            "{}\n{}",
            paint.heading(name),
            facts(&[("what", what), ("meaning", words)])
        ));
    }
    parts.extend(meanings.equation.as_ref().map(|e| {
        let file = e.file.to_string();
        let statement = e.statement.replace("\\|", "|");
        let rows = [
            ("what", "equation of the model"),
            ("statement", &*statement),
            ("status", e.status),
            ("file", &file),
        ];
        format!("{}\n{}", paint.heading(e.label), facts(&rows))
    }));
    parts.join("\n")
}

fn facts(rows: &[(&str, &str)]) -> String {
    let mut grid = Grid::new("ll").indented();
    for (name, text) in rows {
        grid.row([name, text]);
    }
    grid.text_with_widths(&[9])
}

fn key(found: &Found, paint: Paint) -> String {
    let known = &found.known;
    let equations = cited(&known.doc);
    let equation = |e: &Equation| {
        format!(
            "{}: {} ({})",
            e.label,
            e.statement.replace("\\|", "|"),
            e.status
        )
    };
    let told: Vec<String> = equations.iter().map(equation).collect();
    let mut rows = vec![
        ("meaning", known.doc.as_str()),
        (
            "unit",
            if known.unit == "-" {
                "none"
            } else {
                &known.unit
            },
        ),
    ];
    rows.push(("allowed", &known.allowed));
    rows.extend(
        told.iter()
            .enumerate()
            .map(|(k, text)| (if k == 0 { "equation" } else { "" }, text.as_str())),
    );
    let mut text = format!("{}\n{}", paint.heading(&known.key), facts(&rows));
    if found.values.is_empty() {
        return text + "  no embedded file gives it\n";
    }
    let mut grid = Grid::new("llll").indented();
    for (file, info) in &found.values {
        let remarks: Vec<&str> = [&info.source, &info.note]
            .into_iter()
            .map(String::as_str)
            .filter(|s| !s.is_empty())
            .collect();
        let (shown, long) = match value(info) {
            long if long.chars().count() > 24 => (String::new(), Some(long)),
            short => (short, None),
        };
        let last = long
            .iter()
            .map(String::as_str)
            .chain(remarks)
            .collect::<Vec<_>>()
            .join("; ");
        grid.row([*file, &shown, &info.status, &last]);
    }
    text += &grid.text();
    text
}
