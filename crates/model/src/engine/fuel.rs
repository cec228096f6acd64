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
use crate::math::held;

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
    #[must_use]
    #[inline]
    pub fn hot_friction_pa(&self, piston_m_s: f64) -> f64 {
        match self {
            FuelModel::Willans(w) => (w.l + w.l2 * piston_m_s * piston_m_s) * BAR,
            FuelModel::Map(m) => (m.friction.0 + m.friction.1 * piston_m_s * piston_m_s) * BAR,
        }
    }

    /// Fuel for a brake mean effective pressure with friction in force, both Pa.
    #[must_use]
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
        let b = held(line, *EFFICIENCY.start(), *EFFICIENCY.end());
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

#[cfg(test)]
mod tests {
    use super::*;

    fn willans() -> Willans {
        Willans {
            a: 0.4851,
            b: 0.01193,
            c: -0.00065,
            a2: -0.00385,
            l: 2.39882,
            l2: 0.00286,
        }
    }

    /// BSFC of the natural-aspiration set at 2000 rpm and 79 mm stroke, from the facts table (g/kWh at bmep bar).
    #[test]
    fn val_bsfc_table() {
        let w = willans();
        let cm = 2000.0 * 79.0 / 30_000.0;
        let friction = (w.l + w.l2 * cm * cm) * BAR;
        for (bmep, bsfc) in [
            (1.0, 576.0),
            (2.0, 377.0),
            (3.0, 313.0),
            (4.0, 283.0),
            (6.0, 257.0),
            (8.0, 249.0),
            (10.0, 251.0),
        ] {
            let p = FuelModel::Willans(w).fuel_mep(cm, 209.0, bmep * BAR, friction);
            let got = p.fuel_pa / (bmep * BAR) / 43.2e6 * 3.6e9;
            assert!(
                (got / bsfc - 1.0).abs() < 0.004,
                "{bmep} bar: {got:.1} instead of {bsfc}"
            );
        }
    }

    #[test]
    fn fuel_is_cut_where_the_line_reaches_zero() {
        let p = FuelModel::Willans(willans()).fuel_mep(5.0, 200.0, -3.0 * BAR, 2.4 * BAR);
        assert!(p.fuel_pa.abs() < 1e-12 && !p.outside);
    }

    /// A map made from the Willans line gives the line back at its points, hot and cold.
    #[test]
    fn map_agrees_with_the_line_it_was_made_from() {
        let line = FuelModel::Willans(willans());
        let speeds = [100.0, 200.0, 400.0];
        let bmeps: Vec<f64> = (1..=20).map(|i| 0.5 * BAR * f64::from(i)).collect();
        let stroke = 0.079;
        let cm = |s: f64| s * stroke / std::f64::consts::PI;
        let fuel = speeds
            .iter()
            .map(|&s| {
                bmeps
                    .iter()
                    .map(|&p| {
                        line.fuel_mep(cm(s), s, p, line.hot_friction_pa(cm(s)))
                            .fuel_pa
                    })
                    .collect()
            })
            .collect();
        let map = FuelModel::Map(BsfcMap {
            speed_rad_s: speeds.to_vec(),
            bmep_pa: bmeps,
            fuel_pa: fuel,
            friction: (2.39882, 0.00286),
        });
        for p in [1.0, 3.0, 6.0] {
            let hot = line.hot_friction_pa(cm(200.0));
            let a = line.fuel_mep(cm(200.0), 200.0, p * BAR, 1.5 * hot).fuel_pa;
            let b = map
                .fuel_mep(
                    cm(200.0),
                    200.0,
                    p * BAR,
                    1.5 * map.hot_friction_pa(cm(200.0)),
                )
                .fuel_pa;
            assert!((a / b - 1.0).abs() < 0.01, "{p} bar: {a} {b}");
        }
    }
}
