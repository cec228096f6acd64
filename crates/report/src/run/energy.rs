//! Energy balance, and the terms of a difference of fuel.

use super::super::document::{ReportTable, Section};
use super::super::number::{Quantity, percent};
use super::Car;
use crate::charts::figures::{CarEnergy, energy_flow, transmission_flow};

/// Terms of the power ledger with their names.
pub const TERMS: [(&str, &str); 7] = [
    ("wheels", "rolling and air, net"),
    ("brake", "brakes"),
    ("losses", "transmission"),
    ("accessories", "accessories"),
    ("kinetic", "rotating parts"),
    ("engine_heat", "heat to the engine"),
    ("exhaust", "exhaust"),
];

/// A car's ledger as the figures want it, kJ.
#[must_use]
pub fn car_energy(car: &Car) -> CarEnergy {
    let term = |name: &str| car.run.ledger_kj.get(name).unwrap_or(f64::NAN);
    CarEnergy {
        subject: car.run.vehicle.clone(),
        fuel_kj: car.run.fuel_energy_kj,
        exhaust_kj: term("exhaust"),
        engine_heat_kj: term("engine_heat"),
        accessories_kj: term("accessories"),
        kinetic_kj: term("kinetic"),
        losses_kj: car.losses_kj(),
        brake_kj: term("brake"),
        wheels_kj: term("wheels"),
    }
}

/// What the fuel of the subject has more than that of a baseline, term by term.
pub(super) fn difference(subject: &Car, baseline: &Car) -> String {
    let term = |car: &Car, name: &str| car.run.ledger_kj.get(name).unwrap_or(0.0);
    let fuel = subject.run.fuel_energy_kj - baseline.run.fuel_energy_kj;
    let mut parts: Vec<(&str, f64)> = TERMS
        .iter()
        .map(|(name, words)| (*words, term(subject, name) - term(baseline, name)))
        .collect();
    parts.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let terms: Vec<String> = parts
        .iter()
        .filter(|(_, kj)| kj.abs() >= 0.5)
        .map(|(words, kj)| format!("{words} {}", Quantity::Energy.signed(*kj)))
        .collect();
    let distances = (subject.run.distance_km - baseline.run.distance_km).abs();
    let drive = if distances > 0.0005 {
        format!(
            " The two drive different distances ({} and {}), so distance is a part of it.",
            Quantity::Distance.text(subject.run.distance_km),
            Quantity::Distance.text(baseline.run.distance_km)
        )
    } else {
        String::new()
    };
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
    section.table(balance(cars));
    for car in cars {
        let (name, energy) = (&car.run.vehicle, car_energy(car));
        section.heading(car.run.title.clone());
        section.figure(
            format!("energy_flow_{name}"),
            format!("Energy of {name} from the fuel to the road."),
            energy_flow(&energy),
        );
        let caption = format!(
            "The same, enlarged: from the flywheel of {name} through each part of the transmission to the wheels."
        );
        section.figure(
            format!("transmission_flow_{name}"),
            caption,
            transmission_flow(&energy),
        );
    }
    section
}

fn balance(cars: &[Car]) -> ReportTable {
    let columns = cars.iter().flat_map(|car| {
        [
            (car.run.vehicle.clone(), "kJ".to_owned()),
            ("of fuel".to_owned(), "%".to_owned()),
        ]
    });
    let mut table = ReportTable::of_numbers("Energy balance", "Term", columns);
    let cells = |of: &dyn Fn(&Car) -> Option<f64>| -> Vec<String> {
        cars.iter()
            .flat_map(|car| {
                [
                    Quantity::Energy.bare(of(car)),
                    percent(of(car), car.run.fuel_energy_kj),
                ]
            })
            .collect()
    };
    for (term, words) in TERMS {
        table.named(words.to_owned(), cells(&|car| car.run.ledger_kj.get(term)));
    }
    table.strong(
        "fuel".to_owned(),
        cells(&|car| Some(car.run.fuel_energy_kj)),
    );
    table
}
