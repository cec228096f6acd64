//! Problems of a car made of some numbers, under the options that gave them.

use super::Answers;
use super::rules::{Line, PLAIN};
use crate::document::target::rows;
use crate::{Place, Problem, Problems};

/// Problems of the car of some lines under the options that gave them. What follows from a wrong number is not said of the rest.
pub(super) fn under_options(found: Problems, lines: &[Line], answers: &Answers) -> Problems {
    let line_of = |problem: &Problem| lines.iter().find(|line| line.key == problem.key);
    let option_of = |problem: &Problem| line_of(problem).and_then(|line| line.option);
    let is_of_option = found.iter().any(|problem| option_of(problem).is_some());
    let of_others = |problem: &Problem| is_of_option && option_of(problem).is_none();
    let kept = found
        .into_iter()
        .filter(|problem| !(of_others(problem) && line_of(problem).is_some()));
    let named = |problem: Problem| {
        let Some(option) = option_of(&problem) else {
            return problem;
        };
        let text = answers.numbers.get(option).map_or("", String::as_str);
        let hint = other_unit(option, text).unwrap_or_default();
        let problem = problem.at(Place::file(&answers.file)).key(option);
        problem.value(text).hint(hint)
    };
    kept.map(named).collect()
}

/// "did you mean 1.8l?" of a number without a unit that is out of range, and is not in another unit.
fn other_unit(option: &str, text: &str) -> Option<String> {
    let (_, key, units) = PLAIN.iter().find(|(own, ..)| *own == option)?;
    let number: f64 = text.trim().parse().ok()?;
    let (_, row) = rows().find(|(path, _)| path == key)?;
    let mut others = units
        .0
        .iter()
        .filter(|(_, size)| row.range().contains(number * size));
    others
        .next()
        .map(|(names, _)| format!("did you mean {}{}?", text.trim(), names[0]))
}
