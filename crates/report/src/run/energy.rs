//! Energy balance, and the terms of a difference of fuel.

use super::super::document::{ReportTable, Section};
use super::super::number::{Quantity, percent};
use super::Car;
use crate::charts::figures::{CarEnergy, Term, energy_flow, transmission_flow};

/// Terms of the power ledger with their names and what they are.
pub(crate) const TERMS: [(&str, &str, Term); 7] = [
    ("wheels", "rolling and air, net", Term::Wheels),
    ("brake", "brakes", Term::Brake),
    ("losses", "transmission", Term::Transmission),
    ("accessories", "accessories", Term::Accessories),
    ("kinetic", "rotating parts", Term::Kinetic),
    ("engine_heat", "heat to the engine", Term::EngineHeat),
    ("exhaust", "exhaust", Term::Exhaust),
];

/// A car's ledger as the figures want it, kJ.
fn car_energy(car: &Car) -> CarEnergy {
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
    for (term, words, _) in TERMS {
        table.named(words, cells(&|car| car.run.ledger_kj.get(term)));
    }
    table.strong(
        "fuel".to_owned(),
        cells(&|car| Some(car.run.fuel_energy_kj)),
    );
    table
}
