//! Ratio control RC-1 to RC-8, RC-10, RC-11, clamp map PC-1 and PC-2, launch clutch LC-1 to LC-5.

use super::same;
use cvtcycle_model::math::Curve;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::coupling::{Coupling, CouplingLoad, FrictionClutch};
use cvtcycle_model::transmission::cvt::controller::{
    ClampSignals, ColdRise, MapLaw, Moment, OperatingLine, RatioControl, RatioDemand,
};

fn control() -> RatioControl {
    RatioControl {
        low: 2.4,
        high: 0.41,
        gentle_rad_s: 180.0,
        gentle_share: 0.15,
        rise_rad_s: 420.0,
        overrun_rad_s: 150.0,
        highest_rad_s: 600.0,
        route_efficiency: 0.85,
        up_per_s: 0.35,
        down_per_s: 0.9,
        rate_speed_rad_s: 100.0,
        hysteresis: 0.05,
        filter_s: 0.0,
        cold: ColdRise::NONE,
        line: None,
        shift_map: None,
    }
}

fn demand(power_share: f64, secondary_rad_s: f64, before: f64) -> RatioDemand {
    RatioDemand {
        begins: None,
        secondary_rad_s,
        primary_rad_s: before * secondary_rad_s,
        speed_m_s: 10.0,
        power_w: power_share * 80e3,
        share: power_share,
        full_load_rad_s: 0.0,
        mapped_rad_s: None,
        cold_rad_s: 0.0,
        ratio_before: before,
        flow_down_per_s: 9.0,
        flow_up_per_s: 9.0,
        coupled: true,
        locks_at: 1.0,
        last_direction: 0,
        free_up_to_rad_s: 0.0,
        dt_s: 0.5,
    }
}

/// RC-1, RC-2, RC-3, RC-8.
#[test]
fn val_target_by_hand() {
    let c = control();
    for (share, want) in [
        (-0.1, 150.0),
        (0.0, 150.0),
        (0.02, 154.0),
        (0.075, 165.0),
        (0.15, 180.0),
        (0.45, 180.0 + 420.0 * 0.3),
        (1.4, 600.0),
    ] {
        same(c.target_rad_s(&demand(share, 100.0, 1.0)), want);
    }
    let steep = RatioControl {
        gentle_share: 0.0,
        ..control()
    };
    for (share, want) in [(0.0, 150.0), (0.004, 162.0 + 420.0 * 0.004), (0.01, 184.2)] {
        same(steep.target_rad_s(&demand(share, 100.0, 1.0)), want);
    }
    let route = |share: f64, full_load_rad_s: f64| {
        c.target_rad_s(&RatioDemand {
            full_load_rad_s,
            ..demand(share, 100.0, 1.0)
        })
    };
    same(route(0.2, 350.0), 350.0);
    same(route(0.2, 190.0), 201.0);
    same(route(0.2, 800.0), 600.0);
    same(route(-0.2, 350.0), 150.0);
    same(route(0.0, 350.0), 150.0);
}

