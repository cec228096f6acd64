//! The values of a factor at the points of a design: as numbers, as words, and as labels.

use std::sync::Arc;

use crate::plan::{Acts, FactorValue, Plan};

/// The values of a factor at the first points, as the design has them. They need no table: a design is a function of the point.
pub(super) fn values(
    plan: &Plan,
    factor: usize,
    points: usize,
) -> impl Iterator<Item = Option<FactorValue>> {
    (0..points as u64).map(move |point| value(plan, factor, point))
}

/// The value of a factor at a point. One of another form than that of the point has the value of the point's form for the same key, or else leaves the
/// key as it is.
pub(super) fn value(plan: &Plan, factor: usize, point: u64) -> Option<FactorValue> {
    let at = |f: usize| plan.factors[f].value(plan.design.level(&plan.factors, point, f));
    let of = &plan.factors[factor];
    if of.form.is_none() {
        return at(factor);
    }
    let is_like = |f: &usize| (&plan.factors[*f].key, plan.factors[*f].cars) == (&of.key, of.cars);
    let alike = (0..plan.factors.len()).filter(is_like);
    let neutral = || match (of.values.are_numbers(), of.acts) {
        (false, _) => None,
        (true, Acts::Scale) => Some(FactorValue::Number(1.0)),
        (true, _) => Some(FactorValue::Number(0.0)),
    };
    at(factor)
        .or_else(|| alike.filter_map(at).next())
        .or_else(neutral)
}

/// Numbers of a factor.
pub(super) fn numbers(plan: &Plan, factor: usize, points: usize) -> Vec<f64> {
    let number = |value: Option<FactorValue>| value.and_then(|x| x.number()).unwrap_or(f64::NAN);
    values(plan, factor, points).map(number).collect()
}

/// Words of a factor, or its numbers as words; every word is held once.
pub(super) fn words(plan: &Plan, factor: usize, points: usize) -> impl Iterator<Item = Arc<str>> {
    let mut known: Vec<(Option<FactorValue>, Arc<str>)> = vec![(None, "".into())];
    let word = move |value: Option<FactorValue>| {
        if let Some((_, text)) = known.iter().find(|(other, _)| *other == value) {
            return text.clone();
        }
        let text: Arc<str> = value
            .iter()
            .map(|value| label(value, ""))
            .collect::<String>()
            .into();
        known.push((value, text.clone()));
        text
    };
    values(plan, factor, points).map(word)
}

/// A value as a label: numbers with four figures and their unit.
pub(super) fn label(value: &FactorValue, unit: &str) -> String {
    let x = match value {
        FactorValue::Word(word) => return word.to_string(),
        FactorValue::Number(x) => *x,
    };
    let digits = match x.abs() > 0.0 {
        true => (3 - x.abs().log10().floor() as i32)
            .clamp(0, 12)
            .unsigned_abs(),
        false => 0,
    };
    let mut text = format!("{x:.*}", digits as usize);
    if text.contains('.') {
        text.truncate(text.trim_end_matches('0').trim_end_matches('.').len());
    }
    match unit {
        "" | "-" => text,
        unit => format!("{text} {unit}"),
    }
}
