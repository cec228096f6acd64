//! A measured map of a whole box by its input torque: loss torque, loss power or efficiency, made one of loss torque.
//!
//! | label | statement | status |
//! |---|---|---|
//! | MP-3 | box map of a CVT in place of all its losses but those of the coupling: T_in = T_out/I + L, L = L(I, w_e, T_in, T_oil), at the engine's speed; no slip | derived: definition; the box's input shaft turns with the engine, and its pump does so while the coupling slips |
//! | MP-4 | box map of a manual box: T_in = T_out/i + L(gear, w_in, T_in, T_oil) | derived: definition |
//! | MP-6 | L = P/w_in; L = T (1 - eta) for T > 0, L = \|T\| (1/eta - 1) for T < 0; without rows below 0 that of \|T\|; L at T = 0 given | derived: definition of efficiency; that of overrun without rows ASSUMED |
//!
//! One linear piece of L(T) after the other: T_in is found where T_in - L(T_in) is the torque behind, which rises with T_in in every map.

pub mod scattered;

use crate::keys::file_table::{FileColumn, FileRows, FileTable};
use crate::keys::{Bound, Key, Values};
use crate::maps::LossMap;
use crate::math::{GRID_AXES, Grid};

const SPEED: FileColumn =
    FileColumn::new("input_speed_rpm", "speed", Bound::closed(0.0, 20_000.0)).or_none();
const TORQUE: FileColumn =
    FileColumn::new("input_torque_nm", "torque", Bound::closed(-3000.0, 3000.0)).or_none();
const OIL: FileColumn =
    FileColumn::new("oil_temp_degc", "oil", Bound::closed(-60.0, 200.0)).or_none();
const LOSS: FileColumn = FileColumn::new("torque_loss_nm", "loss", Bound::closed(0.0, 1000.0));
const POWER: FileColumn = FileColumn::new("power_loss_w", "loss", Bound::closed(0.0, 1e6));
const EFFICIENCY: FileColumn =
    FileColumn::new("efficiency_percent", "loss", Bound::closed(0.0, 100.0));

const WORDS: &[(&str, &str)] = &[
    ("belt_ratio", "ratio"),
    ("speed", "input_speed"),
    ("torque", "input_torque"),
    ("oil_temperature", "oil_temp"),
    ("loss_torque", "torque_loss"),
    ("loss_power", "power_loss"),
];

/// The map of a CVT as a file.
pub static CVT_BOX: FileTable = OF_CVT;

const OF_CVT: FileTable = FileTable {
    kind: "cvt_box",
    columns: &[
        FileColumn::new("ratio", "ratio", Bound::closed(0.2, 12.0)).or_none(),
        SPEED,
        TORQUE,
        OIL,
        LOSS,
        POWER,
        EFFICIENCY,
    ],
    rises_with: None,
    is_grid: true,
    words: WORDS,
};

/// The same from points that fill no grid.
pub static CVT_BOX_POINTS: FileTable = FileTable {
    kind: "cvt_box_points",
    is_grid: false,
    ..OF_CVT
};

/// The map of a manual box as a file.
pub static MANUAL_BOX: FileTable = FileTable {
    kind: "manual_box",
    columns: &[
        FileColumn::new("gear", "ratio", Bound::closed(0.2, 12.0)).or_none(),
        SPEED,
        TORQUE,
        OIL,
        LOSS,
        POWER,
        EFFICIENCY,
    ],
    ..OF_CVT
};

/// Least torque of which an efficiency says something, Nm: below it is 0/0.
const MIN_NM: f64 = 2.0;
/// Largest efficiency of a table whose numbers are likely to be shares.
const SHARE: f64 = 0.01;
/// Place of the torque among the axes of a [`LossMap`].
const OF_TORQUE: usize = 2;
/// Names of the axes of a [`LossMap`] in the files.
const AXES: [[&str; 2]; GRID_AXES] = [
    ["ratio", "gear"],
    ["input_speed_rpm", ""],
    ["input_torque_nm", ""],
    ["", ""],
    ["oil_temp_degc", ""],
];

/// A point of the map: its axes, and the loss torque in Nm.
type Point = ([f64; GRID_AXES], f64);

/// Why rows are no map: what is allowed, what is wrong, what helps.
#[derive(Clone, Debug, PartialEq)]
pub struct NoMap {
    /// Accepted values.
    pub allowed: String,
    /// Problem, one sentence.
    pub message: String,
    /// Remedy.
    pub hint: String,
}

impl NoMap {
    fn new(allowed: &str, message: String, hint: &str) -> Self {
        NoMap {
            allowed: allowed.to_owned(),
            message,
            hint: hint.to_owned(),
        }
    }
}

/// The points of a table as loss torque (MP-6); `idle_nm` is the loss without torque, where it is given.
///
/// # Errors
/// Problem of an efficiency or a power.
pub fn points(table: &FileRows, idle_nm: Option<f64>) -> Result<Vec<Point>, NoMap> {
    let axes = AXES.map(|names| names.iter().find_map(|name| table.position(name)));
    let at = |row: &[f64]| {
        let mut x = [0.0; GRID_AXES];
        for (x, axis) in x.iter_mut().zip(axes) {
            *x = axis.map_or(0.0, |k| row[k]);
        }
        x
    };
    let of = |name: &str| table.position(name);
    if let Some(loss) = of("torque_loss_nm") {
        let rows = table.rows.iter();
        return Ok(rows.map(|row| (at(row), row[loss])).collect());
    }
    if let Some(power) = of("power_loss_w") {
        let rows = table.rows.iter().map(|row| (at(row), row[power]));
        return of_power(rows.collect(), axes[1].is_some());
    }
    let share = of("efficiency_percent").unwrap_or_default();
    let rows = table.rows.iter().map(|row| (at(row), row[share]));
    of_efficiency(rows.collect(), axes[OF_TORQUE].is_some(), idle_nm)
}