/// RC-13: each line in place of the gentle targets, linear between its rows and held at its ends, above the clutch's speed; RC-3 and RC-8 go on.
#[test]
fn val_lines_by_hand() {
    let curve = |points: &[(f64, f64)]| Some(Curve::new(points).unwrap());
    let both = OperatingLine {
        drive: curve(&[(0.0, 120.0), (0.1, 140.0), (0.5, 300.0)]),
        overrun: curve(&[(5.0, 130.0), (25.0, 170.0)]),
    };
    let lined = |line: OperatingLine| RatioControl {
        line: Some(Box::new(line)),
        ..control()
    };
    let c = lined(both.clone());
    for (share, want) in [(1e-9, 120.0), (0.05, 130.0), (0.3, 220.0), (0.9, 300.0)] {
        let got = c.target_rad_s(&demand(share, 100.0, 1.0));
        assert!((got - want).abs() < 1e-5, "{got} at {share}");
    }
    let at = |speed_m_s: f64, power_share: f64| RatioDemand {
        speed_m_s,
        ..demand(power_share, 100.0, 1.0)
    };
    for (speed, want) in [(1.0, 130.0), (15.0, 150.0), (40.0, 170.0)] {
        same(c.target_rad_s(&at(speed, -0.1)), want);
        same(c.target_rad_s(&at(speed, 0.0)), want);
    }
    // Without one of the lines RC-2 holds there.
    let drive_only = lined(OperatingLine {
        overrun: None,
        ..both.clone()
    });
    same(drive_only.target_rad_s(&at(15.0, -0.1)), 150.0);
    let overrun_only = lined(OperatingLine {
        drive: None,
        ..both
    });
    same(overrun_only.target_rad_s(&at(15.0, 0.075)), 165.0);
    // A clutch that would slip below 160 rad/s, the full-load route, and the speed of greatest power.
    let raised = |power_share: f64, full_load_rad_s: f64| RatioDemand {
        free_up_to_rad_s: 160.0,
        full_load_rad_s,
        ..demand(power_share, 100.0, 1.0)
    };
    same(c.target_rad_s(&raised(0.05, 0.0)), 160.96);
    same(c.target_rad_s(&raised(-0.05, 0.0)), 160.96);
    same(c.target_rad_s(&raised(0.05, 450.0)), 450.0);
    same(c.target_rad_s(&raised(0.05, 900.0)), 600.0);
}

/// RC-9: a first-order filter of any step, none at 0 s; RC-3 sees the demand itself, RC-1 and RC-2 what is left of it.
#[test]
fn val_filtered_demand_by_hand() {
    let filter = |filter_s: f64| RatioControl {
        filter_s,
        ..control()
    };
    // One second in steps of 1, 1/2 and 1/10 s with 2 s of time constant: 1 - exp(-1/2) of the way.
    for steps in [1, 2, 10] {
        let dt_s = 1.0 / f64::from(steps);
        let share = (0..steps).fold(0.1, |u, _| filter(2.0).filtered_share(u, [0.5; 2], dt_s));
        assert!(
            (share - (0.1 + 0.4 * 0.393_469_340_287)).abs() < 1e-10,
            "{share}"
        );
    }
    same(filter(0.0).filtered_share(0.1, [0.3, 0.5], 1e-3), 0.5);
    // A demand that rises in a line: as many steps of any length give the same.
    let rising = |steps: u32| {
        let at = |k: u32| 0.1 + 0.4 * f64::from(k) / f64::from(steps);
        let dt_s = 1.0 / f64::from(steps);
        (0..steps).fold(0.1, |u, k| {
            filter(2.0).filtered_share(u, [at(k), at(k + 1)], dt_s)
        })
    };
    same(rising(1), 0.5 - 0.8 * (1.0 - (-0.5_f64).exp()));
    same(rising(1), rising(7));
    let sudden = RatioDemand {
        share: 0.02,
        full_load_rad_s: 420.0,
        ..demand(0.6, 100.0, 1.0)
    };
    same(control().target_rad_s(&sudden), 420.0);
    let faded = RatioDemand {
        share: 0.35,
        full_load_rad_s: 420.0,
        ..demand(-0.1, 100.0, 1.0)
    };
    same(control().target_rad_s(&faded), 180.0 + 420.0 * 0.2);
}

