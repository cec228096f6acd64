//! Number type of the equations: an f64, or several f64 side by side, one for each of several runs in lockstep.
//!
//! An equation over [`Real`] is one text for both, and each lane has the bits that f64 alone would have: only +, -, x, / and the square root, which
//! are exact to rounding everywhere, choices by [`Mask::select`], and functions of f64 lane by lane ([`Real::map`]). Runs may differ in what a mask
//! holds, so it takes no `if`: both sides are computed, and `select` takes one. An `if` on something that the runs of a group share, such as a
//! formulation, stays an `if`.
//!
//! Constants are written as they are: `2.0 * x`, `x.max(0.0)`. A constant that has to be an `R` by itself takes its lanes from any number at hand:
//! `x.splat(1.0)`. The methods with names of f64 differ from those in one point: `max` and `min` return the argument where one of the two is NaN.

use super::curve::Curve;
use super::physics;
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// A bool for each lane.
#[physics]
pub trait Mask:
    Copy
    + Debug
    + PartialEq
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + Not<Output = Self>
    + Selectable<Self>
{
    /// True if any lane is true.
    fn any(self) -> bool;

    /// True if every lane is true.
    fn all(self) -> bool;

    /// The bool of one lane.
    fn lane(self, lane: usize) -> bool;

    /// `if_true` in the lanes that are true, else `if_false`. Both are computed, so neither may panic.
    fn select<T: Selectable<Self>>(self, if_true: T, if_false: T) -> T {
        T::select(self, if_true, if_false)
    }
}

/// A value that [`Mask::select`] chooses lane by lane: a number or a mask.
pub trait Selectable<M> {
    /// `if_true` in the lanes where `mask` is true, else `if_false`.
    fn select(mask: M, if_true: Self, if_false: Self) -> Self;
}

#[physics]
impl Selectable<bool> for bool {
    fn select(mask: bool, if_true: bool, if_false: bool) -> bool {
        if mask { if_true } else { if_false }
    }
}

#[physics]
impl Mask for bool {
    fn any(self) -> bool {
        self
    }

    fn all(self) -> bool {
        self
    }

    fn lane(self, _: usize) -> bool {
        self
    }
}

/// Right side of an operation on an `R`: an `R`, or an f64 for all lanes.
pub trait Operand<R>: Copy {
    /// Converts to an `R` with the lanes of `like`.
    fn broadcast(self, like: R) -> R;
}

#[physics]
impl<R: Real> Operand<R> for R {
    fn broadcast(self, _: R) -> R {
        self
    }
}

/// Left side of an operator before an `R`.
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

/// Names a type `T` in a bound of another: as `Implied<f64, Is: Left<Self>>` it lets [`Real`] imply `f64: Left<R>`, which a plain `where` on the trait
/// would ask of every function again.
pub trait Implied<T>: Named<T, Is = T> {}

impl<S, T> Implied<T> for S {}

/// The type that [`Implied`] names.
pub trait Named<T> {
    /// `T` itself.
    type Is;
}

impl<S, T> Named<T> for S {
    type Is = T;
}

/// Value that each lane has its own of, without arithmetic.
pub trait LaneValue: Clone + Debug + PartialEq + Send + Sync {}

impl<T: Clone + Debug + PartialEq + Send + Sync> LaneValue for T {}

