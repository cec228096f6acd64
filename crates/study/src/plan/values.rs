//! The values of a factor: a list, a range or a distribution.

use std::sync::Arc;

use super::distribution::mass;
use super::keys::{
    self, FACTOR, LOGNORMAL, MAX_IN_RANGE, NORMAL, RANGE, TRIANGULAR, TRUNCATED, UNIFORM,
};
use super::{Acts, Distribution, FactorValue, FactorValues, Places, options};
use cvtcycle_config::ProblemKind;
use cvtcycle_config::ProblemKind::{Conflict, Missing, OutOfRange, TooLarge};
use cvtcycle_config::{Bound, RawValue, Section};
use cvtcycle_model::keys::{Key, Kind, Quantity, Values};

/// Ways to give values.
pub(super) const WAYS: [&str; 3] = ["values", "range", "distribution"];
/// Message for a factor without any of them.
pub(super) const NONE: &str = "the factor has no values";
/// Least share of a normal distribution that has to lie between the ends at which it is cut off.
const MIN_LEFT: f64 = 0.01;
/// Least standard deviation over the mean: below it the draws hardly differ as they are stored.
const MIN_SPREAD: f64 = 1e-9;

/// Factor that the values belong to.
#[derive(Clone, Copy)]
pub(super) struct Of<'a> {
    /// Key of the factor.
    pub key: &'a str,
    /// Action of the numbers.
    pub acts: Acts,
}

impl Of<'_> {
    /// Unit of the numbers.
    fn quantity(&self) -> Quantity {
        match self.acts {
            Acts::Scale => Quantity::NONE,
            Acts::Value | Acts::Offset => keys::quantity(self.key),
        }
    }

    /// Complains about numbers for an option that takes words.
    fn no_numbers(&self, s: &Section, way: &str) {
        if let Some(row) = keys::run_option(self.key)
            && keys::range(self.key).is_none()
        {
            let message = format!("`{}` takes words, not numbers", self.key);
            s.mistyped(way, &row.allowed(), &message, "give them as values = [...]");
        }
    }
}

/// Reads the values that the table of a factor gives in one of the three ways, and records their places; none if that is reported.
pub(super) fn read(s: &Section, of: Of, places: &mut Places) -> Option<FactorValues> {
    let list = list(s, of, places);
    let range = range(s, of, places).map(FactorValues::List);
    let distribution = distribution(s, of, places).map(FactorValues::Distribution);
    let given: Vec<&str> = WAYS.into_iter().filter(|way| s.has(way)).collect();
    let one_of = "one of values, range, distribution";
    match given.as_slice() {
        [_] => return list.or(range).or(distribution),
        [] => {
            let hint = "add values = [...], range = { ... } or [factor.distribution.NAME]";
            s.missing("values", one_of, NONE, hint);
        }
        [first, .., last] => {
            s.complain_by_name(
                ProblemKind::Conflict,
                last,
                one_of,
                &format!("`{last}` with `{first}`"),
                "keep one of them",
            );
        }
    }
    None
}

fn list(s: &Section, of: Of, places: &mut Places) -> Option<FactorValues> {
    let written = s.written(&FACTOR.values)?;
    places.add("values", written.place());
    let Some(items) = written.items() else {
        let hint = format!("write values = [{}]", written.text());
        written.complain_by_name(
            ProblemKind::WrongType,
            "a list",
            "`values` is no list",
            &hint,
        );
        return None;
    };
    if items.is_empty() {
        written.complain_by_name(
            ProblemKind::Missing,
            "a list of at least one value",
            "`values` is empty",
            "",
        );
        return None;
    }
    places.add_items("values", &items);
    let read: Vec<Option<FactorValue>> = items.iter().map(|item| value(item, of)).collect();
    let values = read.into_iter().collect::<Option<Vec<FactorValue>>>()?;
    let mixed = values
        .iter()
        .position(|v| v.is_number() != values[0].is_number());
    if let Some(k) = mixed.filter(|_| of.key != "start") {
        let message = "`values` mixes numbers with other values";
        items[k].complain_by_name(
            ProblemKind::WrongType,
            "numbers alone, or none",
            message,
            "make two factors of it",
        );
        return None;
    }
    let again = (0..values.len()).find(|&k| values[..k].contains(&values[k]));
    if let Some(k) = again {
        let message = format!("`{}` is listed twice in `values`", values[k]);
        items[k].complain_by_name(ProblemKind::Duplicate, "", &message, "remove one");
    }
    again
        .is_none()
        .then(|| FactorValues::List(values).unmixed())
}

