//! The HTML page: one file, readable without scripts, on paper and in the dark.

use askama::Template;

use cvtcycle_config::Override;
use cvtcycle_study::check::expr::short;
use cvtcycle_study::check::judge::{Judged, Report};
use cvtcycle_study::check::report::{Counts, computed_text, notes, unit_text};
use cvtcycle_study::check::rule::Verdict;

#[derive(Template)]
#[template(path = "validation.html")]
struct Page {
    program: &'static str,
    vehicle: String,
    set: Vec<Override>,
    counts: Counts,
    total: usize,
    moved: Vec<String>,
    chapters: Vec<Chapter>,
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

/// A report as an HTML page.
///
/// # Errors
/// Never for the templates of this program.
pub fn page(report: &Report) -> Result<String, String> {
    let page = Page {
        program: cvtcycle_output::PROGRAM,
        vehicle: report.candidate.vehicle.clone(),
        set: report.candidate.set.clone(),
        counts: Counts::of(report.rows.iter()),
        total: report.rows.len(),
        moved: report.moved().map(|judged| judged.row.id.clone()).collect(),
        chapters: chapters(report),
    };
    page.render().map_err(|e| e.to_string())
}

/// Rows by chapter, chapters in the order of their first rows.
fn chapters(report: &Report) -> Vec<Chapter> {
    let mut names: Vec<&str> = Vec::new();
    for judged in &report.rows {
        if !names.contains(&judged.row.chapter.as_str()) {
            names.push(&judged.row.chapter);
        }
    }
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
#[must_use]
pub fn chapter_title(name: &str) -> String {
    match name {
        "C" => "Appendix C".to_owned(),
        name if name.parse::<u32>().is_ok() => format!("Chapter {name}"),
        name => name.to_owned(),
    }
}

/// Widths on both sides of what is printed; empty where there are none, or next to none.
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
    let (verdict, class) = match judged.verdict {
        Verdict::Agrees => ("agrees", "agrees"),
        Verdict::Fit => ("fit", "fit"),
        Verdict::Differs => ("differs", "differs"),
        Verdict::NotComparable => ("not comparable", "none"),
    };
    Line {
        id: row.id.clone(),
        what: row.what.clone(),
        condition: row.condition.clone(),
        printed: row.printed_text.clone(),
        tolerance: tolerance(judged),
        computed: computed_text(judged),
        unit: unit_text(&row.unit).to_owned(),
        verdict,
        class,
        notes: notes(judged),
    }
}
