//! Reads a `[launch]` table.

use crate::{Bound, Section};
use cvtcycle_model::transmission::launch::{FrictionClutch, Launch};
use std::sync::Arc;

/// Reads the launch device; `creep_nm` is the default of its creep torque.
#[must_use]
pub fn load(s: &Section, creep_nm: f64) -> Arc<dyn Launch> {
    let (_, c) = s.choose(
        "launch",
        &["friction_clutch"],
        Some("friction_clutch"),
        "launch device: a wet or dry friction clutch",
    );
    let rpm = Bound::closed(300.0, 5000.0);
    Arc::new(FrictionClutch {
        engage_rad_s: c.number_or(
            "engage_rpm",
            rpm,
            1000.0,
            "engine speed at which it begins to engage (LC-1)",
        ),
        gain_nm_s2: c.number_or(
            "gain_nm_per_rpm2",
            Bound::closed(1e-7, 1e-2),
            3.0e-5,
            "torque over the square of engine speed above it (LC-1)",
        ),
        creep_nm: c.number_or(
            "creep_nm",
            Bound::closed(0.0, 50.0),
            creep_nm,
            "torque passed on at idle in gear (LC-2)",
        ),
        release_rad_s: c.number_or(
            "release_rpm",
            rpm,
            1000.0,
            "input speed below which it opens in overrun (LC-3)",
        ),
    })
}
