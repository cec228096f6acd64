//! The tables of the variator rig: a row a point, and a row a curve.

use cvtcycle_model::bench::variator::{CurveSummary, Resolution, VariatorRow};

use crate::columns;
use crate::table::{Cell, Column};
use crate::trace::{bar, degc, rpm};

/// What the user gave, without the rounding of its way to SI and back.
fn given(x: f64) -> f64 {
    (x * 1e9).round() / 1e9
}

/// Columns of the points, in the order in which they are written.
#[must_use]
pub fn point_columns() -> Vec<Column<VariatorRow>> {
    columns! { VariatorRow;
        number "belt_ratio", "-", "geometric belt ratio, held", r => r.held.ratio;
        number "secondary_pressure_bar", "bar", "secondary pressure, held", r => given(bar(r.held.pressure_pa));
        number "input_speed_rpm", "rpm", "primary speed, held", r => given(rpm(r.held.input_rad_s));
        number "belt_temp_degc", "degC", "belt temperature, held", r => given(degc(r.held.belt_k));
        number "output_torque_nm", "Nm", "torque at the secondary pulley", r => r.output_nm;
        number "slip_percent", "%", "belt slip: speed lost against the geometric ratio", r => 100.0 * r.belt.slip_total;
        number "slip_reading_percent", "%", "pulse ratio over geometric ratio, less one", r => 100.0 * r.slip_reading();
        number "slip_zeroed_percent", "%", "pulse ratio over that at zero torque, less one: as the thesis zeroes it", r => 100.0 * r.slip_zeroed();
        number "primary_slip_m_s", "m/s", "primary surface speed less belt speed", r => r.slip_m_s()[0];
        number "secondary_slip_m_s", "m/s", "belt speed less secondary surface speed; negative where the pulley runs ahead", r => r.slip_m_s()[1];
        number "primary_slip_zeroed_m_s", "m/s", "the same with the radii of zero torque", r => r.slip_zeroed_m_s()[0];
        number "secondary_slip_zeroed_m_s", "m/s", "the same with the radii of zero torque", r => r.slip_zeroed_m_s()[1];
        number "primary_radius_mm", "mm", "geometric running radius at the primary", r => 1e3 * r.geometry.primary_radius_m;
        number "secondary_radius_mm", "mm", "geometric running radius at the secondary", r => 1e3 * r.geometry.secondary_radius_m;
        number "primary_pulse_radius_mm", "mm", "belt speed over primary speed", r => 1e3 * r.pulse_radius_m()[0];
        number "secondary_pulse_radius_mm", "mm", "belt speed over secondary speed", r => 1e3 * r.pulse_radius_m()[1];
        number "primary_zeroed_radius_mm", "mm", "geometric radius for the pulse ratio at zero torque", r => 1e3 * r.zero.radius_m[0];
        number "secondary_zeroed_radius_mm", "mm", "geometric radius for the pulse ratio at zero torque", r => 1e3 * r.zero.radius_m[1];
        number "belt_speed_m_s", "m/s", "speed of the belt", r => r.belt_m_s;
        number "output_speed_rpm", "rpm", "secondary speed", r => rpm(r.shaft_rad_s[1]);
        number "input_torque_nm", "Nm", "torque at the primary pulley", r => r.belt.input_torque_nm;
        number "belt_loss_nm", "Nm", "all belt losses, torque at the primary", r => r.belt.loss_nm();
        number "segment_compression_n", "N", "compression between segments; zero at the breakpoint", r => r.belt.tension.compression_n;
        number "active_segments", "-", "segments that carry, of the branch in force, real-valued", r => r.belt.slip.active_segments;
        number "capacity_nm", "Nm", "torque at the secondary that the clamping forces carry", r => r.belt.capacity_nm;
        words "flags", "", "gross slip, and departures from the rig's limits (Table 6-1)", r => Cell::Names(r.flags.names().collect());
    }
}

/// Columns of the curves, in the order in which they are written.
#[must_use]
pub fn curve_columns() -> Vec<Column<(CurveSummary, Resolution)>> {
    columns! { (CurveSummary, Resolution);
        number "belt_ratio", "", "", (s, _) => s.held.ratio;
        number "secondary_pressure_bar", "", "", (s, _) => given(bar(s.held.pressure_pa));
        number "input_speed_rpm", "", "", (s, _) => given(rpm(s.held.input_rad_s));
        number "belt_temp_degc", "", "", (s, _) => given(degc(s.held.belt_k));
        number "breakpoint_nm", "", "", (s, _) => s.breakpoint_nm;
        number "capacity_nm", "", "", (s, _) => s.capacity_nm;
        number "slip_at_zero_percent", "", "", (s, _) => 100.0 * s.slip_at_zero;
        number "slip_at_breakpoint_percent", "", "", (s, _) => 100.0 * s.slip_at_breakpoint;
        number "slip_at_capacity_percent", "", "", (s, _) => 100.0 * s.slip_at_capacity;
        number "most_slip_percent", "", "", (s, _) => 100.0 * s.most_slip;
        number "most_slip_torque_nm", "", "", (s, _) => s.most_slip_nm;
        number "most_primary_slip_m_s", "", "", (s, _) => s.most_slip_m_s[0];
        number "most_secondary_slip_m_s", "", "", (s, _) => s.most_slip_m_s[1];
        number "three_percent_torque_nm", "", "", (s, _) => s.three_percent_nm;
        number "three_percent_primary_slip_m_s", "", "", (s, _) => s.three_percent_m_s[0];
        number "three_percent_secondary_slip_m_s", "", "", (s, _) => s.three_percent_m_s[1];
        number "linearity_to_three_percent_r2", "", "", (s, _) => s.measured_r2;
        number "linearity_to_capacity_r2", "", "", (s, _) => s.capacity_r2;
        number "gate_s", "", "", (_, r) => r.gate_s;
        number "gate_segments", "", "", (_, r) => r.segments;
        number "gate_primary_turns", "", "", (_, r) => r.turns[0];
        number "gate_secondary_turns", "", "", (_, r) => r.turns[1];
        number "slip_per_primary_pulse_percent", "", "", (_, r) => 100.0 * r.slip_per_pulse[0];
        number "slip_per_secondary_pulse_percent", "", "", (_, r) => 100.0 * r.slip_per_pulse[1];
        number "belt_speed_per_segment_percent", "", "", (_, r) => 100.0 * r.belt_per_segment;
    }
}
