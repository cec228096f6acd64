//! The program as run by users: commands, documents, limits of inputs, faults of its environment.

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
