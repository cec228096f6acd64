//! Interface of the machine that drives a transmission.

/// Share of full load above which a prime mover is asked for more than it can give, with a margin for what a solve leaves: an engine
/// that cannot turn its own pump and accessories in the cold. Such rows are flagged outside validity.
pub const FULL_LOAD_LIMIT: f64 = 1.0 + 1e-5;

use crate::math::Real;

/// An engine or motor at its temperature and altitude; speeds in rad/s at its shaft, torques in Nm.
pub trait PrimeMover<R: Real = f64> {
    /// Idle speed.
    fn idle_rad_s(&self) -> R;
    /// Highest speed.
    fn max_rad_s(&self) -> R;
    /// Rated power, W.
    fn rated_w(&self) -> R;
    /// Power that the warm machine in the reference air has at full load where this one has `power_w`, at a speed, W.
    fn warm_power_w(&self, power_w: R, speed_rad_s: R) -> R;
    /// Full-load torque at a speed.
    fn full_load_nm(&self, speed_rad_s: R) -> R;
    /// Torque of the accessories at a speed.
    fn accessories_nm(&self, speed_rad_s: R) -> R;
    /// Drag torque at a speed without fuel, positive.
    fn drag_nm(&self, speed_rad_s: R) -> R;
    /// Largest acceleration of the free shaft, rad/s2.
    fn max_accel_rad_s2(&self) -> R;

    /// Rotating energy at a speed, J.
    fn rotating_j(&self, speed_rad_s: R) -> R;
    /// Speed to which the shaft falls from another in `dt_s` with a load on it and no fuel.
    fn slowed_rad_s(&self, from_rad_s: R, load_nm: R, dt_s: f64) -> R;
}
