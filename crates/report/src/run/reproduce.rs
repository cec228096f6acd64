//! What is needed to get the same numbers again.

use super::super::document::{ReportTable, Section};
use super::super::number::{Quantity, tiny, words};
use super::super::results::RunResults;
use super::Car;
use cvtcycle_output::number::finite;
use cvtcycle_output::record::Record;

pub(super) fn section(found: &RunResults, cars: &[Car]) -> Section {
    let mut section = Section::new("reproducibility", "Reproducibility");
    let mut facts = vec![(
        "Program of the run".to_owned(),
        found.summary.program.clone(),
    )];
    if let Some(record) = &found.record {
        facts.push(("Command".to_owned(), record.command.clone()));
        facts.push((
            format!("Cycle {}, SHA-256", record.cycle.name),
            record.cycle.sha256.clone(),
        ));
    }
    section.facts(facts);
    if let Some(record) = &found.record {
        section.table(hashes(record, "Inputs"));
    }
    let columns = cars
        .iter()
        .map(|car| (car.run.vehicle.clone(), String::new()));
    let mut table = ReportTable::of_numbers("Ledgers and solution", "", columns);
    let mut add =
        |name: &str, of: &dyn Fn(&Car) -> String| table.named(name.to_owned(), cars.iter().map(of));
    add("Energy ledger, worst row", &|car| {
        tiny(car.run.ledger_error)
    });
    add("Energy ledger, whole run", &|car| {
        tiny(car.run.run_ledger_error)
    });
    add(
        "Worst residual of the solve (of full-load torque)",
        &|car| tiny(finite(car.run.solve.worst_residual)),
    );
    add("Evaluations per step", &|car| {
        Quantity::Ratio.bare(car.run.solve.evaluations_per_step)
    });
    section.table(table);
    section.table(flags(cars));
    section
}

/// Files of every car with their hashes.
#[must_use]
pub fn hashes(record: &Record, caption: &str) -> ReportTable {
    let mut table = ReportTable::of_words(caption, &["Car", "What", "File", "SHA-256"]);
    for car in &record.cars {
        for (what, file) in [
            ("vehicle", &car.vehicle),
            ("transmission oil", &car.lubricant),
            ("engine oil", &car.engine_oil),
        ] {
            table.row([
                car.name.clone(),
                what.to_owned(),
                file.file.clone(),
                file.sha256.clone(),
            ]);
        }
        table.row([
            car.name.clone(),
            "everything, checked".to_owned(),
            String::new(),
            car.resolved_sha256.clone(),
        ]);
    }
    table
}

fn flags(cars: &[Car]) -> ReportTable {
    let columns = cars
        .iter()
        .map(|car| (car.run.vehicle.clone(), "s".to_owned()));
    let mut table = ReportTable::of_numbers("Time with each flag", "Flag", columns);
    let names: Vec<&str> = cars
        .first()
        .map(|car| car.run.flags_s.iter().map(|(name, _)| name).collect())
        .unwrap_or_default();
    for name in names {
        let of = |car: &Car| car.run.flags_s.get(name);
        if cars.iter().any(|car| of(car).is_some_and(|s| s > 0.0)) {
            table.named(
                words(name),
                cars.iter().map(|car| Quantity::Seconds.bare(of(car))),
            );
        }
    }
    table.note = "Flags without any time are left out. The command cvtcycle explain FLAG says what each means.".to_owned();
    table
}
