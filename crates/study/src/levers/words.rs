//! The answer of a lever study in sentences.

use super::{LeverAnswer, LeverBlock, LeverRow};
use cvtcycle_output::number::{fixed, signed};

/// What a car's levers save, the first lines of the answer.
pub fn answer_in_words(answer: &LeverAnswer, block: &LeverBlock) -> Vec<String> {
    let mut sentences = Vec::new();
    let fuel = fixed(block.fuel_l_per_100km, 2);
    let single = || block.rows.iter().filter(|row| !row.is_combination());
    match single().find(|row| row.fuel_percent.value < 0.0) {
        Some(best) => {
            let (name, change) = (&best.of.title, change(answer, best));
            sentences.push(format!("{fuel} L/100 km; {name} saves most: {change}."));
        }
        None => sentences.push(format!("{fuel} L/100 km; no lever saves fuel.")),
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
    for row in block.rows.iter().filter(|row| row.is_combination()) {
        let (list, change) = (row.of.members.join(" + "), change(answer, row));
        let sum = signed(row.sum_percent, 2);
        sentences.push(format!(
            "Together ({list}): {change}; the sum of the single ones is {sum} %."
        ));
    }
    sentences
}

/// Median, range and certainty of a change.
fn change(answer: &LeverAnswer, row: &LeverRow) -> String {
    let median = signed(row.fuel_percent.value, 2);
    let Some(_) = answer.plan else {
        return format!("{median} % fuel");
    };
    let [low, high] = [row.low_percent, row.high_percent].map(|end| signed(end.value, 2));
    let (k, n) = (row.saves.k, row.saves.n);
    let share = row.saves.interval.map_or(f64::NAN, |[low, _]| low);
    let (share, draws) = (fixed(100.0 * share, 0), answer.confidence.draws_percent());
    format!(
        "{median} % fuel, {draws} % of the draws from {low} to {high}, less in {k} of {n}: in at least {share} % of all cases"
    )
}
