//! Time of a run alone and in lockstep: `cargo run --release -p cvtcycle-model-tests --example together [VEHICLE [CYCLE [RUNS [LEVEL]]]]`; LEVEL is the set
//! of the processor's instructions: `sse2`, `avx2` or `avx512`, the best that it has where none is given.
//!
//! Cars that differ in mass, clutch, engine and oil drive a cycle one after another and side by side; the outcomes must have the same bits.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a program that shows numbers"
)]

use std::time::Instant;

use cvtcycle_config::Override;
use cvtcycle_config::cycle::embedded;
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_model::drive::{Conditions, Outcome, Run, Start, drive, drive_each_on};
use cvtcycle_model::math::{Level, Simd};

/// Numbers that differ between the cars, from a value on by a step.
const VARIED: [(&str, f64, f64); 4] = [
    ("road_load.mass_kg", 950.0, 23.0),
    ("engine.idle.hot_rpm", 760.0, 7.0),
    ("engine.friction.viscous_share", 0.3, 0.02),
    ("engine.accessory_nm", 0.1, 0.07),
];
/// How often the times are taken; the least counts.
const REPEATS: usize = 30;

fn car(vehicle: &str, number: usize) -> Setup {
    let set = |(place, (key, from, step)): (usize, &(&str, f64, f64))| {
        let steps = (number * (2 * place + 1)) % 11;
        format!("{key}={}", from + step * steps as f64)
    };
    let sets: Vec<String> = VARIED.iter().enumerate().map(set).collect();
    let options = Options {
        set: Override::parse_all(&sets).unwrap(),
        ..Options::default()
    };
    load(vehicle, &options).unwrap()
}

/// The processor's instructions of a name; none where it does not have them.
fn level(name: &str) -> Option<Level> {
    let best = Level::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    match name {
        "sse2" => return best.as_sse2().map(|simd| simd.level()),
        "avx2" => return best.as_avx2().map(|simd| simd.level()),
        "avx512" => return best.as_avx512().map(|simd| simd.level()),
        _ => {}
    }
    (name == "best").then_some(best)
}

/// Least time of some tries, s.
fn least_s(mut work: impl FnMut()) -> f64 {
    let once = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..REPEATS).map(once).fold(f64::INFINITY, f64::min)
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word =
        |place: usize, default: &str| words.get(place).cloned().unwrap_or(default.to_owned());
    let cycle = embedded(&word(1, "ece15_eudc")).unwrap();
    let count: usize = word(2, "8").parse().unwrap();
    let level = level(&word(3, "best")).unwrap();
    let cars: Vec<Setup> = (0..count)
        .map(|k| car(&word(0, "rover_216_5mt"), k))
        .collect();
    let conditions = Conditions {
        ambient_k: 266.15,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    let runs: Vec<Run> = cars
        .iter()
        .map(|car| Run {
            vehicle: car,
            conditions,
        })
        .collect();
    let alone = || -> Vec<Outcome> {
        (runs
            .iter()
            .map(|run| drive(run.vehicle, &cycle, &conditions)))
        .collect()
    };
    let numbers = |outcomes: &[Outcome]| -> Vec<String> {
        let one = |outcome: &Outcome| format!("{:?} {:?}", outcome.totals, outcome.end);
        outcomes.iter().map(one).collect()
    };
    let (one_by_one, side_by_side) = (
        numbers(&alone()),
        numbers(&drive_each_on(level, &runs, &cycle)),
    );
    let differ = one_by_one.iter().zip(&side_by_side).filter(|(a, b)| a != b);
    println!("{} of {count} runs differ", differ.count());
    let [alone_s, together_s] = [
        least_s(|| drop(alone())),
        least_s(|| drop(drive_each_on(level, &runs, &cycle))),
    ];
    let us = |seconds: f64| seconds * 1e6 / count as f64;
    println!(
        "alone {:.1} us a run, together {:.1} us, {:.2} times",
        us(alone_s),
        us(together_s),
        alone_s / together_s
    );
}
