//! Road load: RL-1 to RL-8, and wheel work over a whole cycle.

use super::{near, same};
use cvtcycle_config::cycle::{Motion, Step, embedded};
use cvtcycle_config::setup::{Options, load};
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::road::{Ambient, RoadLoad, Surface, Tyre};

fn car() -> RoadLoad {
    RoadLoad {
        f0_n: 110.0,
        f1_n_per_m_s: 1.3,
        f2_n_per_m_s2: 0.42,
        mass_kg: 1200.0,
        inertia_kg: 1236.0,
        wheel_radius_m: 0.29,
    }
}

fn step(from: f64, to: f64, grade: f64) -> Step {
    let dt_s = 1.5;
    Step {
        time_s: 10.0,
        dt_s,
        start_speed_m_s: from,
        end_speed_m_s: to,
        motion: Motion::between(from, to, dt_s),
        phase: 0,
        grade,
        engine_off: false,
        interval: 0,
    }
}

/// Work in drive and in braking by a fine sum over the step (RL-1, RL-5).
fn summed(car: &RoadLoad, s: &Step) -> (f64, f64) {
    summed_with(car, s, 0.0)
}

/// The same with a force that is no part of the coefficients.
fn summed_with(car: &RoadLoad, s: &Step, extra_n: f64) -> (f64, f64) {
    let n = 40_000;
    let a = (s.end_speed_m_s - s.start_speed_m_s) / s.dt_s;
    let slope = 9.80665 * s.grade.atan().sin();
    let mut work = (0.0, 0.0);
    for i in 0..n {
        let t = (f64::from(i) + 0.5) / f64::from(n) * s.dt_s;
        let v = s.start_speed_m_s + a * t;
        let force = car.f0_n
            + extra_n
            + car.f1_n_per_m_s * v
            + car.f2_n_per_m_s2 * v * v
            + car.inertia_kg * a
            + car.mass_kg * slope;
        let part = force * v * s.dt_s / f64::from(n);
        if part > 0.0 {
            work.0 += part
        } else {
            work.1 += part
        }
    }
    work
}

/// RL-1 and RL-5 against the sum: drive, braking, and steps in which the force changes sign, up and down, on hills.
#[test]
fn val_work_against_a_fine_sum() {
    let linear = RoadLoad {
        f2_n_per_m_s2: 0.0,
        ..car()
    };
    let none = RoadLoad {
        f1_n_per_m_s: 0.0,
        f2_n_per_m_s2: 0.0,
        ..car()
    };
    let mut split = [0; 3];
    for (k, car) in [car(), linear, none].into_iter().enumerate() {
        for (from, to, grade) in [
            (10.0, 12.0, 0.0),
            (12.0, 10.0, 0.0),
            (20.0, 20.0, 0.04),
            (20.0, 20.0, -0.04),
            (30.0, 29.5, 0.0),
            (25.0, 24.5, 0.0),
            (15.0, 30.0, -0.9),
            (30.0, 15.0, 0.85),
            (26.0, 18.0, 0.45),
            (18.0, 26.0, -0.47),
            (0.0, 3.0, 0.0),
            (3.0, 0.0, 0.0),
            // The force changes sign at about 25 m/s: coasting, on hills, up and down.
            (25.25, 24.76, 0.0),
            (30.0, 20.0, 0.8914),
            (20.0, 30.0, -1.0841),
            (22.0, 30.0, -0.8076),
            (30.0, 20.0, 0.9483),
            (20.0, 30.0, -1.0178),
        ] {
            let s = step(from, to, grade);
            let (got, want) = (car.wheel(&s, 0.0), summed(&car, &s));
            let scale = 1e-5 * (want.0 - want.1) + 1e-3;
            assert!(
                (got.positive_j - want.0).abs() <= scale,
                "{from} {to} {grade}: {} instead of {}",
                got.positive_j,
                want.0
            );
            assert!(
                (got.negative_j - want.1).abs() <= scale,
                "{from} {to} {grade}: {} instead of {}",
                got.negative_j,
                want.1
            );

            same(got.positive_j + got.negative_j, got.power_w * s.dt_s);
            split[k] += u32::from(got.positive_j > 1.0 && got.negative_j < -1.0);
            same(got.wheel_rad_s, 0.5 * (from + to) / 0.29);
            same(got.accel_m_s2, (to - from) / 1.5);
        }
    }
    assert!(split[0] > 2 && split[1] > 0 && split[2] == 0, "{split:?}");
    let rest = car().wheel(&step(0.0, 0.0, 0.1), 0.0);
    assert!(rest.power_w == 0.0 && rest.wheel_rad_s == 0.0);
}

