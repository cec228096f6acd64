//! Measured maps that a drive left: outside its grid a map is clamped to its edge, which is not a measurement.

use serde::{Deserialize, Serialize};

use super::{Driven, Summary};
use crate::number::finite;
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::loss_map_axes;
use cvtcycle_model::drive::{Conditions, Row, drive_into};
use cvtcycle_model::engine::{Engine, FuelModel};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::keys::Quantity;
use cvtcycle_model::maps::{BsfcMap, LossMap};
use cvtcycle_model::math::GRID_AXES;
use cvtcycle_model::transmission::component::{Component, Part};

/// Share of the engine-on time from which leaving a map is a headline. ASSUMED: in less, a fuel that is wrong by a tenth moves the result by 0.2 %.
const LARGE: f64 = 0.02;

/// A map that was left for a large part of a drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapLeft {
    /// As the vehicle's file names it.
    pub file: String,
    /// Share of the engine-on time, per cent.
    pub percent: f64,
    /// The same as time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
    /// Column whose range was left for the longest time; empty where that was in holes between the points.
    pub column: String,
    /// Side of the range: `below` or `above`.
    pub side: String,
    /// End of the range, in the unit of the column.
    pub end: Option<f64>,
}

/// Finds the maps that each car of a run left.
pub fn find_maps_left(
    summary: &mut Summary,
    cycle: &Cycle,
    conditions: &Conditions,
    driven: &[Driven],
) {
    for (run, car) in summary.runs.iter_mut().zip(driven) {
        run.maps_left = maps_left(cycle, conditions, car);
    }
}

/// Finds the maps that a car left for a large part of its drive. Rows are searched only if the flags of the drive show a departure that long; a
/// drive without rows is repeated.
fn maps_left(cycle: &Cycle, conditions: &Conditions, driven: &Driven) -> Vec<MapLeft> {
    let totals = &driven.outcome.totals;
    let running_s = totals.total().duration_s - totals.seconds(Flags::ENGINE_OFF);
    let transmission = driven.setup.transmission();
    let is_left = |seconds: f64| seconds > LARGE * running_s;
    let engine = driven.setup.engine();
    let fuel_map = match &engine.fuel {
        FuelModel::Map(map) => Some(map),
        FuelModel::Willans(_) => None,
    };
    if transmission.maps().next().is_none() && fuel_map.is_none()
        || !is_left(totals.seconds(Flags::OUTSIDE_VALIDITY))
    {
        return Vec::new();
    }
    let maps: Vec<(Component, &LossMap)> = transmission.maps().collect();
    let mut times = vec![TimeOutside::default(); maps.len()];
    let mut of_fuel = TimeOutside::default();
    let mut see = |rows: &[Row]| {
        for ((component, map), left) in maps.iter().zip(&mut times) {
            left.add(rows, *component, map);
        }
        if let Some(map) = fuel_map {
            of_fuel.add_fuel(rows, engine, map);
        }
    };
    match driven.outcome.rows.as_slice() {
        [] => drop(drive_into(driven.setup, cycle, conditions, Some(&mut see))),
        rows => see(rows),
    }
    let of_map = |((component, map), left): (&(Component, &LossMap), &TimeOutside)| {
        let seconds = finite(left.any_s);
        let percent = 100.0 * left.any_s / running_s;
        let Some((axis, side)) = left.longest_departure() else {
            return is_left(left.any_s).then(|| MapLeft {
                file: file(driven, *component),
                percent,
                seconds,
                column: String::new(),
                side: String::new(),
                end: None,
            });
        };
        let values = map.grid().axes()[axis].as_slice();
        let is_box = component.part() == Part::BoxMap;
        let column = match (axis, is_box) {
            (2, true) => "input_torque_nm",
            _ => loss_map_axes(transmission.is_cvt())[axis],
        };
        let end = [values.first(), values.last()][side].copied();
        is_left(left.any_s).then(|| MapLeft {
            file: file(driven, *component),
            percent,
            seconds,
            column: column.to_owned(),
            side: ["below", "above"][side].to_owned(),
            end: end.and_then(|si| finite(Quantity::from_key(column).from_si(si))),
        })
    };
    let mut all: Vec<MapLeft> = maps.iter().zip(&times).filter_map(of_map).collect();
    if let Some(map) = fuel_map.filter(|_| is_left(of_fuel.any_s)) {
        all.push(fuel_map_left(map, &of_fuel, running_s));
    }
    all
}

/// The map of fuel that a car left.
fn fuel_map_left(map: &BsfcMap, left: &TimeOutside, running_s: f64) -> MapLeft {
    let (column, side, end) = match left.longest_departure() {
        None => ("", "", None),
        Some((axis, side)) => {
            let ends = |of: &[f64]| [of.first(), of.last()][side].copied();
            let (column, end) = match axis {
                0 => ("speed_rpm", ends(&map.speed_rad_s)),
                _ => ("bmep_bar", ends(&map.bmep_pa)),
            };
            let in_unit = |si: f64| Quantity::from_key(column).from_si(si);
            (column, ["below", "above"][side], end.map(in_unit))
        }
    };
    MapLeft {
        file: map
            .origin
            .as_ref()
            .map_or_else(String::new, |origin| origin.file.clone()),
        percent: 100.0 * left.any_s / running_s,
        seconds: finite(left.any_s),
        column: column.to_owned(),
        side: side.to_owned(),
        end: end.and_then(finite),
    }
}

