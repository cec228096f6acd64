//! The transmission rig of thesis chapters 4 and 5: steady maps, strip-down, transients, a second box.
//!
//! Each test is a series of points of [`super::Bench`]; what the rig is set to is data, [`Conditions`].

mod conditions;
mod keys;
mod steady;
mod strip_down;
mod transient;

pub use conditions::{Conditions, PressureFactors, RigCooler, Speeds, TransientTest};
pub use keys::{OIL, RigKeys, TORQUE};
pub use steady::{Plan, SteadyPoint, TwoBoxes, loaded, second_box, steady};
pub use strip_down::{Found, Piece, Stage, StripDown, strip_down};
pub use transient::{Branch, Loop, LoopEnergy, MAX_DURATION_S, Moment, on_the_rig, transient};
