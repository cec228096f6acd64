//! Circular functions in plain arithmetic, so that their bits are the same on every machine; the standard library's are those of a C library.
//!
//! asin x = x + x z P(z) with z = x2 and |x| <= 1/2; P interpolates (asin(x)/x - 1)/z at the 13 Chebyshev nodes of 0 <= z <= 1/4, worked out with 60
//! digits; the rest is below 6e-18 of asin x. Beyond 1/2, asin x = pi/2 - 2 asin y with y2 = (1 - x)/2, y in two parts.
//! sin and cos by their Taylor series within pi/4 of a multiple of pi/2, to x^17 and x^18; the rest is below 4e-19.
//!
//! asin, sin, cos: at most one unit of the last place; tan two. sin and cos for |x| <= 100, within 1e-24 where they vanish. asin is NaN beyond 1.

use super::physics;
use super::real::{Mask, Real};
use std::f64::consts::FRAC_PI_2;

/// Difference of pi/2 and the nearest f64.
const FRAC_PI_2_LOW: f64 = 6.123_233_995_736_766e-17;
/// Leading 33 bits of pi/2, so that a small whole number times it is exact.
const FRAC_PI_2_HIGH: f64 = f64::from_bits(FRAC_PI_2.to_bits() & !0xf_ffff);
/// The rest of pi/2.
const FRAC_PI_2_REST: f64 = (FRAC_PI_2 - FRAC_PI_2_HIGH) + FRAC_PI_2_LOW;

/// Largest magnitude of x for which asin x is the polynomial of x itself.
const ASIN_REACH: f64 = 0.5;

/// P of asin, from z^0.
const ASIN: [f64; 13] = [
    0.166_666_666_666_666_69,
    0.074_999_999_999_984_33,
    0.044_642_857_146_355_43,
    0.030_381_944_138_531_247,
    0.022_372_172_942_149_89,
    0.017_352_392_720_869_973,
    0.013_971_212_973_552_933,
    0.011_479_177_415_184_906,
    0.010_322_814_350_185_78,
    0.005_457_506_718_640_358,
    0.017_400_879_442_694_02,
    -0.014_851_887_071_247_204,
    0.028_757_851_367_421_566,
];

/// z P(z), in pieces of three coefficients that wait for no other.
#[physics]
fn asin_series<R: Real>(z: R) -> R {
    #[physics]
    fn three<R: Real>(z: R, k: usize) -> R {
        z * (z * ASIN[k + 2] + ASIN[k + 1]) + ASIN[k]
    }
    let z3 = z * (z * z);
    let low = three(z, 0) + z3 * three(z, 3);
    let high = three(z, 6) + z3 * (three(z, 9) + z3 * ASIN[12]);
    z * (low + (z3 * z3) * high)
}

/// asin of several numbers side by side, the same bits as one by one.
#[physics]
pub(super) fn asin_lanes<R: Real>(x: R) -> R {
    if x.splat(ASIN_REACH).ge(x.abs()).all() {
        x + x * asin_series(x * x)
    } else {
        x.map(asin_of_one)
    }
}

/// asin where a lane is beyond.
#[cold]
#[inline(never)]
fn asin_of_one(x: f64) -> f64 {
    asin(x)
}

/// Angle whose sine is x, rad, from -pi/2 to pi/2.
#[inline]
pub fn asin(x: f64) -> f64 {
    if x.abs() <= ASIN_REACH {
        x + x * asin_series(x * x)
    } else {
        asin_steep(x)
    }
}

/// asin beyond its own polynomial.
#[cold]
fn asin_steep(x: f64) -> f64 {
    /// A product with it splits off the leading half of the digits: 2^27 + 1.
    const SPLIT: f64 = 134_217_729.0;
    let z = 0.5 * (1.0 - x.abs());
    let y = z.sqrt();
    let head = y * SPLIT - (y * SPLIT - y);
    // y is head + rest; both of the root's errors are gone: head has half of the digits, so its square is exact.
    let rest = if y > 0.0 {
        (z - head * head) / (y + head)
    } else {
        y
    };
    let rest = rest + y * asin_series(z);
    let angle = (FRAC_PI_2 - 2.0 * head) + (FRAC_PI_2_LOW - 2.0 * rest);
    angle.copysign(x)
}

/// Sine and cosine of an angle, rad.
pub fn sin_cos(x: f64) -> (f64, f64) {
    let quarters = (x / FRAC_PI_2).round();
    let far = x - quarters * FRAC_PI_2_HIGH;
    let r = far - quarters * FRAC_PI_2_REST;
    // Rounding error of the second difference.
    let low = (far - r) - quarters * FRAC_PI_2_REST;
    let z = r * r;
    let sin = r + (r * z * (taylor(z, 3) / -6.0) + low * (1.0 - 0.5 * z));
    let half = 0.5 * z;
    let most = 1.0 - half;
    let cos = most + (((1.0 - most) - half) + (z * z * (taylor(z, 4) / 24.0) - r * low));
    match (quarters as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// n!/n! - n! z/(n + 2)! + n! z2/(n + 4)! - ..: what a Taylor series of sine or cosine has after the power n, over its term there.
fn taylor(z: f64, n: u32) -> f64 {
    (0..8).rev().fold(0.0, |sum, k| {
        let n = f64::from(n + 2 * k);
        1.0 - z * sum / ((n + 1.0) * (n + 2.0))
    })
}

/// Cosine of an angle, rad.
pub fn cos(x: f64) -> f64 {
    sin_cos(x).1
}

/// Tangent of an angle, rad.
pub fn tan(x: f64) -> f64 {
    let (sin, cos) = sin_cos(x);
    sin / cos
}
