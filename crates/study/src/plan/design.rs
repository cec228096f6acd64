//! The design of a plan, and what concerns all its factors at once.

use super::keys::{self, MAX_SAMPLES, ONE_AT_A_TIME, SAMPLE, STUDY};
use super::{Acts, Cars, Design, Factor, FactorValues, Places, Plan};
use cvtcycle_config::ProblemKind::{self, Conflict, Duplicate, Missing, OutOfRange, TooLarge};
use cvtcycle_config::{Override, Problem, Problems, Section, readable};
use cvtcycle_model::keys::Values;

/// Most samples of a Sobol sequence: the length of the tables behind it.
pub const MAX_SOBOL_SAMPLES: u64 = 1 << 16;

/// Most dimensions of a Sobol sequence; Saltelli's design needs two a factor.
pub const MAX_SOBOL_DIMENSIONS: usize = sobol_burley::NUM_DIMENSIONS as usize;

impl Design {
    /// Numbers of samples that it may have; none for a design without samples.
    pub fn sample_range(&self) -> Option<std::ops::RangeInclusive<u64>> {
        match self {
            Design::Grid | Design::OneAtATime { .. } => None,
            Design::LatinHypercube { .. } | Design::MonteCarlo { .. } => Some(2..=MAX_SAMPLES),
            Design::Sobol { .. } | Design::Saltelli { .. } => Some(2..=MAX_SOBOL_SAMPLES),
        }
    }

    /// The design with another number of samples and another seed, where they are given.
    ///
    /// # Errors
    /// A problem with the key `samples` or `seed`: a design that draws nothing, or a number out of range.
    pub fn changed(&self, samples: Option<u64>, seed: Option<u64>) -> Result<Design, Problem> {
        let key = match (samples, seed) {
            (None, None) => return Ok(*self),
            (Some(_), _) => "samples",
            (None, Some(_)) => "seed",
        };
        let (Some(range), Some(changed)) = (self.sample_range(), self.with(samples, seed)) else {
            let problem = Problem::invalid("the design of the plan draws no samples").key(key);
            return Err(problem.hint(
                "samples and seed are for Latin hypercube, Sobol, Monte Carlo and Saltelli designs",
            ));
        };
        match samples {
            Some(samples) if !range.contains(&samples) => {
                let message = format!("{samples} samples are out of range for this design");
                let problem = Problem::invalid(message)
                    .key(key)
                    .value(samples.to_string());
                let problem = problem.allowed(format!("{} to {}", range.start(), range.end()));
                Err(problem.hint(format!("the nearest allowed value is {}", range.end())))
            }
            _ => Ok(changed),
        }
    }
}

/// Reads the design; meaningless if one of its problems was reported.
pub(super) fn read(study: &Section, places: &mut Places) -> Design {
    let (name, d) = Values::choose(study, &STUDY.design);
    places.add_given(study, "design", "design");
    match name {
        "grid" => return Design::Grid,
        "one_at_a_time" => {
            let quantile = Values::number(&d, &ONE_AT_A_TIME.quantile);
            return Design::OneAtATime { quantile };
        }
        _ => {}
    }
    places.add_given(&d, "samples", "design.samples");
    let count = Values::number(&d, &SAMPLE.samples);
    let samples = count as u64;
    if count.is_finite() && (samples as f64 - count).abs() > 0.0 {
        d.mistyped(
            "samples",
            "a whole number",
            "`samples` is no whole number",
            "",
        );
    }
    if matches!(name, "sobol" | "saltelli") && samples > MAX_SOBOL_SAMPLES {
        let hint = match name {
            "sobol" => "use latin_hypercube for more",
            _ => "more are seldom of use; monte_carlo draws any number",
        };
        let allowed = format!("2 to {MAX_SOBOL_SAMPLES}");
        d.too_large(
            "samples",
            &allowed,
            "the Sobol sequence is not that long",
            hint,
        );
    }
    let seed = d.integer(&SAMPLE.seed).unsigned_abs();
    match name {
        "latin_hypercube" => Design::LatinHypercube { samples, seed },
        "sobol" => Design::Sobol { samples, seed },
        "monte_carlo" => Design::MonteCarlo { samples, seed },
        _ => Design::Saltelli { samples, seed },
    }
}

/// Finds conflicts between factors.
pub(super) fn clashes(factors: &[Factor]) -> Problems {
    let mut problems = Problems::new();
    for (k, factor) in factors.iter().enumerate() {
        let earlier = |is_like: &dyn Fn(&Factor) -> bool| {
            let found = factors[..k].iter().find(|other| is_like(other));
            found.map(|other| other.place.line)
        };
        let overlaps = |other: &Factor| {
            let is_apart = match (&other.form, &factor.form) {
                (Some(a), Some(b)) => a.name != b.name,
                _ => false,
            };
            let is_shared = [other.cars, factor.cars].contains(&Cars::All);
            !is_apart && (other.cars == factor.cars || is_shared)
        };
        if let Some(line) = earlier(&|other| other.key == factor.key && overlaps(other)) {
            let message = format!(
                "`{}` is varied twice for the same car, first in line {line}",
                factor.key
            );
            let hint =
                "join them, or give one `cars = \"subject\"` and the other `cars = \"baselines\"`";
            problems.push(of_factor(Duplicate, factor, "key", message, hint));
        } else if let Some(line) = earlier(&|other| other.name == factor.name) {
            let message = format!(
                "the name `{}` was used before, by the factor in line {line}",
                factor.name
            );
            let hint = "names are unique";
            problems.push(of_factor(Duplicate, factor, "name", message, hint));
        }
    }
    problems
}

