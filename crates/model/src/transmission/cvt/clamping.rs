//! Pressure of the clamp laws that look at the belt (PC-3, PC-4, PC-6), with the causes of a smallest one (PC-5).

use super::Cvt;
use super::controller::{ClampLaw, PressurePoint};
use super::floors::Held;
use super::variator::{BeltAtRatio, BeltLoad, belt_state};
use crate::math::{larger, smaller};
use crate::transmission::clamp_cause::ClampCause;

/// Steps of the slip-limited law's walk from its lowest pressure to the cap.
const SLIP_STEPS: u32 = 32;

/// The belt that a clamp law looks at.
pub(super) struct Clamping<'a> {
    pub cvt: &'a Cvt,
    pub at: &'a BeltAtRatio,
    pub load: &'a BeltLoad,
    pub secondary_rad_s: f64,
    /// Logarithm of the force ratio that the shift needs (PC-5).
    pub force_log: f64,
}

impl Clamping<'_> {
    /// Secondary pressure that a law and PC-5 demand, Pa, not yet below the cap, and which of them.
    #[inline(never)]
    pub fn pressure_pa(&self, law: &ClampLaw) -> (f64, ClampCause) {
        match *law {
            ClampLaw::Map(_) => (f64::NAN, ClampCause::Law), // looks at the engine only
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
                let pressure_pa = self.for_slip_pa(slip, least_pa);
                if pressure_pa > least_pa {
                    (pressure_pa, ClampCause::Law)
                } else {
                    (least_pa, cause)
                }
            }
        }
    }

    /// Pressure of the table, or that of the cause that needs more (PC-6, PC-5); without a table that of the torque.
    fn of_table_pa(&self) -> (f64, ClampCause) {
        let held = self.held(1.0, self.load.output_torque_nm.abs());
        let at = PressurePoint::of_belt(
            self.load.output_torque_nm,
            self.at.geometry.ratio,
            self.secondary_rad_s,
        );
        let table = self.cvt.pressure_table.as_ref();
        held.above(table.map_or_else(|| held.of_torque_pa(), |table| table.pressure_pa(&at))) // PC-6
    }

    /// Pressure for the torque with a safety factor, or that of the cause that needs more (PC-3, PC-5).
    fn for_torque_pa(&self, safety: f64, least_nm: f64) -> (f64, ClampCause) {
        let torque = larger(self.load.output_torque_nm.abs(), least_nm);
        let held = self.held(safety, torque);
        held.above(held.of_torque_pa())
    }

    /// The belt at a torque with a safety factor, Nm (PC-3).
    fn held(&self, safety: f64, torque: f64) -> Held<'_> {
        let (cvt, at, load) = (self.cvt, self.at, self.load);
        let formulation = cvt.belt.formulation;
        let segment = formulation.segment_friction(load.segment_friction);
        let mu = formulation.capacity_friction(segment, load.capacity_friction);
        let weaker = smaller(at.thrust_ratio, 1.0);
        let force = safety * torque * cvt.belt.cos_wedge
            / (2.0 * mu * at.geometry.secondary_radius_m * weaker); // PC-3
        Held {
            cvt,
            at,
            load,
            own_n: cvt.secondary_clamp_n(0.0, self.secondary_rad_s),
            need_n: force,
            force_log: self.force_log,
        }
    }

    /// Slip at a pressure, Pa.
    fn slip(&self, pressure_pa: f64) -> f64 {
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
    }

    fn for_slip_pa(&self, limit: f64, least_pa: f64) -> f64 {
        let floor = least_pa;
        if floor >= self.cvt.cap_pa || self.slip(floor) <= limit {
            return floor;
        }
        // Slip falls with clamping force until the stretch of the bands outweighs the grip, then rises: walk up to the first
        // pressure that meets the limit, or to the least slip where none does.
        let step = (self.cvt.cap_pa - floor) / f64::from(SLIP_STEPS);
        let at_step = |k: u32| floor + step * f64::from(k);
        let mut best = (self.slip(floor), 0);
        for k in 1..=SLIP_STEPS {
            let now = self.slip(at_step(k));
            if now <= limit {
                return bisect(at_step(k - 1), at_step(k), |pa| self.slip(pa) > limit);
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
        let least = least_of(low, high, |pa| self.slip(pa));
        if self.slip(least) <= limit {
            bisect(low, least, |pa| self.slip(pa) > limit)
        } else {
            least
        } // PC-4
    }
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
