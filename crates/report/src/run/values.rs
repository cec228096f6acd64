//! Values with their status and their effect on fuel.

use std::collections::BTreeMap;

use super::super::document::{ReportTable, Section};
use super::super::number::{NONE, Quantity, sign};
use super::super::results::RunResults;
use super::Car;
use cvtcycle_output::record::{CarRecord, Effect, Sensitivity, ValueRecord};

/// Number of assumptions and fits of the subject in the body.
const SHOWN: usize = 10;
/// Effect below which 0 is written, per cent of fuel.
const SMALL_PERCENT: f64 = 0.005;

/// True for a value from judgement, a fit, a class or another car, without a source for this one.
fn is_doubtful(value: &ValueRecord) -> bool {
    ["assumed", "fitted", "default"].contains(&value.status.as_str()) || is_inherited(value)
}

/// True for a value of a class or of another car.
fn is_inherited(value: &ValueRecord) -> bool {
    ["class", "like"].contains(&value.status.as_str())
}

/// "assumed, fitted or X", with the inherited values if there are any.
fn doubtful_words(car: &CarRecord, last: &str) -> String {
    let inherited = match car.values.iter().any(is_inherited) {
        true => ", inherited",
        false => "",
    };
    format!("assumed, fitted{inherited} or {last}")
}

/// True for a given value: neither a choice of a model nor an optional key without a value.
fn is_given(value: &ValueRecord) -> bool {
    value.status != "choice" && !value.value.is_empty()
}

pub(super) fn section(found: &RunResults, cars: &[Car]) -> Option<Section> {
    let record = found.record.as_ref()?;
    let mut section = Section::new("values", "Assumptions, and how much each matters");
    section.text(format!(
        "{} `cvtcycle assumptions` prints every value and equation of the shipped files with its source.",
        count(cars)
    ));
    match &record.sensitivity {
        Some(sensitivity) => {
            section.text(format!(
                "Each number was changed by itself by {} down and up, and the cycle driven again: the effect is the change of that car's fuel. \
                 An efficiency was changed through its loss, a temperature by 5\u{a0}K; a dash where the value cannot be so. The step is the same for all; how uncertain each value is, is another question (docs/uncertainty.md).",
                percent_text(sensitivity.step_percent)
            ));
        }
        None => section.text("How much each value matters was not computed for this run."),
    }
    let mut more = Section::default();
    for (k, car) in cars.iter().enumerate() {
        let Some(car_record) = car.record else {
            continue;
        };
        let body = if k == 0 { Some(&mut section) } else { None };
        add_car_values(
            body,
            &mut more,
            (car_record, car.run.label()),
            record.sensitivity.as_ref(),
        );
    }
    section.more = more.blocks;
    Some(section)
}

fn percent_text(x: f64) -> String {
    format!("{x}\u{a0}%")
}

fn count(cars: &[Car]) -> String {
    let one = |(car, name): (&CarRecord, &str)| {
        let mut by_status: BTreeMap<&str, usize> = BTreeMap::new();
        for value in car.values.iter().filter(|value| is_given(value)) {
            *by_status.entry(&value.status).or_default() += 1;
        }
        let list = by_status.iter().map(|(status, n)| format!("{n} {status}"));
        let list: Vec<String> = list.collect();
        format!("{name}: {}.", list.join(", "))
    };
    let known = cars
        .iter()
        .filter_map(|car| Some((car.record?, car.run.label())));
    known.map(one).collect::<Vec<_>>().join(" ")
}

/// Value with its effect on fuel.
type Ranked<'a> = (&'a ValueRecord, Option<&'a Effect>);

/// Selects values of a car with their effects, the strongest first.
fn ranked<'a>(
    car: &'a CarRecord,
    sensitivity: Option<&'a Sensitivity>,
    wanted: fn(&ValueRecord) -> bool,
) -> Vec<Ranked<'a>> {
    let effects = sensitivity.map_or(&[][..], |found| &found.effects);
    let effect = |value: &ValueRecord| {
        let own = |effect: &&Effect| effect.car == car.name && effect.key == value.key;
        effects.iter().find(own)
    };
    let values = car.values.iter().filter(|value| wanted(value));
    let mut list: Vec<Ranked> = values.map(|value| (value, effect(value))).collect();
    // Values without an effect come last.
    let size = |ranked: &Ranked| ranked.1.map_or(-1.0, Effect::size_percent).max(-1.0);
    // Stable sort: values without an effect keep the order of the file.
    list.sort_by(|a, b| size(b).total_cmp(&size(a)));
    list
}

