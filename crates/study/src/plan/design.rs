//! The design of a plan, and what concerns all its factors at once.

use super::{Cars, Design, Factor, FactorValues, Places, Plan, options};
use crate::design::{MAX_SOBOL_DIMENSIONS, MAX_SOBOL_SAMPLES};
use cvtcycle_config::{Bound, Problem, Problems, Section, readable, unit_of};

/// Designs.
const DESIGNS: [&str; 6] = [
    "grid",
    "one_at_a_time",
    "latin_hypercube",
    "sobol",
    "monte_carlo",
    "saltelli",
];
/// Most samples of a design without a limit of its own.
const MAX_SAMPLES: u64 = 1_000_000_000;

impl Design {
    /// Numbers of samples that it may have; none for a design without samples.
    #[must_use]
    pub fn sample_range(&self) -> Option<std::ops::RangeInclusive<u64>> {
        match self {
            Design::Grid | Design::OneAtATime { .. } => None,
            Design::LatinHypercube { .. } | Design::MonteCarlo { .. } => Some(2..=MAX_SAMPLES),
            Design::Sobol { .. } | Design::Saltelli { .. } => Some(2..=MAX_SOBOL_SAMPLES),
        }
    }
}

/// Reads the design; meaningless if one of its problems was reported.
pub(super) fn read(study: &Section, places: &mut Places) -> Design {
    let (name, d) = study.choose("design", &DESIGNS, None, "which combinations are driven");
    places.add_given(study, "design", "design");
    match name {
        "grid" => return Design::Grid,
        "one_at_a_time" => {
            let quantile = d.number_or(
                "quantile",
                Bound::closed(1e-6, 0.49),
                0.05,
                "lower quantile of distributions; the upper one is 1 - it",
            );
            return Design::OneAtATime { quantile };
        }
        _ => {}
    }
    places.add_given(&d, "samples", "design.samples");
    let count = d.number(
        "samples",
        Bound::closed(2.0, MAX_SAMPLES as f64),
        "number of samples",
    );
    let samples = count as u64;
    if count.is_finite() && (samples as f64 - count).abs() > 0.0 {
        d.complain(
            "samples",
            "a whole number",
            "`samples` is no whole number",
            "",
        );
    }
    if matches!(name, "sobol" | "saltelli") && samples > MAX_SOBOL_SAMPLES {
        let hint = if name == "sobol" {
            "use latin_hypercube for more"
        } else {
            "more are seldom of use; monte_carlo draws any number"
        };
        d.complain(
            "samples",
            &format!("2 to {MAX_SOBOL_SAMPLES}"),
            "the Sobol sequence is not that long",
            hint,
        );
    }
    let seed = d.integer_or("seed", 0..=i64::MAX, 1, "seed").unsigned_abs();
    match name {
        "latin_hypercube" => Design::LatinHypercube { samples, seed },
        "sobol" => Design::Sobol { samples, seed },
        "monte_carlo" => Design::MonteCarlo { samples, seed },
        _ => Design::Saltelli { samples, seed },
    }
}

/// What is wrong between factors.
pub(super) fn clashes(factors: &[Factor]) -> Problems {
    let mut problems = Problems::new();
    for (k, factor) in factors.iter().enumerate() {
        let overlaps = |other: &Factor| {
            other.cars == factor.cars || other.cars == Cars::All || factor.cars == Cars::All
        };
        if let Some(first) = factors[..k]
            .iter()
            .find(|other| other.key == factor.key && overlaps(other))
        {
            let message = format!(
                "`{}` is varied twice for the same car, first in line {}",
                factor.key, first.place.line
            );
            let hint =
                "join them, or give one `cars = \"subject\"` and the other `cars = \"baselines\"`";
            problems.push(problem(factor, "key", &message, hint));
        } else if let Some(first) = factors[..k].iter().find(|other| other.name == factor.name) {
            let message = format!(
                "the name `{}` was used before, by the factor in line {}",
                factor.name, first.place.line
            );
            problems.push(problem(factor, "name", &message, "names are unique"));
        }
    }
    problems
}

fn problem(factor: &Factor, key: &str, message: &str, hint: &str) -> Problem {
    // What is not given follows from the key.
    let place = if factor.places.of(key) == factor.places.of("") {
        &factor.place
    } else {
        factor.places.of(key)
    };
    Problem::invalid(message)
        .at(place.clone())
        .key(key)
        .hint(hint)
}

/// What is wrong between the design and a number of factors, of which those in `read` could be read.
pub(super) fn limits(design: &Design, number: usize, read: &[Factor], places: &Places) -> Problems {
    let mut problems = Problems::new();
    let mut add = |place, key: &str, allowed: String, message: String, hint: &str| {
        let (key, hint) = (key.to_owned(), hint.to_owned());
        problems.push(
            Problem::invalid(message)
                .at(place)
                .key(key)
                .allowed(allowed)
                .hint(hint),
        );
    };
    let at = || places.of("design").clone();
    if number == 0 && *design != Design::Grid {
        let allowed = "at least one [[factor]]".to_owned();
        add(
            at(),
            "study.design",
            allowed,
            "nothing is varied".into(),
            "add a [[factor]], or use the design `grid` for the base alone",
        );
    }
    let dimensions = match design {
        Design::Sobol { .. } => number,
        Design::Saltelli { .. } => 2 * number,
        _ => 0,
    };
    if dimensions > MAX_SOBOL_DIMENSIONS {
        let most = MAX_SOBOL_DIMENSIONS * number / dimensions;
        add(
            at(),
            "study.design",
            format!("up to {most} factors"),
            format!("{number} factors are too many for this design"),
            "leave some out",
        );
    }
    if *design == Design::Grid {
        for factor in read
            .iter()
            .filter(|factor| matches!(factor.values, FactorValues::Distribution(_)))
        {
            let message = format!(
                "factor {}: a distribution has no values for a grid",
                factor.key
            );
            add(
                factor.places.of("distribution").clone(),
                "distribution",
                "values or range".into(),
                message,
                "give `values` or a `range`",
            );
        }
    }
    if read.len() == number && design.points(read).is_none() {
        add(
            at(),
            "study.design",
            String::new(),
            "the design has more points than can be counted".into(),
            "take fewer values or factors",
        );
    }
    problems
}

/// What only a whole plan shows: distributions of run options that leave their range, and factors of cars that do not exist.
pub(super) fn reach(plan: &Plan) -> Problems {
    let mut problems = Problems::new();
    for (k, factor) in plan.factors.iter().enumerate() {
        if factor.cars == Cars::Baselines && plan.base.baselines.as_ref().is_some_and(Vec::is_empty)
        {
            let message = format!("factor {}: there are no baselines", factor.key);
            problems.push(problem(
                factor,
                "cars",
                &message,
                "name them in `baselines`, or remove the factor",
            ));
        }
        let (Some(bound), FactorValues::Distribution(_), Some((low, high))) =
            (options::bound(&factor.key), &factor.values, plan.span(k))
        else {
            continue;
        };
        if !(bound.contains(low) && bound.contains(high)) {
            let message = format!(
                "factor {}: the draws go from {} to {}",
                factor.key,
                readable(low, 4),
                readable(high, 4)
            );
            let allowed = bound.in_unit(unit_of(options::quantity(&factor.key)));
            let hint = "use truncated_normal, uniform or triangular".to_owned();
            let place = factor.places.of("distribution").clone();
            problems.push(
                Problem::invalid(message)
                    .at(place)
                    .key("distribution")
                    .allowed(allowed)
                    .hint(hint),
            );
        }
    }
    problems
}