/// RL-2 and RL-4 by hand.
#[test]
fn val_ambient_by_hand() {
    let ambient = Ambient {
        temp_k: 263.15,
        altitude_m: 1500.0,
    };
    let pressure = (1.0 - 2.25577e-5 * 1500.0f64).powf(5.25588);
    same(ambient.pressure_ratio(), pressure);
    same(ambient.density_ratio(), pressure * 293.15 / 263.15);
    let road = car().for_ambient(Surface::Road, &ambient, 0.00864);
    same(road.f0_n, 110.0 * (1.0 + 0.00864 * 30.0));
    same(road.f1_n_per_m_s, 1.3);
    same(road.f2_n_per_m_s2, 0.42 * pressure * 293.15 / 263.15);
    assert_eq!(
        car().for_ambient(Surface::Dynamometer, &ambient, 0.00864),
        car()
    );
}

/// Means of v, v2, v3 and v^0.7 over a step.
#[test]
fn val_motion_by_hand() {
    let m = Motion::between(4.0, 10.0, 2.0);
    same(m.speed_m_s, 7.0);
    same(m.accel_m_s2, 3.0);
    same(m.square_m2_s2, 52.0);
    same(m.cube_m3_s3, (10f64.powi(4) - 4f64.powi(4)) / 24.0);
    same(m.speed_power_07, 7f64.powf(0.7));
    assert!(Motion::between(0.0, 0.0, 1.0).speed_power_07 == 0.0);
}

/// RL-1 to RL-3 and EN-5 as read from a vehicle file: body, table of UN R83, payload, altitude.
#[test]
fn val_road_load_of_a_file() {
    let at = |sets: &[&str]| {
        let setup = crate::common::car("rover_216_cvt", sets);
        let car = setup.car(293.15);
        (car.road_load, car.charge)
    };
    let (plain, factor) = at(&[]);
    let warmer = (298.15f64 / 293.15).sqrt();
    same(factor, warmer);
    let high = at(&["road_load.altitude_m=1500"]).1;
    same(high, warmer * (1.0 - 2.25577e-5 * 1500.0f64).powf(5.25588));
    let (loaded, _) = at(&["road_load.payload_kg=100"]);
    same(loaded.mass_kg, plain.mass_kg + 100.0);
    same(
        loaded.inertia_kg / loaded.mass_kg,
        plain.inertia_kg / plain.mass_kg,
    );
    same(loaded.f0_n, plain.f0_n);
    let (road, _) = at(&["road_load.payload_kg=113", "road_load.surface=road"]);
    near(
        road.f0_n,
        plain.f0_n * (plain.mass_kg + 113.0) / plain.mass_kg,
        1e-12,
    );
    let form = |sets: &[&str]| {
        let text = include_str!("../../../../vehicles/rover_216_cvt.toml");
        let start = text.find("[road_load.form.coefficients]").unwrap();
        let end = start + text[start..].find("[engine]").unwrap();
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("car.toml");
        // The table of UN R83 knows the mass.
        let given = |line: &&str| !(line.starts_with("mass_kg") && sets[0].contains("r83"));
        let head: Vec<&str> = text[..start].lines().filter(given).collect();
        std::fs::write(
            &file,
            format!("{}\n{}\n{}", head.join("\n"), sets.join("\n"), &text[end..]),
        )
        .unwrap();
        load(file.to_str().unwrap(), &Options::default())
            .unwrap_or_else(|p| panic!("{p:?}"))
            .car(293.15)
            .road_load
    };
    let body = form(&[
        "[road_load.form.body]",
        "drag_coefficient = 0.33",
        "frontal_area_m2 = 1.9",
        "rolling_coefficient = 0.011",
    ]);
    same(body.f0_n, body.mass_kg * 9.80665 * 0.011);
    same(body.f2_n_per_m_s2, 0.5 * 1.204 * 0.33 * 1.9);
    assert!(body.f1_n_per_m_s == 0.0);
    // UN R83: up to 1080 kg of reference mass the class of 1020 kg, then that of 1130 kg; the last class has no end.
    for (reference, f0, kmh) in [
        (1080.0, 6.1, 0.0412),
        (1080.1, 6.4, 0.0433),
        (200.0, 3.8, 0.0261),
        (4000.0, 9.9, 0.0674),
    ] {
        let r83 = form(&[
            "[road_load.form.r83]",
            &format!("reference_mass_kg = {reference:.1}"),
        ]);
        same(r83.f0_n, f0);
        same(r83.f2_n_per_m_s2, kmh * 12.96);
    }
}

