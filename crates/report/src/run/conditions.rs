//! Conditions: cycle, ambient, cars, fluids, and values that differ from the shipped files.

use super::super::document::{ReportTable, Section};
use super::super::number::{NONE, Quantity, degc, words};
use super::super::results::RunResults;
use super::{Car, cycle_title, start_line};
use cvtcycle_output::record::{CarRecord, Change};

/// Changes shown before the rest is folded away.
const SHOWN: usize = 25;

pub(super) fn section(found: &RunResults, cars: &[Car]) -> Section {
    let mut section = Section::new("conditions", "Conditions");
    let summary = &found.summary;
    let settings = &summary.settings;
    let mut facts = vec![
        (
            "Cycle".to_owned(),
            format!(
                "{} ({})",
                cycle_title(summary, found.record.as_ref()),
                summary.cycle
            ),
        ),
        ("Ambient".to_owned(), degc(summary.ambient_degc)),
        ("Start".to_owned(), start_line(summary)),
        ("Longest step".to_owned(), format!("{} s", settings.dt_s)),
        ("Belt model".to_owned(), settings.formulation.clone()),
    ];
    for (option, list) in [
        ("Set for the subject", &settings.set),
        ("Set for all cars", &settings.set_all),
    ] {
        if !list.is_empty() {
            facts.push((option.to_owned(), list.join(", ")));
        }
    }
    section.facts(facts);
    section.table(table(cars));
    section.facts(
        cars.iter()
            .filter_map(|car| controller(car.record?))
            .collect(),
    );
    for car in cars {
        if let Some(record) = car.record {
            changes(&mut section, car, record);
        }
    }
    section
}

fn table(cars: &[Car]) -> ReportTable {
    let mut table = ReportTable::of_words(
        "Cars and fluids",
        &[
            "Car",
            "Role",
            "What it is",
            "Ratio or gears",
            "Transmission oil",
            "Engine oil",
            "Distance",
        ],
    );
    for car in cars {
        let run = car.run;
        let control = run
            .gear_schedule
            .clone()
            .unwrap_or_else(|| "ratio control of the vehicle file".to_owned());
        table.row([
            run.vehicle.clone(),
            run.role.clone(),
            run.title.clone(),
            control,
            run.lubricant.clone(),
            run.engine_oil.clone(),
            Quantity::Distance.text(run.distance_km),
        ]);
    }
    table
}

/// The controller of a CVT: its clamp law and what sets its ratio.
fn controller(record: &CarRecord) -> Option<(String, String)> {
    const RATIO: &str = "transmission.cvt.ratio.";
    let law = record
        .values
        .iter()
        .find(|value| value.key == "transmission.cvt.clamp")?;
    let parts = record.values.iter().filter_map(|value| {
        let name = words(
            value
                .key
                .strip_prefix(RATIO)?
                .trim_end_matches("_rpm")
                .trim_end_matches("_per_s"),
        );
        let unit = if value.unit == "-" {
            String::new()
        } else {
            format!("\u{a0}{}", value.unit)
        };
        Some(format!("{name} {}{unit}", value.value))
    });
    let list = parts.collect::<Vec<_>>().join(", ");
    Some((
        format!("Controller of {}", record.name),
        format!("clamp law {}; ratio: {list}", words(&law.value)),
    ))
}

fn changes(section: &mut Section, car: &Car, record: &CarRecord) {
    let (same, all) = record.reference_values;
    if record.changes.is_empty() {
        section.text(format!(
            "{} is the shipped vehicle {}, unchanged ({all} values).",
            car.run.vehicle, record.reference
        ));
        return;
    }
    let caption = format!(
        "{} against the shipped vehicle {}: {} values differ, {same} of {all} are the same",
        car.run.vehicle,
        record.reference,
        record.changes.len()
    );
    section.table(change_table(
        &caption,
        &record.changes[..record.changes.len().min(SHOWN)],
        ["shipped", "here"],
    ));
    if record.changes.len() > SHOWN {
        let rest = &record.changes[SHOWN..];
        let caption = format!(
            "{} more values of {} that differ",
            rest.len(),
            car.run.vehicle
        );
        section.folded(change_table(&caption, rest, ["shipped", "here"]));
    }
}

/// Values that differ, side by side.
pub(crate) fn change_table(caption: &str, changes: &[Change], names: [&str; 2]) -> ReportTable {
    let mut table = ReportTable::of_words(caption, &["Key", "Unit", names[0], names[1]]);
    let cell = |text: &String| {
        if text.is_empty() {
            NONE.to_owned()
        } else {
            text.clone()
        }
    };
    for change in changes {
        table.row([
            change.key.clone(),
            change.unit.clone(),
            cell(&change.shipped),
            cell(&change.here),
        ]);
    }
    table
}
