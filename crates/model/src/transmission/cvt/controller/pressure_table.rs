//! The clamp law that is a table of the user's: pressure over torque, ratio and speed.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PC-6 | `table`: p = p(\|T_s\|/I, I, I w_s), linear in each, held at the ends, above the floors of PC-5 with F_need that of PC-3 at S = 1, below the cap | derived: p is given; a table of a box at constant ratio has nothing for its shift, which PC-5 adds |

use crate::keys::file_table::{FileColumn, FileRows, FileTable};
use crate::keys::{Bound, Values, keys};
use crate::math::{GRID_AXES, Grid, gather_each};
use std::sync::Arc;

keys! {
    /// Keys of `[transmission.cvt.clamp.table]`.
    TABLE: TableKeys = "table" [] {
        file: csv(), "CSV of secondary pressure over input torque and belt ratio; columns input_torque_nm, belt_ratio, where measured input_speed_rpm, and secondary_pressure_bar", ["PC-6"];
    }
}

/// The table as a file.
pub static PRESSURE_TABLE: FileTable = FileTable {
    kind: "pressure_table",
    columns: &[
        FileColumn::new("input_torque_nm", "torque", Bound::closed(0.0, 3000.0)),
        FileColumn::new("belt_ratio", "ratio", Bound::closed(0.2, 12.0)),
        FileColumn::new("input_speed_rpm", "speed", Bound::closed(0.0, 20_000.0)).or_none(),
        FileColumn::new(
            "secondary_pressure_bar",
            "pressure",
            Bound::closed(0.0, 200.0),
        ),
    ],
    rises_with: Some("torque"),
    is_grid: true,
    has_holes: false,
    words: &[
        ("ratio", "belt_ratio"),
        ("torque", "input_torque"),
        ("speed", "input_speed"),
        ("line_pressure", "secondary_pressure"),
        ("clamping_pressure", "secondary_pressure"),
    ],
};

/// The checked table (PC-6).
#[derive(Clone, Debug, PartialEq)]
pub struct PressureTable {
    grid: Grid,
}

gather_each!(Arc<PressureTable>);

/// Where the table is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressurePoint {
    /// Torque at the primary by the ratio alone, Nm, drive and overrun alike.
    pub torque_nm: f64,
    /// Belt ratio.
    pub ratio: f64,
    /// Speed of the primary by the ratio alone, rad/s.
    pub speed_rad_s: f64,
}

impl PressurePoint {
    /// The point of a belt with a torque at the secondary, Nm, and a speed of it, rad/s.
    #[must_use]
    pub fn of_belt(secondary_nm: f64, ratio: f64, secondary_rad_s: f64) -> Self {
        PressurePoint {
            torque_nm: secondary_nm.abs() / ratio,
            ratio,
            speed_rad_s: ratio * secondary_rad_s,
        }
    }
}

impl PressureTable {
    /// A table from the rows of its file.
    ///
    /// # Errors
    /// A sentence: the rows fill no grid.
    pub fn from_rows(table: &FileRows) -> Result<Self, String> {
        let names = ["belt_ratio", "input_torque_nm", "input_speed_rpm"];
        let axes = names.map(|name| table.position(name));
        let pressure = table.position("secondary_pressure_bar").unwrap_or_default();
        let rows: Vec<([f64; GRID_AXES], f64)> = table
            .rows
            .iter()
            .map(|row| {
                let mut x = [0.0; GRID_AXES];
                for (x, axis) in x.iter_mut().zip(axes) {
                    *x = axis.map_or(0.0, |k| row[k]);
                }
                (x, row[pressure])
            })
            .collect();
        Grid::from_rows(&rows).map(|grid| PressureTable { grid })
    }

    /// The grid: ratio, torque in Nm, speed in rad/s; pressures in Pa.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Pressure, Pa (PC-6).
    #[must_use]
    pub fn pressure_pa(&self, at: &PressurePoint) -> f64 {
        self.read(at).0 // PC-6
    }

    /// True if the table covers the point: a ratio within it, torque and speed not beyond its last ones. Less torque or speed than its first needs no more
    /// pressure than that.
    #[must_use]
    pub fn holds(&self, at: &PressurePoint) -> bool {
        let [ratios, torques, speeds, ..] = self.grid.axes();
        let last =
            |axis: &[f64], x: f64| axis.len() < 2 || axis.last().is_some_and(|end| x <= *end);
        let first = ratios.len() < 2 || ratios.first().is_some_and(|end| *end <= at.ratio);
        first
            && last(ratios, at.ratio)
            && last(torques, at.torque_nm)
            && last(speeds, at.speed_rad_s)
    }

    fn read(&self, at: &PressurePoint) -> (f64, bool) {
        let mut x = [0.0; GRID_AXES];
        x[..3].copy_from_slice(&[at.ratio, at.torque_nm, at.speed_rad_s]);
        self.grid.at(x)
    }
}

/// The table that the option's file gives; none after a problem.
pub(super) fn pressure_table<V: Values>(s: &V) -> Option<Arc<PressureTable>> {
    let rows = s.file_table(&TABLE.file, &PRESSURE_TABLE)?;
    match PressureTable::from_rows(&rows) {
        Ok(table) => Some(Arc::new(table)),
        Err(why) => {
            s.complain(
                TABLE.file.name,
                "a full grid",
                &why,
                "every combination of the columns' values has one row",
            );
            None
        }
    }
}
