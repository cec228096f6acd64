//! The number that an equation is written for: an f64, or several side by side, one for each of several runs in lockstep.
//!
//! An equation over [`Real`] is one text for both. Each lane has the bits that f64 alone would have: only +, -, x, / and the square root, which are
//! exact to rounding everywhere, choices by [`Real::pick`], and functions of f64 lane by lane ([`Real::each`]). Where runs may differ there is no `if`:
//! both sides are worked out, and `pick` takes one. An `if` on what the runs of a group share, such as a formulation, stays an `if`.
//!
//! `where f64: Left<R>` lets constants be to the left of an operator: `2.0 * x`. A constant as the other side of a comparison or as a bound is given as it
//! is: `x.most(0.0)`. One that has to be an `R` by itself takes its lanes from any number at hand: `x.filled(1.0)`.

use super::curve::Curve;
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Yes or no, for each lane.
pub trait Mask:
    Copy + Debug + PartialEq + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Whether it is yes in any lane.
    fn any(self) -> bool;

    /// Whether it is yes in every lane.
    fn all(self) -> bool;

    /// The answer of one lane.
    fn lane(self, lane: usize) -> bool;

    /// The answer of `yes` where it is yes, else that of `no`.
    #[inline(always)]
    fn then(self, yes: Self, no: Self) -> Self {
        (self & yes) | (!self & no)
    }
}

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }

    #[inline(always)]
    fn all(self) -> bool {
        self
    }

    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }

    #[inline(always)]
    fn then(self, yes: bool, no: bool) -> bool {
        if self { yes } else { no }
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

/// What a lane can have of its own.
pub trait Own: Clone + Debug + PartialEq + Send + Sync {}

impl<T: Clone + Debug + PartialEq + Send + Sync> Own for T {}

/// A number of the physics.
pub trait Real:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
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

    /// What each lane has of its own and no arithmetic works on, such as a curve.
    type Each<T: Own>: Own;

    /// A curve for each lane.
    type Curve: Own;

    /// How many runs are side by side.
    const LANES: usize;

    /// A number in every lane that `self` has.
    fn filled(self, number: f64) -> Self;

    /// A number for each lane that `self` has, from the lane's place.
    fn by_lane(self, f: impl Fn(usize) -> f64) -> Self;

    /// The number of one lane.
    fn lane(self, lane: usize) -> f64;

    /// The same with another number in one lane.
    fn with_lane(self, lane: usize, number: f64) -> Self;

    /// The same answer in every lane that `self` has.
    fn answer(self, yes: bool) -> Self::Mask;

    /// An answer for each lane that `self` has, from the lane's place.
    fn ask(self, f: impl Fn(usize) -> bool) -> Self::Mask;

    /// A value for each lane.
    fn every<T: Own>(f: impl FnMut(usize) -> T) -> Self::Each<T>;

    /// The value of one lane.
    fn one<T: Own>(of: &Self::Each<T>, lane: usize) -> &T;

    /// The same, to be changed.
    fn one_mut<T: Own>(of: &mut Self::Each<T>, lane: usize) -> &mut T;

    /// A curve for each lane, from the lane's place.
    fn curves(of: impl FnMut(usize) -> Curve) -> Self::Curve;

    /// The curve of one lane.
    fn curve(of: &Self::Curve, lane: usize) -> &Curve;

    /// Value of a curve at it.
    fn along(self, curve: &Self::Curve) -> Self;

    /// Lane by lane what a function of f64 gives.
    fn each(self, f: impl Fn(f64) -> f64) -> Self;

    /// Where `self` is above the other; no where one is no number.
    fn above(self, other: impl Operand<Self>) -> Self::Mask;

    /// Where `self` is at or above the other; no where one is no number.
    fn reaches(self, other: impl Operand<Self>) -> Self::Mask;

    /// Where both have the same bits.
    fn is_same(self, other: Self) -> Self::Mask;

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
    fn exp(self) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self;

    /// e to the power of several, the same bits as one by one: together they cost less.
    fn exp_each<const COUNT: usize>(x: [Self; COUNT]) -> [Self; COUNT];

    /// Natural logarithm of several, the same bits as one by one: together they cost less.
    fn ln_each<const COUNT: usize>(x: [Self; COUNT]) -> [Self; COUNT];

    /// Hyperbolic tangent.
    fn tanh(self) -> Self;

    /// Angle whose sine it is, rad.
    fn asin(self) -> Self;

    /// Where `self` is below the other; no where one is no number.
    #[inline(always)]
    fn below(self, other: impl Operand<Self>) -> Self::Mask {
        other.lifted(self).above(self)
    }

    /// Where `self` is at or below the other; no where one is no number.
    #[inline(always)]
    fn at_most(self, other: impl Operand<Self>) -> Self::Mask {
        other.lifted(self).reaches(self)
    }

    /// The sum of numbers in their order, as `Iterator::sum` has it.
    #[inline(always)]
    fn sum_of(self, numbers: &[Self]) -> Self {
        let mut sum = self.filled(-0.0);
        for number in numbers {
            sum = sum + *number;
        }
        sum
    }
}
