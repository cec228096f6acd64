//! Drag of the input shaft.
//!
//! | label | statement | status |
//! |---|---|---|
//! | IS-1 | input shaft: T = c0 + c1 (nu/nu_80)^m n/1000 rpm, the second term by FH-1 | source: thesis 7.3, 5.5.5 in form; fitted to 1-2 Nm over 1000-4000 rpm |
//!
//! nu_80 = 11 mm2/s is the viscosity at which the constants hold, without the heating of the films. Below 25 degC the viscous term is
//! extrapolated, bounded by the heating of its film (FH-1). Unmeasured there.

use crate::keys::{Values, keys};
use crate::math::{Gather, Real, physics};
use crate::transmission::viscous_self_heating::{SELF_HEATING, ViscousSelfHeating};

/// The checked input shaft.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct ShaftDrag<R: Real = f64> {
    /// Constant c0, Nm.
    pub constant_nm: R,
    /// Slope c1 at reference viscosity, Nm s/rad.
    pub viscous_nm_s: R,
    /// Exponent of viscosity.
    pub exponent: R,
    /// Heating of its films (FH-1).
    pub heating: ViscousSelfHeating<R>,
}

#[physics]
impl<R: Real> ShaftDrag<R> {
    /// Torque, Nm, at a speed, rad/s, with the power (nu/nu_80)^m known (IS-1).
    pub fn torque_nm(&self, power: R, speed_rad_s: R) -> R {
        self.constant_nm
            + self
                .heating
                .torque_nm(self.viscous_nm_s * power * speed_rad_s, speed_rad_s) // IS-1
    }
}

keys! {
    /// Keys of `[transmission.cvt.input_shaft]`.
    SHAFT: ShaftKeys = "input_shaft" [] {
        constant_nm: number(0.0, 20.0), "torque at rest", ["IS-1"];
        viscous_nm_per_rpm: number(0.0, 0.01), "slope at 11 mm2/s", ["IS-1"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["IS-1"];
        film_heating_w: SELF_HEATING, "viscous dissipation at which the heat of the films halves it; absent: no heating", ["IS-1", "FH-1"];
    }
}

impl ShaftDrag {
    /// The input shaft from the values of its table.
    pub(super) fn from_values<V: Values>(s: &V) -> Self {
        ShaftDrag {
            constant_nm: s.number(&SHAFT.constant_nm),
            viscous_nm_s: s.number(&SHAFT.viscous_nm_per_rpm),
            exponent: s.number(&SHAFT.viscous_exponent),
            heating: ViscousSelfHeating::from_values(s, &SHAFT.film_heating_w),
        }
    }
}
