//! Comparison of runs: a document on two of one cycle (two fluids, two pumps, two offsets), and a table and a document of any number.

mod figures;
mod many;
pub(crate) mod side_by_side;

pub use many::{DifferingValue, RunComparison, Side, compare, names};

use figures::{difference, traces};

use super::document::{Block, Document, ReportTable, Section};
use super::number::{Quantity, capital_first, phase, sign, words};
use super::problems::problem;
use super::results::RunResults;
use super::run::{Car, cars, change_table, conditions_line, cycle_title, hashes};
use cvtcycle_config::Problems;
use cvtcycle_output::Component;
use cvtcycle_output::record::{CarRecord, Change, ValueRecord};
use cvtcycle_output::summary::{Over, RunSummary};

/// Relative difference of driven distances above which the report says that a fuel difference includes one of distance.
const DISTANCE: f64 = 1e-4;

/// A car in both runs.
struct Pair<'a> {
    a: Car<'a>,
    b: Car<'a>,
}

/// The report of two runs, A and B.
///
/// # Errors
/// Runs of different cycles; runs without a car in common.
pub(crate) fn document(a: &RunResults, b: &RunResults) -> Result<Document, Problems> {
    if a.summary.cycle != b.summary.cycle {
        let message = format!(
            "{} drives {}, {} drives {}: runs of different cycles cannot be compared",
            a.path.display(),
            a.summary.cycle,
            b.path.display(),
            b.summary.cycle
        );
        let problem = problem(&b.path, &message, "compare runs of one cycle");
        let problem = problem.value(b.summary.cycle.clone());
        return Err(problem.allowed(a.summary.cycle.clone()).into());
    }
    let (cars_a, cars_b) = (cars(a), cars(b));
    let pairs = pairs(&cars_a, &cars_b);
    let names = both_names(a, b);
    let mut sections = vec![
        answer(a, b, &pairs, &names),
        conditions(a, b, &pairs, &names),
    ];
    if let Some(subject) = pairs.first() {
        sections.push(difference(subject, &names));
        sections.push(traces(subject, &names));
    }
    sections.push(reproduce(a, b, &names));
    let missing = |(found, name): (&RunResults, &String)| {
        let missing = found.missing.iter();
        missing
            .map(|text| format!("{name}: {text}"))
            .collect::<Vec<_>>()
    };
    let warnings = [a, b].into_iter().zip(&names).flat_map(missing).collect();
    let cycle = cycle_title(&a.summary, a.record.as_ref());
    Ok(Document {
        title: format!("{} against {}", names[1], names[0]),
        subtitle: format!("{cycle}; {}", subtitle(a, b)),
        sections,
        warnings,
        ..Document::default()
    })
}

/// Names of the runs: those of their directories, with letters appended if equal.
fn both_names(a: &RunResults, b: &RunResults) -> [String; 2] {
    let name = |found: &RunResults| match found.path.file_name() {
        Some(name) => name.to_string_lossy().into_owned(),
        None => found.path.display().to_string(),
    };
    let (a, b) = (name(a), name(b));
    if a == b {
        [format!("A ({a})"), format!("B ({b})")]
    } else {
        [a, b]
    }
}

fn subtitle(a: &RunResults, b: &RunResults) -> String {
    let lines = [conditions_line(&a.summary), conditions_line(&b.summary)];
    if lines[0] == lines[1] {
        lines[0].clone()
    } else {
        format!("{} against {}", lines[1], lines[0])
    }
}

/// Pairs the subjects, and baselines by name.
fn pairs<'a>(a: &[Car<'a>], b: &[Car<'a>]) -> Vec<Pair<'a>> {
    let (Some((subject_a, rest_a)), Some((subject_b, rest_b))) = (a.split_first(), b.split_first())
    else {
        return Vec::new();
    };
    let first = Pair {
        a: *subject_a,
        b: *subject_b,
    };
    let other = |a: &Car<'a>| {
        let b = rest_b.iter().find(|b| b.run.vehicle == a.run.vehicle)?;
        Some(Pair { a: *a, b: *b })
    };
    let others = rest_a.iter().filter_map(other);
    [first].into_iter().chain(others).collect()
}

