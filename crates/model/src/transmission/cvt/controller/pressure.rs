//! How hard the secondary clamps the belt.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PC-1 | `map`: p = f(n) (p0 + k u) (r_low/r_p)^a (1 + k_T (80 degC - T)), at most the cap | source: thesis 3.7 in words (rises with ratio, throttle, cold); fitted to 36-40 bar pulling away, 12 bar at 50 km/h |
//! | PC-2 | f(n) from `slow_factor` at `slow_rpm` to 1 at `full_rpm`, above it less by `fall` per 1000 rpm, never below `slow_factor` | source: thesis 5.3.1 (steep rise to 2000 rpm, very gradual fall in high); fitted, size of the fall ASSUMED |
//! | PC-3 | `torque_following`: F = S \|T\| cos th / (2 mu_cap R_s), thrust ratio of TE-1 below 1 counted, above the floors of PC-5, below the cap | source: Coulomb limit VA-4 with safety factor S |
//! | PC-4 | `slip_limited`: the lowest pressure between PC-3 with PC-5 and the cap at which belt slip stays below the limit; where none does, that of least slip | derived: slip falls with clamping force until the stretch of the bands (SL-1) outweighs the grip |
//!
//! The law is never raised silently: where it is below what the torque needs, the row is flagged `low_clamp`.

use super::pressure_table::{PressureTable, TableKeys, pressure_table};
use crate::keys::{Choice, Key, Values, keys};
use crate::math::{Gather, Mask, Real, physics, ramp};
use std::sync::Arc;

/// The Rover's law.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct MapLaw<R: Real = f64> {
    /// Pressure in low at closed throttle, Pa.
    pub base_pa: R,
    /// Rise to full throttle, Pa.
    pub throttle_pa: R,
    /// Rise per kelvin below 80 degC, 1/K.
    pub cold_per_k: R,
    /// Factor at and below the slow speed.
    pub slow_factor: R,
    /// Speed of the slow factor, rad/s.
    pub slow_rad_s: R,
    /// Speed at which the factor is 1, rad/s.
    pub full_rad_s: R,
    /// Fall of the factor with speed above it, s/rad.
    pub fall_s: R,
}

/// The clamp law in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClampLaw<R: Real = f64> {
    /// PC-1.
    Map(MapLaw<R>),
    /// PC-3 with safety factor.
    TorqueFollowing {
        /// Safety factor S.
        safety: R,
        /// Smallest torque that is clamped for, Nm.
        least_torque_nm: R,
    },
    /// PC-4 with slip limit.
    SlipLimited {
        /// Largest slip.
        slip: R,
        /// Safety factor below which the law never goes.
        safety: R,
        /// Smallest torque that is clamped for, Nm.
        least_torque_nm: R,
    },
    /// PC-6, with the table of the box.
    Table,
}

/// The numbers of a law that looks at the belt: its slip, safety and least torque.
fn numbers(law: &ClampLaw) -> [f64; 3] {
    match *law {
        ClampLaw::TorqueFollowing {
            safety,
            least_torque_nm,
        } => [0.0, safety, least_torque_nm],
        ClampLaw::SlipLimited {
            slip,
            safety,
            least_torque_nm,
        } => [slip, safety, least_torque_nm],
        ClampLaw::Map(_) | ClampLaw::Table => [0.0; 3],
    }
}

impl Gather for ClampLaw {
    type Together<R: Real> = ClampLaw<R>;

    fn gather<R: Real>(like: R, of: &[&Self]) -> ClampLaw<R> {
        let map = |law: &&ClampLaw| match law {
            ClampLaw::Map(map) => Some(*map),
            _ => None,
        };
        let maps: Option<Vec<MapLaw>> = of.iter().map(map).collect();
        if let Some(maps) = maps {
            let each: Vec<_> = maps.iter().collect();
            return ClampLaw::Map(Gather::gather(like, &each));
        }
        let each = of.iter().map(|law| numbers(law)).collect::<Vec<_>>();
        let [slip, safety, least_torque_nm] =
            Gather::gather(like, &each.iter().collect::<Vec<_>>());
        match of[0] {
            ClampLaw::TorqueFollowing { .. } => ClampLaw::TorqueFollowing {
                safety,
                least_torque_nm,
            },
            ClampLaw::SlipLimited { .. } => ClampLaw::SlipLimited {
                slip,
                safety,
                least_torque_nm,
            },
            ClampLaw::Map(_) | ClampLaw::Table => ClampLaw::Table,
        }
    }

    fn lane<R: Real>(together: &ClampLaw<R>, lane: usize) -> Self {
        match together {
            ClampLaw::Map(map) => ClampLaw::Map(Gather::lane(map, lane)),
            ClampLaw::TorqueFollowing {
                safety,
                least_torque_nm,
            } => ClampLaw::TorqueFollowing {
                safety: safety.lane(lane),
                least_torque_nm: least_torque_nm.lane(lane),
            },
            ClampLaw::SlipLimited {
                slip,
                safety,
                least_torque_nm,
            } => ClampLaw::SlipLimited {
                slip: slip.lane(lane),
                safety: safety.lane(lane),
                least_torque_nm: least_torque_nm.lane(lane),
            },
            ClampLaw::Table => ClampLaw::Table,
        }
    }

