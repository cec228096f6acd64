//! The values of a factor: a list, a range or a distribution.

use std::sync::Arc;

use super::distribution::mass;
use super::{Acts, Distribution, FactorValue, FactorValues, Places, options};
use cvtcycle_config::{Bound, RawValue, Section};
use cvtcycle_model::keys::Quantity;

/// Ways to give values.
pub(super) const WAYS: [&str; 3] = ["values", "range", "distribution"];
/// Message for a factor without any of them.
pub(super) const NONE: &str = "the factor has no values";
/// Distributions.
const DISTRIBUTIONS: [&str; 5] = [
    "normal",
    "truncated_normal",
    "uniform",
    "triangular",
    "lognormal",
];
/// Most values of a range.
const MAX_IN_RANGE: i64 = 10_000;
/// Least share of a normal distribution that has to lie between the ends at which it is cut off.
const MIN_LEFT: f64 = 0.01;
/// Least standard deviation over the mean: below it the draws hardly differ as they are stored.
const MIN_SPREAD: f64 = 1e-9;

/// Whose values they are.
#[derive(Clone, Copy)]
pub(super) struct Of<'a> {
    /// Key of the factor.
    pub key: &'a str,
    /// What its numbers do.
    pub acts: Acts,
}

impl Of<'_> {
    /// A key that ends in the unit of the numbers.
    fn quantity(&self) -> &str {
        match self.acts {
            Acts::Scale => "",
            Acts::Value | Acts::Offset => {
                options::quantity(self.key.rsplit('.').next().unwrap_or_default())
            }
        }
    }

    /// Range of its numbers, as far as it is known here.
    fn bound(&self) -> Bound {
        options::bound(self.key).unwrap_or(Bound::any())
    }
}

/// Reads the values that the table of a factor gives in one of the three ways, and notes where they stand; none if that is reported.
pub(super) fn read(s: &Section, of: Of, places: &mut Places) -> Option<FactorValues> {
    let list = list(s, of, places).map(FactorValues::List);
    let range = range(s, of, places).map(FactorValues::List);
    let distribution = distribution(s, of, places).map(FactorValues::Distribution);
    let given: Vec<&str> = WAYS.into_iter().filter(|way| s.has(way)).collect();
    let one_of = "one of values, range, distribution";
    match given.as_slice() {
        [_] => list.or(range).or(distribution),
        [] => {
            s.complain(
                "values",
                one_of,
                NONE,
                "add values = [...], range = { ... } or [factor.distribution.NAME]",
            );
            None
        }
        [first, .., last] => {
            s.complain(
                last,
                one_of,
                &format!("`{last}` with `{first}`"),
                "keep one of them",
            );
            None
        }
    }
}

fn list(s: &Section, of: Of, places: &mut Places) -> Option<Vec<FactorValue>> {
    let written = s.raw(
        "values",
        "a list of numbers or words",
        "values, each for itself",
    )?;
    places.add("values", written.place());
    let Some(items) = written.items() else {
        written.complain(
            "a list",
            "`values` is no list",
            &format!("write values = [{}]", written.text()),
        );
        return None;
    };
    if items.is_empty() {
        written.complain("a list of at least one value", "`values` is empty", "");
        return None;
    }
    items
        .iter()
        .enumerate()
        .for_each(|(k, item)| places.add_item("values", k, item.place()));
    let read: Vec<Option<FactorValue>> = items.iter().map(|item| value(item, of)).collect();
    let mut values = read.into_iter().collect::<Option<Vec<FactorValue>>>()?;
    let is_number = |value: &FactorValue| matches!(value, FactorValue::Number(_));
    if !values.iter().all(is_number) {
        if of.key == "start" {
            values
                .iter_mut()
                .for_each(|value| *value = FactorValue::Word(Arc::from(value.to_string())));
        } else if let Some(k) = values
            .iter()
            .position(|value| is_number(value) != is_number(&values[0]))
        {
            items[k].complain(
                "numbers alone, or none",
                "`values` mixes numbers with other values",
                "make two factors of it",
            );
            return None;
        }
    }
    for (k, value) in values.iter().enumerate() {
        if values[..k].contains(value) {
            items[k].complain(
                "",
                &format!("`{value}` is listed twice in `values`"),
                "remove one",
            );
            return None;
        }
    }
    Some(values)
}

