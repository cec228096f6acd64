//! Churning: a wheel that dips into the sump drags oil along.
//!
//! | label | statement | status |
//! |---|---|---|
//! | CH-1 | C = f rho/2 w^2 R^3 S_m 1.366 (h/D)^0.45 (V/D^3)^0.1 Fr^-0.6 Re^-0.21 (b/R)^0.21 | source: form of Changenet and Velex 2007 (J. Mech. Des. 129); coefficients from memory, ASSUMED within 0.3 to 5; f fitted with c of BR-1 |
//!
//! Fr = w^2 R/g, Re = w R^2/nu; R radius, D diameter, b width, h immersion, all m; S_m wetted flanks and rim, m2; V oil in the sump, m3;
//! rho kg/m3. The law of low Reynolds numbers is used at all of them.

use crate::math::{Real, asin, exp, ln, physics, smaller};

const GRAVITY_M_S2: f64 = 9.81;

/// A wheel, or a packet of wheels, in the sump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Churner {
    /// Shaft on which it is, from 0.
    pub shaft: usize,
    /// Tip radius, m.
    pub radius_m: f64,
    /// Width, m.
    pub face_m: f64,
    /// Depth to which it dips into the oil, m.
    pub immersion_m: f64,
}

impl Churner {
    /// Wetted flanks and rim, m2.
    pub fn wetted_m2(&self) -> f64 {
        let (r, h) = (
            self.radius_m,
            smaller(self.immersion_m, 2.0 * self.radius_m),
        );
        // Half of the angle under oil, whose cosine is 1 - h/r.
        let cos = 1.0 - h / r;
        let half = 2.0 * asin((h / (2.0 * r)).sqrt());
        let sin = (1.0 - cos * cos).sqrt();
        2.0 * r * r * (half - sin * cos) + 2.0 * half * r * self.face_m
    }

    /// Factor of CH-1 without speed and oil, Nm over density, speed^0.59 and viscosity^0.21, SI.
    pub fn factor(&self, oil_m3: f64) -> f64 {
        let r = self.radius_m;
        let d = 2.0 * r;
        let h = smaller(self.immersion_m, d);
        if h <= 0.0 {
            return 0.0;
        }
        let power = |x: f64, exponent: f64| exp(exponent * ln(x));
        0.5 * (r * r * r)
            * self.wetted_m2()
            * 1.366
            * power(h / d, 0.45)
            * power(oil_m3 / (d * d * d), 0.1)
            * power(r / GRAVITY_M_S2, -0.6)
            * power(r * r, -0.21)
            * power(self.face_m / r, 0.21)
    }
}

/// The factor of a churner for its torque at shaft 0 of a train, and for the speed of that shaft, from its own and from the speed of its shaft
/// over that of shaft 0 (CH-1).
pub fn in_train(factor: f64, turns: f64) -> f64 {
    factor * turns * exp(0.59 * ln(turns))
}

/// Torque at a shaft of a churner with its factor, Nm, from the logarithms of the shaft's speed in rad/s and of nu in m2/s (CH-1).
#[physics]
pub fn torque_nm<R: Real>(factor: R, density_kg_m3: R, log_rad_s: R, log_nu: R) -> R {
    factor * density_kg_m3 * (0.59 * log_rad_s + 0.21 * log_nu).exp() // CH-1
}
