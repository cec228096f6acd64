//! A plan made for its own cars, taken relative to their values, so that it serves any car. A friction of which the car's fluid has a table has the range
//! of that table.

use super::prepare::{folder_of, in_folder};
use crate::plan::{
    Acts, Cars, Distribution, Factor, FactorValue, FactorValues, Places, Plan, RUN_OPTIONS, unit,
};
use cvtcycle_config::setup::{NamedBy, Options, ParamSet, Setup, TWIN, baseline_of};
use cvtcycle_config::{Problems, Target, unit_of};

/// Share of the largest value of a factor below which the value of its car is too near to zero to be a measure of it.
const NEAR_ZERO: f64 = 0.1;

/// The plan with factors and differences in place of values: of its subject, and of its first baseline for factors of the baselines.
/// Temperatures, and values near or below zero, become differences, all others factors on the value of each car. A factor does not act on a car
/// that does not have its key, and what leaves the range of a key is held at its end. Also whether the subject has a CVT.
///
/// # Errors
/// The problems of its cars.
pub fn relative(plan: Plan) -> Result<(Plan, bool), Problems> {
    let folder = folder_of(&plan);
    let options = |lubricant: &Option<String>| Options {
        lubricant: lubricant.clone(),
        engine_oil: plan.base.engine_oil.clone(),
        named_by: NamedBy::File,
        ..Options::default()
    };
    let word = in_folder(folder, &plan.base.vehicle);
    let subject = ParamSet::load(&word, &options(&plan.base.lubricant))?;
    let own = Setup::from_params(&subject).baselines;
    let named = plan.base.baselines.as_ref().unwrap_or(&own);
    let baseline = named.first().map(|name| match plan.base.baselines {
        Some(_) if name != TWIN => in_folder(folder, name),
        _ => baseline_of(&word, name),
    });
    let baseline = match baseline {
        Some(word) => Some(ParamSet::load(&word, &options(&None))?),
        None => None,
    };
    let owner = |factor: &Factor| match factor.cars {
        Cars::Baselines => baseline.as_ref(),
        Cars::Subject | Cars::All => Some(&subject),
    };
    let over = |factor: &Factor| {
        let param = owner(factor)?.param(&factor.key).ok()?;
        let is_known = param.is_active() && param.base().is_finite();
        is_known.then(|| over(factor, param.base()))
    };
    let is_value = |factor: &Factor| {
        let is_option = RUN_OPTIONS.contains(&factor.key.as_str());
        factor.acts == Acts::Value && factor.values.are_numbers() && !is_option
    };
    let measured = |factor: &Factor| of_table(factor, owner(factor)?);
    let factors = plan.factors.iter().map(|factor| match is_value(factor) {
        true => (measured(factor).or_else(|| over(factor))).unwrap_or_else(|| factor.clone()),
        false => factor.clone(),
    });
    let factors = factors.collect();
    let relative = Plan {
        factors,
        skip_missing: true,
        clip: true,
        ..plan
    };
    Ok((relative, subject.vehicle().transmission().is_cvt()))
}

