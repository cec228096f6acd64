//! A lubricant: viscosity, density, heat capacity, and the friction it lends to the belt.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LU-1 | ln ln(nu + 0.7) = a - b ln T, nu in mm2/s, T in K | source: ASTM D341 (Walther) |
//! | LU-2 | rho = rho15 (1 - 0.00068 (T - 15 degC)) | source: physics of petroleum oils, ASSUMED coefficient |
//! | LU-3 | cp = (1.685 + 0.0034 T_C) / sqrt(rho15 / 1000), kJ/kgK | source: petroleum oils, ASSUMED for all fluids |
//! | LU-4 | mu_b = mu_85 exp(k (T - 85 degC)) (1 - r s) | k fitted to thesis 5.5.2, 8.9; form ASSUMED |
//! | LU-5 | film share s = z/(1+z), z = (eta dv / N_lift)^p; 0 with the film switched off | r, N_lift, p fitted to thesis 5.5.2, 8.9 (form ASSUMED: mixed lubrication) |
//!
//! Symbols: nu kinematic viscosity, eta dynamic viscosity Pa s, dv sliding speed of the innermost band m/s.
//! Valid from 1.5 mm2/s upwards and from -40 to 160 degC; outside, rows are flagged.
//!
//! Sources: ASTM D341; Akehurst 2001, 5.5.2, 8.4.5, 8.9. Ichihashi in Akehurst 2.3 (0.09 to 0.135, up to 30 % with temperature) measured segment on pulley at
//! 100 MPa, not band on segment: it is no bound of LU-4.

mod keys;
mod viscosity;

pub(crate) use keys::viscosity;
pub use keys::{FRICTION, FluidKeys};
pub use viscosity::Viscosity;

use crate::math::{exp, larger, ln, smaller};

pub use crate::keys::ZERO_DEGC_K;

/// Largest friction of the bands: at 0.53 they would block themselves in the larger wrap (TE-5). The reader refuses fluids that reach it at a valid
/// temperature; beyond, friction is held there.
const MAX_BAND_FRICTION: f64 = 0.5;

/// Least share of the density at 15 degC; reached at some 1000 degC.
const MIN_DENSITY: f64 = 0.3;

/// Friction that a fluid lends to the belt's contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Boundary friction band on band and band on segment at 85 degC.
    pub band: f64,
    /// Rise of the band friction with belt temperature, 1/K.
    pub band_rise_per_k: f64,
    /// Friction segment on pulley in micro slip.
    pub segment: f64,
    /// Friction segment on pulley in macro slip, which bounds the torque.
    pub capacity: f64,
    /// Friction in wedging and penetration.
    pub flank: f64,
    /// Whether the bands can ride on oil at all (LU-5).
    pub lift_off: bool,
    /// Part of the boundary friction that the film takes away when it carries fully.
    pub lift_reduction: f64,
    /// eta dv at which the film carries half, N/m.
    pub lift_n_m: f64,
    /// Sharpness of the lift-off.
    pub lift_exponent: f64,
    /// Thickness of the carrying film, m.
    pub film_thickness_m: f64,
}

/// Band friction at one state: boundary part and the share of the contact that a film carries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandFriction {
    /// Coefficient of friction, boundary and mixed.
    pub mu: f64,
    /// Share z / (1 + z) of the film, 0..1.
    pub film_share: f64,
}

impl Friction {
    /// Band friction at belt temperature, dynamic viscosity and sliding speed (LU-4).
    #[inline]
    pub fn band(&self, belt_k: f64, eta_pa_s: f64, sliding_m_s: f64) -> BandFriction {
        let load = self.film_load(eta_pa_s, sliding_m_s);
        self.band_on_film(
            belt_k,
            if load > 0.0 {
                exp(self.lift_exponent * ln(load))
            } else {
                0.0
            },
        )
    }

    /// eta dv / `N_lift` of LU-5; 0 where nothing slides or the film is switched off.
    #[inline]
    pub fn film_load(&self, eta_pa_s: f64, sliding_m_s: f64) -> f64 {
        if self.lift_off {
            eta_pa_s * sliding_m_s / self.lift_n_m
        } else {
            0.0
        }
    }

    /// Band friction at belt temperature with the power z of the film's load known (LU-4, LU-5).
    #[inline]
    pub fn band_on_film(&self, belt_k: f64, z: f64) -> BandFriction {
        let warm = exp(self.band_rise_per_k * (belt_k - ZERO_DEGC_K - 85.0));
        let film_share = if z.is_finite() { z / (1.0 + z) } else { 1.0 }; // LU-5
        BandFriction {
            mu: smaller(self.band * warm, MAX_BAND_FRICTION)
                * (1.0 - self.lift_reduction * film_share),
            film_share,
        } // LU-4
    }
}

/// A checked lubricant.
#[derive(Clone, Debug, PartialEq)]
pub struct Lubricant {
    /// Short name as in `--lubricant`.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Kinematic viscosity.
    pub viscosity: Viscosity,
    /// Density at 15 degC, kg/m3.
    pub density15_kg_m3: f64,
    /// Friction in the belt's contacts.
    pub friction: Friction,
}

/// Viscosity and density of an oil at one temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OilState {
    /// Kinematic viscosity, m2/s.
    pub kinematic_m2_s: f64,
    /// Density, kg/m3.
    pub density_kg_m3: f64,
}

/// Validity range of the fluid models, K.
pub const VALID_K: std::ops::RangeInclusive<f64> = 233.15..=433.15;

impl Lubricant {
    /// Kinematic viscosity, m2/s (LU-1).
    #[inline]
    pub fn kinematic_m2_s(&self, temp_k: f64) -> f64 {
        self.viscosity.kinematic_m2_s(temp_k)
    }

    /// Density, kg/m3 (LU-2).
    #[inline]
    pub fn density_kg_m3(&self, temp_k: f64) -> f64 {
        let share = 1.0 - 0.000_68 * (temp_k - ZERO_DEGC_K - 15.0);
        // Far beyond its validity the line would reach zero, and there is no oil of negative mass.
        self.density15_kg_m3 * larger(MIN_DENSITY, share) // LU-2
    }

    /// Viscosity and density.
    pub fn state(&self, temp_k: f64) -> OilState {
        OilState {
            kinematic_m2_s: self.kinematic_m2_s(temp_k),
            density_kg_m3: self.density_kg_m3(temp_k),
        }
    }

    /// Dynamic viscosity, Pa s.
    #[inline]
    pub fn dynamic_pa_s(&self, temp_k: f64) -> f64 {
        self.kinematic_m2_s(temp_k) * self.density_kg_m3(temp_k)
    }

    /// Specific heat capacity, J/kgK (LU-3).
    pub fn heat_capacity_j_kgk(&self, temp_k: f64) -> f64 {
        1000.0 * (1.685 + 0.0034 * (temp_k - ZERO_DEGC_K)) / (self.density15_kg_m3 / 1000.0).sqrt() // LU-3
    }
}
