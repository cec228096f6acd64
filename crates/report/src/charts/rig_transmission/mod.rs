//! Pictures of the transmission rig's tests.

pub mod plots;
pub mod strip_down;
