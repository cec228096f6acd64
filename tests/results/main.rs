//! Output files, plots, reports and the comparison with published values.

#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

#[path = "../common/mod.rs"]
mod common;
#[path = "../fixtures/mod.rs"]
mod fixtures;
#[path = "../common/titles.rs"]
mod titles;

mod attacks;
mod alike;
mod failures;
mod history;
mod outputs;
mod pictures;
mod record;
mod report;
mod validate;
