//! Pressure of the clamp laws that look at the belt (PC-3, PC-4, PC-6), with the causes of a smallest one (PC-5).

use super::Cvt;
use super::controller::{ClampLaw, PressurePoint};
use super::floors::Held;
use super::variator::{BeltAtRatio, BeltLoad, belt_state};
use crate::math::{Mask, Real, physics};
use crate::transmission::clamp_cause::ClampCause;

/// Steps of the slip-limited law's walk from its lowest pressure to the cap.
const SLIP_STEPS: u32 = 32;

/// The belt that a clamp law looks at.
pub(super) struct Clamping<'a, R: Real = f64> {
    pub cvt: &'a Cvt<R>,
    pub at: &'a BeltAtRatio<R>,
    pub load: &'a BeltLoad<R>,
    pub secondary_rad_s: R,
    /// Logarithm of the force ratio that the shift needs (PC-5).
    pub force_log: R,
}

#[physics]
impl<R: Real> Clamping<'_, R> {
    /// Secondary pressure that a law and PC-5 demand, Pa, not yet below the cap, and the number of the cause.
    #[inline(never)]
    pub fn pressure_pa(&self, law: &ClampLaw<R>) -> (R, R) {
        self.force_log.vectorize(|| self.by_law_pa(law))
    }

    fn by_law_pa(&self, law: &ClampLaw<R>) -> (R, R) {
        match *law {
            // Looks at the engine only.
            ClampLaw::Map(_) => {
                let none = self.force_log.splat(f64::NAN);
                (none, none.splat(ClampCause::Law.number()))
            }
            ClampLaw::TorqueFollowing {
                safety,
                least_torque_nm,
            } => self.for_torque_pa(safety, least_torque_nm),
            ClampLaw::Table => self.of_table_pa(),
            ClampLaw::SlipLimited {
                slip,
                safety,
                least_torque_nm,
            } => {
                let (least_pa, cause) = self.for_torque_pa(safety, least_torque_nm);
                // Run by run: each walks its own way.
                let pressure_pa = slip.map_lanes(|lane| self.for_slip_pa(lane, slip, least_pa));
                let slips = pressure_pa.gt(least_pa);
                let by_law = cause.splat(ClampCause::Law.number());
                (
                    slips.select(pressure_pa, least_pa),
                    slips.select(by_law, cause),
                )
            }
        }
    }

    /// Pressure of the table, or that of the cause that needs more (PC-6, PC-5); without a table that of the torque.
    fn of_table_pa(&self) -> (R, R) {
        let torque_nm = self.load.output_torque_nm;
        let held = self.held(torque_nm.splat(1.0), torque_nm.abs());
        let Some(tables) = &self.cvt.pressure_table else {
            return held.raised(held.of_torque_pa());
        };
        let ratio = self.at.geometry.ratio;
        held.raised(torque_nm.map_lanes(|lane| {
            let (torque_nm, speed) = (torque_nm.lane(lane), self.secondary_rad_s.lane(lane));
            let at = PressurePoint::of_belt(torque_nm, ratio.lane(lane), speed);
            R::get(tables, lane).pressure_pa(&at)
        })) // PC-6
    }

    /// Pressure for the torque with a safety factor, or that of the cause that needs more (PC-3, PC-5).
    fn for_torque_pa(&self, safety: R, least_nm: R) -> (R, R) {
        let torque = self.load.output_torque_nm.abs().max(least_nm);
        let held = self.held(safety, torque);
        held.raised(held.of_torque_pa())
    }

    /// The belt at a torque with a safety factor, Nm (PC-3).
    fn held(&self, safety: R, torque: R) -> Held<'_, R> {
        let (cvt, at, load) = (self.cvt, self.at, self.load);
        let formulation = cvt.belt.formulation;
        let segment = formulation.segment_friction(load.segment_friction);
        let mu = formulation.capacity_friction(segment, load.capacity_friction);
        let weaker = at.thrust_ratio.min(1.0);
        let force = safety * torque * cvt.belt.cos_wedge
            / (2.0 * mu * at.geometry.secondary_radius_m * weaker); // PC-3
        Held {
            cvt,
            at,
            load,
            own_n: cvt.secondary_clamp_n(force.splat(0.0), self.secondary_rad_s),
            need_n: force,
            force_log: self.force_log,
        }
    }

    /// Slip of a run at a pressure, Pa.
    #[inline]
    fn slip(&self, lane: usize, pressure_pa: f64) -> f64 {
        let pressure_pa = self.force_log.splat(pressure_pa);
        let load = BeltLoad {
            secondary_clamp_n: self
                .cvt
                .secondary_clamp_n(pressure_pa, self.secondary_rad_s),
            ..*self.load
        };
        belt_state(&self.cvt.belt, self.at, &load)
            .losses
            .slip_total
            .abs()
            .lane(lane)
    }

    /// The pressure of a run, Pa, for its limit of slip.
    #[inline]
    fn for_slip_pa(&self, lane: usize, limit: R, least_pa: R) -> f64 {
        let (cap_pa, limit) = (self.cvt.cap_pa.lane(lane), limit.lane(lane));
        least_for_slip_pa(limit, (least_pa.lane(lane), cap_pa), |pa| {
            self.slip(lane, pa)
        })
    }
}

/// The lowest pressure from a floor to the cap, Pa, at which a slip is within its limit, or that of least slip (PC-4).
fn least_for_slip_pa(limit: f64, (floor, cap_pa): (f64, f64), slip: impl Fn(f64) -> f64) -> f64 {
    if floor >= cap_pa || slip(floor) <= limit {
        return floor;
    }
    // Slip falls with clamping force until the stretch of the bands outweighs the grip, then rises: walk up to the first
    // pressure that meets the limit, or to the least slip where none does.
    let step = (cap_pa - floor) / f64::from(SLIP_STEPS);
    let at_step = |k: u32| floor + step * f64::from(k);
    let mut best = (slip(floor), 0);
    for k in 1..=SLIP_STEPS {
        let now = slip(at_step(k));
        if now <= limit {
            return bisect(at_step(k - 1), at_step(k), |pa| slip(pa) > limit);
        }
        best = if now < best.0 { (now, k) } else { best };
    }
    let (low, high) = (
        at_step(best.1.saturating_sub(1)),
        at_step(if best.1 < SLIP_STEPS {
            best.1 + 1
        } else {
            SLIP_STEPS
        }),
    );
    let least = least_of(low, high, &slip);
    if slip(least) <= limit {
        bisect(low, least, |pa| slip(pa) > limit)
    } else {
        least
    } // PC-4
}

/// Where `above` changes from true at `low` to false at `high`.
fn bisect(mut low: f64, mut high: f64, above: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if above(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Place of the least value of a function with one valley between `low` and `high`, by golden section.
fn least_of(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    for _ in 0..60 {
        let (a, b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        if f(a) < f(b) {
            high = b;
        } else {
            low = a;
        }
    }
    0.5 * (low + high)
}