/// An item of a list.
fn value(item: &RawValue, of: Of) -> Option<FactorValue> {
    if options::is_option(of.key) {
        return options::value(of.key, item);
    }
    if item.is_number() {
        return item
            .number(Quantity::of(of.quantity()), Bound::any())
            .map(FactorValue::Number);
    }
    let Some(word) = item.word() else {
        if item.is_table() {
            item.wrong_type("a number, a word or a list");
            return None;
        }
        return Some(FactorValue::Word(Arc::from(item.text())));
    };
    // Such a word would become what it looks like when it is put into the car's file.
    if word.trim().is_empty() || toml::from_str::<toml::Table>(&format!("x = {word}")).is_ok() {
        let hint = if word.trim().is_empty() {
            String::new()
        } else {
            format!("write {} without quotes", word.trim())
        };
        item.complain(
            "a number, a word or a list",
            &format!("{} is no word", item.text()),
            &hint,
        );
        return None;
    }
    Some(FactorValue::Word(Arc::from(word)))
}

fn range(s: &Section, of: Of, places: &mut Places) -> Option<Vec<FactorValue>> {
    let table = s.table("range");
    if !s.has("range") {
        return None;
    }
    places.add("values", s.place("range"));
    places.add("range", s.place("range"));
    words_only(s, of, "range");
    if !table.exists() {
        return None;
    }
    let end = |key: &str, doc: &str| match table.raw(key, &of.bound().to_string(), doc) {
        Some(written) => written
            .number(Quantity::of(of.quantity()), of.bound())
            .unwrap_or(f64::NAN),
        None => table.number(key, of.bound(), doc),
    };
    let (from, to) = (end("from", "first value"), end("to", "last value"));
    let step = table.optional_number(
        "step",
        Bound::positive(),
        "distance of the values; the last one may be nearer",
    );
    let count = table.integer_or(
        "count",
        2..=MAX_IN_RANGE,
        2,
        "number of values, with both ends",
    );
    let count = table.has("count").then_some(count);
    if from >= to {
        table.complain(
            "to",
            &format!("above {from}"),
            "the range ends before it begins",
            "swap `from` and `to`",
        );
        return None;
    }
    let numbers = match (count, step) {
        (Some(count), None) => evenly(from, to, count),
        (None, Some(step)) if (to - from) / step >= MAX_IN_RANGE as f64 => {
            table.complain(
                "step",
                &format!("up to {MAX_IN_RANGE} values"),
                "the range has too many values",
                "take a larger step",
            );
            return None;
        }
        (None, Some(step)) => stepwise(from, to, step),
        (Some(_), Some(_)) => {
            table.complain(
                "step",
                "count or step",
                "`step` with `count`",
                "keep one of them",
            );
            return None;
        }
        (None, None) => {
            table.complain(
                "count",
                "count or step",
                "the range has neither `count` nor `step`",
                "add count = 5 or a step",
            );
            return None;
        }
    };
    if numbers.windows(2).any(|pair| pair[0] >= pair[1]) {
        table.complain(
            "to",
            "",
            "the values lie too close to each other",
            "widen the range, or take fewer values",
        );
        return None;
    }
    numbers
        .iter()
        .all(|x| x.is_finite())
        .then(|| numbers.into_iter().map(FactorValue::Number).collect())
}

fn evenly(from: f64, to: f64, count: i64) -> Vec<f64> {
    let last = count - 1;
    let inner = (1..last).map(|k| clean(from + (to - from) * k as f64 / last as f64));
    [from].into_iter().chain(inner).chain([to]).collect()
}

fn stepwise(from: f64, to: f64, step: f64) -> Vec<f64> {
    if !(from + to + step).is_finite() {
        return vec![f64::NAN];
    }
    let inner = (1..)
        .map(|k: u32| clean(from + step * f64::from(k)))
        .take_while(|x| *x < to - 1e-9 * step);
    [from].into_iter().chain(inner).chain([to]).collect()
}

/// Without the last digits, in which sums of decimal fractions carry their rounding.
fn clean(x: f64) -> f64 {
    format!("{x:.12e}").parse().unwrap_or(x)
}

/// Complains about numbers for an option that takes words.
fn words_only(s: &Section, of: Of, way: &str) {
    if options::is_option(of.key) && options::bound(of.key).is_none() {
        s.complain(
            way,
            &options::allowed(of.key),
            &format!("`{}` takes words, not numbers", of.key),
            "give them as values = [...]",
        );
    }
}

