//! Figures of two runs: difference by component, and traces.

use super::Pair;
use crate::charts::figures::{
    DifferenceTerm, EnergyDifference, Overlay, OverlayPanel, TERMS, Term, TraceDifference,
    difference_bars, overlay, trace_difference,
};
use crate::document::{ReportTable, Section};
use crate::number::{NONE, Quantity, capital};
use crate::run::Car;
use cvtcycle_output::Component;
use cvtcycle_output::history::History;
use cvtcycle_output::summary::Over;

pub(super) fn difference(subject: &Pair, names: &[String; 2]) -> Section {
    let mut section = Section::new("difference", "Difference by component");
    let cars = [&subject.a, &subject.b];
    let over_distance = cars.iter().all(|car| car.run.over() == Over::Distance);
    let as_litres = match over_distance {
        true => " As L/100 km each term counts as the fuel that holds its energy.",
        false => "",
    };
    section.text(format!(
        "Both runs close their energy ledgers, so the differences of all terms add up to that of the fuel.{as_litres}"
    ));
    let component = |c: Component| {
        let kj = cars.map(|car| car.run.loss_kj.get(c.name()));
        let some = kj.iter().any(Option::is_some);
        some.then(|| DifferenceTerm::component(c, kj.map(|kj| kj.unwrap_or(0.0))))
    };
    let ledger = |(name, words, term): (&str, &str, Term)| {
        let kj = cars.map(|car| car.run.term_kj(name).unwrap_or(0.0));
        let is_there = name != "electric" || kj.iter().any(|kj| kj.abs() > 0.0);
        let is_shown = term != Term::Transmission && is_there;
        is_shown.then(|| DifferenceTerm::term(words, term, kj))
    };
    let components = Component::ALL.into_iter().filter_map(component);
    let terms = TERMS.into_iter().filter_map(ledger);
    let of_both = |of_both: fn(&Car) -> f64| cars.map(of_both);
    let picture = difference_bars(&EnergyDifference {
        names: names.clone(),
        fuel_kj_per_l: of_both(|car| car.run.fuel_energy_kj / car.run.fuel_l),
        distance_km: of_both(|car| match car.run.over() {
            Over::Distance => car.run.distance_km,
            Over::Time => 0.0,
        }),
        fuel_kj: of_both(|car| car.run.fuel_energy_kj),
        terms: components.chain(terms).collect(),
    });
    let [a, b] = names;
    let caption = format!("What {b} has more or less than {a}, term by term.");
    section.figure("difference", caption, picture);
    section.table(ends(subject, names));
    section
}

fn ends(subject: &Pair, names: &[String; 2]) -> ReportTable {
    let q = Quantity::Degc;
    let columns = [names[0].as_str(), &names[1], "difference"].map(|name| (name, q.unit()));
    let mut table =
        ReportTable::numeric("Temperatures of the subjects at the end", "Node", columns);
    let (a, b) = (&subject.a.run.end_degc, &subject.b.run.end_degc);
    for (node, x) in a.iter() {
        let y = b.get(node);
        if x.is_some() || y.is_some() {
            let change = q.bare_signed(x.zip(y).map(|(x, y)| y - x));
            table.row([capital(node), q.bare(x), q.bare(y), change]);
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

/// Number of panels of a picture.
const PANELS: usize = 3;

pub(super) fn traces(subject: &Pair, names: &[String; 2]) -> Section {
    let mut section = Section::new("driveline", "Where along the drive they differ");
    let (Some(a), Some(b)) = (subject.a.history, subject.b.history) else {
        section.text(format!(
            "One of the two runs has no trace of its subject: nothing to overlay ({NONE})."
        ));
        return section;
    };
    let points = |history: &History, name: &str| {
        let times = history.time_s().iter().copied();
        times.zip(history.column(name).iter().copied()).collect()
    };
    let known = OVERLAID
        .iter()
        .filter(|(name, ..)| a.has(name) || b.has(name));
    let panels = known.map(|(name, title, unit)| OverlayPanel {
        title: (*title).to_owned(),
        unit,
        runs: [points(a, name), points(b, name)],
    });
    let panels: Vec<OverlayPanel> = panels.collect();
    let flow = |history: &History| {
        let times = history.time_s().iter().zip(history.dt_s());
        let steps = times.zip(history.column("fuel_g_s"));
        steps.map(|((end, dt), g_s)| (*end, *dt, *g_s)).collect()
    };
    let picture = trace_difference(&TraceDifference {
        names: names.clone(),
        speed_kmh: points(a, "speed_kmh"),
        fuel_g_s: [flow(a), flow(b)],
        panels: panels.clone(),
    });
    let caption = "Fuel that the second run has burnt more than the first one up to each moment, and what else is different.";
    section.figure("trace_difference", caption, picture);
    let mut more = Section::default();
    for (k, chunk) in panels.chunks(PANELS).enumerate() {
        let picture = overlay(&Overlay {
            title: "Traces of the subjects".to_owned(),
            subject: format!("{} and {}", names[0], names[1]),
            names: names.clone(),
            panels: chunk.to_vec(),
        });
        let titles = chunk.iter().map(|panel| panel.title.to_lowercase());
        let titles: Vec<String> = titles.collect();
        let caption = format!("Both subjects over time: {}.", titles.join(", "));
        more.figure(format!("traces_{}", k + 1), caption, picture);
    }
    section.more = more.blocks;
    section
}
