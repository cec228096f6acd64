//! Clamp laws that look at the belt, PC-3 and PC-4, their floor and cap, and the state in which a drive begins.

use super::{near, same};
use crate::common::{CARS, ZERO, car};
use cvtcycle_model::drive::Car;
use cvtcycle_model::fluid::BandFriction;
use cvtcycle_model::road::WheelDemand;
use cvtcycle_model::thermal::{Heat, NODES};
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::controller::{ClampLaw, ClampSignals};
use cvtcycle_model::transmission::cvt::variator::{BeltAtRatio, BeltLoad, belt_state};
use cvtcycle_model::transmission::{StepInput, Transmission, TransmissionState};

fn shipped() -> Car {
    car(CARS[0], &[]).car(293.15)
}

fn cvt(car: &mut Car) -> &mut Cvt {
    let Transmission::Cvt(cvt) = &mut car.transmission else {
        panic!("a CVT")
    };
    cvt.centrifugal_n_s2 = 2e-3;
    cvt
}

fn load(torque: f64) -> BeltLoad {
    BeltLoad {
        primary_speed_rad_s: 250.0,
        output_torque_nm: torque,
        secondary_clamp_n: 0.0,
        band: BandFriction {
            mu: 0.11,
            film_share: 0.0,
        },
        eta_pa_s: 0.01,
        film_thickness_m: 5e-7,
        segment_friction: 0.125,
        flank_friction: 0.13,
    }
}

const SIGNALS: ClampSignals = ClampSignals {
    throttle: 0.4,
    engine_rad_s: 250.0,
    oil_k: 330.0,
    radius_factor: 0.5,
};

/// PC-3: both signs of torque, the least torque, ratios on both sides of 1, and the bounds.
#[test]
fn val_torque_following_by_hand() {
    let mut car = shipped();
    let cvt = cvt(&mut car);
    cvt.clamp = ClampLaw::TorqueFollowing {
        safety: 1.3,
        least_torque_nm: 25.0,
    };
    (cvt.floor_pa, cvt.cap_pa) = (7e5, 30e5);
    let mut seen = [0; 3];
    for ratio in [0.45, 0.8, 0.96, 0.98, 1.0, 1.5, 2.4] {
        let at = BeltAtRatio::new(&cvt.belt, ratio);
        for torque in [-120.0f64, -25.0, -24.0, 0.0, 26.0, 90.0, 200.0, 500.0] {
            let weaker = at.thrust_ratio.min(1.0);
            let force = 1.3 * torque.abs().max(25.0) * cvt.belt.cos_wedge
                / (2.0 * 0.125 * at.geometry.secondary_radius_m * weaker);
            let pa = (force - cvt.spring_n - 2e-3 * 90.0 * 90.0) / cvt.secondary_piston_m2;
            near(
                cvt.pressure_pa(&SIGNALS, &at, || load(torque), 90.0),
                pa.clamp(7e5, 30e5),
                1e-12,
            );
            seen[if pa < 7e5 {
                0
            } else if pa > 30e5 {
                2
            } else {
                1
            }] += 1;
        }
    }
    assert!(seen.iter().all(|n| *n > 0), "{seen:?}");
}

/// PC-4 against a walk in steps of 200 Pa: the lowest pressure that keeps slip below the limit, the least slip where none does, never below
/// the torque's own pressure.
#[test]
fn val_slip_limited_against_a_fine_walk() {
    let mut car = shipped();
    let cvt = cvt(&mut car);
    (cvt.floor_pa, cvt.cap_pa) = (4e5, 44e5);
    let (mut met, mut floor, mut none) = (0, 0, 0);
    for (ratio, torque) in [
        (0.45, 30.0),
        (0.45, -30.0),
        (0.9, 60.0),
        (1.6, 90.0),
        (2.4, 100.0),
        (2.4, 170.0),
        (2.4, 400.0),
        (2.0, 5.0),
    ] {
        let at = BeltAtRatio::new(&cvt.belt, ratio);
        let slip = |cvt: &Cvt, pa: f64| {
            let l = BeltLoad {
                secondary_clamp_n: cvt.secondary_clamp_n(pa, 90.0),
                ..load(torque)
            };
            belt_state(&cvt.belt, &at, &l).losses.slip_total.abs()
        };
        for (limit, safety) in [
            (0.002, 1.05),
            (0.01, 1.05),
            (0.03, 1.05),
            (0.01, 2.5),
            (0.03, 4.0),
        ] {
            cvt.clamp = ClampLaw::TorqueFollowing {
                safety,
                least_torque_nm: 10.0,
            };
            let least = cvt.pressure_pa(&SIGNALS, &at, || load(torque), 90.0);
            cvt.clamp = ClampLaw::SlipLimited {
                slip: limit,
                safety,
                least_torque_nm: 10.0,
            };
            let got = cvt.pressure_pa(&SIGNALS, &at, || load(torque), 90.0);
            let steps = ((44e5 - least) / 200.0) as u32;
            let walk = || (0..=steps).map(|k| least + 200.0 * f64::from(k));
            if least >= 44e5 || slip(cvt, least) <= limit {
                same(got, least);
                floor += 1;
            } else if let Some(pa) = walk().find(|pa| slip(cvt, *pa) <= limit) {
                assert!(
                    got <= pa + 1.0 && got >= pa - 201.0,
                    "I {ratio} T {torque}: {got} instead of {pa}"
                );
                assert!(slip(cvt, got) <= limit * (1.0 + 1e-9));
                met += 1;
            } else {
                let best = walk().map(|pa| slip(cvt, pa)).fold(f64::INFINITY, f64::min);
                assert!(
                    slip(cvt, got) <= best * (1.0 + 1e-6),
                    "I {ratio} T {torque}: {} instead of {best}",
                    slip(cvt, got)
                );
                none += 1;
            }
        }
    }
    assert!(met > 2 && floor > 2 && none > 2, "{met} {floor} {none}");
}

