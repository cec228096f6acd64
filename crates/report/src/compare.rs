//! Two runs of one cycle held against each other: two fluids, two pumps, two offsets.

use super::document::{Block, Document, Section, Table};
use super::found::RunFound;
use super::number::{NONE, Quantity, capital, phase, words};
use super::run::{Car, TERMS, car_energy, cars, conditions_line, cycle_title, hashes};
use crate::charts::review_figures::{
    Difference, DifferenceTerm, Overlay, OverlayPanel, Term, difference_bars, overlay,
};
use cvtcycle_config::{Place, Problem, Problems};
use cvtcycle_output::Component;
use cvtcycle_output::history::History;
use cvtcycle_output::record::Change;
use cvtcycle_output::summary::{Named, RunSummary};

/// Relative difference of driven distances above which a fuel difference is told to hold one of road too.
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
pub fn document(a: &RunFound, b: &RunFound) -> Result<Document, Problems> {
    if a.summary.cycle != b.summary.cycle {
        let message = format!(
            "{} drives {}, {} drives {}: there is no difference to tell between cycles",
            a.path.display(),
            a.summary.cycle,
            b.path.display(),
            b.summary.cycle
        );
        let place = Place {
            file: b.path.display().to_string(),
            ..Place::default()
        };
        let hint = "compare runs of one cycle".to_owned();
        return Err(Problem::invalid(message)
            .at(place)
            .value(b.summary.cycle.clone())
            .allowed(a.summary.cycle.clone())
            .hint(hint)
            .into());
    }
    let (cars_a, cars_b) = (cars(a), cars(b));
    let pairs = pairs(&cars_a, &cars_b);
    let names = names(a, b);
    let mut sections = vec![
        answer(a, b, &pairs, &names),
        conditions(a, b, &pairs, &names),
    ];
    if let Some(subject) = pairs.first() {
        sections.push(difference(subject, &names));
        sections.push(traces(subject, &names));
    }
    sections.push(reproduce(a, b, &names));
    let missing = |found: &RunFound, name: &String| {
        found
            .missing
            .iter()
            .map(|text| format!("{name}: {text}"))
            .collect::<Vec<_>>()
    };
    let warnings = [missing(a, &names[0]), missing(b, &names[1])].concat();
    Ok(Document {
        title: format!("{} against {}", names[1], names[0]),
        subtitle: format!(
            "{}; {}",
            cycle_title(&a.summary, a.record.as_ref()),
            subtitle(a, b)
        ),
        sections,
        warnings,
        ..Document::default()
    })
}

/// What the two are called: the names of their directories, with letters where these are the same.
fn names(a: &RunFound, b: &RunFound) -> [String; 2] {
    let name = |found: &RunFound| {
        found.path.file_name().map_or_else(
            || found.path.display().to_string(),
            |n| n.to_string_lossy().into_owned(),
        )
    };
    let (a, b) = (name(a), name(b));
    if a == b {
        [format!("A ({a})"), format!("B ({b})")]
    } else {
        [a, b]
    }
}

fn subtitle(a: &RunFound, b: &RunFound) -> String {
    let lines = [conditions_line(&a.summary), conditions_line(&b.summary)];
    if lines[0] == lines[1] {
        lines[0].clone()
    } else {
        format!("{} against {}", lines[1], lines[0])
    }
}

