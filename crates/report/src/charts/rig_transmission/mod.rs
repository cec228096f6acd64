//! Tables and pictures of the transmission rig's tests.

pub mod plots;
pub mod tables;
