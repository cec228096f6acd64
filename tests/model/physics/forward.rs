//! A CVT that is driven by a torque (FO-1 to FO-3, RC-15).
//!
//! Truth: the drive that goes the other way, and the power balance of each step.

use crate::common::{ZERO, car, cycle};
use cvtcycle_model::drive::{Car, Drive, Forward, Given, Row, State, Turned};
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, Heat, SUMP};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::Hold;

const AMBIENT_K: f64 = ZERO + 25.0;

/// Rows of a drive with what is known of each for the other way.
fn driven(own: &Car, cycle_name: &str, dt_s: f64) -> Vec<(Given, Row, Heat)> {
    let cycle = cycle(cycle_name);
    let start = || Drive::new(own, State::at(AMBIENT_K));
    let (mut plain, mut drive) = (start(), start());
    let radius_m = own.road_load.wheel_radius_m;
    let mut before_rad_s = f64::NAN;
    let mut list = Vec::new();
    for step in cycle.trace_for(true).steps(dt_s) {
        let heat = drive.state().heat;
        // A box that is asked for a ratio has another way to it within the step than its own control (RC-15, RC-17): the drive is one that is asked.
        let (own_row, _) = plain.step(&step);
        let ratio = own_row.belt_ratio;
        let (row, _) = drive.step_held(
            &step,
            &Hold {
                ratio,
                clamp: None,
                end: None,
                paced: true,
            },
        );
        let (w, end) = (row.engine_speed_rad_s, row.engine_end_rad_s);
        let before = if before_rad_s.is_nan() {
            w
        } else {
            before_rad_s
        };
        let kinetic_w = 0.5 * own.engine.inertia_kg_m2 * (end * end - before * before) / step.dt_s;
        before_rad_s = end;
        list.push((
            Given {
                engine_nm: row.engine_torque_nm + kinetic_w / w,
                wheel_rad_s: [step.start_speed_m_s, step.end_speed_m_s].map(|v| v / radius_m),
                ratio,
                sump_k: heat.node_k[SUMP],
                engine_k: [heat.node_k[COOLANT], heat.node_k[ENGINE_OIL]],
                dt_s: step.dt_s,
            },
            row,
            drive.state().heat,
        ));
    }
    list
}

/// Remainder of power in less power out, losses and rotating energy, over the sum of all.
fn open_share(turned: &Turned) -> f64 {
    let out = &turned.output;
    let in_w = turned.taken_nm * out.engine_rad_s;
    let losses_w: f64 = out.loss_w.iter().sum();
    let rest_w = in_w - out.output_w - losses_w - out.alternator_w - turned.kinetic_w;
    rest_w.abs() / (in_w.abs() + out.output_w.abs() + losses_w)
}

/// Largest differences to a drive.
#[derive(Debug, Default)]
struct Apart {
    wheel_nm: f64,
    speed: f64,
    loss_w: f64,
    belt_k: f64,
    /// Energy at the wheels of both, J, where neither brake nor engine is the limit.
    energy_j: [f64; 2],
    steps: usize,
}

/// Follows a drive with clutch or converter, launches and stops, the other way round.
fn follow(word: &str, cycle_name: &str, dt_s: f64) -> Apart {
    let own = car(word, &[]).car(AMBIENT_K);
    let mut forward = Forward::new(&own, State::at(AMBIENT_K)).expect("a CVT");
    let mut apart = Apart::default();
    let most = |into: &mut f64, x: f64| *into = into.max(x.abs());
    for (given, row, heat) in driven(&own, cycle_name, dt_s) {
        let turned = forward.step(&given);
        let open = open_share(&turned);
        assert!(open < 1e-12, "{word} at {} s: {open}", row.time_s);
        // At rest the drive has no power to be found; there FO-3 turns the wheels.
        if row.speed_m_s <= 0.0 {
            continue;
        }
        let out = &turned.output;
        assert!(
            (turned.taken_nm - given.engine_nm).abs() < 2e-3,
            "{word} at {} s: {} of {} Nm",
            row.time_s,
            turned.taken_nm,
            given.engine_nm
        );
        most(
            &mut apart.speed,
            out.engine_rad_s / row.engine_speed_rad_s - 1.0,
        );
        let [there, here] = [&row.loss_w, &out.loss_w].map(|loss| loss.iter().sum::<f64>());
        most(&mut apart.loss_w, here - there);
        most(
            &mut apart.belt_k,
            forward.state().heat.node_k[BELT] - heat.node_k[BELT],
        );
        // Wheels that bring the engine up take it out of their brakes (SI-5).
        let by_brakes = row.engine_torque_nm < 0.0 && row.kinetic_w > 0.0;
        if row.brake_w <= 0.0 && row.deficit_w <= 0.0 && !by_brakes {
            most(&mut apart.wheel_nm, turned.wheel_nm() - row.wheel_torque_nm);
            apart.energy_j[0] += out.output_w * given.dt_s;
            apart.energy_j[1] += row.wheel_power_w * given.dt_s;
            apart.steps += 1;
        }
    }
    apart
}

