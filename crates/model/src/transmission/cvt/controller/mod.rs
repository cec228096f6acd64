//! The hydromechanical controller: ratio and secondary pressure.
mod pressure;
mod ratio;

pub use pressure::{ClampKeys, ClampLaw, ClampSignals, MapLaw, clamp};
pub use ratio::{ColdRise, OperatingLine, RatioControl, RatioDemand, RatioKeys};
pub(super) use ratio::{FREE_OVER_IDLE, direction_after};
