//! Every value of a factor tried by itself, before anything starts.

use super::cars::{Binding, CarVariant, StudyCar, words};
use super::plan::{Acts, Distribution, Factor, FactorValue, FactorValues, Plan};
use cvtcycle_config::{Place, Problem, Problems};

/// Notes the problems of a factor: a key that a car does not know, values that its files do not allow.
pub(super) fn factor(plan: &Plan, index: usize, cars: &[StudyCar], problems: &mut Problems) {
    let factor = &plan.factors[index];
    let mut reached = false;
    for car in cars {
        reached |= car.bindings[index] != Binding::Not;
        match car.bindings[index] {
            Binding::Number(acts) => numbers(plan, index, car, acts, problems),
            Binding::Words { stride } => variants(plan, index, car, stride, problems),
            Binding::Not | Binding::Ambient | Binding::Start | Binding::Cycle | Binding::Step => {}
        }
    }
    if !reached && !cars.is_empty() {
        let problem = at(
            factor,
            None,
            "the study has no baseline, so no car has this factor",
        );
        problems.push(problem.hint("name baselines, or give `cars = \"subject\"`"));
    }
}

/// What a number makes of the value of the car's file.
pub(super) fn resolved(acts: Acts, base: f64, number: f64) -> f64 {
    match acts {
        Acts::Value => number,
        Acts::Scale => base * number,
        Acts::Offset => base + number,
    }
}

fn numbers(plan: &Plan, index: usize, car: &StudyCar, acts: Acts, problems: &mut Problems) {
    let factor = &plan.factors[index];
    // The car itself has been checked before.
    let Ok(variant) = car.variant(0, &plan.factors) else {
        return;
    };
    problems.extend(
        variant
            .unknown
            .iter()
            .filter(|(unknown, _)| *unknown == index)
            .map(|(_, problem)| problem.clone()),
    );
    let Some(slot) = &variant.slots[index] else {
        return;
    };
    let mut bench = variant.blueprint.bench();
    for (entry, number) in extremes(plan, index) {
        let value = resolved(acts, slot.base(), number);
        bench.reset();
        bench.set(slot, value);
        if bench.build().is_ok() || goes_with_another(plan, index, car, variant, value) {
            continue;
        }
        for problem in bench.problems() {
            problems.push(of_value(factor, entry, car, number, value, problem));
        }
    }
}

/// Whether a value that is not possible by itself is so with some value of another factor: then it is for the points to tell.
fn goes_with_another(
    plan: &Plan,
    index: usize,
    car: &StudyCar,
    variant: &CarVariant,
    value: f64,
) -> bool {
    let mut bench = variant.blueprint.bench();
    let mut possible = |other: usize, number: f64| {
        let (Some(slot), Some(partner), Binding::Number(acts)) = (
            &variant.slots[index],
            &variant.slots[other],
            car.bindings[other],
        ) else {
            return false;
        };
        bench.reset();
        bench.set(slot, value);
        bench.set(partner, resolved(acts, partner.base(), number));
        bench.build().is_ok()
    };
    let others = (0..plan.factors.len()).filter(|other| *other != index);
    others
        .flat_map(|other| {
            extremes(plan, other)
                .into_iter()
                .map(move |(_, number)| (other, number))
        })
        .any(|(other, number)| possible(other, number))
}

fn of_value(
    factor: &Factor,
    entry: Option<usize>,
    car: &StudyCar,
    number: f64,
    value: f64,
    problem: Problem,
) -> Problem {
    let by = match factor.acts {
        Acts::Value => String::new(),
        Acts::Scale => format!(", the file's value times {number},"),
        Acts::Offset => format!(", the file's value and {number},"),
    };
    let unit = super::prepare::key_unit(&factor.key);
    let unit = if unit == "-" {
        unit.replace('-', "")
    } else {
        format!(" {unit}")
    };
    let tail = matches!(
        factor.values,
        FactorValues::Distribution(Distribution::Normal { .. } | Distribution::Lognormal { .. })
    );
    let hint = if tail && problem.hint.is_empty() {
        "the distribution has no ends: cut it with truncated_normal, or give a smaller spread"
            .to_owned()
    } else {
        problem.hint
    };
    Problem::invalid(format!(
        "{}: {value}{unit}{by} is not possible: {}",
        car.name, problem.message
    ))
    .at(place(factor, entry))
    .key(factor.key.clone())
    .value(number.to_string())
    .allowed(problem.allowed)
    .hint(hint)
}

fn variants(plan: &Plan, index: usize, car: &StudyCar, stride: usize, problems: &mut Problems) {
    let factor = &plan.factors[index];
    for (k, word) in words(factor).iter().enumerate() {
        let Err(found) = car.variant((k + 1) * stride, &plan.factors) else {
            continue;
        };
        for problem in found {
            problems.push(
                problem
                    .clone()
                    .at(if problem.place.line > 0 {
                        problem.place.clone()
                    } else {
                        place(factor, Some(k))
                    })
                    .key(factor.key.clone())
                    .value(word.to_string())
                    .message(format!("{}: {}", car.name, problem.message)),
            );
        }
    }
}

/// Every entry of a list; the ends of a distribution, or, where it has none, the least and largest value that the design reaches.
fn extremes(plan: &Plan, index: usize) -> Vec<(Option<usize>, f64)> {
    match &plan.factors[index].values {
        FactorValues::List(list) => {
            let number = |(k, value): (usize, &FactorValue)| match value {
                FactorValue::Number(x) => Some((Some(k), *x)),
                FactorValue::Word(_) => None,
            };
            list.iter().enumerate().filter_map(number).collect()
        }
        FactorValues::Distribution(distribution) => {
            let (low, high) = distribution.support();
            let tails = if low.is_finite() && high.is_finite() {
                None
            } else {
                Some(plan.design.share_span(&plan.factors, index))
            };
            let (low, high) = tails.map_or((low, high), |(low, high)| {
                (
                    distribution.inverse_cdf(low),
                    distribution.inverse_cdf(high),
                )
            });
            vec![(None, low), (None, high)]
        }
    }
}

fn at(factor: &Factor, entry: Option<usize>, message: &str) -> Problem {
    Problem::invalid(message)
        .at(place(factor, entry))
        .key(factor.key.clone())
}

fn place(factor: &Factor, entry: Option<usize>) -> Place {
    let key = if matches!(factor.values, FactorValues::Distribution(_)) {
        "distribution"
    } else {
        "values"
    };
    entry
        .map_or_else(
            || factor.places.of(key),
            |entry| factor.places.nth(key, entry),
        )
        .clone()
}
