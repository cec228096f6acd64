//! Conditions: cycle, ambient, cars, fluids, and values that differ from the shipped files.

use super::super::document::{ReportTable, Section};
use super::super::number::{NONE, Quantity, degc, sign};
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
    for car in cars {
        let table = car
            .record
            .and_then(|record| controller(record, car.run.label()));
        table.into_iter().for_each(|table| section.folded(table));
    }
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

/// Controller of a CVT: its clamp law and ratio control, without what is not given.
fn controller(record: &CarRecord, name: &str) -> Option<ReportTable> {
    const TABLES: [&str; 2] = ["transmission.cvt.clamp", "transmission.cvt.ratio"];
    let caption = format!("Controller of {name}");
    let mut table = ReportTable::textual(&caption, &["Key", "Value", "Meaning", "Status"]);
    let is_own = |value: &&ValueRecord| TABLES.iter().any(|table| value.key.starts_with(table));
    let is_given = |value: &&ValueRecord| !["", "[]"].contains(&value.value.as_str());
    let values = record.values.iter().filter(is_own).filter(is_given);
    let mut count = 0;
    for value in values {
        let key = value.key.trim_start_matches("transmission.cvt.");
        let number = match value.unit.as_str() {
            "-" | "" => value.value.clone(),
            unit => format!("{}\u{a0}{}", value.value, sign(unit)),
        };
        table.row([
            key.to_owned(),
            number,
            value.doc.clone(),
            value.status.clone(),
        ]);
        count += 1;
    }
    (count > 0).then_some(table)
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
