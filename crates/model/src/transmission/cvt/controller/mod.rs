//! The hydromechanical controller: ratio and secondary pressure.
mod pressure;
mod ratio;

pub use pressure::{ClampKeys, ClampLaw, ClampSignals, MapLaw, clamp};
pub(super) use ratio::{FREE_OVER_IDLE, direction_after};
pub use ratio::{OperatingLine, RatioControl, RatioDemand, RatioKeys};
