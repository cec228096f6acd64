//! Road load: RL-1 to RL-5.

use super::{near, same};
use cvtcycle_config::cycle::{Motion, Step};
use cvtcycle_config::setup::{Options, load};
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::road::{Ambient, RoadLoad, Surface};

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
    let n = 40_000;
    let a = (s.end_speed_m_s - s.start_speed_m_s) / s.dt_s;
    let slope = 9.80665 * s.grade.atan().sin();
    let mut work = (0.0, 0.0);
    for i in 0..n {
        let t = (f64::from(i) + 0.5) / f64::from(n) * s.dt_s;
        let v = s.start_speed_m_s + a * t;
        let force = car.f0_n
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
            let (got, want) = (car.wheel(&s), summed(&car, &s));
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
    let rest = car().wheel(&step(0.0, 0.0, 0.1));
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

/// What a step says of its speeds: means of v, v2, v3 and the power of 0.7.
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
        near(now.full_load_share(300.0), pressure.powf(1.2), 0.03);
    }
}
