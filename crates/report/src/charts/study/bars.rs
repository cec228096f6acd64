//! Bars of two measures of each factor, with intervals: Sobol indices, rank correlations.

use super::{
    MARGIN, MAX_ROWS, RIGHT, ROW, Shown, WIDE_FOOT, by_size, estimate_cells, estimate_columns,
    value,
};
use crate::charts::engine::{
    Axis, Chart, Entry, Fill, INK, Label, Style, at, rows_left, rows_panel, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::capital_first;
use cvtcycle_study::statistics::{Confidence, Estimate, RankSensitivity, SobolIndices};

/// A factor with its two measures.
type FactorBars<'a> = (&'a str, [Estimate; 2]);

/// Texts of a picture.
struct Texts<'a> {
    title: String,
    axis: &'a str,
    kinds: [&'a str; 2],
    /// Short names, for columns.
    short: [&'a str; 2],
    /// Index of the measure that sorts, and maximum number of rows.
    key: usize,
    max_rows: usize,
    notes: Vec<String>,
}

/// Draws first-order and total Sobol indices of factors by name with their intervals, the largest total index first.
pub fn sobol_plot(shown: &Shown, names: &[String], sensitivity: &SobolIndices) -> Picture {
    let factors = names.iter().zip(&sensitivity.factors);
    let rows = factors.map(|(name, f)| (name.as_str(), [f.first, f.total]));
    let mut notes = vec![format!(
        "{} samples{}",
        sensitivity.samples,
        left_out(sensitivity.missing)
    )];
    if sensitivity.samples > 1 && sensitivity.variance <= 0.0 {
        notes.push("The output does not vary: it has no indices.".to_owned());
    } else {
        notes.push(format!(
            "Sum of first-order indices {}. What remains to 1 is due to interactions.",
            with_interval(&sensitivity.sum_first)
        ));
        notes.push(format!(
            "Bars: estimates. Whiskers: intervals of {} % from {} resamples.",
            shown.confidence.percent(),
            sensitivity.resamples
        ));
    }
    let texts = Texts {
        title: sobol_title(names, sensitivity, shown),
        max_rows: MAX_SOBOL,
        axis: "Share of the variance [-]",
        kinds: ["First order: alone", "Total: also with others"],
        short: ["First order", "Total"],
        key: 1,
        notes,
    };
    draw(rows.collect(), shown, texts)
}

/// Maximum number of drawn factors of Sobol indices; further ones are noise.
const MAX_SOBOL: usize = 6;

/// Title: the dominant factor, if its interval lies above that of the next one.
fn sobol_title(names: &[String], sensitivity: &SobolIndices, shown: &Shown) -> String {
    let mut totals: Vec<(&String, &Estimate)> = names
        .iter()
        .zip(sensitivity.factors.iter().map(|f| &f.total))
        .collect();
    by_size(&mut totals, |sensitivity| sensitivity.1.value);
    let ends = |estimate: &Estimate| estimate.interval.unwrap_or([estimate.value; 2]);
    match totals.as_slice() {
        [(name, first), (_, second), ..] if ends(first)[0] > ends(second)[1] => format!(
            "{} decides: {} of the variance of the {}; the next has {}",
            capital_first(name),
            value(first.value, 0.9),
            shown.output,
            value(second.value, 0.9)
        ),
        _ => format!(
            "{} samples single out no factor for the {}",
            sensitivity.samples, shown.output
        ),
    }
}

/// Title: the factor with the strongest rank correlation.
fn rank_title(names: &[String], sensitivity: &RankSensitivity, shown: &Shown) -> String {
    let mut all: Vec<(&String, f64)> = names
        .iter()
        .zip(sensitivity.factors.iter().map(|f| f.spearman.value))
        .collect();
    by_size(&mut all, |sensitivity| sensitivity.1.abs());
    match all.first().filter(|sensitivity| sensitivity.1.is_finite()) {
        Some((name, rank)) => format!(
            "The {} follows {name} most: rank correlation {}",
            shown.output,
            value(*rank, 0.9)
        ),
        None => format!("Rank sensitivity: {}", shown.output),
    }
}

/// Draws rank correlations and rank regression coefficients with their intervals, the strongest correlation first.
pub fn rank_plot(shown: &Shown, names: &[String], sensitivity: &RankSensitivity) -> Picture {
    let factors = names.iter().zip(&sensitivity.factors);
    let rows = factors.map(|(name, f)| (name.as_str(), [f.spearman, f.regression]));
    let fit = match sensitivity.r_squared {
        r if r.is_finite() => format!("R\u{b2} of the regression on ranks: {r:.3}"),
        _ => "No regression: too few rows, or factors that follow from each other.".to_owned(),
    };
    let texts = Texts {
        title: rank_title(names, sensitivity, shown),
        max_rows: MAX_ROWS,
        axis: "Coefficient [-]",
        kinds: ["Rank correlation", "Rank regression coefficient"],
        short: ["Correlation", "Regression"],
        key: 0,
        notes: vec![
            format!("{} rows{}", sensitivity.n, left_out(sensitivity.missing)),
            fit,
            format!("Whiskers: intervals of {} %", shown.confidence.percent()),
        ],
    };
    draw(rows.collect(), shown, texts)
}

fn draw(mut rows: Vec<FactorBars>, shown: &Shown, texts: Texts) -> Picture {
    let size = |row: &FactorBars| row.1[texts.key].value.abs();
    by_size(&mut rows, size);
    let table = table(&rows, &texts, shown.confidence);
    let mut notes = texts.notes.clone();
    if rows.len() > texts.max_rows + 1 {
        let rest = rows.split_off(texts.max_rows);
        let largest = rest.first().map_or(0.0, size);
        let (more, max_rows) = (rest.len(), value(largest, 0.9));
        notes.push(format!(
            "{more} more factors in the table, each at most {max_rows}."
        ));
    }
    let estimates = rows.iter().flat_map(|row| &row.1);
    let ends = estimates.flat_map(|e| e.interval.into_iter().flatten().chain([e.value, 0.0]));
    let left = rows_left(rows.iter().map(|row| row.0), 11.0);
    let x = Axis::round(texts.axis, ends, 8);
    let panel = rows_panel((left, 58.0), RIGHT, rows.len().max(2), ROW, x);
    let mut panel = panel.no_data(rows.is_empty());
    for (k, (name, estimates)) in rows.iter().enumerate() {
        panel.row_name(k, Label::new(at(0.0, 0.0), *name).class("row").row(k));
        for (i, (estimate, top)) in estimates.iter().zip([-10.0, 0.0]).enumerate() {
            let style = Style::edged(Fill::nth(i, 2), 0.5).row(k);
            panel.bar(k, (0.0, estimate.value), (top, top + 10.0), style);
            if let Some(interval) = estimate.interval {
                panel.whisker(k, interval, top + 5.0, k);
            }
        }
    }
    panel.upright(0.0, stroke(INK, 1.0, &[]));
    let entry = |(k, kind): (usize, &str)| Entry::fill(Fill::nth(k, 2), kind);
    Chart::new(texts.title, shown.subject, MARGIN)
        .panels([panel])
        .legend(WIDE_FOOT, texts.kinds.into_iter().enumerate().map(entry))
        .notes(WIDE_FOOT, notes)
        .picture(table)
}

fn table(rows: &[FactorBars], texts: &Texts, confidence: Confidence) -> PictureTable {
    let estimates = texts.short.map(|name| estimate_columns(name, confidence));
    let columns = estimates.concat();
    let columns = [("Factor".to_owned(), "")].into_iter().chain(columns);
    let mut table = PictureTable::with_columns(columns).note(texts.notes.join(" "));
    for (name, estimates) in rows {
        let cells = estimates.iter().flat_map(estimate_cells);
        table.push([(*name).to_owned()].into_iter().chain(cells));
    }
    table
}

fn left_out(missing: usize) -> String {
    if missing == 0 {
        String::new()
    } else {
        format!("; {missing} left out, for a value of them is missing")
    }
}

/// "0.314 (0.290 to 0.338)".
fn with_interval(estimate: &Estimate) -> String {
    let digits = |x: f64| value(x, 0.9);
    let own = digits(estimate.value);
    match estimate.interval {
        Some([low, high]) => format!("{own} ({} to {})", digits(low), digits(high)),
        None => own,
    }
}
