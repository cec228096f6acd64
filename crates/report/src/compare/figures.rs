//! Figures of two runs: the difference by component and the traces.

use super::Pair;
use crate::charts::figures::{
    Difference, DifferenceTerm, Overlay, OverlayPanel, Term, difference_bars, overlay,
};
use crate::document::{ReportTable, Section};
use crate::number::{NONE, Quantity, capital};
use crate::run::{Car, TERMS, car_energy};
use cvtcycle_output::Component;
use cvtcycle_output::history::History;
use cvtcycle_output::summary::Named;

pub(super) fn difference(subject: &Pair, names: &[String; 2]) -> Section {
    let mut section = Section::new("difference", "Difference by component");
    let (energy_a, energy_b) = (car_energy(&subject.a), car_energy(&subject.b));
    section.text(
        "Both runs close their energy ledgers, so the differences of all terms add up to that of the fuel. As L/100 km each term counts as the \
         fuel that holds its energy.",
    );
    let kj = |car: &Car, c: Component| car.run.loss_kj.get(c.name()).unwrap_or(0.0);
    let has = |c: Component| {
        [subject.a, subject.b]
            .iter()
            .any(|car| car.run.loss_kj.get(c.name()).is_some())
    };
    let mut terms: Vec<DifferenceTerm> = Component::ALL
        .iter()
        .filter(|c| has(**c))
        .map(|c| DifferenceTerm::of(*c, kj(&subject.a, *c), kj(&subject.b, *c)))
        .collect();
    let ledger = |car: &Car, name: &str| car.run.ledger_kj.get(name).unwrap_or(0.0);
    for (name, words) in TERMS {
        let term = match name {
            "wheels" => Term::Wheels,
            "brake" => Term::Brake,
            "accessories" => Term::Accessories,
            "kinetic" => Term::Kinetic,
            "engine_heat" => Term::EngineHeat,
            "exhaust" => Term::Exhaust,
            _ => continue,
        };
        terms.push(DifferenceTerm::term(
            words,
            term,
            ledger(&subject.a, name),
            ledger(&subject.b, name),
        ));
    }
    let per_litre = |car: &Car| car.run.fuel_energy_kj / car.run.fuel_l;
    let picture = difference_bars(&Difference {
        a: names[0].clone(),
        b: names[1].clone(),
        fuel_kj_per_l: (per_litre(&subject.a), per_litre(&subject.b)),
        distance_km: (subject.a.run.distance_km, subject.b.run.distance_km),
        fuel_kj: (energy_a.fuel_kj, energy_b.fuel_kj),
        terms,
    });
    section.figure(
        "difference",
        format!(
            "What {} has more or less than {}, term by term.",
            names[1], names[0]
        ),
        picture,
    );
    section.table(ends(subject, names));
    section
}

fn ends(subject: &Pair, names: &[String; 2]) -> ReportTable {
    let q = Quantity::Degc;
    let columns = [names[0].clone(), names[1].clone(), "difference".to_owned()]
        .map(|name| (name, q.unit().to_owned()));
    let mut table =
        ReportTable::of_numbers("Temperatures of the subjects at the end", "Node", columns);
    let (a, b): (&Named, &Named) = (&subject.a.run.end_degc, &subject.b.run.end_degc);
    for (node, x) in a.iter() {
        let y = b.get(node);
        if x.is_some() || y.is_some() {
            table.row([
                capital(node),
                q.bare(x),
                q.bare(y),
                q.bare_signed(x.zip(y).map(|(x, y)| y - x)),
            ]);
        }
    }
    table
}

/// Columns overlaid, with title and unit of their axis.
const OVERLAID: [(&str, &str, &str); 6] = [
    ("transmission_sump_degc", "Transmission sump", "\u{b0}C"),
    ("engine_speed_rpm", "Engine speed", "rpm"),
    ("belt_ratio", "Belt ratio", "-"),
    ("gear", "Gear", "-"),
    ("secondary_pressure_bar", "Secondary pressure", "bar"),
    ("slip_percent", "Belt slip", "%"),
];

/// Panels of one picture.
const PANELS: usize = 3;

pub(super) fn traces(subject: &Pair, names: &[String; 2]) -> Section {
    let mut section = Section::new("driveline", "Traces overlaid");
    let (Some(a), Some(b)) = (subject.a.history, subject.b.history) else {
        section.text(format!(
            "One of the two runs has no trace of its subject: nothing to overlay ({NONE})."
        ));
        return section;
    };
    let points = |history: &History, name: &str| -> Vec<(f64, f64)> {
        history
            .time_s()
            .iter()
            .copied()
            .zip(history.column(name).iter().copied())
            .collect()
    };
    let known = OVERLAID
        .iter()
        .filter(|(name, ..)| a.has(name) || b.has(name));
    let panels: Vec<OverlayPanel> = known
        .map(|(name, title, unit)| OverlayPanel {
            title: (*title).to_owned(),
            unit,
            a: points(a, name),
            b: points(b, name),
        })
        .collect();
    for (k, chunk) in panels.chunks(PANELS).enumerate() {
        let picture = overlay(&Overlay {
            title: "Traces of the subjects".to_owned(),
            subject: format!("{} and {}", names[0], names[1]),
            a: names[0].clone(),
            b: names[1].clone(),
            panels: chunk.to_vec(),
        });
        let titles: Vec<String> = chunk
            .iter()
            .map(|panel| panel.title.to_lowercase())
            .collect();
        section.figure(
            format!("traces_{}", k + 1),
            format!("Both subjects over time: {}.", titles.join(", ")),
            picture,
        );
    }
    section
}