/// EN-5 and EN-8 against the exponent of 1.2 that ISO 1585 has for pressure: full load of a warm engine at altitude.
#[test]
fn val_full_load_at_altitude() {
    let setup = crate::common::car("rover_216_cvt", &[]);
    let e = setup.engine();
    for pressure in [0.9f64, 0.8, 0.7] {
        let now = e.at(e.hot_k, e.hot_k, setup.oils().1, pressure);
        let share = now.full_load_nm(300.0) / e.full_load.at(300.0);
        near(share, pressure.powf(1.2), 0.03);
    }
}

fn tyre() -> Tyre {
    crate::common::car("rover_216_5mt", &[]).car(293.15).tyre
}

/// Temperature of the tyres after so long at a speed and an ambient.
fn rolled_k(tyre: &Tyre, kmh: f64, ambient_k: f64, seconds: f64, dt_s: f64) -> f64 {
    let v = kmh / 3.6;
    let motion = Motion::between(v, v, dt_s);
    (0..(seconds / dt_s) as u32).fold(ambient_k, |k, _| {
        tyre.advance_k(k, ambient_k, &motion, dt_s)
    })
}

/// RL-6 and RL-7 by hand, one step, with the bound of half the resistance.
#[test]
fn val_tyre_by_hand() {
    let t = tyre();
    same(t.warm_n, 1130.0 * 9.80665 * 0.011);
    for degc in [-40.0f64, 10.0, 40.0, 80.0, 99.0] {
        let ratio = (1.0 + 0.0095 * (40.0 - degc)).max(0.5);
        let k = degc + 273.15;
        same(t.extra_n(k), 0.6 * t.warm_n * (ratio - 1.0));
        let (heat, air) = (t.warm_n * ratio * 20.0, 20.0 + 13.7 * 20f64.powf(0.7));
        let slope = if ratio > 0.5 {
            0.0095 * t.warm_n * 20.0
        } else {
            0.0
        };
        let want = k + (heat - air * (k - 280.0)) / (45e3 / 1.5 + air + slope);
        same(
            t.advance_k(k, 280.0, &Motion::between(15.0, 25.0, 1.5), 1.5),
            want,
        );
    }
}

/// RL-6 with RL-7 against UN R117: rolling resistance at a steady 80 km/h falls by 0.008 of that at 25 degC per kelvin of ambient, from 20 to 30 degC.
#[test]
fn val_r117_ambient_slope() {
    let t = tyre();
    let force = |ambient: f64| {
        let k = rolled_k(&t, 80.0, ambient + 273.15, 1e4, 1.0);
        t.warm_n + t.extra_n(k) / t.share
    };
    let slope = (force(20.0) - force(30.0)) / force(25.0);
    assert!((slope - 0.08).abs() < 0.004, "{slope}");
}

/// RL-7: steps of 10 s end where steps of 0.01 s do.
#[test]
fn tyre_step_is_stable() {
    let t = tyre();
    for (kmh, seconds) in [(30.0, 60.0), (80.0, 300.0), (130.0, 1000.0), (0.0, 500.0)] {
        let [coarse, fine] = [10.0, 0.01].map(|dt| rolled_k(&t, kmh, 263.15, seconds, dt));
        assert!((coarse - fine).abs() < 0.3, "{kmh}: {coarse} {fine}");
    }
}

