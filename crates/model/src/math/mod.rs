//! Numerical tools without physics: interpolation, ramps, elementary functions, and the number that equations are written for.

mod circular;
mod curve;
mod curves;
mod elementary;
mod grid;
mod lanes;
mod lattice;
mod real;
mod scalar;
mod speed;

pub use circular::{asin, cos, sin_cos, tan};
pub use curve::Curve;
pub use cvtcycle_macros::{Gather, physics};
pub use elementary::{exp, exp_array, ln, ln_array, tanh};
pub use grid::{GRID_AXES, Grid};
pub use lanes::{Gather, LaneMask, Level, Simd, dispatch, eight, f64x4, f64x8, four};
pub(crate) use lanes::{MAX_LANES, gather_each};
pub use lattice::{Across, Lattice};
pub use real::{Implied, LaneValue, Left, Mask, Named, Operand, Real, Selectable};
pub use speed::{rad_s, rpm};

/// The larger of two numbers; the second where one is no number. Unlike `f64::max` a single instruction.
#[physics]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers; the second where one is no number.
#[physics]
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
#[physics]
pub fn ramp<R: Real>(x: R, from: R, to: R) -> R {
    let width = to - from;
    let step = x.ge(from).select(x.splat(1.0), x.splat(0.0));
    let along = ((x - from) / width).clamp(0.0, 1.0);
    width.abs().gt(0.0).select(along, step)
}

/// Mean of [`ramp`] over numbers from one to another, each as often.
#[physics]
pub fn mean_ramp<R: Real>([first, last]: [R; 2], from: R, to: R) -> R {
    let apart = last - first;
    let middle = ramp(0.5 * (first + last), from, to);
    let wide = apart.abs().gt(1e-6 * (first.abs() + last.abs()));
    if !wide.any() {
        return middle;
    }
    let risen = ramp_integral(last, from, to) - ramp_integral(first, from, to);
    wide.select(risen / apart, middle)
}

/// Integral of [`ramp`] up to a number.
#[physics]
fn ramp_integral<R: Real>(x: R, from: R, to: R) -> R {
    let (width, zero) = (to - from, x.splat(0.0));
    let along = (x - from).clamp(zero, width.max(zero));
    let risen = width.gt(0.0).select(0.5 * along * along / width, zero);
    risen + (x - to).max(zero)
}

/// Smooth ramp with zero slope at both ends (3 u2 - 2 u3).
#[physics]
pub fn smooth_ramp<R: Real>(x: R, from: R, to: R) -> R {
    let u = ramp(x, from, to);
    u * u * (3.0 - 2.0 * u)
}

/// The same of two sides, as an array: the compiler then works on both at once where it can.
#[physics]
pub fn pair(f: impl Fn(usize) -> f64) -> [f64; 2] {
    [f(0), f(1)]
}

/// `both!(i => of[i])`: the same of two sides, as an array; [`pair`] without a function, so that it is always inlined.
macro_rules! both {
    ($side:ident => $value:expr) => {
        [
            {
                let $side = 0;
                $value
            },
            {
                let $side = 1;
                $value
            },
        ]
    };
}
pub(crate) use both;

/// `places!(i in 0, 1, 2 => of[i])`: the same at several places, as an array, as [`both`].
macro_rules! places {
    ($place:ident in $($number:literal),* => $value:expr) => {
        [$({
            let $place = $number;
            $value
        }),*]
    };
}
pub(crate) use places;
