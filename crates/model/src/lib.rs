//! Physics of a car with its transmission: cycle, fluids, road load, transmission, engine, heat, drives and test benches.
//!
//! No input or output, SI units throughout. The modules are listed in the order of their use: each uses those above it only.

// The derive of `Gather` names this crate from outside and inside alike.
extern crate self as cvtcycle_model;

pub mod math;
pub mod maps;
pub mod keys;
pub mod equations;
pub mod flags;
pub mod prime_mover;
pub mod cycle;
pub mod lubricant;
pub mod road;
pub mod thermal;
pub mod transmission;
pub mod engine;
pub mod drive;
pub mod rig;
pub mod files;
