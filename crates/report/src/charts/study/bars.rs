//! Bars of two measures a factor, with intervals: Sobol indices, rank correlations.

use super::super::axis::Axis;
use super::super::legend::Mark;
use super::super::picture::{Picture, PictureTable, cell};
use super::super::style::fill;
use super::rows::{Frame, MOST_ROWS, Rows};
use super::text::value;
use super::{Shown, interval_cells};
use cvtcycle_study::statistics::{Estimate, RankSensitivity, SobolIndices};

/// Sobol indices of an output.
#[derive(Clone, Copy, Debug)]
pub struct SobolPlot<'a> {
    /// Output and study.
    pub shown: Shown<'a>,
    /// Names of the factors, in the order of the indices.
    pub names: &'a [String],
    /// The indices.
    pub indices: &'a SobolIndices,
}

/// Rank correlations of an output.
#[derive(Clone, Copy, Debug)]
pub struct RankPlot<'a> {
    /// Output and study.
    pub shown: Shown<'a>,
    /// Names of the factors, in the order of the coefficients.
    pub names: &'a [String],
    /// The coefficients.
    pub ranks: &'a RankSensitivity,
}

/// A row of the picture.
struct Row<'a> {
    name: &'a str,
    values: [Estimate; 2],
}

/// Draws first-order and total Sobol indices with their intervals, the largest total index first.
#[must_use]
pub fn sobol_plot(plot: &SobolPlot) -> Picture {
    let of = plot.indices;
    let rows = plot
        .names
        .iter()
        .zip(&of.factors)
        .map(|(name, f)| Row {
            name,
            values: [f.first, f.total],
        })
        .collect();
    let mut notes = vec![format!("{} samples{}", of.samples, left_out(of.missing))];
    if of.samples > 1 && of.variance <= 0.0 {
        notes.push("The output does not vary: it has no indices.".to_owned());
    } else {
        notes.push(format!(
            "Sum of first-order indices {}. What is missing to 1 is the work of factors together.",
            told(&of.sum_first)
        ));
        notes.push(format!(
            "Bars: estimates. Whiskers: intervals of 95 % from {} resamples.",
            of.resamples
        ));
    }
    let title = format!("Sobol indices: {}", plot.shown.output);
    let kinds = ["First order: alone", "Total: also with others"];
    draw(
        rows,
        &plot.shown,
        &Words {
            title,
            axis: "Share of the variance [-]",
            kinds,
            short: ["First order", "Total"],
            key: 1,
            notes,
        },
    )
}

/// Draws rank correlations and rank regression coefficients with their intervals, the strongest correlation first.
#[must_use]
pub fn rank_plot(plot: &RankPlot) -> Picture {
    let of = plot.ranks;
    let rows = plot
        .names
        .iter()
        .zip(&of.factors)
        .map(|(name, f)| Row {
            name,
            values: [f.spearman, f.regression],
        })
        .collect();
    let mut notes = vec![format!("{} rows{}", of.n, left_out(of.missing))];
    notes.push(match of.r_squared {
        r if r.is_finite() => format!("R\u{b2} of the regression on ranks: {r:.3}"),
        _ => "No regression: too few rows, or factors that follow from each other.".to_owned(),
    });
    notes.push("Whiskers: intervals of 95 %".to_owned());
    let title = format!("Rank sensitivity: {}", plot.shown.output);
    let kinds = ["Rank correlation", "Rank regression coefficient"];
    draw(
        rows,
        &plot.shown,
        &Words {
            title,
            axis: "Coefficient [-]",
            kinds,
            short: ["Correlation", "Regression"],
            key: 0,
            notes,
        },
    )
}

/// What a picture says.
struct Words<'a> {
    title: String,
    axis: &'a str,
    kinds: [&'a str; 2],
    /// The same for columns.
    short: [&'a str; 2],
    /// Which of the two measures sorts.
    key: usize,
    notes: Vec<String>,
}

fn draw(mut rows: Vec<Row>, shown: &Shown, words: &Words) -> Picture {
    let size = |row: &Row| row.values[words.key].value.abs();
    rows.sort_by(|a, b| {
        size(a)
            .is_nan()
            .cmp(&size(b).is_nan())
            .then(size(b).total_cmp(&size(a)))
    });
    let (desc, table) = (describe(&rows, words), table(&rows, words));
    let mut notes = words.notes.clone();
    if rows.len() > MOST_ROWS + 1 {
        let rest = rows.split_off(MOST_ROWS);
        let largest = rest.first().map_or(0.0, &size);
        notes.push(format!(
            "{} more factors in the table, each at most {}.",
            rest.len(),
            value(largest, 0.9)
        ));
    }
    let ends = rows
        .iter()
        .flat_map(|row| &row.values)
        .flat_map(|e| e.interval95.into_iter().flatten().chain([e.value, 0.0]));
    let frame = Frame {
        title: words.title.clone(),
        subject: shown.subject,
        desc,
        x: Axis::round(words.axis, ends, 8),
        names: rows.iter().map(|row| row.name).collect(),
        entries: words.kinds,
        notes,
    };
    let mut paints = Vec::new();
    let mut picture = Rows::new(frame, |figure| {
        paints = (0..2).map(|k| fill(figure, "measure", k, 2)).collect();
        paints.iter().cloned().map(Mark::Fill).collect()
    });
    for (k, row) in rows.iter().enumerate() {
        let middle = picture.middle(k);
        for ((estimate, paint), top) in row.values.iter().zip(&paints).zip([middle - 10.0, middle])
        {
            picture.bar(k, (0.0, estimate.value), (top, top + 10.0), paint);
            if let Some(interval) = estimate.interval95 {
                picture.whisker(k, interval, top + 5.0);
            }
        }
    }
    picture.mark(0.0);
    picture.finish(table)
}

fn table(rows: &[Row], words: &Words) -> PictureTable {
    let mut columns = vec![("Factor".to_owned(), "")];
    for kind in words.short {
        columns.extend(
            [
                kind.to_owned(),
                format!("{kind}: 95 % from"),
                format!("{kind}: to"),
            ]
            .map(|name| (name, "")),
        );
    }
    let mut table = PictureTable {
        columns,
        note: words.notes.join(" "),
        ..PictureTable::default()
    };
    for row in rows {
        let mut cells = vec![row.name.to_owned()];
        for estimate in &row.values {
            cells.push(cell(estimate.value, 1e-3));
            cells.extend(interval_cells(estimate.interval95, 1e-3));
        }
        table.push(cells);
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
fn told(estimate: &Estimate) -> String {
    let digits = |x: f64| value(x, 0.9);
    match estimate.interval95 {
        Some([low, high]) => format!(
            "{} ({} to {})",
            digits(estimate.value),
            digits(low),
            digits(high)
        ),
        None => digits(estimate.value),
    }
}

fn describe(rows: &[Row], words: &Words) -> String {
    let row = |row: &Row| {
        format!(
            "{}: {} and {}",
            row.name,
            told(&row.values[0]),
            told(&row.values[1])
        )
    };
    let [first, second] = words.kinds;
    format!(
        "For each factor two bars with intervals of 95 %, {first} and {second}. {}.",
        rows.iter().map(row).collect::<Vec<_>>().join("; ")
    )
}
