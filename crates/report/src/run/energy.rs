//! Energy balance, and the terms of a difference of fuel.

use super::super::document::{ReportTable, Section};
use super::super::number::{Quantity, grouped, percent, signed};
use super::Car;
use crate::charts::Picture;
use crate::charts::decision::PerKm;
use crate::charts::figures::{CarEnergy, TERMS, Term, energy_flow, transmission_flow};

/// Ledger of a car for the figures, kJ/km.
fn car_energy(car: &Car, conditions: &str) -> CarEnergy {
    let per_km = |kj: f64| kj / car.run.distance_km;
    let term = |name: &str| per_km(car.run.term_kj(name).unwrap_or(f64::NAN));
    let electric = per_km(car.run.term_kj("electric").unwrap_or(0.0));
    let losses = car.losses_kj().into_iter();
    CarEnergy {
        subject: car.run.label().to_owned(),
        conditions: conditions.to_owned(),
        fuel_kj_km: per_km(car.run.fuel_energy_kj),
        exhaust_kj_km: term("exhaust"),
        engine_heat_kj_km: term("engine_heat"),
        accessories_kj_km: term("accessories") + electric,
        kinetic_kj_km: term("kinetic"),
        losses_kj_km: losses.map(|(c, kj)| (c, per_km(kj))).collect(),
        brake_kj_km: term("brake"),
        wheels_kj_km: term("wheels"),
        largest_kj_km: [0.0; 2],
    }
}

/// Ledgers of all cars, with a common scale.
fn energies(cars: &[Car], conditions: &str) -> Vec<CarEnergy> {
    let energy = |car| car_energy(car, conditions);
    let mut all: Vec<CarEnergy> = cars.iter().map(energy).collect();
    let max_of = |value_of: fn(&CarEnergy) -> f64| all.iter().map(value_of).fold(0.0, f64::max);
    let largest_kj_km = [
        max_of(|car| car.fuel_kj_km),
        max_of(CarEnergy::flywheel_kj_km),
    ];
    for car in &mut all {
        car.largest_kj_km = largest_kj_km;
    }
    all
}

/// Energies of two cars over their distance, kJ/km.
pub(crate) fn per_km(subject: &Car, baseline: &Car) -> PerKm {
    let per_km = |car: &Car, kj: Option<f64>| kj.unwrap_or(0.0) / car.run.distance_km;
    let term = |(name, words, term): (&str, &str, Term)| {
        let [own, other] = [subject, baseline].map(|car| per_km(car, car.run.term_kj(name)));
        (words.to_owned(), term, own - other)
    };
    PerKm {
        names: [subject, baseline].map(|car| car.run.label().to_owned()),
        fuel: [subject, baseline].map(|car| per_km(car, Some(car.run.fuel_energy_kj))),
        terms: TERMS.into_iter().map(term).collect(),
    }
}

/// Sentence on the terms by which the fuel of the subject differs from that of a baseline per kilometre. It leaves their sum out, which has a range that is with the answer.
pub(super) fn difference(subject: &Car, baseline: &Car) -> String {
    let mut terms = per_km(subject, baseline).terms;
    terms.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    let large = terms.iter().filter(|(.., x)| x.abs() >= 0.5);
    let terms: Vec<String> = large
        .map(|(name, _, x)| format!("{} {name}", signed(grouped(*x, 0), *x)))
        .collect();
    let (subject, baseline) = (subject.run.label(), baseline.run.label());
    match terms.is_empty() {
        true => format!("No term differs by 0.5 kJ/km between {subject} and {baseline}."),
        false => format!(
            "Terms of {subject} against {baseline}, in kJ/km: {}.",
            terms.join(", ")
        ),
    }
}

pub(super) fn section(cars: &[Car], conditions: &str) -> Section {
    let mut section = Section::new("energy", "Energy from fuel to wheel");
    section.text(
        "Widths are in proportion to the energy per kilometre over the whole cycle, by the ledger of the run: fuel = exhaust + heat to the engine + accessories \
         + rotating parts + transmission + brakes + rolling and air. Wheel work is net of overrun. What the rotating parts keep is drawn with the accessories where it is less than 0.5 % of the fuel, and parts of the transmission with less than 0.5 % of the work at the flywheel are drawn as one.",
    );
    let stops = |car: &Car| car.run.term_kj("electric").is_some_and(|kj| kj.abs() > 0.0);
    if cars.iter().any(stops) {
        section.text(
            "Battery and starter: what the alternator, the battery and the starter lose, and what is stored in the battery. In the figures it is a part of the accessories.",
        );
    }
    section.table(balance(cars));
    let energies = energies(cars, conditions);
    let passed = energies.iter().filter_map(|car| {
        Some(format!(
            "{} {} %",
            car.subject,
            grouped(100.0 * car.passed()?, 0)
        ))
    });
    let passed: Vec<String> = passed.collect();
    if !passed.is_empty() {
        section.text(format!(
            "Of the work at the flywheel, brakes and wheels get: {}.",
            passed.join(", ")
        ));
    }
    type Draw = fn(&CarEnergy) -> Picture;
    let view = |kind: &str, about: &str, draw: Draw| {
        let all = cars.iter().zip(&energies);
        let view = all.map(|(car, energy)| {
            let name = car.run.label();
            let caption = format!("{about} of {name}; all cars on one scale.");
            (
                name.to_owned(),
                format!("{kind}_{}", car.run.vehicle),
                caption,
                draw(energy),
            )
        });
        view.collect::<Vec<_>>()
    };
    let about = "Energy from the fuel to the road";
    section.views("energy_flow", view("energy_flow", about, energy_flow));
    let about = "From the flywheel through each part of the transmission to the wheels";
    section.views(
        "transmission_flow",
        view("transmission_flow", about, transmission_flow),
    );
    section
}

fn balance(cars: &[Car]) -> ReportTable {
    let mut table = with_shares("Energy balance", "Term", "of fuel", cars);
    let mut add = |words: &str, value_of: &dyn Fn(&Car) -> Option<f64>| {
        table.named(
            words,
            cells_with_shares(cars, |car| Some((value_of(car), car.run.fuel_energy_kj))),
        );
    };
    for (term, words, _) in TERMS {
        let value_of = |car: &Car| car.run.term_kj(term);
        let is_there = |car: &Car| value_of(car).is_some_and(|kj| kj.abs() > 0.0);
        if term != "electric" || cars.iter().any(is_there) {
            add(words, &value_of);
        }
    }
    add("fuel", &|car| Some(car.run.fuel_energy_kj));
    table.emphasise(true);
    table
}

/// An empty table of energies of each car with their shares.
pub(super) fn with_shares(caption: &str, first: &str, whole: &str, cars: &[Car]) -> ReportTable {
    let columns = |car: &Car| [(car.run.label().to_owned(), "kJ"), (whole.to_owned(), "%")];
    ReportTable::numeric(caption, first, cars.iter().flat_map(columns))
}

/// Cells of an energy and a whole of each car, kJ; empty without them.
pub(super) fn cells_with_shares(
    cars: &[Car],
    energy_and_whole: impl Fn(&Car) -> Option<(Option<f64>, f64)>,
) -> impl Iterator<Item = String> {
    cars.iter()
        .flat_map(move |car| match energy_and_whole(car) {
            Some((kj, whole)) => [Quantity::Energy.bare(kj), percent(kj, whole)],
            None => Default::default(),
        })
}
