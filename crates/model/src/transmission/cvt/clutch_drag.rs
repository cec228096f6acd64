//! Drag of the open reverse clutch.
//!
//! | label | statement | status |
//! |---|---|---|
//! | CD-1 | reverse clutch: T = min(c (nu/nu_80)^m, cap) | source: thesis 7.6 in form; fitted to 5.5.3; cap: 5.5.3 "approximately 0.5 Nm" below 25 degC |
//!
//! nu_80 = 11 mm2/s is the viscosity at which c holds.

use crate::keys::{Values, keys};
use crate::math::smaller;

/// The checked reverse clutch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClutchDrag {
    /// Torque at reference viscosity, Nm.
    pub drag_nm: f64,
    /// Exponent of viscosity.
    pub exponent: f64,
    /// Largest torque, Nm.
    pub cap_nm: f64,
}

impl ClutchDrag {
    /// Torque, Nm, with the power (nu/nu_80)^m known (CD-1).
    #[inline]
    pub fn torque_nm(&self, power: f64) -> f64 {
        smaller(self.drag_nm * power, self.cap_nm) // CD-1
    }
}

keys! {
    /// Keys of `[transmission.cvt.reverse_clutch]`.
    CLUTCH: ClutchKeys = "reverse_clutch" [] {
        drag_nm: number(0.0, 20.0), "drag at 11 mm2/s", ["CD-1"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["CD-1"];
        cap_nm: number(0.0, 20.0), "largest drag", ["CD-1"];
    }
}

impl ClutchDrag {
    /// The reverse clutch from the values of its table.
    pub(super) fn from_values<V: Values>(s: &V) -> Self {
        ClutchDrag {
            drag_nm: s.number(&CLUTCH.drag_nm),
            exponent: s.number(&CLUTCH.viscous_exponent),
            cap_nm: s.number(&CLUTCH.cap_nm),
        }
    }
}
