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
use crate::math::{Real, both, physics};

/// Wedge and penetration losses at the primary shaft, Nm; pairs are primary, secondary.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deflection<R: Real = f64> {
    /// Wedging at entry and exit.
    pub wedge_nm: [R; 2],
    /// Penetration.
    pub penetration_nm: [R; 2],
}

/// 2/t times depth over deflection, 1/m, with 1/t known (PE-1).
#[physics]
pub fn penetration_per_m<R: Real>(belt: &Belt<R>, inv_thickness: R) -> R {
    let depth = if belt.formulation.radial_penetration() {
        0.5 / belt.tan_wedge
    } else {
        belt.tan_wedge.splat(1.0)
    };
    2.0 * depth * inv_thickness
}

/// Wedge and penetration losses, both pulleys side by side (WE-1 to PE-1).
#[physics]
pub fn deflection<R: Real>(
    belt: &Belt<R>,
    at: &BeltAtRatio<R>,
    t: &Tension<R>,
    mu_flank: R,
) -> Deflection<R> {
    let clamp_n = [t.primary_clamp_n, t.secondary_clamp_n];
    clamped(belt, at, clamp_n, mu_flank)
}

/// The same from the clamping forces, N.
#[physics]
fn clamped<R: Real>(
    belt: &Belt<R>,
    at: &BeltAtRatio<R>,
    clamp_n: [R; 2],
    mu_flank: R,
) -> Deflection<R> {
    let (g, prepared) = (&at.geometry, &at.prepared);
    let radius_m = [g.primary_radius_m, g.secondary_radius_m];
    let friction_n = both!(i => mu_flank * clamp_n[i] * prepared.normal_per_clamp[i]);
    let compliance_per_n = [
        prepared.stop * belt.primary_compliance_per_n,
        belt.secondary_compliance_per_n,
    ]; // WE-4
    let delta_m = both!(i => clamp_n[i] * (radius_m[i] * compliance_per_n[i])); // WE-1
    let (r, q) = (radius_m, both!(i => delta_m[i] * at.fixed.wedge_half_cot));
    // WE-2: sqrt(q (2R+q)) sqrt(2 (R+q) q)
    let chord_m2 = both!(i => q[i] * ((r[i] + r[i] + q[i]) * (r[i] + r[i] + q[i] + q[i])).sqrt());
    let wedge_n = if belt.formulation.own_wedge_force() {
        friction_n
    } else {
        [friction_n[0]; 2]
    };
    Deflection {
        wedge_nm: both!(i => prepared.wedge_per_m[i] * wedge_n[i] * chord_m2[i]), // WE-3
        penetration_nm: both!(i => prepared.penetration * friction_n[i] * delta_m[i]), // PE-1
    }
}
