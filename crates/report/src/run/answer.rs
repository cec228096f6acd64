//! Half a page of results.

use super::super::document::{Block, ReportTable, Section};
use super::super::number::{Quantity, capital_first, percent, phase, words};
use super::super::results::{RunResults, StudyResults};
use super::super::{study_answers, validation};
use super::{Car, conditions_line, cycle_title, energy};
use cvtcycle_output::Component;
use cvtcycle_output::summary::{Comparison, RunSummary, Summary};
use cvtcycle_study::attribute;
use cvtcycle_study::words::run::{contradictions, intervals, maps_left};

pub(super) fn section(found: &RunResults, cars: &[Car]) -> Section {
    let mut section = Section::new("answer", "Answer");
    let (summary, record) = (&found.summary, found.record.as_ref());
    let cycle = cycle_title(summary, record);
    section
        .blocks
        .push(Block::Lead(lead(summary, brief(&cycle))));
    for line in checks(summary)
        .into_iter()
        .chain(said(&contradictions(summary)))
    {
        section.alert(line);
    }
    for line in &found.missing {
        section.alert(capital_first(line) + ".");
    }
    section.table(fuel(summary));
    for own in &found.studies {
        // A study of another case says nothing about this run; its section says what it is.
        if let Some(why) = study_answers::other_case(own, summary) {
            let title = &own.answer.title;
            section.alert(format!(
                "The study \u{201c}{title}\u{201d} is of another case: {why}."
            ));
            continue;
        }
        if let Some(text) = own.unfinished() {
            section.alert(format!("{text}; what it says here is of these."));
        }
        let title = &own.answer.title;
        let answers = study_answers::answers_of_run(own, summary).into_iter();
        let named = answers.map(|line| format!("Study \u{201c}{title}\u{201d}: {line}"));
        section.blocks.extend(named.map(Block::Text));
    }
    if let Some(price) = cars.first().and_then(|car| attribute::answer(car.run)) {
        section.text(price);
    }
    section.text(where_it_went(cars));
    if let [subject, baseline, ..] = cars {
        section.text(energy::difference(subject, baseline));
    }
    section.text(ends(cars));
    section.heading("What to doubt");
    section.blocks.push(Block::List(doubts(found, cars)));
    section
}

/// Sentences of the program as print has them.
fn said(lines: &[String]) -> Vec<String> {
    lines
        .iter()
        .map(|line| study_answers::typeset(line))
        .collect()
}

/// The title of a cycle up to its details: "NEDC" of "NEDC: four ECE 15 and one EUDC, 1180 s (UN R83)".
fn brief(title: &str) -> &str {
    title.split([':', '(', ',']).next().map_or(title, str::trim)
}

fn lead(summary: &Summary, cycle: &str) -> String {
    let Some((subject, baselines)) = summary.runs.split_first() else {
        return String::new();
    };
    let fuel = |run: &RunSummary| Quantity::Fuel.text(run.headline_fuel());
    let weighted = match subject.weighted_fuel_l_per_100km {
        Some(_) => " (weighted)",
        None => "",
    };
    let mut text = format!(
        "{} uses {}{weighted} on {cycle}, {}",
        subject.title,
        fuel(subject),
        conditions_line(summary)
    );
    let compared = baselines.iter().zip(&summary.comparison);
    let differences = compared.filter_map(|(baseline, comparison)| {
        let size = more_or_less(comparison)?;
        let kind = likeness(comparison).map_or_else(String::new, |kind| format!(", {kind}"));
        Some(format!(
            "{size} than {} ({}{kind})",
            baseline.title,
            fuel(baseline)
        ))
    });
    let differences: Vec<String> = differences.collect();
    if !differences.is_empty() {
        text += &format!(": {}", differences.join(", and "));
    }
    text + "."
}

/// "like for like" or "not like for like"; none in results of earlier versions.
fn likeness(comparison: &Comparison) -> Option<&'static str> {
    let kind = match comparison.differences.is_empty() {
        true => "like for like",
        false => "not like for like",
    };
    (!comparison.likeness.is_empty()).then_some(kind)
}

/// "5.9 % more", by the sign of the difference.
fn more_or_less(comparison: &Comparison) -> Option<String> {
    let percent = comparison.fuel_percent?;
    let side = if percent < 0.0 { "less" } else { "more" };
    Some(format!("{} {side}", Quantity::Percent.text(percent.abs())))
}

fn checks(summary: &Summary) -> Vec<String> {
    let failed = |run: &&RunSummary| !run.failed_checks.is_empty();
    let sentence = |run: &RunSummary| {
        let check = |check: &String| match run.flags_s.get(check) {
            Some(s) => format!("{} for {}", words(check), Quantity::Seconds.text(s)),
            None => words(check),
        };
        let list: Vec<String> = run.failed_checks.iter().map(check).collect();
        format!(
            "A check failed for {}: {}. Its numbers are not those of a car that has driven this cycle.",
            run.title,
            list.join(", ")
        )
    };
    summary.runs.iter().filter(failed).map(sentence).collect()
}

