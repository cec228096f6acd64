//! Losses of the transmission by phase of the cycle: a stacked bar for each car, per distance.

use super::bar_rows::{at_end, axis_with_room, bar, bars_panel, label_room, name};
use super::{MARGIN, TEXT, TOP, finite, grouped};
use crate::charts::engine::{
    Axis, Block, Chart, Entry, Fill, Panel, Style, WIDTH, cell, rows_left,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::capital;
use cvtcycle_output::Component;

/// Losses of one car by component, in the order of the power flow.
pub type CarParts = Vec<(Component, f64)>;

/// Losses by phase group and car.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhaseLosses {
    /// The cycle and its conditions.
    pub subject: String,
    /// Names of the cars.
    pub cars: Vec<String>,
    /// For each phase group its name and, for each car, the loss of each component over the group's distance, kJ/km.
    pub groups: Vec<(String, Vec<CarParts>)>,
}

/// Heights above a panel and between panels, pixels.
const HEADING: f64 = 23.0;
const GAP: f64 = 12.0;
/// Left edge of the legend, pixels.
const LEGEND: f64 = 40.0;

/// Loss per distance of each phase group, stacked by component in the order of the power flow. A group without any finite loss, such as a
/// soak, in which no distance is driven, is left out.
#[must_use]
pub fn loss_by_phase(of: &PhaseLosses) -> Picture {
    let (of, left_out) = with_losses(of);
    let mut table = PictureTable::new(&[
        ("phase", ""),
        ("car", ""),
        ("component", ""),
        ("loss", "kJ/km"),
    ]);
    if !left_out.is_empty() {
        table.note = format!(
            "Left out, for there is no loss per distance: {}.",
            left_out.join(", ")
        );
    }
    let left = rows_left(of.cars.iter().map(String::as_str), TEXT);
    let sums = || {
        of.groups
            .iter()
            .flat_map(|(_, cars)| cars.iter().map(|parts| sum(parts)))
    };
    let room = label_room(sums().map(|sum| grouped(sum, 1)));
    let axis = axis_with_room("Loss of the transmission [kJ/km]", left, sums(), room);
    let mut panels: Vec<Panel> = Vec::new();
    let mut top = TOP + HEADING;
    for k in 0..of.groups.len() {
        panels.push(draw(&of, k, (left, top), &axis, &mut table));
        top = panels[k].rect.bottom + GAP + HEADING;
    }
    if of.groups.is_empty() {
        panels.push(Panel {
            no_data: true,
            ..bars_panel((left, top), of.cars.len(), axis)
        });
    }
    let last = panels.len() - 1;
    for panel in &mut panels[..last] {
        panel.x_labels = false;
    }
    let entry = |c: Component| Entry::fill(Fill::component(c), capital(c.name()));
    let entries = used(&of).into_iter().map(entry).collect();
    let chart = Chart {
        title: "Transmission losses by phase, per distance".to_owned(),
        subject: of.subject.clone(),
        description: describe(&of),
        left: MARGIN,
        panels,
        foot: vec![Block::legend((LEGEND, WIDTH - LEGEND - 20.0), "", entries)],
        table,
        ..Chart::default()
    };
    chart.picture()
}

/// The bars of a group, a row for each car.
fn draw(
    of: &PhaseLosses,
    group: usize,
    corner: (f64, f64),
    x: &Axis,
    table: &mut PictureTable,
) -> Panel {
    let (group, cars) = &of.groups[group];
    let mut panel = bars_panel(corner, of.cars.len(), x.clone());
    panel.heading.clone_from(group);
    for (row, (car, parts)) in of.cars.iter().zip(cars).enumerate() {
        name(&mut panel, row, car, false);
        let mut base = 0.0;
        for (component, loss) in parts {
            let words = capital(component.name());
            let at = table.push(vec![group.clone(), car.clone(), words, cell(*loss, 0.01)]);
            let next = base + finite(*loss).max(0.0);
            let style = Style::edged(Fill::component(*component), 0.5).row(at);
            bar(&mut panel, row, (base, next), style);
            base = next;
        }
        at_end(&mut panel, row, base, false, grouped(base, 1));
    }
    panel
}

/// The groups in which some loss is a number, and the names of the others.
fn with_losses(of: &PhaseLosses) -> (PhaseLosses, Vec<String>) {
    let empty = |cars: &[CarParts]| !cars.iter().flatten().any(|(_, x)| x.is_finite());
    let (left_out, groups): (Vec<_>, Vec<_>) =
        of.groups.iter().cloned().partition(|(_, cars)| empty(cars));
    (
        PhaseLosses {
            groups,
            ..of.clone()
        },
        left_out.into_iter().map(|(name, _)| name).collect(),
    )
}

/// Components of any car, in the order of the power flow.
fn used(of: &PhaseLosses) -> Vec<Component> {
    let has = |c: &Component| {
        of.groups
            .iter()
            .any(|(_, cars)| cars.iter().flatten().any(|(own, _)| own == c))
    };
    Component::ALL.into_iter().filter(has).collect()
}

fn sum(parts: &[(Component, f64)]) -> f64 {
    parts.iter().map(|(_, loss)| finite(*loss).max(0.0)).sum()
}

fn describe(of: &PhaseLosses) -> String {
    let group = |(name, cars): &(String, Vec<CarParts>)| {
        let cars = of.cars.iter().zip(cars);
        let sums = cars.map(|(car, parts)| format!("{car} {}", grouped(sum(parts), 1)));
        format!("{name}: {}", sums.collect::<Vec<_>>().join(", "))
    };
    format!(
        "Loss of the transmission per distance, kJ/km. {}.",
        of.groups.iter().map(group).collect::<Vec<_>>().join("; ")
    )
}
