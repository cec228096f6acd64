//! Every value of a factor tried by itself, before anything starts.

use super::cars::{Binding, CarVariant, StudyCar, words};
use crate::plan::{Acts, Distribution, Factor, FactorValues, Plan};
use cvtcycle_config::{Place, Problem, Problems};

/// Notes the problems of a factor: a key that a car does not know, values that its files do not allow.
pub(super) fn factor(plan: &Plan, index: usize, cars: &[StudyCar], problems: &mut Problems) {
    let factor = &plan.factors[index];
    for car in cars {
        match car.bindings[index] {
            // Clipped values are always in range; other faults show at the points.
            Binding::Number(_) if plan.clip => {}
            Binding::Number(acts) => numbers(plan, index, car, acts, problems),
            Binding::Words { stride } => variants(plan, index, car, stride, problems),
            Binding::Not | Binding::Ambient | Binding::Start | Binding::Cycle | Binding::Step => {}
        }
    }
    let is_not = |car: &StudyCar| car.bindings[index] == Binding::Not;
    if cars.iter().all(is_not) && !cars.is_empty() && !plan.skip_missing {
        let message = "the study has no baseline, so no car has this factor";
        let problem = Problem::conflict(message)
            .at(place(factor, None))
            .key(factor.key.as_str());
        problems.push(problem.hint("name baselines, or give `cars = \"subject\"`"));
    }
}

fn numbers(plan: &Plan, index: usize, car: &StudyCar, acts: Acts, problems: &mut Problems) {
    let factor = &plan.factors[index];
    // The car itself has been checked before.
    let Ok(variant) = car.variant(0, &plan.factors) else {
        return;
    };
    let unknown = variant
        .unknown
        .iter()
        .filter(|(unknown, _)| *unknown == index);
    problems.extend(unknown.map(|(_, problem)| problem.clone()));
    let Some(param) = &variant.params[index] else {
        return;
    };
    for (entry, number) in extremes(plan, index) {
        let value = car.drawn(index, acts, param.base(), number);
        let Err(found) = variant.base.with_numbers(&[(param, value)]) else {
            continue;
        };
        if goes_with_another(plan, index, car, variant, value) {
            continue;
        }
        let of_value = |problem| of_value(factor, (entry, number), car, value, problem);
        problems.extend(found.map(of_value));
    }
}

/// True if a value that is refused by itself is accepted with some value of another factor: the points then report it.
fn goes_with_another(
    plan: &Plan,
    index: usize,
    car: &StudyCar,
    variant: &CarVariant,
    value: f64,
) -> bool {
    let possible = |other: usize| {
        let params = (&variant.params[index], &variant.params[other]);
        let ((Some(param), Some(partner)), Binding::Number(acts)) = (params, car.bindings[other])
        else {
            return false;
        };
        extremes(plan, other).into_iter().any(|(_, number)| {
            let of_partner = car.drawn(other, acts, partner.base(), number);
            let numbers = [(param, value), (partner, of_partner)];
            variant.base.with_numbers(&numbers).is_ok()
        })
    };
    (0..plan.factors.len()).any(|other| other != index && possible(other))
}

fn of_value(
    factor: &Factor,
    (entry, number): (Option<usize>, f64),
    car: &StudyCar,
    value: f64,
    problem: Problem,
) -> Problem {
    let by = match factor.acts {
        Acts::Value => String::new(),
        Acts::Scale => format!(", the file's value times {number},"),
        Acts::Offset => format!(", the file's value and {number},"),
    };
    let unit = match cvtcycle_config::unit_of(&factor.key) {
        "-" => String::new(),
        unit => format!(" {unit}"),
    };
    let tail = matches!(
        factor.values,
        FactorValues::Distribution(Distribution::Normal { .. } | Distribution::Lognormal { .. })
    );
    let hint = match tail && problem.hint.is_empty() {
        true => {
            "the distribution has no ends: cut it with truncated_normal, or give a smaller spread"
        }
        false => &problem.hint,
    };
    let (name, message) = (&car.name, &problem.message);
    let message = format!("{name}: {value}{unit}{by} is not possible: {message}");
    Problem {
        names_key: problem.names_key && problem.key == factor.key,
        ..Problem::new(problem.kind, message)
            .at(place(factor, entry))
            .key(factor.key.as_str())
            .value(number.to_string())
            .allowed(problem.allowed.as_str())
            .hint(hint)
    }
}

fn variants(plan: &Plan, index: usize, car: &StudyCar, stride: usize, problems: &mut Problems) {
    let factor = &plan.factors[index];
    for (k, word) in words(factor).iter().enumerate() {
        let Err(found) = car.variant((k + 1) * stride, &plan.factors) else {
            continue;
        };
        problems.extend(found.iter().map(|problem| {
            let own = &problem.place;
            let at = match own.line > 0 {
                true => own.clone(),
                false => place(factor, Some(k)),
            };
            let problem = problem.clone().with_context(&format!("{}: ", car.name));
            problem
                .at(at)
                .key(factor.key.as_str())
                .value(word.to_string())
        }));
    }
}

/// Every entry of a list; the ends of a distribution, or, where it has none, the least and largest value that the design reaches.
fn extremes(plan: &Plan, index: usize) -> Vec<(Option<usize>, f64)> {
    match &plan.factors[index].values {
        FactorValues::List(list) => {
            let entries = list.iter().enumerate();
            entries
                .filter_map(|(k, value)| Some((Some(k), value.number()?)))
                .collect()
        }
        FactorValues::Distribution(distribution) => {
            let (low, high) = distribution.support();
            let ends = match low.is_finite() && high.is_finite() {
                true => Some((low, high)),
                false => plan.span(index),
            };
            ends.into_iter()
                .flat_map(|(low, high)| [(None, low), (None, high)])
                .collect()
        }
    }
}

fn place(factor: &Factor, entry: Option<usize>) -> Place {
    let key = match factor.values {
        FactorValues::Distribution(_) => "distribution",
        FactorValues::List(_) => "values",
    };
    let place = match entry {
        Some(entry) => factor.places.nth(key, entry),
        None => factor.places.place(key),
    };
    place.clone()
}