/// Fuel, distance and difference of each car, by phase.
fn fuel(summary: &Summary) -> ReportTable {
    let runs = &summary.runs;
    let columns = runs.iter().map(|run| (run.vehicle.clone(), ""));
    let mut table = ReportTable::of_numbers("Fuel and distance", "", columns);
    let mut add = |what: &str, quantity: Quantity, strong: bool, of: &ByRun| {
        let name = format!("{what} [{}]", quantity.unit());
        let values = runs.iter().enumerate();
        table.named(name, values.map(|(k, run)| quantity.bare(of(k, run))));
        table.emphasise(strong);
    };
    let groups = runs.first().map_or(&[][..], |run| &run.phases);
    for (p, group) in groups.iter().enumerate().filter(|_| groups.len() > 1) {
        let name = format!("Fuel, {}", phase(&group.name));
        add(&name, Quantity::Fuel, false, &|_, run| {
            run.phases.get(p).and_then(|p| p.fuel_l_per_100km)
        });
    }
    let weighted = runs
        .iter()
        .any(|run| run.weighted_fuel_l_per_100km.is_some());
    add("Fuel, whole cycle", Quantity::Fuel, !weighted, &|_, run| {
        run.fuel_l_per_100km
    });
    if weighted {
        let of: &ByRun = &|_, run| run.weighted_fuel_l_per_100km;
        add("Fuel, weighted 0.43/0.57", Quantity::Fuel, true, of);
    }
    if runs.len() > 1 {
        let against = |k: usize| summary.comparison.get(k.checked_sub(1)?)?.fuel_percent;
        add(
            "Subject against this car",
            Quantity::Percent,
            true,
            &|k, _| against(k),
        );
    }
    let co2 = if weighted {
        "Carbon dioxide, weighted"
    } else {
        "Carbon dioxide"
    };
    let of: &ByRun = &|_, run| run.weighted_co2_g_per_km.or(run.co2_g_per_km);
    add(co2, Quantity::Co2, false, of);
    add("Driven distance", Quantity::Distance, false, &|_, run| {
        Some(run.distance_km)
    });
    table.note = "Positive differences: the subject uses more.".to_owned();
    table
}

/// A number of a run by its index.
type ByRun<'a> = dyn Fn(usize, &RunSummary) -> Option<f64> + 'a;

fn where_it_went(cars: &[Car]) -> String {
    let Some(subject) = cars.first() else {
        return String::new();
    };
    let run = subject.run;
    let mut losses = subject.losses_kj();
    losses.sort_by(|a, b| b.1.total_cmp(&a.1));
    let text = |(c, kj): &(Component, f64)| words(c.name()) + " " + &Quantity::Energy.text(*kj);
    let largest: Vec<String> = losses.iter().take(3).map(text).collect();
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
        let lost = Quantity::Energy.text(car.run.transmission_loss_kj());
        text += &format!(" The transmission of {} lost {lost}.", car.run.vehicle);
    }
    text
}

fn ends(cars: &[Car]) -> String {
    let temperatures = |car: &Car| {
        let nodes = ["transmission_sump", "engine_oil", "coolant"];
        let end = |node: &str| words(node) + " " + &Quantity::Degc.text(car.run.end_degc.get(node));
        format!("{}: {}", car.run.vehicle, nodes.map(end).join(", "))
    };
    let seconds = cars
        .first()
        .map(|car| Quantity::Seconds.text(car.run.duration_s));
    let seconds = seconds.unwrap_or_default();
    let ends: Vec<String> = cars.iter().map(temperatures).collect();
    format!("At the end, after {seconds}: {}.", ends.join("; "))
}

/// Temperature below which the thesis measured trends only, degC.
const MEASURED_FROM_DEGC: f64 = 25.0;

/// Time of a car with transmission oil below the measured temperatures, if there is any.
fn cold_time(car: &Car) -> Option<String> {
    let history = car.history?;
    let degc = history.column("transmission_sump_degc").iter();
    let steps = degc.zip(history.column("dt_s"));
    let cold = steps.filter(|(degc, _)| **degc < MEASURED_FROM_DEGC);
    let cold: f64 = cold.map(|(_, dt)| dt).sum();
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
    list.extend(maps_left(&found.summary));
    let unlike = found.summary.comparison.iter();
    let unlike = unlike.filter(|comparison| !comparison.differences.is_empty());
    list.extend(
        unlike.map(|of| format!("The comparison with {} is {}.", of.baseline, of.likeness)),
    );
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
        study.outline.plan.design.is_sampled()
            && !study.answer.comparisons.is_empty()
            && study.answer.points_done > 0
            && study_answers::other_case(study, &found.summary).is_none()
    };
    let none = "There is no study of uncertainty of this case: the difference has no interval.";
    let known = said(&intervals(&found.summary));
    let is_known = !known.is_empty();
    list.extend(known);
    list.extend(match found.studies.iter().find(has_interval) {
        None => (!is_known).then(|| none.to_owned()),
        Some(study) => {
            let unfinished = study.unfinished();
            unfinished.map(|text| format!("Its interval is preliminary: {text}."))
        }
    });
    list.extend(found.validation.as_ref().map(validation::doubt));
    for car in cars {
        if let Some(safety) = car.run.min_clamp_safety {
            let (name, safety) = (&car.run.vehicle, Quantity::Ratio.text(safety));
            list.push(format!(
                "The smallest clamping safety of {name} is {safety}."
            ));
        }
    }
    list
}
