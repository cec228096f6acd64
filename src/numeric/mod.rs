//! Numerical tools without physics: interpolation and root bracketing.

mod curve;
mod grid;

pub use curve::Curve;
pub use grid::{GRID_AXES, Grid};

/// Linear ramp: 0 at or below `from`, 1 at or above `to`.
///
/// `from` and `to` may stand in either order; equal ends give a step: 0 below them, 1 at them and above.
#[must_use]
#[inline]
pub fn ramp(x: f64, from: f64, to: f64) -> f64 {
    let width = to - from;
    if width.abs() > 0.0 { ((x - from) / width).clamp(0.0, 1.0) } else { f64::from(u8::from(x >= from)) }
}

/// Smooth ramp with zero slope at both ends (3 u2 - 2 u3).
#[must_use]
#[inline]
pub fn smooth_ramp(x: f64, from: f64, to: f64) -> f64 {
    let u = ramp(x, from, to);
    u * u * (3.0 - 2.0 * u)
}