fn distribution(s: &Section, of: Of, places: &mut Places) -> Option<Distribution> {
    if !s.has("distribution") {
        let _ = s.table("distribution"); // for the hints of mistyped keys
        return None;
    }
    let (name, t) = s.choose(
        "distribution",
        &DISTRIBUTIONS,
        None,
        "how the values are distributed",
    );
    places.add("distribution", s.place("distribution"));
    words_only(s, of, "distribution");
    let mut number = |key: &str, bound: Bound, doc: &str| {
        places.add_given(&t, key, &format!("distribution.{key}"));
        t.number(key, bound, doc)
    };
    let any = Bound::any();
    let found = match name {
        "normal" => Distribution::Normal {
            mean: number("mean", any, "mean"),
            sd: number("sd", Bound::positive(), "standard deviation"),
        },
        "truncated_normal" => Distribution::TruncatedNormal {
            mean: number("mean", any, "mean before the cut"),
            sd: number("sd", Bound::positive(), "standard deviation before the cut"),
            low: number("low", any, "least value"),
            high: number("high", any, "largest value"),
        },
        "uniform" => Distribution::Uniform {
            low: number("low", any, "least value"),
            high: number("high", any, "largest value"),
        },
        "triangular" => Distribution::Triangular {
            low: number("low", any, "least value"),
            mode: number("mode", any, "most likely value"),
            high: number("high", any, "largest value"),
        },
        _ => Distribution::Lognormal {
            median: number("median", Bound::positive(), "median"),
            geometric_sd: number(
                "geometric_sd",
                Bound::open_low(1.0, 10.0),
                "68 % lie between median / g and median g; 1.1 for about 10 %",
            ),
        },
    };
    (fits(&t, &found, of.acts) && t.exists()).then_some(found)
}

/// Whether the parameters of a distribution go together; if not, it is reported. Parameters that were reported already are NaN.
fn fits(t: &Section, found: &Distribution, acts: Acts) -> bool {
    match *found {
        Distribution::Normal { mean, sd } => {
            if acts == Acts::Scale && sd > 0.5 * mean {
                let allowed = format!("up to {}, half of the mean", 0.5 * mean);
                t.complain(
                    "sd",
                    &allowed,
                    "the factors of a scale would reach zero",
                    "use lognormal or truncated_normal",
                );
            }
            not_too_narrow(t, mean, sd) && !(acts == Acts::Scale && sd > 0.5 * mean)
        }
        Distribution::TruncatedNormal {
            mean,
            sd,
            low,
            high,
        } => {
            if !(not_too_narrow(t, mean, sd) && ends(t, low, high)) {
                return false;
            }
            let left = mass((low - mean) / sd, (high - mean) / sd);
            if left < MIN_LEFT {
                let message = format!(
                    "only {:.2} % of the normal distribution lie between `low` and `high`",
                    100.0 * left
                );
                t.complain(
                    "low",
                    "at least 1 %",
                    &message,
                    "move the mean, or use uniform or triangular",
                );
            }
            left >= MIN_LEFT
        }
        Distribution::Uniform { low, high } => ends(t, low, high),
        Distribution::Triangular { low, mode, high } => {
            let fits = ends(t, low, high);
            if fits && (mode < low || mode > high) {
                t.complain(
                    "mode",
                    &format!("{low} to {high}"),
                    "the most likely value lies outside `low` to `high`",
                    "",
                );
            }
            fits && low <= mode && mode <= high
        }
        Distribution::Lognormal {
            median,
            geometric_sd,
        } => median.is_finite() && geometric_sd.is_finite(),
    }
}

fn not_too_narrow(t: &Section, mean: f64, sd: f64) -> bool {
    if sd < MIN_SPREAD * mean.abs() {
        let message = "the standard deviation is so small that nothing varies";
        t.complain(
            "sd",
            &format!("at least {:e}", MIN_SPREAD * mean.abs()),
            message,
            "",
        );
    }
    sd >= MIN_SPREAD * mean.abs()
}

fn ends(t: &Section, low: f64, high: f64) -> bool {
    if low >= high {
        t.complain(
            "high",
            &format!("above {low}"),
            "`high` is not above `low`",
            "",
        );
    } else if (high - low).is_infinite() {
        t.complain(
            "high",
            "a finite distance from `low`",
            "`low` and `high` are too far apart",
            "",
        );
    }
    low < high && (high - low).is_finite()
}
