//! Tables of the user's in place of a law: shift map (RC-14), line pressure (PC-6).
#![allow(clippy::unwrap_used, reason = "tests")]

use cvtcycle_config::cycle::embedded;
use cvtcycle_config::render;
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_model::drive::{Conditions, Outcome, Start, drive};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::keys::file_table::FileRows;
use cvtcycle_model::keys::rad_s;
use cvtcycle_model::lubricant::FilmPowers;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::coupling::Coupling;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::controller::{
    ClampSignals, PressurePoint, PressureTable, ShiftMap, ShiftPoint,
};
use cvtcycle_model::transmission::cvt::variator::{BeltAtRatio, BeltLoad};
use std::fmt::Write;

/// The Rover with overrides, one of which may name `map.csv`.
fn car(csv: &str, set: &[&str]) -> Result<Setup, String> {
    crate::box_map::car("rover_216_cvt", csv, set)
}

fn driven(setup: &Setup, cycle: &str) -> Outcome {
    let conditions = Conditions {
        ambient_k: 298.15,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: true,
    };
    drive(setup, &embedded(cycle).unwrap(), &conditions)
}

fn cvt(setup: &Setup) -> &Cvt {
    match setup.transmission() {
        Transmission::Cvt(cvt) => cvt,
        Transmission::Manual(_) => panic!("a CVT"),
    }
}

/// Relative difference of the fuel of two drives.
fn fuel_difference(a: &Outcome, b: &Outcome) -> f64 {
    a.totals.total().fuel_kg / b.totals.total().fuel_kg - 1.0
}

const SHIFT_MAP: &str = "transmission.cvt.ratio.shift_map=map.csv";

/// Hand calculation of RC-14. Full load is 100 Nm at any speed, so that n = a + b u with u = P/(eta 100 n) is the root of n^2 - a n - b P/(100 eta).
#[test]
fn val_shift_map_by_hand() {
    let map = |columns: [&'static str; 3], rows: &[[f64; 3]]| {
        ShiftMap::from_rows(&FileRows {
            columns: columns.to_vec(),
            rows: rows.iter().map(|row| row.to_vec()).collect(),
        })
        .unwrap()
    };
    let rows = [
        [20.0, 0.0, 300.0],
        [10.0, 1.0, 400.0],
        [10.0, 0.0, 100.0],
        [20.0, 1.0, 500.0],
    ];
    let at = |speed_m_s: f64, power_w: f64| ShiftPoint {
        speed_m_s,
        secondary_rad_s: 250.0,
        power_w,
        efficiency: 0.8,
    };
    let near = |got: f64, want: f64| assert!((got / want - 1.0).abs() < 1e-8, "{got}, {want}");
    let pedal = map(["speed_kmh", "pedal_percent", "input_speed_rpm"], &rows);
    for (speed, a, b) in [
        (10.0, 100.0, 300.0),
        (15.0, 200.0, 250.0),
        (20.0, 300.0, 200.0),
    ] {
        for power_w in [100.0, 3000.0, 9000.0] {
            let c = b * power_w / (100.0 * 0.8);
            let want = a / 2.0 + f64::sqrt(a * a / 4.0 + c);
            near(pedal.target_rad_s(&at(speed, power_w), |n| 100.0 * n), want);
        }
        // Overrun is no pedal, and more than full load is all of it.
        near(pedal.target_rad_s(&at(speed, -5e3), |n| 100.0 * n), a);
        near(pedal.target_rad_s(&at(speed, 1e6), |n| 100.0 * n), a + b);
    }
    near(pedal.target_rad_s(&at(5.0, 0.0), |n| 100.0 * n), 100.0);
    near(pedal.target_rad_s(&at(90.0, 0.0), |n| 100.0 * n), 300.0);
    let power = map(["speed_kmh", "power_kw", "engine_speed_rpm"], &rows);
    near(power.target_rad_s(&at(15.0, 0.25), |_| f64::NAN), 262.5);
    let ratio = map(["speed_kmh", "power_kw", "belt_ratio"], &rows);
    near(
        ratio.target_rad_s(&at(15.0, 0.25), |_| f64::NAN),
        262.5 * 250.0,
    );
}

