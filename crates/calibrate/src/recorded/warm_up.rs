//! Thermostat and heat capacity of the engine.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CL-15 | thermostat: both ends of the car's shifted by the difference of the medians of log and computed car, in seconds of 5 minutes or more whose coolant stays within 4 K over 2 minutes, above 70 degC in both | derived: the level of a car in balance moves with them one by one |
//! | CL-16 | heat capacity of the block times (sum of flow / rise of coolant) of the log over that of the computed car, until both agree within 0.5 %; without a channel of fuel, time for flow; between 3 K above the start and 8 K below the level, below 65 degC | derived: the same heat per fuel and the same losses; heat goes into oil and metal as in the car |

use super::resample::{Estimate, estimate, quantile};
use super::seconds::{Second, WARM_DEGC, driven};
use super::{Found, Value};
use cvtcycle_config::Problems;
use cvtcycle_config::setup::{ParamSet, Setup};
use cvtcycle_model::lubricant::ZERO_DEGC_K;

/// Key of the heat capacity of coolant, block and head.
const BLOCK: &str = "thermal.engine.block_kj_k";
/// Keys of the thermostat.
const THERMOSTAT: [(&str, &str); 2] = [
    ("thermostat opens", "thermal.radiator.thermostat_from_degc"),
    ("thermostat open", "thermal.radiator.thermostat_to_degc"),
];
/// Window over which a level is even, s, and by how much it may change in it, K.
const EVEN: (usize, f64) = (120, 4.0);
/// Fewest seconds of a level.
const LEVEL_S: usize = 300;
/// Highest coolant of a warm-up, degC.
const COLD_DEGC: f64 = 65.0;
/// Least rise that tells a heat capacity, K.
const LEAST_RISE_K: f64 = 15.0;
/// Rounds of CL-16, and the error at which they end.
const ROUNDS: (usize, f64) = (6, 0.005);

pub fn find(found: &mut Found) -> Result<(), Problems> {
    if !found.seconds.iter().any(|own| own.coolant_degc.is_some()) {
        return Ok(());
    }
    level(found);
    capacity(found)
}

/// The level of the thermostat (CL-15).
fn level(found: &mut Found) {
    let even = |own: &&[Second]| {
        let (first, last) = (own[0], own[own.len() - 1]);
        let near = |of: fn(&Second) -> Option<f64>| {
            of(&first)
                .zip(of(&last))
                .is_some_and(|(a, b)| (a - b).abs() < EVEN.1 && b > WARM_DEGC)
        };
        let computed = |own: &Second| own.computed.map(|own| own.coolant_degc);
        first.log == last.log
            && near(|own| own.coolant_degc)
            && (last.computed.is_none() || near(computed))
    };
    let last = |own: &[Second]| own[own.len() - 1];
    let list: Vec<Second> = found
        .seconds
        .windows(EVEN.0)
        .filter(even)
        .map(last)
        .collect();
    let degc: Vec<(usize, f64)> = list
        .iter()
        .filter_map(|own| Some((own.block, own.coolant_degc?)))
        .collect();
    let median = |list: &mut [f64]| quantile(list, 0.5);
    let Some(own) = estimate(&degc, median).filter(|own| own.count >= LEVEL_S) else {
        found.cannot(format!(
            "thermostat: {} with coolant that stays, {LEVEL_S} are needed",
            super::idle::seconds(degc.len())
        ));
        return;
    };
    let value = |name, key, own| Value::of_seconds(name, key, "CL-15", "degC", own);
    found.add(value("coolant, warm", None, own));
    let shifts: Vec<(usize, f64)> = list
        .iter()
        .filter_map(|own| Some((own.block, own.coolant_degc? - own.computed?.coolant_degc)))
        .collect();
    let Some(shift) = estimate(&shifts, median) else {
        return;
    };
    for (name, key) in THERMOSTAT {
        let Some(before) = found.of_car(key) else {
            continue;
        };
        let own = Estimate {
            value: before + shift.value, // CL-15
            range: shift.range.map(|ends| ends.map(|end| before + end)),
            count: shift.count,
        };
        found.add(value(name, Some(key), own));
    }
}

/// A second of a warm-up: rise of the coolant, K, and flow, g, or time, s.
type Rise = [f64; 2];

