//! Fuel against speed and load: extended Willans line, or a measured map.
//!
//! | label | statement | status |
//! |---|---|---|
//! | WI-1 | A f2 + B f - (L Theta + p) = 0; A = a2, B = a + b c + c2 cm2, L = l + l2 cm2 (positive) | source: CO2MPAS, natural aspiration set |
//! | WI-2 | indicated = B f + A f2 | derived: WI-1 read as a balance |
//! | BM-3 | cold: BMEP raised by friction above hot friction | derived: as WI-1 treats temperature |
//! | WI-3 | with a drag of its own (EN-7), below the torque at which the hot engine turns itself: fuel and indicated work fall in proportion to nothing at the drag | derived: continuous at both ends; indicated efficiency of idling |
//!
//! f fuel mean effective pressure, p brake mean effective pressure, both bar inside WI-1; cm mean piston speed m/s; Theta friction factor.
//! Valid while WI-1 has a root, L Theta + p up to -B2/(4 A): 13 to 16 bar of p with the set of CO2MPAS for natural aspiration, 22 to 28 with those of engines measured since 2012;
//! beyond it the turning point is held and the row flagged. B is held between 0.05 and 1,
//! and fuel of a map at no less than the indicated work, so that no engine makes work of nothing: the row is flagged too. The reader refuses a
//! line that would leave these bounds below the engine's highest speed.

use crate::maps::BsfcMap;
use crate::math::{Gather, Mask, Real, physics};

const BAR: f64 = 1e5;
/// Fuel over indicated work, both near zero, from which rounding explains that it is less.
const ALMOST_ALL: f64 = 1.0 - 1e-6;
/// Efficiency B that a line may have.
pub const EFFICIENCY: std::ops::RangeInclusive<f64> = 0.05..=1.0;

/// Coefficients of the extended Willans line, per displacement, in bar and m/s.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Willans<R: Real = f64> {
    /// a.
    pub a: R,
    /// b, s/m.
    pub b: R,
    /// c, s2/m2.
    pub c: R,
    /// a2, 1/bar.
    pub a2: R,
    /// Friction at zero speed, bar, positive.
    pub l: R,
    /// Friction over piston speed squared, bar s2/m2, positive.
    pub l2: R,
}

/// A fuel model.
#[derive(Clone, Debug, PartialEq)]
pub enum FuelModel<R: Real = f64> {
    /// Extended Willans line.
    Willans(Willans<R>),
    /// Measured map.
    Map(R::PerLane<BsfcMap>),
}

impl Gather for FuelModel {
    type Together<R: Real> = FuelModel<R>;

    fn gather<R: Real>(like: R, of: &[&Self]) -> FuelModel<R> {
        match of[0] {
            FuelModel::Willans(first) => {
                let line = |model: &&'_ Self| match model {
                    FuelModel::Willans(line) => *line,
                    FuelModel::Map(_) => *first, // never in one group
                };
                let lines: Vec<Willans> = of.iter().map(line).collect();
                FuelModel::Willans(Gather::gather(like, &lines.iter().collect::<Vec<_>>()))
            }
            FuelModel::Map(first) => FuelModel::Map(R::per_lane(|run| match of[run] {
                FuelModel::Map(map) => map.clone(),
                FuelModel::Willans(_) => first.clone(), // never in one group
            })),
        }
    }

    fn lane<R: Real>(together: &FuelModel<R>, lane: usize) -> Self {
        match together {
            FuelModel::Willans(line) => FuelModel::Willans(Willans::lane(line, lane)),
            FuelModel::Map(map) => FuelModel::Map(R::get(map, lane).clone()),
        }
    }

    fn groups_with(&self, other: &Self) -> bool {
        matches!(
            (self, other),
            (FuelModel::Willans(_), FuelModel::Willans(_)) | (FuelModel::Map(_), FuelModel::Map(_))
        )
    }
}

/// Answer of a fuel model, mean effective pressures in Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuelPoint<R: Real = f64> {
    /// Fuel mean effective pressure; 0 when fuel is cut.
    pub fuel_pa: R,
    /// Indicated mean effective pressure.
    pub indicated_pa: R,
    /// Outside the model's validity.
    pub outside: R::Mask,
}

#[physics]
impl<R: Real> FuelModel<R> {
    /// Friction mean effective pressure of the hot engine, Pa.
    pub fn hot_friction_pa(&self, piston_m_s: R) -> R {
        match self {
            FuelModel::Willans(w) => (w.l + w.l2 * piston_m_s * piston_m_s) * BAR,
            FuelModel::Map(m) => {
                let friction = piston_m_s.map_lanes(|run| R::get(m, run).friction.0);
                let per_square = piston_m_s.map_lanes(|run| R::get(m, run).friction.1);
                (friction + per_square * piston_m_s * piston_m_s) * BAR
            }
        }
    }

