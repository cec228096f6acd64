//! Piecewise linear curve through points, held at its ends.

use super::real::Real;
use std::sync::Arc;

/// A curve y(x) through points with strictly rising x; between them linear, outside them held.
/// Copies share their points: the cars of a study have most curves in common, and side by side they find them in the processor's caches once.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The points, each with the piece that begins there; the last piece is flat and has no end.
    pieces: Arc<[Piece]>,
    /// For equal cells of x: the piece in which the cell begins, so that a look-up needs no search.
    cell: Arc<[u16]>,
    cells_per_x: f64,
    first: (f64, f64),
    last: (f64, f64),
}

/// A point and the straight piece from it to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    x: f64,
    y: f64,
    slope: f64,
    /// Where the next piece begins.
    end: f64,
}

/// Cells of the look-up table, a power of two.
const CELLS: usize = 128;
/// Adding this rounds to a whole number, which is then in the lowest bits: 1.5 2^52.
const ROUND: f64 = 6_755_399_441_055_744.0;

impl Curve {
    /// A curve through `points` (x, y).
    ///
    /// # Errors
    /// A sentence, if there is no point or x does not rise strictly or a number is not finite.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, String> {
        if points.is_empty() {
            return Err("a curve needs at least one point".into());
        }
        if points.iter().any(|p| !p.0.is_finite() || !p.1.is_finite()) {
            return Err("a curve takes finite numbers only".into());
        }
        if points.windows(2).any(|p| p[0].0 >= p[1].0) {
            return Err("the first column must rise strictly from row to row".into());
        }
        if points.len() > usize::from(u16::MAX) {
            return Err("a curve takes at most 65 535 points".into());
        }
        Ok(Curve::build(points))
    }

    fn build(points: &[(f64, f64)]) -> Self {
        let (first, last) = (points[0], points[points.len() - 1]);
        let width = last.0 - first.0;
        let cells_per_x = if width > 0.0 {
            CELLS as f64 / width
        } else {
            0.0
        };
        let between = points.windows(2).map(|p| Piece {
            x: p[0].0,
            y: p[0].1,
            slope: (p[1].1 - p[0].1) / (p[1].0 - p[0].0),
            end: p[1].0,
        });
        let piece = |x: f64| {
            points
                .partition_point(|p| p.0 <= x)
                .clamp(1, points.len().max(2) - 1)
                - 1
        };
        Curve {
            pieces: between
                .chain([Piece {
                    x: last.0,
                    y: last.1,
                    slope: 0.0,
                    end: f64::INFINITY,
                }])
                .collect(),
            cell: (0..CELLS)
                .map(|i| piece(first.0 + i as f64 * width / CELLS as f64) as u16)
                .collect(),
            cells_per_x,
            first,
            last,
        }
    }

    /// A curve with the same value everywhere.
    pub fn constant(y: f64) -> Self {
        Curve::build(&[(0.0, y)])
    }

    /// Value at `x`; beyond the ends the end's value; NaN for NaN.
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        if x >= self.last.0 {
            return self.last.1;
        }
        if x > self.first.0 {
            let piece = &self.pieces[self.number(x)];
            return piece.y + piece.slope * (x - piece.x);
        }
        if x.is_nan() { f64::NAN } else { self.first.1 }
    }

    /// The piece that `x`, between the ends, is on.
    #[inline(always)]
    fn number(&self, x: f64) -> usize {
        // The whole number at or below, or one less at an edge: a cast would ask for every number that cannot be here.
        let cells = (x - self.first.0) * self.cells_per_x;
        let cell = (cells - 0.5 + ROUND).to_bits() as usize % CELLS;
        let mut number = usize::from(self.cell[cell]);
        while x >= self.pieces[number].end {
            number += 1;
        }
        number
    }

    /// The values at the lanes of `x`, with the bits of [`Curve::at`]: pieces from the one of the `least` lane on up to that of the `most`; no lane is NaN.
    #[inline(always)]
    pub(super) fn across<R: Real>(&self, x: R, (least, most): (f64, f64)) -> R {
        let (first, last) = (self.first, self.last);
        let mut number = match least > first.0 && least < last.0 {
            true => self.number(least),
            false => 0,
        };
        let piece = &self.pieces[number];
        let (mut from, mut y) = (x.filled(piece.x), x.filled(piece.y));
        let mut slope = x.filled(piece.slope);
        while most >= self.pieces[number].end {
            number += 1;
            let piece = &self.pieces[number];
            let beyond = x.reaches(x.filled(piece.x));
            from = R::pick(beyond, x.filled(piece.x), from);
            y = R::pick(beyond, x.filled(piece.y), y);
            slope = R::pick(beyond, x.filled(piece.slope), slope);
        }
        let within = y + slope * (x - from);
        let held = R::pick(x.above(x.filled(first.0)), within, x.filled(first.1));
        R::pick(x.reaches(x.filled(last.0)), x.filled(last.1), held)
    }

    /// Whether two curves have the same points, most often since they share them.
    fn is_same(&self, other: &Curve) -> bool {
        Arc::ptr_eq(&self.pieces, &other.pieces) || self == other
    }

    /// The points (x, y).
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.pieces.iter().map(|p| (p.x, p.y))
    }
}

/// The curves of runs side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves<const LANES: usize> {
    of_lane: [Curve; LANES],
    /// True where all are one: the cars of a study that does not change it.
    common: bool,
}

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
    #[inline(always)]
    pub(super) fn common(&self) -> Option<&Curve> {
        self.common.then_some(&self.of_lane[0])
    }

    /// The values of each lane's own curve at its number.
    #[inline(never)]
    pub(super) fn at(&self, x: [f64; LANES]) -> [f64; LANES] {
        std::array::from_fn(|lane| self.of_lane[lane].at(x[lane]))
    }

    /// The curve of a lane.
    #[inline(always)]
    pub(super) fn one(&self, lane: usize) -> &Curve {
        &self.of_lane[lane]
    }
}