    fn groups_with(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

/// Inputs of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampSignals<R: Real = f64> {
    /// Throttle 0..1.
    pub throttle: R,
    /// Engine speed, rad/s.
    pub engine_rad_s: R,
    /// Oil temperature, K.
    pub oil_k: R,
    /// (r_low/r_p)^a of the ratio in force.
    pub radius_factor: R,
    /// Logarithm of the force ratio that the shift needs, positive towards low (PC-5).
    pub force_log: R,
}

#[physics]
impl<R: Real> MapLaw<R> {
    /// Pressure before the cap, Pa (PC-1, PC-2).
    pub fn pressure_pa(&self, s: &ClampSignals<R>) -> R {
        let rise = self.slow_factor
            + (1.0 - self.slow_factor) * ramp(s.engine_rad_s, self.slow_rad_s, self.full_rad_s);
        let over = s.engine_rad_s - self.full_rad_s;
        let is_over = over.gt(0.0);
        let fallen = is_over.select(rise - self.fall_s * over, rise);
        let falls = fallen.gt(self.slow_factor) | over.splat(0.0).ge(over);
        let fast = falls.select(fallen, self.slow_factor); // PC-2
        fast * (self.base_pa + self.throttle_pa * s.throttle)
            * s.radius_factor
            * (1.0 + self.cold_per_k * (353.15 - s.oil_k)) // PC-1
    }
}

keys! {
    /// Keys of `[transmission.cvt.clamp.torque_following]`.
    FOLLOWING: FollowingKeys = "torque_following" [] {
        safety_factor: or(1.3, number(0.5, 10.0)), "capacity over torque", ["PC-3"];
        least_torque_nm: or(20.0, number(0.0, 500.0)), "smallest torque clamped for", ["PC-3"];
    }

    /// Keys of `[transmission.cvt.clamp.slip_limited]`.
    SLIP: SlipKeys = "slip_limited" [] {
        slip_percent: or(2.0, number(0.1, 10.0)), "largest slip", ["PC-4"];
        safety_factor: or(1.05, number(0.5, 10.0)), "smallest capacity over torque", ["PC-4"];
        least_torque_nm: or(20.0, number(0.0, 500.0)), "smallest torque clamped for", ["PC-4"];
    }

    /// Keys of `[transmission.cvt.clamp.map]`.
    MAP: ClampKeys = "map" [] {
        base_bar: number(0.0, 200.0), "pressure in low at closed throttle", ["PC-1"];
        throttle_bar: number(0.0, 200.0), "rise to full throttle", ["PC-1"];
        cold_per_k: number(0.0, 0.02), "rise per kelvin below 80 degC", ["PC-1"];
        slow_factor: number(0.05, 1.5), "factor at the slow speed", ["PC-2"];
        slow_rpm: number(0.0, 10_000.0), "slow speed", ["PC-2"];
        full_rpm: number(0.0, 10_000.0), "speed at which the factor is 1", ["PC-2"];
        fall_per_1000_rpm: or(0.0, number(0.0, 0.2)), "fall of the factor per 1000 rpm above full_rpm", ["PC-2"];
    }
}

impl ClampKeys {
    /// The clamp laws.
    pub const CHOICES: &[Choice] = &[
        Choice::new("map", "pressure map of the Rover 216", Self::TABLE),
        Choice::new(
            "torque_following",
            "a constant safety factor over the transmitted torque",
            FollowingKeys::TABLE,
        ),
        Choice::new(
            "slip_limited",
            "the least force that keeps the slip below a limit",
            SlipKeys::TABLE,
        ),
        Choice::new(
            "table",
            "a table of the user's over torque, ratio and speed",
            TableKeys::TABLE,
        ),
    ];
}

/// The chosen clamp law, and its table if it is one.
pub fn clamp<V: Values>(s: &V, key: &Key<'static>) -> (ClampLaw, Option<Arc<PressureTable>>) {
    let (law, c) = s.choose(key);
    if law == "table" {
        return (ClampLaw::Table, pressure_table(&c));
    }
    let law = match law {
        "torque_following" => ClampLaw::TorqueFollowing {
            safety: c.number(&FOLLOWING.safety_factor),
            least_torque_nm: c.number(&FOLLOWING.least_torque_nm),
        },
        "slip_limited" => ClampLaw::SlipLimited {
            slip: c.number(&SLIP.slip_percent),
            safety: c.number(&SLIP.safety_factor),
            least_torque_nm: c.number(&SLIP.least_torque_nm),
        },
        _ => ClampLaw::Map(MapLaw {
            base_pa: c.number(&MAP.base_bar),
            throttle_pa: c.number(&MAP.throttle_bar),
            cold_per_k: c.number(&MAP.cold_per_k),
            slow_factor: c.number(&MAP.slow_factor),
            slow_rad_s: c.number(&MAP.slow_rpm),
            full_rad_s: c.number(&MAP.full_rpm),
            fall_s: c.number(&MAP.fall_per_1000_rpm),
        }),
    };
    (law, None)
}
