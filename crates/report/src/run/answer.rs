//! Half a page of results.

use super::super::document::{Block, ReportTable, Section};
use super::super::number::{Quantity, percent, phase, words};
use super::super::results::{RunResults, StudyResults};
use super::super::{study_answers, validation};
use super::{Car, conditions_line, cycle_title, energy};
use cvtcycle_output::summary::{Comparison, Summary};

pub(super) fn section(found: &RunResults, cars: &[Car]) -> Section {
    let mut section = Section::new("answer", "Answer");
    let (summary, record) = (&found.summary, found.record.as_ref());
    section.lead(lead(summary, brief(&cycle_title(summary, record))));
    for line in checks(summary) {
        section.alert(line);
    }
    for line in &found.missing {
        section.alert(capital_first(line));
    }
    section.table(fuel(summary));
    for own in &found.studies {
        // A study of another case says nothing about this run; its section says what it is.
        if let Some(why) = study_answers::other_case(own, summary) {
            section.alert(format!(
                "The study \u{201c}{}\u{201d} is of another case: {why}.",
                own.answer.title
            ));
            continue;
        }
        section.blocks.extend(
            own.unfinished()
                .map(|text| Block::Alert(format!("{text}; what it says here is of these."))),
        );
        section
            .blocks
            .extend(study_answers::answers(own).into_iter().map(Block::Text));
    }
    section.text(where_it_went(cars));
    if let Some((subject, baseline)) = cars
        .split_first()
        .and_then(|(s, rest)| Some((s, rest.first()?)))
    {
        section.text(energy::difference(subject, baseline));
    }
    section.text(ends(cars));
    section.heading("What to doubt".to_owned());
    section.list(doubts(found, cars));
    section
}

/// The title of a cycle up to its details: "NEDC" of "NEDC: four ECE 15 and one EUDC, 1180 s (UN R83)".
fn brief(title: &str) -> &str {
    title.split([':', '(', ',']).next().map_or(title, str::trim)
}

fn capital_first(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map(|c| c.to_uppercase().collect::<String>())
        .unwrap_or_default()
        + letters.as_str()
        + "."
}

fn lead(summary: &Summary, cycle: &str) -> String {
    let Some((subject, baselines)) = summary.runs.split_first() else {
        return String::new();
    };
    let fuel = Quantity::Fuel.text(subject.headline_fuel());
    let weighted = if subject.weighted_fuel_l_per_100km.is_some() {
        " (weighted)"
    } else {
        ""
    };
    let mut text = format!(
        "{} uses {fuel}{weighted} on {cycle}, {}",
        subject.title,
        conditions_line(summary)
    );
    let differences: Vec<String> = baselines
        .iter()
        .zip(&summary.comparison)
        .filter_map(|(baseline, comparison)| {
            let size = more_or_less(comparison)?;
            Some(format!(
                "{size} than {} ({})",
                baseline.title,
                Quantity::Fuel.text(baseline.headline_fuel())
            ))
        })
        .collect();
    if differences.is_empty() {
        return text + ".";
    }
    text += ": ";
    text + &differences.join(", and ") + "."
}

/// "5.9 % more", by the sign of the difference.
fn more_or_less(comparison: &Comparison) -> Option<String> {
    let percent = comparison.fuel_percent?;
    Some(format!(
        "{} {}",
        Quantity::Percent.text(percent.abs()),
        if percent < 0.0 { "less" } else { "more" }
    ))
}

fn checks(summary: &Summary) -> Vec<String> {
    let failed = summary
        .runs
        .iter()
        .filter(|run| !run.failed_checks.is_empty());
    failed
        .map(|run| {
            let seconds = |check: &String| run.flags_s.get(check).map_or(String::new(), |s| format!(" for {}", Quantity::Seconds.text(s)));
            let list: Vec<String> = run.failed_checks.iter().map(|check| words(check) + &seconds(check)).collect();
            format!("A check failed for {}: {}. Its numbers are not those of a car that has driven this cycle.", run.title, list.join(", "))
        })
        .collect()
}

/// Fuel, distance and difference of each car, by phase.
fn fuel(summary: &Summary) -> ReportTable {
    let runs = &summary.runs;
    let q = Quantity::Fuel;
    let columns = runs.iter().map(|run| (run.vehicle.clone(), String::new()));
    let mut table = ReportTable::of_numbers("Fuel and distance", "", columns);
    let name = |what: &str, unit: &str| format!("{what} [{unit}]");
    let mut add =
        |what: &str, quantity: Quantity, strong: bool, of: &dyn Fn(usize) -> Option<f64>| {
            let cells = [name(what, quantity.unit())]
                .into_iter()
                .chain((0..runs.len()).map(|k| quantity.bare(of(k))));
            if strong {
                table.strong_row(cells)
            } else {
                table.row(cells)
            }
        };
    let groups = runs.first().map_or(&[][..], |run| &run.phases);
    if groups.len() > 1 {
        for (p, group) in groups.iter().enumerate() {
            add(&format!("Fuel, {}", phase(&group.name)), q, false, &|k| {
                runs[k].phases.get(p).and_then(|p| p.fuel_l_per_100km)
            });
        }
    }
    let weighted = runs
        .iter()
        .any(|run| run.weighted_fuel_l_per_100km.is_some());
    add("Fuel, whole cycle", q, !weighted, &|k| {
        runs[k].fuel_l_per_100km
    });
    if weighted {
        add("Fuel, weighted 0.43/0.57", q, true, &|k| {
            runs[k].weighted_fuel_l_per_100km
        });
    }
    let of = |k: usize| k.checked_sub(1).and_then(|k| summary.comparison.get(k));
    if runs.len() > 1 {
        add("Subject against this car", Quantity::Percent, true, &|k| {
            of(k).and_then(|c| c.fuel_percent)
        });
    }
    let co2 = if weighted {
        "Carbon dioxide, weighted"
    } else {
        "Carbon dioxide"
    };
    add(co2, Quantity::Co2, false, &|k| {
        runs[k].weighted_co2_g_per_km.or(runs[k].co2_g_per_km)
    });
    add("Driven distance", Quantity::Distance, false, &|k| {
        Some(runs[k].distance_km)
    });
    table.note = "Positive differences: the subject uses more.".to_owned();
    table
}

