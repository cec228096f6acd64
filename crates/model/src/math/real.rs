//! The number that an equation is written for: an f64, or several side by side, one for each of several runs in lockstep.
//!
//! An equation over [`Real`] is one text for both. Each lane has the bits that f64 alone would have: only +, -, x, / and the square root, which are
//! exact to rounding everywhere, choices by [`Real::pick`], and functions of f64 lane by lane ([`Real::each`]). Where runs may differ there is no `if`:
//! both sides are worked out, and `pick` takes one. An `if` on what the runs of a group share, such as a formulation, stays an `if`.
//!
//! `where f64: Left<R>` lets constants be to the left of an operator: `2.0 * x`. A constant as the other side of a comparison or as a bound is given as it
//! is: `x.most(0.0)`. One that has to be an `R` by itself takes its lanes from any number at hand: `x.filled(1.0)`.

use super::{circular, clamp, elementary, larger, smaller};
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Yes or no, for each lane.
pub trait Mask:
    Copy + Debug + PartialEq + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Whether it is yes in any lane.
    fn any(self) -> bool;
}

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
}

/// What can be the other side of an operation on an `R`: an `R`, or an f64 for all lanes.
pub trait Operand<R>: Copy {
    /// As an `R`, with the lanes of `like`.
    fn lifted(self, like: R) -> R;
}

impl<R: Real> Operand<R> for R {
    #[inline(always)]
    fn lifted(self, _: R) -> R {
        self
    }
}

/// What can be to the left of an operator before an `R`: `where f64: Left<R>` lets constants be there.
pub trait Left<R>:
    Operand<R> + Add<R, Output = R> + Sub<R, Output = R> + Mul<R, Output = R> + Div<R, Output = R>
{
}

impl<R, C> Left<R> for C where
    C: Operand<R>
        + Add<R, Output = R>
        + Sub<R, Output = R>
        + Mul<R, Output = R>
        + Div<R, Output = R>
{
}

/// A number of the physics.
pub trait Real:
    Copy
    + Debug
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// Answer of a comparison.
    type Mask: Mask;

    /// A number in every lane that `self` has.
    fn filled(self, number: f64) -> Self;

    /// Lane by lane what a function of f64 gives.
    fn each(self, f: impl Fn(f64) -> f64) -> Self;

    /// Where `self` is above the other; no where one is no number.
    fn above(self, other: impl Operand<Self>) -> Self::Mask;

    /// Where `self` is at or above the other; no where one is no number.
    fn reaches(self, other: impl Operand<Self>) -> Self::Mask;

    /// `yes` where the mask says so, else `no`.
    fn pick(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Magnitude.
    fn abs(self) -> Self;

    /// Square root, exact to rounding.
    fn sqrt(self) -> Self;

    /// A part that is large enough to be a function of its own, with the processor's features of its caller.
    fn within<T>(self, part: impl FnOnce() -> T) -> T;

    /// The larger of two numbers; the other one where one is no number.
    #[inline(always)]
    fn most(self, other: impl Operand<Self>) -> Self {
        let other = other.lifted(self);
        Self::pick(self.above(other), self, other)
    }

    /// The smaller of two numbers; the other one where one is no number.
    #[inline(always)]
    fn least(self, other: impl Operand<Self>) -> Self {
        let other = other.lifted(self);
        Self::pick(other.above(self), self, other)
    }

    /// Held between `low` and `high`; what is no number stays so.
    #[inline(always)]
    fn held(self, low: impl Operand<Self>, high: impl Operand<Self>) -> Self {
        let (low, high) = (low.lifted(self), high.lifted(self));
        let x = Self::pick(low.above(self), low, self);
        Self::pick(x.above(high), high, x)
    }

    /// e to the power of it.
    #[inline(always)]
    fn exp(self) -> Self {
        self.each(elementary::exp)
    }

    /// Natural logarithm.
    #[inline(always)]
    fn ln(self) -> Self {
        self.each(elementary::ln)
    }

    /// Hyperbolic tangent.
    #[inline(always)]
    fn tanh(self) -> Self {
        self.each(elementary::tanh)
    }

    /// Angle whose sine it is, rad.
    #[inline(always)]
    fn asin(self) -> Self {
        self.each(circular::asin)
    }
}

impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn filled(self, number: f64) -> f64 {
        number
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
}
