//! A lubricant: viscosity, density, heat capacity, and the friction it lends to the belt.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LU-1 | ln ln(nu + 0.7) = a - b ln T, nu in mm2/s, T in K | source: ASTM D341 (Walther) |
//! | LU-2 | rho = rho15 (1 - 0.00068 (T - 15 degC)) | source: physics of petroleum oils, ASSUMED coefficient |
//! | LU-3 | cp = (1.685 + 0.0034 T_C) / sqrt(rho15 / 1000), kJ/kgK | source: petroleum oils, ASSUMED for all fluids |
//! | LU-4 | mu_b = mu_85 exp(k (T - 85 degC)): friction of the part of a contact that is not on a film | k fitted to thesis 5.5.2, 8.9; form ASSUMED |
//! | LU-5 | film share of interface i: u_i = z_i/(1 + z_i), z_i = x_i^q, x_i = eta dv_i/N_half; 0 with the film switched off | N_half, q fitted to thesis 5.5.2, 8.9; form ASSUMED: load shared by asperities and film (Echavarri et al. 2017) |
//! | FI-2 | film thickness h_i = h_half x_i^0.6 | form: isoviscous film; h_half ASSUMED |
//!
//! Friction that a bench has measured is in [`contact`] (FR-1 to FR-7), the fit to its table in [`bench`](mod@bench) (FR-5, FR-8).
//!
//! Symbols: nu kinematic viscosity, eta dynamic viscosity Pa s, dv sliding speed m/s of the innermost interface, or of each other one.
//! Valid from 1.5 mm2/s upwards and from -40 to 160 degC; outside, rows are flagged.
//!
//! Sources: ASTM D341; Akehurst 2001, 5.5.2, 8.4.5, 8.9. Ichihashi in Akehurst 2.3 (0.09 to 0.135, up to 30 % with temperature) measured segment on pulley at
//! 100 MPa, not band on segment: it is no bound of LU-4.

pub mod bench;
pub mod contact;
mod keys;
mod viscosity;

pub use bench::Bench;
pub use contact::{Contact, ContactCurve};
pub(crate) use keys::viscosity;
pub use keys::{FRICTION, FluidKeys};
pub use viscosity::Viscosity;

use crate::math::{Gather, Mask, Real, both, physics};
use std::sync::Arc;

pub use crate::keys::ZERO_DEGC_K;

/// Largest friction of the bands: at 0.53 they would block themselves in the larger wrap (TE-5). The reader refuses fluids that reach it at a valid
/// temperature; beyond, friction is held there.
const MAX_BAND_FRICTION: f64 = 0.5;

/// Least share of the density at 15 degC; reached at some 1000 degC.
const MIN_DENSITY: f64 = 0.3;

/// Friction that a fluid lends to the belt's contacts.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Friction<R: Real = f64> {
    /// Boundary friction band on band and band on segment at 85 degC.
    pub band: R,
    /// Rise of the band friction with belt temperature, 1/K.
    pub band_rise_per_k: R,
    /// Friction segment on pulley in micro slip.
    pub segment: R,
    /// Friction segment on pulley in macro slip, which bounds the torque.
    pub capacity: R,
    /// Friction in wedging and penetration.
    pub flank: R,
    /// True if the bands can ride on oil (LU-5).
    #[gather(same)]
    pub film: bool,
    /// eta dv at which the film carries half, N/m.
    pub half_n_m: R,
    /// Exponent q of the film's share.
    pub film_exponent: R,
    /// Thickness of the film where it carries half, m.
    pub half_thickness_m: R,
    /// Dissipation of an interface that halves the shear of its film, W (FH-1).
    pub film_heating_w: R,
    /// Friction segment on pulley in micro slip as a bench measured it (FR-1), in place of `segment`.
    pub micro_slip: Option<ContactCurve<R>>,
    /// Friction segment on pulley in macro slip as a bench measured it (FR-1), in place of `capacity`.
    pub macro_slip: Option<ContactCurve<R>>,
    /// Logarithm of the fluid's factor on the friction of teeth (FR-7).
    pub log_gear_factor: R,
}

/// Friction of elements on pulleys at one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementFriction<R: Real = f64> {
    /// In micro slip.
    pub segment: R,
    /// In macro slip, which bounds the torque.
    pub capacity: R,
}

