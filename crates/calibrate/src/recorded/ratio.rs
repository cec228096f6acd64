//! Kind of gearbox, ends of the ratio, lock-up.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CL-8 | N = n/v of a running engine; steps: of the steps of 0.02 of ln N between its 5 and 95 % quantiles, fewer than 47 % hold a quarter of an even share, in seconds above 25 km/h and below 1 m/s2 whose neighbours are within 3 % | ASSUMED: a stepped gearbox has gaps between its gears; 14 to 39 % in three logs of manual boxes, 55 to 67 % of three computed CVTs |
//! | CL-9 | N_high: the least N that is held, median within 1.5 % of the mode below the 30 % quantile above 50 km/h, for 30 s or more, with fewer seconds in the same width below it | ASSUMED |
//! | CL-10 | belt ratio = N 3.6 r 2 pi/60 / i_fd, without slip of belt and tyres | derived; slip of belt and tyres is 1 to 3 % in it |
//! | CL-11 | lock-up after a start from rest: between the speeds of the last second above and the first within 1.02 N_low; opening: between those of the last second before a stop above, and the first within 1.08 idle speed | derived: in low until locked (RC-6); N_low of the car |

use super::idle::FEWEST;
use super::resample::{Estimate, between, median, quantile};
use super::seconds::Second;
use super::{Found, Value};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::cycle::is_standstill;
use cvtcycle_model::transmission::Transmission;
use std::f64::consts::PI;

/// Bins of ln N (CL-8).
const BIN: f64 = 0.02;
/// Fewest seconds that tell the kind of gearbox.
const KIND_S: usize = 200;
/// Fewest bins, so that gears would have gaps between them.
const KIND_BINS: usize = 15;
/// Share of the bins that a gearbox without steps fills at least, per cent (CL-8).
const FILLED: f64 = 47.0;
/// Fewest events of a speed of lock-up.
const FEWEST_EVENTS: usize = 4;

/// Engine speed over road speed, rpm per km/h, at the ends of the ratio.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ratios {
    pub low: Option<f64>,
    pub high: Option<f64>,
    /// Belt ratio by engine speed over road speed.
    belt: Option<f64>,
}

impl Ratios {
    /// Those of a car with a CVT.
    pub fn of_car(setup: Option<&Setup>) -> Self {
        let Some(setup) = setup else {
            return Ratios::default();
        };
        let Transmission::Cvt(cvt) = setup.transmission() else {
            return Ratios::default();
        };
        let radius_m = setup.vehicle.road_load.base.wheel_radius_m;
        let belt = 3.6 * radius_m * 2.0 * PI / 60.0 / cvt.final_drive.ratio; // CL-10
        Ratios {
            low: Some(cvt.lowest_ratio() / belt),
            high: Some(cvt.ratio.high / belt),
            // One of two ranges is not known from the speeds.
            belt: cvt.ranges.is_none().then_some(belt),
        }
    }
}

pub fn find(found: &mut Found) {
    if found.value("idle, warm").is_none() && !found.seconds.iter().any(|own| own.rpm.is_some()) {
        return;
    }
    kind(found);
    high(found);
    lock_up(found);
}

/// Judges whether the gearbox has steps (CL-8).
fn kind(found: &mut Found) {
    let held = found.seconds.windows(3).filter_map(|own| {
        let near = |a: f64, b: f64| (a / b).ln().abs() < 0.03;
        let middle = own[1].rpm_per_kmh()?;
        let steady = own[1].kmh() > 25.0 && own[1].accel().abs() < 1.0;
        let alike = near(own[0].rpm_per_kmh()?, middle) && near(own[2].rpm_per_kmh()?, middle);
        (own[2].follows(&own[1]) && own[1].follows(&own[0]) && steady && alike).then(|| middle.ln())
    });
    let mut held: Vec<f64> = held.collect();
    let ends = [0.05, 0.95].map(|share| quantile(&mut held, share));
    let [Some(low), Some(high)] = ends else {
        return;
    };
    let bins = ((high - low) / BIN).ceil() as usize;
    if held.len() < KIND_S || bins < KIND_BINS {
        found.cannot(format!(
            "kind of gearbox: {} with a ratio that is held, over {} % of ratio",
            super::idle::seconds(held.len()),
            (100.0 * ((high - low).exp() - 1.0)).round()
        ));
        return;
    }
    let mut counts = vec![0_usize; bins + 1];
    for own in held.iter().filter(|own| (low..=high).contains(own)) {
        counts[((own - low) / BIN) as usize] += 1;
    }
    let least = (0.25 * held.len() as f64 / bins as f64).max(1.0);
    let occupied = counts
        .iter()
        .filter(|count| **count as f64 >= least)
        .count();
    let share = 100.0 * occupied as f64 / bins as f64;
    let own = Estimate {
        value: share.min(100.0),
        range: None,
        count: held.len(),
    };
    found.add(Value::of_seconds(
        "ratios that occur",
        None,
        "CL-8",
        "% of range",
        own,
    ));
    if share < FILLED {
        // CL-8
        found.findings.doubts.push(format!(
            "engine speed over road speed takes {} % of the values in its range: the gearbox has steps, and ratio, lock-up and lines are not those of a CVT",
            share.round()
        ));
    }
}

