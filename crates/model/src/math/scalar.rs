//! One run: f64 as a number of the physics.

use super::physics;
use super::real::{LaneValue, Operand, Real, Selectable};
use super::{Curve, circular, clamp, elementary, larger, smaller};

#[physics]
impl Selectable<bool> for f64 {
    fn select(mask: bool, if_true: f64, if_false: f64) -> f64 {
        if mask { if_true } else { if_false }
    }
}

#[physics]
impl Real for f64 {
    type Mask = bool;
    type PerLane<T: LaneValue> = T;
    type Curve = Curve;
    const LANES: usize = 1;

    fn splat(self, number: f64) -> f64 {
        number
    }

    fn map_lanes(self, f: impl Fn(usize) -> f64) -> f64 {
        f(0)
    }

    fn lane(self, _: usize) -> f64 {
        self
    }

    fn with_lane(self, _: usize, number: f64) -> f64 {
        number
    }

    fn splat_mask(self, yes: bool) -> bool {
        yes
    }

    fn mask_lanes(self, f: impl Fn(usize) -> bool) -> bool {
        f(0)
    }

    fn per_lane<T: LaneValue>(mut f: impl FnMut(usize) -> T) -> T {
        f(0)
    }

    fn get<T: LaneValue>(of: &T, _: usize) -> &T {
        of
    }

    fn get_mut<T: LaneValue>(of: &mut T, _: usize) -> &mut T {
        of
    }

    fn curves(mut of: impl FnMut(usize) -> Curve) -> Curve {
        of(0)
    }

    fn curve(of: &Curve, _: usize) -> &Curve {
        of
    }

    fn interpolate(self, curve: &Curve) -> f64 {
        curve.at(self)
    }

    fn map(self, f: impl Fn(f64) -> f64) -> f64 {
        f(self)
    }

    fn gt(self, other: impl Operand<f64>) -> bool {
        self > other.broadcast(self)
    }

    fn ge(self, other: impl Operand<f64>) -> bool {
        self >= other.broadcast(self)
    }

    fn bits_eq(self, other: f64) -> bool {
        self.to_bits() == other.to_bits()
    }

    fn abs(self) -> f64 {
        self.abs()
    }

    fn sqrt(self) -> f64 {
        self.sqrt()
    }

    #[inline(never)]
    fn vectorize<T>(self, part: impl FnOnce() -> T) -> T {
        part()
    }

    fn exp_array<const COUNT: usize>(x: [f64; COUNT]) -> [f64; COUNT] {
        elementary::exp_array(x)
    }

    fn ln_array<const COUNT: usize>(x: [f64; COUNT]) -> [f64; COUNT] {
        elementary::ln_array(x)
    }

    fn max(self, other: impl Operand<f64>) -> f64 {
        larger(self, other.broadcast(self))
    }

    fn min(self, other: impl Operand<f64>) -> f64 {
        smaller(self, other.broadcast(self))
    }

    fn clamp(self, low: impl Operand<f64>, high: impl Operand<f64>) -> f64 {
        clamp(self, low.broadcast(self), high.broadcast(self))
    }

    fn exp(self) -> f64 {
        elementary::exp(self)
    }

    fn ln(self) -> f64 {
        elementary::ln(self)
    }

    fn tanh(self) -> f64 {
        elementary::tanh(self)
    }

    fn asin(self) -> f64 {
        circular::asin(self)
    }
}
