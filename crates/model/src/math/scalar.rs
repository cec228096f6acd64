//! One run: f64 as a number of the physics.

use super::real::{LaneValue, Operand, Real, Selectable};
use super::{Curve, circular, clamp, elementary, larger, smaller};

impl Selectable<bool> for f64 {
    #[inline(always)]
    fn select(mask: bool, if_true: f64, if_false: f64) -> f64 {
        if mask { if_true } else { if_false }
    }
}

impl Real for f64 {
    type Mask = bool;
    type PerLane<T: LaneValue> = T;
    type Curve = Curve;
    const LANES: usize = 1;

    #[inline(always)]
    fn splat(self, number: f64) -> f64 {
        number
    }

    #[inline(always)]
    fn map_lanes(self, f: impl Fn(usize) -> f64) -> f64 {
        f(0)
    }

    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn with_lane(self, _: usize, number: f64) -> f64 {
        number
    }

    #[inline(always)]
    fn splat_mask(self, yes: bool) -> bool {
        yes
    }

    #[inline(always)]
    fn mask_lanes(self, f: impl Fn(usize) -> bool) -> bool {
        f(0)
    }

    #[inline(always)]
    fn per_lane<T: LaneValue>(mut f: impl FnMut(usize) -> T) -> T {
        f(0)
    }

    #[inline(always)]
    fn get<T: LaneValue>(of: &T, _: usize) -> &T {
        of
    }

    #[inline(always)]
    fn get_mut<T: LaneValue>(of: &mut T, _: usize) -> &mut T {
        of
    }

    #[inline(always)]
    fn curves(mut of: impl FnMut(usize) -> Curve) -> Curve {
        of(0)
    }

    #[inline(always)]
    fn curve(of: &Curve, _: usize) -> &Curve {
        of
    }

    #[inline(always)]
    fn interpolate(self, curve: &Curve) -> f64 {
        curve.at(self)
    }

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> f64 {
        f(self)
    }

    #[inline(always)]
    fn gt(self, other: impl Operand<f64>) -> bool {
        self > other.broadcast(self)
    }

    #[inline(always)]
    fn ge(self, other: impl Operand<f64>) -> bool {
        self >= other.broadcast(self)
    }

    #[inline(always)]
    fn bits_eq(self, other: f64) -> bool {
        self.to_bits() == other.to_bits()
    }

    #[inline(always)]
    fn abs(self) -> f64 {
        self.abs()
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        self.sqrt()
    }

    #[inline(never)]
    fn vectorize<T>(self, part: impl FnOnce() -> T) -> T {
        part()
    }

    #[inline(always)]
    fn exp_array<const COUNT: usize>(x: [f64; COUNT]) -> [f64; COUNT] {
        elementary::exp_array(x)
    }

    #[inline(always)]
    fn ln_array<const COUNT: usize>(x: [f64; COUNT]) -> [f64; COUNT] {
        elementary::ln_array(x)
    }

    #[inline(always)]
    fn max(self, other: impl Operand<f64>) -> f64 {
        larger(self, other.broadcast(self))
    }

    #[inline(always)]
    fn min(self, other: impl Operand<f64>) -> f64 {
        smaller(self, other.broadcast(self))
    }

    #[inline(always)]
    fn clamp(self, low: impl Operand<f64>, high: impl Operand<f64>) -> f64 {
        clamp(self, low.broadcast(self), high.broadcast(self))
    }

    #[inline(always)]
    fn exp(self) -> f64 {
        elementary::exp(self)
    }

    #[inline(always)]
    fn ln(self) -> f64 {
        elementary::ln(self)
    }

    #[inline(always)]
    fn tanh(self) -> f64 {
        elementary::tanh(self)
    }

    #[inline(always)]
    fn asin(self) -> f64 {
        circular::asin(self)
    }
}
