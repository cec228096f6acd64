//! The hydromechanical controller: ratio and secondary pressure.
mod pressure;
mod pressure_table;
mod ratio;
mod shift_map;

pub use pressure::{ClampKeys, ClampLaw, ClampSignals, MapLaw, clamp};
pub use pressure_table::{PRESSURE_TABLE, PressurePoint, PressureTable};
pub use ratio::{ColdRise, Moment, OperatingLine, RatioControl, RatioDemand, RatioKeys, Shifted};
pub(super) use ratio::{FREE_OVER_IDLE, direction_after};
pub use shift_map::{SHIFT_MAP, ShiftMap, ShiftPoint};
