//! A measured torque-loss map that replaces a component's model.
//!
//! Coordinates: ratio (belt ratio, or gear number of a manual box), input speed rad/s, torque Nm, secondary pressure Pa,
//! oil temperature K. Value: torque loss at the box's input shaft, Nm. Outside the map the edge's value holds and the row is flagged.

use crate::math::{Grid, larger};

/// Most passes for the torque of a point behind the map.
const MAX_PASSES: usize = 100;
/// They end where the loss moves less, Nm.
const STILL_NM: f64 = 1e-12;

/// A measured torque-loss map.
#[derive(Clone, Debug, PartialEq)]
pub struct LossMap {
    grid: Grid,
    scatter: Option<Scatter>,
}

/// How well scattered points are met by the plane through their neighbours (MP-5), each left out in turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Number of points.
    pub points: usize,
    /// Root of the mean square of the differences, Nm.
    pub rms_nm: f64,
    /// Largest difference, Nm.
    pub largest_nm: f64,
}

/// Where a map is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPoint {
    /// Belt ratio, or gear number.
    pub ratio: f64,
    /// Input shaft speed, rad/s.
    pub input_speed_rad_s: f64,
    /// Transmitted torque as the map's column says, Nm.
    pub torque_nm: f64,
    /// Secondary pressure, Pa.
    pub pressure_pa: f64,
    /// Oil temperature, K.
    pub oil_k: f64,
}

impl LossMap {
    /// A map from its grid.
    pub fn new(grid: Grid) -> Self {
        LossMap {
            grid,
            scatter: None,
        }
    }

    /// The map of a grid that was made from scattered points.
    #[must_use]
    pub fn of_scatter(self, scatter: Option<Scatter>) -> Self {
        LossMap { scatter, ..self }
    }

    /// The map with some of its points beyond what was measured.
    #[must_use]
    pub(crate) fn with_unknown(self, unknown: &[[f64; crate::math::GRID_AXES]]) -> Self {
        LossMap {
            grid: self.grid.with_unknown(unknown.iter()),
            ..self
        }
    }

    /// How well the scattered points are met that the grid was made from, if it was.
    pub fn scatter(&self) -> Option<Scatter> {
        self.scatter
    }

    /// The grid of the map.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// A factor times the loss, Nm, at the input torque T for which T less that loss is the point's torque, and whether that input torque lies within
    /// the map (MP-3, MP-4). By repetition: the loss changes by less than the torque does.
    pub fn loss_behind_nm(&self, behind: &MapPoint, factor: f64) -> (f64, bool) {
        let at = |loss_nm: f64| {
            let torque_nm = behind.torque_nm + loss_nm;
            let (loss_nm, inside) = self.loss_nm(&MapPoint {
                torque_nm,
                ..*behind
            });
            (factor * loss_nm, inside)
        };
        let mut answer = at(0.0);
        for _ in 0..MAX_PASSES {
            let before_nm = answer.0;
            answer = at(before_nm); // MP-3, MP-4
            if (answer.0 - before_nm).abs() <= STILL_NM {
                break;
            }
        }
        answer
    }

    /// Torque loss at the input shaft, Nm, never negative, and whether the point lies within the map.
    pub fn loss_nm(&self, p: &MapPoint) -> (f64, bool) {
        let (loss, inside) = self.grid.at([
            p.ratio,
            p.input_speed_rad_s,
            p.torque_nm,
            p.pressure_pa,
            p.oil_k,
        ]);
        (larger(loss, 0.0), inside)
    }
}