/// RC-4, RC-5, RC-6: rate towards both ends, by pace, by flow and free, with the flag where flow holds.
#[test]
fn val_shift_by_hand() {
    let c = control();
    let step = |d: RatioDemand| {
        let way = c.step(&d);
        (way.end, way.change, way.held)
    };
    let check = |d: RatioDemand, change: f64, held: bool| {
        let got = step(d);
        same(got.1, change);
        same(got.0, d.ratio_before * change.exp());
        assert_eq!(got.2, held, "{d:?}");
    };
    // Towards high: target 180/300 = 0.6.
    check(demand(0.15, 300.0, 1.0), -0.175, false);
    check(demand(0.15, 300.0, 0.65), (0.6f64 / 0.65).ln(), false);
    check(
        RatioDemand {
            flow_up_per_s: 0.2,
            ..demand(0.15, 300.0, 1.0)
        },
        -0.1,
        true,
    );
    check(
        RatioDemand {
            flow_up_per_s: 0.2,
            ..demand(0.15, 300.0, 0.61)
        },
        (0.6f64 / 0.61).ln(),
        false,
    );
    check(
        RatioDemand {
            flow_down_per_s: 0.0,
            ..demand(0.15, 300.0, 1.0)
        },
        -0.175,
        false,
    );
    // Towards low: target 180/100 = 1.8.
    check(demand(0.15, 100.0, 1.0), 0.45, false);
    check(demand(0.15, 100.0, 1.7), (1.8f64 / 1.7).ln(), false);
    check(
        RatioDemand {
            flow_down_per_s: 0.3,
            ..demand(0.15, 100.0, 1.0)
        },
        0.15,
        true,
    );
    check(
        RatioDemand {
            flow_down_per_s: 0.3,
            ..demand(0.15, 100.0, 1.75)
        },
        (1.8f64 / 1.75).ln(),
        false,
    );
    check(
        RatioDemand {
            flow_up_per_s: 0.0,
            ..demand(0.15, 100.0, 1.0)
        },
        0.45,
        false,
    );
    // Flow above the rate is not what holds.
    check(
        RatioDemand {
            flow_down_per_s: 0.95,
            ..demand(0.15, 100.0, 1.0)
        },
        0.45,
        false,
    );
    check(
        RatioDemand {
            flow_up_per_s: 0.36,
            ..demand(0.15, 300.0, 1.0)
        },
        -0.175,
        false,
    );
    // Slow primary: 0.8 of 50 rad/s are 40 % of the speed of the full rates.
    check(demand(0.15, 50.0, 0.8), 0.9 * 0.4 * 0.5, false);
    // Towards high with a slow primary: 300 of 400 rad/s; and flow that holds a change between what it gives in a step and in a second.
    let slow = RatioControl {
        rate_speed_rad_s: 400.0,
        ..control()
    };
    same(
        slow.step(&demand(0.15, 300.0, 1.0)).change,
        -0.35 * 0.75 * 0.5,
    );
    check(
        RatioDemand {
            flow_up_per_s: 0.2,
            ..demand(0.15, 300.0, 0.75)
        },
        -0.1,
        true,
    );
    check(
        RatioDemand {
            flow_down_per_s: 0.2,
            ..demand(0.15, 100.0, 1.44)
        },
        0.1,
        true,
    );
    // The ends of the ratio.
    let (low, _, _) = step(demand(0.15, 20.0, 2.39));
    same(low, 2.4);
    let (high, _, _) = step(demand(0.15, 900.0, 0.42));
    same(high, 0.41);
    // Not coupled: no up-shift, down-shift allowed.
    assert_eq!(
        step(RatioDemand {
            coupled: false,
            ..demand(0.15, 300.0, 1.0)
        }),
        (1.0, 0.0, false)
    );
    check(
        RatioDemand {
            coupled: false,
            ..demand(0.15, 100.0, 1.0)
        },
        0.45,
        false,
    );
    // At rest, and where nothing is wanted.
    assert_eq!(step(demand(0.15, 0.0, 1.3)), (1.3, 0.0, false));
    assert_eq!(step(demand(0.15, 100.0, 1.8)), (1.8, 0.0, false));
    // An unchanged ratio outside the limits comes back within them.
    same(step(demand(0.15, 300.0, 3.0)).0, 2.4);
}