/// The only difference to a drive is the heat of the engine within a step, which the way round does not know: it moves the belt's temperature.
#[test]
fn a_drive_the_other_way_round_is_that_drive() {
    for (word, cycle_name, dt_s) in [
        ("rover_216_cvt", "ece15_eudc", 1.0),
        ("rover_216_cvt", "ece15", 0.1),
        ("rover_216_cvt", "wltc_class3b", 1.0),
        ("civic_20_cvt", "ece15_eudc", 1.0),
        ("civic_20_cvt", "hwfet", 1.0),
    ] {
        let apart = follow(word, cycle_name, dt_s);
        let [here, there] = apart.energy_j;
        assert!(apart.steps > 500, "{apart:?}");
        assert!(
            (here / there - 1.0).abs() < 2e-5,
            "{word} {cycle_name}: {apart:?}"
        );
        // A converter moves with its engine's speed; a clutch does not.
        let (speed, wheel_nm) = if word.starts_with("civic") {
            (2e-3, 1.0)
        } else {
            (1e-4, 0.5)
        };
        assert!(
            apart.speed < speed && apart.belt_k < 0.1 && apart.wheel_nm < wheel_nm,
            "{word} {cycle_name}: {apart:?}"
        );
    }
}

/// A step of a warm car.
fn warm(engine_nm: f64, wheel_rad_s: [f64; 2], ratio: f64, dt_s: f64) -> Given {
    Given {
        engine_nm,
        wheel_rad_s,
        ratio,
        sump_k: ZERO + 80.0,
        engine_k: [ZERO + 90.0; 2],
        dt_s,
    }
}

/// A car pulls away by a torque: its clutch or converter slips, then locks; what the engine gave is at the wheels, lost, or turns.
#[test]
fn a_torque_launches_a_car() {
    for word in ["rover_216_cvt", "civic_20_cvt"] {
        let own = car(word, &[]).car(AMBIENT_K);
        let mut forward = Forward::new(&own, State::at(ZERO + 80.0)).expect("a CVT");
        let (radius_m, mass_kg) = (own.road_load.wheel_radius_m, own.road_load.inertia_kg);
        let Transmission::Cvt(cvt) = &own.transmission else {
            unreachable!("a CVT")
        };
        let (low, dt_s) = (cvt.ratio.low, 0.02);
        let (mut wheel_rad_s, mut before_nm, mut slipped, mut locked) = (0.0_f64, 0.0, 0, 0);
        let (mut engine_rad_s, mut jumps) = (0.0, 0);
        for k in 0..500 {
            let next = wheel_rad_s + dt_s * before_nm / (mass_kg * radius_m * radius_m);
            let turned = forward.step(&warm(80.0, [wheel_rad_s, next], low, dt_s));
            assert!(open_share(&turned) < 1e-12);
            assert!(
                (turned.taken_nm - 80.0).abs() < 1e-3 || k < 3,
                "{k}: {turned:?}"
            );
            // No jump of torque or speed: a launch is smooth.
            let nm = turned.wheel_nm();
            assert!((0.0..4000.0).contains(&nm), "{word} {k}: {nm}");
            let rise = turned.output.engine_rad_s - engine_rad_s;
            jumps += usize::from(k > 5 && rise.abs() > 20.0);
            engine_rad_s = turned.output.engine_rad_s;
            let slips = engine_rad_s > 1.05 * low * cvt.final_drive.ratio * turned.wheel_rad_s;
            if slips {
                slipped += 1;
            } else {
                locked += 1;
            }
            (wheel_rad_s, before_nm) = (next, nm);
        }
        // A lock-up takes a time to close (TC-9).
        assert_eq!(jumps, 0, "{word}");
        assert!(slipped > 5 && locked > 50, "{word}: {slipped} {locked}");
        assert!(wheel_rad_s * radius_m > 5.0, "{word}: {wheel_rad_s}");
    }
}

