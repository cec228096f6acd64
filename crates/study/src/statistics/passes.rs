//! Columns that are gone through again and again in place of being held, and what one round over them adds up.

use std::convert::Infallible;

use super::spread::Spread;

/// Numbers in one order, in pieces. A description of them takes several passes, so that it needs no memory that grows with them.
pub trait Numbers {
    /// Error of reading the numbers.
    type Error;

    /// Hands on all numbers, in their order.
    ///
    /// # Errors
    /// Numbers that cannot be had.
    fn pass(&self, f: impl FnMut(&[f64])) -> Result<(), Self::Error>;
}

impl Numbers for [f64] {
    type Error = Infallible;

    fn pass(&self, mut f: impl FnMut(&[f64])) -> Result<(), Infallible> {
        f(self);
        Ok(())
    }
}

/// Hands on every number by itself.
pub(super) fn each<P: Numbers + ?Sized>(
    numbers: &P,
    mut f: impl FnMut(f64),
) -> Result<(), P::Error> {
    numbers.pass(|piece| piece.iter().for_each(|x| f(*x)))
}

/// Moments by DS-1, in three passes: number, sum and ends; what the rough mean leaves; deviations.
#[derive(Clone, Debug)]
pub(super) struct Moments {
    pass: usize,
    n: usize,
    missing: usize,
    min: f64,
    max: f64,
    mean: f64,
    sum: f64,
    squares: f64,
}

impl Default for Moments {
    fn default() -> Self {
        Moments {
            pass: 0,
            n: 0,
            missing: 0,
            min: f64::NAN,
            max: f64::NAN,
            mean: 0.0,
            sum: 0.0,
            squares: 0.0,
        }
    }
}

impl Moments {
    /// Passes that it takes.
    pub(super) const PASSES: usize = 3;

    /// Computes the spread of all finite numbers.
    pub(super) fn compute<P: Numbers + ?Sized>(numbers: &P) -> Result<Spread, P::Error> {
        let mut moments = Moments::default();
        for _ in 0..Self::PASSES {
            each(numbers, |x| moments.add(x))?;
            moments.turn();
        }
        Ok(moments.spread())
    }

    /// One number of a pass.
    pub(super) fn add(&mut self, x: f64) {
        if !x.is_finite() {
            self.missing += usize::from(self.pass == 0);
            return;
        }
        if self.pass == 0 {
            self.n += 1;
            self.min = x.min(self.min);
            self.max = x.max(self.max);
        }
        // Deviation from the mean so far, which is 0 in the first pass.
        let d = x - self.mean;
        self.sum += d;
        self.squares += d * d;
    }

    /// True in the first pass.
    pub(super) fn is_first(&self) -> bool {
        self.pass == 0
    }

    /// Ends a pass.
    pub(super) fn turn(&mut self) {
        self.pass += 1;
        if self.pass < Self::PASSES {
            self.mean += self.sum / self.n as f64; // DS-1
            (self.sum, self.squares) = (0.0, 0.0);
        }
    }

    /// Gives the spread after all passes.
    pub(super) fn spread(&self) -> Spread {
        let count = self.n as f64;
        let sd = match self.n {
            0 | 1 => f64::NAN,
            _ => ((self.squares - self.sum * self.sum / count).max(0.0) / (count - 1.0)).sqrt(), // DS-1
        };
        Spread {
            n: self.n,
            missing: self.missing,
            mean: self.mean,
            sd,
            min: self.min,
            max: self.max,
        }
    }
}
