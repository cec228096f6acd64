//! A measured map of a whole box by its input torque: loss torque, loss power or efficiency, made one of loss torque.
//!
//! | label | statement | status |
//! |---|---|---|
//! | MP-3 | box map of a CVT in place of all its losses but those of the coupling: T_in = T_out/I + L, L = L(I, w_e, T_in, T_oil), at the engine's speed; no slip | derived: definition; the box's input shaft turns with the engine, and its pump does so while the coupling slips |
//! | MP-4 | box map of a manual box: T_in = T_out/i + L(gear, w_in, T_in, T_oil) | derived: definition |
//! | MP-7 | points that leave a grid of their own speeds and torques in part: at each ratio, and oil temperature, linear in the triangles of a Delaunay triangulation over speed and torque, each in shares of its range; beyond the points at a speed L = L_0 + (L_e - L_0) T/T_e from the loss L_0 without torque and the last one, L_e at T_e, or L_e where there is no L_0; beyond the speeds that of the last one | derived: MP-3 on triangles; beyond the points ASSUMED, and the time there is counted |
//! | MP-6 | L = P/w_in; L = T (1 - eta) for T > 0, L = \|T\| (1/eta - 1) for T < 0; without rows below 0 that of \|T\|; L at T = 0 given | derived: definition of efficiency; that of overrun without rows ASSUMED |
//!
//! One linear piece of L(T) after the other: T_in is found where T_in - L(T_in) is the torque behind, which rises with T_in in every map.

pub mod scattered;

use crate::keys::file_table::{FileColumn, FileRows, FileTable};
use crate::keys::{Bound, Key, Quantity, Values};
use crate::maps::LossMap;
pub use crate::maps::NoMap;
use crate::math::{Across, GRID_AXES, Grid, Lattice};

const RATIO: FileColumn = FileColumn::new("ratio", "ratio", Bound::closed(0.2, 12.0)).or_none();
const SPEED_RATIO: FileColumn =
    FileColumn::new("speed_ratio", "ratio", Bound::closed(0.08, 5.0)).or_none();
const OUTPUT_SPEED: FileColumn =
    FileColumn::new("output_speed_rpm", "ratio", Bound::open_low(0.0, 20_000.0)).or_none();
const GEAR: FileColumn = FileColumn::new("gear", "ratio", Bound::closed(0.2, 12.0)).or_none();
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

/// The columns behind that of the ratio or gear, in all their units.
const SPEED_RAD_S: FileColumn = SPEED.in_unit("input_speed_rad_s", Bound::closed(0.0, 2100.0));
const TORQUE_LBFT: FileColumn = TORQUE.in_unit("input_torque_lbft", Bound::closed(-2200.0, 2200.0));
const LOSS_LBFT: FileColumn = LOSS.in_unit("torque_loss_lbft", Bound::closed(0.0, 740.0));
const POWER_KW: FileColumn = POWER.in_unit("power_loss_kw", Bound::closed(0.0, 1000.0));
const SHARE_OF_ONE: FileColumn = EFFICIENCY.in_unit("efficiency", Bound::closed(0.0, 1.0));

const WORDS: &[(&str, &str)] = &[
    ("belt_ratio", "ratio"),
    ("cvt_ratio", "ratio"),
    ("pulley_ratio", "ratio"),
    ("transmission_ratio", "ratio"),
    ("gear_number", "gear"),
    ("speed", "input_speed"),
    ("n_in", "input_speed"),
    ("primary_speed", "input_speed"),
    ("speed_in", "input_speed"),
    ("speed_out", "output_speed"),
    ("n_out", "output_speed"),
    ("secondary_speed", "output_speed"),
    ("torque", "input_torque"),
    ("t_in", "input_torque"),
    ("primary_torque", "input_torque"),
    ("torque_in", "input_torque"),
    ("oil_temperature", "oil_temp"),
    ("loss_torque", "torque_loss"),
    ("loss_power", "power_loss"),
    ("eff", "efficiency"),
    ("eta", "efficiency"),
];

/// The map of a CVT as a file.
pub static CVT_BOX: FileTable = OF_CVT;

const OF_CVT: FileTable = FileTable {
    kind: "cvt_box",
    columns: &[
        RATIO,
        SPEED_RATIO,
        OUTPUT_SPEED,
        OUTPUT_SPEED.in_unit("output_speed_rad_s", Bound::open_low(0.0, 2100.0)),
        SPEED,
        SPEED_RAD_S,
        TORQUE,
        TORQUE_LBFT,
        OIL,
        LOSS,
        LOSS_LBFT,
        POWER,
        POWER_KW,
        SHARE_OF_ONE,
        EFFICIENCY,
    ],
    rises_with: None,
    is_grid: true,
    has_holes: true,
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
        GEAR,
        SPEED,
        SPEED_RAD_S,
        TORQUE,
        TORQUE_LBFT,
        OIL,
        LOSS,
        LOSS_LBFT,
        POWER,
        POWER_KW,
        SHARE_OF_ONE,
        EFFICIENCY,
    ],
    ..OF_CVT
};