/// An item of a list.
fn value(item: &RawValue, of: Of) -> Option<FactorValue> {
    if let Some(row) = keys::run_option(of.key) {
        return options::value(row, item);
    }
    if item.is_number() {
        let number = item.number(of.quantity(), Bound::any());
        return number.map(FactorValue::Number);
    }
    let allowed = "a number, a word or a list";
    let Some(word) = item.word() else {
        if item.is_table() {
            item.wrong_type(allowed);
            return None;
        }
        return Some(FactorValue::Word(Arc::from(item.text())));
    };
    // Such a word would become what it looks like when it is put into the car's file.
    let is_empty = word.trim().is_empty();
    if is_empty || toml::from_str::<toml::Table>(&format!("x = {word}")).is_ok() {
        let hint = match is_empty {
            true => String::new(),
            false => format!("write {} without quotes", word.trim()),
        };
        item.mistyped(allowed, &format!("{} is no word", item.text()), &hint);
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
    of.no_numbers(s, "range");
    if !table.exists() {
        return None;
    }
    let bound = keys::range(of.key).unwrap_or(Bound::any());
    let end = |row: &Key<'static>| {
        // The ends are in the unit of the factor and are not converted.
        let row = Key {
            kind: Kind::Number(bound),
            ..*row
        };
        match table.written(&row) {
            Some(written) => written.number(of.quantity(), bound).unwrap_or(f64::NAN),
            None => Values::number(&table, &row),
        }
    };
    let (from, to) = (end(&RANGE.from), end(&RANGE.to));
    let step = table.optional(&RANGE.step);
    let count = table.integer(&RANGE.count);
    let refuse = |kind, key: &str, allowed: &str, message: &str, hint: &str| {
        table.complain(kind, key, allowed, message, hint);
        None
    };
    if from >= to {
        let (allowed, hint) = (format!("above {from}"), "swap `from` and `to`");
        return refuse(
            Conflict,
            "to",
            &allowed,
            "the range ends before it begins",
            hint,
        );
    }
    let either = "count or step";
    let numbers = match (table.has("count"), step) {
        (true, None) => evenly(from, to, count),
        (false, Some(step)) if (to - from) / step >= MAX_IN_RANGE as f64 => {
            let allowed = format!("up to {MAX_IN_RANGE} values");
            return refuse(
                TooLarge,
                "step",
                &allowed,
                "the range has too many values",
                "take a larger step",
            );
        }
        (false, Some(step)) => stepwise(from, to, step),
        (true, Some(_)) => {
            return refuse(
                Conflict,
                "step",
                either,
                "`step` with `count`",
                "keep one of them",
            );
        }
        (false, None) => {
            let message = "the range has neither `count` nor `step`";
            return refuse(Missing, "count", either, message, "add count = 5 or a step");
        }
    };
    if numbers.windows(2).any(|pair| pair[0] >= pair[1]) {
        let hint = "widen the range, or take fewer values";
        return refuse(
            Conflict,
            "to",
            "",
            "the values lie too close to each other",
            hint,
        );
    }
    let is_whole = numbers.iter().all(|x| x.is_finite());
    is_whole.then(|| numbers.into_iter().map(FactorValue::Number).collect())
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

fn distribution(s: &Section, of: Of, places: &mut Places) -> Option<Distribution> {
    if !s.has("distribution") {
        let _ = s.table("distribution"); // for the hints of mistyped keys
        return None;
    }
    let (name, t) = Values::choose(s, &FACTOR.distribution);
    places.add("distribution", s.place("distribution"));
    of.no_numbers(s, "distribution");
    let mut number = |row: &Key<'static>| {
        places.add_given(&t, row.name, &format!("distribution.{}", row.name));
        Values::number(&t, row)
    };
    let found = match name {
        "normal" => Distribution::Normal {
            mean: number(&NORMAL.mean),
            sd: number(&NORMAL.sd),
        },
        "truncated_normal" => Distribution::TruncatedNormal {
            mean: number(&TRUNCATED.mean),
            sd: number(&TRUNCATED.sd),
            low: number(&TRUNCATED.low),
            high: number(&TRUNCATED.high),
        },
        "uniform" => Distribution::Uniform {
            low: number(&UNIFORM.low),
            high: number(&UNIFORM.high),
        },
        "triangular" => Distribution::Triangular {
            low: number(&TRIANGULAR.low),
            mode: number(&TRIANGULAR.mode),
            high: number(&TRIANGULAR.high),
        },
        _ => Distribution::Lognormal {
            median: number(&LOGNORMAL.median),
            geometric_sd: number(&LOGNORMAL.geometric_sd),
        },
    };
    (fits(&t, &found, of.acts) && t.exists()).then_some(found)
}

