//! Waterfall from the fuel of a baseline to that of the subject, term by term, per distance.

use super::{MARGIN, TOP, says};
use crate::charts::engine::{
    Axis, CONTEXT, Chart, INK, Label, Style, Symbol, WIDTH, at, cell, row_middle, rows_left,
    rows_panel, text_width,
};
use crate::charts::figures::Term;
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{grouped, signed};

/// Right edge of the plot, height of a row, size of labels, pixels.
const RIGHT: f64 = WIDTH - 18.0;
const ROW: f64 = 25.0;
const TEXT: f64 = 11.5;
/// Share of the total difference below which terms are combined.
const SMALL: f64 = 0.02;

/// Energies of two cars over their distance, kJ/km.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PerKm {
    /// Names of subject and baseline.
    pub names: [String; 2],
    /// Fuel of subject and baseline.
    pub fuel: [f64; 2],
    /// Uses of the fuel: name, kind, subject's minus baseline's.
    pub terms: Vec<(String, Term, f64)>,
}

/// Draws bars from the fuel of the baseline to that of the subject, the largest first, small ones combined.
pub fn waterfall(data: &PerKm, conditions: &str) -> Picture {
    let difference = data.fuel[0] - data.fuel[1];
    let terms = folded(data, difference);
    let [subject, baseline] = [&data.names[0], &data.names[1]];
    let ends = [format!("fuel of {baseline}"), format!("fuel of {subject}")];
    let names = terms.iter().map(|(name, ..)| name.as_str());
    let left = rows_left(ends.iter().map(String::as_str).chain(names), TEXT);
    let mut level = data.fuel[1];
    let mut steps = vec![level];
    for (.., kj) in &terms {
        level += kj;
        steps.push(level);
    }
    let (low, high) = bounds(&steps, left);
    let x = Axis::exact(
        "Energy over distance [kJ/km]; the axis does not begin at zero",
        low,
        high,
        7,
    );
    let mut panel = rows_panel((left, TOP), RIGHT, terms.len() + 2, ROW, x);
    let mut table = PictureTable::new(&[
        ("term", ""),
        ("change", "kJ/km"),
        ("fuel after it", "kJ/km"),
    ]);
    let last = terms.len() + 1;
    for (row, (name, fuel)) in [
        (0, (&ends[0], data.fuel[1])),
        (last, (&ends[1], data.fuel[0])),
    ] {
        panel.row_name(row, Label::new(at(0.0, 0.0), name).size(TEXT).bold(true));
        let place = at(fuel, row_middle(row));
        panel.symbol(Symbol::DIAMOND, place, 5.5, Symbol::filled(INK).row(row));
        let text = Label::new(
            place.shift(10.0, 4.0),
            format!("{} kJ/km", grouped(fuel, 0)),
        );
        panel.label(text.size(TEXT).bold(true));
    }
    table.push([ends[0].clone(), String::new(), cell(data.fuel[1], 0.1)]);
    for (k, (name, term, kj)) in terms.iter().enumerate() {
        let (row, from, to) = (k + 1, steps[k], steps[k + 1]);
        panel.row_name(row, Label::new(at(0.0, 0.0), name).size(TEXT));
        let at_row = table.push([name.clone(), cell(*kj, 0.1), cell(to, 0.1)]);
        panel.bar(
            row,
            (from, to),
            (-8.0, 8.0),
            Style::edged(term.fill(), 0.5).row(at_row),
        );
        let link = |row: f64| at(to, row);
        panel.segment(
            link(row as f64 + 0.82),
            link(row as f64 + 1.18),
            Style::line(CONTEXT),
        );
        let place = at(from.max(to), row_middle(row)).shift(7.0, 4.0);
        panel.label(Label::new(place, signed(grouped(*kj, 0), *kj)).size(TEXT));
    }
    table.push([
        ends[1].clone(),
        cell(difference, 0.1),
        cell(data.fuel[0], 0.1),
    ]);
    let mut named: Vec<(String, f64)> = data
        .terms
        .iter()
        .map(|(name, _, kj)| (name.clone(), *kj))
        .collect();
    named.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let title = says::waterfall([subject, baseline], &named);
    Chart::new(title, conditions, MARGIN)
        .panels([panel])
        .picture(table)
}

/// Terms in descending change; those that are small relative to the difference are combined into the last one.
fn folded(data: &PerKm, difference: f64) -> Vec<(String, Term, f64)> {
    let limit = SMALL * difference.abs();
    let (mut large, small): (Vec<_>, Vec<_>) = data
        .terms
        .iter()
        .cloned()
        .partition(|(.., kj)| kj.abs() >= limit);
    large.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    let rest: f64 = small.iter().map(|(.., kj)| kj).sum();
    if let [alone] = &small[..] {
        large.push(alone.clone());
    } else if !small.is_empty() {
        large.push((format!("{} others", small.len()), Term::Other, rest));
    }
    large
}

/// Ends of the axis: all steps, and room for the label of the last one.
fn bounds(steps: &[f64], left: f64) -> (f64, f64) {
    let (low, high) = crate::charts::engine::range(steps.iter().copied()).unwrap_or((0.0, 1.0));
    let span = (high - low).max(1e-3 * high.abs()).max(1e-9);
    let label = text_width("00 000 kJ/km", TEXT) + 24.0;
    let room = span * label / (RIGHT - left - label).max(1.0);
    (low - 0.06 * span, high + 1.1 * room)
}