/// Least torque of which an efficiency says something, Nm: below it is 0/0.
const MIN_NM: f64 = 2.0;
/// Largest efficiency of a table whose numbers are likely to be shares.
const SHARE: f64 = 0.01;
/// Most points of a grid that is filled: as many as a file may have.
const MOST_NODES: usize = 1_000_000;
/// Place of the speed among the axes of a [`LossMap`].
const OF_SPEED: usize = 1;
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

/// The points of a table as loss torque (MP-6); `idle_nm` is the loss without torque, where it is given.
///
/// # Errors
/// Problem of an efficiency or a power.
pub fn points(table: &FileRows, idle_nm: Option<f64>) -> Result<Vec<Point>, NoMap> {
    let axes = AXES.map(|names| names.iter().find_map(|name| table.position(name)));
    let [speed_ratio, output_speed] =
        ["speed_ratio", "output_speed_rpm"].map(|name| table.position(name));
    if output_speed.is_some() && axes[1].is_none() {
        return Err(NoMap::new(
            "a column input_speed_rpm",
            "an output speed is no ratio without the input speed".to_owned(),
            "add the input speed, or give the ratio",
        ));
    }
    let at = |row: &[f64]| {
        let mut x = [0.0; GRID_AXES];
        for (x, axis) in x.iter_mut().zip(axes) {
            *x = axis.map_or(0.0, |k| row[k]);
        }
        if let Some(k) = speed_ratio {
            x[0] = rounded(1.0 / row[k]);
        }
        if let Some(k) = output_speed {
            x[0] = rounded(x[1] / row[k]);
        }
        x
    };
    let of = |name: &str| table.position(name);
    let with = |value: usize| {
        let mut rows: Vec<Point> = table.rows.iter().map(|row| (at(row), row[value])).collect();
        if speed_ratio.is_some() || output_speed.is_some() {
            join_ratios(&mut rows);
        }
        rows
    };
    if let Some(loss) = of("torque_loss_nm") {
        return Ok(with(loss));
    }
    if let Some(power) = of("power_loss_w") {
        return of_power(with(power), axes[1].is_some());
    }
    let share = of("efficiency_percent").unwrap_or_default();
    of_efficiency(with(share), axes[OF_TORQUE].is_some(), idle_nm)
}

/// Computed ratios that differ by the rounding of the speeds become one, the lowest of them.
fn join_ratios(rows: &mut [Point]) {
    let mut ratios: Vec<f64> = rows.iter().map(|(x, _)| x[0]).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup_by(|a, b| (*a - *b).abs() <= SAME_RATIO * b.abs());
    for (x, _) in rows {
        let place = ratios.partition_point(|own| *own <= x[0]);
        x[0] = ratios[place.saturating_sub(1)];
    }
}

/// Ratios of speeds in whole revolutions a minute that differ by less are one.
const SAME_RATIO: f64 = 1e-3;

/// A ratio without the last digits of its rounding, by which one ratio would be several.
fn rounded(ratio: f64) -> f64 {
    (ratio * 1e12).round() * 1e-12
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

/// A map of points that leave their grid in part (MP-7).
///
/// # Errors
/// Fewer than four points at a ratio and an oil temperature, points on one line, and what [`map`] refuses.
pub fn layered(table: &FileRows, points: &[Point]) -> Result<LossMap, NoMap> {
    let levels = |axis: usize| {
        let mut levels: Vec<f64> = points.iter().map(|(x, _)| x[axis]).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels
    };
    let (speeds, torques) = (levels(OF_SPEED), levels(OF_TORQUE));
    let bits = |x: &[f64; GRID_AXES]| [x[0], x[3], x[4]].map(f64::to_bits);
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| {
        [0, 3, 4]
            .map(|k| a.0[k])
            .iter()
            .zip([0, 3, 4].map(|k| b.0[k]))
            .fold(std::cmp::Ordering::Equal, |so_far, (a, b)| {
                so_far.then(a.total_cmp(&b))
            })
    });
    let layers: Vec<&[Point]> = sorted.chunk_by(|a, b| bits(&a.0) == bits(&b.0)).collect();
    let combinations = [0, 3, 4]
        .map(|axis| levels(axis).len())
        .iter()
        .product::<usize>();
    let size = layers.len() * speeds.len() * torques.len();
    if layers.len() != combinations || size > MOST_NODES {
        return Err(missing(table));
    }
    let mut nodes = Vec::with_capacity(size);
    let mut unknown = Vec::new();
    for layer in layers {
        let plane: Vec<([f64; 2], f64)> = layer
            .iter()
            .map(|(x, loss)| ([x[OF_SPEED], x[OF_TORQUE]], *loss))
            .collect();
        let lattice = Lattice::new(&plane, [&speeds, &torques], beyond);
        let lattice = lattice.ok_or_else(|| missing(table))?;
        for (i, speed) in speeds.iter().enumerate() {
            for (k, torque) in torques.iter().enumerate() {
                let mut x = layer[0].0;
                (x[OF_SPEED], x[OF_TORQUE]) = (*speed, *torque);
                nodes.push((x, lattice.values[i][k]));
                if !lattice.known[i][k] {
                    unknown.push(x);
                }
            }
        }
    }
    Ok(map(&nodes)?.with_unknown(&unknown))
}

