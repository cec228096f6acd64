//! Error of the time step: `cargo run --release -p cvtcycle-model-tests --example steps [VEHICLE [CYCLE]]`, one minute and a half on one core for all.
//!
//! All shipped cars drive all shipped cycles from a soak at 25 degC with steps of at most 1, 0.5, 0.25, 0.1 and 0.05 s. Printed are, for each car, the largest and
//! the median error of the fuel against 0.05 s, the order that the medians have from 1 to 0.25 s, and the pairs whose verdict depends on the step. With a
//! car, or a car and a cycle, each pair is a line.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a program that shows numbers"
)]

use cvtcycle_config::cycle::{embedded, names};
use cvtcycle_config::setup::{Kind, Options, Setup, load};
use cvtcycle_model::cycle::Cycle;
use cvtcycle_model::drive::{Conditions, Start, Totals, drive};
use cvtcycle_model::flags::Flags;

/// Largest steps, s; the last is the reference.
const STEPS: [f64; 5] = [1.0, 0.5, 0.25, 0.1, 0.05];
/// Flags that fail a run.
const FAILS: [Flags; 5] = [
    Flags::MISSED_TRACE,
    Flags::NOT_CONVERGED,
    Flags::OVERSPEED,
    Flags::TOO_HOT,
    Flags::WRONG_GEAR,
];

/// Fuel and seconds of each failure at each step.
struct Pair {
    cycle: &'static str,
    fuel_kg: [f64; STEPS.len()],
    estimate_kg: [f64; STEPS.len()],
    failed_s: [[f64; FAILS.len()]; STEPS.len()],
}

impl Pair {
    fn drive(car: &Setup, cycle: &Cycle, name: &'static str) -> Self {
        let totals: [Totals; STEPS.len()] = STEPS.map(|max_dt_s| {
            let conditions = Conditions {
                ambient_k: 298.15,
                start: Start::Soak,
                max_dt_s,
                keep_rows: false,
            };
            drive(car, cycle, &conditions).totals
        });
        let engine = car.engine();
        let line_ends = engine.full_load.points().last();
        let highest = line_ends.map_or(engine.highest_rad_s, |(speed, _)| {
            engine.highest_rad_s.max(speed)
        });
        Pair {
            cycle: name,
            fuel_kg: std::array::from_fn(|k| totals[k].total().fuel_kg),
            estimate_kg: std::array::from_fn(|k| totals[k].step_error_kg()),
            failed_s: std::array::from_fn(|k| {
                FAILS.map(|flag| match flag {
                    // As in the checks of a run: belt slip adds to the target of the ratio.
                    Flags::OVERSPEED if totals[k].fastest_rad_s.value <= 1.01 * highest => 0.0,
                    flag => totals[k].seconds(flag),
                })
            }),
        }
    }

    /// Error of the fuel against the finest step, %.
    fn error_percent(&self, step: usize) -> f64 {
        100.0 * (self.fuel_kg[step] / self.fuel_kg[STEPS.len() - 1] - 1.0)
    }

    /// Estimate of that error (TS-1), %.
    fn estimate_percent(&self, step: usize) -> f64 {
        100.0 * self.estimate_kg[step] / self.fuel_kg[step]
    }

    /// True if the same checks fail with every step.
    fn has_one_verdict(&self) -> bool {
        let fails = |step: usize| self.failed_s[step].map(|seconds| seconds > 0.0);
        (1..STEPS.len()).all(|step| fails(step) == fails(0))
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let wanted = |place: usize, name: &str| words.get(place).is_none_or(|word| word == name);
    let (mut pairs, mut alike) = (0, 0);
    println!(
        "car | largest, % at 1 0.5 0.25 0.1 s | median, % | order | median estimate, % | within twice the estimate | other verdicts"
    );
    for vehicle in Kind::Vehicle.names() {
        if !wanted(0, vehicle) {
            continue;
        }
        let car = load(vehicle, &Options::default()).unwrap();
        let cycles = names().iter().filter(|name| wanted(1, name));
        let driven: Vec<Pair> = cycles
            .map(|name| Pair::drive(&car, &embedded(name).unwrap(), name))
            .collect();
        if !words.is_empty() {
            for pair in &driven {
                let errors = [0, 1, 2, 3].map(|step| format!("{:+.3}", pair.error_percent(step)));
                let seconds = pair
                    .failed_s
                    .map(|failed| failed.map(|s| format!("{s:.2}")).join(" "));
                let estimates =
                    [0, 1, 2, 3].map(|step| format!("{:.3}", pair.estimate_percent(step)));
                println!(
                    "{} | {} | {} | {}",
                    pair.cycle,
                    errors.join(" "),
                    estimates.join(" "),
                    seconds.join(" ; ")
                );
            }
        }
        let errors = |step: usize| -> Vec<f64> {
            driven
                .iter()
                .map(|pair| pair.error_percent(step).abs())
                .collect()
        };
        let largest = [0, 1, 2, 3].map(|step| errors(step).into_iter().fold(0.0, f64::max));
        let medians = [0, 1, 2, 3].map(|step| median(errors(step)));
        let order = (medians[0] / medians[2]).ln() / 4_f64.ln();
        let estimates = [0, 1, 2, 3].map(|step| {
            median(
                driven
                    .iter()
                    .map(|pair| pair.estimate_percent(step))
                    .collect(),
            )
        });
        let within = [0, 1, 2, 3].map(|step| {
            let holds =
                |pair: &&Pair| pair.error_percent(step).abs() <= 2.0 * pair.estimate_percent(step);
            driven.iter().filter(holds).count()
        });
        let others: Vec<&str> = driven
            .iter()
            .filter(|pair| !pair.has_one_verdict())
            .map(|pair| pair.cycle)
            .collect();
        pairs += driven.len();
        alike += driven.len() - others.len();
        println!(
            "{vehicle} | {} | {} | {order:.2} | {} | {within:?} of {} | {}",
            largest.map(|error| format!("{error:.3}")).join(" "),
            medians.map(|error| format!("{error:.3}")).join(" "),
            estimates.map(|error| format!("{error:.3}")).join(" "),
            driven.len(),
            others.join(" ")
        );
    }
    println!("same verdict with every step: {alike} of {pairs} pairs");
}
