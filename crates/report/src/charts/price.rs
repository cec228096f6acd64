//! Price of each loss, next to its energy.

use super::engine::{
    Axis, Chart, Fill, INK, Label, Style, WIDTH, at, optional_cell, rows_left, rows_panel, stroke,
};
use super::picture::{Picture, PictureTable};
use cvtcycle_output::Component;
use cvtcycle_output::summary::RunSummary;

/// Right edge of the plot, left edge of blocks below it, height of a row, pixels.
const RIGHT: f64 = WIDTH - 28.0;
const MARGIN: f64 = 12.0;
const ROW: f64 = 27.0;
/// Upper and lower edge of both bars of a row, from its middle, pixels.
const HALVES: [(f64, f64); 2] = [(-10.0, -0.5), (0.5, 10.0)];
/// Opacity of both.
const PALE: [f64; 2] = [0.4, 1.0];
/// Names of the bars.
const BARS: [&str; 2] = ["Energy of the loss", "Fuel saved without the loss"];

/// Draws bars of each loss of a car, and of all together: its share of the fuel's energy, and the fuel saved without it.
pub fn price_bars(run: &RunSummary, subject: &str) -> Picture {
    // Iterates over the table of components, so that a file with other names adds no rows.
    let loss = |c: Component| run.price.as_ref()?.losses.get(c.name());
    let row = |c: Component| {
        let loss = loss(c)?;
        let values = [loss.energy_percent, loss.saved.percent];
        Some((Some(c), run.loss_words(c.name()), values))
    };
    let mut rows: Vec<(Option<Component>, String, [Option<f64>; 2])> =
        Component::ALL.into_iter().filter_map(row).collect();
    if let Some(price) = &run.price {
        let energies: f64 = rows.iter().filter_map(|(.., values)| values[0]).sum();
        rows.push((
            None,
            "together".to_owned(),
            [Some(energies), price.together.percent],
        ));
    }
    let values = rows.iter().flat_map(|(.., values)| values).flatten();
    let x = Axis::round("Per cent of the fuel", values.copied().chain([0.0]), 8);
    let left = rows_left(rows.iter().map(|(_, name, _)| name.as_str()), 11.0);
    let panel = rows_panel((left, 58.0), RIGHT, rows.len().max(2), ROW, x);
    let mut panel = panel.no_data(rows.is_empty());
    let columns = [("Loss", ""), (BARS[0], "%"), (BARS[1], "%")];
    let mut table = PictureTable::new(&columns);
    for (k, (component, name, values)) in rows.iter().enumerate() {
        panel.row_name(k, Label::new(at(0.0, 0.0), name).class("row").row(k));
        table.push(
            [name.clone()]
                .into_iter()
                .chain(values.map(|x| optional_cell(x, 0.01))),
        );
        for (half, value) in values.iter().enumerate() {
            if let Some(value) = value {
                let fill = component.map_or_else(|| Fill::plain("#8f8f8f"), Fill::component);
                let style = Style::edged(fill, 0.5).fill_opacity(PALE[half]).row(k);
                panel.bar(k, (0.0, *value), HALVES[half], style);
            }
        }
    }
    panel.upright(0.0, stroke(INK, 1.0, &[]));
    let foot = (MARGIN, RIGHT - MARGIN);
    let note = "Upper, pale bar: share of the fuel's energy that the loss takes. Lower bar: fuel saved without the loss.";
    Chart::new(title(run, subject), subject, MARGIN)
        .panels([panel])
        .notes(foot, vec![note.to_owned()])
        .picture(table)
}

/// Title: price of all losses together, and the most expensive one.
fn title(run: &RunSummary, subject: &str) -> String {
    let Some(price) = &run.price else {
        return "The price of the losses was not computed".to_owned();
    };
    let cost = |c: &Component| price.losses.get(c.name())?.saved.percent;
    let costs = Component::ALL
        .into_iter()
        .filter_map(|c| Some((c, cost(&c)?)));
    let dearest = costs.max_by(|a, b| a.1.total_cmp(&b.1));
    let dearest = dearest.map_or_else(String::new, |(c, percent)| {
        let name = run.loss_words(c.name());
        format!(", the largest of them {name} ({percent:.1} %)")
    });
    let together = price.together.percent.unwrap_or(f64::NAN);
    format!("Its losses cost {subject} {together:.1} % of its fuel{dearest}")
}
