//! Titles of figures: sentences with numbers of their table, each used only where it is true.

use crate::number::{grouped, list_of};
use cvtcycle_analysis::words::{between, decimals, more_or_less, than};

/// "7 % more than the baseline", with the digits that the interval supports.
pub fn against(percent: f64, interval: Option<[f64; 2]>, baseline: &str) -> String {
    let compared = more_or_less(percent, interval.map_or(1, decimals));
    format!("{compared} {} {baseline}", than(&compared))
}

/// "+1 to +10 %".
pub fn level(interval: [f64; 2]) -> String {
    between(interval, "%")
}

/// Title of the strip of the answer.
pub(super) fn strip(
    subject: &str,
    first: Option<(&str, f64, Option<[f64; 2]>)>,
    is_by_cars: bool,
) -> String {
    let Some((baseline, percent, interval)) = first else {
        return format!("{subject} has no car to compare it with");
    };
    let compared = against(percent, interval, baseline);
    match interval {
        None => format!("{subject} uses {compared}; no range is claimed"),
        Some(ends @ [low, high]) if low < 0.0 && high > 0.0 => {
            let [least, most] = ends.map(|end| more_or_less(end, decimals(ends)));
            let nominal = more_or_less(percent, decimals(ends));
            match [&least, &most].iter().any(|of| *of == "as much") {
                true => format!("{subject} uses {compared}; {} are possible", level(ends)),
                false => format!(
                    "{subject} uses between {least} and {most} than {baseline}; {nominal} with nominal values"
                ),
            }
        }
        Some(ends) => {
            let among = match is_by_cars {
                true => "by the error of the model on measured cars",
                false => "with uncertain inputs varied",
            };
            format!("{subject} uses {compared}; {among} {}", level(ends))
        }
    }
}

/// Title of the change from the fuel of a baseline to that of the subject; `terms` in kJ/km and descending size. It states no difference, since
/// that has a range, which is with the answer.
pub(super) fn waterfall(names: [&str; 2], terms: &[(String, f64)]) -> String {
    let [subject, baseline] = names;
    let named = terms.iter().filter(|(_, x)| x.abs() >= 0.5).take(2);
    let named: Vec<String> = named
        .map(|(name, kj)| {
            let word = if *kj < 0.0 { "less" } else { "more" };
            format!("{word} for {name}")
        })
        .collect();
    if named.is_empty() {
        return format!("No term differs between {subject} and {baseline}");
    }
    let named = list_of(&named);
    format!("Fuel of {subject} against {baseline}: {named}")
}

/// Title of the repeated part of a cycle, from all losses of each drive and those of each group in the first and last one.
pub(super) fn repeats(totals: &[f64], parts: &[(String, [f64; 2])]) -> String {
    let (Some(first), Some(last)) = (totals.first(), totals.last()) else {
        return "No part of the cycle is driven twice".to_owned();
    };
    let word = if last < first { "cuts" } else { "raises" };
    let [first, last] = [first, last].map(|kj| grouped(*kj, 0));
    let drop = |part: &&(String, [f64; 2])| part.1[0] - part.1[1];
    let largest = parts.iter().max_by(|a, b| drop(a).total_cmp(&drop(b)));
    let largest = largest.filter(|part| drop(part) > 0.0);
    let largest = largest.map_or_else(String::new, |(name, ends)| {
        let [a, b] = ends.map(|kj| grouped(kj, 0));
        format!(", {name} most ({a} to {b})")
    });
    format!("Warmer oil {word} the loss of the same drive from {first} to {last} kJ{largest}")
}

/// Title of the spread that remains when a factor is known.
pub(super) fn information(best: Option<(&str, f64, f64)>, unit: &str) -> String {
    match best {
        Some((name, sd, left)) => {
            let digits = decimals([0.0, sd]) + 1;
            let [sd, left] = [sd, left].map(|x| grouped(x, digits));
            format!(
                "Knowing the {name} would cut the standard deviation from {sd} to {left} {unit}"
            )
        }
        None => "No single value is above chance: more runs first".to_owned(),
    }
}

/// Title of the published and computed numbers.
pub(super) fn agreement(agree: usize, all: usize) -> String {
    format!(
        "{agree} of {all} published numbers that nothing was fitted to agree within their tolerance"
    )
}
