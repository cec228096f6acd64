//! Published against computed numbers, in tolerances of the published ones.

use super::{MARGIN, TOP, says};
use crate::charts::engine::{
    Axis, Chart, Entry, Fill, INK, Label, QUIET, Style, Symbol, WIDTH, at, row_middle, rows_left,
    rows_panel, stroke,
};
use crate::charts::picture::{Picture, PictureTable};

/// Right edge of the plot with room for counts, height of a row, radius of a dot, pixels.
const RIGHT: f64 = WIDTH - 110.0;
const ROW: f64 = 24.0;
const RADIUS: f64 = 3.4;
/// Distance beyond which numbers are drawn at the edge, tolerances.
const FAR: f64 = 4.0;

/// A computed number that nothing was fitted to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CheckedNumber {
    /// Part of the publication.
    pub part: String,
    /// Distance from the published number, in tolerances: positive above, zero within the published range.
    pub off: f64,
    /// True if the distance counts as agreement by the rule of the row.
    pub agrees: bool,
}

/// A dot for each number, a row for each part.
pub fn agreement(subject: &str, numbers: &[CheckedNumber]) -> Picture {
    let mut parts: Vec<&str> = Vec::new();
    for of in numbers {
        if !parts.contains(&of.part.as_str()) {
            parts.push(&of.part);
        }
    }
    let ticks = (-4..=4).map(|k| (f64::from(k), crate::number::grouped(f64::from(k), 0)));
    let title = "Computed less published, in tolerances of the published number";
    let x = Axis::labelled(title, (-FAR - 0.3, FAR + 0.3), ticks.collect());
    let left = rows_left(parts.iter().copied(), 11.0);
    let panel = rows_panel((left, TOP), RIGHT, parts.len().max(1), ROW, x);
    let mut panel = panel.no_data(numbers.is_empty());
    let band = Style::fill(Fill::plain("#d4dae6")).fill_opacity(0.6);
    panel.rectangle(at(-1.0, f64::NEG_INFINITY), at(1.0, f64::INFINITY), band);
    let mut table = PictureTable::new(&[("Part", ""), ("agree", ""), ("numbers", "")]);
    for (k, part) in parts.iter().enumerate() {
        let own: Vec<&CheckedNumber> = numbers.iter().filter(|of| of.part == *part).collect();
        let agree = own.iter().filter(|of| of.agrees).count();
        panel.row_name(k, Label::new(at(0.0, 0.0), *part).class("row").row(k));
        for (j, of) in own.iter().enumerate() {
            // Dots at one place are drawn next to each other.
            let shift = 3.2 * ((j % 5) as f64 - 2.0);
            let place = at(of.off.clamp(-FAR, FAR), row_middle(k)).shift(0.0, shift);
            let colour = if of.agrees { AGREES } else { DIFFERS };
            let (symbol, radius) = match of.off {
                off if off > FAR => (Symbol::edge(true), 4.0),
                off if off < -FAR => (Symbol::edge(false), 4.0),
                _ => (Symbol::CIRCLE, RADIUS),
            };
            panel.symbol(symbol, place, radius, Symbol::filled(colour).row(k));
        }
        let count = Label::new(
            at(f64::INFINITY, row_middle(k)).shift(8.0, 4.0),
            format!("{agree} of {}", own.len()),
        );
        panel.label(count.size(11.0).colour(QUIET));
        table.push([(*part).to_owned(), agree.to_string(), own.len().to_string()]);
    }
    panel.upright(0.0, stroke(INK, 0.8, &[]));
    let agree = numbers.iter().filter(|of| of.agrees).count();
    table.push([
        "all".to_owned(),
        agree.to_string(),
        numbers.len().to_string(),
    ]);
    let entries = [(AGREES, "agrees"), (DIFFERS, "differs")];
    let entries =
        entries.map(|(colour, name)| Entry::symbol(Symbol::CIRCLE, Symbol::filled(colour), name));
    let note = format!(
        "Band: one tolerance. At the edges: farther than {FAR:.0} tolerances. At the right: numbers that agree."
    );
    Chart::new(says::agreement(agree, numbers.len()), subject, MARGIN)
        .panels([panel])
        .legend((MARGIN, WIDTH - 2.0 * MARGIN), entries)
        .notes((MARGIN, WIDTH - 2.0 * MARGIN), vec![note])
        .picture(table)
}

/// Colours of the two verdicts.
const AGREES: &str = "#0072b2";
const DIFFERS: &str = "#d55e00";