/// Subjects with each other, baselines by their names.
fn pairs<'a>(a: &[Car<'a>], b: &[Car<'a>]) -> Vec<Pair<'a>> {
    let (Some((subject_a, rest_a)), Some((subject_b, rest_b))) = (a.split_first(), b.split_first())
    else {
        return Vec::new();
    };
    let mut pairs = vec![Pair {
        a: *subject_a,
        b: *subject_b,
    }];
    for a in rest_a {
        pairs.extend(
            rest_b
                .iter()
                .find(|b| b.run.vehicle == a.run.vehicle)
                .map(|b| Pair { a: *a, b: *b }),
        );
    }
    pairs
}

fn answer(a: &RunFound, b: &RunFound, pairs: &[Pair], names: &[String; 2]) -> Section {
    let mut section = Section::new("answer", "Answer");
    // What a kJ of loss costs can be told of one car under one set of conditions only.
    let same_conditions = (a.summary.ambient_degc - b.summary.ambient_degc).abs() < 1e-9
        && a.summary.start == b.summary.start;
    let alike = same_conditions
        && pairs
            .first()
            .is_some_and(|pair| pair.a.run.vehicle == pair.b.run.vehicle);
    let fuel = |run: &RunSummary| run.headline_fuel().unwrap_or(f64::NAN);
    if let Some(Pair { a, b }) = pairs.first() {
        let change = fuel(b.run) - fuel(a.run);
        let percent = 100.0 * change / fuel(a.run);
        section.blocks.push(Block::Lead(format!(
            "The subject of {} uses {}: {} or {} {} than that of {} ({}).",
            names[1],
            Quantity::Fuel.text(fuel(b.run)),
            Quantity::FuelShare.text(change.abs()),
            Quantity::Effect.text(percent.abs()),
            if change < 0.0 { "less" } else { "more" },
            names[0],
            Quantity::Fuel.text(fuel(a.run))
        )));
        let (km_a, km_b) = (a.run.distance_km, b.run.distance_km);
        if ((km_b - km_a) / km_a).abs() > DISTANCE {
            section.blocks.push(Block::Alert(format!(
                "The two drive different distances ({} and {}): a part of the difference is one of road.",
                Quantity::Distance.text(km_a),
                Quantity::Distance.text(km_b)
            )));
        }
        section.text(largest(a, b, alike));
    }
    for (found, name) in [(a, &names[0]), (b, &names[1])] {
        for run in found
            .summary
            .runs
            .iter()
            .filter(|run| !run.failed_checks.is_empty())
        {
            let list: Vec<String> = run.failed_checks.iter().map(|check| words(check)).collect();
            section.blocks.push(Block::Alert(format!(
                "A check failed in {name} for {}: {}.",
                run.vehicle,
                list.join(", ")
            )));
        }
        for line in &found.missing {
            section
                .blocks
                .push(Block::Alert(format!("{name}: {line}.")));
        }
    }
    section.table(fuel_table(pairs, names));
    section
}

/// The components that moved most.
fn largest(a: &Car, b: &Car, alike: bool) -> String {
    let kj = |car: &Car, c: Component| car.run.loss_kj.get(c.name()).unwrap_or(0.0);
    let mut moved: Vec<(Component, f64)> = Component::ALL
        .iter()
        .map(|c| (*c, kj(b, *c) - kj(a, *c)))
        .collect();
    moved.sort_by(|x, y| y.1.abs().total_cmp(&x.1.abs()));
    let told: Vec<String> = moved
        .iter()
        .take(3)
        .filter(|(_, kj)| kj.abs() >= 0.05)
        .map(|(component, kj)| {
            format!(
                "{} {}",
                words(component.name()),
                Quantity::Energy.signed(*kj)
            )
        })
        .collect();
    let transmission = b.run.transmission_loss_kj() - a.run.transmission_loss_kj();
    let fuel = b.run.fuel_energy_kj - a.run.fuel_energy_kj;
    let mut text = format!(
        "Its transmission loses {} {}",
        Quantity::Energy.text(transmission.abs()),
        if transmission < 0.0 { "less" } else { "more" }
    );
    if !told.is_empty() {
        text += &format!(" ({})", told.join(", "));
    }
    text += &format!(
        "; its fuel's energy differs by {}",
        Quantity::Energy.signed(fuel)
    );
    if alike && transmission.abs() > 0.05 {
        text += &format!(
            ", {} for each kJ of transmission loss",
            Quantity::Energy.text(fuel / transmission)
        );
    }
    text + "."
}

fn fuel_table(pairs: &[Pair], names: &[String; 2]) -> Table {
    let unit = |q: Quantity| q.unit().to_owned();
    let q = Quantity::Fuel;
    let columns = [
        (names[0].clone(), unit(q)),
        (names[1].clone(), unit(q)),
        ("difference".to_owned(), unit(q)),
        ("difference".to_owned(), "%".to_owned()),
    ];
    let mut table = Table::of_numbers("Fuel", "Car, phase", columns);
    for Pair { a, b } in pairs {
        let car = if a.run.vehicle == b.run.vehicle {
            a.run.vehicle.clone()
        } else {
            format!("{} / {}", a.run.vehicle, b.run.vehicle)
        };
        let mut row = |what: &str, x: Option<f64>, y: Option<f64>, strong: bool| {
            let both = x.zip(y);
            let cells = [
                format!("{car}, {what}"),
                q.bare(x),
                q.bare(y),
                Quantity::FuelShare.bare_signed(both.map(|(x, y)| y - x)),
                Quantity::Effect.bare_signed(both.map(|(x, y)| 100.0 * (y / x - 1.0))),
            ];
            if strong {
                table.strong_row(cells)
            } else {
                table.row(cells)
            }
        };
        for (x, y) in a
            .run
            .phases
            .iter()
            .zip(&b.run.phases)
            .filter(|_| a.run.phases.len() > 1)
        {
            row(
                &phase(&x.name),
                x.fuel_l_per_100km,
                y.fuel_l_per_100km,
                false,
            );
        }
        row(
            "whole cycle",
            a.run.fuel_l_per_100km,
            b.run.fuel_l_per_100km,
            true,
        );
        if a.run.weighted_fuel_l_per_100km.is_some() {
            row(
                "weighted",
                a.run.weighted_fuel_l_per_100km,
                b.run.weighted_fuel_l_per_100km,
                true,
            );
        }
    }
    table
}

fn conditions(a: &RunFound, b: &RunFound, pairs: &[Pair], names: &[String; 2]) -> Section {
    let mut section = Section::new("conditions", "Conditions, and what differs");
    let mut table = Table::of_words("Conditions", &["", &names[0], &names[1]]);
    let mut row = |name: &str, of: &dyn Fn(&RunFound) -> String| {
        let (a, b) = (of(a), of(b));
        if !(a.is_empty() && b.is_empty()) {
            table.row([name.to_owned(), a, b]);
        }
    };
    let subject = |found: &RunFound, of: fn(&RunSummary) -> &String| {
        found
            .summary
            .runs
            .first()
            .map_or(String::new(), |run| of(run).clone())
    };
    row("Cycle", &|found| {
        cycle_title(&found.summary, found.record.as_ref())
    });
    row("Conditions", &|found| conditions_line(&found.summary));
    row("Subject", &|found| subject(found, |run| &run.title));
    row("Transmission oil", &|found| {
        subject(found, |run| &run.lubricant)
    });
    row("Engine oil", &|found| subject(found, |run| &run.engine_oil));
    row("Longest step", &|found| {
        format!("{} s", found.summary.settings.dt_s)
    });
    row("Belt model", &|found| {
        found.summary.settings.formulation.clone()
    });
    row("Set for the subject", &|found| {
        found.summary.settings.set.join(", ")
    });
    row("Set for all cars", &|found| {
        found.summary.settings.set_all.join(", ")
    });
    row("Program", &|found| found.summary.program.clone());
    section.table(table);
    if let Some(Pair { a, b }) = pairs.first()
        && let (Some(record_a), Some(record_b)) = (a.record, b.record)
    {
        let mut changes = Vec::new();
        for value in &record_a.values {
            let other = record_b.values.iter().find(|other| other.key == value.key);
            let here = other.map_or(String::new(), |other| other.value.clone());
            if here != value.value {
                changes.push(Change {
                    key: value.key.clone(),
                    unit: value.unit.clone(),
                    shipped: value.value.clone(),
                    here,
                });
            }
        }
        for value in record_b
            .values
            .iter()
            .filter(|value| record_a.values.iter().all(|other| other.key != value.key))
        {
            changes.push(Change {
                key: value.key.clone(),
                unit: value.unit.clone(),
                shipped: String::new(),
                here: value.value.clone(),
            });
        }
        if changes.is_empty() {
            section.text("Every value of the two subjects is the same.");
        } else {
            let caption = format!(
                "Values of the subjects that differ ({} of {})",
                changes.len(),
                record_a.values.len()
            );
            section.table(super::run::change_table(
                &caption,
                &changes,
                [&names[0], &names[1]],
            ));
        }
    }
    section
}

fn difference(subject: &Pair, names: &[String; 2]) -> Section {
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

fn ends(subject: &Pair, names: &[String; 2]) -> Table {
    let q = Quantity::Degc;
    let columns = [names[0].clone(), names[1].clone(), "difference".to_owned()]
        .map(|name| (name, q.unit().to_owned()));
    let mut table = Table::of_numbers("Temperatures of the subjects at the end", "Node", columns);
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

fn traces(subject: &Pair, names: &[String; 2]) -> Section {
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

fn reproduce(a: &RunFound, b: &RunFound, names: &[String; 2]) -> Section {
    let mut section = Section::new("reproducibility", "Reproducibility");
    for (found, name) in [(a, &names[0]), (b, &names[1])] {
        let mut facts = vec![(format!("Program of {name}"), found.summary.program.clone())];
        if let Some(record) = &found.record {
            facts.push((format!("Command of {name}"), record.command.clone()));
            facts.push((
                format!("Cycle of {name}, SHA-256"),
                record.cycle.sha256.clone(),
            ));
        }
        section.blocks.push(Block::Facts(facts));
        if let Some(record) = &found.record {
            section
                .blocks
                .push(Block::Folded(hashes(record, &format!("Inputs of {name}"))));
        }
    }
    section
}
