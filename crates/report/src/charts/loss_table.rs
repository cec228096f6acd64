//! Figures of a grid: maps over two axes, stacks over one, a panel for each combination of the other axes.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use cvtcycle_output::Component;
use cvtcycle_output::losses::{Axis, LossRow, LossTable};

use super::{MapFigure, StackFigure, map_figure, stack_figure};

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

/// Figures of the losses over a grid with their file names; none for a single point.
#[must_use]
pub fn loss_figures(plan: &LossTable) -> Vec<(String, String)> {
    let varied = plan.grid.varied();
    let gears = |axis: &Axis| *axis == Axis::Ratio && !plan.is_cvt();
    let on_map: Vec<Axis> = ORDER
        .into_iter()
        .filter(|axis| {
            varied.contains(axis) && plan.grid.of(*axis).len() >= MIN_ON_MAP && !gears(axis)
        })
        .collect();
    let rows: Vec<LossRow> = plan.rows().collect();
    match (on_map.as_slice(), varied.is_empty()) {
        ([x, rest @ ..], _) if !rest.is_empty() => {
            // The axis with most values, so that few panels are needed; of equals the first.
            let y = rest
                .iter()
                .rev()
                .max_by_key(|axis| plan.grid.of(**axis).len());
            maps(plan, &Layout::new(plan, &rows, *x, y.copied()))
        }
        ([x, ..], _) => stack(plan, &Layout::new(plan, &rows, *x, None)),
        ([], false) => {
            let varied = ORDER.into_iter().filter(|axis| varied.contains(axis));
            let x = varied.max_by_key(|axis| plan.grid.of(*axis).len());
            stack(
                plan,
                &Layout::new(plan, &rows, x.unwrap_or(Axis::Ratio), None),
            )
        }
        ([], true) => Vec::new(),
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
        let along = |axis: Axis| x == axis || y == Some(axis);
        let others: Vec<Axis> = plan
            .grid
            .varied()
            .into_iter()
            .filter(|axis| !along(*axis))
            .collect();
        let fixed: Vec<Axis> = Axis::ALL
            .into_iter()
            .filter(|axis| !along(*axis) && !others.contains(axis))
            .collect();
        let key = |row: &LossRow| {
            others
                .iter()
                .map(|axis| row.asked[*axis as usize].to_bits())
                .collect::<Vec<u64>>()
        };
        // In the order of the grid, each combination once.
        let mut places: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
        let mut gathered: Vec<Vec<&LossRow>> = Vec::new();
        for row in rows {
            let place = *places.entry(key(row)).or_insert(gathered.len());
            match gathered.get_mut(place) {
                Some(group) => group.push(row),
                None => gathered.push(vec![row]),
            }
        }
        let count = gathered.len();
        let panels = gathered.into_iter().take(MAX_PANELS).map(|mut list| {
            let title = plan.held(&list[0].asked, &others);
            let at = |row: &LossRow, axis: Axis| row.asked[axis as usize];
            let by =
                |axis: Axis| move |a: &&LossRow, b: &&LossRow| at(a, axis).total_cmp(&at(b, axis));
            list.sort_by(|a, b| {
                by(x)(a, b).then_with(|| y.map_or(Ordering::Equal, |y| by(y)(a, b)))
            });
            let columns = list.chunk_by(|a, b| at(a, x).to_bits() == at(b, x).to_bits());
            let rows = columns.map(<[&LossRow]>::to_vec).collect();
            Panel { title, rows }
        });
        let values = |axis: Axis| {
            let mut values = plan.grid.of(axis).to_vec();
            values.sort_by(f64::total_cmp);
            values
        };
        let mut subject = format!(
            "{}: {}",
            plan.setup.name,
            plan.held(&plan.grid.at(0), &fixed)
        );
        if count > MAX_PANELS {
            subject += &format!(" (first {MAX_PANELS} of {count} combinations)");
        }
        Layout {
            x: (x, values(x)),
            y: y.map(|y| (y, values(y))),
            panels: panels.collect(),
            subject,
        }
    }
}

fn sum(row: &LossRow, parts: &[Component]) -> f64 {
    parts.iter().map(|c| row.answer.part_nm(*c)).sum()
}

/// One map of the total and one of each group of components.
fn maps(plan: &LossTable, layout: &Layout) -> Vec<(String, String)> {
    let Some((y_axis, y)) = &layout.y else {
        return Vec::new();
    };
    let cvt = plan.is_cvt();
    let total = ("All losses".to_owned(), plan.components());
    let all = [total].into_iter().chain(plan.groups());
    all.map(|(name, parts)| {
        let values = |panel: &Panel| {
            panel
                .rows
                .iter()
                .map(|column| column.iter().map(|row| sum(row, &parts)).collect())
                .collect()
        };
        let title = if name == "All losses" {
            "Torque loss of the transmission".to_owned()
        } else {
            format!("Torque loss: {}", name.to_lowercase())
        };
        let figure = MapFigure {
            title: &title,
            subject: &layout.subject,
            value: "Loss [Nm]",
            x: (layout.x.0.title(cvt), &layout.x.1),
            y: (y_axis.title(cvt), y),
            panels: layout
                .panels
                .iter()
                .map(|panel| (panel.title.clone(), values(panel)))
                .collect(),
        };
        let file = if name == "All losses" {
            "total".to_owned()
        } else {
            name.to_lowercase().replace(' ', "_")
        };
        (format!("losses_{file}.svg"), map_figure(&figure))
    })
    .collect()
}

/// All components stacked over one axis.
fn stack(plan: &LossTable, layout: &Layout) -> Vec<(String, String)> {
    let components = plan.components();
    let values = |panel: &Panel, component: Component| {
        let columns = panel.rows.iter();
        columns
            .map(|column| column[0].answer.part_nm(component))
            .collect()
    };
    let panels = layout.panels.iter().map(|panel| {
        let stacked = components.iter().map(|c| values(panel, *c));
        (panel.title.clone(), stacked.collect())
    });
    let figure = stack_figure(&StackFigure {
        title: "Torque losses of the transmission",
        subject: &layout.subject,
        value: "Loss at the input shaft [Nm]",
        x: (layout.x.0.title(plan.is_cvt()), &layout.x.1),
        parts: components.iter().map(|c| c.title().to_owned()).collect(),
        panels: panels.collect(),
    });
    vec![("losses_stacked.svg".to_owned(), figure)]
}
