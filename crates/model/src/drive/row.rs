//! One row: everything that is known about one time step.

use crate::flags::Flags;
use crate::transmission::component::ByComponent;

/// One time step: means over the step that ends at `time_s`; temperatures are those at its end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// End of the step, s from the start of the cycle.
    pub time_s: f64,
    /// Length of the step, s.
    pub dt_s: f64,
    /// Index into the cycle's phases.
    pub phase: u16,
    /// Mean vehicle speed, m/s.
    pub speed_m_s: f64,
    /// Vehicle acceleration, m/s2.
    pub accel_m_s2: f64,
    /// Distance in the step, m.
    pub distance_m: f64,
    /// Demanded mean torque at the driven wheels, Nm.
    pub wheel_torque_nm: f64,
    /// Demanded mean power at the driven wheels, W.
    pub wheel_power_w: f64,
    /// Demanded work in the drive parts of the step, J, never negative.
    pub wheel_work_positive_j: f64,
    /// Demanded work in the braking parts of the step, J, never positive.
    pub wheel_work_negative_j: f64,
    /// Power that could not be delivered, W.
    pub deficit_w: f64,
    /// Engine speed, rad/s.
    pub engine_speed_rad_s: f64,
    /// Torque at the flywheel into the transmission, without rotating inertia, Nm.
    pub engine_torque_nm: f64,
    /// Engine torque with accessories, without inertia, over full-load torque at that speed, 0..1.
    pub throttle: f64,
    /// Gear of a manual box; 0 neutral or CVT.
    pub gear: u8,
    /// Belt ratio I = R_sec / R_pri (thesis eq. 5); NaN for a manual box.
    pub belt_ratio: f64,
    /// Engine speed over wheel speed; NaN at standstill.
    pub overall_ratio: f64,
    /// Primary pressure, Pa; NaN for a manual box.
    pub primary_pressure_pa: f64,
    /// Secondary pressure, Pa; NaN for a manual box.
    pub secondary_pressure_pa: f64,
    /// Belt slip as a fraction; NaN for a manual box.
    pub slip: f64,
    /// Torque capacity over torque of the belt; infinite at zero torque; NaN for a manual box.
    pub clamp_safety: f64,
    /// Loss power of each component, W, never negative.
    pub loss_w: ByComponent<f64>,
    /// Power of the accessories, W.
    pub accessories_w: f64,
    /// Power into the wheel brakes, W.
    pub brake_w: f64,
    /// Change of rotating kinetic energy of engine and transmission over the step length, W.
    pub kinetic_w: f64,
    /// Fuel mass flow, kg/s.
    pub fuel_kg_s: f64,
    /// Fuel power (lower heating value), W.
    pub fuel_power_w: f64,
    /// Heat into the engine's thermal nodes, W.
    pub engine_heat_w: f64,
    /// Heat and unburnt fuel into the exhaust, W.
    pub exhaust_w: f64,
    /// Coolant and block, K.
    pub coolant_k: f64,
    /// Engine oil, K.
    pub engine_oil_k: f64,
    /// Transmission oil in the sump, K.
    pub sump_k: f64,
    /// Transmission case and shafts, K.
    pub metal_k: f64,
    /// Belt, pulleys and the oil sprayed off them, K; NaN for a manual box.
    pub belt_spray_k: f64,
    /// Oil to the cooler, K; NaN without one.
    pub cooler_in_k: f64,
    /// Oil from the cooler, K; NaN without one.
    pub cooler_out_k: f64,
    /// Heat stored in the nodes, W.
    pub stored_w: f64,
    /// Heat given to the air, W.
    pub to_air_w: f64,
    /// Power ledger: |in - out| over the sum of absolute terms.
    pub power_ledger_error: f64,
    /// Heat ledger: |in - stored - to air| over the sum of absolute terms.
    pub heat_ledger_error: f64,
    /// What the implicit solve left, as a fraction of full-load torque.
    pub solve_residual: f64,
    /// Evaluations of the driveline that the implicit solve needed.
    pub iterations: u16,
    /// States and departures from validity.
    pub flags: Flags,
}