fn of_factor(
    kind: ProblemKind,
    factor: &Factor,
    key: &str,
    message: String,
    hint: &str,
) -> Problem {
    // Missing places are those of the factor itself.
    let place = match factor.places.place(key) {
        place if place == factor.places.place("") => &factor.place,
        place => place,
    };
    Problem::new(kind, message)
        .at(place.clone())
        .key(key)
        .hint(hint)
}

/// Checks the design against the number of factors, not all of which could be read.
pub(super) fn limits(plan: &Plan, number: usize) -> Problems {
    let (design, read) = (&plan.design, &plan.factors);
    let mut problems = Problems::new();
    let mut refuse = |kind, allowed: &str, message: String, hint: &str| {
        let place = plan.places.place("design").clone();
        let problem = Problem::new(kind, message).at(place).key("study.design");
        problems.push(problem.allowed(allowed).hint(hint));
    };
    if number == 0 && *design != Design::Grid {
        let hint = "add a [[factor]], or use the design `grid` for the base alone";
        refuse(
            Missing,
            "at least one [[factor]]",
            "nothing is varied".into(),
            hint,
        );
    }
    let dimensions = match design {
        Design::Sobol { .. } => number,
        Design::Saltelli { .. } => 2 * number,
        _ => 0,
    };
    if dimensions > MAX_SOBOL_DIMENSIONS {
        let allowed = format!(
            "up to {} factors",
            MAX_SOBOL_DIMENSIONS * number / dimensions
        );
        let message = format!("{number} factors are too many for this design");
        refuse(TooLarge, &allowed, message, "leave some out");
    }
    if read.len() == number && design.points(read).is_none() {
        let message = "the design has more points than can be counted".into();
        refuse(TooLarge, "", message, "take fewer values or factors");
    }
    let is_drawn = |factor: &&Factor| matches!(factor.values, FactorValues::Distribution(_));
    if *design == Design::Grid {
        problems.extend(read.iter().filter(is_drawn).map(|factor| {
            let message = "a distribution has no values for a grid".to_owned();
            of_distribution(Conflict, factor, message, "give `values` or a `range`")
                .allowed("values or range")
        }));
    }
    problems
}

fn of_distribution(kind: ProblemKind, factor: &Factor, message: String, hint: &str) -> Problem {
    Problem::new(kind, format!("factor {}: {message}", factor.key))
        .at(factor.places.place("distribution").clone())
        .key("distribution")
        .hint(hint)
}

/// Factors whose values would replace what the plan sets: of the same key, or of an option that another one is set in place of.
pub(super) fn shadowed(plan: &Plan) -> Problems {
    let mut problems = Problems::new();
    for factor in &plan.factors {
        let own = match factor.cars {
            Cars::Baselines => &[],
            Cars::Subject | Cars::All => &plan.base.set[..],
        };
        let is_replaced = |by: &&Override| match factor.key.strip_prefix(by.key()) {
            Some("") => true,
            Some(below) => {
                let option = below
                    .strip_prefix('.')
                    .and_then(|way| way.split('.').next());
                option.is_some_and(|option| option != by.value())
            }
            None => false,
        };
        let set = own.iter().chain(&plan.base.set_all);
        let Some(by) = set.filter(|_| factor.acts == Acts::Value).find(is_replaced) else {
            continue;
        };
        let (key, value) = (by.key(), by.value());
        let message = format!(
            "`{key}` is set to {value} and `{}` varied: the factor's values would replace it",
            factor.key
        );
        let hint = "remove one of them, or give the factor acts = \"scale\"";
        problems.push(of_factor(Conflict, factor, "key", message, hint));
    }
    problems
}

/// Checks that need a whole plan: distributions of run options that leave their range, and factors of cars that do not exist.
pub(super) fn reach(plan: &Plan) -> Problems {
    let mut problems = Problems::new();
    let no_baselines = plan.base.baselines.as_ref().is_some_and(Vec::is_empty);
    for (k, factor) in plan.factors.iter().enumerate() {
        if factor.cars == Cars::Baselines && no_baselines {
            let message = format!("factor {}: there are no baselines", factor.key);
            let hint = "name them in `baselines`, or remove the factor";
            problems.push(of_factor(Conflict, factor, "cars", message, hint));
        }
        let (Some(bound), FactorValues::Distribution(_)) =
            (keys::range(&factor.key), &factor.values)
        else {
            continue;
        };
        // Looks through all samples: only for the options of a run, which have a range.
        let Some((low, high)) = plan.span(k) else {
            continue;
        };
        if !(bound.contains(low) && bound.contains(high)) {
            let (low, high) = (readable(low, 4), readable(high, 4));
            let message = format!("the draws go from {low} to {high}");
            let hint = "use truncated_normal, uniform or triangular";
            let allowed = bound.in_unit(keys::quantity(&factor.key).unit());
            problems.push(of_distribution(OutOfRange, factor, message, hint).allowed(allowed));
        }
    }
    problems
}
