//! What each loss costs, next to the energy that it takes.

use super::engine::{
    Axis, Chart, Entry, Fill, INK, Label, Style, WIDTH, at, optional_cell, rows_left, rows_panel,
    stroke,
};
use super::picture::{Picture, PictureTable};
use cvtcycle_output::Component;
use cvtcycle_output::summary::RunSummary;

/// Right edge of the plot, left edge of what lies below it, height of a row, pixels.
const RIGHT: f64 = WIDTH - 28.0;
const MARGIN: f64 = 12.0;
const ROW: f64 = 27.0;
/// Upper and lower edge of both bars of a row, from its middle, pixels.
const HALVES: [(f64, f64); 2] = [(-10.0, -0.5), (0.5, 10.0)];
/// What the bars are.
const BARS: [&str; 2] = ["Energy of the loss", "Fuel saved without the loss"];

/// Bars of each loss of a car, and of all together: its share of the fuel's energy, and the fuel that would be saved without it.
pub fn price_bars(run: &RunSummary, subject: &str) -> Picture {
    let name = |component: &str| component.replace('_', " ");
    // By the table of components, so that a file with other names draws no other rows.
    let loss = |c: Component| run.price.as_ref()?.losses.get(c.name());
    let row = |c: Component| {
        let loss = loss(c)?;
        Some((name(c.name()), [loss.energy_percent, loss.saved.percent]))
    };
    let mut rows: Vec<(String, [Option<f64>; 2])> =
        Component::ALL.into_iter().filter_map(row).collect();
    if let Some(price) = &run.price {
        let energies: f64 = rows.iter().filter_map(|(_, values)| values[0]).sum();
        rows.push((
            "together".to_owned(),
            [Some(energies), price.together.percent],
        ));
    }
    let values = rows.iter().flat_map(|(_, values)| values).flatten();
    let x = Axis::round("Per cent of the fuel", values.copied().chain([0.0]), 8);
    let left = rows_left(rows.iter().map(|(name, _)| name.as_str()), 11.0);
    let panel = rows_panel((left, 58.0), RIGHT, rows.len().max(2), ROW, x);
    let mut panel = panel.no_data(rows.is_empty());
    let columns = [("Loss", ""), (BARS[0], "%"), (BARS[1], "%")];
    let mut table = PictureTable::new(&columns);
    for (k, (name, values)) in rows.iter().enumerate() {
        panel.row_name(k, Label::new(at(0.0, 0.0), name).class("row").row(k));
        table.push(
            [name.clone()]
                .into_iter()
                .chain(values.map(|x| optional_cell(x, 0.01))),
        );
        for (half, value) in values.iter().enumerate() {
            if let Some(value) = value {
                let style = Style::edged(Fill::nth(half, 2), 0.5).row(k);
                panel.bar(k, (0.0, *value), HALVES[half], style);
            }
        }
    }
    panel.upright(0.0, stroke(INK, 1.0, &[]));
    let foot = (MARGIN, RIGHT - MARGIN);
    let entry = |(k, name): (usize, &str)| Entry::fill(Fill::nth(k, 2), name);
    Chart::new("What each loss costs", subject, MARGIN)
        .panels([panel])
        .legend(foot, BARS.into_iter().enumerate().map(entry))
        .picture(table)
}
