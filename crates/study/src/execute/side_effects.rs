//! Side effects of a change of the car other than fuel, from the rows of a run.

use crate::store::{Head, Kind};
use cvtcycle_model::keys::{RPM, rpm};
use cvtcycle_model::transmission::clamp_cause::ClampCause;
use cvtcycle_output::{Flags, Row};

/// Share of full load above which a slow locked engine is heard and felt.
const LOADED: f64 = 0.5;

/// Seconds in which a floor decides the clamp pressure.
pub const FLOOR: &str = "clamp_floor_s";
/// Seconds of a slow, loaded engine behind a closed clutch.
pub const LUGGING: &str = "lugging_s";
/// Least share of full load that is left.
pub const RESERVE: &str = "least_reserve_percent";
/// Least speed of a driving engine behind a closed clutch.
pub const LOCKED: &str = "lowest_locked_rpm";

/// Names, units and meanings of the numbers.
const COLUMNS: [(&str, &str, &str); 4] = [
    (
        FLOOR,
        "s",
        "moving time in which a floor and not the clamp law decides the secondary pressure",
    ),
    (
        LUGGING,
        "s",
        "time with the clutch closed, the engine slower than the speed of noise and vibration, and above half of full load",
    ),
    (
        RESERVE,
        "%",
        "least share of full load that is left while the car moves",
    ),
    (
        LOCKED,
        "rpm",
        "least engine speed in driving with the clutch closed",
    ),
];

/// Gathers them row by row.
#[derive(Clone, Copy, Debug)]
pub(super) struct SideEffects {
    heard_rad_s: f64,
    floor_s: f64,
    lugging_s: f64,
    most_load: f64,
    locked_rad_s: f64,
}

impl SideEffects {
    /// With the engine speed, rpm, below which load is heard and felt.
    pub fn new(heard_rpm: f64) -> Self {
        SideEffects {
            heard_rad_s: heard_rpm * RPM,
            floor_s: 0.0,
            lugging_s: 0.0,
            most_load: 0.0,
            locked_rad_s: f64::NAN,
        }
    }

    /// Heads of the columns.
    pub fn heads() -> impl Iterator<Item = Head> {
        COLUMNS.into_iter().map(|(name, unit, doc)| Head {
            name: name.to_owned(),
            unit: unit.to_owned(),
            doc: doc.to_owned(),
            kind: Kind::Number,
        })
    }

    /// Takes the next rows.
    pub fn see(&mut self, rows: &[Row]) {
        for row in rows.iter().filter(|row| !row.rests()) {
            let cause = row.clamp_cause;
            if row.clamp_safety.is_finite() && !matches!(cause, ClampCause::Law | ClampCause::Cap) {
                self.floor_s += row.dt_s;
            }
            self.most_load = self.most_load.max(row.throttle);
            let slips = Flags(Flags::CLUTCH_SLIPPING.0 | Flags::CLUTCH_OPEN.0);
            if row.flags.any(slips) || row.throttle <= 0.0 {
                continue;
            }
            self.locked_rad_s = self.locked_rad_s.min(row.engine_speed_rad_s);
            if row.engine_speed_rad_s < self.heard_rad_s && row.throttle > LOADED {
                self.lugging_s += row.dt_s;
            }
        }
    }

    /// The numbers, in the order of their heads.
    pub fn numbers(&self) -> [f64; COLUMNS.len()] {
        [
            self.floor_s,
            self.lugging_s,
            100.0 * (1.0 - self.most_load),
            rpm(self.locked_rad_s),
        ]
    }
}
