//! Price of each loss, next to its energy.

use super::engine::{
    Axis, Chart, Entry, INK, Label, QUIET, Style, Symbol, WIDTH, at, group_line, optional_cell,
    row_middle, rows_left, rows_panel, stroke,
};
use super::picture::{Picture, PictureTable};
use crate::number::grouped;
use cvtcycle_analysis::words::decimals;
use cvtcycle_output::Component;
use cvtcycle_output::summary::RunSummary;

/// Right edge of the plot with room for the numbers, left edge of blocks below it, height of a row, pixels.
const RIGHT: f64 = WIDTH - 150.0;
const MARGIN: f64 = 12.0;
const ROW: f64 = 23.0;
/// Radius of a price and of an energy, pixels.
const RADIUS: [f64; 2] = [5.0, 3.0];

/// A loss with its share of the fuel's energy, the fuel saved without it, and the range of that, per cent.
struct Row {
    component: Option<Component>,
    name: String,
    energy: Option<f64>,
    saved: Option<f64>,
    range: Option<[f64; 2]>,
}

impl Row {
    fn colour(&self) -> &'static str {
        self.component.map_or(QUIET, |c| group_line(c.group()))
    }

    /// "1.9 % (1.4 to 2.3)".
    fn in_words(&self) -> String {
        let digits = self.range.map_or(1, decimals);
        let range = self.range.map(|ends| {
            let [low, high] = ends.map(|x| grouped(x, digits));
            format!(" ({low} to {high})")
        });
        self.saved.map_or_else(String::new, |saved| {
            format!("{} %{}", grouped(saved, digits), range.unwrap_or_default())
        })
    }
}

/// Draws a dot for the fuel saved without each loss of a car, the largest first, then all together, and a ring for the energy of the loss.
pub fn price_dots(run: &RunSummary, subject: &str) -> Picture {
    let rows = rows(run);
    let values = rows.iter().flat_map(|row| {
        let ends = row.range.into_iter().flatten();
        row.energy.into_iter().chain(row.saved).chain(ends)
    });
    let x = Axis::round("Per cent of the fuel", values.chain([0.0]), 8);
    let left = rows_left(rows.iter().map(|row| row.name.as_str()), 11.0);
    let panel = rows_panel((left, 58.0), RIGHT, rows.len().max(2), ROW, x);
    let mut panel = panel.no_data(rows.is_empty());
    let columns = [
        ("Loss", ""),
        ("Energy of the loss", "%"),
        ("Fuel saved without the loss", "%"),
        ("5 % below", "%"),
        ("95 % below", "%"),
    ];
    let mut table = PictureTable::new(&columns);
    let ring = |row: &Row| Symbol::white(row.colour());
    for (k, row) in rows.iter().enumerate() {
        panel.row_name(k, Label::new(at(0.0, 0.0), &row.name).class("row").row(k));
        let middle = |x: f64| at(x, row_middle(k));
        if let Some(saved) = row.saved {
            let line = Style::line(stroke(row.colour(), 1.2, &[])).row(k);
            panel.segment(middle(0.0), middle(saved), line);
        }
        if let Some(ends) = row.range {
            panel.whisker(k, ends, 0.0, k);
        }
        if let Some(energy) = row.energy {
            panel.symbol(Symbol::CIRCLE, middle(energy), RADIUS[1], ring(row).row(k));
        }
        if let Some(saved) = row.saved {
            let dot = Symbol::filled(row.colour()).row(k);
            panel.symbol(Symbol::CIRCLE, middle(saved), RADIUS[0], dot);
        }
        let place = at(f64::INFINITY, row_middle(k)).shift(8.0, 4.0);
        panel.label(Label::new(place, row.in_words()));
        let ends = [0, 1].map(|end| row.range.map(|ends| ends[end]));
        let cells = [row.energy, row.saved].into_iter().chain(ends);
        let cells = cells.map(|x| optional_cell(x, 0.01));
        table.push([row.name.clone()].into_iter().chain(cells));
    }
    panel.upright(0.0, stroke(INK, 1.0, &[]));
    let foot = (MARGIN, WIDTH - 2.0 * MARGIN);
    let mut entries = vec![
        Entry::symbol(
            Symbol::CIRCLE,
            Symbol::filled(QUIET),
            "fuel saved without the loss",
        ),
        Entry::symbol(Symbol::CIRCLE, Symbol::white(QUIET), "energy of the loss"),
    ];
    if rows.iter().any(|row| row.range.is_some()) {
        let line = stroke(INK, 1.25, &[]);
        entries.push(Entry::line(line, "90 %, uncertain inputs only"));
    }
    let about = format!("{subject}; per cent of its fuel");
    Chart::new(title(run, subject), about, MARGIN)
        .panels([panel])
        .legend(foot, entries)
        .picture(table)
}

/// The losses of a car, the most expensive first, then all together. Iterates over the table of components, so that a file with other names adds no
/// rows.
fn rows(run: &RunSummary) -> Vec<Row> {
    let Some(price) = &run.price else {
        return Vec::new();
    };
    let row = |component: Component| {
        let loss = price.losses.get(component.name())?;
        Some(Row {
            component: Some(component),
            name: run.loss_words(component.name()),
            energy: loss.energy_percent,
            saved: loss.saved.percent,
            range: loss.range,
        })
    };
    let mut rows: Vec<Row> = Component::ALL.into_iter().filter_map(row).collect();
    let saved = |row: &Row| row.saved.unwrap_or(f64::NEG_INFINITY);
    rows.sort_by(|a, b| saved(b).total_cmp(&saved(a)));
    rows.push(Row {
        component: None,
        name: "all together".to_owned(),
        energy: Some(rows.iter().filter_map(|row| row.energy).sum()),
        saved: price.together.percent,
        range: None,
    });
    rows
}

/// Title: price of all losses together, and the most expensive one.
fn title(run: &RunSummary, subject: &str) -> String {
    let Some(price) = &run.price else {
        return "The price of the losses was not computed".to_owned();
    };
    let rows = rows(run);
    let first = rows.first().filter(|row| row.component.is_some());
    let first = first.map_or_else(String::new, |row| {
        format!(
            ", the largest of them {} ({:.1} %)",
            row.name,
            row.saved.unwrap_or(f64::NAN)
        )
    });
    let together = price.together.percent.unwrap_or(f64::NAN);
    format!("Its losses cost {subject} {together:.1} % of its fuel{first}")
}
