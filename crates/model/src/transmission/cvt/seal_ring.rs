//! Split rings that seal the oil feed of the rotating cylinders.
//!
//! | label | statement | status |
//! |---|---|---|
//! | SR-1 | at each pulley: T = n mu psi p pi D w D/2 | derived: pressure p on the flank of width w presses a ring on its groove, psi the share that oil on the other side leaves; mu fitted, the rest ASSUMED |
//!
//! n rings a pulley, D their diameter m, p the pressure of the cylinder Pa. Rectangular rings of a CVT are face seals in mixed friction
//! (Gronitzki and Poll 2007): no term of viscosity or speed. Valid for p >= 0.

use crate::keys::{Values, keys};
use crate::math::{Gather, Real, physics};
use std::f64::consts::PI;

/// The checked rings of one pulley; both have the same.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct SealRing<R: Real = f64> {
    /// Friction of a ring on its groove.
    pub friction: R,
    /// Rings.
    pub rings: R,
    /// Diameter, m.
    pub diameter_m: R,
    /// Width of the flank, m.
    pub flank_m: R,
    /// Share of the pressure that presses.
    pub pressed_share: R,
}

#[physics]
impl<R: Real> SealRing<R> {
    /// Torque over the pressure of a cylinder, Nm/Pa (SR-1).
    pub fn torque_per_pa(&self) -> R {
        let flank_m2 = PI * self.diameter_m * self.flank_m;
        self.rings * self.friction * self.pressed_share * flank_m2 * (0.5 * self.diameter_m) // SR-1
    }
}

keys! {
    /// Keys of `[transmission.cvt.seal_ring]`.
    RING: SealRingKeys = "seal_ring" [] {
        friction: or(0.045, number(0.0, 0.3)), "friction of a ring on the flank of its groove", ["SR-1"];
        rings: integer(0, 20, 2), "rings of a pulley", ["SR-1"];
        diameter_mm: or(40.0, number(5.0, 300.0)), "diameter of the rings", ["SR-1"];
        flank_mm: or(2.0, number(0.1, 20.0)), "width of the flank that is pressed on", ["SR-1"];
        pressed_share: or(0.5, number(0.0, 1.0)), "share of the pressure that presses: 0.5 where it falls in a line over the flank", ["SR-1"];
    }
}

impl SealRing {
    /// The rings from the values of their table.
    pub(super) fn from_values<V: Values>(s: &V) -> Self {
        SealRing {
            friction: s.number(&RING.friction),
            rings: s.integer(&RING.rings) as f64,
            diameter_m: s.number(&RING.diameter_mm),
            flank_m: s.number(&RING.flank_mm),
            pressed_share: s.number(&RING.pressed_share),
        }
    }
}
