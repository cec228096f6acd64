//! Numbers of a chart: a column for each line, a row for each value of the horizontal axis.

use super::super::engine::{cell, range, round_step};
use super::super::picture::PictureTable;
use super::{LineChart, LinePanel, Look};
use cvtcycle_output::table::distinct;

/// Maximum number of rows, and of cells: a table of many columns has fewer rows.
const MAX_ROWS: usize = 600;
const MAX_CELLS: usize = 8000;

/// Builds a chart's table, and lists for each panel the columns that it draws.
///
/// Panels over one quantity share its column, the first one. In a chart over several quantities, each has its own column and rows.
pub(super) fn table(chart: &LineChart) -> (PictureTable, Vec<Vec<usize>>) {
    let quantities = distinct(chart.panels.iter().map(|panel| chart.x_title(panel)));
    let mut table = PictureTable::with_columns(quantities.iter().map(|title| split(title)));
    let mut places = Vec::new();
    for panel in &chart.panels {
        places.push(table.columns.len());
        let looks = panel.series.iter().map(|(look, _)| *look);
        table
            .columns
            .extend(looks.map(|look| column(chart, panel, look)));
    }
    let mut every = 1;
    for (k, title) in quantities.iter().enumerate() {
        let panels = chart.panels.iter().zip(places.iter().copied());
        let own = panels.filter(|(panel, _)| chart.x_title(panel) == *title);
        every = every.max(rows(&mut table, k, &own.collect::<Vec<_>>()));
    }
    if every > 1 {
        table.note = format!("One row in {every} is listed; lines are drawn from all.");
    }
    let drawn =
        |(panel, first): (&LinePanel, &usize)| (*first..*first + panel.series.len()).collect();
    let columns = chart.panels.iter().zip(&places).map(drawn).collect();
    (table, columns)
}

/// Adds the rows of panels over one quantity, each with its first column; returns the thinning factor.
fn rows(table: &mut PictureTable, place: usize, panels: &[(&LinePanel, usize)]) -> usize {
    let series = || {
        panels
            .iter()
            .flat_map(|(panel, first)| panel.series.iter().zip(*first..))
    };
    // Adding zero turns a negative zero into a plain one, which compares equal.
    let mut xs: Vec<f64> = series()
        .flat_map(|((_, points), _)| points.iter().map(|p| p.0 + 0.0))
        .filter(|x| x.is_finite())
        .collect();
    xs.sort_by(f64::total_cmp);
    xs.dedup_by(|a, b| a.total_cmp(b).is_eq());
    let width = table.columns.len();
    let mut cells: Vec<Vec<String>> = vec![vec![String::new(); width]; xs.len()];
    let step = exact_step(&xs);
    for (row, x) in cells.iter_mut().zip(&xs) {
        row[place] = cell(*x, step);
    }
    for ((_, points), column) in series() {
        let step = step_of(points.iter().map(|p| p.1));
        for (x, y) in points {
            if let Ok(at) = xs.binary_search_by(|probe| probe.total_cmp(&(x + 0.0))) {
                cells[at][column] = cell(*y, step);
            }
        }
    }
    let max_rows = (MAX_CELLS / width.max(1)).clamp(1, MAX_ROWS);
    let every = cells.len().div_ceil(max_rows).max(1);
    table.rows.extend(cells.into_iter().step_by(every));
    every
}

/// Splits "Torque loss [Nm]" into name and unit; a unit of `-` becomes empty.
fn split(title: &'static str) -> (String, &'static str) {
    let inside = title.strip_suffix(']');
    match inside.and_then(|rest| rest.rsplit_once(" [")) {
        Some((name, "-")) => (name.to_owned(), ""),
        Some((name, unit)) => (name.to_owned(), unit),
        None => (title.to_owned(), ""),
    }
}

/// Name and unit of the column of a line.
fn column(chart: &LineChart, panel: &LinePanel, look: Look) -> (String, &'static str) {
    let (quantity, unit) = split(panel.y_title);
    let name = chart.names.iter().find(|(other, _)| *other == look);
    let name = name.map_or("", |(_, name)| name.as_str());
    let alike = chart
        .panels
        .iter()
        .filter(|other| other.heading == panel.heading);
    let alike = alike.count() > 1;
    let named = alike || name.is_empty() && panel.heading.is_empty();
    let quantity = if named { quantity.as_str() } else { "" };
    let parts = [panel.heading.as_str(), quantity, name];
    let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    (parts.join(": "), unit)
}

/// About a five-hundredth of the span of the values: the visible resolution of the drawing.
fn step_of(values: impl Iterator<Item = f64>) -> f64 {
    let Some((low, high)) = range(values) else {
        return 1.0;
    };
    let size = low.abs().max(high.abs());
    if high - low > 1e-9 * size {
        round_step((high - low) / 500.0)
    } else {
        round_step((size / 1000.0).max(1e-300))
    }
}

/// Step with the fewest decimals that write all values exactly, or that of [`step_of`].
fn exact_step(values: &[f64]) -> f64 {
    let exact = |step: &f64| {
        values
            .iter()
            .all(|x| ((x / step).round() * step - x).abs() <= 1e-9 * x.abs().max(*step))
    };
    [1.0, 0.1, 0.01, 0.001]
        .into_iter()
        .find(exact)
        .unwrap_or_else(|| step_of(values.iter().copied()))
}
