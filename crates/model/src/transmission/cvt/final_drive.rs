//! The final drive of the CVT: two stages of gears and a differential behind the secondary shaft.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FD-1 | torque without load at the secondary shaft: GT-1, shaft 0 the secondary, 1 between the stages, 2 the differential | derived; geometry ASSUMED, factors fitted to thesis 5.5.1 and a manual box |
//! | FD-2 | torque at the secondary shaft for one behind the final drive: GT-2 | derived |
//!
//! The bearings of the secondary's own shaft are those of the pulley.

use crate::keys::Values;
use crate::math::{Gather, Real};
use crate::transmission::gear_train::{GearParts, GearTrain};

/// The checked final drive.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct FinalDrive<R: Real = f64> {
    /// Speed of the secondary over that of the wheels (CV-1).
    pub ratio: R,
    /// Gears, bearings and seals (FD-1, FD-2).
    pub train: GearTrain<R>,
}

impl FinalDrive {
    /// The final drive from the values of its table, its ratio and that of its first stage, in its oil.
    pub(super) fn from_values<V: Values>(s: &V, ratio: f64, first: f64, oil_m3: f64) -> Self {
        let ratios = [first, ratio / first];
        FinalDrive {
            ratio,
            train: GearParts::from_values(s, oil_m3, &[ratios]).train(ratios),
        }
    }
}