/// Exponent of thickness in FI-2.
const THICKNESS_EXPONENT: f64 = 0.6;

/// Exponent of x over thickness.
const SHEARED_EXPONENT: f64 = 1.0 - THICKNESS_EXPONENT;

/// Band friction at one state. Pairs are the innermost interface, band on segments, and each other one, band on band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandFriction<R: Real = f64> {
    /// Boundary friction (LU-4).
    pub mu: R,
    /// Share of the contact that the film carries, 0..1 (LU-5).
    pub film_share: [R; 2],
    /// Shear of the film over the whole contact, its share counted and without heating, Pa (FI-1, FI-2).
    pub shear_pa: [R; 2],
}

impl BandFriction {
    /// Boundary friction without a film.
    pub const fn dry(mu: f64) -> Self {
        BandFriction {
            mu,
            film_share: [0.0; 2],
            shear_pa: [0.0; 2],
        }
    }
}

/// Powers of x = eta dv/N_half by interface: x^q and x^0.4; zeros where nothing slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmPowers<R: Real = f64> {
    /// x^q (LU-5).
    pub carried: [R; 2],
    /// x over x^0.6 (FI-2).
    pub sheared: [R; 2],
}

#[physics]
impl<R: Real> Friction<R> {
    /// Friction of elements on pulleys at belt temperature, dynamic viscosity and belt speed: the fluid's numbers, or where a bench measured it
    /// the curve's (FR-4).
    pub fn elements(&self, belt_k: R, eta_pa_s: R, belt_m_s: R) -> ElementFriction<R> {
        let of = |curve: &Option<ContactCurve<R>>, number: R| match curve {
            Some(curve) => curve.at_belt_speed(belt_k, eta_pa_s, belt_m_s),
            None => number,
        };
        ElementFriction {
            segment: of(&self.micro_slip, self.segment),
            capacity: of(&self.macro_slip, self.capacity),
        }
    }

    /// Band friction at belt temperature, dynamic viscosity and sliding speeds (LU-4, LU-5, FI-2).
    pub fn band(&self, belt_k: R, eta_pa_s: R, sliding_m_s: [R; 2]) -> BandFriction<R> {
        let films = self.film_powers(self.film_loads(eta_pa_s, sliding_m_s));
        self.band_on_film(belt_k, films)
    }

    /// x = eta dv/N_half of LU-5 by interface; 0 where nothing slides or the film is switched off.
    pub fn film_loads(&self, eta_pa_s: R, sliding_m_s: [R; 2]) -> [R; 2] {
        if self.film {
            let per_speed = eta_pa_s / self.half_n_m;
            both!(i => per_speed * sliding_m_s[i])
        } else {
            [eta_pa_s.splat(0.0); 2]
        }
    }

    /// The powers of the films' loads.
    pub fn film_powers(&self, x: [R; 2]) -> FilmPowers<R> {
        let zero = x[0].splat(0.0);
        let slides = both!(i => x[i].gt(0.0));
        if !(slides[0] | slides[1]).any() {
            return FilmPowers {
                carried: [zero; 2],
                sheared: [zero; 2],
            };
        }
        let log = R::ln_array(both!(i => slides[i].select(x[i], zero.splat(1.0))));
        let [carried, sheared] = [self.film_exponent, zero.splat(SHEARED_EXPONENT)];
        let powers = R::exp_array([
            carried * log[0],
            carried * log[1],
            sheared * log[0],
            sheared * log[1],
        ]);
        FilmPowers {
            carried: both!(i => slides[i].select(powers[i], zero)),
            sheared: both!(i => slides[i].select(powers[2 + i], zero)),
        }
    }

    /// Band friction at belt temperature with the powers of the films' loads known (LU-4, LU-5, FI-2).
    pub fn band_on_film(&self, belt_k: R, powers: FilmPowers<R>) -> BandFriction<R> {
        let warm = (self.band_rise_per_k * (belt_k - ZERO_DEGC_K - 85.0)).exp();
        let z = powers.carried;
        let is_finite = both!(i => z[i].splat(f64::MAX).ge(z[i].abs()));
        let film_share = both!(i => is_finite[i].select(z[i] / (1.0 + z[i]), z[i].splat(1.0))); // LU-5
        let most_pa = self.half_n_m / self.half_thickness_m; // eta dv/h where the film carries half
        BandFriction {
            mu: (self.band * warm).min(MAX_BAND_FRICTION), // LU-4
            film_share,
            shear_pa: both!(i => film_share[i] * most_pa * powers.sheared[i]), // FI-1, FI-2
        }
    }
}

