//! Cars in lockstep: each run has the bits that it has alone.
//!
//! Truth: the same text with f64, one run after another.

use crate::common::try_car;
use cvtcycle_config::cycle::embedded;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::cycle::Cycle;
use cvtcycle_model::drive::{Conditions, Outcome, Run, Start, drive, drive_each};
use cvtcycle_model::thermal::{COOLANT, SUMP, StartTemperatures};

/// Numbers of the car that move every part of the drive, each by its own steps.
const VARIED: [(&str, f64, f64); 12] = [
    ("road_load.mass_kg", 950.0, 60.0),
    ("road_load.wheel_radius_m", 0.27, 0.004),
    ("road_load.form.coefficients.f0_n", 4.0, 13.0),
    ("road_load.tyre.warm_degc", 30.0, 3.0),
    ("engine.displacement_cc", 1400.0, 51.0),
    ("engine.inertia_kg_m2", 0.15, 0.021),
    ("engine.idle.hot_rpm", 760.0, 17.0),
    ("engine.friction.overrun_factor", 1.0, 0.11),
    ("engine.friction.viscous_share", 0.3, 0.05),
    ("engine.fuel.cut_from_degc", 20.0, 9.0),
    ("engine.fuel.start_g", 0.0, 1.5),
    ("engine.accessory_nm", 0.1, 0.07),
];

/// Cars of one family, no two alike.
fn family(vehicle: &str, count: usize) -> Vec<Setup> {
    let car = |k: usize| {
        let set: Vec<String> = (VARIED.iter().enumerate())
            .map(|(i, (key, from, step))| {
                let steps = (k * (2 * i + 1)) % 7;
                format!("{key}={}", from + step * steps as f64)
            })
            .collect();
        try_car(vehicle, &set).unwrap_or_else(|problems| panic!("{problems}"))
    };
    (0..count).map(car).collect()
}

/// Every number of an outcome; the shortest digits that give an f64 back are as good as its bits.
fn numbers(outcome: &Outcome) -> String {
    format!("{:?} {:?}", outcome.totals, outcome.end)
}

fn assert_alone(cars: &[Setup], cycle: &Cycle, conditions: impl Fn(usize) -> Conditions) {
    let runs: Vec<Run> = (cars.iter().enumerate())
        .map(|(k, car)| Run {
            vehicle: car,
            conditions: conditions(k),
        })
        .collect();
    let together = drive_each(&runs, cycle);
    assert_eq!(together.len(), runs.len());
    for (k, (run, outcome)) in runs.iter().zip(&together).enumerate() {
        let alone = drive(run.vehicle, cycle, &run.conditions);
        assert_eq!(numbers(outcome), numbers(&alone), "run {k}");
        assert_eq!(outcome.gear_schedule, alone.gear_schedule);
    }
}

const COLD: Conditions = Conditions {
    ambient_k: 266.15,
    start: Start::Soak,
    max_dt_s: 1.0,
    keep_rows: false,
};

/// Gears of the cycle, a whole group and a remainder.
#[test]
fn manual_cars_in_lockstep_have_their_own_bits() {
    let cycle = embedded("ece15_eudc").unwrap();
    assert_alone(&family("rover_216_5mt", 19), &cycle, |_| COLD);
}

/// Shift speeds that differ, other ambients and starts in one group.
#[test]
fn gears_of_their_own_and_starts_of_their_own() {
    let cycle = embedded("udds").unwrap();
    let start = |k: usize| match k % 3 {
        0 => Start::Soak,
        1 => Start::At(280.0 + 5.0 * k as f64),
        _ => {
            let mut nodes = StartTemperatures::default();
            nodes.given_k[COOLANT] = Some(300.0 + 5.0 * k as f64);
            nodes.given_k[SUMP] = Some(310.0);
            Start::Nodes(nodes)
        }
    };
    assert_alone(&family("rover_216_5mt", 9), &cycle, |k| Conditions {
        ambient_k: 260.0 + 5.0 * k as f64,
        start: start(k),
        ..COLD
    });
}

