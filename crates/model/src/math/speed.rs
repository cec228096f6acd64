//! Speeds of rotation between the unit of the model and that of people.

use std::f64::consts::PI;

/// A speed in rad/s, converted to rpm.
#[must_use]
pub const fn rpm(rad_s: f64) -> f64 {
    rad_s * 30.0 / PI
}

/// A speed in rpm, converted to rad/s.
#[must_use]
pub const fn rad_s(rpm: f64) -> f64 {
    rpm * PI / 30.0
}
