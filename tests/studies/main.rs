//! Plans, designs, execution and statistics of studies; fits to measurements.

#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

#[path = "../common/announced.rs"]
mod announced;
#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code, reason = "the pictures of runs are used by tests/results")]
#[path = "../fixtures/mod.rs"]
mod fixtures;
#[path = "../common/small_tables.rs"]
mod small_tables;
#[path = "../common/titles.rs"]
mod titles;
#[path = "../common/tree.rs"]
mod tree;

mod answer;
mod attribute;
mod calibrate;
mod calibrate_cli;
mod calibrate_solve;
mod calibrate_tables;
mod equations;
mod optimum;
mod levers;
mod order_of_factors;
mod param_set;
mod parquet_readers;
mod parts;
mod sensitivity;
mod study;
mod study_design;
mod study_distributions;
mod study_execute;
mod study_plan;
mod study_statistics;
mod study_store;
mod uncertainty_plan;
mod validate_expressions;
