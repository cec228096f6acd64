//! The columns of a trace: one table for every format that writes rows, and for the plots.
//!
//! Rows are in SI units; this table is where they become engineer's units.
use std::f64::consts::PI;

use super::{Component, Flags, Row};

/// One cell of a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A real number; NaN and infinities mean that there is no value.
    Number(f64),
    /// A whole number.
    Count(u32),
    /// A fixed word.
    Text(&'static str),
    /// Index into the phase names of the cycle: the row does not hold the name itself.
    Phase(u16),
    /// A bit set, written as names joined by `|`.
    Flags(Flags),
}

impl Value {
    #[inline]
    fn number(self) -> f64 {
        match self {
            Value::Number(x) => x,
            Value::Count(n) => f64::from(n),
            Value::Phase(n) => f64::from(n),
            Value::Text(_) | Value::Flags(_) => f64::NAN,
        }
    }
}

/// The runs in whose trace a column stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Every run.
    Always,
    /// Runs with a belt.
    Cvt,
    /// Runs with a manual box.
    Manual,
    /// Runs that have this component.
    Has(Component),
}

/// One column of the trace.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Name in the header, ending in its unit where it has one.
    pub name: &'static str,
    /// Unit; empty for words, counts and flags, `-` for plain ratios.
    pub unit: &'static str,
    /// What it holds, one phrase.
    pub doc: &'static str,
    /// The runs that have it.
    pub scope: Scope,
    /// Its cell in a row.
    pub get: fn(&Row) -> Value,
    /// Appends the numbers of some rows, each as [`Column::number`] has it: one call for many cells.
    pub numbers: fn(&[Row], &mut Vec<f64>),
}

impl Column {
    /// The number in a row; NaN where the cell is none.
    #[must_use]
    pub fn number(&self, row: &Row) -> f64 {
        (self.get)(row).number()
    }
}

/// The columns of a run, in the order of the table.
#[must_use]
pub fn columns_for(cvt: bool, components: &[Component]) -> Vec<&'static Column> {
    let wanted = |column: &&Column| match column.scope {
        Scope::Always => true,
        Scope::Cvt => cvt,
        Scope::Manual => !cvt,
        Scope::Has(component) => components.contains(&component),
    };
    COLUMNS.iter().filter(wanted).collect()
}

/// The column of that name.
#[must_use]
pub fn column(name: &str) -> Option<&'static Column> {
    COLUMNS.iter().find(|column| column.name == name)
}

/// The column of a component's loss power.
#[must_use]
pub fn loss_column(component: Component) -> Option<&'static Column> {
    COLUMNS
        .iter()
        .find(|column| column.scope == Scope::Has(component))
}

fn kmh(speed_m_s: f64) -> f64 {
    speed_m_s * 3.6
}

fn rpm(speed_rad_s: f64) -> f64 {
    speed_rad_s * 30.0 / PI
}

fn bar(pressure_pa: f64) -> f64 {
    pressure_pa / 1e5
}

fn degc(temperature_k: f64) -> f64 {
    temperature_k - 273.15
}

macro_rules! columns {
    ($($name:literal, $unit:literal, $scope:expr, $doc:literal, $row:ident => $value:expr;)*) => {
        /// Every column that a trace can have, in the order in which they are written.
        pub static COLUMNS: &[Column] = &[$(Column {
            name: $name,
            unit: $unit,
            doc: $doc,
            scope: $scope,
            get: |$row: &Row| $value,
            numbers: |rows: &[Row], into: &mut Vec<f64>| into.extend(rows.iter().map(|$row: &Row| $value.number())),
        }),*];
    };
}

macro_rules! loss {
    ($row:ident, $component:ident) => {
        Value::Number($row.loss_w[Component::$component as usize])
    };
}

use Scope::{Always, Cvt, Has, Manual};
use Value::{Count, Number, Phase};