impl Friction {
    /// No less than the friction of elements on pulleys in micro slip anywhere.
    #[must_use]
    pub fn largest_segment(&self) -> f64 {
        self.micro_slip
            .as_ref()
            .map_or(self.segment, ContactCurve::largest)
    }
}

/// A checked lubricant.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct Lubricant<R: Real = f64> {
    /// Short name as in `--lubricant`.
    #[gather(same)]
    pub name: String,
    /// Name for people.
    #[gather(same)]
    pub title: String,
    /// Kinematic viscosity.
    pub viscosity: Viscosity<R>,
    /// Density at 15 degC, kg/m3.
    pub density15_kg_m3: R,
    /// Friction in the belt's contacts.
    pub friction: Friction<R>,
    /// Tables of friction that were measured with it.
    #[gather(same)]
    pub benches: Vec<Arc<Bench>>,
}

/// Viscosity and density of an oil at one temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OilState<R: Real = f64> {
    /// Kinematic viscosity, m2/s.
    pub kinematic_m2_s: R,
    /// Density, kg/m3.
    pub density_kg_m3: R,
    /// Dynamic viscosity, Pa s.
    pub dynamic_pa_s: R,
    /// Logarithm of the kinematic viscosity in m2/s: losses are powers of it.
    pub log_nu: R,
    /// Logarithm of the dynamic viscosity in Pa s.
    pub log_eta: R,
    /// Logarithm of the fluid's factor on the friction of teeth (FR-7).
    pub log_gear_factor: R,
}

#[physics]
impl<R: Real> OilState<R> {
    /// The oil with a kinematic viscosity, m2/s, and a density, kg/m3.
    pub fn new(kinematic_m2_s: R, density_kg_m3: R) -> Self {
        let dynamic_pa_s = kinematic_m2_s * density_kg_m3;
        let [log_nu, log_eta] = R::ln_array([kinematic_m2_s, dynamic_pa_s]);
        OilState {
            kinematic_m2_s,
            density_kg_m3,
            dynamic_pa_s,
            log_nu,
            log_eta,
            log_gear_factor: log_nu.splat(0.0),
        }
    }

    /// The same oil with the logarithm of its factor on the friction of teeth (FR-7).
    pub fn with_gear_factor(self, log_gear_factor: R) -> Self {
        OilState {
            log_gear_factor,
            ..self
        }
    }
}

/// Validity range of the fluid models, K.
pub const VALID_K: std::ops::RangeInclusive<f64> = 233.15..=433.15;

#[physics]
impl<R: Real> Lubricant<R> {
    /// Kinematic viscosity, m2/s (LU-1).
    pub fn kinematic_m2_s(&self, temp_k: R) -> R {
        self.viscosity.kinematic_m2_s(temp_k)
    }

    /// Density, kg/m3 (LU-2).
    pub fn density_kg_m3(&self, temp_k: R) -> R {
        let share = 1.0 - 0.000_68 * (temp_k - ZERO_DEGC_K - 15.0);
        // Far beyond its validity the line would reach zero, and there is no oil of negative mass.
        self.density15_kg_m3 * share.splat(MIN_DENSITY).max(share) // LU-2
    }

    /// Viscosity and density.
    pub fn state(&self, temp_k: R) -> OilState<R> {
        OilState::new(self.kinematic_m2_s(temp_k), self.density_kg_m3(temp_k))
            .with_gear_factor(self.friction.log_gear_factor)
    }

    /// Dynamic viscosity, Pa s.
    pub fn dynamic_pa_s(&self, temp_k: R) -> R {
        self.kinematic_m2_s(temp_k) * self.density_kg_m3(temp_k)
    }

    /// Specific heat capacity, J/kgK (LU-3).
    pub fn heat_capacity_j_kgk(&self, temp_k: R) -> R {
        1000.0 * (1.685 + 0.0034 * (temp_k - ZERO_DEGC_K)) / (self.density15_kg_m3 / 1000.0).sqrt() // LU-3
    }
}