fn of_power(mut rows: Vec<Point>, has_speed: bool) -> Result<Vec<Point>, NoMap> {
    if !has_speed || rows.iter().any(|(x, _)| x[1] <= 0.0) {
        return Err(NoMap::new(
            "a column input_speed_rpm, above 0 in every row",
            "a loss power is no torque without a speed".to_owned(),
            "give the speed, or torque_loss_nm in place of power_loss_w",
        ));
    }
    for (x, loss) in &mut rows {
        *loss /= x[1]; // MP-6
    }
    Ok(rows)
}

fn of_efficiency(
    rows: Vec<Point>,
    has_torque: bool,
    idle_nm: Option<f64>,
) -> Result<Vec<Point>, NoMap> {
    let largest = rows.iter().map(|(_, eta)| *eta).fold(0.0, f64::max);
    if largest <= SHARE {
        return Err(NoMap::new(
            "percent",
            format!("the largest efficiency is {} %", 100.0 * largest),
            "multiply a share by 100",
        ));
    }
    let is_small = |(x, _): &&Point| x[OF_TORQUE].abs() < MIN_NM;
    if !has_torque || rows.iter().any(|point| is_small(&point)) {
        return Err(NoMap::new(
            "input_torque_nm of at least 2 N m, or at most -2",
            "an efficiency without torque is 0/0".to_owned(),
            "leave these rows out and give no_load_loss_nm, or give torque_loss_nm in place of the efficiency",
        ));
    }
    if rows.iter().any(|(_, eta)| *eta <= 0.0) {
        return Err(NoMap::new(
            "above 0 %",
            "an efficiency of 0 % has no loss torque in overrun".to_owned(),
            "give torque_loss_nm where nothing passes",
        ));
    }
    let Some(idle_nm) = idle_nm else {
        return Err(NoMap::new(
            "no_load_loss_nm next to the map",
            "an efficiency does not say what the box loses without torque".to_owned(),
            "give the drag torque at the input with nothing behind the box",
        ));
    };
    Ok(by_efficiency(&rows, idle_nm))
}

/// The loss at each torque of rows with an efficiency, and without torque.
fn by_efficiency(rows: &[Point], idle_nm: f64) -> Vec<Point> {
    let loss = |torque: f64, eta: f64| {
        if torque > 0.0 {
            torque * (1.0 - eta) // MP-6
        } else {
            -torque * (1.0 / eta - 1.0) // MP-6
        }
    };
    let in_overrun = rows.iter().any(|(x, _)| x[OF_TORQUE] < 0.0);
    let mut points = Vec::new();
    for (x, eta) in rows {
        let with = |torque: f64| {
            let mut x = *x;
            x[OF_TORQUE] = torque;
            x
        };
        let torque = x[OF_TORQUE];
        points.push((*x, loss(torque, *eta)));
        points.push((with(0.0), idle_nm));
        if !in_overrun {
            points.push((with(-torque), loss(-torque, *eta)));
        }
    }
    // The row without torque came once with each torque.
    points.sort_by(|a, b| compare(&a.0, &b.0));
    points.dedup_by(|a, b| compare(&a.0, &b.0).is_eq());
    points
}

fn compare(a: &[f64; GRID_AXES], b: &[f64; GRID_AXES]) -> std::cmp::Ordering {
    let each = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    each.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
}

/// A map of loss torque whose T - L(T) rises with T everywhere.
///
/// # Errors
/// The points fill no grid, or the loss rises as fast as the torque.
pub fn map(points: &[Point]) -> Result<LossMap, NoMap> {
    let grid = Grid::from_rows(points).map_err(|why| {
        NoMap::new(
            "a full grid",
            why,
            "every combination of the columns' values has one row",
        )
    })?;
    let torques = &grid.axes()[OF_TORQUE];
    let after = grid.axes()[OF_TORQUE + 1..].iter().map(Vec::len);
    let stride: usize = after.product();
    let values = grid.values();
    for (k, loss_nm) in values.iter().enumerate() {
        let place = k / stride % torques.len();
        let Some(next) = torques.get(place + 1) else {
            continue;
        };
        let (from, by) = (torques[place], next - torques[place]);
        let rise = values[k + stride] - loss_nm;
        if rise.abs() >= by {
            return Err(NoMap::new(
                "a loss that changes by less than the torque does",
                format!(
                    "the loss goes from {loss_nm:.4} to {:.4} N m while the input torque goes from {from:.4} to {next:.4} N m",
                    loss_nm + rise
                ),
                "correct the rows; is the torque that at the output, or the loss a power?",
            ));
        }
    }
    Ok(LossMap::new(grid))
}

/// The map that the file of a key gives, if it gives one.
pub(crate) fn from_values<V: Values>(
    s: &V,
    key: &Key<'static>,
    table: &'static FileTable,
    idle_nm: Option<f64>,
) -> Option<LossMap> {
    let rows = s.file_table(key, table)?;
    let made = points(&rows, idle_nm).and_then(|points| match table.is_grid {
        true => map(&points),
        false => scattered::gridded(&points)
            .and_then(|grid| map(&grid))
            .map(|map| map.of_scatter(scattered::leave_one_out(&points))),
    });
    let report = |why: NoMap| s.complain(key.name, &why.allowed, &why.message, &why.hint);
    made.map_err(report).ok()
}
