//! The test benches, the belt command and tables of losses, through the library and the program.

#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "helpers and tables of tests"
)]

#[path = "../common/mod.rs"]
mod common;

mod belt;
mod loss_columns;
mod losses;
mod rig_transmission;
mod rig_variator;
