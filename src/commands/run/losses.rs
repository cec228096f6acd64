//! Losses of the transmission with their prices as a table.

use cvtcycle::output::Component;
use cvtcycle::output::number::{fixed, percent, signed};
use cvtcycle::output::summary::{RunSummary, Saving, Summary};
use cvtcycle::output::table::TextTable;

/// Role of the first car.
const SUBJECT: &str = "subject";

/// Cells of a row of prices: energy and fuel saved for the subject, share of the fuel for baselines.
fn priced(run: &RunSummary, kj: Option<f64>, saved: Option<&Saving>) -> Vec<String> {
    let percent_of_fuel = fixed(saved.and_then(|saved| saved.percent), 2);
    if run.role != SUBJECT {
        return vec![percent_of_fuel];
    }
    vec![
        fixed(kj, 1),
        percent(kj, run.fuel_energy_kj, 2),
        percent_of_fuel,
        fixed(saved.and_then(|saved| saved.l_per_100km), 3),
    ]
}

/// Cells of a row with energy only, for the subject.
fn energy(run: &RunSummary, kj: Option<f64>) -> Vec<String> {
    let blank = String::new;
    match run.role == SUBJECT {
        true => vec![
            fixed(kj, 1),
            percent(kj, run.fuel_energy_kj, 2),
            blank(),
            blank(),
        ],
        false => vec![blank()],
    }
}

/// Cells of the price of all losses together and of the interaction, the part not explained by single losses.
fn interaction(run: &RunSummary) -> Vec<String> {
    let saved = run.price.as_ref().map(|price| &price.interaction);
    let points = signed(saved.and_then(|saved| saved.percent), 2);
    let litres = signed(saved.and_then(|saved| saved.l_per_100km), 3);
    match run.role == SUBJECT {
        true => vec![String::new(), String::new(), points, litres],
        false => vec![points],
    }
}

/// Heading and table of losses with prices.
pub(super) fn priced_losses(summary: &Summary) -> (String, String) {
    let runs = &summary.runs;
    let subject = runs.first().map_or("", |run| &run.vehicle);
    let heads = runs.iter().flat_map(|run| match run.role == SUBJECT {
        true => ["kJ", "% energy", "% fuel", "L/100 km"]
            .map(str::to_owned)
            .to_vec(),
        false => vec![format!("% fuel {}", run.vehicle)],
    });
    let heads: Vec<String> = heads.collect();
    let mut table = TextTable::new(&("l".to_owned() + &"r".repeat(heads.len())));
    table.row([String::new()].into_iter().chain(heads));
    let mut add = |name: &str, cells: &dyn Fn(&RunSummary) -> Vec<String>| {
        let cells = runs.iter().flat_map(cells);
        table.row([name.replace('_', " ")].into_iter().chain(cells));
    };
    for component in Component::ALL {
        let name = component.name();
        let has = |run: &RunSummary| run.loss_kj.iter().any(|(own, _)| own == name);
        if runs.iter().any(has) {
            add(&loss_words(summary, name), &|run| {
                let price = run.price.as_ref().and_then(|price| price.losses.get(name));
                match has(run) {
                    true => priced(run, run.loss_kj.get(name), price.map(|loss| &loss.saved)),
                    false => vec![String::new(); if run.role == SUBJECT { 4 } else { 1 }],
                }
            });
        }
    }
    add("together", &|run| {
        let saved = run.price.as_ref().map(|price| &price.together);
        priced(run, Some(run.transmission_loss_kj()), saved)
    });
    add("interaction", &interaction);
    for name in ["accessories", "brake"] {
        add(name, &|run| energy(run, run.loss_kj.get(name)));
    }
    let title =
        format!("Transmission losses of {subject}: energy, and fuel saved if the loss were zero");
    (title, table.text() + &price_notes(summary))
}

fn price_notes(summary: &Summary) -> String {
    let priced = summary.runs.iter().flat_map(|run| {
        let price = run.price.iter();
        let notes = price.flat_map(|price| price.notes.iter().chain(&price.failures));
        notes.map(|note| format!("{}: {note}\n", run.vehicle))
    });
    priced.collect()
}

/// Name of a loss in words, which depends on the devices of all cars.
pub(super) fn loss_words(summary: &Summary, component: &str) -> String {
    let mut names: Vec<String> = Vec::new();
    for run in &summary.runs {
        let name = run.loss_words(component);
        let has = run.loss_kj.iter().any(|(own, _)| own == component);
        if has && !names.contains(&name) {
            names.push(name);
        }
    }
    names.join(", ")
}