fn begin(car: &Car, wheel_rad_s: f64, power_w: f64) -> TransmissionState {
    let engine = car.engine.at(300.0, 300.0, &car.engine_oil, 1.0);
    let wheel = WheelDemand {
        speed_m_s: wheel_rad_s * 0.28,
        wheel_rad_s,
        power_w,
        ..WheelDemand::default()
    };
    let heat = Heat {
        node_k: [20.0 + ZERO; NODES],
    };
    car.transmission.start(&StepInput {
        wheel: &wheel,
        engine: &engine,
        oil: &car.oil,
        heat: &heat,
        gear: None,
        dt_s: 1.0,
        engine_off: false,
    })
}

/// A drive begins in low at rest, and rolling in the ratio of the variogram, within its limits; the engine idles or turns with the box.
#[test]
fn val_start_by_hand() {
    let car = shipped();
    let Transmission::Cvt(cvt) = &car.transmission else {
        panic!("a CVT")
    };
    let engine = car.engine.at(300.0, 300.0, &car.engine_oil, 1.0);
    let idle = engine.idle_rad_s;
    for (wheel, power) in [
        (0.0, 0.0),
        (2.0, 1e3),
        (20.0, 3e3),
        (20.0, -2e3),
        (60.0, 10e3),
        (60.0, 45e3),
        (120.0, 5e3),
    ] {
        let state = begin(&car, wheel, power);
        let c = &cvt.ratio;
        let (ws, share) = (cvt.final_drive.ratio * wheel, power / car.engine.rated_w);
        let mut target = c.overrun_rad_s
            + (share / c.gentle_share).clamp(0.0, 1.0) * (c.gentle_rad_s - c.overrun_rad_s);
        target += c.rise_rad_s * (share - c.gentle_share).max(0.0);
        if share > 0.0 {
            target = target.max(super::route_rad_s(cvt, &engine, power / c.route_efficiency));
        }
        let ratio = if ws > 0.0 {
            (target.min(c.highest_rad_s) / ws).clamp(c.high, c.low)
        } else {
            c.low
        };
        same(state.cvt.unwrap().belt.geometry.ratio, ratio);
        same(state.driveline.engine_rad_s, (ratio * ws).max(idle));
        assert_eq!(
            (
                state.driveline.coupled,
                state.driveline.stood,
                state.cvt.unwrap().warm_start.overrun
            ),
            (ratio * ws > idle, wheel == 0.0, false),
            "{wheel}"
        );
        same(state.driveline.secondary_pa, cvt.floor_pa);
    }
    let manual = crate::common::car(CARS[1], &[]).car(293.15);
    let Transmission::Manual(m) = &manual.transmission else {
        panic!("a manual box")
    };
    let idle = manual
        .engine
        .at(300.0, 300.0, &manual.engine_oil, 1.0)
        .idle_rad_s;
    for wheel in [0.0, 4.0, 40.0, 120.0] {
        let past = begin(&manual, wheel, 0.0).driveline;
        let gear = if wheel > 0.0 {
            m.shifts.for_speed(wheel * 0.28, 1, m.overall.len())
        } else {
            0
        };
        let input = if gear > 0 {
            m.overall[usize::from(gear) - 1] * wheel
        } else {
            0.0
        };
        assert_eq!(
            (past.gear, past.coupled, past.stood),
            (gear, input > idle, true)
        );
        same(past.engine_rad_s, input.max(idle));
    }
}
