//! Where the belt runs: radii, wraps and free strut for a ratio.
//!
//! | label | statement | status |
//! |---|---|---|
//! | GE-1 | I = R_s / R_p | source: thesis eq. 5 |
//! | GE-2 | beta_p = pi - 2 alpha, beta_s = pi + 2 alpha, sin alpha = (R_s - R_p)/X | source: thesis 8.1.1, App. C |
//! | GE-3 | R_p beta_p + R_s beta_s + 2 sqrt(X2 - (R_s - R_p)2) = L | source: thesis 8.1.1, App. C |
//! | GE-4 | GE-3 in R_s alone: f = pi h R + 2 asin(g R/X) g R + 2 sqrt(X2 - (g R)2) - L, f' = pi h + 2 g asin(g R/X), g = 1 - 1/I, h = 1 + 1/I | derived |
//!
//! Symbols: X centre distance, L belt length, all m; angles rad. Valid for ratios 0.3 to 3.3 of the shipped belt; the configured
//! limits lie within. f is convex and rising in R, so Newton from the series start needs at most three steps.

use crate::math::{Gather, Mask, Real, physics};
use std::f64::consts::PI;

/// Geometry of the belt at one ratio.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Geometry<R: Real = f64> {
    /// Belt ratio I = R_sec / R_pri.
    pub ratio: R,
    /// One over it.
    pub inv_ratio: R,
    /// Primary running radius, m.
    pub primary_radius_m: R,
    /// Secondary running radius, m.
    pub secondary_radius_m: R,
    /// Primary wrap angle, rad.
    pub primary_wrap_rad: R,
    /// Secondary wrap angle, rad.
    pub secondary_wrap_rad: R,
    /// Length of one free strut, m.
    pub strut_m: R,
}

/// Square of pi.
const PI_SQUARED: f64 = PI * PI;

#[physics]
impl<R: Real> Geometry<R> {
    /// Solves the belt's geometry for a ratio, centre distance and belt length (GE-1 to GE-4).
    pub fn new(ratio: R, centre_distance_m: R, belt_length_m: R) -> Self {
        let (x, l) = (centre_distance_m, belt_length_m);
        let (inv_ratio, inv_x) = (1.0 / ratio, 1.0 / x); // g is 0 at I = 1 to the bit
        let (g, h) = (1.0 - inv_ratio, 1.0 + inv_ratio);
        let free = l - 2.0 * x;
        let root = (PI_SQUARED * h * h + 4.0 * g * g * free * inv_x).sqrt();
        let mut r = 2.0 * free / (PI * h + root);
        let mut alpha = (g * r * inv_x).asin();
        let mut strut = (x * x - g * r * g * r).sqrt();
        let mut open = !r.gt(r); // in every lane
        for _ in 0..4 {
            let f = PI * h * r + 2.0 * alpha * g * r + 2.0 * strut - l;
            let step = f / (PI * h + 2.0 * alpha * g); // GE-4
            r = open.select(r - step, r);
            alpha = (g * r * inv_x).asin();
            strut = (x * x - g * r * g * r).sqrt();
            open = open & step.abs().gt(1e-9 * r);
            if !open.any() {
                break;
            }
        }
        Geometry {
            ratio,
            inv_ratio,
            primary_radius_m: r * inv_ratio, // GE-1
            secondary_radius_m: r,
            primary_wrap_rad: PI - 2.0 * alpha, // GE-2
            secondary_wrap_rad: PI + 2.0 * alpha,
            strut_m: strut,
        }
    }

    /// Speed of the belt at a speed of the primary, m/s.
    pub fn belt_m_s(&self, primary_rad_s: R) -> R {
        self.primary_radius_m * primary_rad_s.abs()
    }

    /// Change of the secondary radius with the logarithm of the ratio, m (derived from GE-3 at constant length).
    pub fn secondary_radius_slope_m(&self) -> R {
        // dL = beta_p dR_p + beta_s dR_s = 0 along the constraint, with dR_p = (dR_s - R_s dlnI)/I.
        let bp = self.primary_wrap_rad * self.inv_ratio;
        bp * self.secondary_radius_m / (bp + self.secondary_wrap_rad)
    }
}

impl Geometry {
    /// True if a belt of this length runs so: GE-3 holds, and each pulley carries at least one segment.
    pub fn is_real(&self, belt_length_m: f64, segment_thickness_m: f64) -> bool {
        let arcs = [
            self.primary_radius_m * self.primary_wrap_rad,
            self.secondary_radius_m * self.secondary_wrap_rad,
        ];
        let left = arcs[0] + arcs[1] + 2.0 * self.strut_m - belt_length_m; // GE-3
        arcs.iter().all(|arc| *arc >= segment_thickness_m) && left.abs() <= 1e-9 * belt_length_m
    }
}
