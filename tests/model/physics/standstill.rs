//! Standstill: noise of a speed sensor at rest moves no car.

use crate::common::{CARS, at, car, cycle, fuel_kg, soak_rows};
use cvtcycle_config::csv::Columns;
use cvtcycle_config::cycle::{Cycle, Interval, STANDSTILL_M_S, Trace, read_columns};
use cvtcycle_model::drive::Start;
use std::fmt::Write;

/// Speeds of a sensor at rest, km/h: even over +-0.05, by a fixed sequence.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 12_345_u32;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        0.1 * (f64::from(state >> 8) / f64::from(1_u32 << 24) - 0.5)
    }
}

/// A trace at a rate, Hz, as a user's table with a noise at its standstills.
fn table(trace: &Trace, rate: u32, mut at_rest_kmh: impl FnMut() -> f64) -> Cycle {
    let mut text = "time_s,speed_kmh\n".to_owned();
    for k in 0..=trace.duration_s() as u32 * rate {
        let time_s = f64::from(k) / f64::from(rate);
        let inside = |own: &&Interval| own.start_s <= time_s && time_s <= own.end_s;
        let own = trace.intervals.iter().find(inside).unwrap();
        let share = (time_s - own.start_s) / (own.end_s - own.start_s);
        let speed = own.start_speed_m_s + share * (own.end_speed_m_s - own.start_speed_m_s);
        let kmh = match speed > 0.0 {
            true => 3.6 * speed,
            false => at_rest_kmh(),
        };
        writeln!(text, "{time_s},{kmh}").unwrap();
    }
    read_columns("log.csv", text.as_bytes(), &Columns::default())
        .unwrap_or_else(|problems| panic!("{problems:?}"))
}

/// Truth: the same cycle without noise, to the last bit: with and without start-stop, as a log at 10 Hz, which is smoothed, and as intervals.
#[test]
fn noise_at_rest_moves_no_fuel() {
    let plain = cycle("ece15_eudc");
    let trace = plain.trace_for(true);
    let start_stop = [CARS[0], "engine.start_stop.delay_s=0.5"];
    let cars = [&CARS[..1], &CARS[1..2], &start_stop[..], &["civic_20_cvt"]];
    for (rate, cars) in [(1, &cars[..]), (10, &cars[..1])] {
        let (still, noisy) = (table(trace, rate, || 0.0), table(trace, rate, noise()));
        for words in cars {
            let setup = car(words[0], &words[1..]);
            let fuel = |cycle| fuel_kg(&setup, cycle, &at(25.0, Start::Soak));
            let (still, noisy) = (fuel(&still), fuel(&noisy));
            assert_eq!(
                still.to_bits(),
                noisy.to_bits(),
                "{words:?}: {noisy} for {still}"
            );
        }
    }
    let [still, noisy] = [0.0, 1.0].map(|share| {
        let mut noise = noise();
        let mut before = 0.0;
        let intervals = trace.intervals.iter().map(|own| {
            let start_speed_m_s = before;
            before = match own.end_speed_m_s > 0.0 {
                true => own.end_speed_m_s,
                false => share * noise().abs() / 3.6,
            };
            Interval {
                start_speed_m_s,
                end_speed_m_s: before,
                ..*own
            }
        });
        let cycle = Cycle::from_intervals("own", intervals.collect()).unwrap();
        fuel_kg(&car(CARS[0], &[]), &cycle, &at(25.0, Start::Soak))
    });
    assert_eq!(still.to_bits(), noisy.to_bits(), "{noisy} for {still}");
}

/// Property: a speed at the threshold drives, one below it does not, and idles the fuel of a standing car away.
#[test]
fn a_crawl_drives_and_a_standing_car_idles() {
    let held = |speed_m_s: f64| {
        let interval = Interval {
            start_s: 0.0,
            end_s: 60.0,
            start_speed_m_s: speed_m_s,
            end_speed_m_s: speed_m_s,
            phase: 0,
            grade: 0.0,
            engine_off: false,
        };
        let cycle = Cycle::from_intervals("held", vec![interval]).unwrap();
        let setup = car(CARS[0], &[]);
        let outcome = soak_rows(&setup, &cycle, 25.0);
        let total = outcome.totals.total();
        (total.distance_m, total.standstill_fuel_kg / total.fuel_kg)
    };
    assert_eq!(held(0.99 * STANDSTILL_M_S), held(0.0));
    assert_eq!(held(0.0), (0.0, 1.0));
    let (distance_m, at_rest) = held(STANDSTILL_M_S);
    assert!((distance_m - 60.0 * STANDSTILL_M_S).abs() < 1e-12 && at_rest == 0.0);
}
