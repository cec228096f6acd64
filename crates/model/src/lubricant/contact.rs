//! Friction of a contact over sliding speed, pressure and temperature, where a bench has measured it.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FR-1 | mu = (1 - u) mu_b exp(k (T - 85 degC)) + u mu_f; u = z/(1 + z), z = (eta v/N)^q | derived: LU-4 and LU-5 with a friction of the film of its own; mu_b, k, mu_f, N, q fitted to a table (FR-5) |
//! | FR-2 | mu_b and mu_f times (p/p_0)^m, p the pressure of the contact held within those of the table, p_0 their geometric mean | ASSUMED form; m fitted where a table has several pressures, else 0 |
//! | FR-3 | T of FR-1 is held within the temperatures of the table | ASSUMED: an exponential through a bench's few temperatures is no law beyond them |
//! | FR-4 | elements on pulleys slide at v = share x belt speed: 0.5 % in micro slip, 2 % in macro slip | ASSUMED: 0.2 to 1 %, 1 to 4 %; slip at the torque of use and at the peak of traction |
//! | FR-6 | friction in force: mu (1 + w place), w the half width of what is known of it, place from -1 to 1 | derived: one number by which a study moves all of a curve |
//! | FR-7 | X_L of the fluid times X_L of the box in GM-2 | source: ISO/TR 14179-2: a factor of the kind of oil |
//!
//! Symbols: v sliding speed m/s, p mean pressure Pa, eta dynamic viscosity Pa s of this fluid at T, N, q, k, m numbers of the contact.
//!
//! Limits: without sliding, and in oil without viscosity, u = 0 and mu is that of the boundary, mu_b exp(..); in the cold and at speed u goes to 1
//! and mu to mu_f, so that it lies between two measured levels however thick the oil is. mu is above zero and continuous with all slopes, but for
//! the ends of FR-3, where it is continuous. It has no sign of sliding: a force takes that of the speed it hinders. Bands: mu_b, k, N and q of a
//! table are those of LU-4 and LU-5, and mu_f is left out: FI-1 shears the film between the bands, whose pressure is a hundredth of a ball's. Without
//! a table friction is the number of the key at every speed and temperature (bands: LU-4).
//!
//! Valid from 0 to 20 m/s; a table says for which pressures and temperatures.

use crate::keys::ZERO_DEGC_K;
use crate::math::{Gather, Mask, Real, physics};

/// A contact of which a fluid's file can say what was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Contact {
    /// Innermost band on shoulders, and bands on each other.
    Bands,
    /// Elements on pulleys while torque is transmitted.
    MicroSlip,
    /// Elements on pulleys at the limit of what they transmit.
    MacroSlip,
    /// Plates of a wet clutch.
    WetClutch,
    /// Teeth of gears.
    Gears,
}

impl Contact {
    /// All contacts.
    pub const ALL: [Contact; 5] = [
        Contact::Bands,
        Contact::MicroSlip,
        Contact::MacroSlip,
        Contact::WetClutch,
        Contact::Gears,
    ];

    /// Name of its table in `[friction]`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Contact::Bands => "bands",
            Contact::MicroSlip => "micro_slip",
            Contact::MacroSlip => "macro_slip",
            Contact::WetClutch => "wet_clutch",
            Contact::Gears => "gears",
        }
    }

    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Contact::Bands => "bands on shoulders and on each other",
            Contact::MicroSlip => "elements on pulleys in micro slip",
            Contact::MacroSlip => "elements on pulleys in macro slip (torque capacity)",
            Contact::WetClutch => "wet clutch",
            Contact::Gears => "gears",
        }
    }

    /// Key in the fluid's file that has its friction where there is no table; none of the clutch, which no equation reads.
    #[must_use]
    pub const fn number_key(self) -> Option<&'static str> {
        match self {
            Contact::Bands => Some("friction.band"),
            Contact::MicroSlip => Some("friction.segment"),
            Contact::MacroSlip => Some("friction.capacity"),
            Contact::WetClutch => None,
            Contact::Gears => Some("friction.gears.oil_factor"),
        }
    }
}

/// Friction of a contact as a curve (FR-1).
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct ContactCurve<R: Real = f64> {
    /// Boundary friction at 85 degC.
    pub boundary: R,
    /// Rise of the boundary friction with temperature, 1/K.
    pub rise_per_k: R,
    /// Friction where the film carries all.
    pub film: R,
    /// eta v at which it carries half, N/m; infinite where it carries nothing.
    pub half_n_m: R,
    /// Exponent q of its share.
    pub exponent: R,
    /// Lowest temperature of the table, K.
    pub from_k: R,
    /// Highest one, K.
    pub to_k: R,
    /// Sliding speed over belt speed (FR-4).
    pub slip: R,
}

#[physics]
impl<R: Real> ContactCurve<R> {
    /// Friction at a temperature, K, a dynamic viscosity, Pa s, and a sliding speed, m/s (FR-1, FR-3).
    pub fn friction(&self, temp_k: R, eta_pa_s: R, sliding_m_s: R) -> R {
        let held_k = self.to_k.min(temp_k.max(self.from_k)); // FR-3
        let warm = (self.rise_per_k * (held_k - ZERO_DEGC_K - 85.0)).exp();
        let x = eta_pa_s * sliding_m_s.abs() / self.half_n_m;
        let (slides, one) = (x.gt(0.0), x.splat(1.0));
        let z = (self.exponent * slides.select(x, one).ln()).exp();
        let is_finite = z.splat(f64::MAX).ge(z);
        let carried = is_finite.select(z / (1.0 + z), one);
        let film_share = slides.select(carried, one.splat(0.0));
        (1.0 - film_share) * self.boundary * warm + film_share * self.film // FR-1
    }

    /// Friction between an element and its pulley at a temperature, K, a viscosity, Pa s, and a belt speed, m/s (FR-4).
    pub fn at_belt_speed(&self, temp_k: R, eta_pa_s: R, belt_m_s: R) -> R {
        self.friction(temp_k, eta_pa_s, self.slip * belt_m_s) // FR-4
    }
}

impl ContactCurve {
    /// No less than its friction anywhere.
    #[must_use]
    pub fn largest(&self) -> f64 {
        let ends = [self.from_k, self.to_k].map(|k| self.friction(k, 0.0, 0.0));
        let film = if self.half_n_m.is_finite() {
            self.film
        } else {
            0.0
        };
        ends.into_iter().fold(film, f64::max)
    }

    /// The curve with both levels times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        ContactCurve {
            boundary: self.boundary * factor,
            film: self.film * factor,
            ..self
        }
    }
}
