//! Torque that turns an engine without fuel: friction, pumping, accessories of its own.

use crate::math::{Gather, Real, physics};

/// Mean effective pressure that the hot engine takes up with its throttle closed and no fuel, over mean piston speed (EN-7).
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Motored<R: Real = f64> {
    /// At no speed, Pa.
    pub rest_pa: R,
    /// Over piston speed, Pa s/m.
    pub pa_per_m_s: R,
    /// Over its square, Pa s2/m2.
    pub pa_per_m_s2: R,
}

#[physics]
impl<R: Real> Motored<R> {
    /// The pressure at a mean piston speed, Pa.
    pub fn hot_pa(&self, piston_m_s: R) -> R {
        self.rest_pa + (self.pa_per_m_s + self.pa_per_m_s2 * piston_m_s) * piston_m_s
    }
}