    /// As [`FuelModel::fuel_mep`] for an engine whose drag without fuel is not its friction but `drag_pa` (WI-3), all Pa.
    ///
    /// The hot engine turns itself with the fuel that the line has at no torque. What it takes up without fuel is less than the friction
    /// at which the line ends (a line through loads says nothing of a closed throttle), so that between the two both fuel and indicated work
    /// go to nothing in proportion. Friction above that of the hot engine is met as load, as in BM-3.
    pub fn fuel_mep_above_drag(
        &self,
        piston_m_s: R,
        speed_rad_s: R,
        brake_pa: R,
        friction_pa: R,
        drag_pa: R,
    ) -> FuelPoint<R> {
        let hot = self.hot_friction_pa(piston_m_s);
        let colder = friction_pa - hot;
        let hot_drag = drag_pa - colder;
        let share = ((brake_pa + drag_pa) / hot_drag).clamp(0.0, 1.0);
        let fired = share.ge(1.0);
        let need = fired.select(brake_pa + friction_pa, hot * share);
        let none = share.splat(0.0).ge(share);
        let point = match self {
            FuelModel::Willans(w) => {
                let line = w.fuel(piston_m_s, fired.select(need, hot));
                FuelPoint {
                    fuel_pa: fired.select(line.fuel_pa, line.fuel_pa * share),
                    indicated_pa: fired.select(line.indicated_pa, line.indicated_pa * share),
                    outside: line.outside,
                }
            }
            FuelModel::Map(m) => {
                let hot_brake = brake_pa + colder;
                self.of_map(m, speed_rad_s, need, [hot_brake, hot_drag])
            }
        };
        FuelPoint {
            fuel_pa: none.select(share.splat(0.0), point.fuel_pa),
            indicated_pa: none.select(share.splat(0.0), point.indicated_pa),
            outside: !none & point.outside,
        }
    }

    /// Fuel for a brake mean effective pressure with friction in force, both Pa.
    pub fn fuel_mep(
        &self,
        piston_m_s: R,
        speed_rad_s: R,
        brake_pa: R,
        friction_pa: R,
    ) -> FuelPoint<R> {
        let need = brake_pa + friction_pa;
        let zero = need.splat(0.0);
        let none = zero.ge(need);
        if none.all() {
            return FuelPoint {
                fuel_pa: zero,
                indicated_pa: zero,
                outside: !none,
            };
        }
        let point = match self {
            FuelModel::Willans(w) => w.fuel(piston_m_s, need),
            FuelModel::Map(m) => {
                let hot = self.hot_friction_pa(piston_m_s);
                self.of_map(m, speed_rad_s, need, [need - hot, hot]) // BM-3
            }
        };
        FuelPoint {
            fuel_pa: none.select(zero, point.fuel_pa),
            indicated_pa: none.select(zero, point.indicated_pa),
            outside: !none & point.outside,
        }
    }

    /// Fuel of a measured map for an indicated mean effective pressure, from the brake mean effective pressure of the hot engine and the drag at
    /// which its fuel ends, all Pa.
    fn of_map(
        &self,
        map: &R::PerLane<BsfcMap>,
        speed_rad_s: R,
        need: R,
        [brake_pa, drag_pa]: [R; 2],
    ) -> FuelPoint<R> {
        let found = R::per_lane(|run| {
            let (brake_pa, drag_pa) = (brake_pa.lane(run), drag_pa.lane(run));
            R::get(map, run).at_speed(speed_rad_s.lane(run), brake_pa, drag_pa)
        });
        let fuel_pa = need.map_lanes(|run| R::get(&found, run).0);
        let inside = need.mask_lanes(|run| R::get(&found, run).1);
        // Below the map both go to zero together, up to rounding.
        let short = fuel_pa.lt(need * ALMOST_ALL - 1e-3);
        FuelPoint {
            fuel_pa: fuel_pa.ge(need).select(fuel_pa, need),
            indicated_pa: need,
            outside: !inside | short,
        }
    }
}

#[physics]
impl<R: Real> Willans<R> {
    /// Indicated efficiency at no load, B.
    pub fn efficiency(&self, piston_m_s: R) -> R {
        self.a + (self.b + self.c * piston_m_s) * piston_m_s
    }

    fn fuel(&self, piston_m_s: R, need_pa: R) -> FuelPoint<R> {
        let line = self.efficiency(piston_m_s);
        let (least, most) = (*EFFICIENCY.start(), *EFFICIENCY.end());
        let b = line.clamp(least, most);
        let need = need_pa * BAR.recip();
        let disc = b * b + 4.0 * self.a2 * need;
        let turned = disc.splat(0.0).gt(disc);
        let root = turned.select(disc.splat(0.0), disc.sqrt());
        let f = 2.0 * need / (b + root); // WI-1
        let indicated = (b + self.a2 * f) * f; // WI-2
        let inside = line.ge(least) & line.splat(most).ge(line);
        FuelPoint {
            fuel_pa: f * BAR,
            indicated_pa: turned.select(need_pa, indicated * BAR),
            outside: turned | !inside,
        }
    }
}
