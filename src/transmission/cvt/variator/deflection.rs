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

use super::{Belt, BeltAtRatio, Tension};

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

/// chord times sliding speed over shaft speed for a radial overlap q, m2 (WE-2).
#[inline]
fn wedge_area_m2(radius_m: f64, q: f64) -> f64 {
    // sqrt(q (2R+q)) sqrt(2 (R+q) q) = q sqrt((2R+q) 2 (R+q))
    q * ((2.0 * radius_m + q) * 2.0 * (radius_m + q)).sqrt()
}

/// Wedge and penetration losses (WE-1 to PE-1).
#[must_use]
#[inline(always)]
pub fn deflection(belt: &Belt, at: &BeltAtRatio, t: &Tension, mu_flank: f64) -> Deflection {
    let (f, g, prepared) = (belt.formulation, &at.geometry, &at.prepared);
    let delta_p = prepared.stop * g.primary_radius_m * t.primary_clamp_n * belt.primary_compliance_per_n; // WE-4
    let delta_s = g.secondary_radius_m * t.secondary_clamp_n * belt.secondary_compliance_per_n; // WE-1
    let n_p = t.primary_clamp_n * prepared.normal_per_clamp[0];
    let n_s = t.secondary_clamp_n * prepared.normal_per_clamp[1];
    let half_cot = prepared.wedge_half_cot;
    let per_pitch = mu_flank / belt.segment_thickness_m;
    let common = 0.5 * f.wedge_arcs() * per_pitch;
    let wedge_s_force = if f.own_wedge_force() { n_s } else { n_p };
    let depth = if f.radial_penetration() { 0.5 / belt.tan_wedge } else { 1.0 };
    let pen = 2.0 * per_pitch * g.primary_radius_m * depth;
    Deflection {
        wedge_primary_nm: common * n_p * wedge_area_m2(g.primary_radius_m, delta_p * half_cot), // WE-3
        wedge_secondary_nm: common * wedge_s_force * wedge_area_m2(g.secondary_radius_m, delta_s * half_cot) * prepared.per_ratio, // WE-3
        penetration_primary_nm: pen * n_p * delta_p,                                            // PE-1
        penetration_secondary_nm: pen * n_s * delta_s,                                          // PE-1
    }
}
