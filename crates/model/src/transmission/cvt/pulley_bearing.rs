//! Bearings of the pulley shafts under the pull of the belt.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PB-1 | both shafts: F_rad = 2 (F_p tan th/beta_p + F_s tan th/beta_s) cos alpha, cos alpha = free strut / centre distance | derived: pull of both strands, 2 Tm - \|C_x\| - 2 m v2 with Tm of TE-7; what torque and speed add cancels |
//! | PB-2 | T = mu_b F_rad d/2 on each shaft | source: SKF's estimate of bearing friction from load and bore; mu_b ASSUMED, 0.0008 to 0.0020 |
//!
//! F clamping forces N, beta wraps rad, th half wedge angle, alpha lean of the strands, d bore m. The rest of the strands' pull across the line of
//! centres, (T1 - T2 -+ C_x) sin alpha, turns the sum by less than a tenth of a percent of its size and is left out. Friction without load
//! is IS-1's at the primary; at the secondary it is not modelled.

use super::variator::{Belt, BeltAtRatio};
use crate::keys::{Values, keys};
use crate::math::{Gather, Real, physics};

/// The checked bearings.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct PulleyBearing<R: Real = f64> {
    /// Friction at the bore.
    pub friction: R,
    /// Bore on the shafts of primary and secondary, m.
    pub bore_m: [R; 2],
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
}

keys! {
    /// Keys of `[transmission.cvt.pulley_bearing]`.
    BEARING: PulleyBearingKeys = "pulley_bearing" [] {
        friction: or(0.0015, number(0.0, 0.01)), "friction under load, at the bore", ["PB-2"];
        primary_bore_mm: or(45.0, number(5.0, 300.0)), "bore of the bearings on the primary's shaft", ["PB-2"];
        secondary_bore_mm: or(45.0, number(5.0, 300.0)), "bore of the bearings on the secondary's shaft", ["PB-2"];
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
        }
    }
}
