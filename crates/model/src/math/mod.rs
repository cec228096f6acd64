//! Numerical tools without physics: interpolation, ramps, elementary functions.

mod circular;
mod curve;
mod elementary;
mod grid;

pub use circular::{asin, cos, sin_cos, tan};
pub use curve::Curve;
pub use elementary::{exp, exp_each, ln, ln_each, tanh};
pub use grid::{GRID_AXES, Grid};

/// The larger of two numbers; the second where one is no number. Unlike `f64::max` a single instruction.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers; the second where one is no number.
#[inline(always)]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// `x` held between `low` and `high`; NaN stays NaN. Unlike `f64::clamp` without a check of the bounds.
#[inline]
pub fn clamp(x: f64, low: f64, high: f64) -> f64 {
    // In this order both are single instructions, and NaN passes.
    let x = if low > x { low } else { x };
    if high < x { high } else { x }
}

/// Linear ramp: 0 at or below `from`, 1 at or above `to`.
///
/// `from` and `to` may be in either order; equal ends give a step: 0 below them, 1 at them and above.
#[inline]
pub fn ramp(x: f64, from: f64, to: f64) -> f64 {
    let width = to - from;
    if width.abs() > 0.0 {
        clamp((x - from) / width, 0.0, 1.0)
    } else {
        f64::from(u8::from(x >= from))
    }
}

/// Smooth ramp with zero slope at both ends (3 u2 - 2 u3).
#[inline]
pub fn smooth_ramp(x: f64, from: f64, to: f64) -> f64 {
    let u = ramp(x, from, to);
    u * u * (3.0 - 2.0 * u)
}

/// The same of two sides, as an array: the compiler then works on both at once where it can.
#[inline(always)]
pub fn pair(f: impl Fn(usize) -> f64) -> [f64; 2] {
    [f(0), f(1)]
}
