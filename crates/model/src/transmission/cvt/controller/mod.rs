//! The hydromechanical controller: ratio and secondary pressure.
mod pressure;
mod ratio;

pub use pressure::{ClampLaw, ClampSignals, MapLaw};
pub use ratio::{RatioControl, RatioDemand};
