//! Figures of losses over a grid: maps over two axes, stacks over one, a panel for each combination of the other axes.

use std::collections::BTreeMap;

use super::grids::{MapFigure, map_figure};
use super::lines::{StackFigure, stack_figure};
use cvtcycle_output::Component;
use cvtcycle_output::losses::{Axis, LossRow, LossTable};

/// Smallest number of values on an axis of a map: values between two points are unknown.
const MIN_ON_MAP: usize = 3;
/// Largest number of panels of a figure.
const MAX_PANELS: usize = 12;
/// Axes by priority.
const ORDER: [Axis; 7] = [
    Axis::Speed,
    Axis::Torque,
    Axis::Sump,
    Axis::Pressure,
    Axis::Throttle,
    Axis::Belt,
    Axis::Ratio,
];

/// Figures with their file names; none for a single point.
#[must_use]
pub fn loss_figures(plan: &LossTable) -> Vec<(String, String)> {
    let varied = plan.grid.varied();
    let count = |axis: &Axis| plan.grid.of(*axis).len();
    let gears = |axis: &Axis| *axis == Axis::Ratio && !plan.is_cvt();
    let drawn = ORDER.into_iter().filter(|axis| varied.contains(axis));
    let on_map = drawn
        .clone()
        .filter(|axis| count(axis) >= MIN_ON_MAP && !gears(axis));
    let rows: Vec<LossRow> = plan.rows().collect();
    let stacked = |x: Axis| {
        let svg = stack(plan, &Layout::new(plan, &rows, x, None));
        vec![("losses_stacked.svg".to_owned(), svg)]
    };
    match (on_map.collect::<Vec<_>>().as_slice(), varied.is_empty()) {
        (_, true) => Vec::new(),
        ([], false) => stacked(drawn.max_by_key(count).unwrap_or(Axis::Ratio)),
        ([x], _) => stacked(*x),
        ([x, rest @ ..], _) => {
            // The axis with most values, so that few panels are needed; of equals the first.
            let y = rest.iter().rev().max_by_key(|axis| count(axis));
            maps(plan, &Layout::new(plan, &rows, *x, y.copied()))
        }
    }
}

/// One value of each axis that is not drawn along, and the rows of its panel.
struct Panel<'a> {
    title: String,
    /// Rows by x, then by y.
    rows: Vec<Vec<&'a LossRow>>,
}

struct Layout<'a> {
    x: (Axis, Vec<f64>),
    y: Option<(Axis, Vec<f64>)>,
    panels: Vec<Panel<'a>>,
    subject: String,
}

impl<'a> Layout<'a> {
    fn new(plan: &LossTable, rows: &'a [LossRow], x: Axis, y: Option<Axis>) -> Self {
        let along = |axis: &Axis| x == *axis || y == Some(*axis);
        let varied = plan.grid.varied().into_iter();
        let others: Vec<Axis> = varied.filter(|axis| !along(axis)).collect();
        let held = |axis: &Axis| !along(axis) && !others.contains(axis);
        let fixed: Vec<Axis> = Axis::ALL.into_iter().filter(held).collect();
        let at = |row: &LossRow, axis: Axis| row.asked[axis as usize];
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
            let title = plan.held(&list[0].asked, &others);
            // Stable: first by y, then by x.
            for axis in y.into_iter().chain([x]) {
                list.sort_by(|a, b| at(a, axis).total_cmp(&at(b, axis)));
            }
            let columns = list.chunk_by(|a, b| at(a, x).to_bits() == at(b, x).to_bits());
            let rows = columns.map(<[&LossRow]>::to_vec).collect();
            Panel { title, rows }
        };
        let values = |axis: Axis| {
            let mut values = plan.grid.of(axis).to_vec();
            values.sort_by(f64::total_cmp);
            (axis, values)
        };
        let held = plan.held(&plan.grid.at(0), &fixed);
        let mut subject = format!("{}: {held}", plan.setup.name);
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

    /// Title and values of each panel; `column` gets the rows of one value of the horizontal axis.
    fn values<T>(&self, of: impl Fn(&Panel<'a>) -> T) -> Vec<(String, T)> {
        let panels = self.panels.iter();
        panels
            .map(|panel| (panel.title.clone(), of(panel)))
            .collect()
    }
}

/// One map of the total and one of each group of components.
fn maps(plan: &LossTable, layout: &Layout) -> Vec<(String, String)> {
    let Some((y_axis, y)) = &layout.y else {
        return Vec::new();
    };
    let cvt = plan.is_cvt();
    let draw = |file: &str, title: &str, parts: &[Component]| {
        let sum = |row: &&LossRow| parts.iter().map(|c| row.answer.part_nm(*c)).sum();
        let column = |column: &Vec<&LossRow>| column.iter().map(sum).collect();
        let figure = MapFigure {
            title,
            subject: &layout.subject,
            value: "Loss [Nm]",
            x: (layout.x.0.title(cvt), &layout.x.1),
            y: (y_axis.title(cvt), y),
            panels: layout.values(|panel| panel.rows.iter().map(column).collect()),
        };
        (format!("losses_{file}.svg"), map_figure(&figure))
    };
    let total = draw(
        "total",
        "Torque loss of the transmission",
        &plan.components(),
    );
    let groups = plan.groups().into_iter().map(|(name, parts)| {
        let name = name.to_lowercase();
        draw(
            &name.replace(' ', "_"),
            &format!("Torque loss: {name}"),
            &parts,
        )
    });
    [total].into_iter().chain(groups).collect()
}

/// All components stacked over one axis.
fn stack(plan: &LossTable, layout: &Layout) -> String {
    let components = plan.components();
    let panels = layout.values(|panel| {
        let part = |c: &Component| {
            let columns = panel.rows.iter();
            columns.map(|column| column[0].answer.part_nm(*c)).collect()
        };
        components.iter().map(part).collect()
    });
    stack_figure(&StackFigure {
        title: "Torque losses of the transmission",
        subject: &layout.subject,
        value: "Loss at the input shaft [Nm]",
        x: (layout.x.0.title(plan.is_cvt()), &layout.x.1),
        parts: components.iter().map(|c| c.title().to_owned()).collect(),
        panels,
    })
}
