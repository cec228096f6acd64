//! Fuel against speed and load: extended Willans line, or a measured map.
//!
//! | label | statement | status |
//! |---|---|---|
//! | WI-1 | A f2 + B f - (L Theta + p) = 0; A = a2, B = a + b c + c2 cm2, L = l + l2 cm2 (positive) | source: CO2MPAS, natural aspiration set |
//! | WI-2 | indicated = B f + A f2 | derived: WI-1 read as a balance |
//! | BM-3 | cold: BMEP raised by friction above hot friction | derived: as WI-1 treats temperature |
//!
//! f fuel mean effective pressure, p brake mean effective pressure, both bar inside WI-1; cm mean piston speed m/s; Theta friction factor.
//! Valid while WI-1 has a root, p up to about 14 bar; beyond it the turning point is held and the row flagged. B is held between 0.05 and 1,
//! and fuel of a map at no less than the indicated work, so that no engine makes work of nothing: the row is flagged too. The reader refuses a
//! line that would leave these bounds below the engine's highest speed.

use crate::maps::BsfcMap;
use crate::math::clamp;

const BAR: f64 = 1e5;
/// Efficiency B that a line may have.
pub const EFFICIENCY: std::ops::RangeInclusive<f64> = 0.05..=1.0;

/// Coefficients of the extended Willans line, per displacement, in bar and m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Willans {
    /// a.
    pub a: f64,
    /// b, s/m.
    pub b: f64,
    /// c, s2/m2.
    pub c: f64,
    /// a2, 1/bar.
    pub a2: f64,
    /// Friction at zero speed, bar, positive.
    pub l: f64,
    /// Friction over piston speed squared, bar s2/m2, positive.
    pub l2: f64,
}

/// A fuel model.
#[derive(Clone, Debug, PartialEq)]
pub enum FuelModel {
    /// Extended Willans line.
    Willans(Willans),
    /// Measured map.
    Map(BsfcMap),
}

/// Answer of a fuel model, mean effective pressures in Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuelPoint {
    /// Fuel mean effective pressure; 0 when fuel is cut.
    pub fuel_pa: f64,
    /// Indicated mean effective pressure.
    pub indicated_pa: f64,
    /// Outside the model's validity.
    pub outside: bool,
}

impl FuelModel {
    /// Friction mean effective pressure of the hot engine, Pa.
    #[inline]
    pub fn hot_friction_pa(&self, piston_m_s: f64) -> f64 {
        match self {
            FuelModel::Willans(w) => (w.l + w.l2 * piston_m_s * piston_m_s) * BAR,
            FuelModel::Map(m) => (m.friction.0 + m.friction.1 * piston_m_s * piston_m_s) * BAR,
        }
    }

    /// Fuel for a brake mean effective pressure with friction in force, both Pa.
    #[inline]
    pub fn fuel_mep(
        &self,
        piston_m_s: f64,
        speed_rad_s: f64,
        brake_pa: f64,
        friction_pa: f64,
    ) -> FuelPoint {
        let need = brake_pa + friction_pa;
        if need <= 0.0 {
            return FuelPoint {
                fuel_pa: 0.0,
                indicated_pa: 0.0,
                outside: false,
            };
        }
        match self {
            FuelModel::Willans(w) => w.fuel(piston_m_s, need),
            FuelModel::Map(m) => {
                let hot = self.hot_friction_pa(piston_m_s);
                let (fuel_pa, inside) = m.at_speed(speed_rad_s, need - hot, hot); // BM-3
                let possible = fuel_pa >= need;
                // Below the map both go to zero together, up to rounding.
                let outside = !inside || fuel_pa < need * (1.0 - 1e-6) - 1e-3;
                FuelPoint {
                    fuel_pa: if possible { fuel_pa } else { need },
                    indicated_pa: need,
                    outside,
                }
            }
        }
    }
}

impl Willans {
    /// Indicated efficiency at no load, B.
    #[inline]
    pub fn efficiency(&self, piston_m_s: f64) -> f64 {
        self.a + (self.b + self.c * piston_m_s) * piston_m_s
    }

    #[inline]
    fn fuel(&self, piston_m_s: f64, need_pa: f64) -> FuelPoint {
        let line = self.efficiency(piston_m_s);
        let b = clamp(line, *EFFICIENCY.start(), *EFFICIENCY.end());
        let need = need_pa / BAR;
        let disc = b * b + 4.0 * self.a2 * need;
        let turned = disc < 0.0;
        let f = 2.0 * need / (b + if turned { 0.0 } else { disc.sqrt() }); // WI-1
        let indicated = (b + self.a2 * f) * f; // WI-2
        let outside = turned || !EFFICIENCY.contains(&line);
        FuelPoint {
            fuel_pa: f * BAR,
            indicated_pa: if turned { need_pa } else { indicated * BAR },
            outside,
        }
    }
}