/// Seconds of the log's warm-up, with their place in the list.
fn rises(found: &Found) -> Vec<(usize, Rise)> {
    let mut list = Vec::new();
    let mut start_degc = f64::NAN;
    let has_fuel = found.seconds.iter().any(|own| own.fuel_g_s.is_some());
    let level = found
        .value("coolant, warm")
        .map_or(COLD_DEGC, |level| COLD_DEGC.min(level - 8.0));
    for (k, pair) in found.seconds.windows(2).enumerate() {
        let [before, own] = pair else { continue };
        if k == 0 || !own.follows(before) {
            start_degc = before.coolant_degc.unwrap_or(f64::NAN);
        }
        let (Some(a), Some(b)) = (before.coolant_degc, own.coolant_degc) else {
            continue;
        };
        let given = match has_fuel {
            true => own.fuel_g_s,
            false => Some(1.0),
        };
        let in_rise = a > start_degc + 3.0 && b < level;
        if let Some(given) = given.filter(|_| in_rise && own.follows(before)) {
            list.push((k + 1, [b - a, given]));
        }
    }
    list
}

/// Flow over rise, of a whole warm-up.
fn per_kelvin(list: &mut [Rise]) -> Option<f64> {
    let [rise, given] = list
        .iter()
        .fold([0.0, 0.0], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
    (rise > 1.0 && given > 0.0).then_some(given / rise)
}

/// Heat capacity of the block (CL-16).
fn capacity(found: &mut Found) -> Result<(), Problems> {
    let rises = rises(found);
    let total: f64 = rises.iter().map(|(_, own)| own[0]).sum();
    let blocks: Vec<(usize, Rise)> = rises
        .iter()
        .map(|(k, own)| (found.seconds[*k].block, *own))
        .collect();
    let own = estimate(&blocks, per_kelvin).filter(|_| total >= LEAST_RISE_K);
    let Some(own) = own else {
        let coldest = found.seconds.iter().filter_map(|own| own.coolant_degc);
        let coldest = coldest.fold(f64::INFINITY, f64::min);
        found.cannot(format!(
            "warm-up: the coolant rises by {} K between {} and {COLD_DEGC} degC, {LEAST_RISE_K} K are needed",
            total.max(0.0).round(),
            coldest.round()
        ));
        return Ok(());
    };
    let has_fuel = found.seconds.iter().any(|own| own.fuel_g_s.is_some());
    let unit = if has_fuel { "g/K" } else { "s/K" };
    found.add(Value::of_seconds("warm-up", None, "CL-16", unit, own));
    let Some(car) = found.question.car.as_ref() else {
        return Ok(());
    };
    let Ok(param) = car.values.param(BLOCK) else {
        return Ok(());
    };
    let (mut value, mut values) = (param.base(), car.values.clone());
    let mut error = f64::INFINITY;
    for round in 0..ROUNDS.0 {
        if round > 0 {
            values = car.values.with(BLOCK, value)?;
        }
        let Some(computed) = computed(found, &rises, &values, has_fuel) else {
            break;
        };
        let factor = own.value / computed;
        error = (factor - 1.0).abs();
        if error < ROUNDS.1 {
            break;
        }
        value *= factor; // CL-16
    }
    if error >= ROUNDS.1 {
        found.cannot(
            "heat capacity of the engine: the car does not warm up as the log does with any",
        );
        return Ok(());
    }
    let relative = |end: f64| value * end / own.value;
    let own = Estimate {
        value,
        range: own.range.map(|ends| ends.map(relative)),
        ..own
    };
    let name = "heat capacity of the block";
    found.add(Value::of_seconds(name, Some(BLOCK), "CL-16", "kJ/K", own));
    Ok(())
}

/// Flow over rise of the computed car over the temperatures of the log's warm-up.
fn computed(
    found: &Found,
    rises: &[(usize, Rise)],
    values: &ParamSet,
    has_fuel: bool,
) -> Option<f64> {
    let setup = Setup::from_params(values);
    let mut list = Vec::new();
    for (number, log) in found.question.logs.iter().enumerate() {
        let own = rises
            .iter()
            .map(|(k, _)| &found.seconds[*k])
            .filter(|own| own.log == number);
        let degc = own.filter_map(|own| own.coolant_degc);
        let (low, high) = degc.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        if low > high {
            continue;
        }
        let rows = driven(&setup, &log.cycle, found.question.ambient_degc);
        for pair in rows.windows(2) {
            let [a, b] = [&pair[0], &pair[1]].map(|row| row.coolant_k - ZERO_DEGC_K);
            if a >= low && b <= high {
                let given = if has_fuel {
                    1e3 * pair[1].fuel_kg_s
                } else {
                    1.0
                };
                list.push([b - a, given * pair[1].dt_s]);
            }
        }
    }
    per_kelvin(&mut list)
}