fn answer(a: &RunResults, b: &RunResults, pairs: &[Pair], names: &[String; 2]) -> Section {
    let mut section = Section::new("answer", "Answer");
    // The fuel for a kJ of loss is known for one car under one set of conditions only.
    let same_conditions = (a.summary.ambient_degc - b.summary.ambient_degc).abs() < 1e-9
        && a.summary.start == b.summary.start;
    let alike = same_conditions
        && pairs
            .first()
            .is_some_and(|pair| pair.a.run.vehicle == pair.b.run.vehicle);
    if let Some(pair) = pairs.first() {
        let lead = only_change(pair) + &lead(pair, names);
        section.blocks.push(Block::Lead(capital_first(&lead)));
        let [km_a, km_b] = [pair.a, pair.b].map(|car| car.run.distance_km);
        if ((km_b - km_a) / km_a).abs() > DISTANCE {
            let [km_a, km_b] = [km_a, km_b].map(|km| Quantity::Distance.text(km));
            section.alert(format!(
                "The two drive different distances ({km_a} and {km_b}): a part of the difference is one of road."
            ));
        }
        section.text(largest(&pair.a, &pair.b, alike));
    }
    for (found, name) in [(a, &names[0]), (b, &names[1])] {
        let runs = found.summary.runs.iter();
        for run in runs.filter(|run| !run.failed_checks.is_empty()) {
            let list: Vec<String> = run.failed_checks.iter().map(|check| words(check)).collect();
            let (car, list) = (&run.vehicle, list.join(", "));
            section.alert(format!("A check failed in {name} for {car}: {list}."));
        }
        for line in &found.missing {
            section.alert(format!("{name}: {line}."));
        }
    }
    section.table(fuel_table(pairs, names));
    section
}

/// Beginning of a sentence with the differing value, if there is only one.
fn only_change(subjects: &Pair) -> String {
    let records = subjects.a.record.zip(subjects.b.record);
    let changes = records.map_or_else(Vec::new, |(a, b)| changes(a, b));
    match &changes[..] {
        [change] if !change.here.is_empty() && !change.shipped.is_empty() => {
            let unit = match sign(&change.unit) {
                "-" | "" => String::new(),
                unit => format!("\u{a0}{unit}"),
            };
            format!(
                "With {} {}{unit} instead of {}{unit}: ",
                change.key, change.here, change.shipped
            )
        }
        _ => String::new(),
    }
}

/// Fuel of both subjects, and the difference.
fn lead(subjects: &Pair, [name_a, name_b]: &[String; 2]) -> String {
    let over = subjects.a.run.over();
    let fuel = |car: &Car| car.run.consumption(over).unwrap_or(f64::NAN);
    let (fuel_a, fuel_b) = (fuel(&subjects.a), fuel(&subjects.b));
    let change = fuel_b - fuel_a;
    let percent = 100.0 * change / fuel_a;
    format!(
        "the subject of {name_b} uses {}: {} or {} {} than that of {name_a} ({}).",
        Quantity::fuel(over).text(fuel_b),
        match over {
            Over::Distance => Quantity::FuelShare,
            Over::Time => Quantity::FuelInTime,
        }
        .text(change.abs()),
        Quantity::Effect.text(percent.abs()),
        less_or_more(change),
        Quantity::fuel(over).text(fuel_a)
    )
}

fn less_or_more(change: f64) -> &'static str {
    if change < 0.0 { "less" } else { "more" }
}

/// Components with the largest changes.
fn largest(a: &Car, b: &Car, alike: bool) -> String {
    let kj = |car: &Car, c: Component| car.run.loss_kj.get(c.name()).unwrap_or(0.0);
    let moved = |c: Component| (c, kj(b, c) - kj(a, c));
    let mut moved: Vec<(Component, f64)> = Component::ALL.into_iter().map(moved).collect();
    moved.sort_by(|x, y| y.1.abs().total_cmp(&x.1.abs()));
    let largest = moved.iter().take(3).filter(|(_, kj)| kj.abs() >= 0.05);
    let text = |(c, kj): &(Component, f64)| words(c.name()) + " " + &Quantity::Energy.signed(*kj);
    let largest: Vec<String> = largest.map(text).collect();
    let transmission = b.run.transmission_loss_kj() - a.run.transmission_loss_kj();
    let fuel = b.run.fuel_energy_kj - a.run.fuel_energy_kj;
    let mut text = format!(
        "Its transmission loses {} {}",
        Quantity::Energy.text(transmission.abs()),
        less_or_more(transmission)
    );
    if !largest.is_empty() {
        text += &format!(" ({})", largest.join(", "));
    }
    let change = Quantity::Energy.signed(fuel);
    text += &format!("; its fuel's energy differs by {change}");
    if alike && transmission.abs() > 0.05 {
        let each = Quantity::Energy.text(fuel / transmission);
        text += &format!(", {each} for each kJ of transmission loss");
    }
    text + "."
}

fn fuel_table(pairs: &[Pair], names: &[String; 2]) -> ReportTable {
    let over = pairs
        .first()
        .map_or(Over::Distance, |pair| pair.a.run.over());
    let unit = Quantity::fuel(over).unit();
    let columns = [
        (names[0].as_str(), unit),
        (&names[1], unit),
        ("difference", unit),
        ("difference", "%"),
    ];
    let mut table = ReportTable::numeric("Fuel", "Car, phase", columns);
    for Pair { a, b } in pairs {
        let car = if a.run.vehicle == b.run.vehicle {
            a.run.label().to_owned()
        } else {
            format!("{} / {}", a.run.vehicle, b.run.vehicle)
        };
        let phases = a.run.phases.iter().zip(&b.run.phases);
        for (x, y) in phases.filter(|_| a.run.phases.len() > 1) {
            let name = format!("{car}, {}", phase(&x.name));
            let [x, y] = [x, y].map(|phase| match over {
                Over::Distance => phase.fuel_l_per_100km,
                Over::Time => phase.fuel_l_per_h,
            });
            table.named(name, fuel_cells(x, y));
        }
        let [x, y] = [a, b].map(|car| match over {
            Over::Distance => car.run.fuel_l_per_100km,
            Over::Time => car.run.litres_per_hour(),
        });
        let whole = fuel_cells(x, y);
        table.strong(format!("{car}, whole cycle"), whole);
        let weighted = [a, b].map(|car| car.run.weighted_fuel_l_per_100km);
        if weighted[0].is_some() {
            let cells = fuel_cells(weighted[0], weighted[1]);
            table.strong(format!("{car}, weighted"), cells);
        }
    }
    table
}

