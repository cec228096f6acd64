//! Energy balance, and the terms of a difference of fuel.

use super::super::document::{ReportTable, Section};
use super::super::number::{Quantity, percent};
use super::Car;
use crate::charts::figures::{CarEnergy, TERMS, energy_flow, transmission_flow};

/// A car's ledger as the figures want it, kJ.
fn car_energy(car: &Car) -> CarEnergy {
    let term = |name: &str| car.run.term_kj(name).unwrap_or(f64::NAN);
    CarEnergy {
        subject: car.run.vehicle.clone(),
        fuel_kj: car.run.fuel_energy_kj,
        exhaust_kj: term("exhaust"),
        engine_heat_kj: term("engine_heat"),
        accessories_kj: term("accessories") + car.run.term_kj("electric").unwrap_or(0.0),
        kinetic_kj: term("kinetic"),
        losses_kj: car.losses_kj(),
        brake_kj: term("brake"),
        wheels_kj: term("wheels"),
    }
}

/// What the fuel of the subject has more than that of a baseline, term by term.
pub(super) fn difference(subject: &Car, baseline: &Car) -> String {
    let term = |car: &Car, name: &str| car.run.term_kj(name).unwrap_or(0.0);
    let fuel = subject.run.fuel_energy_kj - baseline.run.fuel_energy_kj;
    let part = |(name, words, _)| (words, term(subject, name) - term(baseline, name));
    let mut parts: Vec<(&str, f64)> = TERMS.into_iter().map(part).collect();
    parts.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let large = parts.iter().filter(|(_, kj)| kj.abs() >= 0.5);
    let text = |(words, kj): &(&str, f64)| format!("{words} {}", Quantity::Energy.signed(*kj));
    let terms: Vec<String> = large.map(text).collect();
    let [own, other] = [subject, baseline].map(|car| car.run.distance_km);
    let mut drive = String::new();
    if (own - other).abs() > 0.0005 {
        let [own, other] = [own, other].map(|km| Quantity::Distance.text(km));
        drive = format!(
            " The two drive different distances ({own} and {other}), so distance is a part of it."
        );
    }
    format!(
        "Against {} the fuel's energy differs by {}: {}.{drive}",
        baseline.run.vehicle,
        Quantity::Energy.signed(fuel),
        terms.join(", ")
    )
}

pub(super) fn section(cars: &[Car]) -> Section {
    let mut section = Section::new("energy", "Energy from fuel to wheel");
    section.text(
        "Widths are in proportion to energy over the whole cycle, by the ledger of the run: fuel = exhaust + heat to the engine + accessories \
         + rotating parts + transmission + brakes + rolling and air. What the wheels gave back in overrun is set off against what they took.",
    );
    let stops = |car: &Car| car.run.term_kj("electric").is_some_and(|kj| kj.abs() > 0.0);
    if cars.iter().any(stops) {
        section.text(
            "Battery and starter: what the alternator, the battery and the starter lose, and what is stored in the battery. In the figures it is a part of the accessories.",
        );
    }
    section.table(balance(cars));
    for car in cars {
        let (name, energy) = (&car.run.vehicle, car_energy(car));
        section.heading(&car.run.title);
        let caption = format!("Energy of {name} from the fuel to the road.");
        section.figure(format!("energy_flow_{name}"), caption, energy_flow(&energy));
        let caption = format!(
            "The same, enlarged: from the flywheel of {name} through each part of the transmission to the wheels."
        );
        let name = format!("transmission_flow_{name}");
        section.figure(name, caption, transmission_flow(&energy));
    }
    section
}

fn balance(cars: &[Car]) -> ReportTable {
    let mut table = with_shares("Energy balance", "Term", "of fuel", cars);
    let mut add = |words: &str, of: &dyn Fn(&Car) -> Option<f64>| {
        table.named(
            words,
            cells_with_shares(cars, |car| Some((of(car), car.run.fuel_energy_kj))),
        );
    };
    for (term, words, _) in TERMS {
        let of = |car: &Car| car.run.term_kj(term);
        let is_there = |car: &Car| of(car).is_some_and(|kj| kj.abs() > 0.0);
        if term != "electric" || cars.iter().any(is_there) {
            add(words, &of);
        }
    }
    add("fuel", &|car| Some(car.run.fuel_energy_kj));
    table.emphasise(true);
    table
}

/// An empty table of energies of each car with their shares.
pub(super) fn with_shares(caption: &str, first: &str, of: &str, cars: &[Car]) -> ReportTable {
    let columns = |car: &Car| [(car.run.vehicle.clone(), "kJ"), (of.to_owned(), "%")];
    ReportTable::of_numbers(caption, first, cars.iter().flat_map(columns))
}

/// Cells of an energy and a whole of each car, kJ; empty without them.
pub(super) fn cells_with_shares(
    cars: &[Car],
    of: impl Fn(&Car) -> Option<(Option<f64>, f64)>,
) -> impl Iterator<Item = String> {
    cars.iter().flat_map(move |car| match of(car) {
        Some((kj, whole)) => [Quantity::Energy.bare(kj), percent(kj, whole)],
        None => Default::default(),
    })
}
