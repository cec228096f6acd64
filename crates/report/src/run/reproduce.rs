//! Information needed to reproduce the numbers.

use super::super::document::{ReportTable, Section};
use super::super::number::{Quantity, tiny, words};
use super::super::results::RunResults;
use super::Car;
use cvtcycle_output::number::finite;
use cvtcycle_output::record::Record;
use cvtcycle_output::summary::RunSummary;

pub(super) fn section(found: &RunResults, cars: &[Car]) -> Section {
    let mut section = Section::new("reproducibility", "Reproducibility");
    let mut facts = vec![(
        "Program of the run".to_owned(),
        found.summary.manifest.program.clone(),
    )];
    if let Some(record) = &found.record {
        facts.push(("Command".to_owned(), record.command.clone()));
        let name = format!("Cycle {}, SHA-256", record.cycle.name);
        facts.push((name, record.cycle.sha256.clone()));
    }
    section.facts(facts);
    if let Some(record) = &found.record {
        section.table(hashes(record, "Inputs"));
    }
    let columns = cars.iter().map(|car| (car.run.label().to_owned(), ""));
    let mut table = ReportTable::numeric("Ledgers and solution", "", columns);
    for (name, of) in SOLUTION {
        table.named(name, cars.iter().map(|car| of(car.run)));
    }
    let mut more = Section::default();
    more.table(table);
    more.table(flags(cars));
    section.more = more.blocks;
    section
}

/// Name and number of a run.
type Line = (&'static str, fn(&RunSummary) -> String);

const SOLUTION: [Line; 4] = [
    ("Energy ledger, worst row", |run| tiny(run.ledger_error)),
    ("Energy ledger, whole run", |run| tiny(run.run_ledger_error)),
    ("Worst residual of the solve (of full-load torque)", |run| {
        tiny(finite(run.solve.worst_residual))
    }),
    ("Evaluations per step", |run| {
        Quantity::Ratio.bare(run.solve.evaluations_per_step)
    }),
];

/// Files of every car with their hashes.
pub fn hashes(record: &Record, caption: &str) -> ReportTable {
    let mut table = ReportTable::textual(caption, &["Car", "What", "File", "SHA-256"]);
    for car in &record.cars {
        let files = [
            ("vehicle", &car.vehicle),
            ("transmission oil", &car.lubricant),
            ("engine oil", &car.engine_oil),
        ];
        let files = files.map(|(what, of)| (what, of.file.clone(), of.sha256.clone()));
        let all = (
            "everything, checked",
            String::new(),
            car.resolved_sha256.clone(),
        );
        for (what, file, hash) in files.into_iter().chain([all]) {
            table.row([car.name.clone(), what.to_owned(), file, hash]);
        }
    }
    table
}

fn flags(cars: &[Car]) -> ReportTable {
    let columns = cars.iter().map(|car| (car.run.label().to_owned(), "s"));
    let mut table = ReportTable::numeric("Time with each flag", "Flag", columns);
    for (name, _) in cars
        .first()
        .into_iter()
        .flat_map(|car| car.run.flags_s.iter())
    {
        let of = |car: &Car| car.run.flags_s.get(name);
        if cars.iter().any(|car| of(car).is_some_and(|s| s > 0.0)) {
            let cells = cars.iter().map(|car| Quantity::Seconds.bare(of(car)));
            table.named(words(name), cells);
        }
    }
    table.note = "Flags without any time are left out. The command cvtcycle explain FLAG says what each means.".to_owned();
    table
}
