//! The prices as tables.

use cvtcycle::analysis::attribute::answer;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::output::number::{fixed, plain, signed};
use cvtcycle::output::summary::{PriceSummary, RunSummary, Saving, StartWord, Summary};
use cvtcycle::output::table::{TextTable, wrapped};

use super::AttributionSummary;
use crate::print::colour::Paint;
use crate::print::sections;

/// Prints all prices.
pub fn tables(summary: &AttributionSummary, cycle: &Cycle, by_phase: bool, paint: Paint) -> String {
    let mut text = format!("{}  {}\n", paint.heading(&cycle.name), cycle.title);
    text.extend(
        cycle
            .read_as
            .iter()
            .map(|words| wrapped(words, "read as: ")),
    );
    text += &match summary.factor {
        factor if factor > 0.0 => {
            format!("fuel saved with {} times each loss\n", plain(factor))
        }
        _ => "fuel saved without each loss\n".to_owned(),
    };
    for conditions in &summary.conditions {
        for run in &conditions.runs {
            text += &run_tables(conditions, run, by_phase, paint);
        }
    }
    let count = summary.conditions.first().map_or(0, |c| c.runs.len());
    let cars = (0..count).filter(|_| summary.conditions.len() > 1);
    let by_ambient = cars.map(|car| {
        let run = &summary.conditions[0].runs[car];
        let title = format!(
            "{}: % of the fuel by ambient temperature, degC",
            run.vehicle
        );
        (title, by_ambient(summary, car))
    });
    text + &sections(by_ambient.collect::<Vec<_>>(), paint)
}

fn run_tables(summary: &Summary, run: &RunSummary, by_phase: bool, paint: Paint) -> String {
    let Some(price) = &run.price else {
        return String::new();
    };
    let start = match &summary.start {
        StartWord::Word(word) => word.clone(),
        StartWord::Degc(degc) => format!("start at {} degC", plain(*degc)),
        StartWord::Nodes(_) => format!("start {}", summary.start.text()),
    };
    let ambient = plain(summary.ambient_degc);
    let over = run.over();
    let title = format!("{} at {ambient} degC, {start}", run.vehicle);
    let fuel = fixed(run.consumption(over), 2);
    let fuel_line = format!("{}: {fuel} {}.", run.vehicle, over.unit());
    let sentences = std::iter::once(fuel_line).chain(answer(run));
    let sentences = sentences.map(|sentence| wrapped(&sentence, ""));
    let notes = price.notes.iter().map(|note| wrapped(note, "note: "));
    let parts = [
        (
            title,
            sentences.collect::<String>() + "\n" + &losses(price, run),
        ),
        ("Pairs, % of the fuel".to_owned(), pairs(price, run)),
        ("Shared out over groups (Shapley)".to_owned(), groups(price)),
        (
            "By part of the cycle, L/100 km".to_owned(),
            match by_phase {
                true => phases(price, run),
                false => String::new(),
            },
        ),
    ];
    sections(parts, paint) + &notes.collect::<String>()
}

/// Name of a loss in words.
fn words(name: &str) -> String {
    name.replace('_', " ")
}

fn losses(price: &PriceSummary, run: &RunSummary) -> String {
    let mut table = TextTable::new("lrrrrr");
    table.row(["", "kJ", "% energy", "% fuel", "L/100 km", "% alone"]);
    let litres = |saving: &Saving| fixed(saving.l_per_100km, 3);
    for (name, loss) in &price.losses {
        let alone = loss.alone.as_ref().and_then(|alone| alone.percent);
        table.row([
            run.loss_words(name),
            fixed(loss.loss_kj, 1),
            fixed(loss.energy_percent, 2),
            fixed(loss.saved.percent, 2),
            litres(&loss.saved),
            fixed(alone, 2),
        ]);
    }
    let all_kj = run.transmission_loss_kj();
    table.row([
        "together".to_owned(),
        fixed(all_kj, 1),
        fixed(100.0 * all_kj / run.fuel_energy_kj, 2),
        fixed(price.together.percent, 2),
        litres(&price.together),
        String::new(),
    ]);
    table.row([
        "interaction".to_owned(),
        String::new(),
        String::new(),
        signed(price.interaction.percent, 2),
        signed(price.interaction.l_per_100km, 3),
        String::new(),
    ]);
    table.text()
}

/// Tabulates each pair in both orders.
fn pairs(price: &PriceSummary, run: &RunSummary) -> String {
    let mut table = TextTable::new("llrrrrr");
    if !price.pairs.is_empty() {
        let less = match price.factor {
            factor if factor > 0.0 => format!("with {} times", plain(factor)),
            _ => "without".to_owned(),
        };
        let [a, b] = ["a", "b"].map(|other| format!("{less} {other}"));
        let head = ["a", "b", "together", "a", &b, "b", &a];
        table.row(head);
    }
    let percent = |litres: Option<f64>| {
        let share = litres.zip(run.headline_fuel());
        fixed(share.map(|(litres, fuel)| 100.0 * litres / fuel), 2)
    };
    for pair in &price.pairs {
        table.row([
            run.loss_words(&pair.a),
            run.loss_words(&pair.b),
            signed(pair.interaction.percent, 2),
            percent(pair.a_with_b),
            percent(pair.a_without_b),
            percent(pair.b_with_a),
            percent(pair.b_without_a),
        ]);
    }
    table.text()
}

fn groups(price: &PriceSummary) -> String {
    let mut table = TextTable::new("lrr");
    if !price.groups.is_empty() {
        table.row(["", "% fuel", "L/100 km"]);
    }
    for (name, share) in &price.groups {
        let litres = fixed(share.l_per_100km, 3);
        table.row([words(name), fixed(share.percent, 2), litres]);
    }
    table.text()
}

fn phases(price: &PriceSummary, run: &RunSummary) -> String {
    let mut table = TextTable::new(&("l".to_owned() + &"r".repeat(run.phases.len())));
    let names = run.phases.iter().map(|phase| phase.name.as_str());
    table.row([""].into_iter().chain(names));
    let losses = price
        .losses
        .iter()
        .map(|(name, loss)| (name.as_str(), &loss.saved));
    let whole = [
        ("together", &price.together),
        ("interaction", &price.interaction),
    ];
    for (name, saving) in losses.chain(whole) {
        let cells = saving.phases.iter().map(|(_, litres)| fixed(litres, 3));
        table.row([run.loss_words(name)].into_iter().chain(cells));
    }
    table.text()
}

fn by_ambient(summary: &AttributionSummary, car: usize) -> String {
    let mut table = TextTable::new(&("l".to_owned() + &"r".repeat(summary.conditions.len())));
    let ambients = summary.conditions.iter().map(|c| plain(c.ambient_degc));
    table.row([String::new()].into_iter().chain(ambients));
    let prices: Vec<&PriceSummary> = summary
        .conditions
        .iter()
        .filter_map(|conditions| conditions.runs.get(car)?.price.as_ref())
        .collect();
    let mut names: Vec<&String> = Vec::new();
    for name in prices.iter().flat_map(|price| price.losses.keys()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    for name in names {
        let percent = |price: &&PriceSummary| {
            fixed(
                price.losses.get(name).and_then(|loss| loss.saved.percent),
                2,
            )
        };
        table.row([words(name)].into_iter().chain(prices.iter().map(percent)));
    }
    let together = prices.iter().map(|price| fixed(price.together.percent, 2));
    table.row(["together".to_owned()].into_iter().chain(together));
    let interaction = prices
        .iter()
        .map(|price| signed(price.interaction.percent, 2));
    table.row(["interaction".to_owned()].into_iter().chain(interaction));
    table.text()
}
