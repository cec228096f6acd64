//! Clamp laws that look at the belt, PC-3 and PC-4, their floor and cap, and the state in which a drive begins.

use super::{near, same};
use crate::common::{CARS, ZERO, car, cycle, soak_rows};
use cvtcycle_model::drive::Car;
use cvtcycle_model::lubricant::BandFriction;
use cvtcycle_model::road::WheelDemand;
use cvtcycle_model::thermal::{Heat, NODES};
use cvtcycle_model::transmission::clamp_cause::ClampCause;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::controller::{ClampLaw, ClampSignals};
use cvtcycle_model::transmission::cvt::floors::Floors;
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
        band: BandFriction::dry(0.11),
        film_n: [0.0; 2],
        segment_friction: 0.125,
        capacity_friction: 0.115,
        flank_friction: 0.13,
    }
}

const SIGNALS: ClampSignals = ClampSignals {
    throttle: 0.4,
    engine_rad_s: 250.0,
    oil_k: 330.0,
    radius_factor: 0.5,
    force_log: 0.0,
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
    (cvt.floors, cvt.cap_pa) = (Floors::of_control(7e5), 30e5);
    let mut seen = [0; 3];
    for ratio in [0.45, 0.8, 0.96, 0.98, 1.0, 1.5, 2.4] {
        let at = BeltAtRatio::new(&cvt.belt, ratio);
        for torque in [-120.0f64, -25.0, -24.0, 0.0, 26.0, 90.0, 200.0, 500.0] {
            let weaker = at.thrust_ratio.min(1.0);
            let force = 1.3 * torque.abs().max(25.0) * cvt.belt.cos_wedge
                / (2.0 * 0.115 * at.geometry.secondary_radius_m * weaker);
            let pa = (force - cvt.spring_n - 2e-3 * 90.0 * 90.0) / cvt.secondary_piston_m2;
            near(
                cvt.pressure_pa(&SIGNALS, &at, || load(torque), 90.0).0,
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
    (cvt.floors, cvt.cap_pa) = (Floors::of_control(4e5), 44e5);
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
            let least = cvt.pressure_pa(&SIGNALS, &at, || load(torque), 90.0).0;
            cvt.clamp = ClampLaw::SlipLimited {
                slip: limit,
                safety,
                least_torque_nm: 10.0,
            };
            let got = cvt.pressure_pa(&SIGNALS, &at, || load(torque), 90.0).0;
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

/// PC-5: each cause by hand, alone and against the others; the largest is the pressure, and is named.
#[test]
fn val_floors_by_hand() {
    let mut car = shipped();
    let cvt = cvt(&mut car);
    cvt.cap_pa = 60e5;
    cvt.clamp = ClampLaw::TorqueFollowing {
        safety: 1.3,
        least_torque_nm: 1.0,
    };
    let own_n = cvt.spring_n + 2e-3 * 90.0 * 90.0;
    let mut seen = [0; ClampCause::NAMES.len()];
    for (control_pa, clutch_return_pa, clutch, strand_n) in [
        (5e5, 1e5, 0.06e5, 300.0),
        (1e5, 1e5, 0.02e5, 3000.0),
        (1e5, 1e5, 0.2e5, 300.0),
        (0.1e5, 0.1e5, 0.0, 0.0),
    ] {
        cvt.floors = Floors {
            control_pa,
            clutch_return_pa,
            clutch_pa_per_nm: clutch,
            strand_n,
            creep_per_rad: 0.02,
        };
        for ratio in [0.45, 0.8, 1.5, 2.4] {
            let at = BeltAtRatio::new(&cvt.belt, ratio);
            for torque in [-60.0f64, 0.0, 20.0, 60.0, 120.0] {
                for force_log in [-0.6, -0.1, 0.0, 0.1, 0.6f64] {
                    let weaker = at.thrust_ratio.min(1.0);
                    let need_n = 1.3 * torque.abs().max(1.0) * cvt.belt.cos_wedge
                        / (2.0 * 0.115 * at.geometry.secondary_radius_m * weaker);
                    let pa = |force_n: f64| (force_n - own_n) / cvt.secondary_piston_m2;
                    // Towards high, the pressure at which the primary's piston just has its force, by bisection.
                    let short = |p: f64| {
                        let secondary_n = p * cvt.secondary_piston_m2 + own_n;
                        p * cvt.primary_piston_m2
                            < at.thrust_ratio * secondary_n * (-force_log).exp()
                    };
                    let (mut low, mut high) = (0.0, 1e9);
                    for _ in 0..200 {
                        let middle = 0.5 * (low + high);
                        *(if short(middle) { &mut low } else { &mut high }) = middle;
                    }
                    let strands_n =
                        strand_n * at.geometry.secondary_wrap_rad / 2.0 / cvt.belt.tan_wedge;
                    let needs = [
                        (pa(need_n), ClampCause::Law),
                        (control_pa, ClampCause::Control),
                        (
                            clutch_return_pa + clutch * torque.abs() / ratio,
                            ClampCause::Clutch,
                        ),
                        (pa(strands_n), ClampCause::Belt),
                        (
                            if force_log > 0.0 {
                                pa(need_n * force_log.exp())
                            } else {
                                0.0
                            },
                            ClampCause::ShiftDown,
                        ),
                        (
                            if force_log < 0.0 { high } else { 0.0 },
                            ClampCause::ShiftUp,
                        ),
                    ];
                    let (mut want, mut cause) = needs[0];
                    for need in needs {
                        if need.0 > want {
                            (want, cause) = need;
                        }
                    }
                    if want > 60e5 {
                        (want, cause) = (60e5, ClampCause::Cap);
                    }
                    let signals = ClampSignals {
                        force_log,
                        ..SIGNALS
                    };
                    let got = cvt.pressure_pa(&signals, &at, || load(torque), 90.0);
                    near(got.0, want, 1e-9);
                    assert_eq!(got.1, cause, "{ratio} {torque} Nm {force_log}: {want} Pa");
                    seen[cause as usize] += 1;
                }
            }
        }
    }
    assert!(seen.iter().all(|n| *n > 0), "{seen:?}");
    // The map was measured with its causes in it: only control holds it up.
    let map = car_map();
    let at = BeltAtRatio::new(&map.belt, 0.45);
    let shifting = ClampSignals {
        force_log: 2.0,
        ..SIGNALS
    };
    let got = map.pressure_pa(&shifting, &at, || load(120.0), 90.0);
    assert_eq!(
        got,
        map.pressure_pa(&SIGNALS, &at, || load(0.0), 90.0),
        "{got:?}"
    );
    assert_eq!(got.1, ClampCause::Law);
    // r = 1/s at 1000 rpm of the primary takes a force ratio exp(1/(104.72 x 0.02)) = 1.612; nothing at rest.
    let floors = &map.floors;
    near(floors.force_log(1.0, 104.7198).exp(), 1.6120, 1e-3);
    assert!(floors.force_log(0.0, 0.0) == 0.0 && floors.force_log(-1.0, 50.0) < 0.0);
}

/// The shipped CVT with its map.
fn car_map() -> Cvt {
    match shipped().transmission {
        Transmission::Cvt(cvt) => *cvt,
        Transmission::Manual(_) => panic!("a CVT"),
    }
}

/// A clamp that follows the torque counts its causes: their seconds are the moving time, control holds most of it, and a higher one costs
/// fuel. Under the map, capacity friction moves safety and nothing else.
#[test]
fn electronic_clamp_counts_its_floors() {
    let run = |set: &[&str]| soak_rows(&car(CARS[0], set), &cycle("ece15_eudc"), 25.0);
    let following = "transmission.cvt.clamp=torque_following";
    let (low, low_rows) = {
        let run = run(&[following]);
        (run.totals, run.rows)
    };
    let sum: f64 = low.clamp_cause_s.iter().sum();
    let moving: f64 = low_rows
        .iter()
        .filter(|row| row.speed_m_s > 0.0)
        .map(|row| row.dt_s)
        .sum();
    near(sum, moving, 1e-9);
    let share = low.clamp_cause_s[ClampCause::Control as usize] / sum;
    assert!((0.6..0.95).contains(&share), "control {share}");
    let high = run(&[following, "transmission.cvt.pressure.control_bar=9"]).totals;
    let more = high.total().fuel_kg / low.total().fuel_kg - 1.0;
    println!("control 5 to 9 bar: {:.2} % of fuel", 100.0 * more);
    assert!((0.015..=0.023).contains(&more), "{more}");
    let map = run(&[]).totals;
    let gripping = run(&["lubricant.friction.capacity=0.18"]).totals;
    assert!(map.total().fuel_kg == gripping.total().fuel_kg);
    near(gripping.min_clamp_safety, 2.0 * map.min_clamp_safety, 1e-12);
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
        neutral_share: 0.0,
        kinetic_j: f64::NAN, // before it begins
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
        same(state.driveline.secondary_pa, cvt.floors.control_pa);
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
