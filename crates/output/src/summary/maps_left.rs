//! Measured maps that a drive left: outside its grid a map is clamped to its edge, which is not a measurement.

use serde::{Deserialize, Serialize};

use super::{Driven, Summary};
use crate::number::finite;
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::loss_map_axes;
use cvtcycle_model::drive::{Conditions, Row, drive_into};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::keys::Quantity;
use cvtcycle_model::maps::LossMap;
use cvtcycle_model::math::GRID_AXES;
use cvtcycle_model::transmission::component::{Component, Part};

/// Share of the engine-on time from which leaving a map is a headline.
const LARGE: f64 = 0.1;

/// A map that was left for a large part of a drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapLeft {
    /// As the vehicle's file names it.
    pub file: String,
    /// Share of the engine-on time, per cent.
    pub percent: f64,
    /// Column whose range was left for the longest time.
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
    if transmission.maps().next().is_none() || !is_left(totals.seconds(Flags::OUTSIDE_VALIDITY)) {
        return Vec::new();
    }
    let maps: Vec<(Component, &LossMap)> = transmission.maps().collect();
    let mut times = vec![TimeOutside::default(); maps.len()];
    let mut see = |rows: &[Row]| {
        for ((component, map), left) in maps.iter().zip(&mut times) {
            left.add(rows, *component, map);
        }
    };
    match driven.outcome.rows.as_slice() {
        [] => drop(drive_into(driven.setup, cycle, conditions, Some(&mut see))),
        rows => see(rows),
    }
    let of_map = |((component, map), left): (&(Component, &LossMap), &TimeOutside)| {
        let (axis, side, _) = left.longest_departure()?;
        let values = map.grid().axes()[axis].as_slice();
        let is_box = component.part() == Part::BoxMap;
        let column = match (axis, is_box) {
            (2, true) => "input_torque_nm",
            _ => loss_map_axes(transmission.is_cvt())[axis],
        };
        let end = [values.first(), values.last()][side].copied();
        is_left(left.any_s).then(|| MapLeft {
            file: file(driven, *component),
            percent: 100.0 * left.any_s / running_s,
            column: column.to_owned(),
            side: ["below", "above"][side].to_owned(),
            end: end.and_then(|si| finite(Quantity::from_key(column).from_si(si))),
        })
    };
    maps.iter().zip(&times).filter_map(of_map).collect()
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
    sides_s: [[f64; 2]; GRID_AXES],
}

impl TimeOutside {
    fn add(&mut self, rows: &[Row], component: Component, map: &LossMap) {
        for row in rows.iter().filter(|row| !row.flags.any(Flags::ENGINE_OFF)) {
            let mut is_left = false;
            let axes = map.grid().axes().iter().zip(at(row, component));
            for ((axis, x), sides_s) in axes.zip(&mut self.sides_s) {
                let (Some(x), [first, .., last]) = (x, axis.as_slice()) else {
                    continue;
                };
                for (is_out, side_s) in [x < *first, x > *last].into_iter().zip(sides_s) {
                    *side_s += if is_out { row.dt_s } else { 0.0 };
                    is_left |= is_out;
                }
            }
            self.any_s += if is_left { row.dt_s } else { 0.0 };
        }
    }

    /// Axis, side and time of the longest departure.
    fn longest_departure(&self) -> Option<(usize, usize, f64)> {
        let all = self.sides_s.iter().enumerate();
        let all = all.flat_map(|(axis, sides)| [(axis, 0, sides[0]), (axis, 1, sides[1])]);
        all.max_by(|a, b| a.2.total_cmp(&b.2))
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