/// RL-8: the factor scales the coefficients and leaves masses and the tyres alone; on the road tyres that warm up replace RL-2's factor on f0.
#[test]
fn load_factor_scales_force_not_inertia() {
    let of = |sets: &[&str]| crate::common::car("rover_216_5mt", sets).car(263.15);
    let (plain, more) = (of(&[]), of(&["road_load.load_factor=1.1"]));
    same(more.road_load.f0_n, 1.1 * plain.road_load.f0_n);
    same(
        more.road_load.f2_n_per_m_s2,
        1.1 * plain.road_load.f2_n_per_m_s2,
    );
    assert!(more.road_load.inertia_kg == plain.road_load.inertia_kg && more.tyre == plain.tyre);
    let road = "road_load.surface=road";
    let cold = of(&[road, "road_load.tyre.rolling_coefficient=0"]);
    same(
        cold.road_load.f0_n,
        plain.road_load.f0_n * (1.0 + 0.00864 * 30.0),
    );
    same(of(&[road]).road_load.f0_n, plain.road_load.f0_n);
}

/// RL-5 with a negative f1, which makes the force zero at two speeds: the work is split at both.
#[test]
fn val_two_zeros_of_the_force() {
    let us = RoadLoad {
        f1_n_per_m_s: -20.0,
        ..car()
    };
    for (from, to) in [(0.0, 60.0), (55.0, 5.0), (10.0, 45.0), (24.0, 50.0)] {
        let accel = (to - from) / 1.5;
        let level = us.inertia_kg * accel + us.f0_n - 200.0;
        let s = step(from, to, 0.0);
        let got = us.wheel(&s, -level);
        let want = summed_with(&us, &s, -level);
        let scale = 1e-5 * (want.0 - want.1) + 1e-3;
        assert!(
            (got.positive_j - want.0).abs() <= scale,
            "{from} {to}: {got:?} {want:?}"
        );
        assert!(
            (got.negative_j - want.1).abs() <= scale,
            "{from} {to}: {got:?} {want:?}"
        );
        assert!(got.positive_j > 1.0 && got.negative_j < -1.0);
    }
}

fn rover() -> RoadLoad {
    RoadLoad {
        f0_n: 6.3,
        f1_n_per_m_s: 0.0,
        f2_n_per_m_s2: 0.0433 * 12.96,
        mass_kg: 1130.0,
        inertia_kg: 1130.0 * 1.015,
        wheel_radius_m: 0.2832,
    }
}

/// Colder air is denser and tyres roll harder; a dynamometer does not know.
#[test]
fn cold_road_drags_more() {
    let cold = Ambient {
        temp_k: 263.15,
        altitude_m: 0.0,
    };
    let road = rover().for_ambient(Surface::Road, &cold, 0.00864);
    assert!(road.f0_n > 1.2 * 6.3 && road.f2_n_per_m_s2 > 1.1 * rover().f2_n_per_m_s2);
    assert_eq!(
        rover().for_ambient(Surface::Dynamometer, &cold, 0.00864),
        rover()
    );
}

/// Standard atmosphere: 0.7942 of the density at 2260 m by the isothermal part, pressure 898.7 hPa at 1000 m.
#[test]
fn val_standard_atmosphere() {
    let p = Ambient {
        temp_k: 288.15,
        altitude_m: 1000.0,
    }
    .pressure_ratio()
        * 1013.25;
    assert!((p - 898.75).abs() < 0.1, "{p}");
}

fn work(automatic: bool, dt: f64) -> (f64, f64) {
    let cycle = embedded("ece15_eudc").expect("embedded");
    let car = rover();
    cycle
        .trace_for(automatic)
        .steps(dt)
        .fold((0.0, 0.0), |(p, n), s| {
            let w = car.wheel(&s, 0.0);
            (p + w.positive_j, n + w.negative_j)
        })
}

/// Outside truth: the project's independent calculation, within 1e-4, at any step.
#[test]
fn val_wheel_work() {
    for (automatic, want) in [(true, 3403.32e3), (false, 3413.28e3)] {
        for dt in [1.0, 0.25] {
            let (p, n) = work(automatic, dt);
            assert!((p / want - 1.0).abs() < 1e-4, "{p}");
            assert!((n / -1103.40e3 - 1.0).abs() < 1e-4, "{n}");
        }
    }
}
