//! The hydromechanical controller: ratio and secondary pressure.
mod pressure;
mod ratio;

pub use pressure::{ClampKeys, ClampLaw, ClampSignals, MapLaw, clamp};
pub use ratio::{RatioControl, RatioDemand, RatioKeys};