/// Adds the values of a car: the strongest doubtful ones to the body if there are any, all others to the full report.
fn add_car_values(
    body: Option<&mut Section>,
    more: &mut Section,
    (car, name): (&CarRecord, &str),
    sensitivity: Option<&Sensitivity>,
) {
    let doubtful = ranked(car, sensitivity, is_doubtful);
    let shown = if body.is_some() { SHOWN } else { 0 };
    let (first, rest) = doubtful.split_at(doubtful.len().min(shown));
    let words = doubtful_words(car, "left at the program's default");
    if let Some(body) = body {
        let caption = format!("Values of {name} that are {words}, the strongest first");
        body.table(table(&caption, first, sensitivity));
    }
    if !rest.is_empty() {
        let kind = if shown > 0 { "more" } else { "values" };
        let caption = format!("{} {kind} of {name} that are {words}", rest.len());
        more.table(table(&caption, rest, sensitivity));
    }
    let sourced = ranked(car, sensitivity, |value| {
        !is_doubtful(value) && is_given(value)
    });
    let caption = format!(
        "{} values of {name} with a source or set by the user",
        sourced.len()
    );
    more.folded(table(&caption, &sourced, sensitivity));
}

fn table(caption: &str, list: &[Ranked], sensitivity: Option<&Sensitivity>) -> ReportTable {
    let step = sensitivity.map_or(String::new(), |s| percent_text(s.step_percent));
    let heads = [
        format!("fuel change, value \u{2212}{step} [%]"),
        format!("fuel change, value +{step} [%]"),
    ];
    let mut columns = vec!["Key", "Value", "Status", "Where from"];
    if sensitivity.is_some() {
        columns.extend(heads.iter().map(String::as_str));
    }
    let mut table = ReportTable::textual(caption, &columns);
    for column in table.columns.iter_mut().skip(4) {
        column.number = true;
    }
    for (value, effect) in list {
        let shown = match (value.value.as_str(), value.unit.as_str()) {
            ("", _) => NONE.to_owned(),
            (text, "-" | "") => short(text),
            (text, unit) => format!("{}\u{a0}{}", short(text), sign(unit)),
        };
        let (key, status) = (value.key.clone(), value.status.clone());
        let mut cells = vec![key, shown, status, short(&value.source)];
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

/// Cuts long texts and lists to fit a cell.
fn short(text: &str) -> String {
    const MAX_CHARS: usize = 90;
    if text.chars().count() <= MAX_CHARS {
        text.to_owned()
    } else {
        text.chars().take(MAX_CHARS).collect::<String>() + "\u{2026}"
    }
}

/// Sentence on the number of doubtful values, and the one with the largest effect.
pub(super) fn doubt(found: &RunResults, cars: &[Car]) -> Option<String> {
    let (record, subject) = (found.record.as_ref()?, cars.first()?.record?);
    let count = |wanted: fn(&ValueRecord) -> bool| {
        subject.values.iter().filter(|value| wanted(value)).count()
    };
    let (numbers, doubtful) = (count(is_given), count(is_doubtful));
    if numbers == 0 {
        return None;
    }
    let label = cars.first().map_or("", |car| car.run.label());
    let mut text = format!(
        "{doubtful} of the {numbers} values of {label} are {}",
        doubtful_words(subject, "defaults")
    );
    let sensitivity = record.sensitivity.as_ref();
    if let (Some((value, Some(effect))), Some(sensitivity)) = (
        ranked(subject, sensitivity, is_doubtful).first(),
        sensitivity,
    ) && effect.size_percent().is_finite()
    {
        // A temperature is changed by kelvins, not by a share of its degrees.
        let step = match value.unit.as_str() {
            "degC" => "5\u{a0}K".to_owned(),
            _ => percent_text(sensitivity.step_percent),
        };
        text += &format!(
            "; the one that moves its fuel most is {} ({step} move the fuel by {})",
            value.key,
            Quantity::Effect.text(effect.size_percent())
        );
    }
    Some(text + ".")
}