columns! {
    "time_s", "s", Always, "end of the step, from the start of the cycle; every other column is the mean over the step that ends here, temperatures are those at its end", r => Number(r.time_s);
    "dt_s", "s", Always, "length of the step", r => Number(r.dt_s);
    "phase", "", Always, "phase of the cycle", r => Phase(r.phase);
    "speed_kmh", "km/h", Always, "vehicle speed, mean over the step that ends at time_s", r => Number(kmh(r.speed_m_s));
    "accel_m_s2", "m/s2", Always, "vehicle acceleration", r => Number(r.accel_m_s2);
    "wheel_torque_nm", "Nm", Always, "demanded torque at the driven wheels", r => Number(r.wheel_torque_nm);
    "wheel_power_w", "W", Always, "demanded power at the driven wheels", r => Number(r.wheel_power_w);
    "engine_speed_rpm", "rpm", Always, "engine speed", r => Number(rpm(r.engine_speed_rad_s));
    "engine_torque_nm", "Nm", Always, "torque at the flywheel into the transmission, without inertia", r => Number(r.engine_torque_nm);
    "throttle", "-", Always, "engine torque with accessories over full-load torque at that speed", r => Number(r.throttle);
    "gear", "", Manual, "gear; 0 is neutral", r => Count(u32::from(r.gear));
    "belt_ratio", "-", Cvt, "belt ratio, secondary over primary running radius", r => Number(r.belt_ratio);
    "overall_ratio", "-", Always, "engine speed over wheel speed; empty at standstill", r => Number(r.overall_ratio);
    "primary_pressure_bar", "bar", Cvt, "primary pulley pressure", r => Number(bar(r.primary_pressure_pa));
    "secondary_pressure_bar", "bar", Cvt, "secondary pulley pressure", r => Number(bar(r.secondary_pressure_pa));
    "slip_percent", "%", Cvt, "belt slip", r => Number(100.0 * r.slip);
    "clamp_safety", "-", Cvt, "torque capacity of the belt over its torque; empty at zero torque", r => Number(r.clamp_safety);
    "launch_clutch_loss_w", "W", Has(Component::LaunchClutch), "loss of launch clutch slip and creep", r => loss!(r, LaunchClutch);
    "pump_loss_w", "W", Has(Component::Pump), "loss of the oil pump", r => loss!(r, Pump);
    "input_shaft_loss_w", "W", Has(Component::InputShaft), "loss of the input shaft's bearings and seals", r => loss!(r, InputShaft);
    "clutch_drag_loss_w", "W", Has(Component::ClutchDrag), "drag of the open reverse clutch", r => loss!(r, ClutchDrag);
    "belt_band_loss_w", "W", Has(Component::BeltBand), "boundary friction between bands and between band and segments", r => loss!(r, BeltBand);
    "belt_film_loss_w", "W", Has(Component::BeltFilm), "viscous shear between the bands", r => loss!(r, BeltFilm);
    "belt_slip_loss_w", "W", Has(Component::BeltSlip), "sliding of the segments along the pulleys", r => loss!(r, BeltSlip);
    "belt_wedge_loss_w", "W", Has(Component::BeltWedge), "wedging at pulley entry and exit", r => loss!(r, BeltWedge);
    "belt_penetration_loss_w", "W", Has(Component::BeltPenetration), "penetration into the deflected pulleys", r => loss!(r, BeltPenetration);
    "belt_map_loss_w", "W", Has(Component::BeltMap), "loss of the whole belt, from its measured map", r => loss!(r, BeltMap);
    "final_drive_loss_w", "W", Has(Component::FinalDrive), "loss of the final drive of the CVT", r => loss!(r, FinalDrive);
    "gear_mesh_loss_w", "W", Has(Component::GearMesh), "gear mesh loss of the manual box, with its final drive", r => loss!(r, GearMesh);
    "bearing_loss_w", "W", Has(Component::Bearing), "bearing loss of the manual box", r => loss!(r, Bearing);
    "churning_loss_w", "W", Has(Component::Churning), "churning loss of the manual box", r => loss!(r, Churning);
    "seal_loss_w", "W", Has(Component::Seal), "seal loss of the manual box", r => loss!(r, Seal);
    "box_map_loss_w", "W", Has(Component::BoxMap), "loss of the whole manual box, from its measured map", r => loss!(r, BoxMap);
    "accessories_w", "W", Always, "power of the accessories", r => Number(r.accessories_w);
    "brake_w", "W", Always, "power into the wheel brakes", r => Number(r.brake_w);
    "kinetic_w", "W", Always, "change of the rotating kinetic energy of engine and transmission", r => Number(r.kinetic_w);
    "deficit_w", "W", Always, "power that could not be delivered", r => Number(r.deficit_w);
    "fuel_g_s", "g/s", Always, "fuel mass flow", r => Number(1000.0 * r.fuel_kg_s);
    "fuel_power_w", "W", Always, "fuel power, lower heating value", r => Number(r.fuel_power_w);
    "engine_heat_w", "W", Always, "heat into the engine", r => Number(r.engine_heat_w);
    "exhaust_w", "W", Always, "heat and unburnt fuel into the exhaust", r => Number(r.exhaust_w);
    "coolant_degc", "degC", Always, "coolant and engine block at the end of the step", r => Number(degc(r.coolant_k));
    "engine_oil_degc", "degC", Always, "engine oil at the end of the step", r => Number(degc(r.engine_oil_k));
    "transmission_sump_degc", "degC", Always, "transmission oil in the sump at the end of the step", r => Number(degc(r.sump_k));
    "transmission_metal_degc", "degC", Always, "transmission case and shafts at the end of the step", r => Number(degc(r.metal_k));
    "belt_spray_degc", "degC", Cvt, "belt, pulleys and the oil sprayed off them at the end of the step", r => Number(degc(r.belt_spray_k));
    "cooler_in_degc", "degC", Always, "oil to the cooler; empty without one", r => Number(degc(r.cooler_in_k));
    "cooler_out_degc", "degC", Always, "oil from the cooler; empty without one", r => Number(degc(r.cooler_out_k));
    "stored_w", "W", Always, "heat stored in the thermal nodes", r => Number(r.stored_w);
    "to_air_w", "W", Always, "heat given to the air", r => Number(r.to_air_w);
    "power_ledger_error", "-", Always, "power ledger: |in - out| over the sum of absolute terms", r => Number(r.power_ledger_error);
    "heat_ledger_error", "-", Always, "heat ledger: |in - stored - to air| over the sum of absolute terms", r => Number(r.heat_ledger_error);
    "solve_residual", "-", Always, "what the implicit solve left, as a fraction of full-load torque", r => Number(r.solve_residual);
    "iterations", "", Always, "driveline evaluations of the implicit solve", r => Count(u32::from(r.iterations));
    "flags", "", Always, "states and departures from validity", r => Value::Flags(r.flags);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_component_has_its_column_in_the_order_of_the_power_flow() {
        let names: Vec<_> = COLUMNS
            .iter()
            .filter_map(|c| match c.scope {
                Has(_) => Some(c.name.to_string()),
                _ => None,
            })
            .collect();
        let wanted: Vec<_> = Component::ALL
            .iter()
            .map(|c| format!("{}_loss_w", c.name()))
            .collect();
        assert_eq!(names, wanted);
        for component in Component::ALL {
            let mut row = Row::default();
            row.loss_w[component as usize] = 7.5;
            let sum: f64 = Component::ALL
                .iter()
                .map(|&c| loss_column(c).map_or(f64::NAN, |column| column.number(&row)))
                .sum();
            let own = loss_column(component).map_or(f64::NAN, |column| column.number(&row));
            assert!((own - 7.5).abs() < 1e-15 && (sum - 7.5).abs() < 1e-15);
        }
    }

    #[test]
    fn many_numbers_are_those_of_single_rows() {
        let row = |k: u8| Row {
            time_s: f64::from(k),
            phase: u16::from(k),
            gear: k,
            slip: f64::NAN,
            loss_w: [0.5; 16],
            ..Row::default()
        };
        let rows: Vec<Row> = (0..5).map(row).collect();
        for column in COLUMNS {
            let mut numbers = vec![7.0];
            (column.numbers)(&rows, &mut numbers);
            let single = rows.iter().map(|row| column.number(row).to_bits());
            assert!(
                numbers
                    .iter()
                    .map(|x| x.to_bits())
                    .eq([7.0_f64.to_bits()].into_iter().chain(single)),
                "{}",
                column.name
            );
        }
    }

    #[test]
    fn names_are_unique_and_end_in_their_unit() {
        for (i, column) in COLUMNS.iter().enumerate() {
            assert!(COLUMNS[..i].iter().all(|other| other.name != column.name));
            let suffix = match column.unit {
                "" | "-" => continue,
                "km/h" => "_kmh",
                "m/s2" => "_m_s2",
                "g/s" => "_g_s",
                "%" => "_percent",
                "degC" => "_degc",
                "Nm" => "_nm",
                "W" => "_w",
                unit => &format!("_{unit}"),
            };
            assert!(column.name.ends_with(suffix), "{}", column.name);
        }
    }
}
