//! Idle: speed and flow at rest.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CL-3 | warm idle: median engine speed of seconds at rest, of which the car has rested 3 s and rests the next, with a running engine; flow: median of the same | definition |
//! | CL-4 | cold idle: median of n_hot + (n - n_hot)/c over such seconds with c >= 0.3, c the share of EN-1 by the coolant, from 60 s after the log begins | derived: EN-1 solved for its cold end; temperatures of its ends are those of the car |

use super::resample::{Estimate, median};
use super::seconds::{OFF_RPM, Second};
use super::{Found, Value};

/// Time for which a car has rested before its engine idles, s (CL-3).
const SETTLED_S: usize = 3;
/// Least share of the rise of a cold idle (CL-4).
const LEAST_SHARE: f64 = 0.3;
/// Time after which the rise after a start is gone, s (CL-4).
const STARTED_S: f64 = 60.0;
/// Fewest seconds of a quantity.
pub const FEWEST: usize = 10;

/// Seconds of which the car has rested for a while and rests the next.
fn settled(seconds: &[Second]) -> impl Iterator<Item = &Second> {
    seconds.windows(SETTLED_S + 2).filter_map(|window| {
        let one_log = window[SETTLED_S + 1].log == window[0].log;
        let rests = window.iter().all(Second::rests);
        (one_log && rests).then_some(&window[SETTLED_S])
    })
}

pub fn find(found: &mut Found) {
    let resting: Vec<Second> = settled(&found.seconds).copied().collect();
    let off = |own: &&Second| own.rpm.is_some_and(|rpm| rpm <= OFF_RPM);
    let (known, stopped) = (
        resting.iter().filter(|own| own.rpm.is_some()).count(),
        resting.iter().filter(off).count(),
    );
    let running = |own: &&Second| own.rpm.is_some_and(|rpm| rpm > OFF_RPM);
    let warm: Vec<&Second> = resting
        .iter()
        .filter(running)
        .filter(|own| own.is_warm())
        .collect();
    let speeds: Vec<(usize, f64)> = warm
        .iter()
        .filter_map(|own| Some((own.block, own.rpm?)))
        .collect();
    let flows: Vec<(usize, f64)> = warm
        .iter()
        .filter_map(|own| Some((own.block, own.fuel_g_s?)))
        .collect();
    let hot = median(&speeds).filter(|own| own.count >= FEWEST); // CL-3
    let value = |name, key, unit, own| Value::of_seconds(name, key, "CL-3", unit, own);
    match hot {
        Some(own) => found.add(value("idle, warm", Some("engine.idle.hot_rpm"), "rpm", own)),
        None if known > 0 => found.cannot(format!(
            "warm idle: {} of a warm car at rest with its engine running",
            seconds(speeds.len())
        )),
        None => {}
    }
    if let Some(own) = median(&flows).filter(|own| own.count >= FEWEST) {
        found.add(value("flow at warm idle", None, "g/s", own));
    }
    if known >= FEWEST {
        let share = 100.0 * stopped as f64 / known as f64;
        let own = Estimate {
            value: share,
            range: None,
            count: known,
        };
        found.add(value("engine off at rest", None, "% of time", own));
    }
    if let Some(hot) = hot {
        cold(found, &resting, hot.value);
    }
}

/// The cold end of EN-1.
fn cold(found: &mut Found, resting: &[Second], hot_rpm: f64) {
    let key = "engine.idle.cold_rpm";
    // Defaults of the keys, where no car is known.
    let [cold_degc, warm_degc] = [
        ("engine.idle.cold_degc", 37.0),
        ("engine.idle.warm_degc", 71.0),
    ]
    .map(|(key, usual)| found.of_car(key).unwrap_or(usual));
    let share = |degc: f64| ((warm_degc - degc) / (warm_degc - cold_degc)).clamp(0.0, 1.0);
    let of = |own: &Second| {
        let rpm = own
            .rpm
            .filter(|rpm| *rpm > OFF_RPM && own.start_s >= STARTED_S)?;
        let share = share(own.coolant_degc?);
        (share >= LEAST_SHARE).then(|| (own.block, hot_rpm + (rpm - hot_rpm) / share)) // CL-4
    };
    let list: Vec<(usize, f64)> = resting.iter().filter_map(of).collect();
    let coldest = found.seconds.iter().filter_map(|own| own.coolant_degc);
    let coldest = coldest.fold(f64::INFINITY, f64::min);
    match median(&list).filter(|own| own.count >= FEWEST) {
        Some(own) => found.add(Value::of_seconds(
            "idle, cold",
            Some(key),
            "CL-4",
            "rpm",
            own,
        )),
        None if coldest.is_finite() => found.cannot(format!(
            "cold idle: {} at rest with coolant below {} degC later than {STARTED_S} s after the log begins; its coldest coolant is {} degC",
            seconds(list.len()),
            (warm_degc - LEAST_SHARE * (warm_degc - cold_degc)).round(),
            coldest.round()
        )),
        None => {}
    }
}

/// `1 second`, `no second`, `12 seconds`.
pub fn seconds(count: usize) -> String {
    match count {
        0 => "no second".to_owned(),
        1 => "1 second".to_owned(),
        _ => format!("{count} seconds"),
    }
}
