//! Public measurements of other cars (validation/outside) against the shipped ones.

use crate::common::{CARS, ZERO, at, car, cycle};
use cvtcycle_model::drive::{Conditions, Outcome, Start, drive};
use std::collections::HashMap;

/// Rows of a file of `validation/outside`: numbers by column; a word is NaN.
pub fn rows(name: &str) -> Vec<HashMap<String, f64>> {
    let file = format!(
        "{}/../../validation/outside/{name}",
        env!("CARGO_MANIFEST_DIR")
    );
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path(file)
        .unwrap();
    let number = |text: &str| text.parse().unwrap_or(f64::NAN);
    let names = reader.headers().unwrap().clone();
    reader
        .records()
        .map(|row| {
            let row = row.unwrap();
            let cells = names.iter().zip(row.iter());
            cells
                .map(|(key, text)| (key.to_owned(), number(text)))
                .collect()
        })
        .collect()
}

/// A cycle after a soak, with its rows.
pub fn soaked(name: &str, cycle_name: &str, degc: f64) -> Outcome {
    let conditions = Conditions {
        keep_rows: true,
        ..at(degc, Start::Soak)
    };
    drive(&car(name, &[]), &cycle(cycle_name), &conditions)
}

/// Fuel heat for a kelvin of coolant from 25 to 80 degC in town. Truth: 23 starts of another car at 21 to 32 degC in traffic
/// (`engine_starts_driving.csv`), 80 kJ/K with a standard deviation of 12.5. Half of the heat capacity of block and oil meets it; the shipped cars,
/// whose capacity was chosen when this table took a row of its log, of which there are two a second, for a second, take twice as much (rows O.24 to O.26).
#[test]
fn val_fuel_per_kelvin_of_warm_up() {
    let starts: Vec<f64> = rows("engine_starts_driving.csv")
        .iter()
        .filter(|row| (21.0..=32.0).contains(&row["coolant_at_start_degc"]))
        .map(|row| row["fuel_per_kelvin_to_80_kj"])
        .collect();
    let count = starts.len() as f64;
    let mean = starts.iter().sum::<f64>() / count;
    let squares: f64 = starts.iter().map(|x| (x - mean).powi(2)).sum();
    let sd = (squares / (count - 1.0)).sqrt();
    assert!(
        starts.len() == 23 && (mean - 80.0).abs() < 0.1 && (sd - 12.5).abs() < 0.1,
        "{count} {mean} {sd}"
    );
    let conditions = Conditions {
        keep_rows: true,
        ..at(25.0, Start::Soak)
    };
    for name in CARS {
        let shipped = car(name, &[]);
        let half = |key: &str| {
            let info = shipped.keys.iter().find(|info| info.key == key);
            let value: f64 = info.unwrap().value.parse().unwrap();
            format!("{key}={:?}", 0.5 * value)
        };
        let sets = ["thermal.engine.block_kj_k", "thermal.engine.oil_kj_k"].map(half);
        let lighter = car(name, &sets.each_ref().map(String::as_str));
        let [whole, halved] = [&shipped, &lighter].map(|car| {
            let o = drive(car, &cycle("ece15_eudc"), &conditions);
            let warm = o.rows.iter().position(|row| row.coolant_k >= 80.0 + ZERO);
            let until = warm.unwrap_or_else(|| panic!("{name}: never at 80 degC"));
            assert!(o.rows[until].time_s < 780.0, "{name}: not in town");
            let joules: f64 = o.rows[..=until]
                .iter()
                .map(|row| row.fuel_power_w * row.dt_s)
                .sum();
            joules / 1e3 / 55.0
        });
        println!("{name}: {whole:.0} kJ/K, {halved:.0} with half of the heat capacity");
        assert!((halved - mean).abs() < sd, "{name}: {halved:.1} kJ/K");
        assert!(whole > 1.8 * halved, "{name}: {whole:.1} kJ/K");
    }
}

/// The colder the start, the later the coolant is at 80 degC.
#[test]
fn later_the_colder() {
    for name in CARS {
        let warm_s = [25.0, -10.0, -30.0].map(|degc| {
            let o = soaked(name, "ece15_eudc", degc);
            let warm = o.rows.iter().find(|row| row.coolant_k >= 80.0 + ZERO);
            warm.map_or(f64::INFINITY, |row| row.time_s)
        });
        println!("{name}: {warm_s:?} s");
        assert!(
            warm_s[0] + 60.0 < warm_s[1] && warm_s[1] < warm_s[2],
            "{name}: {warm_s:?}"
        );
    }
}

/// Cars of different rated power have different engines, and so different heat capacities, by mass: ADVISOR has 1.8 to 2.6 kg/kW at 0.5 kJ/(kg K).
#[test]
fn every_engine_has_its_own_heat_capacity() {
    let of = |name: &str| {
        let car = car(name, &[]);
        let capacity = car.car(293.15).network.capacity_j_k;
        (car.engine().rated_w, capacity[0] + capacity[1])
    };
    let (rover, mondeo) = (of(CARS[1]), of(CARS[2]));
    assert!(rover.0 < mondeo.0 && rover.1 < mondeo.1);
    for (watts, joules) in [rover, mondeo] {
        let each = joules / watts;
        assert!((0.9..=1.3).contains(&each), "{each} kJ/K a kW");
    }
}

/// First idle of a start at -30 degC: at most 4 L/h in the first 11 s. Truth: the requirement; it was not measured.
#[test]
fn first_idle_at_minus_30() {
    for name in CARS {
        let o = soaked(name, "ece15_eudc", -30.0);
        let first: f64 = o
            .rows
            .iter()
            .filter(|row| row.time_s < 11.5)
            .map(|row| row.fuel_kg_s * row.dt_s)
            .sum();
        let litres = first / 11.0 * 3.6e6 / car(name, &[]).engine().fuel_density_kg_m3;
        println!("{name}: {litres:.2} L/h");
        assert!((1.5..=4.0).contains(&litres), "{name}: {litres}");
    }
}

/// RL-6 on the dynamometer: the cold first bag of FTP75 takes more work at the wheels than the same trace in the third.
#[test]
fn tyres_warm_up_on_rollers_too() {
    for name in CARS {
        let o = soaked(name, "ftp75", -6.7);
        let bags: Vec<f64> = o
            .totals
            .phases
            .iter()
            .filter(|phase| phase.distance_m > 0.0)
            .map(|phase| phase.wheel_positive_j)
            .collect();
        assert!(bags[0] > 1.005 * bags[2], "{name}: {bags:?}");
        let warmest = o
            .rows
            .iter()
            .map(|row| row.tyre_k - ZERO)
            .fold(-50.0, f64::max);
        assert!((5.0..20.0).contains(&warmest), "{name}: {warmest} degC");
    }
}
