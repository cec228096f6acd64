//! Figures of losses over a grid: maps over two axes, stacks over one, a panel for each combination of the other axes.

use std::collections::BTreeMap;

use super::engine::{self, Axis, Chart, Entry, Fill, PLOT_LEFT, Side, WIDTH, grid};
use super::grids::{MapFigure, map_figure, panels_left_of};
use super::lines::{Look, stack_layers};
use super::picture::PictureTable;
use crate::number::{capital_first, grouped};
use cvtcycle_output::Component;
use cvtcycle_output::losses::{Axis as GridAxis, LossRow, LossTable};

/// Minimum number of values on an axis of a map: values between two points are unknown.
const MIN_ON_MAP: usize = 3;
/// Maximum number of panels of a figure.
const MAX_PANELS: usize = 12;
/// Axes by priority.
const ORDER: [GridAxis; 8] = [
    GridAxis::Speed,
    GridAxis::Torque,
    GridAxis::InputTorque,
    GridAxis::Sump,
    GridAxis::Pressure,
    GridAxis::Throttle,
    GridAxis::Belt,
    GridAxis::Ratio,
];

/// Draws figures with their file names; empty for a single point.
pub fn loss_figures(table: &LossTable) -> Vec<(String, String)> {
    let varied = table.grid.varied();
    let count = |axis: &GridAxis| table.grid.axis_values(*axis).len();
    let gears = |axis: &GridAxis| *axis == GridAxis::Ratio && !table.is_cvt();
    let drawn = ORDER.into_iter().filter(|axis| varied.contains(axis));
    let on_map = drawn
        .clone()
        .filter(|axis| count(axis) >= MIN_ON_MAP && !gears(axis));
    let rows: Vec<LossRow> = table.rows().collect();
    let stacked = |x: GridAxis| {
        let svg = stack(table, &Layout::new(table, &rows, x, None));
        vec![("losses_stacked.svg".to_owned(), svg)]
    };
    match (on_map.collect::<Vec<_>>().as_slice(), varied.is_empty()) {
        (_, true) => Vec::new(),
        ([], false) => stacked(drawn.max_by_key(count).unwrap_or(GridAxis::Ratio)),
        ([x], _) => stacked(*x),
        ([x, rest @ ..], _) => {
            // The axis with the largest number of values, for few panels; the first of equals.
            let y = rest.iter().rev().max_by_key(|axis| count(axis));
            maps(table, &Layout::new(table, &rows, *x, y.copied()))
        }
    }
}

/// One value of each axis that is not drawn, and the rows of its panel.
struct Panel<'a> {
    title: String,
    /// Rows by x, then by y.
    rows: Vec<Vec<&'a LossRow>>,
}

struct Layout<'a> {
    x: (GridAxis, Vec<f64>),
    y: Option<(GridAxis, Vec<f64>)>,
    panels: Vec<Panel<'a>>,
    subject: String,
}

impl<'a> Layout<'a> {
    fn new(table: &LossTable, rows: &'a [LossRow], x: GridAxis, y: Option<GridAxis>) -> Self {
        let along = |axis: &GridAxis| x == *axis || y == Some(*axis);
        let varied = table.grid.varied().into_iter();
        let others: Vec<GridAxis> = varied.filter(|axis| !along(axis)).collect();
        let held = |axis: &GridAxis| !along(axis) && !others.contains(axis);
        let fixed: Vec<GridAxis> = GridAxis::ALL.into_iter().filter(held).collect();
        let at = |row: &LossRow, axis: GridAxis| row.requested[axis as usize];
        // In the order of the grid, each combination once.
        let mut places: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
        let mut groups: Vec<Vec<&LossRow>> = Vec::new();
        for row in rows {
            let key = others.iter().map(|axis| at(row, *axis).to_bits()).collect();
            let place = *places.entry(key).or_insert(groups.len());
            if place == groups.len() {
                groups.push(Vec::new());
            }
            groups[place].push(row);
        }
        let count = groups.len();
        let panel = |mut list: Vec<&'a LossRow>| {
            let title = table.values_in_words(&list[0].requested, &others);
            // Stable sort: by x after y.
            for axis in y.into_iter().chain([x]) {
                list.sort_by(|a, b| at(a, axis).total_cmp(&at(b, axis)));
            }
            let columns = list.chunk_by(|a, b| at(a, x).to_bits() == at(b, x).to_bits());
            let rows = columns.map(<[&LossRow]>::to_vec).collect();
            Panel { title, rows }
        };
        let values = |axis: GridAxis| {
            let mut values = table.grid.axis_values(axis).to_vec();
            values.sort_by(f64::total_cmp);
            (axis, values)
        };
        let held = table.values_in_words(&table.grid.at(0), &fixed);
        let mut subject = format!("{}: {held}", table.setup.name);
        if count > MAX_PANELS {
            subject += &format!(" (first {MAX_PANELS} of {count} combinations)");
        }
        Layout {
            x: values(x),
            y: y.map(values),
            panels: groups.into_iter().take(MAX_PANELS).map(panel).collect(),
            subject,
        }
    }
}

