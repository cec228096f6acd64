//! Drive-cycle losses and fuel of cars with a pushing-metal-V-belt CVT, cold and warm.
//!
//! The modules stand in the order in which data and power flow.

pub mod config;
pub mod numeric;
pub mod cycle;
pub mod lubricant;
pub mod vehicle;
pub mod transmission;
pub mod engine;
pub mod thermal;
pub mod setup;
pub mod simulate;
pub mod run;
pub mod results;
pub mod sensitivity;
pub mod provenance;
pub mod rig;
pub mod study;
pub mod validate;
pub mod calibrate;
pub mod report;
pub mod review;
