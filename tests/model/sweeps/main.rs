//! Properties of the model over many points: continuity in every input, laws over random cars and cycles.

#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

#[path = "../../common/mod.rs"]
mod common;

mod continuity;
mod random_cars;
