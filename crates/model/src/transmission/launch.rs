//! What couples the engine to the box while pulling away, creeping and stopping.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LC-1 | engine speed while slipping: idle up to the creep torque, above it rising to n_engage + sqrt(T/k) | source: thesis 1.1.2 (engages from about 1000 rpm, 1700 rpm plateau); form ASSUMED |
//! | LC-2 | creep torque at standstill, falling linearly to zero as the input shaft reaches idle speed | ASSUMED |
//! | LC-3 | in overrun the coupling lets go from 0.2 idle speed above the release speed down to 1.1 idle speed | source: thesis 1.1.2 (order of the variogram); ramp ASSUMED |
//! | LC-5 | once coupled it stays locked; between 1.2 idle speed and idle speed it lets the engine slip again | derived: locked until the engine would be dragged below idle; width ASSUMED |
//! | LC-4 | slip loss = T (w_engine - w_input) | derived: power balance |
//!
//! A wet or dry friction clutch slips from idle to lock-up. A torque converter will be another implementation of [`Launch`].

use std::sync::Arc;

use crate::keys::{Choice, Key, Values, keys, spec};
use crate::math::{exp, ramp};

/// Launch device as the driveline sees it; torques at the box's input shaft, Nm, speeds rad/s.
pub trait Launch: std::fmt::Debug + Send + Sync {
    /// Engine speed that goes with a transmitted torque, never below idle nor below the input shaft (LC-1, LC-5).
    fn engine_speed_rad_s(
        &self,
        torque_nm: f64,
        input_speed_rad_s: f64,
        idle_rad_s: f64,
        coupled: bool,
    ) -> f64;
    /// Whether, once coupled, it holds engine and input shaft together without slip (LC-5).
    fn holds(&self, input_speed_rad_s: f64, idle_rad_s: f64) -> bool {
        input_speed_rad_s >= self.holds_from_rad_s(idle_rad_s)
    }
    /// Input speed from which it does, rad/s (LC-5).
    fn holds_from_rad_s(&self, idle_rad_s: f64) -> f64;
    /// Torque that the idling engine passes on without being asked, Nm (LC-2).
    fn creep_torque_nm(&self, input_speed_rad_s: f64, idle_rad_s: f64) -> f64;
    /// Share of the engine's overrun torque that the coupling carries, 0..1 (LC-3).
    fn overrun_share(&self, input_speed_rad_s: f64, idle_rad_s: f64) -> f64;
}

/// A friction clutch that slips at launch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionClutch {
    /// Engine speed at which it begins to engage, rad/s.
    pub engage_rad_s: f64,
    /// Torque per square of speed above it, Nm s2/rad2.
    pub gain_nm_s2: f64,
    /// Creep torque at standstill with the engine idling, Nm.
    pub creep_nm: f64,
    /// Input speed below which it opens in overrun, rad/s.
    pub release_rad_s: f64,
}

/// Input speed over idle speed from which a coupled clutch does not slip (LC-5).
const LOCKED_OVER_IDLE: f64 = 1.2;
/// Width of the transition from creeping to launching, Nm.
const CREEP_WIDTH_NM: f64 = 5.0;
/// Speed that rounds off the square root at zero torque, rad/s (200 rpm).
const ROUND_RAD_S: f64 = 20.944;

impl Launch for FrictionClutch {
    #[inline]
    fn engine_speed_rad_s(
        &self,
        torque_nm: f64,
        input_speed_rad_s: f64,
        idle_rad_s: f64,
        coupled: bool,
    ) -> f64 {
        let locked = LOCKED_OVER_IDLE * idle_rad_s;
        if coupled && self.holds(input_speed_rad_s, idle_rad_s) {
            return input_speed_rad_s;
        }
        let above = torque_nm - self.creep_nm;
        let mut speed = idle_rad_s;
        if above > 0.0 {
            let lift = if self.engage_rad_s > idle_rad_s {
                self.engage_rad_s - idle_rad_s
            } else {
                0.0
            };
            speed += lift * (1.0 - exp(-above / CREEP_WIDTH_NM))
                + (above / self.gain_nm_s2 + ROUND_RAD_S * ROUND_RAD_S).sqrt()
                - ROUND_RAD_S; // LC-1
        }
        if speed <= input_speed_rad_s {
            return input_speed_rad_s;
        }
        let slips = if coupled {
            1.0 - ramp(input_speed_rad_s, idle_rad_s, locked)
        } else {
            1.0
        };
        input_speed_rad_s + slips * (speed - input_speed_rad_s) // LC-5
    }

