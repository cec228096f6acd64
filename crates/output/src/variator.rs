//! Tables of the variator rig: one row a point, and one row a curve.

use std::io::{self, Write};

use cvtcycle_model::rig::variator::{CurveSummary, Held, Resolution, VariatorRig, VariatorRow};
use serde_json::json;

use crate::columns;
use crate::files::Summing;
use crate::number::fixed;
use crate::record::Manifest;
use crate::rig::given;
use crate::table::{Cell, Column, json_columns, json_rows, write_csv, write_json};
use crate::trace::{bar, degc};
use cvtcycle_model::keys::rpm;

/// Version of the JSON object.
const SCHEMA: u32 = 1;
/// Maximum default torque over the torque capacity.
const MAX_TORQUE: f64 = 1.1;

/// One curve with its points.
#[derive(Debug)]
pub struct Curve {
    /// Breakpoint, capacity and slip of the curve.
    pub summary: CurveSummary,
    /// Resolution of the speed sensors.
    pub resolution: Resolution,
    /// Points by torque.
    pub rows: Vec<VariatorRow>,
}

impl Curve {
    /// Solves a curve, by default from zero torque to beyond the torque capacity. `pulses` is the number of pulses of the speed sensors a turn.
    pub fn solve(rig: &VariatorRig, held: &Held, torque_nm: Option<&[f64]>, pulses: f64) -> Self {
        let summary = rig.summary(held);
        let rows = match torque_nm {
            Some(torques) => rig.rows(held, torques),
            None => rig.rows(held, &default_torques(held, summary.capacity_nm)),
        };
        let (belt, idle) = (&rig.cvt().belt, &rig.rows(held, &[0.0])[0]);
        Curve {
            summary,
            resolution: Resolution::new(idle, belt.length_m, belt.segment_thickness_m, pulses),
            rows,
        }
    }

    /// Secondary pressure, bar, without the rounding errors of its conversion.
    pub fn bar(&self) -> f64 {
        (self.summary.held.pressure_pa / 1e5 * 1e6).round() / 1e6
    }

    /// True if two curves differ in pressure only.
    pub fn is_same_test(&self, other: &Curve) -> bool {
        let key = |curve: &Curve| {
            let held = &curve.summary.held;
            [held.ratio, held.input_rad_s, held.belt_k].map(f64::to_bits)
        };
        key(self) == key(other)
    }

    /// Ratio, speed and temperature in words.
    pub fn test_name(&self) -> String {
        let held = &self.summary.held;
        let ratio = fixed(held.ratio, 3);
        let ratio = ratio.trim_end_matches('0').trim_end_matches('.');
        let (rpm, degc) = (fixed(rpm(held.input_rad_s), 0), fixed(degc(held.belt_k), 1));
        format!(
            "ratio {ratio}, {rpm} rpm, belt {} \u{b0}C",
            degc.trim_end_matches(".0")
        )
    }
}

/// Default torques, from zero to beyond the torque capacity, Nm.
fn default_torques(held: &Held, capacity_nm: f64) -> Vec<f64> {
    let step = if held.ratio > 1.0 { 5.0 } else { 2.0 };
    let count = (MAX_TORQUE * capacity_nm / step).ceil().clamp(1.0, 1000.0) as u32;
    (0..=count).map(|i| step * f64::from(i)).collect()
}

/// Curves of the rig, and their inputs.
#[derive(Debug)]
pub struct VariatorCurves {
    /// Name of the vehicle.
    pub vehicle: String,
    /// Name of its transmission oil.
    pub lubricant: String,
    /// Name of the belt model.
    pub formulation: String,
    /// Overrides of the vehicle, as the user wrote them.
    pub set: Vec<String>,
    /// Pulses of the speed sensors a turn.
    pub pulses: f64,
    /// The curves.
    pub curves: Vec<Curve>,
}

impl VariatorCurves {
    fn points(&self) -> impl Iterator<Item = &VariatorRow> {
        self.curves.iter().flat_map(|curve| &curve.rows)
    }

    fn numbers(&self) -> Vec<(CurveSummary, Resolution)> {
        let curves = self.curves.iter();
        curves
            .map(|curve| (curve.summary, curve.resolution))
            .collect()
    }

    /// Writes every point of every curve as CSV.
    ///
    /// # Errors
    /// I/O errors of `out`.
    pub fn write_points(&self, out: &mut dyn Write) -> io::Result<()> {
        write_csv(out, &point_columns(), self.points(), &[])
    }

    /// Writes a line for each curve as CSV.
    ///
    /// # Errors
    /// I/O errors of `out`.
    pub fn write_curves(&self, out: &mut dyn Write) -> io::Result<()> {
        write_csv(out, &curve_columns(), self.numbers(), &[])
    }

    /// Writes one JSON object, its points one a line.
    ///
    /// # Errors
    /// I/O errors of `out`.
    pub fn write_json(&self, out: &mut dyn Write) -> io::Result<()> {
        let columns = point_columns();
        let mut points = Summing::new(io::sink());
        self.write_points(&mut points)?;
        let rest = json!({
            "settings": {
                "vehicle": self.vehicle,
                "lubricant": self.lubricant,
                "formulation": self.formulation,
                "set": self.set,
                "pulses": self.pulses,
            },
            "curves": json_rows(&curve_columns(), &self.numbers()),
            "columns": json_columns(&columns),
            "count": self.points().count(),
        });
        let head = Manifest::new(SCHEMA).for_run(&(&rest, points.finish()));
        write_json(out, &head.with(&rest), &columns, self.points())
    }
}

/// Columns of the points, in output order.
fn point_columns() -> Vec<Column<VariatorRow>> {
    columns! { VariatorRow;
        number "belt_ratio", "-", "geometric belt ratio, held", r => r.held.ratio;
        number "secondary_pressure_bar", "bar", "secondary pressure, held", r => given(bar(r.held.pressure_pa));
        number "input_speed_rpm", "rpm", "primary speed, held", r => given(rpm(r.held.input_rad_s));
        number "belt_temp_degc", "degC", "belt temperature, held", r => given(degc(r.held.belt_k));
        number "output_torque_nm", "Nm", "torque at the secondary pulley", r => r.output_nm;
        number "slip_percent", "%", "belt slip: speed lost against the geometric ratio", r => 100.0 * r.belt.losses.slip_total;
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
        number "belt_loss_nm", "Nm", "all belt losses, torque at the primary", r => r.belt.losses.sum_nm();
        number "segment_compression_n", "N", "compression between segments; zero at the breakpoint", r => r.belt.tension.compression_n;
        number "active_segments", "-", "segments that carry, of the branch in force, real-valued", r => r.belt.slip.active_segments;
        number "capacity_nm", "Nm", "torque at the secondary that the clamping forces carry", r => r.belt.losses.capacity_nm;
        words "flags", "", "gross slip, and departures from the rig's limits (Table 6-1)", r => Cell::Names(r.flags.names().collect());
    }
}

/// Columns of the curves, in output order.
fn curve_columns() -> Vec<Column<(CurveSummary, Resolution)>> {
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
