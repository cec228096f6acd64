//! Drag of the forward-reverse set: its open reverse clutch and its bearings.
//!
//! | label | statement | status |
//! |---|---|---|
//! | CD-1 | film between the plates: T_f = min(c (nu/nu_80)^m s_0/s, cap) | source: thesis 7.6 in form; fitted to 5.5.3; cap: 5.5.3 "approximately 0.5 Nm" below 25 degC |
//! | CD-2 | speed: T = T_f 2x/(1 + (x/q)^2), x = n/n_p | ASSUMED: rise, rupture of the film, fall (Yuan et al.; Pointner-Gabriel et al., Lubricants 13 (2025) 27); n_p 2000 to 6000 rpm |
//! | CD-3 | bearings and seals of the set behind its locked forward clutch: T_0 + c (nu/nu_80)^m w_p on top | ASSUMED: form of IS-1; T_0 0 to 1 Nm, 0 by default, where other parts hold it |
//!
//! nu_80 = 11 mm2/s is the viscosity and s_0 = 0.3 mm the clearance at which c holds; s clearance of a pair of plates, n speed of the
//! primary, n_p speed of the largest drag with the normal oil feed, q feed over the normal one. Below n_p the film shears as Couette's
//! (slope 2 T_f/n_p, whatever the feed); above it centrifugal force takes more oil out than the feed brings. The largest drag is q T_f at
//! q n_p. Without n_p the drag is T_f at every speed.

use crate::keys::{Values, keys};
use crate::math::{Gather, Real, physics};

/// Clearance at which `drag_nm` holds, m.
pub const CLEARANCE_M: f64 = 0.3e-3;

/// The checked reverse clutch.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct ClutchDrag<R: Real = f64> {
    /// Torque at reference viscosity and clearance, Nm.
    pub drag_nm: R,
    /// Exponent of viscosity.
    pub exponent: R,
    /// Largest torque of the film, Nm.
    pub cap_nm: R,
    /// Speed of the largest drag with the normal oil feed, rad/s; `None`: no dependence on speed.
    pub peak_rad_s: Option<R>,
    /// Clearance of a pair of plates, m.
    pub clearance_m: R,
    /// Oil feed over the normal one.
    pub oil_share: R,
    /// Constant torque of the set's bearings, Nm.
    pub set_nm: R,
    /// Their torque over speed at reference viscosity, Nm s.
    pub set_nm_s: R,
}

#[physics]
impl<R: Real> ClutchDrag<R> {
    /// Torque, Nm, with the power (nu/nu_80)^m known, at a speed of the primary, rad/s (CD-1 to CD-3).
    pub fn torque_nm(&self, power: R, primary_rad_s: R) -> R {
        let set_nm = self.set_nm + self.set_nm_s * power * primary_rad_s; // CD-3
        self.film_nm(power, primary_rad_s) + set_nm
    }

    /// Torque of the film between the plates, Nm (CD-1, CD-2).
    fn film_nm(&self, power: R, primary_rad_s: R) -> R {
        let film_nm = self.drag_nm * power * (CLEARANCE_M / self.clearance_m);
        let film_nm = film_nm.min(self.cap_nm); // CD-1
        let Some(peak_rad_s) = self.peak_rad_s else {
            return film_nm;
        };
        let x = primary_rad_s / peak_rad_s;
        let fed = x / self.oil_share;
        film_nm * 2.0 * x / (1.0 + fed * fed) // CD-2
    }
}

keys! {
    /// Keys of `[transmission.cvt.reverse_clutch]`.
    CLUTCH: ClutchKeys = "reverse_clutch" [] {
        drag_nm: number(0.0, 20.0), "largest drag at 11 mm2/s and a clearance of 0.3 mm", ["CD-1"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["CD-1"];
        cap_nm: number(0.0, 20.0), "largest drag", ["CD-1"];
        peak_rpm: optional(number(200.0, 20_000.0)), "primary speed of the largest drag; absent: the same drag at every speed", ["CD-2"];
        clearance_mm: or(0.3, number(0.05, 3.0)), "clearance of a pair of plates", ["CD-1"];
        oil_share: or(1.0, number(0.05, 2.0)), "oil feed over the normal one", ["CD-2"];
        set_nm: or(0.0, number(0.0, 20.0)), "constant torque of the bearings of the forward-reverse set", ["CD-3"];
        set_nm_per_rpm: or(0.0, number(0.0, 0.05)), "their torque over speed at 11 mm2/s", ["CD-3"];
    }
}

impl ClutchDrag {
    /// The reverse clutch from the values of its table.
    pub(super) fn from_values<V: Values>(s: &V) -> Self {
        ClutchDrag {
            drag_nm: s.number(&CLUTCH.drag_nm),
            exponent: s.number(&CLUTCH.viscous_exponent),
            cap_nm: s.number(&CLUTCH.cap_nm),
            peak_rad_s: s.optional(&CLUTCH.peak_rpm),
            clearance_m: s.number(&CLUTCH.clearance_mm),
            oil_share: s.number(&CLUTCH.oil_share),
            set_nm: s.number(&CLUTCH.set_nm),
            set_nm_s: s.number(&CLUTCH.set_nm_per_rpm),
        }
    }
}
