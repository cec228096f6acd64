//! Conditions: cycle, ambient, cars, fluids, and values that differ from the shipped files.

use super::super::document::{ReportTable, Section};
use super::super::number::{NONE, Quantity, degc, sign, words};
use super::super::results::RunResults;
use super::{Car, cycle_title, start_line};
use cvtcycle_output::record::{CarRecord, Change, ValueRecord};

/// Number of changes shown before the collapsed rest.
const SHOWN: usize = 25;

pub(super) fn section(found: &RunResults, cars: &[Car]) -> Section {
    let mut section = Section::new("conditions", "Conditions");
    let summary = &found.summary;
    let settings = &summary.settings;
    let cycle = cycle_title(summary, found.record.as_ref());
    let fact = |name: &str, value: String| (name.to_owned(), value);
    let mut facts = vec![
        fact("Cycle", format!("{cycle} ({})", summary.cycle)),
        fact("Ambient", degc(summary.ambient_degc)),
        fact("Start", start_line(summary)),
        fact("Longest step", format!("{} s", settings.dt_s)),
        fact("Belt model", settings.formulation.clone()),
    ];
    if let Some(words) = &summary.read_as {
        facts.insert(1, fact("Read as", words.clone()));
    }
    let repairs = summary.recording.iter().flat_map(|own| &own.repairs);
    let repairs: Vec<String> = repairs
        .map(|own| format!("{} ({})", own.what, own.name))
        .collect();
    if !repairs.is_empty() {
        facts.push(fact("Repairs of the log", repairs.join("; ")));
    }
    for (option, list) in [
        ("Set for the subject", &settings.set),
        ("Set for all cars", &settings.set_all),
    ] {
        if !list.is_empty() {
            facts.push(fact(option, list.join(", ")));
        }
    }
    section.facts(facts);
    section.table(table(cars));
    let controllers = cars
        .iter()
        .filter_map(|car| controller(car.record?, car.run.label()));
    section.facts(controllers.collect());
    for car in cars {
        for note in &car.run.notes {
            section.text(format!("{}: {note}.", car.run.label()));
        }
        if let Some(record) = car.record {
            changes(&mut section, car, record);
        }
    }
    section
}

fn table(cars: &[Car]) -> ReportTable {
    let columns = [
        "Car",
        "Role",
        "What it is",
        "Ratio or gears",
        "Transmission oil",
        "Engine oil",
        "Distance",
    ];
    let mut table = ReportTable::textual("Cars and fluids", &columns);
    for car in cars {
        let run = car.run;
        let schedule = run.gear_schedule.as_deref();
        let control = schedule.unwrap_or("ratio control of the vehicle file");
        table.row([
            run.label().to_owned(),
            run.role.clone(),
            run.title.clone(),
            control.to_owned(),
            run.lubricant.clone(),
            run.engine_oil.clone(),
            Quantity::Distance.text(run.distance_km),
        ]);
    }
    table
}

/// Controller of a CVT: its clamp law and ratio control.
fn controller(record: &CarRecord, name: &str) -> Option<(String, String)> {
    const RATIO: &str = "transmission.cvt.ratio.";
    let mut values = record.values.iter();
    let law = values.find(|value| value.key == "transmission.cvt.clamp")?;
    let part = |value: &ValueRecord| {
        let name = value.key.strip_prefix(RATIO)?.trim_end_matches("_rpm");
        let name = words(name.trim_end_matches("_per_s"));
        Some(match value.unit.as_str() {
            "-" => format!("{name} {}", value.value),
            unit => format!("{name} {}\u{a0}{}", value.value, sign(unit)),
        })
    };
    let parts: Vec<String> = record.values.iter().filter_map(part).collect();
    let (law, ratio) = (words(&law.value), parts.join(", "));
    let name = format!("Controller of {name}");
    Some((name, format!("clamp law {law}; ratio: {ratio}")))
}

fn changes(section: &mut Section, car: &Car, record: &CarRecord) {
    let (same, all) = record.reference_values;
    if record.changes.is_empty() {
        section.text(format!(
            "{} is the shipped vehicle {}, unchanged ({all} values).",
            car.run.label(),
            record.reference
        ));
        return;
    }
    let caption = format!(
        "{} against the shipped vehicle {}: {} values differ, {same} of {all} are the same",
        car.run.label(),
        record.reference,
        record.changes.len()
    );
    let (first, rest) = record.changes.split_at(record.changes.len().min(SHOWN));
    let heads = ["shipped", "here"];
    section.table(change_table(&caption, first, heads));
    if !rest.is_empty() {
        let caption = format!(
            "{} more values of {} that differ",
            rest.len(),
            car.run.label()
        );
        section.folded(change_table(&caption, rest, heads));
    }
}

/// Table of differing values in two columns.
pub(crate) fn change_table(caption: &str, changes: &[Change], names: [&str; 2]) -> ReportTable {
    let mut table = ReportTable::textual(caption, &["Key", "Unit", names[0], names[1]]);
    let cell = |text: &str| if text.is_empty() { NONE } else { text }.to_owned();
    for change in changes {
        let (key, unit) = (change.key.clone(), sign(&change.unit).to_owned());
        table.row([key, unit, cell(&change.shipped), cell(&change.here)]);
    }
    table
}