/// PC-1 and PC-2 in each piece of f(n).
#[test]
fn val_clamp_map_by_hand() {
    let law = MapLaw {
        base_pa: 20e5,
        throttle_pa: 14e5,
        cold_per_k: 0.002,
        slow_factor: 0.6,
        slow_rad_s: 100.0,
        full_rad_s: 220.0,
        fall_s: 4e-4,
    };
    let f = |speed: f64| {
        let rise = 0.6 + 0.4 * ((speed - 100.0) / 120.0).clamp(0.0, 1.0);
        if speed > 220.0 {
            (rise - 4e-4 * (speed - 220.0)).max(0.6)
        } else {
            rise
        }
    };
    for speed in [
        50.0, 100.0, 160.0, 220.0, 221.0, 500.0, 1219.0, 1221.0, 2000.0,
    ] {
        for (throttle, degc, radius) in [(0.0, 80.0, 1.0), (0.3, 20.0, 0.4), (1.0, 110.0, 0.7)] {
            let s = ClampSignals {
                throttle,
                engine_rad_s: speed,
                oil_k: degc + 273.15,
                radius_factor: radius,
                force_log: 0.0,
            };
            same(
                law.pressure_pa(&s),
                f(speed) * (20e5 + 14e5 * throttle) * radius * (1.0 + 0.002 * (80.0 - degc)),
            );
        }
    }
    // A law whose slow factor is above 1 holds nothing back below the full speed.
    let odd = MapLaw {
        slow_factor: 1.5,
        ..law
    };
    let s = ClampSignals {
        throttle: 0.0,
        engine_rad_s: 160.0,
        oil_k: 353.15,
        radius_factor: 1.0,
        force_log: 0.0,
    };
    same(odd.pressure_pa(&s), 1.25 * 20e5);
}

/// RC-11: in full up to `from`, linear to nothing at `to`, by coolant or sump; added to the target under power, none without, and never above
/// RC-8.
#[test]
fn val_cold_line_by_hand() {
    let cold = ColdRise {
        rise_rad_s: 70.0,
        from_k: 270.0,
        to_k: 320.0,
        by_sump: false,
    };
    for (coolant, rise) in [
        (250.0, 70.0),
        (270.0, 70.0),
        (295.0, 35.0),
        (320.0, 0.0),
        (370.0, 0.0),
    ] {
        same(cold.at(coolant, 250.0), rise);
        let by_sump = ColdRise {
            by_sump: true,
            ..cold
        };
        same(by_sump.at(370.0, coolant), rise);
    }
    same(ColdRise::NONE.at(200.0, 200.0), 0.0);
    let c = control();
    let target = |share: f64, cold_rad_s: f64| {
        c.target_rad_s(&RatioDemand {
            cold_rad_s,
            ..demand(share, 100.0, 1.0)
        })
    };
    for (share, part) in [
        (-0.2, 0.0),
        (0.0, 0.0),
        (0.005, 0.5),
        (0.01, 1.0),
        (0.2, 1.0),
    ] {
        same(target(share, 35.0), target(share, 0.0) + 35.0 * part);
    }
    same(target(0.2, 1e4), c.highest_rad_s);
}

