//! Bearings of the pulley shafts under the pull of the belt, and what the secondary's shaft drags without it.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PB-1 | both shafts: F_rad = 2 (F_p tan th/beta_p + F_s tan th/beta_s) cos alpha, cos alpha = free strut / centre distance | derived: pull of both strands, 2 Tm - \|C_x\| - 2 m v2 with Tm of TE-7; what torque and speed add cancels |
//! | PB-3 | at the secondary without load: T = c0 + c1 (nu/nu_80)^m n/1000 rpm, the second term by FH-1; m and the heating are those of IS-1 | form: IS-1, as it is measured at the primary; c1 0 to 0.5 Nm per 1000 rpm: Palmgren (BR-1) gives 0.02 to 0.05 for two ball bearings of 65 mm, oil that belt and sheaves carry round ASSUMED to give the rest |
//! | PB-2 | T = mu_b F_rad d/2 on each shaft | source: SKF's estimate of bearing friction from load and bore; mu_b ASSUMED, 0.0008 to 0.0020 |
//!
//! F clamping forces N, beta wraps rad, th half wedge angle, alpha lean of the strands, d bore m. The rest of the strands' pull across the line of
//! centres, (T1 - T2 -+ C_x) sin alpha, turns the sum by less than a tenth of a percent of its size and is left out. Friction without load
//! is IS-1's at the primary.

use super::variator::{Belt, BeltAtRatio};
use crate::keys::{Values, keys};
use crate::math::{Gather, Real, physics};
use crate::transmission::viscous_self_heating::ViscousSelfHeating;

/// The checked bearings.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct PulleyBearing<R: Real = f64> {
    /// Friction at the bore.
    pub friction: R,
    /// Bore on the shafts of primary and secondary, m.
    pub bore_m: [R; 2],
    /// Torque of the secondary's shaft without load, Nm.
    pub idle_nm: R,
    /// Slope of that torque over speed at reference viscosity, Nm s/rad.
    pub idle_nm_s: R,
}

#[physics]
impl<R: Real> PulleyBearing<R> {
    /// Radial force on each shaft per clamping force of the secondary (PB-1).
    pub fn pull_per_clamp(belt: &Belt<R>, at: &BeltAtRatio<R>) -> R {
        let lean = at.geometry.strut_m / belt.centre_distance_m;
        2.0 * belt.tan_wedge * at.prepared.clamps_per_wrap * lean // PB-1
    }

    /// Torque on the shaft of the primary (0) or the secondary (1) under a radial force, Nm (PB-2).
    pub fn torque_nm(&self, pulley: usize, pull_n: R) -> R {
        self.friction * pull_n * (0.5 * self.bore_m[pulley]) // PB-2
    }

    /// Torque of the secondary's shaft without load, Nm, at its speed, rad/s, with the power (nu/nu_80)^m and the heating of the input shaft
    /// (PB-3).
    pub fn idle_nm(&self, power: R, heating: &ViscousSelfHeating<R>, secondary_rad_s: R) -> R {
        let viscous_nm = self.idle_nm_s * power * secondary_rad_s;
        self.idle_nm + heating.torque_nm(viscous_nm, secondary_rad_s) // PB-3
    }
}

keys! {
    /// Keys of `[transmission.cvt.pulley_bearing]`.
    BEARING: PulleyBearingKeys = "pulley_bearing" [] {
        friction: or(0.0015, number(0.0, 0.01)), "friction under load, at the bore", ["PB-2"];
        primary_bore_mm: or(45.0, number(5.0, 300.0)), "bore of the bearings on the primary's shaft", ["PB-2"];
        secondary_bore_mm: or(45.0, number(5.0, 300.0)), "bore of the bearings on the secondary's shaft", ["PB-2"];
        secondary_nm: or(0.0, number(0.0, 10.0)), "torque of the secondary's shaft without load and speed", ["PB-3"];
        secondary_nm_per_rpm: or(0.0, number(0.0, 0.01)), "its slope over the secondary's speed at 11 mm2/s", ["PB-3"];
    }
}

impl PulleyBearing {
    /// The bearings from the values of their table.
    pub(super) fn from_values<V: Values>(s: &V) -> Self {
        PulleyBearing {
            friction: s.number(&BEARING.friction),
            bore_m: [
                s.number(&BEARING.primary_bore_mm),
                s.number(&BEARING.secondary_bore_mm),
            ],
            idle_nm: s.number(&BEARING.secondary_nm),
            idle_nm_s: s.number(&BEARING.secondary_nm_per_rpm),
        }
    }
}
