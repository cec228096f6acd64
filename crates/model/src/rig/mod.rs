//! The thesis's test rigs, virtual: a transmission or its variator driven by a motor, at held speed, torque and oil temperature.
//!
//! [`Bench`] answers one operating point of a whole box, part by part; the rigs of chapters 4 to 6 are series of such points.

mod point;
mod cvt_bench;
mod held_point;
mod input_torque;
mod limits;
pub mod transmission;
pub mod variator;

pub use crate::transmission::cvt::Parts;
pub use held_point::{AtRatio, Bench, KeptRatio};
pub use limits::solvable_ratios;
pub use point::{BenchAnswer, BenchPoint};
