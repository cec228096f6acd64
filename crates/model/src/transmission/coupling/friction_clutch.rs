//! A wet or dry friction clutch: it slips from idle to lock-up while pulling away, creeping and stopping.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LC-1 | engine speed while slipping: idle up to the creep torque, above it rising to n_engage + sqrt(T/k) | source: thesis 1.1.2 (engages from about 1000 rpm, 1700 rpm plateau); form ASSUMED |
//! | LC-2 | creep torque at standstill, falling linearly to zero as the input shaft reaches idle speed | ASSUMED |
//! | LC-3 | in overrun the coupling lets go from 0.2 idle speed above the release speed down to 1.1 idle speed | source: thesis 1.1.2 (order of the variogram); ramp ASSUMED |
//! | LC-5 | once coupled it stays locked; between 1.2 idle speed and idle speed it lets the engine slip again | derived: locked until the engine would be dragged below idle; width ASSUMED |
//! | LC-7 | at least speed: LC-1 with w_e = max(idle, w_input) whatever the torque | derived: at a torque of the clutch fuel rises with the engine's speed; a clutch that is pressed by oil of its own needs no speed to carry a torque |
//! | LC-4 | slip loss = T (w_engine - w_input) | derived: power balance |

use super::{Coupling, CouplingLoad, EngineSide, Launch};
use crate::keys::{Values, keys};
use crate::math::{Gather, Mask, Real, physics, ramp};

/// A friction clutch that slips at launch.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct FrictionClutch<R: Real = f64> {
    /// Engine speed at which it begins to engage, rad/s.
    pub engage_rad_s: R,
    /// Torque per square of speed above it, Nm s2/rad2.
    pub gain_nm_s2: R,
    /// Creep torque at standstill with the engine idling, Nm.
    pub creep_nm: R,
    /// Input speed below which it opens in overrun, rad/s.
    pub release_rad_s: R,
}

/// Input speed over idle speed from which a coupled clutch does not slip (LC-5).
const LOCKED_OVER_IDLE: f64 = 1.2;
/// Width of the transition from creeping to launching, Nm.
const CREEP_WIDTH_NM: f64 = 5.0;
/// Speed that rounds off the square root at zero torque, rad/s (200 rpm).
const ROUND_RAD_S: f64 = 20.944;
/// Square of that speed, (rad/s)2.
const ROUND_SQUARED: f64 = ROUND_RAD_S * ROUND_RAD_S;

#[physics]
impl<R: Real> Coupling<R> for FrictionClutch<R> {
    /// LC-1, LC-5: never below idle nor below the input shaft.
    fn engine_rad_s(&self, load: &CouplingLoad<R>) -> R {
        self.steady_rad_s(load)
    }

    fn locked_from_rad_s(&self, idle_rad_s: R) -> R {
        LOCKED_OVER_IDLE * idle_rad_s
    }

    /// CV-6: in overrun the power passes unchanged, since a clutch whose engine still slows down from a higher speed can neither give
    /// nor take energy.
    fn engine_side(&self, output_nm: R, output_rad_s: R, engine_rad_s: R) -> EngineSide<R> {
        let overruns = output_nm.lt(0.0);
        let mut engine_nm = output_nm;
        if overruns.any() {
            engine_nm = overruns.select(output_nm * output_rad_s / engine_rad_s, engine_nm);
        }
        let slipping_nm = overruns.select(output_nm.splat(0.0), output_nm);
        EngineSide {
            engine_nm,
            engine_rad_s,
            loss_w: slipping_nm * (engine_rad_s - output_rad_s), // LC-4, CV-6
        }
    }

    #[inline]
    fn at_least_speed(&self) -> Option<Launch<R>> {
        Some(Launch::clutch(self.of_least_speed()))
    }

    fn output_nm(&self, engine_nm: R, _output_rad_s: R, _engine_rad_s: R) -> R {
        engine_nm
    }

    fn creep_nm(&self, output_rad_s: R, idle_rad_s: R) -> R {
        self.creep_nm * (1.0 - ramp(output_rad_s, idle_rad_s.splat(0.0), idle_rad_s)) // LC-2
    }

    fn overrun_share(&self, output_rad_s: R, idle_rad_s: R) -> R {
        let from = 1.1 * idle_rad_s;
        let to = self.release_rad_s.max(from);
        ramp(output_rad_s, from, to + 0.2 * idle_rad_s) // LC-3
    }
}

impl<R: Real> FrictionClutch<R> {
    /// The clutch whose engine is never faster than it has to be (LC-7).
    pub(super) fn of_least_speed(&self) -> Self {
        FrictionClutch {
            engage_rad_s: self.engage_rad_s.splat(0.0),
            gain_nm_s2: self.gain_nm_s2.splat(f64::INFINITY),
            ..*self
        } // LC-7
    }

    /// LC-1, LC-5.
    #[physics]
    fn steady_rad_s(&self, load: &CouplingLoad<R>) -> R {
        let CouplingLoad {
            output_nm,
            output_rad_s,
            idle_rad_s,
            coupled,
        } = *load;
        let locked = coupled & output_rad_s.ge(LOCKED_OVER_IDLE * idle_rad_s);
        if locked.all() {
            return output_rad_s;
        }
        let above = output_nm - self.creep_nm;
        let mut speed = idle_rad_s;
        let pulls = above.gt(0.0);
        if pulls.any() {
            let lifts = self.engage_rad_s.gt(idle_rad_s);
            let lift = lifts.select(self.engage_rad_s - idle_rad_s, above.splat(0.0));
            let raised = lift * (1.0 - (-above / CREEP_WIDTH_NM).exp())
                + (above / self.gain_nm_s2 + ROUND_SQUARED).sqrt()
                - ROUND_RAD_S; // LC-1
            speed = pulls.select(speed + raised, speed);
        }
        let slower = locked | speed.le(output_rad_s);
        if slower.all() {
            return output_rad_s;
        }
        let mut slip_share = above.splat(1.0);
        if coupled.any() {
            let stays = ramp(output_rad_s, idle_rad_s, LOCKED_OVER_IDLE * idle_rad_s);
            slip_share = coupled.select(1.0 - stays, slip_share);
        }
        let slipping = output_rad_s + slip_share * (speed - output_rad_s); // LC-5
        slower.select(output_rad_s, slipping)
    }
}

keys! {
    /// Keys of `[….launch.friction_clutch]`.
    FRICTION_CLUTCH: FrictionClutchKeys = "friction_clutch" [] {
        engage_rpm: or(1000.0, number(300.0, 5000.0)), "engine speed at which it begins to engage", ["LC-1"];
        gain_nm_per_rpm2: or(3.0e-5, number(1e-7, 1e-2)), "torque over the square of engine speed above it", ["LC-1"];
        creep_nm: computed("5 with a CVT, 0 with a manual gearbox", number(0.0, 50.0)), "torque passed on at idle in gear", ["LC-2"];
        release_rpm: or(1000.0, number(300.0, 5000.0)), "input speed below which it opens in overrun", ["LC-3"];
    }
}

impl FrictionClutch {
    /// A clutch from the values of its keys; `creep_nm` is the default of its creep torque.
    pub(super) fn from_values<V: Values>(s: &V, creep_nm: f64) -> Self {
        FrictionClutch {
            engage_rad_s: s.number(&FRICTION_CLUTCH.engage_rpm),
            gain_nm_s2: s.number(&FRICTION_CLUTCH.gain_nm_per_rpm2),
            creep_nm: s.number_or(&FRICTION_CLUTCH.creep_nm, creep_nm),
            release_rad_s: s.number(&FRICTION_CLUTCH.release_rpm),
        }
    }
}
