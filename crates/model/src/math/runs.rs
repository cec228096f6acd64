//! What several runs in lockstep have each of its own and is no number: gears, flags, curves.
//!
//! [`Runs`] adds it to [`Real`]: the number is that of one run (f64) or of several, one a lane. What all runs of a group share (time, road speed,
//! a switch) stays what it is. A function that has f64 alone is asked run by run: `x.numbers(|run| ..)`.

use super::{Curve, Mask, Operand, Real};
use std::fmt::Debug;

/// A number of one run or of several, with what each run has besides numbers.
pub trait Runs: Real {
    /// How many runs there are.
    const COUNT: usize;

    /// A `T` of each run.
    type Of<T: Copy + Debug>: Copy + Debug;

    /// A curve of each run.
    type Curves: Clone + Debug + PartialEq;

    /// The number of one run.
    fn lane(self, run: usize) -> f64;

    /// A number of each run, with the lanes that `self` has.
    fn numbers(self, f: impl FnMut(usize) -> f64) -> Self;

    /// A `T` of each run.
    fn of<T: Copy + Debug>(f: impl FnMut(usize) -> T) -> Self::Of<T>;

    /// The one of a run.
    fn own<T: Copy + Debug>(of: &Self::Of<T>, run: usize) -> &T;

    /// The one of a run, to be changed.
    fn own_mut<T: Copy + Debug>(of: &mut Self::Of<T>, run: usize) -> &mut T;

    /// Each run's curve at its number.
    fn on(self, curves: &Self::Curves) -> Self;

    /// The answer of one run.
    #[inline(always)]
    fn answer(self, mask: Self::Mask, run: usize) -> bool {
        Self::pick(mask, self.filled(1.0), self.filled(0.0)).lane(run) > 0.5
    }

    /// An answer of each run.
    #[inline(always)]
    fn answers(self, mut f: impl FnMut(usize) -> bool) -> Self::Mask {
        self.numbers(
            #[inline(always)]
            |run| if f(run) { 1.0 } else { 0.0 },
        )
        .above(self.filled(0.5))
    }

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

/// Whether it is yes in every run.
#[inline(always)]
pub fn all(mask: impl Mask) -> bool {
    !(!mask).any()
}

impl Runs for f64 {
    const COUNT: usize = 1;

    type Of<T: Copy + Debug> = T;

    type Curves = Curve;

    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn numbers(self, mut f: impl FnMut(usize) -> f64) -> f64 {
        f(0)
    }

    #[inline(always)]
    fn of<T: Copy + Debug>(mut f: impl FnMut(usize) -> T) -> T {
        f(0)
    }

    #[inline(always)]
    fn own<T: Copy + Debug>(of: &T, _: usize) -> &T {
        of
    }

    #[inline(always)]
    fn own_mut<T: Copy + Debug>(of: &mut T, _: usize) -> &mut T {
        of
    }

    #[inline(always)]
    fn on(self, curve: &Curve) -> f64 {
        curve.at(self)
    }

    #[inline(always)]
    fn answer(self, mask: bool, _: usize) -> bool {
        mask
    }

    #[inline(always)]
    fn answers(self, mut f: impl FnMut(usize) -> bool) -> bool {
        f(0)
    }
}
