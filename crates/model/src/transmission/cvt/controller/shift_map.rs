//! A table of the user's in place of the variogram: engine speed or belt ratio over road speed and pedal or power.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RC-14 | target in place of RC-1 and RC-2: n = N(v, u), u = clip(P/(eta P_full(n)); 0, 1) or P, or n = I(v, u) w_s; linear in v and u, held at the ends; at least 1.006 times 1.2 idle speed (LC-5) | derived: N is given, P the demand of RC-9, eta that of RC-3; the root is the only one, N rises with u and P_full with n |

use crate::keys::file_table::{FileColumn, FileRows, FileTable};
use crate::keys::{Bound, Key, Values};
use crate::math::{clamp, gather_each, larger};
use std::sync::Arc;

/// Range of engine speeds and input speeds.
const SPEED_RPM: Bound = Bound::closed(300.0, 12_000.0);

/// The table as a file.
pub static SHIFT_MAP: FileTable = FileTable {
    kind: "shift_map",
    columns: &[
        FileColumn::new("speed_kmh", "speed", Bound::closed(0.0, 400.0)),
        FileColumn::new("pedal_percent", "demand", Bound::closed(0.0, 100.0)),
        FileColumn::new("power_kw", "demand", Bound::closed(0.0, 1000.0)),
        FileColumn::new("input_speed_rpm", "target", SPEED_RPM),
        FileColumn::new("engine_speed_rpm", "target", SPEED_RPM),
        FileColumn::new("belt_ratio", "target", Bound::closed(0.2, 12.0)),
    ],
    rises_with: Some("demand"),
    is_grid: true,
    has_holes: false,
    words: &[
        ("vehicle_speed", "speed"),
        ("road_speed", "speed"),
        ("accelerator", "pedal"),
        ("accelerator_pedal", "pedal"),
    ],
};

/// Largest number of halvings of an interval of speeds: to less than rounding.
const HALVINGS: usize = 60;
/// Relative width at which they end.
const CLOSE: f64 = 1e-10;

/// Quantity of a table's demand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Demand {
    /// Share of the power at full load at the target speed.
    Pedal,
    /// Power at the wheels, W.
    Power,
}

/// The checked table (RC-14).
#[derive(Clone, Debug, PartialEq)]
pub struct ShiftMap {
    /// Road speeds, m/s, rising.
    speeds_m_s: Vec<f64>,
    /// Pedal from 0 to 1, or W, rising.
    demands: Vec<f64>,
    /// Speed in rad/s or belt ratio, demands running fastest.
    values: Vec<f64>,
    demand: Demand,
    /// True where the values are belt ratios.
    is_ratio: bool,
}

gather_each!(Arc<ShiftMap>);

/// Where the table is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShiftPoint {
    /// Road speed, m/s.
    pub speed_m_s: f64,
    /// Speed of the secondary, rad/s.
    pub secondary_rad_s: f64,
    /// Filtered power at the wheels, W.
    pub power_w: f64,
    /// Wheel power over engine power (RC-3).
    pub efficiency: f64,
}

impl ShiftMap {
    /// A table from the rows of its file, which fill a grid.
    #[must_use]
    pub fn from_rows(table: &FileRows) -> Option<Self> {
        let speed = table.position("speed_kmh")?;
        let pedal = table.position("pedal_percent");
        let power = table.position("power_kw");
        let ratio = table.position("belt_ratio");
        let value = ratio
            .or_else(|| table.position("input_speed_rpm"))
            .or_else(|| table.position("engine_speed_rpm"))?;
        let of_demand = pedal.or(power)?;
        let mut rows: Vec<&Vec<f64>> = table.rows.iter().collect();
        rows.sort_by(|a, b| {
            let by_speed = a[speed].total_cmp(&b[speed]);
            by_speed.then(a[of_demand].total_cmp(&b[of_demand]))
        });
        Some(ShiftMap {
            speeds_m_s: table.levels(Some(speed)),
            demands: table.levels(Some(of_demand)),
            values: rows.iter().map(|row| row[value]).collect(),
            demand: match pedal {
                Some(_) => Demand::Pedal,
                None => Demand::Power,
            },
            is_ratio: ratio.is_some(),
        })
    }

    /// Road speeds, demands and values as they are read, in SI units; with the last axis running fastest.
    #[must_use]
    pub fn points(&self) -> [&[f64]; 3] {
        [&self.speeds_m_s, &self.demands, &self.values]
    }

    /// Target speed of the primary, rad/s; `full_load_w` is the power at full load at an engine speed, W.
    #[must_use]
    pub fn target_rad_s(&self, at: &ShiftPoint, full_load_w: impl Fn(f64) -> f64) -> f64 {
        let row = between(&self.speeds_m_s, at.speed_m_s);
        let factor = match self.is_ratio {
            true => at.secondary_rad_s,
            false => 1.0,
        };
        let target = |demand: f64| factor * self.value(row, demand);
        let power_w = larger(at.power_w, 0.0);
        if self.demand == Demand::Power {
            return target(power_w); // RC-14
        }
        let asked_w = power_w / at.efficiency;
        // A share that is not finite or above one is full load.
        let pedal = |speed: f64| {
            let share = asked_w / full_load_w(speed);
            if share < 1.0 { larger(share, 0.0) } else { 1.0 }
        };
        let (mut low, mut high) = (target(0.0), target(1.0));
        for _ in 0..HALVINGS {
            if high - low <= CLOSE * high {
                break;
            }
            let middle = 0.5 * (low + high);
            if target(pedal(middle)) > middle {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high) // RC-14
    }

    /// The value at a place between two road speeds and at a demand.
    fn value(&self, (below, above, part): (usize, usize, f64), demand: f64) -> f64 {
        let (left, right, share) = between(&self.demands, demand);
        let of_row = |row: usize| {
            let at = |k: usize| self.values[row * self.demands.len() + k];
            at(left) + share * (at(right) - at(left))
        };
        of_row(below) + part * (of_row(above) - of_row(below))
    }
}

/// The two rising levels around a number, and the part of the way from one to the other; beyond the ends that of the end.
fn between(levels: &[f64], x: f64) -> (usize, usize, f64) {
    let last = levels.len() - 1;
    if last == 0 {
        return (0, 0, 0.0);
    }
    let below = levels.partition_point(|level| *level <= x).clamp(1, last) - 1;
    let part = (x - levels[below]) / (levels[below + 1] - levels[below]);
    (below, below + 1, clamp(part, 0.0, 1.0))
}

/// The table that the file gives, if it gives one.
pub(super) fn shift_map<V: Values>(
    s: &V,
    key: &Key<'static>,
    lines: &[&Key<'static>],
) -> Option<Arc<ShiftMap>> {
    let rows = s.file_table(key, &SHIFT_MAP)?;
    if let Some(line) = lines.iter().find(|line| s.has(line)) {
        s.complain(
            line.name,
            "a shift map or lines",
            "a shift map is in the place of the lines",
            "remove this line, or the shift map",
        );
    }
    ShiftMap::from_rows(&rows).map(Arc::new)
}
