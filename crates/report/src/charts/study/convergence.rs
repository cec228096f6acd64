//! Convergence of Sobol indices with the number of samples.

use super::{FOOT, Shown, WIDE, by_size, estimate_cells, estimate_columns, value};
use crate::charts::engine::{
    Axis, Chart, Entry, PLOT_LEFT, Panel, Rect, STROKES, Shape, Style, Symbol, ZERO, at,
};
use crate::charts::picture::{Picture, PictureTable};
use cvtcycle_study::statistics::{Confidence, Estimate, SobolIndices};

/// Names of the factors, and their indices in that order at growing numbers of samples.
type Steps<'a> = (&'a [String], &'a [SobolIndices]);

const TOP: f64 = 58.0;
const TALL: f64 = 230.0;
const GAP: f64 = 20.0;
/// Bands from the last number of samples over 2 to this power on lie in the plot in full.
const SEEN: f64 = 2.5;

/// Selects one of the two indices of a factor at a number of samples.
type Pick = fn(&SobolIndices, usize) -> Option<Estimate>;

/// Draws first-order indices over total ones against the number of samples, with their intervals as bands; of more than seven factors those with
/// the seven largest total indices.
pub fn convergence_plot(shown: &Shown, names: &[String], steps: &[SobolIndices]) -> Picture {
    let chosen = chosen((names, steps));
    let level = shown.confidence.percent();
    let mut notes = vec![format!(
        "Bands: intervals of {level} %. Clipped at small sample sizes; the table has them."
    )];
    if chosen.len() < names.len() {
        let (some, all) = (chosen.len(), names.len());
        notes.push(format!(
            "{some} of {all} factors, those with the largest total indices."
        ));
    }
    let indices: [(&str, Pick); 2] = [
        ("First-order index [-]", |s, i| {
            s.factors.get(i).map(|f| f.first)
        }),
        ("Total index [-]", |s, i| s.factors.get(i).map(|f| f.total)),
    ];
    let mut panels = indices.map(|(title, pick)| draw((names, steps), &chosen, title, pick));
    for (k, panel) in panels.iter_mut().enumerate() {
        let top = TOP + k as f64 * (TALL + GAP);
        panel.rect = Rect::new(PLOT_LEFT, top, WIDE, TALL);
        panel.x_labels = k == 1;
    }
    let lines = chosen.iter().zip(STROKES);
    let lines = lines.map(|(&i, stroke)| Entry::line(stroke, &names[i]));
    let title = title_of((names, steps), &chosen, shown);
    let subject = format!("{}: {}", shown.subject, shown.output);
    Chart::new(title, subject, PLOT_LEFT)
        .panels(panels)
        .legend(FOOT, lines)
        .notes(FOOT, notes)
        .picture(table((names, steps), shown.confidence))
}

/// Title: the largest total index with its interval at the last number of samples.
fn title_of((names, steps): Steps, chosen: &[usize], shown: &Shown) -> String {
    let of = || {
        let (first, last) = (*chosen.first()?, steps.last()?);
        let total = last.factors.get(first)?.total;
        let [low, high] = total.interval?;
        let digits = |x: f64| value(x, 0.9);
        Some(format!(
            "With {} samples the total index of {} is {} ({} to {})",
            last.samples,
            names.get(first)?,
            digits(total.value),
            digits(low),
            digits(high)
        ))
    };
    of().unwrap_or_else(|| format!("Convergence of Sobol indices: {}", shown.output))
}

/// A row for each number of samples and factor, in this order.
fn table((names, steps): Steps, confidence: Confidence) -> PictureTable {
    let mut table = PictureTable::new(&[("Samples", ""), ("Factor", "")]);
    let estimates = ["First order", "Total"].map(|name| estimate_columns(name, confidence));
    table.columns.extend(estimates.concat());
    for step in steps {
        for (i, name) in names.iter().enumerate() {
            let mut cells = vec![step.samples.to_string(), name.clone()];
            let factor = step.factors.get(i);
            let estimates = factor.map(|f| [f.first, f.total].map(|e| estimate_cells(&e)).concat());
            cells.extend(estimates.unwrap_or_default());
            cells.resize(table.columns.len(), String::new());
            table.push(cells);
        }
    }
    table
}

/// Logarithmic position of a number of samples.
fn place_of(step: &SobolIndices) -> f64 {
    (step.samples.max(1) as f64).log2()
}

/// Factors to draw, in descending total index of the last step.
fn chosen((names, steps): Steps) -> Vec<usize> {
    let total = |i: usize| {
        let last = steps.last().and_then(|s| s.factors.get(i));
        last.map_or(f64::NAN, |f| f.total.value)
    };
    let mut order: Vec<usize> = (0..names.len()).collect();
    by_size(&mut order, |i| total(*i));
    order.truncate(STROKES.len());
    order
}

fn draw((names, steps): Steps, chosen: &[usize], title: &str, pick: Pick) -> Panel {
    let estimates = |i: usize| {
        let steps = steps.iter().enumerate();
        steps.filter_map(move |(k, s)| pick(s, i).map(|e| (k, place_of(s), e)))
    };
    let first = steps.first().map_or(0.0, place_of);
    let last = steps.last().map_or(1.0, place_of);
    // Bands of few samples may leave the plot: they would compress everything else.
    let seen = |(_, x, e): (usize, f64, Estimate)| {
        let ends = e.interval.filter(|_| x > last - SEEN);
        ends.into_iter().flatten().chain([e.value, 0.0])
    };
    let all = chosen.iter().flat_map(|&i| estimates(i));
    let y = Axis::round(title, all.flat_map(seen), 6);
    let tick = |step: &SobolIndices| (place_of(step), step.samples.to_string());
    let ticks = steps.iter().map(tick);
    let x = Axis::labelled("Samples [-]", (first - 0.25, last + 0.25), ticks.collect());
    let mut panel = Panel::new(Rect::default(), x, y);
    panel.no_data = steps.is_empty() || chosen.is_empty();
    let order = || chosen.iter().enumerate().rev();
    for (k, &i) in order() {
        let ends = |(_, x, e): (usize, f64, Estimate)| e.interval.map(|[low, high]| (x, low, high));
        let bounds: Vec<(f64, f64, f64)> = estimates(i).filter_map(ends).collect();
        if bounds.len() > 1 {
            let style = Style::colour(STROKES[k].colour).fill_opacity(0.14);
            panel.add(Shape::between(&bounds), style.class("band"));
        }
    }
    let bands = std::mem::take(&mut panel.items);
    panel.add(Shape::Within(None, bands), Style::default());
    panel.level(0.0, ZERO);
    for (k, &i) in order() {
        let points = estimates(i).map(|(_, x, e)| (x, e.value)).collect();
        panel.series(points, STROKES[k]);
        for (step, x, e) in estimates(i) {
            let style = Style::colour(STROKES[k].colour).class("mark");
            let row = step * names.len() + i;
            panel.symbol(Symbol::CIRCLE, at(x, e.value), 2.8, style.row(row));
        }
    }
    panel
}
