//! Values with their status and their effect on fuel.

use std::collections::BTreeMap;

use super::super::document::{ReportTable, Section};
use super::super::number::{NONE, Quantity};
use super::super::results::RunResults;
use super::Car;
use cvtcycle_output::record::{CarRecord, Effect, Record, Sensitivity, ValueRecord};

/// Assumptions and fits shown before the rest is folded away.
const SHOWN: usize = 20;
/// Effects below this, per cent of fuel, are written as 0.
const SMALL_PERCENT: f64 = 0.005;

/// True for a value from judgement or a fit, not from a source.
fn is_doubtful(value: &ValueRecord) -> bool {
    ["assumed", "fitted", "default"].contains(&value.status.as_str())
}

/// True if there is a value: neither a choice of a model nor an optional key without a value.
fn is_given(value: &ValueRecord) -> bool {
    value.status != "choice" && !value.value.is_empty()
}

pub(super) fn section(found: &RunResults, cars: &[Car]) -> Option<Section> {
    let record = found.record.as_ref()?;
    let mut section = Section::new("values", "Assumptions, and how much each matters");
    section.text(format!(
        "{} `cvtcycle assumptions` prints every value and equation of the shipped files with its source.",
        count(record)
    ));
    match &record.sensitivity {
        Some(sensitivity) => {
            section.text(format!(
                "Each number was changed by itself by {} down and up, and the cycle driven again: the effect is the change of that car's fuel. \
                 An efficiency was changed through its loss, a temperature by 5\u{a0}K; a dash where the value cannot be so. The step is the same for all; how uncertain each value is, is another question (docs/uncertainty.md).",
                percent_text(sensitivity.step_percent)
            ));
        }
        None => section.text("How much each value matters was not computed for this run: use cvtcycle run --sensitivity always."),
    }
    for car in cars {
        if let Some(record) = car.record {
            of_car(
                &mut section,
                record,
                found.record.as_ref().and_then(|r| r.sensitivity.as_ref()),
            );
        }
    }
    Some(section)
}

fn percent_text(x: f64) -> String {
    format!("{x}\u{a0}%")
}

fn count(record: &Record) -> String {
    let one = |car: &CarRecord| {
        let mut by_status: BTreeMap<&str, usize> = BTreeMap::new();
        for value in car.values.iter().filter(|value| is_given(value)) {
            *by_status.entry(&value.status).or_default() += 1;
        }
        let list: Vec<String> = by_status
            .iter()
            .map(|(status, n)| format!("{n} {status}"))
            .collect();
        format!("{}: {}.", car.name, list.join(", "))
    };
    record.cars.iter().map(one).collect::<Vec<_>>().join(" ")
}

/// Doubtful values of a car with their effects, the strongest first.
fn ranked<'a>(
    car: &'a CarRecord,
    sensitivity: Option<&'a Sensitivity>,
) -> Vec<(&'a ValueRecord, Option<&'a Effect>)> {
    let effect = |value: &ValueRecord| {
        sensitivity?
            .effects
            .iter()
            .find(|effect| effect.car == car.name && effect.key == value.key)
    };
    let mut list: Vec<_> = car
        .values
        .iter()
        .filter(|value| is_doubtful(value))
        .map(|value| (value, effect(value)))
        .collect();
    let size = |effect: &Option<&Effect>| effect.map_or(-1.0, Effect::size_percent);
    // Stable: values without an effect keep the order of the file.
    list.sort_by(|a, b| size(&b.1).total_cmp(&size(&a.1)));
    list
}

