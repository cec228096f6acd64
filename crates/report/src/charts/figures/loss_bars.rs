//! Losses of the transmission by component: a panel of bars for each car.

use super::bar_rows::{at_end, axis_with_room, bar, bars_panel, label_room, name};
use super::{MARGIN, TEXT, TOP, energy, finite, percent};
use crate::charts::engine::{Axis, Chart, Fill, Panel, Style, cell, rows_left};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::capital;
use cvtcycle_output::Component;

/// Losses of one car.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarLosses {
    /// Name of the car.
    pub name: String,
    /// Energy lost by each component over the cycle, kJ, in the order of the power flow.
    pub losses_kj: Vec<(Component, f64)>,
}

impl CarLosses {
    /// All of them, kJ.
    #[must_use]
    pub fn total_kj(&self) -> f64 {
        self.losses_kj.iter().map(|(_, kj)| finite(*kj)).sum()
    }
}

/// Heights above a panel and between panels, pixels.
const HEADING: f64 = 24.0;
const GAP: f64 = 16.0;

/// Losses over the cycle by component, in the order of the power flow, with their share of the car's transmission loss.
#[must_use]
pub fn loss_by_component(cars: &[CarLosses]) -> Picture {
    let mut table = PictureTable::new(&[
        ("car", ""),
        ("component", ""),
        ("energy", "kJ"),
        ("share of the transmission's loss", "%"),
    ]);
    let all = || {
        cars.iter()
            .flat_map(|car| car.losses_kj.iter().map(move |(c, kj)| (car, c, *kj)))
    };
    let names: Vec<String> = all().map(|(_, c, _)| capital(c.name())).collect();
    let left = rows_left(names.iter().map(String::as_str), TEXT);
    let room = label_room(all().map(|(car, _, kj)| label(kj, car.total_kj())));
    let values = all().map(|(.., kj)| finite(kj));
    let axis = axis_with_room("Energy lost over the cycle [kJ]", left, values, room);
    let mut panels: Vec<Panel> = Vec::new();
    let mut top = TOP + HEADING;
    for car in cars {
        panels.push(draw(car, (left, top), &axis, &mut table));
        top = panels[panels.len() - 1].rect.bottom + GAP + HEADING;
    }
    if cars.is_empty() {
        panels.push(Panel {
            no_data: true,
            ..bars_panel((left, top), 1, axis)
        });
    }
    let last = panels.len() - 1;
    for panel in &mut panels[..last] {
        panel.x_labels = false;
    }
    let chart = Chart {
        title: "Transmission losses by component".to_owned(),
        subject: match cars {
            [car] => car.name.clone(),
            _ => format!(
                "{} cars, one scale; components in the order of the power flow",
                cars.len()
            ),
        },
        description: describe(cars),
        left: MARGIN,
        panels,
        table,
        ..Chart::default()
    };
    chart.picture()
}

fn draw(car: &CarLosses, corner: (f64, f64), x: &Axis, table: &mut PictureTable) -> Panel {
    let total = car.total_kj();
    let mut panel = bars_panel(corner, car.losses_kj.len(), x.clone());
    panel.heading = format!("{}: {} in all", car.name, energy(total));
    panel.no_data = car.losses_kj.is_empty();
    for (row, (component, kj)) in car.losses_kj.iter().enumerate() {
        let words = capital(component.name());
        let numbers = [*kj, 100.0 * kj / total].map(|x| cell(x, 0.01));
        let cells = [vec![car.name.clone(), words.clone()], numbers.to_vec()].concat();
        let style = Style::edged(Fill::component(*component), 0.5).row(table.push(cells));
        name(&mut panel, row, &words, false);
        bar(&mut panel, row, (0.0, finite(*kj)), style);
        at_end(&mut panel, row, finite(*kj), false, label(*kj, total));
    }
    panel
}

fn label(kj: f64, total: f64) -> String {
    let share = percent(kj, total);
    if share.is_empty() {
        energy(kj)
    } else {
        format!("{}, {share}", energy(kj))
    }
}

fn describe(cars: &[CarLosses]) -> String {
    let car = |car: &CarLosses| {
        let total = car.total_kj();
        let part = |(c, kj): &(Component, f64)| {
            format!(
                "{} {} {}",
                capital(c.name()).to_lowercase(),
                energy(*kj),
                percent(*kj, total)
            )
        };
        let parts: Vec<String> = car.losses_kj.iter().map(part).collect();
        format!(
            "{}: {} in all; {}",
            car.name,
            energy(total),
            parts.join(", ")
        )
    };
    format!(
        "Energy lost by component over the cycle. {}.",
        cars.iter().map(car).collect::<Vec<_>>().join(". ")
    )
}
