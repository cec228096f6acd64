//! Pictures, typical and unusual: valid, readable and equal to their numbers.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

mod ambient;
mod bars;
mod calibration;
mod decision;
mod difference;
mod flow;
mod lines;
mod overlay;
mod runs;
mod svg_checks;
mod titles;
mod variogram;
