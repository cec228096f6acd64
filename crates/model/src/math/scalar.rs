//! One run: f64 as a number of the physics.

use super::real::{Operand, Own, Real};
use super::{Curve, circular, clamp, elementary, larger, smaller};

impl Real for f64 {
    type Mask = bool;
    type Each<T: Own> = T;
    type Curve = Curve;
    const LANES: usize = 1;

    #[inline(always)]
    fn filled(self, number: f64) -> f64 {
        number
    }

    #[inline(always)]
    fn by_lane(self, f: impl Fn(usize) -> f64) -> f64 {
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
    fn answer(self, yes: bool) -> bool {
        yes
    }

    #[inline(always)]
    fn ask(self, f: impl Fn(usize) -> bool) -> bool {
        f(0)
    }

    #[inline(always)]
    fn every<T: Own>(mut f: impl FnMut(usize) -> T) -> T {
        f(0)
    }

    #[inline(always)]
    fn one<T: Own>(of: &T, _: usize) -> &T {
        of
    }

    #[inline(always)]
    fn one_mut<T: Own>(of: &mut T, _: usize) -> &mut T {
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
    fn along(self, curve: &Curve) -> f64 {
        curve.at(self)
    }

    #[inline(always)]
    fn each(self, f: impl Fn(f64) -> f64) -> f64 {
        f(self)
    }

    #[inline(always)]
    fn above(self, other: impl Operand<f64>) -> bool {
        self > other.lifted(self)
    }

    #[inline(always)]
    fn reaches(self, other: impl Operand<f64>) -> bool {
        self >= other.lifted(self)
    }

    #[inline(always)]
    fn is_same(self, other: f64) -> bool {
        self.to_bits() == other.to_bits()
    }

    #[inline(always)]
    fn pick(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
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
    fn within<T>(self, part: impl FnOnce() -> T) -> T {
        part()
    }

    #[inline(always)]
    fn exp_each<const COUNT: usize>(x: [f64; COUNT]) -> [f64; COUNT] {
        elementary::exp_each(x)
    }

    #[inline(always)]
    fn ln_each<const COUNT: usize>(x: [f64; COUNT]) -> [f64; COUNT] {
        elementary::ln_each(x)
    }

    #[inline(always)]
    fn most(self, other: impl Operand<f64>) -> f64 {
        larger(self, other.lifted(self))
    }

    #[inline(always)]
    fn least(self, other: impl Operand<f64>) -> f64 {
        smaller(self, other.lifted(self))
    }

    #[inline(always)]
    fn held(self, low: impl Operand<f64>, high: impl Operand<f64>) -> f64 {
        clamp(self, low.lifted(self), high.lifted(self))
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