/// One map of the total and one of each group of components.
fn maps(table: &LossTable, layout: &Layout) -> Vec<(String, String)> {
    let Some((y_axis, y)) = &layout.y else {
        return Vec::new();
    };
    let cvt = table.is_cvt();
    let draw = |file: &str, title: &str, parts: &[Component]| {
        let sum = |row: &&LossRow| parts.iter().map(|c| row.answer.part_nm(*c)).sum::<f64>();
        let drawn = layout
            .panels
            .iter()
            .flat_map(|panel| panel.rows.iter().flatten());
        let title = &span(title, drawn.map(sum));
        let column = |column: &Vec<&LossRow>| column.iter().map(sum).collect();
        let panel = |facet: &Panel| (facet.title.clone(), facet.rows.iter().map(column).collect());
        let figure = MapFigure {
            title,
            subject: &layout.subject,
            value: "Loss [Nm]",
            x: (layout.x.0.title(cvt), &layout.x.1),
            y: (y_axis.title(cvt), y),
            panels: layout.panels.iter().map(panel).collect(),
        };
        (format!("losses_{file}.svg"), map_figure(&figure))
    };
    let total = draw("total", "The transmission loses", &table.components());
    let groups = table.groups().into_iter().map(|(name, parts)| {
        let name = name.to_lowercase();
        draw(
            &name.replace(' ', "_"),
            &format!("{} takes", capital_first(&name)),
            &parts,
        )
    });
    [total].into_iter().chain(groups).collect()
}

/// "The transmission loses 8.2 to 15.6 Nm".
fn span(what: &str, values: impl Iterator<Item = f64>) -> String {
    match engine::range(values) {
        Some((low, high)) => {
            let [low, high] = [low, high].map(|nm| grouped(nm, 2));
            if low == high {
                return format!("{what} {low} Nm at every point");
            }
            format!("{what} {low} to {high} Nm")
        }
        None => format!("{what} what is not known"),
    }
}

const TOP: f64 = 58.0;
/// Room above a panel for its title, pixels.
const ABOVE: f64 = 24.0;
/// Width of the legend next to a lone panel, and room right of several, pixels; their legend lies below them.
const STRIPS: [f64; 2] = [206.0, 16.0];

/// All components stacked over one axis.
fn stack(table: &LossTable, layout: &Layout) -> String {
    let parts = table.components();
    let several = layout.panels.len() > 1;
    let strip = STRIPS[usize::from(several)];
    let (columns, size, pitch) = panels_left_of(strip, layout.panels.len());
    let titled = layout.panels.iter().any(|panel| !panel.title.is_empty());
    let top = TOP + if titled { ABOVE } else { 0.0 };
    let place = grid((PLOT_LEFT, top), size, pitch, columns);
    let loss = |row: &LossRow, part: Component| row.answer.part_nm(part);
    let sum = |column: &Vec<&LossRow>| {
        let losses = parts.iter().map(|part| loss(column[0], *part));
        losses.filter(|x| x.is_finite()).sum::<f64>()
    };
    let sums = layout.panels.iter().flat_map(|panel| &panel.rows).map(sum);
    let ticks = if several { (4, 5) } else { (8, 8) };
    let (axis, xs) = &layout.x;
    let x = Axis::exact(axis.title(table.is_cvt()), xs[0], xs[xs.len() - 1], ticks.0);
    let y = Axis::round("Loss at the input shaft [Nm]", sums.chain([0.0]), ticks.1);
    let panel = |(k, facet): (usize, &Panel)| {
        let mut panel = engine::Panel::new(place(k), x.clone(), y.clone()).heading(&facet.title);
        let layer = |(k, part): (usize, &Component)| {
            let losses = facet.rows.iter().map(|column| loss(column[0], *part));
            (Look::solid(k), xs.iter().copied().zip(losses).collect())
        };
        let layers = parts.iter().enumerate().map(layer).collect();
        stack_layers(&mut panel, layers, |k| Fill::component(parts[k]));
        panel
    };
    // Listed from the top, as in the stack.
    let entries = parts.iter().rev();
    let entries = entries.map(|part| Entry::fill(Fill::component(*part), part.title()));
    let titles: Vec<&str> = parts.iter().map(|part| part.title()).collect();
    let all = layout.panels.iter().flat_map(|panel| &panel.rows).map(sum);
    let title = span("The transmission loses", all);
    let chart = Chart::new(title, &layout.subject, PLOT_LEFT)
        .lead(format!("Stacked from the bottom: {}", titles.join(", ")))
        .panels(layout.panels.iter().enumerate().map(panel));
    let chart = if several {
        chart.legend((PLOT_LEFT, WIDTH - PLOT_LEFT - 20.0), entries)
    } else {
        chart.side(Side {
            corner: (place(0).right + 16.0, top),
            width: strip - 24.0,
            entries: entries.collect(),
            ..Side::default()
        })
    };
    chart.picture(PictureTable::default()).svg
}
