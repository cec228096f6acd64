//! The hydraulic circuit of the two cylinders: which pressure the pump holds.
//!
//! | label | statement | status |
//! |---|---|---|
//! | HC-1 | `line_is_secondary`: p_line = p_s, and the primary is fed from it: p_p <= p_line | ASSUMED: thesis 1.1.2 has a valve that sets the secondary pressure and one that meters oil into the primary, not where that oil is from |
//! | HC-2 | `independent`: each cylinder has a valve of its own, p_line = max(p_p, p_s) | derived: a valve only lowers a pressure |
//! | HC-3 | `torque_sensor`: p_c = min(F_p, F_s)/A_c in a clamping cylinder of each pulley, p_d = \|F_p - F_s\|/A_d in the shifting cylinder of one, p_line = max(p_c, p_d) | derived: balance of a double piston (its principle: SAE 2004-40CVT-49) |
//!
//! F hydraulic forces N: those of TE-9 and VA-3 without spring and centrifugal head. A_c, A_d areas of the two pistons of a pulley, the same on
//! both. What a shift adds to F_p (PC-5) is not in HC-2 and HC-3. p_p and p_s of the output are then F over the whole piston areas, so that all circuits have the same columns.

use super::Cvt;
use crate::keys::{Key, Values, keys};
use crate::math::{Gather, Real, physics};

/// The checked circuit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LineCircuit<R: Real = f64> {
    /// HC-1.
    LineIsSecondary,
    /// HC-2.
    Independent,
    /// HC-3.
    TorqueSensor {
        /// Area of the clamping piston of a pulley, m2.
        clamp_m2: R,
        /// Area of its shifting piston, m2.
        shift_m2: R,
    },
}

impl Gather for LineCircuit {
    type Together<R: Real> = LineCircuit<R>;

    fn gather<R: Real>(like: R, of: &[&Self]) -> LineCircuit<R> {
        let areas = |lane: usize| match of[lane] {
            LineCircuit::TorqueSensor { clamp_m2, shift_m2 } => [*clamp_m2, *shift_m2],
            LineCircuit::LineIsSecondary | LineCircuit::Independent => [0.0; 2],
        };
        match of[0] {
            LineCircuit::LineIsSecondary => LineCircuit::LineIsSecondary,
            LineCircuit::Independent => LineCircuit::Independent,
            LineCircuit::TorqueSensor { .. } => LineCircuit::TorqueSensor {
                clamp_m2: like.map_lanes(|lane| areas(lane)[0]),
                shift_m2: like.map_lanes(|lane| areas(lane)[1]),
            },
        }
    }

    fn lane<R: Real>(together: &LineCircuit<R>, lane: usize) -> Self {
        match together {
            LineCircuit::LineIsSecondary => LineCircuit::LineIsSecondary,
            LineCircuit::Independent => LineCircuit::Independent,
            LineCircuit::TorqueSensor { clamp_m2, shift_m2 } => LineCircuit::TorqueSensor {
                clamp_m2: clamp_m2.lane(lane),
                shift_m2: shift_m2.lane(lane),
            },
        }
    }

    fn groups_with(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

#[physics]
impl<R: Real> Cvt<R> {
    /// Pressure that the pump holds for those of the cylinders, Pa (HC-1 to HC-3).
    pub fn line_pa(&self, secondary_pa: R, primary_pa: R) -> R {
        match self.circuit {
            LineCircuit::LineIsSecondary => secondary_pa, // HC-1
            LineCircuit::Independent => secondary_pa.max(primary_pa), // HC-2
            LineCircuit::TorqueSensor { clamp_m2, shift_m2 } => {
                let primary_n = primary_pa * self.primary_piston_m2;
                let secondary_n = secondary_pa * self.secondary_piston_m2;
                let clamp_pa = primary_n.min(secondary_n).max(0.0) / clamp_m2;
                clamp_pa.max((primary_n - secondary_n).abs() / shift_m2) // HC-3
            }
        }
    }

    /// Line pressure less that of the secondary, Pa; `None` in a circuit where both are the same. A difference and no ratio: the secondary may be
    /// without pressure while the primary has some.
    pub(super) fn line_above_pa(&self, secondary_pa: R, primary_pa: R) -> Option<R> {
        match self.circuit {
            LineCircuit::LineIsSecondary => None,
            LineCircuit::Independent | LineCircuit::TorqueSensor { .. } => {
                Some(self.line_pa(secondary_pa, primary_pa) - secondary_pa)
            }
        }
    }

    /// Largest pressure that the primary can have at one of the secondary, Pa.
    pub(super) fn most_primary_pa(&self, secondary_pa: R) -> R {
        match self.circuit {
            LineCircuit::LineIsSecondary => secondary_pa + self.pump.line_drop_pa,
            LineCircuit::Independent | LineCircuit::TorqueSensor { .. } => {
                self.cap_pa + self.pump.line_drop_pa
            }
        }
    }
}

keys! {
    /// Keys of `[transmission.cvt.circuit.torque_sensor]`.
    SENSOR: TorqueSensorKeys = "torque_sensor" [] {
        clamp_piston_cm2: number(5.0, 2000.0), "area of the clamping piston of each pulley", ["HC-3"];
        shift_piston_cm2: number(5.0, 2000.0), "area of the shifting piston of each pulley", ["HC-3"];
    }
}

impl LineCircuit {
    /// The chosen circuit.
    pub(super) fn from_values<V: Values>(s: &V, key: &Key<'static>) -> Self {
        let (kind, c) = s.choose(key);
        match kind {
            "independent" => LineCircuit::Independent,
            "torque_sensor" => LineCircuit::TorqueSensor {
                clamp_m2: c.number(&SENSOR.clamp_piston_cm2),
                shift_m2: c.number(&SENSOR.shift_piston_cm2),
            },
            _ => LineCircuit::LineIsSecondary,
        }
    }
}
