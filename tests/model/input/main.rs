//! Inputs through the public items of the crate that reads them.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

#[path = "../../common/loose.rs"]
mod loose;

mod bounded;
mod catalogue;
mod check_only;
mod choices;
mod constant;
mod csv;
mod near;
mod overrides;
mod problems;
mod reading;
mod render;
mod rig;
mod syntax;