/// CVTs after a first drive that is not counted, with a remainder; another kind of box and another oil in between.
#[test]
fn kinds_of_cars_may_be_mixed() {
    let cycle = embedded("ece15").unwrap();
    let mut cars = family("rover_216_cvt", 5);
    cars.insert(1, family("rover_216_5mt", 1).remove(0));
    cars.insert(3, try_car("mondeo_20_5mt", &[]).unwrap());
    assert_alone(&cars, &cycle, |_| Conditions {
        start: Start::Warm,
        max_dt_s: 2.5,
        ..COLD
    });
}

/// Cars with two ranges, whose changes come at different times, and one with another set.
#[test]
fn ranges_change_in_each_car_by_itself() {
    let cycle = embedded("ece15").unwrap();
    let cars = [
        "1.82", "1.7", "1.6", "1.82", "1.5", "1.82", "1.3", "1.82", "1.4",
    ];
    let cars = cars.iter().enumerate().map(|(k, low)| {
        let mass = format!("{}", 1150 + 40 * k);
        let set = super::two_ranges::with(&[("low_ratio", low), ("road_load.mass_kg", &mass)]);
        try_car("rover_216_cvt", &set).unwrap_or_else(|problems| panic!("{problems}"))
    });
    assert_alone(&cars.collect::<Vec<_>>(), &cycle, |_| COLD);
}

/// One car far too heavy for its engine, one whose numbers end in none: the others drive as they do alone.
#[test]
fn a_failed_run_keeps_to_itself() {
    let cycle = embedded("ece15_eudc").unwrap();
    for vehicle in ["rover_216_5mt", "rover_216_cvt"] {
        let mut cars = family(vehicle, 4);
        cars[1] = try_car(vehicle, &["road_load.mass_kg=4900".to_owned()]).unwrap();
        cars[2].vehicle.road_load.base.f0_n = f64::NAN;
        assert_alone(&cars, &cycle, |_| COLD);
    }
}

/// Converters whose numbers and tables differ, with a lock-up clutch that slips, with none, and one that loses a part only, which drives apart.
#[test]
fn converters_have_their_own_tables_and_locks() {
    const OWN: [&[&str]; 7] = [
        &["capacity_nm=27"],
        &["capacity_nm=35", "coast_factor=1.4", "neutral_idle=0.3"],
        &[
            "capacity_nm=21",
            "lockup.from_degc=-20",
            "lockup.slip_rpm=50",
        ],
        &[
            "capacity_nm=30",
            "table=[[0, 1.9, 1], [0.5, 1.4, 0.8], [0.8, 1.1, 0.5], [0.9, 1.0, 0.3], [1, 1, 0]]",
            "lockup.from_degc=-20",
            "lockup.from_kmh=30",
            "lockup.until_kmh=25",
        ],
        &["capacity_nm=27", "lockup.enabled=false"],
        &["capacity_nm=24", "lockup.enabled=false"],
        &["capacity_nm=33", "lockup.open_rpm=1300"],
    ];
    let car = |own: &&[&str]| {
        let set: Vec<String> = (own.iter())
            .map(|set| format!("transmission.cvt.launch.torque_converter.{set}"))
            .collect();
        try_car("rover_216_cvt", &set).unwrap_or_else(|problems| panic!("{problems}"))
    };
    let mut cars: Vec<Setup> = OWN.iter().map(car).collect();
    let part = [
        "transmission.cvt.launch.torque_converter.capacity_nm=27".to_owned(),
        "transmission.cvt.loss_factor.launch_clutch=0.5".to_owned(),
    ];
    cars.push(try_car("rover_216_cvt", &part).unwrap_or_else(|problems| panic!("{problems}")));
    assert_alone(&cars, &embedded("ece15_eudc").unwrap(), |k| Conditions {
        ambient_k: 262.0 + 6.0 * k as f64,
        ..COLD
    });
}
