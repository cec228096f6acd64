//! exp, ln and tanh in plain arithmetic: short enough to be inlined into a loop, and the same bits on every machine.
//!
//! exp x = 2^k t_j exp r with t_j = 2^(j/64) and |r| <= ln 2 / 128, exp r by its Taylor series to r^5; the rest is below 4e-17.
//! ln x = e ln 2 + ln c + ln(1 + r) with x = 2^e c (1 + r), c the middle of one of 128 cells, ln(1 + r) by its series to r^7; the
//! rest is below 2e-18. The tables come from the Taylor series and from ln c = 2 artanh((c - 1)/(c + 1)), at build time.
//!
//! tanh x for |x| < 1 is the ninth convergent of x/(1 + z/(3 + z/(5 + ..))), z = x2; the rest is below 5e-17 of it. Beyond, 1 - 2/(1 + exp 2|x|).
//!
//! exp: relative error at most 6e-16 below 700 in magnitude, 2e-15 beyond. ln: error at most 6e-16 of the larger of 1 and |ln x|, relative
//! within 1/256 of x = 1. tanh: at most 1.3 units of the last place. A library's own functions may differ in the last bit from one
//! processor to the next; these use +, -, x, / only.

use super::physics;
use super::real::{Mask, Real};
use std::f64::consts::LN_2;

/// Leading bits of ln 2, so that a small whole number times it is exact.
const LN_2_HIGH: f64 = f64::from_bits(LN_2.to_bits() & !0x1f_ffff);
/// The rest of ln 2; what the nearest f64 lacks of ln 2 is 2.319e-17.
const LN_2_LOW: f64 = (LN_2 - LN_2_HIGH) + 2.319_046_813_846_299_6e-17;
/// Largest magnitude that exp's own arithmetic takes.
const EXP_REACH: f64 = 700.0;
/// Adding this rounds to a whole number, which is then in the lowest bits: 1.5 2^52.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// Parts of a power of two.
const PARTS: usize = 64;
/// Cells of c.
const CELLS: usize = 128;
/// Bits of the smallest c's cell, 0.6875: the cells reach from there to twice as much, and 1 is an edge.
const FIRST_CELL: u64 = 0x3fe6_0000_0000_0000;

const ONE: u64 = 1.0f64.to_bits();

/// t_j.
static POWER: [f64; PARTS] = {
    let mut t = [0.0; PARTS];
    let mut j = 0;
    while j < PARTS {
        t[j] = taylor(j as f64 * LN_2 / PARTS as f64);
        j += 1;
    }
    t
};

/// 1/c and ln c.
static CELL: [(f64, f64); CELLS] = {
    let mut cells = [(1.0, 0.0); CELLS];
    let mut i = 0;
    while i < CELLS {
        let low = f64::from_bits(FIRST_CELL + ((i as u64) << 45));
        let high = f64::from_bits(FIRST_CELL + ((i as u64 + 1) << 45));
        // The two cells that meet at 1 take c = 1, so that small logarithms keep their digits.
        if low.to_bits() != ONE && high.to_bits() != ONE {
            let inverse = 2.0 / (low + high);
            cells[i] = (inverse, -artanh_ln(inverse));
        }
        i += 1;
    }
    cells
};

/// exp x for 0 <= x <= 1.
const fn taylor(x: f64) -> f64 {
    let (mut sum, mut k) = (1.0, 25);
    while k > 0 {
        sum = 1.0 + sum * x / k as f64;
        k -= 1;
    }
    sum
}

/// ln x for 1/2 <= x <= 2.
const fn artanh_ln(x: f64) -> f64 {
    let s = (x - 1.0) / (x + 1.0);
    let (mut sum, mut k) = (0.0, 41);
    while k > 0 {
        sum = sum * s * s + 1.0 / k as f64;
        k -= 2;
    }
    2.0 * s * sum
}

/// e to the power of x.
#[inline]
pub fn exp(x: f64) -> f64 {
    exp_array([x])[0]
}

/// e to the power of each x, the same bits as one by one: several together cost little more than one, since processors work in pairs.
#[physics]
pub fn exp_array<const N: usize>(mut x: [f64; N]) -> [f64; N] {
    // A loop, as `map` is a function of its own without the processor's features. One comparison for all: a sum within reach has every term within it. Beyond, each is asked.
    let sum = x.iter().fold(0.0, |sum, x| sum + x.abs());
    if sum < EXP_REACH {
        for x in &mut x {
            *x = exp_within(*x);
        }
    } else {
        for x in &mut x {
            *x = exp_anywhere(*x);
        }
    }
    x
}

/// exp where several are large.
#[cold]
#[inline(never)]
fn exp_anywhere(x: f64) -> f64 {
    if x.abs() < EXP_REACH {
        exp_within(x)
    } else {
        // Held where the square has long left the range of numbers.
        let root = exp_within(x.clamp(-1000.0, 1000.0) * 0.5);
        root * root
    }
}

/// exp within reach of its series, of one number or of several side by side.
#[physics]
fn exp_within<R: Real>(x: R) -> R {
    const PER_PART: f64 = PARTS as f64 / LN_2;
    const PART_HIGH: f64 = LN_2_HIGH / PARTS as f64;
    const PART_LOW: f64 = LN_2_LOW / PARTS as f64;
    const INV_6: f64 = 1.0 / 6.0;
    const INV_24: f64 = 1.0 / 24.0;
    const INV_120: f64 = 1.0 / 120.0;
    let shifted = x * PER_PART + ROUND;
    let n = shifted - ROUND;
    let r = (x - n * PART_HIGH) - n * PART_LOW;
    let r2 = r * r;
    let part = r + r2 * ((r * INV_6 + 0.5) + r2 * (r * INV_120 + INV_24));
    let power = shifted.map(|shifted| {
        let whole = shifted.to_bits();
        let t = POWER[whole as usize % PARTS].to_bits();
        f64::from_bits(t.wrapping_add((whole & !(PARTS as u64 - 1)) << 46))
    });
    power + power * part
}

