//! Pictures of the transmission rig's tests.

pub mod plots;
