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

use std::f64::consts::PI;

/// Geometry of the belt at one ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Belt ratio I = R_sec / R_pri.
    pub ratio: f64,
    /// Primary running radius, m.
    pub primary_radius_m: f64,
    /// Secondary running radius, m.
    pub secondary_radius_m: f64,
    /// Primary wrap angle, rad.
    pub primary_wrap_rad: f64,
    /// Secondary wrap angle, rad.
    pub secondary_wrap_rad: f64,
    /// Length of one free strut, m.
    pub strut_m: f64,
}

impl Geometry {
    /// Solves the belt's geometry for a ratio, centre distance and belt length (GE-1 to GE-4).
    #[must_use]
    pub fn new(ratio: f64, centre_distance_m: f64, belt_length_m: f64) -> Self {
        let (x, l) = (centre_distance_m, belt_length_m);
        let g = 1.0 - 1.0 / ratio;
        let h = 1.0 + 1.0 / ratio;
        let free = l - 2.0 * x;
        let mut r = 2.0 * free / (PI * h + (PI * PI * h * h + 4.0 * g * g * free / x).sqrt());
        let mut alpha = (g * r / x).asin();
        let mut strut = (x * x - g * r * g * r).sqrt();
        for _ in 0..4 {
            let f = PI * h * r + 2.0 * alpha * g * r + 2.0 * strut - l;
            let step = f / (PI * h + 2.0 * alpha * g); // GE-4
            r -= step;
            alpha = (g * r / x).asin();
            strut = (x * x - g * r * g * r).sqrt();
            if step.abs() <= 1e-9 * r {
                break;
            }
        }
        Geometry {
            ratio,
            primary_radius_m: r / ratio, // GE-1
            secondary_radius_m: r,
            primary_wrap_rad: PI - 2.0 * alpha, // GE-2
            secondary_wrap_rad: PI + 2.0 * alpha,
            strut_m: strut,
        }
    }

    /// Whether a belt of this length runs so: GE-3 holds, and each pulley carries at least one segment.
    #[must_use]
    pub fn is_real(&self, belt_length_m: f64, segment_thickness_m: f64) -> bool {
        let arcs = [
            self.primary_radius_m * self.primary_wrap_rad,
            self.secondary_radius_m * self.secondary_wrap_rad,
        ];
        let left = arcs[0] + arcs[1] + 2.0 * self.strut_m - belt_length_m; // GE-3
        arcs.iter().all(|arc| *arc >= segment_thickness_m) && left.abs() <= 1e-9 * belt_length_m
    }

    /// Change of the secondary radius with the logarithm of the ratio, m (derived from GE-3 at constant length).
    #[must_use]
    pub fn secondary_radius_slope_m(&self) -> f64 {
        // dL = beta_p dR_p + beta_s dR_s = 0 along the constraint, with dR_p = (dR_s - R_s dlnI)/I.
        let bp = self.primary_wrap_rad / self.ratio;
        bp * self.secondary_radius_m / (bp + self.secondary_wrap_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outside truth: 200 ratios of an independent program, committed with the tests.
    #[test]
    fn val_golden_geometry() {
        let text = include_str!("../../../../../../tests/golden/belt_geometry.csv");
        let mut count = 0;
        for line in text.lines().skip(1) {
            let c: Vec<f64> = line
                .split(',')
                .map(|x| x.parse().expect("number"))
                .collect();
            let g = Geometry::new(c[0], 0.155, 0.6486);
            let got = [
                g.primary_radius_m,
                g.secondary_radius_m,
                g.primary_wrap_rad,
                g.secondary_wrap_rad,
                g.strut_m,
            ];
            for (got, want) in got.iter().zip(&c[1..6]) {
                assert!(
                    (got - want).abs() <= 1e-9 * want.abs() + 1e-9,
                    "I {}: {got} {want}",
                    c[0]
                );
            }
            count += 1;
        }
        assert_eq!(count, 200);
    }

    #[test]
    fn radius_slope_is_the_derivative() {
        for ratio in [0.42, 0.7, 1.0, 1.6, 2.4] {
            let r = |u: f64| Geometry::new(ratio * u.exp(), 0.155, 0.6486).secondary_radius_m;
            let numeric = (r(1e-5) - r(-1e-5)) / 2e-5;
            let slope = Geometry::new(ratio, 0.155, 0.6486).secondary_radius_slope_m();
            assert!(
                (slope / numeric - 1.0).abs() < 1e-6,
                "I {ratio}: {slope} {numeric}"
            );
        }
    }

    /// Dimension rescaling: all lengths twice as long give radii twice as large at the same angles.
    #[test]
    fn rescales_with_length() {
        let (a, b) = (
            Geometry::new(0.6, 0.155, 0.6486),
            Geometry::new(0.6, 0.31, 1.2972),
        );
        assert!((b.primary_radius_m / a.primary_radius_m - 2.0).abs() < 1e-12);
        assert!((b.primary_wrap_rad - a.primary_wrap_rad).abs() < 1e-12);
    }
}