/// exp of several numbers side by side, the same bits as one by one.
#[physics]
pub(super) fn exp_lanes<R: Real>(x: R) -> R {
    if x.splat(EXP_REACH).gt(x.abs()).all() {
        exp_within(x)
    } else {
        x.map(exp_anywhere)
    }
}

/// Natural logarithm.
#[inline]
pub fn ln(x: f64) -> f64 {
    ln_array([x])[0]
}

/// Natural logarithm of each x, the same bits as one by one; see [`exp_array`].
#[physics]
pub fn ln_array<const N: usize>(mut x: [f64; N]) -> [f64; N] {
    // One comparison for all: between 2^-511 and 2^512 the two leading bits of this difference are zero. Beyond, each is asked.
    const LEAST: u64 = 512 << 52;
    let bits = x
        .iter()
        .fold(0, |bits, x| bits | x.to_bits().wrapping_sub(LEAST));
    if bits >> 62 == 0 {
        for x in &mut x {
            *x = ln_plain(*x);
        }
    } else {
        for x in &mut x {
            *x = ln_anywhere(*x);
        }
    }
    x
}

/// ln where one of several is far from 1.
#[cold]
#[inline(never)]
fn ln_anywhere(x: f64) -> f64 {
    /// Makes a normal number of every positive one below them.
    const TWO_54: f64 = 18_014_398_509_481_984.0;
    if (f64::MIN_POSITIVE..f64::INFINITY).contains(&x) {
        ln_plain(x)
    } else if x > 0.0 && x < 1.0 {
        ln_plain(x * TWO_54) - 54.0 * LN_2
    } else if x < 0.0 {
        f64::NAN
    } else if x > 0.0 {
        x
    } else {
        // -infinity for both zeros, NaN for NaN.
        -1.0 / x.abs()
    }
}

/// ln of a normal positive number, or of several side by side.
#[physics]
fn ln_plain<R: Real>(x: R) -> R {
    /// Exponent field of 1.
    const BIAS: u64 = 1023 << 52;
    /// A whole number below it, put in its lowest bits, is added to it.
    const TWO_52: f64 = 4_503_599_627_370_496.0;
    const TWO_52_BIASED: f64 = TWO_52 + 1023.0;
    const INV_3: f64 = 1.0 / 3.0;
    const INV_6: f64 = 1.0 / 6.0;
    const INV_7: f64 = 1.0 / 7.0;
    #[physics]
    fn above(x: f64) -> u64 {
        x.to_bits().wrapping_add(BIAS - FIRST_CELL)
    }
    #[physics]
    fn cell(x: f64) -> (f64, f64) {
        CELL[(above(x) >> 45) as usize % CELLS]
    }
    let inverse = x.map(|x| cell(x).0);
    let ln_c = x.map(|x| cell(x).1);
    let e = x.map(|x| f64::from_bits(above(x) >> 52 | TWO_52.to_bits())) - TWO_52_BIASED;
    let scaled = x.map(|x| {
        let exponent = above(x) & 0xfff0_0000_0000_0000;
        f64::from_bits(x.to_bits().wrapping_sub(exponent).wrapping_add(BIAS))
    });
    let r = scaled * inverse - 1.0;
    let r2 = r * r;
    let low = r2 * (r * INV_3 - 0.5);
    let high = r2 * r2 * ((r * 0.2 - 0.25) + r2 * (r * INV_7 - INV_6));
    (e * LN_2_HIGH + ln_c) + (r + (low + (high + e * LN_2_LOW)))
}

/// ln of several numbers side by side, the same bits as one by one.
#[physics]
pub(super) fn ln_lanes<R: Real>(x: R) -> R {
    let (least, most) = (x.splat(f64::MIN_POSITIVE), x.splat(f64::MAX));
    let plain = x.ge(least) & most.ge(x);
    if plain.all() {
        ln_plain(x)
    } else {
        x.map(ln_anywhere)
    }
}

/// tanh for |x| < 1, of one number or of several side by side; z = x2.
#[physics]
fn tanh_near<R: Real>(x: R, z: R) -> R {
    // Small whole numbers: the numerator of the convergent over x, and what its denominator has more.
    let more = z * (z * (z * (z * 44.0 + 12_870.0) + 810_810.0) + 11_486_475.0);
    let less = z * (z * (z * (z + 990.0) + 135_135.0) + 4_729_725.0) + 34_459_425.0;
    x - x * (more / (less + more))
}

/// tanh for |x| >= 1, but for its sign.
#[physics]
fn tanh_beyond<R: Real>(e: R) -> R {
    e.splat(1.0) - e.splat(2.0) / (e + 1.0)
}

/// tanh of several numbers side by side, the same bits as one by one.
#[physics]
pub(super) fn tanh_lanes<R: Real>(x: R) -> R {
    let z = x * x;
    let near = z.splat(1.0).gt(z);
    let tanh = tanh_near(x, z);
    if near.all() {
        return tanh;
    }
    let beyond = tanh_beyond(exp_lanes(x.abs() * 2.0));
    let beyond = x.splat(0.0).gt(x).select(-beyond, beyond);
    near.select(tanh, beyond)
}

/// Hyperbolic tangent.
#[inline]
pub fn tanh(x: f64) -> f64 {
    let z = x * x;
    if z < 1.0 {
        tanh_near(x, z)
    } else {
        tanh_beyond(exp(2.0 * x.abs())).copysign(x)
    }
}
