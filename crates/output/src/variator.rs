//! The columns of the variator rig's rows, and the names of a curve's numbers.

use std::f64::consts::PI;

use cvtcycle_model::bench::variator::{CurveSummary, Resolution, VariatorRow};

/// One cell.
#[derive(Clone, Debug, PartialEq)]
pub enum VariatorValue {
    /// A number; NaN means none.
    Number(f64),
    /// A word.
    Text(String),
}

/// One column.
#[derive(Clone, Copy, Debug)]
pub struct VariatorColumn {
    /// Name, ending in its unit where it has one.
    pub name: &'static str,
    /// Unit; `-` for plain ratios, empty for words.
    pub unit: &'static str,
    /// What it holds, one phrase.
    pub doc: &'static str,
    /// Its cell in a row.
    pub get: fn(&VariatorRow) -> VariatorValue,
}

macro_rules! columns {
    ($($name:literal, $unit:literal, $doc:literal, $row:ident => $value:expr;)*) => {
        /// Every column, in the order in which they are written.
        pub static COLUMNS: &[VariatorColumn] = &[$(VariatorColumn {
            name: $name,
            unit: $unit,
            doc: $doc,
            get: |$row: &VariatorRow| $value,
        }),*];
    };
}

use VariatorValue::{Number, Text};

fn rpm(w: f64) -> f64 {
    w * 30.0 / PI
}

/// What the user gave, without the rounding of its way to SI and back.
fn given(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}

columns! {
    "belt_ratio", "-", "geometric belt ratio, held", r => Number(r.held.ratio);
    "secondary_pressure_bar", "bar", "secondary pressure, held", r => Number(given(r.held.pressure_pa / 1e5));
    "input_speed_rpm", "rpm", "primary speed, held", r => Number(given(rpm(r.held.input_rad_s)));
    "belt_temp_degc", "degC", "belt temperature, held", r => Number(given(r.held.belt_k - 273.15));
    "output_torque_nm", "Nm", "torque at the secondary pulley", r => Number(r.output_nm);
    "slip_percent", "%", "belt slip: speed lost against the geometric ratio", r => Number(100.0 * r.belt.slip_total);
    "slip_reading_percent", "%", "pulse ratio over geometric ratio, less one", r => Number(100.0 * r.slip_reading());
    "slip_zeroed_percent", "%", "pulse ratio over that at zero torque, less one: as the thesis zeroes it", r => Number(100.0 * r.slip_zeroed());
    "primary_slip_m_s", "m/s", "primary surface speed less belt speed", r => Number(r.slip_m_s()[0]);
    "secondary_slip_m_s", "m/s", "belt speed less secondary surface speed; negative where the pulley runs ahead", r => Number(r.slip_m_s()[1]);
    "primary_slip_zeroed_m_s", "m/s", "the same with the radii of zero torque", r => Number(r.slip_zeroed_m_s()[0]);
    "secondary_slip_zeroed_m_s", "m/s", "the same with the radii of zero torque", r => Number(r.slip_zeroed_m_s()[1]);
    "primary_radius_mm", "mm", "geometric running radius at the primary", r => Number(1e3 * r.geometry.primary_radius_m);
    "secondary_radius_mm", "mm", "geometric running radius at the secondary", r => Number(1e3 * r.geometry.secondary_radius_m);
    "primary_pulse_radius_mm", "mm", "belt speed over primary speed", r => Number(1e3 * r.pulse_radius_m()[0]);
    "secondary_pulse_radius_mm", "mm", "belt speed over secondary speed", r => Number(1e3 * r.pulse_radius_m()[1]);
    "primary_zeroed_radius_mm", "mm", "geometric radius for the pulse ratio at zero torque", r => Number(1e3 * r.zero.radius_m[0]);
    "secondary_zeroed_radius_mm", "mm", "geometric radius for the pulse ratio at zero torque", r => Number(1e3 * r.zero.radius_m[1]);
    "belt_speed_m_s", "m/s", "speed of the belt", r => Number(r.belt_m_s);
    "output_speed_rpm", "rpm", "secondary speed", r => Number(rpm(r.shaft_rad_s[1]));
    "input_torque_nm", "Nm", "torque at the primary pulley", r => Number(r.belt.input_torque_nm);
    "belt_loss_nm", "Nm", "all belt losses, torque at the primary", r => Number(r.belt.loss_nm());
    "segment_compression_n", "N", "compression between segments; zero at the breakpoint", r => Number(r.belt.tension.compression_n);
    "active_segments", "-", "segments that carry, of the branch in force, real-valued", r => Number(r.belt.slip.active_segments);
    "capacity_nm", "Nm", "torque at the secondary that the clamping forces carry", r => Number(r.belt.capacity_nm);
    "flags", "", "gross slip, and departures from the rig's limits (Table 6-1)", r => Text(r.flags.text());
}

/// The numbers of a curve under their names, in engineer's units; NaN means none.
#[must_use]
pub fn curve_numbers(s: &CurveSummary, r: &Resolution) -> Vec<(&'static str, f64)> {
    vec![
        ("belt_ratio", s.held.ratio),
        ("secondary_pressure_bar", given(s.held.pressure_pa / 1e5)),
        ("input_speed_rpm", given(rpm(s.held.input_rad_s))),
        ("belt_temp_degc", given(s.held.belt_k - 273.15)),
        ("breakpoint_nm", s.breakpoint_nm),
        ("capacity_nm", s.capacity_nm),
        ("slip_at_zero_percent", 100.0 * s.slip_at_zero),
        ("slip_at_breakpoint_percent", 100.0 * s.slip_at_breakpoint),
        ("slip_at_capacity_percent", 100.0 * s.slip_at_capacity),
        ("most_slip_percent", 100.0 * s.most_slip),
        ("most_slip_torque_nm", s.most_slip_nm),
        ("most_primary_slip_m_s", s.most_slip_m_s[0]),
        ("most_secondary_slip_m_s", s.most_slip_m_s[1]),
        ("three_percent_torque_nm", s.three_percent_nm),
        ("three_percent_primary_slip_m_s", s.three_percent_m_s[0]),
        ("three_percent_secondary_slip_m_s", s.three_percent_m_s[1]),
        ("linearity_to_three_percent_r2", s.measured_r2),
        ("linearity_to_capacity_r2", s.capacity_r2),
        ("gate_s", r.gate_s),
        ("gate_segments", r.segments),
        ("gate_primary_turns", r.turns[0]),
        ("gate_secondary_turns", r.turns[1]),
        (
            "slip_per_primary_pulse_percent",
            100.0 * r.slip_per_pulse[0],
        ),
        (
            "slip_per_secondary_pulse_percent",
            100.0 * r.slip_per_pulse[1],
        ),
        ("belt_speed_per_segment_percent", 100.0 * r.belt_per_segment),
    ]
}
