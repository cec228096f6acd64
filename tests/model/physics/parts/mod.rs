//! Parts of the model, each against hand calculations, printed numbers and its own properties.

mod belt;
mod curve;
mod elementary;
mod equations;
mod friction_clutch;
mod fuel;
mod gears;
mod geometry;
mod grid;
pub mod network;
mod phases;
mod pressure;
mod pump;
mod quantity;
mod range;
mod ratio_control;
mod road;
mod shift_speeds;
mod spin;
mod trace;
mod viscosity;
mod viscous_self_heating;
mod wheel_work;
