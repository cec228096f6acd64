//! A report as tables for people.

use cvtcycle::report::validation_page::chapter_title;
use cvtcycle::study::check::{Judged, Report, Verdict, computed_text, notes_line, unit_text};

use crate::print::colour::Paint;
use crate::print::grid::Grid;

/// Tables by chapter, notes under each, counts at the end.
pub fn tables(report: &Report, paint: Paint) -> String {
    let mut chapters: Vec<&str> = Vec::new();
    for judged in &report.rows {
        if !chapters.contains(&judged.row.chapter.as_str()) {
            chapters.push(&judged.row.chapter);
        }
    }
    let mut text = format!(
        "{}  {}\n",
        paint.heading("Printed numbers against the program"),
        report.subject.vehicle
    );
    text.extend(
        report
            .subject
            .set
            .iter()
            .map(|set| format!("--set {set}\n")),
    );
    for name in chapters {
        let rows: Vec<&Judged> = report
            .rows
            .iter()
            .filter(|judged| judged.row.chapter == name)
            .collect();
        text += &format!(
            "\n{}\n{}",
            paint.heading(&chapter_title(name)),
            chapter(&rows)
        );
    }
    text += &format!("\n{}\n{}", paint.heading("Rows by verdict"), counts(report));
    text += &format!(
        "\n{}\n{}",
        paint.heading("Held out: rows that no calibration uses, constants aside"),
        held_out(report)
    );
    let moved = moved(report);
    if moved.is_empty() {
        text
    } else {
        text + &paint.bad(moved.trim_end()) + "\n"
    }
}

/// Longest text in a narrow column; longer ones are cut and stand in full in the other forms.
const NARROW: usize = 20;

fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        text.to_owned()
    } else {
        text.chars().take(most - 1).collect::<String>() + "…"
    }
}

fn chapter(rows: &[&Judged]) -> String {
    let mut grid = Grid::new("llllll");
    grid.row(["row", "verdict", "printed", "computed", "unit", "what"]);
    for judged in rows {
        let row = &judged.row;
        let verdict = if judged.moved {
            format!("{} !", judged.verdict.word())
        } else {
            judged.verdict.word().to_owned()
        };
        grid.row([
            row.id.clone(),
            verdict,
            cut(&row.printed_text, NARROW),
            cut(&computed_text(judged), NARROW),
            unit_text(&row.unit).to_owned(),
            row.what.clone(),
        ]);
    }
    let mut text = grid.indented().text();
    let shown = rows.iter().filter(|judged| {
        judged.verdict == Verdict::Differs || judged.moved || judged.left_out + judged.outside > 0
    });
    let mut list = Grid::new("ll");
    let mut some = false;
    for judged in shown {
        let notes = notes_line(judged);
        if !notes.is_empty() {
            some = true;
            list.row([judged.row.id.clone(), notes]);
        }
    }
    if some {
        text += "\n";
        text += &list.indented().text();
    }
    text
}

fn counts(report: &Report) -> String {
    let mut grid = Grid::new("lr");
    for verdict in Verdict::ALL {
        grid.row([verdict.word().to_owned(), report.count(verdict).to_string()]);
    }
    grid.row(["in all".to_owned(), report.rows.len().to_string()]);
    grid.indented().text()
}

fn held_out(report: &Report) -> String {
    let found = report.held_out();
    let mut grid = Grid::new("lr");
    grid.row(["rows".to_owned(), found.rows.to_string()]);
    grid.row(["agree".to_owned(), found.agree.to_string()]);
    grid.row(["numbers among them".to_owned(), found.numbers.to_string()]);
    grid.row([
        "numbers that agree".to_owned(),
        found.numbers_agree.to_string(),
    ]);
    if let Some(median) = found.median_off {
        grid.row([
            "median distance from what is printed, in tolerances".to_owned(),
            format!("{median:.2}"),
        ]);
    }
    grid.indented().text()
}

/// One line for every row with another verdict than recorded.
pub fn moved(report: &Report) -> String {
    let line = |judged: &Judged| {
        let row = &judged.row;
        let recorded = row.recorded.map_or("", Verdict::word);
        let place = &row.place;
        let (computed, printed) = (computed_text(judged), &row.printed_text);
        let unit = unit_text(&row.unit);
        format!(
            "cvtcycle: row {}: `{recorded}` recorded, now `{}`: computed {computed} {unit}, printed {printed} ({} line {})\n",
            row.id,
            judged.verdict.word(),
            place.file,
            place.line
        )
    };
    report.moved().map(line).collect()
}
