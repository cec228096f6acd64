//! Losses of the transmission by component: a panel of bars for each car.

use super::bar_rows::{at_end, axis_with_room, bar, bar_chart, bars_panel, name, stacked};
use super::{TEXT, TOP, energy, finite, percent};
use crate::charts::engine::{Axis, Fill, Panel, Point, Style, cell, rows_left};
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
        let of = |car: &CarLosses| car.losses_kj.clone();
        let total = |car: &CarLosses| std::iter::repeat(car.total_kj());
        cars.iter()
            .flat_map(move |car| of(car).into_iter().zip(total(car)))
    };
    let names: Vec<String> = all().map(|((c, _), _)| capital(c.name())).collect();
    let left = rows_left(names.iter().map(String::as_str), TEXT);
    let values = all().map(|((_, kj), _)| finite(kj));
    let labels = all().map(|((_, kj), total)| label(kj, total));
    let x = axis_with_room("Energy lost over the cycle [kJ]", left, values, labels);
    let subject = match cars {
        [car] => car.name.clone(),
        _ => format!(
            "{} cars, one scale; components in the order of the power flow",
            cars.len()
        ),
    };
    let draw = |k: usize, corner: Point| match cars.get(k) {
        Some(car) => draw(car, corner, &x, &mut table),
        None => bars_panel(corner, 1, x.clone()).no_data(true),
    };
    let chart = bar_chart("Transmission losses by component", subject);
    stacked(chart, (left, TOP), (24.0, 16.0), cars.len().max(1), draw).picture(table)
}

fn draw(car: &CarLosses, corner: Point, x: &Axis, table: &mut PictureTable) -> Panel {
    let total = car.total_kj();
    let mut panel = bars_panel(corner, car.losses_kj.len(), x.clone())
        .heading(format!("{}: {} in all", car.name, energy(total)))
        .no_data(car.losses_kj.is_empty());
    for (row, (component, kj)) in car.losses_kj.iter().enumerate() {
        let words = capital(component.name());
        let numbers = [*kj, 100.0 * kj / total].map(|x| cell(x, 0.01));
        let names = [car.name.clone(), words.clone()];
        let at_row = table.push(names.into_iter().chain(numbers));
        let style = Style::edged(Fill::component(*component), 0.5).row(at_row);
        name(&mut panel, row, &words, false);
        bar(&mut panel, row, (0.0, finite(*kj)), style);
        at_end(&mut panel, row, finite(*kj), false, label(*kj, total));
    }
    panel
}

fn label(kj: f64, total: f64) -> String {
    match percent(kj, total).as_str() {
        "" => energy(kj),
        share => format!("{}, {share}", energy(kj)),
    }
}