/// RC-1 and RC-2 are straight lines over power: a table with their corners drives the same cycle; by pedal the corners are between its columns.
#[test]
fn a_shift_map_of_the_variogram_drives_like_it() {
    let own = car("", &[]).unwrap();
    let ratio = &cvt(&own).ratio;
    let rated_kw = own.engine().rated_w / 1e3;
    let rpm = |rad_s: f64| rad_s * 30.0 / std::f64::consts::PI;
    let line = |share: f64| {
        let part = (share / ratio.gentle_share).min(1.0);
        let gentle = ratio.overrun_rad_s + part * (ratio.gentle_rad_s - ratio.overrun_rad_s);
        gentle + ratio.rise_rad_s * (share - ratio.gentle_share).max(0.0)
    };
    let by_power = |factor: f64| {
        let mut text = String::from("speed_kmh,power_kw,engine_speed_rpm\n");
        for kmh in [0, 200] {
            for share in [0.0, ratio.gentle_share, 1.2] {
                let target = (factor * rpm(line(share))).min(12_000.0);
                let _ = writeln!(text, "{kmh},{},{target}", share * rated_kw);
            }
        }
        text
    };
    let full_load = &own.engine().full_load;
    let mut by_pedal = String::from("Vehicle speed [km/h];Accelerator [%];Engine speed [rpm]\n");
    for kmh in [0, 200] {
        for percent in 0..=40 {
            let pedal = f64::from(percent) / 40.0;
            let speed = (0..200).fold(200.0, |speed: f64, _| {
                let power_w = pedal * ratio.route_efficiency * full_load.at(speed) * speed;
                let target = line(power_w / own.engine().rated_w);
                0.5 * (speed + target.min(ratio.highest_rad_s))
            });
            let _ = writeln!(by_pedal, "{kmh};{};{}", 100.0 * pedal, rpm(speed));
        }
    }
    let reference = driven(&own, "ece15_eudc");
    let exact = driven(&car(&by_power(1.0), &[SHIFT_MAP]).unwrap(), "ece15_eudc");
    assert!(fuel_difference(&exact, &reference).abs() < 1e-9);
    let near = driven(&car(&by_pedal, &[SHIFT_MAP]).unwrap(), "ece15_eudc");
    let off = fuel_difference(&near, &reference);
    assert!(off.abs() < 2e-3 && off.abs() > 0.0, "{off}");
    for o in [&exact, &near] {
        assert!(o.totals.ledger_error < 1e-9);
    }
    // Another table is another drive: the table is read.
    let fast = driven(&car(&by_power(1.5), &[SHIFT_MAP]).unwrap(), "ece15_eudc");
    assert!(fuel_difference(&fast, &reference) > 0.05);
}

/// A logger's table: other columns are passed over where the key says which are meant, and refused where it does not.
#[test]
fn columns_of_a_logger_are_named() {
    let log = "Zeit;vKar;APP;nMot\ns;km/h;%;1/min\n0;0;0;1700\n1;0;100;4000\n2;180;0;1700\n3;180;100;5000\n";
    let columns = "speed=vKar:km/h,pedal=APP:%,engine_speed=nMot:rpm";
    let key = "transmission.cvt.ratio.shift_map";
    let text = format!("{{ value = \"map.csv\", columns = \"{columns}\" }}");
    let setup = car(log, &[&format!("{key}={text}")]).unwrap();
    let map = cvt(&setup).ratio.shift_map.as_ref().unwrap();
    let [speeds, pedals, values] = map.points();
    assert_eq!((speeds, pedals), (&[0.0, 50.0][..], &[0.0, 1.0][..]));
    let want = [1700.0, 4000.0, 1700.0, 5000.0].map(rad_s);
    assert!(values.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-9));
    let refused = car(log, &[SHIFT_MAP]).unwrap_err();
    assert!(refused.contains("columns = \""), "{refused}");
    let gone = text.replace("APP", "PPA");
    let gone = car(log, &[&format!("{key}={gone}")]).unwrap_err();
    assert!(
        gone.contains("no column `PPA`") && gone.contains("shift_map"),
        "{gone}"
    );
}

const TABLE: [&str; 2] = [
    "transmission.cvt.clamp=table",
    "transmission.cvt.clamp.table.file=map.csv",
];

/// Hand calculation of PC-6: linear in each axis, held at the ends.
#[test]
fn val_pressure_table_by_hand() {
    let mut rows = Vec::new();
    for (i, ratio) in [0.5, 2.5].into_iter().enumerate() {
        for (k, torque) in [0.0, 100.0].into_iter().enumerate() {
            rows.push(vec![
                torque,
                ratio,
                1e5 * (5.0 + 10.0 * i as f64 + 20.0 * k as f64),
            ]);
        }
    }
    let table = PressureTable::from_rows(&FileRows {
        columns: vec!["input_torque_nm", "belt_ratio", "secondary_pressure_bar"],
        rows,
    })
    .unwrap();
    for (secondary_nm, ratio, want, inside) in [
        (0.0, 0.5, 5.0, true),
        (75.0, 1.5, 5.0 + 5.0 + 10.0, true),
        (-75.0, 1.5, 5.0 + 5.0 + 10.0, true),
        (500.0, 2.5, 35.0, false),
        (0.0, 3.0, 15.0, false),
        (10.0, 0.4, 10.0, false),
    ] {
        let at = PressurePoint::of_belt(secondary_nm, ratio, 100.0);
        let got = table.pressure_pa(&at) / 1e5;
        assert!((got - want).abs() < 1e-9, "{got} instead of {want}");
        assert_eq!(table.holds(&at), inside, "{at:?}");
    }
}

