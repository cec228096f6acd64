//! The answer of a lever study in sentences.

use super::{Between, LeverAnswer, LeverBlock, LeverRow};
use crate::words::{between, decimals, of_cars};
use cvtcycle_output::number::{fixed, signed};

/// Describes the savings of a car's levers: the first lines of the answer.
pub fn answer_in_words(answer: &LeverAnswer, block: &LeverBlock) -> Vec<String> {
    let mut sentences = Vec::new();
    let fuel = fixed(block.fuel_l_per_100km, 2);
    let range = block.fleet.as_ref().map_or_else(String::new, of_cars);
    let of_runs = match answer.plan {
        Some(_) => format!(
            " in the median of {} runs with uncertain values varied",
            block.n
        ),
        None => String::new(),
    };
    let all = || block.rows.iter().filter(|row| !row.is_combination());
    // Levers that mostly fail are left out: the few draws that remain prove nothing.
    let single = || all().filter(|row| !row.does_not_work());
    match single().find(|row| row.fuel_percent.value < 0.0) {
        Some(best) => {
            let (name, change) = (&best.of.title, change(answer, best));
            sentences.push(format!(
                "{fuel} L/100 km{range}{of_runs}; {name} saves most: {change}."
            ));
        }
        None => sentences.push(format!(
            "{fuel} L/100 km{range}{of_runs}; no lever saves fuel."
        )),
    }
    let is_open = |row: &&LeverRow| {
        let interval = row.saves.interval;
        interval.is_some_and(|[low, high]| low < 0.5 && high > 0.5)
    };
    let open: Vec<&str> = match answer.plan {
        Some(_) => single()
            .filter(is_open)
            .map(|row| row.of.name.as_str())
            .collect(),
        None => Vec::new(),
    };
    if !open.is_empty() {
        let list = open.join(", ");
        sentences.push(format!("It is open whether these save: {list}."));
    }
    for row in single().filter(|row| row.depends_on_form()) {
        sentences.push(by_form(row));
    }
    for row in all().filter(|row| row.does_not_work()) {
        let (name, draws) = (&row.of.name, row.failed + row.n);
        let why = why(&row.reasons);
        sentences.push(match answer.plan {
            Some(_) => format!(
                "{name} does not work in this car: {why} in {} of {draws} runs.",
                row.failed
            ),
            None => format!("{name} does not work in this car: {why}."),
        });
    }
    if answer.plan.is_some() && block.failed > 0 {
        let (failed, n, why) = (block.failed, block.n, why(&block.reasons));
        sentences.push(format!(
            "In {failed} of {n} runs the car as it is fails by {why}; they are left out."
        ));
    }
    if answer.plan.is_some() {
        sentences.extend(block.between.iter().map(against_each_other));
    }
    for row in block.rows.iter().filter(|row| row.is_combination()) {
        let (list, change) = (row.of.members.join(" + "), change(answer, row));
        let sum = signed(row.sum_percent, 2);
        sentences.push(format!(
            "Together ({list}): {change}; the sum of the single ones is {sum} %."
        ));
    }
    sentences
}

/// The change of a lever in each form of a law, in a sentence.
fn by_form(row: &LeverRow) -> String {
    let of_forms = row.by_form.iter();
    let of_forms =
        of_forms.map(|of| format!("{} % with {}", signed(of.median_percent, 2), of.title));
    let list = of_forms.collect::<Vec<_>>().join(", ");
    let end = match row.is_open_by_form() {
        true => "; the form decides whether it saves",
        false => "; the form decides how much",
    };
    format!("{} by the form of the law: {list}{end}.", row.of.title)
}

/// Two levers against each other in a sentence.
fn against_each_other(of: &Between) -> String {
    let [first, second] = &of.titles;
    let ends = [of.percent[0], of.percent[2]];
    let (k, n) = (of.better.k, of.better.n);
    let verdict = match (ends[1] < 0.0, ends[0] > 0.0) {
        (true, _) | (_, true) => "",
        _ => ": which of them saves more is open",
    };
    format!(
        "{first} against {second}: {} fuel ({}), less in {k} of {n}{verdict}.",
        signed(of.percent[1], decimals(ends)) + " %",
        between(ends, "%")
    )
}

/// Names of the failed checks.
fn why(reasons: &[(String, usize)]) -> String {
    let names: Vec<&str> = reasons.iter().map(|(name, _)| name.as_str()).collect();
    names.join(", ")
}

/// Median, range and certainty of a change.
fn change(answer: &LeverAnswer, row: &LeverRow) -> String {
    let median = signed(row.fuel_percent.value, 2);
    let Some(_) = answer.plan else {
        return format!("{median} % fuel (without draws no interval)");
    };
    let [low, high] = [row.low_percent, row.high_percent].map(|end| signed(end.value, 2));
    let (k, n) = (row.saves.k, row.saves.n);
    let share = row.saves.interval.map_or(f64::NAN, |[low, _]| low);
    // Rounded down, as where the number of draws is doubted: no more is shown than there is.
    let (share, draws) = (
        fixed((100.0 * share).floor(), 0),
        answer.confidence.draws_percent(),
    );
    format!(
        "{median} % fuel, {draws} % of these runs from {low} to {high}, less in {k} of {n}: in at least {share} % of all cases"
    )
}