/// Checks that the parameters of a distribution go together and reports if not. NaN marks parameters that were reported already.
fn fits(t: &Section, found: &Distribution, acts: Acts) -> bool {
    let refused = |kind, wrong: bool, key: &str, allowed: &str, message: &str, hint: &str| {
        if wrong {
            t.complain(kind, key, allowed, message, hint);
        }
        wrong
    };
    let spreads = |mean: f64, sd: f64| {
        let least = MIN_SPREAD * mean.abs();
        let (allowed, message) = (
            format!("at least {least:e}"),
            "the standard deviation is so small that nothing varies",
        );
        refused(OutOfRange, sd < least, "sd", &allowed, message, "");
        sd >= least
    };
    let ends = |low: f64, high: f64| {
        let far = (high - low).is_infinite();
        let allowed = format!("above {low}");
        let below = refused(
            Conflict,
            low >= high,
            "high",
            &allowed,
            "`high` is not above `low`",
            "",
        );
        let (allowed, message) = (
            "a finite distance from `low`",
            "`low` and `high` are too far apart",
        );
        refused(OutOfRange, !below && far, "high", allowed, message, "");
        low < high && (high - low).is_finite()
    };
    match *found {
        Distribution::Normal { mean, sd } => {
            let allowed = format!("up to {}, half of the mean", 0.5 * mean);
            let message = "the factors of a scale would reach zero";
            let wide = acts == Acts::Scale && sd > 0.5 * mean;
            let wide = refused(
                OutOfRange,
                wide,
                "sd",
                &allowed,
                message,
                "use lognormal or truncated_normal",
            );
            spreads(mean, sd) && !wide
        }
        Distribution::TruncatedNormal { mean, sd, .. } => {
            let (low, high) = found.support();
            if !(spreads(mean, sd) && ends(low, high)) {
                return false;
            }
            let (a, b) = found.standard_ends(mean, sd);
            let left = mass(a, b);
            let message = format!(
                "only {:.2} % of the normal distribution lie between `low` and `high`",
                100.0 * left
            );
            let hint = "move the mean, or use uniform or triangular";
            refused(
                Conflict,
                left < MIN_LEFT,
                "low",
                "at least 1 %",
                &message,
                hint,
            );
            left >= MIN_LEFT
        }
        Distribution::Uniform { low, high } => ends(low, high),
        Distribution::Triangular { low, mode, high } => {
            let fits = ends(low, high);
            let outside = fits && (mode < low || mode > high);
            let message = "the most likely value lies outside `low` to `high`";
            refused(
                OutOfRange,
                outside,
                "mode",
                &format!("{low} to {high}"),
                message,
                "",
            );
            fits && low <= mode && mode <= high
        }
        Distribution::Lognormal {
            median,
            geometric_sd,
        } => median.is_finite() && geometric_sd.is_finite(),
    }
}
