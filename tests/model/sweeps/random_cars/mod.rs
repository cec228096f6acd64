//! Properties of the whole program over random valid cars: the shipped cars with many values and parts changed, over random short cycles.
//!
//! Truth comes from laws that hold for any car: conservation of energy, losses that are losses, the second law, independence of the clock and
//! of units, and the stated order of the method; and from other ways to the same number (a dense solver, a matrix exponential, Simpson's rule).
//! A car that the reader refuses is not a case. Cars and cycles come from fixed seeds, so that a run can be repeated; every test prints how
//! many cases it saw.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests stop at the first surprise and say what they saw"
)]

mod cars;
mod invariance;
mod network;
mod physics;
mod rows;
mod traces;

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, RngSeed, TestCaseResult, TestRunner};

/// Tries a property on so many random inputs, the same ones in every run.
pub fn hold<S: Strategy>(cases: u32, strategy: &S, property: impl Fn(S::Value) -> TestCaseResult) {
    let config = Config {
        cases,
        failure_persistence: None,
        rng_algorithm: RngAlgorithm::ChaCha,
        rng_seed: RngSeed::Fixed(2001),
        max_shrink_iters: 400,
        ..Config::default()
    };
    if let Err(error) = TestRunner::new(config).run(strategy, property) {
        panic!("{error}");
    }
}
