//! Fuel over speed and load from a measured map.
//!
//! | label | statement | status |
//! |---|---|---|
//! | BM-1 | fuel MEP = BSFC x BMEP x LHV, or fuel flow x LHV 4 pi/(V w), between the map's points, linear in speed and BMEP; LHV and V those of the engine that was measured | source: the user's map |
//! | BM-4 | points that fill no grid: linear in the triangles of a Delaunay triangulation over speed and load, each in shares of its range, at the pairs of the points' speeds and loads; beyond the points at a speed the specific consumption of the last load holds, below them the slope of the mean line through them | derived: BM-1 on triangles; beyond them ASSUMED, and the time there is counted |
//! | BM-2 | below the map's lowest BMEP (of those above the drag) a line to zero fuel at minus the hot friction l + l2 cm2, or at minus the drag of EN-7 where the engine has one of its own | derived; friction from keys l, l2 |

use std::f64::consts::PI;
use std::sync::Arc;

use super::NoMap;
use super::fuel_table::{Basis, FuelTable, Point};
use crate::math::Lattice;

/// Most pairs of speeds and loads: points that are not in lines have as many of each.
const MOST_PAIRS: usize = 250_000;
/// Values of an axis of points beyond that.
const LEVELS: u32 = 500;

/// A map of fuel mean effective pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct BsfcMap {
    /// Speeds, rad/s, rising.
    pub speed_rad_s: Vec<f64>,
    /// Brake mean effective pressures, Pa, rising, at least two.
    pub bmep_pa: Vec<f64>,
    /// Fuel MEP, Pa: `fuel_pa[i][k]` at `speed_rad_s[i]` and `bmep_pa[k]`.
    pub fuel_pa: Vec<Vec<f64>>,
    /// Hot friction l, l2 as in the Willans line, bar and bar s2/m2 (BM-2).
    pub friction: (f64, f64),
    /// True for pairs of speed and load within the points of the file, in the order of `fuel_pa`; `None` if all are.
    pub known: Option<Arc<Vec<Vec<bool>>>>,
    /// The points of the file; none of a map that is from none.
    pub origin: Option<Arc<Origin>>,
}

/// Where a map is from.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    /// Name of the file.
    pub file: String,
    /// How it was read, in words, where it is not written as the program's own are.
    pub read_as: Option<String>,
    /// Swept volume of the engine that was measured, m3.
    pub displacement_m3: f64,
    /// Points of the file, sorted by speed and load.
    pub points: Vec<Point>,
    /// Rows without meaning that were left out, and the first line of one.
    pub left_out: Option<(usize, usize)>,
}

impl BsfcMap {
    /// Fuel MEP at a speed and load, with the drag at which there is none, Pa, and whether the point lies within the map.
    pub(crate) fn at_speed(&self, speed_rad_s: f64, bmep_pa: f64, drag_pa: f64) -> (f64, bool) {
        let n = self.speed_rad_s.len();
        let hi = self
            .speed_rad_s
            .partition_point(|&s| s <= speed_rad_s)
            .clamp(1, n - 1);
        let (s0, s1) = (self.speed_rad_s[hi - 1], self.speed_rad_s[hi]);
        let u = ((speed_rad_s - s0) / (s1 - s0)).clamp(0.0, 1.0);
        let m = self.bmep_pa.len();
        let row = |j: usize| {
            self.fuel_pa[hi - 1][j] + u * (self.fuel_pa[hi][j] - self.fuel_pa[hi - 1][j])
        };
        let inside = s0 <= speed_rad_s && speed_rad_s <= s1 && bmep_pa <= self.bmep_pa[m - 1];
        let is_known = |k: usize| {
            let known = self.known.as_ref();
            known.is_none_or(|known| known[hi - 1][k] && known[hi][k])
        };
        // Loads at which the drag leaves no fuel have none, whatever the map says.
        let first = self.bmep_pa.partition_point(|&p| p <= -drag_pa).min(m - 1);
        let lowest = self.bmep_pa[first];
        if bmep_pa < lowest {
            let fuel_pa = row(first) * (bmep_pa + drag_pa) / (lowest + drag_pa); // BM-2
            return (fuel_pa.max(0.0), inside && is_known(first));
        }
        let k = self
            .bmep_pa
            .partition_point(|&p| p <= bmep_pa)
            .clamp(1, m - 1);
        let (p0, p1) = (self.bmep_pa[k - 1], self.bmep_pa[k]);
        if let Some(known) = self.known.as_deref() {
            let cell = [
                (self.fuel_pa[hi - 1][k - 1], known[hi - 1][k - 1]),
                (self.fuel_pa[hi - 1][k], known[hi - 1][k]),
                (self.fuel_pa[hi][k - 1], known[hi][k - 1]),
                (self.fuel_pa[hi][k], known[hi][k]),
            ];
            let (fuel_pa, is_within) = in_cell(cell, [u, (bmep_pa - p0) / (p1 - p0)]);
            return (fuel_pa, inside && is_within);
        }
        (
            row(k - 1) + (row(k) - row(k - 1)) * (bmep_pa - p0) / (p1 - p0),
            inside,
        ) // BM-1
    }