/// RC-15: a ratio that is asked for at once comes at the box's own rates, and is the one asked for at the end.
#[test]
fn a_ratio_that_is_asked_for_comes_at_the_rate_of_the_box() {
    let own = car("rover_216_cvt", &[]).car(AMBIENT_K);
    let Transmission::Cvt(cvt) = &own.transmission else {
        unreachable!("a CVT")
    };
    let mut forward = Forward::new(&own, State::at(ZERO + 80.0)).expect("a CVT");
    let (dt_s, high, low) = (0.1, cvt.ratio.high, cvt.ratio.low);
    let mut before = f64::NAN;
    let mut rates = Vec::new();
    for k in 0..200 {
        let asked = if k < 100 { high } else { low };
        let turned = forward.step(&warm(40.0, [60.0, 60.0], asked, dt_s));
        let ratio = turned.output.belt_ratio;
        if before.is_finite() {
            rates.push((ratio / before).ln() / dt_s);
        }
        before = ratio;
        if k == 99 {
            assert!((ratio - high).abs() < 1e-12, "{ratio}");
        }
    }
    assert!((before - low).abs() < 1e-12, "{before}");
    let fastest = rates.iter().fold([0.0_f64; 2], |[up, down], rate| {
        [up.max(-rate), down.max(*rate)]
    });
    let limit = [cvt.ratio.up_per_s, cvt.ratio.down_per_s];
    for (found, limit) in fastest.iter().zip(limit) {
        assert!(
            *found <= limit * (1.0 + 1e-9) && *found > 0.2 * limit,
            "{found} of {limit}"
        );
    }
}

/// FO-2: what no engine of the file gives is replaced by the nearest, on both sides.
#[test]
fn a_torque_beyond_the_engine_is_the_nearest() {
    let own = car("rover_216_cvt", &[]).car(AMBIENT_K);
    let taken = |engine_nm: f64| {
        let mut forward = Forward::new(&own, State::at(ZERO + 80.0)).expect("a CVT");
        let mut turned = forward.step(&warm(engine_nm, [60.0, 60.0], 1.0, 0.1));
        for _ in 0..30 {
            turned = forward.step(&warm(engine_nm, [60.0, 60.0], 1.0, 0.1));
        }
        assert!(open_share(&turned) < 1e-12);
        (
            turned.taken_nm,
            turned.output.engine_rad_s,
            turned.wheel_nm(),
        )
    };
    let engine = own
        .engine
        .at(ZERO + 90.0, ZERO + 90.0, &own.engine_oil, own.charge);
    let (most_nm, w, _) = taken(1000.0);
    let full_nm = engine.full_load_nm(w) - engine.accessories_nm(w);
    assert!(
        (most_nm / full_nm - 1.0).abs() < 1e-3,
        "{most_nm} {full_nm}"
    );
    let (least_nm, w, _) = taken(-1000.0);
    let drag_nm = engine.drag_nm(w) + engine.accessories_nm(w);
    assert!(
        (least_nm / -drag_nm - 1.0).abs() < 1e-3,
        "{least_nm} {drag_nm}"
    );
    // Between them more torque gives more torque.
    let wheel: Vec<f64> = [-1000.0, -10.0, 0.0, 30.0, 60.0, 1000.0]
        .map(|nm| taken(nm).2)
        .into();
    assert!(wheel.windows(2).all(|pair| pair[0] < pair[1]), "{wheel:?}");
}

#[test]
fn a_manual_box_has_no_such_drive() {
    let own = car("rover_216_5mt", &[]).car(AMBIENT_K);
    assert!(Forward::new(&own, State::at(AMBIENT_K)).is_none());
}
