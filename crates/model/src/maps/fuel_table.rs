//! Points of a fuel map in SI units as a file has them, whatever its quantities are: load as mean effective pressure, torque or power; fuel as flow, for
//! work, for a working stroke, or as efficiency.

use std::f64::consts::PI;

use super::NoMap;
use crate::math::rad_s;

/// Share by which the swept volume of a table may differ from that of the engine that was measured. ASSUMED: volumes in litres with one decimal, 1.5 for
/// 1.46 to 1.54.
const SAME_VOLUME: f64 = 0.03;
/// Swept volumes that the key `measured_cc` may have, m3.
const VOLUMES_M3: std::ops::RangeInclusive<f64> = 200e-6..=20_000e-6;

/// Slowest engine, rpm: rows of a table at rest and below it belong to no running engine.
const SLOWEST_RPM: f64 = 100.0;

/// Quantity of the load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    /// Brake mean effective pressure, Pa.
    Bmep,
    /// Torque, Nm.
    Torque,
    /// Power, W.
    Power,
}

/// Quantity of the fuel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fuel {
    /// Flow, kg/s.
    Flow,
    /// Specific consumption, kg/J.
    PerWork,
    /// Mass for a working stroke of one cylinder, kg.
    PerStroke,
    /// Brake efficiency.
    Efficiency,
}

/// The engine that was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// Lower heating value, J/kg.
    pub heating_value_j_kg: f64,
    /// Swept volume, m3.
    pub displacement_m3: f64,
    /// Number of cylinders, where it is known.
    pub cylinders: Option<f64>,
}

/// One row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuelRow {
    /// Speed, rad/s.
    pub speed_rad_s: f64,
    /// Load.
    pub load: f64,
    /// Fuel.
    pub fuel: f64,
    /// Line of the file.
    pub line: usize,
}

/// Swept volume that two columns of a load give.
#[derive(Clone, Debug, PartialEq)]
pub struct Swept {
    /// Torque over mean effective pressure, times 4 pi, m3.
    pub volume_m3: f64,
    /// Share of it by which the rounding of the numbers may have moved it.
    pub rounding: f64,
    /// Names of the load and of the mean effective pressure in the file.
    pub columns: [String; 2],
    /// Text by which the key of the file says that only the first of them is meant.
    pub choice: String,
}

/// A table as a file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct FuelTable {
    /// Name of the file.
    pub file: String,
    /// How it was read, in words, where it is not written as the program's own are.
    pub read_as: Option<String>,
    /// Quantity of the load.
    pub load: Load,
    /// Quantity of the fuel.
    pub fuel: Fuel,
    /// Swept volumes, where the file says the load twice.
    pub swept: Vec<Swept>,
    /// The rows.
    pub rows: Vec<FuelRow>,
}

/// A point of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Speed, rad/s.
    pub speed_rad_s: f64,
    /// Brake mean effective pressure, Pa.
    pub bmep_pa: f64,
    /// Fuel mean effective pressure, Pa.
    pub fuel_pa: f64,
    /// Line of the file.
    pub line: usize,
}

/// Points, and how many rows were left out, with the first line of one.
type Points = (Vec<Point>, Option<(usize, usize)>);

impl FuelTable {
    /// The points that have a meaning: rows slower than an engine runs, cells that are no number, and a consumption for no work at no load are left out.
    pub(super) fn points(&self, basis: &Basis) -> Result<Points, NoMap> {
        let mut left_out: Option<(usize, usize)> = None;
        let mut points = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            match self.point(row, basis)? {
                Some(point) => points.push(point),
                None => {
                    let (count, first) = left_out.unwrap_or((0, row.line));
                    left_out = Some((count + 1, first));
                }
            }
        }
        Ok((points, left_out))
    }

    /// Refuses a table whose columns are of another swept volume than the engine that was measured: they leave open by which of the two its loads are to be
    /// read, and these differ as the volumes do.
    pub(super) fn check_volume(&self, basis: &Basis) -> Result<(), NoMap> {
        let own = basis.displacement_m3;
        let differs =
            |swept: &&Swept| (swept.volume_m3 / own - 1.0).abs() > SAME_VOLUME + swept.rounding;
        let Some(swept) = self.swept.iter().find(differs) else {
            return Ok(());
        };
        let [torque, pressure] = &swept.columns;
        let cc = swept.volume_m3 * 1e6;
        let message = format!(
            "{torque} over {pressure} in {} is a swept volume of {cc:.0} cc, and the engine that was measured has {:.0} cc (measured_cc, or where it is absent displacement_cc of the car)",
            self.file,
            own * 1e6
        );
        let choice = format!(
            "or say that only {torque} is right: {{ value = \"FILE\", {} }}",
            swept.choice
        );
        let hint = match VOLUMES_M3.contains(&swept.volume_m3) {
            true => format!("write measured_cc = {cc:.0} next to the file, {choice}"),
            false => format!("correct the unit of one of the columns, {choice}"),
        };
        Err(NoMap::new("one swept volume within 3 %", message, &hint))
    }

    fn point(&self, row: &FuelRow, basis: &Basis) -> Result<Option<Point>, NoMap> {
        let FuelRow {
            speed_rad_s,
            load,
            fuel,
            line,
        } = *row;
        let is_number = [speed_rad_s, load, fuel].iter().all(|x| x.is_finite());
        if !is_number || speed_rad_s < rad_s(SLOWEST_RPM) {
            return Ok(None);
        }
        let per_torque = 4.0 * PI / basis.displacement_m3;
        let bmep_pa = match self.load {
            Load::Bmep => load,
            Load::Torque => load * per_torque,
            Load::Power => load / speed_rad_s * per_torque,
        };
        let of_work = matches!(self.fuel, Fuel::PerWork | Fuel::Efficiency);
        if of_work && bmep_pa < 0.0 {
            return Err(NoMap::new(
                "loads above zero",
                format!(
                    "specific consumption has no meaning at {:.3} bar, where the engine gives no power (line {line})",
                    bmep_pa / 1e5
                ),
                "leave these rows out, or give the flow of fuel (fuel_g_s), which loads of zero and below have too",
            ));
        }
        if of_work && (bmep_pa <= 0.0 || fuel <= 0.0) {
            return Ok(None);
        }
        let per_flow = basis.heating_value_j_kg * 4.0 * PI / basis.displacement_m3;
        let fuel_pa = match self.fuel {
            Fuel::Flow => fuel / speed_rad_s * per_flow, // BM-1
            Fuel::PerWork => fuel * bmep_pa * basis.heating_value_j_kg, // BM-1
            Fuel::Efficiency => bmep_pa / fuel,          // BM-1
            Fuel::PerStroke => {
                let Some(cylinders) = basis.cylinders else {
                    return Err(NoMap::new(
                        "measured_cylinders next to the file",
                        "fuel for a stroke is no flow without the number of cylinders".to_owned(),
                        "add measured_cylinders = 4, or what the measured engine has",
                    ));
                };
                fuel * cylinders * basis.heating_value_j_kg / basis.displacement_m3 // BM-1
            }
        };
        Ok(Some(Point {
            speed_rad_s,
            bmep_pa,
            fuel_pa,
            line,
        }))
    }
}