    /// True where a point lies within the map, or between its lowest load and the drag.
    #[must_use]
    pub fn contains(&self, speed_rad_s: f64, bmep_pa: f64) -> bool {
        self.at_speed(speed_rad_s, bmep_pa, f64::MAX).1
    }

    /// Share of the pairs of speeds and loads that lie within the points of the file.
    #[must_use]
    pub fn known_share(&self) -> f64 {
        let Some(known) = &self.known else {
            return 1.0;
        };
        let all = || known.iter().flatten();
        all().filter(|known| **known).count() as f64 / all().count() as f64
    }

    /// A map of the points of a table, of an engine with a swept volume and a fuel.
    ///
    /// # Errors
    /// Fewer than two speeds or loads, two rows of one point, points on one line, or a quantity that needs another one.
    pub fn from_table(
        table: &FuelTable,
        basis: &Basis,
        friction: (f64, f64),
    ) -> Result<Self, NoMap> {
        table.check_volume(basis)?;
        let (mut points, left_out) = table.points(basis)?;
        // Points that fill a grid but for the rounding of their numbers are one: triangles between a level and itself are none.
        let near = match is_grid(&points, ROUNDING) {
            true => ROUNDING,
            false => SAME,
        };
        let speeds = levels(points.iter().map(|point| point.speed_rad_s), near);
        let loads = levels(points.iter().map(|point| point.bmep_pa), near);
        let place = |of: &Point| {
            let speed = place(&speeds, of.speed_rad_s, near);
            [speed, place(&loads, of.bmep_pa, near)]
        };
        points.sort_by_key(&place);
        let mut twice = points
            .windows(2)
            .filter(|two| place(&two[0]) == place(&two[1]));
        if let Some([first, second]) = twice.next() {
            return Err(NoMap::new(
                "each speed and load once",
                format!(
                    "line {} has the speed and the load of line {}",
                    second.line, first.line
                ),
                "remove one of them",
            ));
        }
        let (n, m) = (speeds.len(), loads.len());
        let few = || {
            NoMap::new(
                "a map of fuel over speed and load",
                format!(
                    "{} rows do not fill a grid of {n} speeds and {m} loads",
                    points.len()
                ),
                "give at least two speeds and two loads",
            )
        };
        if n < 2 || m < 2 {
            return Err(few());
        }
        let origin = |points| {
            Some(Arc::new(Origin {
                file: table.file.clone(),
                read_as: table.read_as.clone(),
                displacement_m3: basis.displacement_m3,
                points,
                left_out,
            }))
        };
        if n * m == points.len() {
            let rows = points.chunks(m);
            let fuel = rows.map(|row| row.iter().map(|point| point.fuel_pa).collect());
            return Ok(BsfcMap {
                fuel_pa: fuel.collect(),
                speed_rad_s: speeds,
                bmep_pa: loads,
                friction,
                known: None,
                origin: origin(points),
            });
        }
        let (speed_rad_s, bmep_pa) = match n * m > MOST_PAIRS {
            true => (even(&speeds), even(&loads)),
            false => (speeds.clone(), loads.clone()),
        };
        let at = |point: &Point| {
            let [i, k] = place(point);
            ([speeds[i], loads[k]], point.fuel_pa)
        };
        let placed: Vec<([f64; 2], f64)> = points.iter().map(at).collect();
        let lattice = Lattice::new(&placed, [&speed_rad_s, &bmep_pa], |across, load_pa| {
            let ([low_pa, high_pa], [low, high]) = (across.ends, across.at_ends);
            if load_pa > high_pa && high_pa > 0.0 {
                return high * load_pa / high_pa; // BM-4
            }
            let slope = match high_pa > low_pa {
                true => (high - low) / (high_pa - low_pa),
                false => low / low_pa.abs().max(1.0),
            };
            (low + (load_pa - low_pa) * slope).max(0.0) // BM-4
        });
        let lattice = lattice.ok_or_else(few)?;
        Ok(BsfcMap {
            speed_rad_s,
            bmep_pa,
            fuel_pa: lattice.values,
            friction,
            known: Some(Arc::new(lattice.known)),
            origin: origin(points),
        })
    }

