//! The program as a user runs it: commands, documents, limits of inputs, faults of its surroundings.

#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

#[path = "../common/sources.rs"]
mod sources;
#[path = "../common/tree.rs"]
mod tree;

mod commands;
mod documents;
mod faults;
mod limits;
mod results_page;
