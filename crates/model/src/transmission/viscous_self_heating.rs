//! A viscous drag warms the film in which it arises: it grows less with cold than the viscosity of the oil in the sump.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FH-1 | T = 2 T_0/(1 + sqrt(1 + 4 T_0 w/P_h)), T_0 the drag with the film as warm as the sump | derived: first order of the fall of viscosity; P_h ASSUMED |
//!
//! The film is warmer than the oil around it by R T w, R = 1/(h A) the resistance from the film to that oil. With T_0 in proportion to
//! nu^m and nu falling by exp(-b K) over K kelvin, b = -d ln nu/dT, the drag is T exp(m b R T w) = T_0. FH-1 takes 1 + x for exp x:
//!
//!   T (1 + T w/P_h) = T_0, P_h = 1/(m b R): the dissipation at which the drag has fallen to one half.
//!
//! The positive root is FH-1. Since exp x >= 1 + x, FH-1 is never below the drag with the full exponential: a bound from above. T_0 w/P_h
//! is the Nahme number. Limits: T = T_0 for P_h without bound (to the last bit) and for w = 0; T = sqrt(T_0 P_h/w) far above, so drag
//! grows with the root of the power law only. T never exceeds T_0, never falls as T_0 rises, and T w never falls as w rises.
//!
//! Only the viscous part of a loss is bounded so. P_h is one number of a part: b is 0.045/K at 25 degC, 0.075/K at -10 degC and 0.105/K at
//! -30 degC for the CVT's fluid, and P_h is meant at -10 degC. Colder, the true P_h is smaller, and FH-1 still a bound from above.
//! The film is taken to be in step with its dissipation: it holds grams of oil, and is there within a second.

use crate::keys::{Key, Values, spec};
use crate::math::{Gather, Real, physics};

/// Heating of a film by its own drag.
#[derive(Clone, Copy, Debug, Default, Gather, PartialEq)]
pub struct ViscousSelfHeating<R: Real = f64> {
    /// Four over the dissipation that halves the drag, 1/W; 0 without heating.
    four_per_halving_w: R,
}

impl ViscousSelfHeating {
    /// No heating: the drag follows the viscosity of the sump.
    pub const NONE: ViscousSelfHeating = ViscousSelfHeating {
        four_per_halving_w: 0.0,
    };

    /// Heating by the dissipation in W that halves the drag (FH-1); none without one.
    pub fn halving_at_w(halving_w: Option<f64>) -> Self {
        halving_w.map_or(Self::NONE, ViscousSelfHeating::halving)
    }
}

#[physics]
impl<R: Real> ViscousSelfHeating<R> {
    /// Heating by the dissipation in W that halves the drag (FH-1).
    pub fn halving(halving_w: R) -> Self {
        ViscousSelfHeating {
            four_per_halving_w: 4.0 / halving_w,
        }
    }

    /// Viscous drag, Nm, from the drag without heating, Nm, and the speed, rad/s (FH-1); both not below zero.
    pub fn torque_nm(self, unheated_nm: R, speed_rad_s: R) -> R {
        2.0 * unheated_nm
            / (1.0 + (1.0 + unheated_nm * speed_rad_s * self.four_per_halving_w).sqrt()) // FH-1
    }
}

/// Row of the key `film_heating_w`, which several parts have.
pub const SELF_HEATING: spec::Spec = spec::optional(spec::number(1.0, 1e9));

impl ViscousSelfHeating {
    /// The heating that a part's `film_heating_w` gives; none where it is absent.
    pub fn from_values<V: Values>(s: &V, key: &Key<'static>) -> Self {
        ViscousSelfHeating::halving_at_w(s.optional(key))
    }
}