/// Loss at a torque beyond the points at a speed (MP-7).
fn beyond(across: &Across<'_>, torque_nm: f64) -> f64 {
    let [low, high] = across.ends;
    let (end_nm, end) = match torque_nm > high {
        true => (high, across.at_ends[1]),
        false => (low, across.at_ends[0]),
    };
    let has_idle = low <= 0.0 && high >= 0.0 && end_nm * torque_nm > 0.0;
    match has_idle {
        true => {
            let idle = across.held(0.0);
            idle + (end - idle) * torque_nm / end_nm // MP-7
        }
        false => end,
    }
}

/// The first combination of a table's values that has no row.
fn missing(table: &FileRows) -> NoMap {
    let values = ["torque_loss_nm", "power_loss_w", "efficiency_percent"];
    let axes: Vec<usize> = (0..table.columns.len())
        .filter(|k| !values.contains(&table.columns[*k]))
        .collect();
    let there: std::collections::HashSet<Vec<u64>> = table
        .rows
        .iter()
        .map(|row| axes.iter().map(|k| row[*k].to_bits()).collect())
        .collect();
    let levels: Vec<Vec<f64>> = axes.iter().map(|k| table.levels(Some(*k))).collect();
    let mut place = vec![0; axes.len()];
    loop {
        let here: Vec<f64> = place
            .iter()
            .zip(&levels)
            .map(|(k, level)| level[*k])
            .collect();
        if !there.contains(&here.iter().map(|x| x.to_bits()).collect::<Vec<u64>>()) {
            let here: Vec<String> = axes
                .iter()
                .zip(here)
                .map(|(k, x)| {
                    let name = table.columns[*k];
                    let own = Quantity::from_key(name).from_si(x);
                    format!("{name} {}", (own * 1e6).round() / 1e6)
                })
                .collect();
            return NoMap::new(
                "a row for every combination of the columns' values, or at each ratio and oil temperature four points that are on no line",
                format!("there is no row for {}", here.join(", ")),
                "add it, or remove the rows that belong to no full grid",
            );
        }
        let next = (0..axes.len())
            .rev()
            .find(|axis| place[*axis] + 1 < levels[*axis].len());
        let Some(axis) = next else {
            return NoMap::new(
                "a full grid",
                format!(
                    "the {} rows fill no grid that is small enough",
                    table.rows.len()
                ),
                "bring them onto a grid",
            );
        };
        place[axis] += 1;
        place[axis + 1..].fill(0);
    }
}

/// A map of points: a full grid, layers of points, or, where they are said to be scattered, planes through neighbours (MP-5).
///
/// # Errors
/// As [`map`], [`layered`] and [`scattered::gridded`].
pub fn of_points(table: &FileRows, points: &[Point], is_grid: bool) -> Result<LossMap, NoMap> {
    if Grid::from_rows(points).is_ok() {
        return map(points);
    }
    match layered(table, points) {
        Err(_) if !is_grid => {
            let grid = scattered::gridded(points)?;
            Ok(map(&grid)?.of_scatter(scattered::leave_one_out(points)))
        }
        made => made,
    }
}

/// The map that the file of a key gives, if it gives one.
pub(crate) fn from_values<V: Values>(
    s: &V,
    key: &Key<'static>,
    table: &'static FileTable,
    idle_nm: Option<f64>,
    is_inverse: bool,
) -> Option<LossMap> {
    let mut rows = s.file_table(key, table)?;
    if is_inverse && let Some(k) = rows.position("ratio") {
        rows.columns[k] = "speed_ratio";
    }
    let made = points(&rows, idle_nm).and_then(|points| of_points(&rows, &points, table.is_grid));
    let report = |why: NoMap| s.complain(key.name, &why.allowed, &why.message, &why.hint);
    made.map_err(report).ok()
}
