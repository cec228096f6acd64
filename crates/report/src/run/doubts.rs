//! Results behind page 1: fuel by phase, uses of the fuel, results of the studies, doubts.

use super::super::document::{Block, ReportTable, Section};
use super::super::number::{Quantity, capital_first, grouped, list_of, percent, phase, words};
use super::super::results::{RunResults, StudyResults};
use super::super::{study_answers, validation};
use super::{Car, energy};
use cvtcycle_analysis::words::difference_of_cars;
use cvtcycle_analysis::words::run::{intervals, maps_left};
use cvtcycle_output::summary::{Over, RunSummary, Summary};

pub(super) fn section(found: &RunResults, cars: &[Car]) -> Section {
    let mut section = Section::new("results", "Results, and what to doubt");
    let summary = &found.summary;
    section.table(fuel(summary));
    section.text(where_it_went(cars));
    if let [subject, baseline, ..] = cars {
        section.text(energy::difference(subject, baseline));
    }
    section.text(ends(cars));
    for own in &found.studies {
        // A study of another case does not apply to this run; its section describes it.
        if let Some(why) = study_answers::other_case(own, summary) {
            let title = &own.answer.title;
            section.alert(format!(
                "The study \u{201c}{title}\u{201d} is of another case: {why}."
            ));
            continue;
        }
        // Savings of the levers are on page 1 and in their own section.
        if own.outline.levers.is_some() {
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
    section.heading("What to doubt");
    section.blocks.push(Block::List(doubts(found, cars)));
    section
}

/// Fuel, distance and difference of each car, by phase.
fn fuel(summary: &Summary) -> ReportTable {
    let runs = &summary.runs;
    let columns = runs.iter().map(|run| (run.label().to_owned(), ""));
    let mut table = ReportTable::numeric("Fuel and distance", "", columns);
    let mut add = |what: &str, quantity: Quantity, strong: bool, value_of: &ByRun| {
        let name = format!("{what} [{}]", quantity.unit());
        let values = runs.iter().enumerate();
        table.named(name, values.map(|(k, run)| quantity.bare(value_of(k, run))));
        table.emphasise(strong);
    };
    let groups = runs.first().map_or(&[][..], |run| &run.phases);
    let over = runs.first().map_or(Over::Distance, RunSummary::over);
    for (p, group) in groups.iter().enumerate().filter(|_| groups.len() > 1) {
        let name = format!("Fuel, {}", phase(&group.name));
        add(&name, Quantity::fuel(over), false, &|_, run| {
            let phase = run.phases.get(p)?;
            match over {
                Over::Distance => phase.fuel_l_per_100km,
                Over::Time => phase.fuel_l_per_h,
            }
        });
    }
    let weighted = runs
        .iter()
        .any(|run| run.weighted_fuel_l_per_100km.is_some());
    let whole = Quantity::fuel(over);
    add(
        "Fuel, whole cycle",
        whole,
        !weighted,
        &|_, run| match over {
            Over::Distance => run.fuel_l_per_100km,
            Over::Time => run.litres_per_hour(),
        },
    );
    if weighted {
        let value_of: &ByRun = &|_, run| run.weighted_fuel_l_per_100km;
        add("Fuel, weighted 0.43/0.57", Quantity::Fuel, true, value_of);
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
    let value_of: &ByRun = &|_, run| run.weighted_co2_g_per_km.or(run.co2_g_per_km);
    add(co2, Quantity::Co2, false, value_of);
    add("Driven distance", Quantity::Distance, false, &|_, run| {
        Some(run.distance_km)
    });
    table.note = "Positive differences: the subject uses more.".to_owned();
    let ranges = summary.comparison.iter().filter_map(|of| {
        let (other, range) = (&of.baseline, of.fleet.as_ref()?);
        Some(format!(" Against {other} {}.", difference_of_cars(range)))
    });
    table.note.extend(ranges);
    table
}

/// Number of a run by its index.
type ByRun<'a> = dyn Fn(usize, &RunSummary) -> Option<f64> + 'a;

fn where_it_went(cars: &[Car]) -> String {
    let Some(subject) = cars.first() else {
        return String::new();
    };
    let run = subject.run;
    let mut losses = subject.losses_kj();
    losses.sort_by(|a, b| b.1.total_cmp(&a.1));
    let largest = || losses.iter().take(3);
    let names: Vec<String> = largest().map(|(c, _)| run.loss_words(c.name())).collect();
    let sum: f64 = largest().map(|(_, kj)| kj).sum();
    let share = |run: &RunSummary| percent(run.ledger_kj.get("losses"), run.fuel_energy_kj);
    let others = cars[1..].iter();
    let others = others.map(|car| format!(", {} {} %", car.run.label(), share(car.run)));
    let lost = run.transmission_loss_kj();
    format!(
        "The transmission of {} loses {} % of the fuel's energy ({}){}. {} are {} % of that loss.",
        run.label(),
        share(run),
        Quantity::Energy.text(lost),
        others.collect::<String>(),
        capital_first(&list_of(&names)),
        grouped(100.0 * sum / lost, 0)
    )
}

fn ends(cars: &[Car]) -> String {
    let temperatures = |car: &Car| {
        let nodes = ["transmission_sump", "engine_oil", "coolant"];
        let end = |node: &str| words(node) + " " + &Quantity::Degc.text(car.run.end_degc.get(node));
        format!("{}: {}", car.run.label(), nodes.map(end).join(", "))
    };
    let seconds = cars
        .first()
        .map(|car| Quantity::Seconds.text(car.run.duration_s));
    let seconds = seconds.unwrap_or_default();
    let ends: Vec<String> = cars.iter().map(temperatures).collect();
    format!("At the end, after {seconds}: {}.", ends.join("; "))
}

/// Minimum temperature of the thesis's measurements beyond trends, degC.
const MEASURED_FROM_DEGC: f64 = 25.0;

/// Sentence on the share of time in which the transmission oil of each car is below the measured temperatures, if there is any.
pub(super) fn cold(cars: &[Car]) -> Option<String> {
    let share = |car: &Car| {
        let history = car.history?;
        let degc = history.column("transmission_sump_degc").iter();
        let steps = degc.zip(history.column("dt_s"));
        let cold = steps.filter(|(degc, _)| **degc < MEASURED_FROM_DEGC);
        let cold: f64 = cold.map(|(_, dt)| dt).sum();
        let share = grouped(100.0 * cold / car.run.duration_s, 0);
        let value_of = match cars.len() {
            1 => String::new(),
            _ => format!(" ({})", car.run.label()),
        };
        (share != "0").then(|| format!("{share} %{value_of}"))
    };
    let shares: Vec<String> = cars.iter().filter_map(share).collect();
    let from = super::degc(MEASURED_FROM_DEGC);
    (!shares.is_empty()).then(|| {
        format!(
            "For {} of the cycle the transmission oil is colder than {from}, the coldest at which losses were measured: there they are extrapolated.",
            list_of(&shares)
        )
    })
}

/// Range of the difference to each baseline by measured cars, in words.
fn by_cars(summary: &Summary) -> Option<String> {
    let known = summary.comparison.iter().filter_map(|of| {
        let range = difference_of_cars(of.fleet.as_ref()?);
        Some(format!("to {} {range}", of.baseline))
    });
    let known: Vec<String> = known.collect();
    (!known.is_empty()).then(|| {
        format!(
            "The range of the difference is that of computed against measured cars, which holds the error of the model: {}.",
            known.join("; ")
        )
    })
}

fn doubts(found: &RunResults, cars: &[Car]) -> Vec<String> {
    let outside = cars.iter().filter(|car| car.run.outside_validity_s > 0.0);
    let outside = outside.map(|car| {
        let seconds = Quantity::Seconds.text(car.run.outside_validity_s);
        let name = car.run.label();
        format!("{name} ran outside the validity of a model for {seconds}.")
    });
    let mut list: Vec<String> = outside.collect();
    list.extend(maps_left(&found.summary.labelled()));
    let labelled = found.summary.labelled();
    let unlike = labelled.comparison.iter();
    let unlike = unlike.filter(|comparison| !comparison.differences.is_empty());
    list.extend(unlike.map(|comparison| {
        format!(
            "The comparison with {} is {}.",
            comparison.baseline, comparison.likeness
        )
    }));
    list.extend(cold(cars));
    list.extend(super::values::doubt(found, cars));
    let has_interval = |study: &&StudyResults| {
        study.outline.plan.design.is_sampled()
            && !study.answer.comparisons.is_empty()
            && study.answer.points_done > 0
            && study_answers::other_case(study, &found.summary).is_none()
    };
    let none = "The uncertain values of this case were not varied: the difference has no range.";
    let known = intervals(&found.summary.labelled());
    let is_known = !known.is_empty();
    list.extend(known);
    list.extend(match found.studies.iter().find(has_interval) {
        None => by_cars(&labelled).or_else(|| (!is_known).then(|| none.to_owned())),
        Some(study) => {
            let unfinished = study.unfinished();
            unfinished.map(|text| format!("Its interval is preliminary: {text}."))
        }
    });
    list.extend(found.validation.as_ref().map(validation::doubt));
    for car in cars {
        if let Some(safety) = car.run.min_clamp_safety {
            let (name, safety) = (car.run.label(), Quantity::Ratio.text(safety));
            list.push(format!(
                "The belt of {name} is clamped to at least {safety} times its load."
            ));
        }
    }
    list
}
