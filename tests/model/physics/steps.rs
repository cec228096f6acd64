//! The length of the steps: fuel and verdict of all shipped cars on all shipped cycles do not depend on it, and its estimate holds.
//!
//! Truth: the same drive in steps of 0.05 s. `cargo run --release -p cvtcycle-model-tests --example steps` prints the table of the book.

use cvtcycle_config::cycle::{embedded, names};
use cvtcycle_config::setup::{Kind, Options, load};
use cvtcycle_model::cycle::{Interval, TOLERANCE_M_S, Trace};
use cvtcycle_model::drive::{Conditions, Start, State, Totals, drive, own_trace, simulate};
use cvtcycle_model::flags::Flags;

use crate::common::{Keep, car};

/// Largest error of the fuel at 1 s against 0.05 s (issue 39, point 5).
const MOST_PERCENT: f64 = 0.3;

fn totals(vehicle: &cvtcycle_config::setup::Setup, cycle: &str, max_dt_s: f64) -> Totals {
    let conditions = Conditions {
        ambient_k: 298.15,
        start: Start::Soak,
        max_dt_s,
        keep_rows: false,
    };
    drive(vehicle, &embedded(cycle).unwrap(), &conditions).totals
}

/// Fuel at 1 s within 0.3 % of that at 0.05 s, the same trace missed, and within twice the estimate (TS-1) in 19 of 20 drives.
#[test]
fn fuel_and_verdict_do_not_depend_on_the_step() {
    let (mut pairs, mut within) = (0, 0);
    for vehicle in Kind::Vehicle.names() {
        let vehicle_car = load(vehicle, &Options::default()).unwrap();
        for cycle in names() {
            let [coarse, fine] = [1.0, 0.05].map(|dt_s| totals(&vehicle_car, cycle, dt_s));
            let [own, truth] = [&coarse, &fine].map(|totals| totals.total().fuel_kg);
            let error_percent = 100.0 * (own / truth - 1.0);
            assert!(
                error_percent.abs() <= MOST_PERCENT,
                "{vehicle} {cycle}: {error_percent:.3} %"
            );
            for flag in [
                Flags::MISSED_TRACE,
                Flags::NOT_CONVERGED,
                Flags::TOO_HOT,
                Flags::WRONG_GEAR,
            ] {
                let fails = [&coarse, &fine].map(|totals| totals.seconds(flag) > 0.0);
                assert_eq!(fails[0], fails[1], "{vehicle} {cycle} {flag:?}");
            }
            let estimate_percent = 100.0 * coarse.step_error_kg() / own;
            pairs += 1;
            within += i32::from(error_percent.abs() <= 2.0 * estimate_percent);
            let finer = 100.0 * fine.step_error_kg() / truth;
            assert!(
                finer < 0.5 * estimate_percent,
                "{vehicle} {cycle}: {finer} after {estimate_percent}"
            );
        }
    }
    assert!(20 * within >= 19 * pairs, "{within} of {pairs}");
}

/// TR-3 by hand: a car that lacks a tenth of its force falls behind by F t/m_e, is back on its trace once nothing is asked of it, and misses it beyond the
/// tolerance alone.
#[test]
fn val_behind_the_trace_by_hand() {
    let own = car("rover_216_cvt", &["road_load.mass_kg=1900"]).car(298.15);
    let pull = |start_s: f64, end_s: f64, from: f64, to: f64| Interval {
        start_s,
        end_s,
        start_speed_m_s: from,
        end_speed_m_s: to,
        phase: 0,
        grade: 0.0,
        engine_off: false,
    };
    let trace = Trace::without_gears(vec![
        pull(0.0, 10.0, 0.0, 25.0),
        pull(10.0, 15.0, 25.0, 20.0),
        pull(15.0, 20.0, 20.0, 20.0),
    ]);
    let mut keep = Keep::default();
    simulate(&own, &trace, 0.5, State::at(298.15), &mut keep);
    let mut behind = 0.0_f64;
    let mut missed = 0;
    for row in &keep.rows {
        let lacks = row.flags.contains(Flags::FULL_LOAD);
        assert!(!lacks || row.deficit_w >= 0.0);
        if row.wheel_power_w <= 0.0 {
            behind = 0.0;
        } else if lacks {
            behind += row.deficit_w / row.speed_m_s * row.dt_s / own.road_load.inertia_kg;
        } else if behind > 0.0 {
            let left_w = row.wheel_power_w * (1.0 / row.throttle - 1.0);
            behind =
                (behind - left_w / row.speed_m_s * row.dt_s / own.road_load.inertia_kg).max(0.0);
        }
        assert!(
            (row.behind_m_s - behind).abs() < 1e-9,
            "{} s: {} and {behind}",
            row.time_s,
            row.behind_m_s
        );
        assert_eq!(
            row.flags.contains(Flags::MISSED_TRACE),
            behind > TOLERANCE_M_S
        );
        missed += usize::from(behind > TOLERANCE_M_S);
    }
    assert!(missed > 2);
    assert!(keep.rows.last().unwrap().behind_m_s == 0.0);
}

/// A manual car has a row where its driver changes gear: no step is in two gears.
#[test]
fn a_step_has_one_gear() {
    let setup = car("rover_216_5mt", &[]);
    let own = setup.car(298.15);
    let cycle = embedded("udds").unwrap();
    let trace = own_trace(&own, cycle.trace_for(false));
    let cvtcycle_model::transmission::Transmission::Manual(manual) = &own.transmission else {
        panic!("a manual box")
    };
    for interval in trace.intervals.iter() {
        let (v0, v1) = (interval.start_speed_m_s, interval.end_speed_m_s);
        // Nearer to an end than a thousandth the interval stays whole.
        let inside = |speed: &f64| {
            let share = (speed - v0) / (v1 - v0);
            1.1e-3 < share && share < 1.0 - 1.1e-3
        };
        let speeds = if v0 < v1 {
            &manual.shifts.up_m_s
        } else {
            &manual.shifts.down_m_s
        };
        assert!(!speeds.iter().any(inside), "{} s", interval.end_s);
    }
    assert!(trace.intervals.len() > cycle.trace_for(false).intervals.len() + 100);
    let apart_m = trace.distance_m() - cycle.trace_for(false).distance_m();
    assert!(apart_m.abs() < 1e-6, "{apart_m}");
}