/// The high end of the ratio (CL-9).
fn high(found: &mut Found) {
    let list: Vec<(usize, f64)> = found
        .seconds
        .iter()
        .filter(|own| own.kmh() > 50.0 && own.accel().abs() < 0.7)
        .filter_map(|own| Some((own.block, own.rpm_per_kmh()?)))
        .collect();
    let mut all: Vec<f64> = list.iter().map(|(_, own)| *own).collect();
    all.sort_by(f64::total_cmp);
    let within = |low: f64, high: f64| {
        let at = |value: f64| all.partition_point(|own| *own < value);
        at(high).saturating_sub(at(low))
    };
    let width = 1.015;
    let end = quantile(&mut all.clone(), 0.3).unwrap_or(0.0);
    let mode = all.iter().take_while(|own| **own <= end);
    let mode = mode
        .copied()
        .max_by_key(|own| within(own / width, own * width));
    let held = mode.map_or(0, |mode| within(mode / width, mode * width));
    let below = mode.map_or(0, |mode| within(mode / width.powi(3), mode / width));
    let own = mode
        .filter(|_| held >= 30 && 4 * below < held)
        .and_then(|mode| {
            let near: Vec<(usize, f64)> = list
                .iter()
                .copied()
                .filter(|(_, own)| (own / mode).ln().abs() < width.ln())
                .collect();
            median(&near)
        });
    let Some(own) = own else {
        found.cannot(format!(
            "high end of the ratio: no least engine speed over road speed is held for 30 s above 50 km/h ({} there)",
            super::idle::seconds(list.len())
        ));
        return;
    };
    found.add(Value::of_seconds(
        "engine over road speed, high",
        None,
        "CL-9",
        "rpm per km/h",
        own,
    ));
    found.ratios.high = Some(own.value);
    if let Some(belt) = found.ratios.belt {
        let own = Estimate {
            value: own.value * belt,
            range: own.range.map(|ends| ends.map(|end| end * belt)),
            ..own
        };
        found.add(Value::of_seconds(
            "belt ratio, high",
            Some("transmission.cvt.ratio.high"),
            "CL-10",
            "-",
            own,
        ));
    }
}

/// Road speeds at which the launch device locks and opens (CL-11).
fn lock_up(found: &mut Found) {
    let (Some(low), Some(idle_rpm)) = (found.ratios.low, found.value("idle, warm")) else {
        found.cannot("lock-up: it needs the low end of the ratio of a car, and a warm idle");
        return;
    };
    let (mut locks, mut opens) = (Vec::new(), Vec::new());
    let (mut open_kmh, mut locked_kmh): (Option<f64>, Option<f64>) = (None, None);
    for pair in found.seconds.windows(2) {
        let [before, own] = pair else { continue };
        if !own.follows(before) {
            (open_kmh, locked_kmh) = (None, None);
            continue;
        }
        if before.rests() && !own.rests() {
            open_kmh = Some(0.0);
        }
        if let Some(at) = open_kmh
            && let Some(ratio) = own.rpm_per_kmh()
        {
            let gains = own.accel() > 0.0;
            match ratio > 1.02 * low {
                true => open_kmh = Some(own.kmh()),
                false => {
                    if gains && own.is_warm() {
                        locks.push([at, own.kmh()]); // CL-11
                    }
                    open_kmh = None;
                }
            }
        }
        if let Some(rpm) = own.rpm.filter(|_| own.is_warm() && own.accel() < 0.0) {
            match rpm > 1.08 * idle_rpm {
                true => locked_kmh = Some(own.kmh()),
                false => {
                    if let Some(at) = locked_kmh
                        .take()
                        .filter(|_| !is_standstill(own.kmh() / 3.6))
                    {
                        opens.push([own.kmh(), at]); // CL-11
                    }
                }
            }
        } else if own.accel() >= 0.0 {
            locked_kmh = None;
        }
    }
    for (name, key, list) in [
        (
            "lock-up closes",
            "transmission.cvt.launch.torque_converter.lockup.from_kmh",
            locks,
        ),
        (
            "lock-up opens",
            "transmission.cvt.launch.torque_converter.lockup.until_kmh",
            opens,
        ),
    ] {
        match between(&list).filter(|own| own.count >= FEWEST_EVENTS) {
            Some(own) => found.add(Value {
                counted: "events",
                ..Value::of_seconds(name, Some(key), "CL-11", "km/h", own)
            }),
            None => found.cannot(format!(
                "{name}: {} of a warm car, {FEWEST_EVENTS} are needed",
                match list.len() {
                    1 => "1 event".to_owned(),
                    n => format!("{n} events"),
                }
            )),
        }
    }
    let slow = found.seconds.iter().filter(|own| own.kmh() < 30.0);
    if slow.filter_map(Second::rpm_per_kmh).count() > FEWEST {
        found.cannot("low end of the ratio: at low speeds the launch device may slip, so that it is that of the car");
    }
}
