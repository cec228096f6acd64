//! Shared by the model tests: loading cars, driving cycles, and steps with given conditions.
#![allow(
    dead_code,
    clippy::print_stdout,
    reason = "each test crate uses a part of it; tests print the numbers they found"
)]

pub mod bench_step;
pub mod range;

use cvtcycle_config::cycle::{Cycle, constant_speed, embedded, read_csv};
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_config::{Override, render};
use cvtcycle_model::drive::Recorder;
use cvtcycle_model::drive::{Conditions, Outcome, Start, drive, litres_per_100km};
use cvtcycle_model::drive::{EnergyTerms, Row};
use cvtcycle_model::rig::{Bench, BenchPoint};
use cvtcycle_model::transmission::component::Component;

/// Shipped vehicles.
pub const CARS: [&str; 3] = ["rover_216_cvt", "rover_216_5mt", "mondeo_20_5mt"];
/// rpm to rad/s.
pub const RPM: f64 = std::f64::consts::PI / 30.0;

/// 0 degC in K.
pub const ZERO: f64 = 273.15;

/// Loads a shipped vehicle with overrides, or returns its problems as printed for users.
pub fn try_car(name: &str, sets: &[String]) -> Result<Setup, String> {
    let load = |set| {
        let options = Options {
            set,
            ..Options::default()
        };
        load(name, &options)
    };
    Override::parse_all(sets)
        .and_then(load)
        .map_err(|problems| render(&problems, false))
}

/// Loads a shipped vehicle with overrides.
pub fn car(name: &str, sets: &[&str]) -> Setup {
    let sets: Vec<String> = sets.iter().map(|s| (*s).to_owned()).collect();
    try_car(name, &sets).unwrap_or_else(|problems| panic!("{name} {sets:?}: {problems}"))
}

/// Bench with the reference car.
pub fn rover_bench() -> Bench {
    Bench::new(&car("rover_216_cvt", &[]))
}

/// Loaded point of the bench: 200 Nm at the output, belt at 90 degC.
pub fn loaded_point() -> BenchPoint {
    BenchPoint {
        output_nm: 200.0,
        throttle: 0.3,
        belt_k: Some(90.0 + ZERO),
        ..BenchPoint::default()
    }
}

/// An embedded or constant-speed cycle.
pub fn cycle(name: &str) -> Cycle {
    match constant_speed(name) {
        Some(cycle) => cycle.expect("constant speed"),
        None => embedded(name).unwrap_or_else(|| panic!("no cycle {name}")),
    }
}

/// Hill: 8 % up from standstill, then 6 % down, driven at up to 70 km/h.
pub fn hill() -> Cycle {
    let text = "time_s,speed_kmh,grade_percent\n0,0,0\n5,0,8\n20,40,8\n80,60,8\n110,70,8\n140,50,-6\n200,60,-6\n215,0,0\n225,0,0\n";
    read_csv("hill.csv", text.as_bytes())
        .unwrap_or_else(|problems| panic!("{}", render(&problems, false)))
}

/// Conditions of a run with a step of 1 s.
pub fn at(ambient_degc: f64, start: Start) -> Conditions {
    Conditions {
        ambient_k: ambient_degc + ZERO,
        start,
        max_dt_s: 1.0,
        keep_rows: false,
    }
}

/// Drives after a soak and keeps the rows.
pub fn soak_rows(setup: &Setup, cycle: &Cycle, ambient_degc: f64) -> Outcome {
    drive(
        setup,
        cycle,
        &Conditions {
            keep_rows: true,
            ..at(ambient_degc, Start::Soak)
        },
    )
}

/// Fuel of a drive, kg.
pub fn fuel_kg(setup: &Setup, cycle: &Cycle, conditions: &Conditions) -> f64 {
    drive(setup, cycle, conditions).totals.total().fuel_kg
}

/// Consumption in L/100 km of the shipped petrol (745 kg/m3) over the phases of a group, or over all.
pub fn consumption(outcome: &Outcome, cycle: &Cycle, group: Option<&str>) -> f64 {
    let sum = match group {
        Some(name) => {
            let groups = cycle.phase_groups();
            let (_, phases) = groups.iter().find(|g| g.0 == name).expect("phase group");
            outcome.totals.over(phases)
        }
        None => outcome.totals.total(),
    };
    litres_per_100km(sum.fuel_kg, 745.0, sum.distance_m)
}

/// Collects rows and energy terms.
#[derive(Default)]
pub struct Keep {
    pub rows: Vec<Row>,
    pub terms: Vec<EnergyTerms>,
}

impl Recorder for Keep {
    fn record(&mut self, row: &Row, terms: &EnergyTerms) {
        self.rows.push(*row);
        self.terms.push(*terms);
    }
}

/// Names of components in the order of [`Component::ALL`].
pub fn component_names() -> [&'static str; Component::COUNT] {
    Component::ALL.map(Component::name)
}

/// Maximum of two numbers that returns NaN if either is NaN, so that NaN fails a test.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