/// LC-1, LC-2, LC-3, LC-5 in each regime.
#[test]
fn val_launch_clutch_by_hand() {
    let c = FrictionClutch {
        engage_rad_s: 105.0,
        gain_nm_s2: 0.002,
        creep_nm: 5.0,
        release_rad_s: 110.0,
    };
    let idle = 90.0;
    let launch = |nm: f64| {
        let above = nm - 5.0;
        idle + 15.0 * (1.0 - (-above / 5.0f64).exp()) + (above / 0.002 + 20.944f64.powi(2)).sqrt()
            - 20.944
    };
    let speed = |nm: f64, input: f64, coupled: bool| {
        c.engine_rad_s(&CouplingLoad::new(nm, input, idle, coupled))
    };
    for nm in [-20.0, 0.0, 5.0] {
        same(speed(nm, 20.0, false), idle);
    }
    for nm in [5.5, 20.0, 90.0] {
        same(speed(nm, 20.0, false), launch(nm));
    }
    same(speed(20.0, 300.0, false), 300.0);
    same(speed(20.0, 300.0, true), 300.0);
    // Coupled: held from 1.2 idle on, free at idle, between them linear.
    same(speed(20.0, 108.0, true), 108.0);
    same(speed(20.0, 99.0, true), 99.0 + 0.5 * (launch(20.0) - 99.0));
    same(speed(20.0, 90.0, true), launch(20.0));
    same(speed(20.0, 99.0, false), launch(20.0));
    same(c.locked_from_rad_s(idle), 108.0);
    assert!((108.0 >= c.locked_from_rad_s(idle)) && 107.9 < c.locked_from_rad_s(idle));
    // An engaging speed below idle lifts nothing.
    let low = FrictionClutch {
        engage_rad_s: 60.0,
        ..c
    };
    same(
        low.engine_rad_s(&CouplingLoad::new(20.0, 0.0, idle, false)),
        idle + (15.0 / 0.002 + 20.944f64.powi(2)).sqrt() - 20.944,
    );
    for (input, nm) in [(0.0, 5.0), (45.0, 2.5), (90.0, 0.0), (200.0, 0.0)] {
        same(c.creep_nm(input, idle), nm);
    }
    // Release at 110: from 99 (1.1 idle) to 128; released earlier than that: from 99 to 117.
    for (input, share) in [
        (80.0, 0.0),
        (99.0, 0.0),
        (113.5, 0.5),
        (128.0, 1.0),
        (300.0, 1.0),
    ] {
        same(c.overrun_share(input, idle), share);
    }
    let early = FrictionClutch {
        release_rad_s: 50.0,
        ..c
    };
    same(early.overrun_share(108.0, idle), 0.5);
}

/// RC-10: a small reversal is not made, a large one in full, the ends of the ratio are reached, and near idle speed nothing is held.
#[test]
fn val_hysteresis_by_hand() {
    let c = control();
    let step = |last_direction: i8, before: f64| {
        c.step(&RatioDemand {
            last_direction,
            free_up_to_rad_s: 90.0,
            ..demand(0.15, 100.0, before) // towards 1.8
        })
    };
    for (last, before, moves) in [
        (-1, 1.8 / 1.04, false),
        (-1, 1.8 / 1.06, true),
        (1, 1.8 / 1.04, true),
        (0, 1.8 / 1.04, true),
        (1, 1.8 * 1.04, false),
        (1, 1.8 * 1.06, true),
        (-1, 1.8 * 1.04, true),
    ] {
        let way = step(last, before);
        let (ratio, change) = (way.end, way.change);
        same(ratio, if moves { 1.8 } else { before });
        same(change, if moves { (1.8 / before).ln() } else { 0.0 });
    }
    let slow = RatioDemand {
        last_direction: -1,
        free_up_to_rad_s: 190.0,
        ..demand(0.15, 100.0, 1.8 / 1.04)
    };
    same(c.step(&slow).end, 1.8);
    let low = RatioDemand {
        last_direction: -1,
        free_up_to_rad_s: 90.0,
        ..demand(0.15, 70.0, 2.35) // towards 2.57, held at the end
    };
    same(c.step(&low).end, 2.4);
    // The engine is not let above the speed of its greatest power: 600 rad/s.
    let fast = RatioDemand {
        last_direction: 1,
        ..demand(2.0, 300.0, 2.0 * 1.02)
    };
    same(c.step(&fast).end, 2.0);
}