/// Name of a component's map in the vehicle's file.
fn file(driven: &Driven, component: Component) -> String {
    let kind = if driven.setup.transmission().is_cvt() {
        "cvt"
    } else {
        "manual"
    };
    let name = component.map_key().unwrap_or_default();
    let key = format!("transmission.{kind}.maps.{name}");
    let mut keys = driven.setup.keys.iter();
    let found = keys.find(|info| info.key == key);
    found.map_or(key.clone(), |info| info.value.clone())
}

/// Time outside a map, s: in total, and below and above each of its axes.
#[derive(Clone, Default)]
struct TimeOutside {
    any_s: f64,
    /// In holes between the points.
    holes_s: f64,
    sides_s: [[f64; 2]; GRID_AXES],
}

impl TimeOutside {
    fn add(&mut self, rows: &[Row], component: Component, map: &LossMap) {
        for row in rows.iter().filter(|row| !row.flags.any(Flags::ENGINE_OFF)) {
            let mut is_left = false;
            let x = at(row, component);
            let axes = map.grid().axes().iter().zip(x);
            for ((axis, x), sides_s) in axes.zip(&mut self.sides_s) {
                let (Some(x), [first, .., last]) = (x, axis.as_slice()) else {
                    continue;
                };
                for (is_out, side_s) in [x < *first, x > *last].into_iter().zip(sides_s) {
                    *side_s += if is_out { row.dt_s } else { 0.0 };
                    is_left |= is_out;
                }
            }
            // A coordinate that the row does not record is on no side, and in no hole.
            let axes = map.grid().axes();
            let known = |(x, axis): (Option<f64>, &Vec<f64>)| match axis.len() {
                1 => Some(axis[0]),
                _ => x,
            };
            let x: Option<Vec<f64>> = x.into_iter().zip(axes).map(known).collect();
            let x = x.and_then(|x| <[f64; GRID_AXES]>::try_from(x).ok());
            let in_hole = !is_left && x.is_some_and(|x| !map.grid().at(x).1);
            self.add_time(row.dt_s, is_left, in_hole);
        }
    }

    fn add_fuel(&mut self, rows: &[Row], engine: &Engine, map: &BsfcMap) {
        let running =
            |row: &&Row| !row.flags.any(Flags::ENGINE_OFF) && row.engine_speed_rad_s > 0.0;
        for row in rows.iter().filter(running) {
            let speed = row.engine_speed_rad_s;
            let crank_nm = row.engine_torque_nm + (row.accessories_w + row.kinetic_w) / speed;
            let bmep_pa = engine.mep_pa(crank_nm);
            let ends = [(speed, &map.speed_rad_s), (bmep_pa, &map.bmep_pa)];
            let mut is_left = false;
            for (k, (x, axis)) in ends.into_iter().enumerate() {
                let [Some(first), Some(last)] = [axis.first(), axis.last()] else {
                    continue;
                };
                // Below the lowest load the line to the drag belongs to the map (BM-2).
                let is_out = [x < *first && k == 0, x > *last];
                for (is_out, side_s) in is_out.into_iter().zip(&mut self.sides_s[k]) {
                    *side_s += if is_out { row.dt_s } else { 0.0 };
                    is_left |= is_out;
                }
            }
            let in_hole = !is_left && !map.contains(speed, bmep_pa);
            self.add_time(row.dt_s, is_left, in_hole);
        }
    }

    fn add_time(&mut self, dt_s: f64, is_left: bool, in_hole: bool) {
        self.any_s += if is_left || in_hole { dt_s } else { 0.0 };
        self.holes_s += if in_hole { dt_s } else { 0.0 };
    }

    /// Axis and side of the longest departure; none where more time was in holes.
    fn longest_departure(&self) -> Option<(usize, usize)> {
        let all = self.sides_s.iter().enumerate();
        let all = all.flat_map(|(axis, sides)| [(axis, 0, sides[0]), (axis, 1, sides[1])]);
        let (axis, side, seconds) = all.max_by(|a, b| a.2.total_cmp(&b.2))?;
        (seconds >= self.holes_s).then_some((axis, side))
    }
}

/// Coordinates at which a row reads the map of a component; `None` where the row does not record them.
fn at(row: &Row, component: Component) -> [Option<f64>; GRID_AXES] {
    let is_box = component.part() == Part::BoxMap;
    let of_engine = is_box || [Component::Pump, Component::InputShaft].contains(&component);
    let couples = Flags(Flags::CLUTCH_SLIPPING.0 | Flags::CLUTCH_OPEN.0 | Flags::LOCKUP_OPEN.0);
    let is_known = of_engine || !row.flags.any(couples);
    let torque_nm = match component {
        Component::BeltMap => finite(row.secondary_nm),
        Component::FinalDrive => None,
        _ if is_box => finite(row.engine_torque_nm),
        _ => Some(0.0),
    };
    let gear = Some(f64::from(row.gear)).filter(|gear| *gear > 0.0);
    let ratio = gear.or_else(|| finite(row.belt_ratio));
    let pressure_pa = if is_box {
        Some(0.0)
    } else {
        finite(row.secondary_pressure_pa)
    };
    let speed = Some(row.engine_speed_rad_s).filter(|_| is_known);
    [ratio, speed, torque_nm, pressure_pa, Some(row.sump_k)]
}
