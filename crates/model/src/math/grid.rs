//! Multilinear interpolation on a full rectangular grid with up to five axes.

use std::sync::Arc;

/// Largest number of axes of a [`Grid`].
pub const GRID_AXES: usize = 5;

/// Values on a rectangular grid; multilinear inside, held outside.
///
/// Multilinear, because a product of monotone cubics is no longer monotone in two dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: [Vec<f64>; GRID_AXES],
    /// Shared between copies: measured maps are long.
    values: Arc<[f64]>,
    /// False at the values that are beyond what was measured; none where all were.
    known: Option<Arc<[bool]>>,
}

impl Grid {
    /// A grid from scattered rows `(coordinates, value)` that fill every combination of the coordinates' values exactly once.
    ///
    /// An axis with one value does not matter for the result.
    ///
    /// # Errors
    /// A sentence that says which combination is missing or doubled.
    pub fn from_rows(rows: &[([f64; GRID_AXES], f64)]) -> Result<Self, String> {
        let mut axes: [Vec<f64>; GRID_AXES] = Default::default();
        for (k, axis) in axes.iter_mut().enumerate() {
            axis.extend(rows.iter().map(|r| r.0[k]));
            axis.sort_by(f64::total_cmp);
            axis.dedup();
        }
        let size: usize = axes.iter().map(Vec::len).product();
        if size != rows.len() || size == 0 {
            return Err(format!(
                "the {} rows do not fill the grid of {} combinations exactly once",
                rows.len(),
                size
            ));
        }
        let mut values = vec![f64::NAN; size];
        for (x, value) in rows {
            let index = index_of(&axes, x);
            if values[index].is_nan() {
                values[index] = *value;
            } else {
                return Err(format!(
                    "the combination {x:?} is there twice, another is missing"
                ));
            }
        }
        Ok(Grid {
            axes,
            values: values.into(),
            known: None,
        })
    }

    /// The grid with some of its points beyond what was measured: what is read between them lies outside.
    #[must_use]
    pub fn with_unknown<'x>(self, unknown: impl Iterator<Item = &'x [f64; GRID_AXES]>) -> Self {
        let mut known = vec![true; self.values.len()];
        for x in unknown {
            known[index_of(&self.axes, x)] = false;
        }
        Grid {
            known: Some(known.into()),
            ..self
        }
    }

    /// Share of the grid's points that were measured or lie between measured ones.
    pub fn known_share(&self) -> f64 {
        let share = |known: &Arc<[bool]>| {
            known.iter().filter(|known| **known).count() as f64 / known.len() as f64
        };
        self.known.as_ref().map_or(1.0, share)
    }

    /// Coordinates along each axis, rising.
    pub fn axes(&self) -> &[Vec<f64>; GRID_AXES] {
        &self.axes
    }

    /// Values, with the last axis running fastest.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Value at `x` and whether `x` lies within the grid on every axis that has more than one value.
    pub fn at(&self, x: [f64; GRID_AXES]) -> (f64, bool) {
        let mut low = [0usize; GRID_AXES];
        let mut part = [0.0f64; GRID_AXES];
        let mut inside = true;
        let (mut active, mut count) = ([0usize; GRID_AXES], 0);
        for k in 0..GRID_AXES {
            let axis = &self.axes[k];
            let last = axis.len() - 1;
            if last == 0 {
                continue;
            }
            active[count] = k;
            count += 1;
            inside &= axis[0] <= x[k] && x[k] <= axis[last];
            low[k] = axis.partition_point(|&a| a <= x[k]).clamp(1, last) - 1;
            part[k] = ((x[k] - axis[low[k]]) / (axis[low[k] + 1] - axis[low[k]])).clamp(0.0, 1.0);
        }
        let mut sum = 0.0;
        for corner in 0..1usize << count {
            let mut weight = 1.0;
            let mut place = low;
            for (bit, &k) in active[..count].iter().enumerate() {
                let upper = corner >> bit & 1;
                weight *= if upper == 1 { part[k] } else { 1.0 - part[k] };
                place[k] += upper;
            }
            let index = (self.axes.iter().zip(place))
                .fold(0, |index, (axis, place)| index * axis.len() + place);
            if weight > 0.0 {
                sum += weight * self.values[index];
                inside &= self.known.as_ref().is_none_or(|known| known[index]);
            }
        }
        (sum, inside)
    }
}

/// Index of the value at given coordinates of the axes.
fn index_of(axes: &[Vec<f64>; GRID_AXES], x: &[f64; GRID_AXES]) -> usize {
    axes.iter().zip(x).fold(0, |index, (axis, &v)| {
        index * axis.len() + axis.partition_point(|&a| a < v).min(axis.len() - 1)
    })
}