fn of_car(section: &mut Section, car: &CarRecord, sensitivity: Option<&Sensitivity>) {
    let ranked = ranked(car, sensitivity);
    let (first, rest) = ranked.split_at(ranked.len().min(SHOWN));
    let caption = format!(
        "Values of {} that are assumed, fitted or left at the program's default, the strongest first",
        car.name
    );
    section.table(table(&caption, first, sensitivity));
    if !rest.is_empty() {
        let caption = format!("{} more of {}", rest.len(), car.name);
        section.folded(table(&caption, rest, sensitivity));
    }
    let sourced: Vec<_> = car
        .values
        .iter()
        .filter(|value| !is_doubtful(value) && is_given(value))
        .collect();
    let effect = |value: &ValueRecord| {
        sensitivity?
            .effects
            .iter()
            .find(|effect| effect.car == car.name && effect.key == value.key)
    };
    let mut sourced: Vec<_> = sourced
        .into_iter()
        .map(|value| (value, effect(value)))
        .collect();
    let size = |effect: &Option<&Effect>| effect.map_or(-1.0, Effect::size_percent);
    sourced.sort_by(|a, b| size(&b.1).total_cmp(&size(&a.1)));
    let caption = format!(
        "{} values of {} with a source or set by the user",
        sourced.len(),
        car.name
    );
    section.folded(table(&caption, &sourced, sensitivity));
}

fn table(
    caption: &str,
    list: &[(&ValueRecord, Option<&Effect>)],
    sensitivity: Option<&Sensitivity>,
) -> ReportTable {
    let step = sensitivity.map_or(String::new(), |s| percent_text(s.step_percent));
    let heads = [
        format!("fuel with it {step} lower, %"),
        format!("fuel with it {step} higher, %"),
    ];
    let mut columns = vec!["Key", "Value", "Status", "Where from"];
    if sensitivity.is_some() {
        columns.extend(heads.iter().map(String::as_str));
    }
    let mut table = ReportTable::of_words(caption, &columns);
    table
        .columns
        .iter_mut()
        .skip(4)
        .for_each(|column| column.number = true);
    for (value, effect) in list {
        let shown = match (value.value.as_str(), value.unit.as_str()) {
            ("", _) => NONE.to_owned(),
            (text, "-" | "") => short(text),
            (text, unit) => format!("{}\u{a0}{unit}", short(text)),
        };
        let mut cells = vec![
            value.key.clone(),
            shown,
            value.status.clone(),
            short(&value.source),
        ];
        if sensitivity.is_some() {
            let side = |x: Option<f64>| match x {
                Some(x) if x.abs() < SMALL_PERCENT => "0".to_owned(),
                x => Quantity::Effect.bare_signed(x),
            };
            cells.extend(effect.map_or([String::new(), String::new()], |e| {
                [side(e.lowered_percent), side(e.raised_percent)]
            }));
        }
        table.row(cells);
    }
    table
}

/// Long texts and lists cut to what fits a cell.
fn short(text: &str) -> String {
    const MOST: usize = 90;
    if text.chars().count() <= MOST {
        text.to_owned()
    } else {
        text.chars().take(MOST).collect::<String>() + "\u{2026}"
    }
}

/// The number of doubtful values, and the one with the largest effect.
pub(super) fn doubt(found: &RunResults, cars: &[Car]) -> Option<String> {
    let (record, subject) = (found.record.as_ref()?, cars.first()?.record?);
    let numbers = subject
        .values
        .iter()
        .filter(|value| is_given(value))
        .count();
    if numbers == 0 {
        return None;
    }
    let doubtful = subject
        .values
        .iter()
        .filter(|value| is_doubtful(value))
        .count();
    let mut text = format!(
        "{doubtful} of the {numbers} values of {} are assumed, fitted or defaults",
        subject.name
    );
    let sensitivity = record.sensitivity.as_ref();
    if let (Some((value, Some(effect))), Some(sensitivity)) =
        (ranked(subject, sensitivity).first(), sensitivity)
        && effect.size_percent().is_finite()
    {
        text += &format!(
            "; the one that moves its fuel most is {} ({} of it move the fuel by {})",
            value.key,
            percent_text(sensitivity.step_percent),
            Quantity::Effect.text(effect.size_percent())
        );
    }
    Some(text + ".")
}