/// Fuel of A and of B, and the difference in both units.
fn fuel_cells(a: Option<f64>, b: Option<f64>) -> [String; 4] {
    let both = a.zip(b);
    [
        Quantity::Fuel.bare(a),
        Quantity::Fuel.bare(b),
        Quantity::FuelShare.bare_signed(both.map(|(a, b)| b - a)),
        Quantity::Effect.bare_signed(both.map(|(a, b)| 100.0 * (b / a - 1.0))),
    ]
}

/// Name of a condition and its value in a run.
type Condition = (&'static str, fn(&RunResults) -> String);

const CONDITIONS: [Condition; 10] = [
    ("Cycle", |run| {
        cycle_title(&run.summary, run.record.as_ref())
    }),
    ("Conditions", |run| conditions_line(&run.summary)),
    ("Subject", |run| subject_field(run, |car| &car.title)),
    ("Transmission oil", |run| {
        subject_field(run, |car| &car.lubricant)
    }),
    ("Engine oil", |run| {
        subject_field(run, |car| &car.engine_oil)
    }),
    ("Longest step", |run| {
        format!("{} s", run.summary.settings.dt_s)
    }),
    ("Belt model", |run| run.summary.settings.formulation.clone()),
    ("Set for the subject", |run| {
        run.summary.settings.set.join(", ")
    }),
    ("Set for all cars", |run| {
        run.summary.settings.set_all.join(", ")
    }),
    ("Program", |run| run.summary.manifest.program.clone()),
];

fn subject_field(run: &RunResults, field: fn(&RunSummary) -> &String) -> String {
    let subject = run.summary.runs.first();
    subject.map_or(String::new(), |car| field(car).clone())
}

fn conditions(a: &RunResults, b: &RunResults, pairs: &[Pair], names: &[String; 2]) -> Section {
    let mut section = Section::new("conditions", "Conditions, and what differs");
    let mut table = ReportTable::textual("Conditions", &["", &names[0], &names[1]]);
    for (name, field) in CONDITIONS {
        let (a, b) = (field(a), field(b));
        if !(a.is_empty() && b.is_empty()) {
            table.row([name.to_owned(), a, b]);
        }
    }
    section.table(table);
    let records = pairs
        .first()
        .and_then(|pair| pair.a.record.zip(pair.b.record));
    let Some((a, b)) = records else {
        return section;
    };
    let changes = changes(a, b);
    if changes.is_empty() {
        section.text("Every value of the two subjects is the same.");
    } else {
        let (count, all) = (changes.len(), a.values.len());
        let caption = format!("Values of the subjects that differ ({count} of {all})");
        let heads = [names[0].as_str(), &names[1]];
        section.table(change_table(&caption, &changes, heads));
    }
    section
}

/// Values that differ between two cars: those of the first one, then those that only the second one has.
fn changes(a: &CarRecord, b: &CarRecord) -> Vec<Change> {
    let find = |car: &CarRecord, key: &str| {
        let value = car.values.iter().find(|value| value.key == key);
        value.map_or(String::new(), |value| value.value.clone())
    };
    let unknown = |v: &&ValueRecord| a.values.iter().all(|other| other.key != v.key);
    let only_b = b.values.iter().filter(unknown);
    let change = |value: &ValueRecord| Change {
        key: value.key.clone(),
        unit: value.unit.clone(),
        shipped: find(a, &value.key),
        here: find(b, &value.key),
    };
    let changes = a.values.iter().map(change);
    let changes = changes.filter(|change| change.here != change.shipped);
    changes.chain(only_b.map(change)).collect()
}

fn reproduce(a: &RunResults, b: &RunResults, names: &[String; 2]) -> Section {
    let mut section = Section::new("reproducibility", "Reproducibility");
    for (found, name) in [(a, &names[0]), (b, &names[1])] {
        let mut facts = vec![(
            format!("Program of {name}"),
            found.summary.manifest.program.clone(),
        )];
        if let Some(record) = &found.record {
            facts.push((format!("Command of {name}"), record.command.clone()));
            let cycle = format!("Cycle of {name}, SHA-256");
            facts.push((cycle, record.cycle.sha256.clone()));
        }
        section.facts(facts);
        if let Some(record) = &found.record {
            section.folded(hashes(record, &format!("Inputs of {name}")));
        }
    }
    section
}
