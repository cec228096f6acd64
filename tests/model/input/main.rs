//! Inputs through the public items of the crate that reads them.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

#[path = "../../common/loose.rs"]
mod loose;

mod choices;
mod cycle;
mod dialects;
mod files;
mod like;
mod new_car;
mod overrides;
mod pairs;
mod problems;
mod reading;
mod setup;
mod twin;
mod written;
