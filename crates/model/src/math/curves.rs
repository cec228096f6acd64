//! Curves of several runs side by side.

use super::curve::Curve;
use super::physics;
use super::real::{Mask, Real};

/// The values at the lanes of `x`, with the bits of [`Curve::at`]: pieces from the one of the `least` lane on up to that of the `most`; no lane is NaN.
#[physics]
pub(super) fn across<R: Real>(curve: &Curve, x: R, (least, most): (f64, f64)) -> R {
    let (first, last) = (curve.first, curve.last);
    let flat = curve.pieces.len() - 1; // the last piece
    let mut number = if least >= last.0 {
        flat
    } else if least > first.0 {
        curve.number(least)
    } else {
        0
    };
    let piece = &curve.pieces[number];
    let (mut from, mut y) = (x.splat(piece.x), x.splat(piece.y));
    let mut slope = x.splat(piece.slope);
    while number < flat && most >= curve.pieces[number].end {
        number += 1;
        let piece = &curve.pieces[number];
        let beyond = x.ge(x.splat(piece.x));
        from = beyond.select(x.splat(piece.x), from);
        y = beyond.select(x.splat(piece.y), y);
        slope = beyond.select(x.splat(piece.slope), slope);
    }
    let within = y + slope * (x - from);
    let held = x.gt(x.splat(first.0)).select(within, x.splat(first.1));
    x.ge(x.splat(last.0)).select(x.splat(last.1), held)
}

/// The curves of runs side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves<const LANES: usize> {
    of_lane: [Curve; LANES],
    /// True where all are one: the cars of a study that does not change it.
    common: bool,
}

#[physics]
impl<const LANES: usize> Curves<LANES> {
    /// A curve for each lane, from the lane's place.
    pub(super) fn new(of: impl FnMut(usize) -> Curve) -> Self {
        let of_lane: [Curve; LANES] = std::array::from_fn(of);
        Curves {
            common: of_lane.iter().all(|curve| curve.is_same(&of_lane[0])),
            of_lane,
        }
    }

    /// The curve of all lanes, if they have one.
    pub(super) fn common(&self) -> Option<&Curve> {
        self.common.then_some(&self.of_lane[0])
    }

    /// The values of each lane's own curve at its number.
    #[inline(never)]
    pub(super) fn at(&self, x: [f64; LANES]) -> [f64; LANES] {
        std::array::from_fn(|lane| self.of_lane[lane].at(x[lane]))
    }

    /// The curve of a lane.
    pub(super) fn one(&self, lane: usize) -> &Curve {
        &self.of_lane[lane]
    }
}