/// Number type of the equations.
#[physics]
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
    + Implied<f64, Is: Left<Self>>
    + Selectable<<Self as Real>::Mask>
{
    /// Result of a comparison.
    type Mask: Mask;

    /// A value for each lane without arithmetic, such as a gear.
    type PerLane<T: LaneValue>: LaneValue;

    /// A curve for each lane.
    type Curve: LaneValue;

    /// Number of lanes.
    const LANES: usize;

    /// `number` in every lane that `self` has.
    fn splat(self, number: f64) -> Self;

    /// A number for each lane that `self` has, computed from the lane's index.
    fn map_lanes(self, f: impl Fn(usize) -> f64) -> Self;

    /// The number of one lane.
    fn lane(self, lane: usize) -> f64;

    /// `self` with another number in one lane.
    fn with_lane(self, lane: usize, number: f64) -> Self;

    /// The same bool in every lane that `self` has.
    fn splat_mask(self, yes: bool) -> Self::Mask;

    /// A bool for each lane that `self` has, computed from the lane's index.
    fn mask_lanes(self, f: impl Fn(usize) -> bool) -> Self::Mask;

    /// A value for each lane, computed from the lane's index.
    fn per_lane<T: LaneValue>(f: impl FnMut(usize) -> T) -> Self::PerLane<T>;

    /// The value of one lane.
    fn get<T: LaneValue>(values: &Self::PerLane<T>, lane: usize) -> &T;

    /// The value of one lane, to be changed.
    fn get_mut<T: LaneValue>(values: &mut Self::PerLane<T>, lane: usize) -> &mut T;

    /// A curve for each lane, from the lane's index.
    fn curves(f: impl FnMut(usize) -> Curve) -> Self::Curve;

    /// The curve of one lane.
    fn curve(curves: &Self::Curve, lane: usize) -> &Curve;

    /// Evaluates each lane's curve at its number.
    fn interpolate(self, curve: &Self::Curve) -> Self;

    /// Applies a function of f64 lane by lane.
    fn map(self, f: impl Fn(f64) -> f64) -> Self;

    /// `self > other`; false where one is NaN.
    fn gt(self, other: impl Operand<Self>) -> Self::Mask;

    /// `self >= other`; false where one is NaN.
    fn ge(self, other: impl Operand<Self>) -> Self::Mask;

    /// `self < other`; false where one is NaN.
    fn lt(self, other: impl Operand<Self>) -> Self::Mask {
        other.broadcast(self).gt(self)
    }

    /// `self <= other`; false where one is NaN.
    fn le(self, other: impl Operand<Self>) -> Self::Mask {
        other.broadcast(self).ge(self)
    }

    /// Compares the bits.
    fn bits_eq(self, other: Self) -> Self::Mask;

    /// Magnitude.
    fn abs(self) -> Self;

    /// Square root, exact to rounding.
    fn sqrt(self) -> Self;

    /// Calls a part that is large enough to be a function of its own, compiled for the processor's features of its caller.
    fn vectorize<T>(self, part: impl FnOnce() -> T) -> T;

    /// The larger of two numbers; `other` where one is NaN.
    fn max(self, other: impl Operand<Self>) -> Self {
        let other = other.broadcast(self);
        self.gt(other).select(self, other)
    }

    /// The smaller of two numbers; `other` where one is NaN.
    fn min(self, other: impl Operand<Self>) -> Self {
        let other = other.broadcast(self);
        other.gt(self).select(self, other)
    }

    /// Limits to `low` and `high`; NaN stays NaN, and the bounds are not checked.
    fn clamp(self, low: impl Operand<Self>, high: impl Operand<Self>) -> Self {
        let (low, high) = (low.broadcast(self), high.broadcast(self));
        let x = low.gt(self).select(low, self);
        x.gt(high).select(high, x)
    }

    /// e to the power of `self`.
    fn exp(self) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self;

    /// e to the power of several numbers: the bits of one by one at less cost.
    fn exp_array<const COUNT: usize>(x: [Self; COUNT]) -> [Self; COUNT];

    /// Natural logarithm of several numbers: the bits of one by one at less cost.
    fn ln_array<const COUNT: usize>(x: [Self; COUNT]) -> [Self; COUNT];

    /// Hyperbolic tangent.
    fn tanh(self) -> Self;

    /// Inverse sine, rad.
    fn asin(self) -> Self;

    /// Sum of numbers in their order, as `Iterator::sum` makes it.
    fn sum(self, numbers: &[Self]) -> Self {
        let mut sum = self.splat(-0.0);
        for number in numbers {
            sum = sum + *number;
        }
        sum
    }
}
