//! Piecewise linear curve through points, held at its ends.

use super::physics;
use std::sync::Arc;

/// A curve y(x) through points with strictly rising x; between them linear, outside them held.
/// Copies share their points: the cars of a study have most curves in common, and side by side they find them in the processor's caches once.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The points, each with the piece that begins there; the last piece is flat and has no end.
    pub(super) pieces: Arc<[Piece]>,
    /// For equal cells of x: the piece in which the cell begins, so that a look-up needs no search.
    cell: Arc<[u16]>,
    cells_per_x: f64,
    pub(super) first: (f64, f64),
    pub(super) last: (f64, f64),
}

/// A point and the straight piece from it to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    pub x: f64,
    pub y: f64,
    pub slope: f64,
    /// Where the next piece begins.
    pub end: f64,
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
    #[physics]
    pub(super) fn number(&self, x: f64) -> usize {
        // The whole number at or below, or one less at an edge: a cast would ask for every number that cannot be here.
        let cells = (x - self.first.0) * self.cells_per_x;
        let cell = (cells - 0.5 + ROUND).to_bits() as usize % CELLS;
        let mut number = usize::from(self.cell[cell]);
        while x >= self.pieces[number].end {
            number += 1;
        }
        number
    }

    /// True if two curves have the same points, most often since they share them.
    pub(super) fn is_same(&self, other: &Curve) -> bool {
        Arc::ptr_eq(&self.pieces, &other.pieces) || self == other
    }

    /// The points (x, y).
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.pieces.iter().map(|p| (p.x, p.y))
    }
}