    #[inline]
    fn holds_from_rad_s(&self, idle_rad_s: f64) -> f64 {
        LOCKED_OVER_IDLE * idle_rad_s
    }

    #[inline]
    fn creep_torque_nm(&self, input_speed_rad_s: f64, idle_rad_s: f64) -> f64 {
        self.creep_nm * (1.0 - ramp(input_speed_rad_s, 0.0, idle_rad_s)) // LC-2
    }

    #[inline]
    fn overrun_share(&self, input_speed_rad_s: f64, idle_rad_s: f64) -> f64 {
        let from = 1.1 * idle_rad_s;
        let to = if self.release_rad_s > from {
            self.release_rad_s
        } else {
            from
        };
        ramp(input_speed_rad_s, from, to + 0.2 * idle_rad_s) // LC-3
    }
}

keys! {
    /// Keys of `[….launch.friction_clutch]`.
    FRICTION_CLUTCH: FrictionClutchKeys = "friction_clutch" [] {
        engage_rpm: or(1000.0, number(300.0, 5000.0)), "engine speed at which it begins to engage (LC-1)";
        gain_nm_per_rpm2: or(3.0e-5, number(1e-7, 1e-2)), "torque over the square of engine speed above it (LC-1)";
        creep_nm: computed("5 with a CVT, 0 with a manual gearbox", number(0.0, 50.0)), "torque passed on at idle in gear (LC-2)";
        release_rpm: or(1000.0, number(300.0, 5000.0)), "input speed below which it opens in overrun (LC-3)";
    }
}

/// Row of the key `launch`, which every gearbox has.
pub const LAUNCH: spec::Spec = spec::or_word(
    "friction_clutch",
    spec::options(&[Choice::new(
        "friction_clutch",
        "friction clutch, wet or dry",
        FrictionClutchKeys::TABLE,
    )]),
);

/// The launch device of a gearbox; `creep_nm` is the default of its creep torque.
#[must_use]
pub fn from_values<V: Values>(s: &V, key: &Key<'_>, creep_nm: f64) -> Arc<dyn Launch> {
    let (_, c) = s.choose(key);
    Arc::new(FrictionClutch {
        engage_rad_s: c.number(&FRICTION_CLUTCH.engage_rpm),
        gain_nm_s2: c.number(&FRICTION_CLUTCH.gain_nm_per_rpm2),
        creep_nm: c.number_or(&FRICTION_CLUTCH.creep_nm, creep_nm),
        release_rad_s: c.number(&FRICTION_CLUTCH.release_rpm),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clutch() -> FrictionClutch {
        let rpm = std::f64::consts::PI / 30.0;
        FrictionClutch {
            engage_rad_s: 1000.0 * rpm,
            gain_nm_s2: 2.1e-5 / rpm / rpm,
            creep_nm: 5.0,
            release_rad_s: 1000.0 * rpm,
        }
    }

    #[test]
    fn creeps_at_idle_and_rises_with_torque() {
        let (c, idle) = (clutch(), 89.0);
        assert!((c.engine_speed_rad_s(5.0, 0.0, idle, false) - idle).abs() < 1e-12);
        let mut last = idle;
        for i in 1..100 {
            let now = c.engine_speed_rad_s(5.0 + f64::from(i), 0.0, idle, false);
            assert!(now > last);
            last = now;
        }
        assert!((c.engine_speed_rad_s(20.0, 300.0, idle, false) - 300.0).abs() < 1e-12);
    }

    #[test]
    fn stays_locked_until_near_idle() {
        let (c, idle) = (clutch(), 89.0);
        assert!((c.engine_speed_rad_s(60.0, 150.0, idle, true) - 150.0).abs() < 1e-12);
        assert!(c.engine_speed_rad_s(60.0, 150.0, idle, false) > 200.0);
        assert!(c.engine_speed_rad_s(60.0, 95.0, idle, true) > 120.0);
    }

    #[test]
    fn creep_vanishes_at_idle_speed_and_overrun_share_stays_in_bounds() {
        let c = clutch();
        assert!(
            (c.creep_torque_nm(0.0, 89.0) - 5.0).abs() < 1e-12
                && c.creep_torque_nm(89.0, 89.0).abs() < 1e-12
        );
        assert!(
            c.overrun_share(89.0, 89.0).abs() < 1e-12
                && (c.overrun_share(200.0, 89.0) - 1.0).abs() < 1e-12
        );
    }
}