fn where_it_went(cars: &[Car]) -> String {
    let Some(subject) = cars.first() else {
        return String::new();
    };
    let run = subject.run;
    let mut losses = subject.losses_kj();
    losses.sort_by(|a, b| b.1.total_cmp(&a.1));
    let largest: Vec<String> = losses
        .iter()
        .take(3)
        .map(|(component, kj)| {
            format!("{} {}", words(component.name()), Quantity::Energy.text(*kj))
        })
        .collect();
    let share = |term: &str| percent(run.ledger_kj.get(term), run.fuel_energy_kj);
    let mut text = format!(
        "Of the fuel's energy of {}, {} % left as exhaust and {} % as heat of the engine; {} % was lost in the transmission ({}), most of it to {}.",
        Quantity::Energy.text(run.fuel_energy_kj),
        share("exhaust"),
        share("engine_heat"),
        share("losses"),
        Quantity::Energy.text(run.transmission_loss_kj()),
        largest.join(", ")
    );
    for car in &cars[1..] {
        text += &format!(
            " The transmission of {} lost {}.",
            car.run.vehicle,
            Quantity::Energy.text(car.run.transmission_loss_kj())
        );
    }
    text
}

fn ends(cars: &[Car]) -> String {
    let temperatures = |car: &Car| {
        let end = |node: &str| Quantity::Degc.text(car.run.end_degc.get(node));
        format!(
            "{}: transmission sump {}, engine oil {}, coolant {}",
            car.run.vehicle,
            end("transmission_sump"),
            end("engine_oil"),
            end("coolant")
        )
    };
    let seconds = cars.first().map_or(String::new(), |car| {
        Quantity::Seconds.text(car.run.duration_s)
    });
    format!(
        "At the end, after {seconds}: {}.",
        cars.iter().map(temperatures).collect::<Vec<_>>().join("; ")
    )
}

/// Temperature below which the thesis measured trends only, degC.
const MEASURED_FROM_DEGC: f64 = 25.0;

/// Time of a car with transmission oil below the measured temperatures, if there is any.
fn cold_time(car: &Car) -> Option<String> {
    let history = car.history?;
    let degc = history.column("transmission_sump_degc").iter();
    let steps = degc.zip(history.column("dt_s"));
    let cold: f64 = steps
        .filter(|(degc, _)| **degc < MEASURED_FROM_DEGC)
        .map(|(_, dt)| dt)
        .sum();
    let [cold_text, whole] = [cold, car.run.duration_s].map(|s| Quantity::Seconds.text(s));
    (cold > 0.0).then(|| format!("{cold_text} of {whole} in {}", car.run.vehicle))
}

fn doubts(found: &RunResults, cars: &[Car]) -> Vec<String> {
    let outside = cars.iter().filter(|car| car.run.outside_validity_s > 0.0);
    let outside = outside.map(|car| {
        let seconds = Quantity::Seconds.text(car.run.outside_validity_s);
        let name = &car.run.vehicle;
        format!("{name} ran outside the validity of a model for {seconds}.")
    });
    let mut list: Vec<String> = outside.collect();
    let below: Vec<String> = cars.iter().filter_map(cold_time).collect();
    if !below.is_empty() {
        list.push(format!(
            "The transmission oil was below {} for {}: there the thesis measured trends only (5.3.3), and the losses are extrapolated.",
            super::degc(MEASURED_FROM_DEGC),
            below.join(", ")
        ));
    }
    list.extend(super::values::doubt(found, cars));
    let has_interval = |study: &&StudyResults| {
        let sampled =
            study.outline.plan.design.is_sampled() && !study.answer.comparisons.is_empty();
        sampled
            && study.answer.points_done > 0
            && study_answers::other_case(study, &found.summary).is_none()
    };
    match found.studies.iter().find(has_interval) {
        None => list.push(
            "There is no study of uncertainty of this case: the difference has no interval."
                .to_owned(),
        ),
        Some(study) => list.extend(
            study
                .unfinished()
                .map(|text| format!("Its interval is preliminary: {text}.")),
        ),
    }
    list.extend(found.validation.as_ref().map(validation::doubt));
    let worst = cars
        .iter()
        .filter_map(|car| car.run.min_clamp_safety.map(|safety| (car, safety)));
    list.extend(worst.map(|(car, safety)| {
        format!(
            "The smallest clamping safety of {} is {}.",
            car.run.vehicle,
            Quantity::Ratio.text(safety)
        )
    }));
    list
}