/// RC-10 within a step (RC-17): a target that turns round while the ratio follows it is followed again from the hysteresis on, not from the next step.
/// Truth: the same rule in 20 000 steps of a ratio that either waits or moves at its rate.
#[test]
fn val_reversal_within_a_step() {
    let mut late = 0;
    for (up_per_s, hysteresis) in [(0.35, 0.05), (0.35, 0.02), (2.0, 0.05), (2.0, 0.6)] {
        let c = RatioControl {
            up_per_s,
            hysteresis,
            ..control()
        };
        for (first, slope) in [(0.04, -0.3), (0.1, -0.5), (-0.02, 0.3), (-0.05, 0.7)] {
            let before: f64 = 1.2;
            let wanted = [before * f64::exp(first), before * f64::exp(first + slope)];
            let mut d = RatioDemand {
                last_direction: 1,
                ..demand(0.15, 180.0 / wanted[1], before)
            };
            let begins = demand(0.15, 180.0 / wanted[0], before);
            d.primary_rad_s = 180.0;
            d.begins = Some(Moment {
                secondary_rad_s: begins.secondary_rad_s,
                speed_m_s: begins.speed_m_s,
                power_w: begins.power_w,
                share: begins.share,
                full_load_rad_s: begins.full_load_rad_s,
                mapped_rad_s: None,
            });
            if first < 0.0 {
                d.last_direction = -1;
            }
            let way = c.step(&d);

            let (steps, mut ln, mut area) = (20_000, 0.0, 0.0);
            let dt_s = d.dt_s / f64::from(steps);
            let mut direction = f64::from(d.last_direction);
            let mut waits = false;
            for k in 0..steps {
                let target = first + slope * (f64::from(k) + 0.5) / f64::from(steps);
                let away: f64 = target - ln;
                waits |= away * direction < 0.0;
                if waits && away.abs() > hysteresis {
                    (waits, direction) = (false, away.signum());
                }
                let rate = if away > 0.0 { c.down_per_s } else { c.up_per_s };
                if !waits {
                    ln += away.signum() * (rate * dt_s).min(away.abs());
                }
                area += ln * dt_s;
            }
            let place = format!("{up_per_s} {hysteresis} {first} {slope}: {way:?}");
            assert!((way.change - ln).abs() < 2e-4, "{place}: {ln}");
            let mean = (way.mean / before).ln();
            assert!((mean - area / d.dt_s).abs() < 2e-4, "{place}: {area}");
            assert_eq!(way.last * direction > 0.0, way.last != 0.0, "{place}");
            late += i32::from((ln - first - slope).abs() > 0.01);
        }
    }
    // Some of them do not come back to the target within the step.
    assert!((4..12).contains(&late), "{late}");
}

/// A target at which full load has a quarter more than the power asked for is not below the route, so that RC-3 need not be worked out there: cars,
/// temperatures, air and powers all over. In thinner air and colder than this the three passes end far above the speed that they go to.
#[test]
fn a_target_with_power_to_spare_is_above_the_route() {
    let (mut ample, mut short) = (0, 0);
    for name in ["rover_216_cvt", "civic_20_cvt"] {
        let setup = crate::common::car(name, &[]);
        let Transmission::Cvt(cvt) = setup.transmission() else {
            panic!("{name} has no CVT")
        };
        let e = setup.engine();
        for (temp_k, least_charge) in [
            (233.15, 0.9),
            (243.15, 0.8),
            (253.15, 0.6),
            (298.15, 0.6),
            (363.15, 0.6),
        ] {
            for charge in [least_charge, 1.0, 1.1] {
                let engine = e.at(temp_k, temp_k, setup.oils().1, charge);
                for i in 0..=60 {
                    let span = e.highest_rad_s - e.idle_hot_rad_s;
                    let target = e.idle_hot_rad_s + span * f64::from(i) / 60.0;
                    for j in 1..=60 {
                        let power_w = 1.2 * e.rated_w * f64::from(j) / 60.0;
                        if 0.8 * engine.full_load_nm(target) * target > power_w {
                            let route = cvt.full_load_rad_s(&engine, power_w);
                            let place = format!("{name} {temp_k} K {charge} {power_w} W");
                            assert!(route <= target, "{place}: {route} over {target}");
                            ample += 1;
                        } else {
                            short += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(ample > 1000 && short > 1000);
}
