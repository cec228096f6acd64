//! Segments wedge at pulley entry and exit and penetrate into pulleys that give way under clamping force.
//!
//! | label | statement | status |
//! |---|---|---|
//! | WE-1 | deflection delta_p = R_p F_p / 0.6e7, delta_s = R_s F_s / 5e7 | source: App. C |
//! | WE-2 | q = delta / (2 tan th); chord = sqrt(q (2R + q)); sliding speed/w = sqrt(2 (R + q) q) | source: thesis eq. 79 to 91 |
//! | WE-3 | loss at the primary shaft: arcs mu N/2 chord/t sliding speed/w_in | source: thesis eq. 92, 93; App. C counts one arc of two |
//! | WE-4 | the primary's deflection falls to zero towards its end stop, I 2.30 to 2.417 | source: thesis 8.8 in words; ramp ASSUMED |
//! | PE-1 | loss: mu N 2 depth R_p / t, depth = delta (App. C) or delta/(2 tan th) (eq. 95) | source: thesis eq. 94 to 98 |
//!
//! N is the resultant normal force on a segment (both flanks), t the segment thickness. Always positive; zero at zero clamping force.

use super::{Belt, Formulation, Geometry, Tension};
use crate::numeric::ramp;

/// Wedge and penetration losses of both pulleys, at the primary shaft, Nm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deflection {
    /// Wedge loss, primary pulley.
    pub wedge_primary_nm: f64,
    /// Wedge loss, secondary pulley.
    pub wedge_secondary_nm: f64,
    /// Penetration loss, primary pulley.
    pub penetration_primary_nm: f64,
    /// Penetration loss, secondary pulley.
    pub penetration_secondary_nm: f64,
}

/// chord times sliding speed over shaft speed, m2 (WE-2).
#[inline]
fn wedge_area_m2(radius_m: f64, deflection_m: f64, tan_wedge: f64) -> f64 {
    let q = deflection_m / (2.0 * tan_wedge);
    // sqrt(q (2R+q)) sqrt(2 (R+q) q) = q sqrt((2R+q) 2 (R+q))
    q * ((2.0 * radius_m + q) * 2.0 * (radius_m + q)).sqrt()
}

/// Wedge and penetration losses (WE-1 to PE-1).
#[must_use]
#[inline]
pub fn deflection(belt: &Belt, f: Formulation, g: &Geometry, t: &Tension, mu_flank: f64) -> Deflection {
    let stop = f.primary_stop(ramp(g.ratio, belt.stop_to_ratio, belt.stop_from_ratio)); // WE-4
    let delta_p = stop * g.primary_radius_m * t.primary_clamp_n * belt.primary_compliance_per_n;
    let delta_s = g.secondary_radius_m * t.secondary_clamp_n * belt.secondary_compliance_per_n; // WE-1
    let pitch = belt.segment_thickness_m;
    let n_p = 2.0 * t.primary_clamp_n * pitch / (g.primary_radius_m * g.primary_wrap_rad * belt.cos_wedge);
    let n_s = 2.0 * t.secondary_clamp_n * pitch / (g.secondary_radius_m * g.secondary_wrap_rad * belt.cos_wedge);
    let tan = f.wedge_tan(belt.tan_wedge);
    let common = f.wedge_arcs() * mu_flank / (2.0 * pitch);
    let wedge_s_force = if f.own_wedge_force() { n_s } else { n_p };
    let depth = if f.radial_penetration() { 1.0 / (2.0 * belt.tan_wedge) } else { 1.0 };
    let pen = 2.0 * mu_flank * g.primary_radius_m / pitch * depth;
    Deflection {
        wedge_primary_nm: common * n_p * wedge_area_m2(g.primary_radius_m, delta_p, tan), // WE-3
        wedge_secondary_nm: common * wedge_s_force * wedge_area_m2(g.secondary_radius_m, delta_s, tan) / g.ratio, // WE-3
        penetration_primary_nm: pen * n_p * delta_p,   // PE-1
        penetration_secondary_nm: pen * n_s * delta_s, // PE-1
    }
}