    /// Torque of a mean effective pressure of the engine that was measured, Nm; none of a map that is from no file.
    pub fn torque_nm(&self, bmep_pa: f64) -> Option<f64> {
        let origin = self.origin.as_ref()?;
        Some(bmep_pa * origin.displacement_m3 / (4.0 * PI))
    }
}

/// Values that differ by this share are one, ...
const SAME: f64 = 1e-9;
/// ... and by this one where they fill a grid: numbers of five figures, changed into another unit.
const ROUNDING: f64 = 1e-4;

/// True if the points are each pair of their levels once.
fn is_grid(points: &[Point], near: f64) -> bool {
    let speeds = levels(points.iter().map(|point| point.speed_rad_s), near);
    let loads = levels(points.iter().map(|point| point.bmep_pa), near);
    if speeds.len() * loads.len() != points.len() {
        return false;
    }
    let mut is_there = vec![false; points.len()];
    points.iter().all(|point| {
        let at = place(&speeds, point.speed_rad_s, near) * loads.len()
            + place(&loads, point.bmep_pa, near);
        !std::mem::replace(&mut is_there[at], true)
    })
}

/// Values, rising, each once: neighbours that differ by a share up to `near` are one.
fn levels(values: impl Iterator<Item = f64>, near: f64) -> Vec<f64> {
    let mut levels: Vec<f64> = values.collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|a, b| (*a - *b).abs() <= near * b.abs());
    levels
}

/// Place of a value among levels.
fn place(levels: &[f64], x: f64, near: f64) -> usize {
    let before = levels.partition_point(|&own| own < x - 10.0 * near * x.abs());
    before.min(levels.len() - 1)
}

/// Levels at equal distances between the ends.
fn even(levels: &[f64]) -> Vec<f64> {
    let ends = (levels.first(), levels.last());
    let (Some(low), Some(high)) = ends else {
        return Vec::new();
    };
    let at = |k: u32| match k {
        LEVELS => *high,
        k => low + (high - low) * f64::from(k) / f64::from(LEVELS),
    };
    (0..=LEVELS).map(at).collect()
}

/// The value in a cell at shares of its sides, and whether it lies within the corners that are known. Corners are at the shares (0, 0), (0, 1), (1, 0)
/// and (1, 1). Where one is not known the cell is two triangles, so that what is beyond the border does not change what is within.
fn in_cell(cell: [(f64, bool); 4], [u, v]: [f64; 2]) -> (f64, bool) {
    let [a, b, c, d] = cell.map(|(value, _)| value);
    let known = cell.map(|(_, known)| known);
    let from_a = a + u * (c - a) + v * (b - a);
    let from_d = d + (1.0 - u) * (b - d) + (1.0 - v) * (c - d);
    let from_b = b + u * (d - b) + (1.0 - v) * (a - b);
    let from_c = c + (1.0 - u) * (a - c) + v * (d - c);
    let diagonal = u + v;
    match known {
        [true, true, true, false] if diagonal <= 1.0 => (from_a, true),
        [true, true, true, false] => (from_d, false),
        [false, true, true, true] if diagonal < 1.0 => (from_a, false),
        [false, true, true, true] => (from_d, true),
        [true, false, true, true] if v > u => (from_b, false),
        [true, false, true, true] => (from_c, true),
        [true, true, false, true] if v >= u => (from_b, true),
        [true, true, false, true] => (from_c, false),
        _ => {
            let [low, high] = [a + u * (c - a), b + u * (d - b)];
            (low + (high - low) * v, known == [true; 4])
        }
    }
}