/// The torque-following law tabulated drives like the law; beyond the table's torque the rows are flagged.
#[test]
fn a_pressure_table_of_the_law_drives_like_it() {
    let law = car("", &["transmission.cvt.clamp=torque_following"]).unwrap();
    let reference = driven(&law, "ece15_eudc");
    let box_ = cvt(&law);
    let oil = law.car(298.15).oil;
    let table = |most_nm: f64| {
        let mut text =
            String::from("input_torque_nm,belt_ratio,input_speed_rpm,secondary_pressure_bar\n");
        for i in 0..=24 {
            let low = box_.ratio.low / box_.ratio.high;
            let ratio = box_.ratio.high * low.powf(f64::from(i) / 24.0);
            let at = BeltAtRatio::new(&box_.belt, ratio);
            for speed in [0.0, 1000.0, 2000.0, 4000.0, 6000.0] {
                for torque in 0..=28 {
                    let torque = most_nm * f64::from(torque) / 28.0;
                    let secondary_rad_s = rad_s(speed) / ratio;
                    let signals = ClampSignals {
                        throttle: 0.0,
                        engine_rad_s: rad_s(speed),
                        oil_k: 353.15,
                        radius_factor: 1.0,
                        force_log: 0.0,
                    };
                    let friction = &oil.friction;
                    let load = || {
                        let none = FilmPowers {
                            carried: [0.0; 2],
                            sheared: [0.0; 2],
                        };
                        let band = friction.band_on_film(353.15, none);
                        let unloaded = BeltLoad::unloaded(friction, band, 1.0, [0.0; 2]);
                        BeltLoad {
                            output_torque_nm: torque * ratio,
                            ..unloaded
                        }
                    };
                    let (pa, _) = box_.pressure_pa(&signals, &at, load, secondary_rad_s);
                    let _ = writeln!(text, "{torque},{ratio},{speed},{}", pa / 1e5);
                }
            }
        }
        text
    };
    let own = driven(&car(&table(140.0), &TABLE).unwrap(), "ece15_eudc");
    let off = fuel_difference(&own, &reference);
    assert!(off.abs() < 2e-3, "{off}");
    assert!(own.totals.ledger_error < 1e-9);
    let outside = |o: &Outcome| {
        let is_out = |flags: Flags| flags.contains(Flags::OUTSIDE_VALIDITY);
        o.rows.iter().filter(|row| is_out(row.flags)).count()
    };
    assert_eq!(outside(&own), outside(&reference));
    let short = driven(&car(&table(40.0), &TABLE).unwrap(), "ece15_eudc");
    assert!(
        outside(&short) > 100 + outside(&reference),
        "{}",
        outside(&short)
    );
}

/// PC-6 at rest in gear: the torque that the table has to cover is the clutch's creep torque at the primary, whatever the ratio.
#[test]
fn a_table_covers_the_creep_torque_of_a_car_at_rest() {
    let plain = car("", &[]).unwrap();
    let (low, idle) = (cvt(&plain).ratio.low, plain.engine().idle_hot_rad_s);
    let creep_nm = cvt(&plain).coupling.creep_nm(0.0, idle);
    assert!(creep_nm > 1.0 && low > 1.5, "{creep_nm} {low}");
    let flagged = |most_nm: f64| {
        let mut text = String::from("input_torque_nm,belt_ratio,secondary_pressure_bar\n");
        for torque in [0.0, most_nm] {
            for ratio in [0.3, 3.0] {
                let _ = writeln!(text, "{torque},{ratio},15");
            }
        }
        let setup = car(&text, &TABLE).unwrap();
        let conditions = Conditions {
            ambient_k: 363.15,
            start: Start::Soak,
            max_dt_s: 1.0,
            keep_rows: true,
        };
        let rows = drive(&setup, &embedded("ece15").unwrap(), &conditions).rows;
        let first = &rows[1];
        assert!(first.speed_m_s <= 0.0 && first.flags.contains(Flags::CLUTCH_SLIPPING));
        first.flags.contains(Flags::OUTSIDE_VALIDITY)
    };
    assert!(!flagged(1.1 * creep_nm) && flagged(0.9 * creep_nm));
}

/// The example of the book drives like the Rover from 80 degC, within 1 %: its pressure is that of 80 degC, at a throttle that is the primary's torque
/// alone, without pump and accessories.
#[test]
fn the_example_of_the_docs_drives_like_the_rover() {
    let file = format!(
        "{}/../../docs/own_tables/car.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let load = |word: &str| load(word, &Options::default()).map_err(|p| render(&p, false));
    let tables = load(&file).unwrap();
    assert!(cvt(&tables).ratio.shift_map.is_some() && cvt(&tables).pressure_table.is_some());
    let hot = |setup: &Setup| {
        let conditions = Conditions {
            ambient_k: 298.15,
            start: Start::At(353.15),
            max_dt_s: 1.0,
            keep_rows: true,
        };
        drive(setup, &embedded("ece15_eudc").unwrap(), &conditions)
    };
    let own = hot(&tables);
    let off = fuel_difference(&own, &hot(&load("rover_216_cvt").unwrap()));
    assert!(off.abs() < 1e-2, "{off}");
    assert!(own.totals.ledger_error < 1e-9);
}