/// A relative plan with the ranges that the files of some cars give their values, in place of those of the plan and besides them: what is known of a
/// class, an engine or a fluid goes with it. The first car that has a key decides. `of_cvts`: whether the subject of the plan has a CVT.
#[must_use]
pub fn with_ranges(plan: Plan, of_cvts: bool, cars: &[&Setup]) -> Plan {
    let mut factors = plan.factors.clone();
    let mut known: Vec<(String, Cars)> = Vec::new();
    for car in cars {
        let own = match car.transmission().is_cvt() == of_cvts {
            true => Cars::Subject,
            false => Cars::Baselines,
        };
        for info in &car.keys {
            let (Some([low, high]), Ok(mode)) = (info.range, info.value.parse::<f64>()) else {
                continue;
            };
            let cars = match OF_A_BOX.iter().any(|prefix| info.key.starts_with(prefix)) {
                true => own,
                false => Cars::All,
            };
            let id = (info.key.clone(), cars);
            if known.contains(&id) {
                continue;
            }
            let place = factors
                .iter()
                .position(|factor| (&factor.key, factor.cars) == (&id.0, cars));
            let of_plan = place.map(|at| &factors[at]);
            let absolute = Factor {
                key: info.key.clone(),
                name: of_plan.map_or_else(|| info.doc.clone(), |factor| factor.name.clone()),
                unit: info.unit.clone(),
                cars,
                acts: Acts::Value,
                values: FactorValues::Distribution(Distribution::Triangular { low, mode, high }),
                form: None,
                status: match info.status.as_str() {
                    status @ ("source" | "derived" | "fitted") => status.to_owned(),
                    _ => "assumed".to_owned(),
                },
                source: info.source.clone(),
                test: of_plan.map_or_else(String::new, |factor| factor.test.clone()),
                place: plan.places.place("").clone(),
                places: Places::new(plan.places.place("").clone()),
            };
            let factor = over(&absolute, mode);
            // The range of a car is known in all forms: their own values of the key go.
            match place {
                Some(at) => factors[at] = factor,
                None => factors.push(factor),
            }
            let of_form = |of: &Factor| of.form.is_some() && (&of.key, of.cars) == (&id.0, cars);
            factors.retain(|of| !of_form(of));
            known.push(id);
        }
    }
    Plan { factors, ..plan }
}

/// Tables of a car that are of its box: the same key of another box is another value.
const OF_A_BOX: [&str; 4] = [
    "transmission.",
    "lubricant.",
    "thermal.transmission.",
    "thermal.cooler.",
];

/// Standard deviations at which the range of a table's friction is cut off.
const CUT: f64 = 3.0;

/// The range of a friction of which the car's fluid has a table: what is known by the table (FR-8), in place of the plan's.
fn of_table(factor: &Factor, car: &ParamSet) -> Option<Factor> {
    let own = factor.key.strip_prefix(Target::Lubricant.prefix())?;
    let mut benches = car.vehicle().oils().0.benches.iter();
    let bench = benches.find(|bench| bench.contact.number_key() == Some(own))?;
    let sd = (0.5 * bench.spread).min(0.3);
    (sd > 0.0).then(|| Factor {
        acts: Acts::Scale,
        unit: unit(&factor.key, Acts::Scale),
        values: FactorValues::Distribution(Distribution::TruncatedNormal {
            mean: 1.0,
            sd,
            low: 1.0 - CUT * sd,
            high: 1.0 + CUT * sd,
        }),
        ..factor.clone()
    })
}

/// A factor over the value of its car.
fn over(factor: &Factor, base: f64) -> Factor {
    let size = |x: f64| x.abs() * NEAR_ZERO;
    let largest = match &factor.values {
        FactorValues::List(list) => {
            let numbers = list.iter().filter_map(FactorValue::number);
            numbers.map(size).fold(0.0, f64::max)
        }
        FactorValues::Distribution(distribution) => {
            let (low, high) = distribution.support();
            let ends = [low, high].into_iter().filter(|x| x.is_finite());
            ends.map(size).fold(0.0, f64::max)
        }
    };
    let is_lognormal = matches!(
        factor.values,
        FactorValues::Distribution(Distribution::Lognormal { .. })
    );
    let near_zero = base <= largest;
    let acts = match unit_of(&factor.key) == unit_of("_degc") || near_zero {
        true if is_lognormal => Acts::Value,
        true => Acts::Offset,
        false => Acts::Scale,
    };
    let number = |value: &FactorValue| match (value, acts) {
        (FactorValue::Number(x), Acts::Scale) => FactorValue::Number(x / base),
        (FactorValue::Number(x), Acts::Offset) => FactorValue::Number(x - base),
        (other, _) => other.clone(),
    };
    Factor {
        acts,
        unit: unit(&factor.key, acts),
        values: match &factor.values {
            FactorValues::List(list) => FactorValues::List(list.iter().map(number).collect()),
            FactorValues::Distribution(distribution) => {
                FactorValues::Distribution(distribution.over(base, acts))
            }
        },
        ..factor.clone()
    }
}
