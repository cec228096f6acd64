//! Physics of a car with its transmission: cycle, fluids, road load, transmission, engine, heat, drives and test benches.
//!
//! No input or output, SI units throughout. The modules are listed in the order of the power flow.

pub mod math;
pub mod keys;
pub mod cycle;
pub mod fluid;
pub mod road;
pub mod transmission;
pub mod engine;
pub mod thermal;
pub mod drive;
pub mod bench;
