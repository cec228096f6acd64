//! Two gear stages with their bearings, churning and seals: the final drive of the CVT, and a manual box in a gear.
//!
//! | label | statement | status |
//! |---|---|---|
//! | GT-1 | T_0 = sum over the shafts of r (M_0 + M_pre + C + T_seal), r speed over that of shaft 0 | derived: powers add |
//! | GT-2 | T = (T_w + T_0)/(1 - k) for T_w + T_0 >= 0, (T_w + T_0)(1 - k) below; k = sum of the shares of GM-3 and BR-3, at most 0.1 | derived: the share k of the power is lost on its way, in both directions |
//!
//! Shaft 0 is driven, stage 1 leads to shaft 1, stage 2 to shaft 2 and the wheels. T_w and T are torques behind and before the train, both at
//! the speed of shaft 0. k is that of the power that is demanded, so that a solve only meets a number. At rest nothing is lost.

pub mod bearing;
pub mod churning;
mod keys;
pub mod mesh;
pub mod seal;

pub use keys::GearKeys;

use self::bearing::{Bearing, BearingFactors, TrainBearing, load_share};
use self::churning::Churner;
use self::mesh::{Mesh, Stage, Teeth};
use self::seal::LipSeal;
use crate::fluid::OilState;
use crate::keys::RPM;
use crate::math::{larger, ln_each};

/// Largest share of the power that a train loses under load.
const MAX_SHARE: f64 = 0.1;

/// The parts of a train, whatever the ratios of its stages.
#[derive(Clone, Debug, PartialEq)]
pub struct GearParts {
    /// The two pairs of wheels.
    pub stages: [Stage; 2],
    /// Surface and oil of the teeth.
    pub teeth: Teeth,
    /// Bearings.
    pub bearings: Vec<Bearing>,
    /// What the bearings share.
    pub bearing: BearingFactors,
    /// Wheels in the sump.
    pub churners: Vec<Churner>,
    /// Factor on their churning.
    pub churning: f64,
    /// Lip seals.
    pub seals: Vec<LipSeal>,
    /// Oil in the sump, m3.
    pub oil_m3: f64,
}

/// A train at the ratios of its stages.
#[derive(Clone, Debug, PartialEq)]
pub struct GearTrain {
    meshes: [Mesh; 2],
    bearings: Vec<TrainBearing>,
    /// Factor of the churners at the speed of shaft 0 (CH-1).
    churning: f64,
    /// Lip seals, at shaft 0, Nm.
    seal_nm: f64,
    /// Lost in the bearings under the load of both stages (BR-3).
    bearing_share: f64,
}

/// A train at a speed, an oil and a demand: what does not depend on the torque that passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurningTrain {
    /// Bearings without load, at shaft 0, Nm.
    pub bearing_nm: f64,
    /// Churning, at shaft 0, Nm.
    pub churning_nm: f64,
    /// Lip seals, at shaft 0, Nm.
    pub seal_nm: f64,
    /// Share of the power that the teeth lose.
    pub mesh_share: f64,
    /// Share of the power that the bearings lose under load.
    pub bearing_share: f64,
}

/// Loss torques of a train at shaft 0, Nm, or a factor on each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainLosses {
    /// Teeth.
    pub mesh: f64,
    /// Bearings, without load and under it.
    pub bearing: f64,
    /// Churning.
    pub churning: f64,
    /// Lip seals.
    pub seal: f64,
}

impl GearParts {
    /// Mean bore of the bearings of a shaft, m; 0 without bearings.
    fn bore_m(&self, shaft: usize) -> f64 {
        let of_shaft = || self.bearings.iter().filter(|b| b.shaft == shaft);
        let count: f64 = of_shaft().map(|b| b.count).sum();
        let bores: f64 = of_shaft().map(|b| b.count * b.bore_m).sum();
        if count > 0.0 { bores / count } else { 0.0 }
    }

    /// The train at the ratios of its stages, speed before each over speed behind.
    pub fn train(&self, ratios: [f64; 2]) -> GearTrain {
        let turns = [1.0, 1.0 / ratios[0], 1.0 / (ratios[0] * ratios[1])];
        let mesh = |k: usize| self.stages[k].mesh(ratios[k], turns[k], self.teeth);
        let loaded = |k: usize| {
            let bores = if ratios[k] >= 1.0 {
                [k, k + 1]
            } else {
                [k + 1, k]
            };
            load_share(
                self.bearing.friction,
                bores.map(|shaft| self.bore_m(shaft)),
                self.stages[k].pinion_radius_m(ratios[k]),
                larger(ratios[k], 1.0 / ratios[k]),
            )
        };
        GearTrain {
            meshes: [mesh(0), mesh(1)],
            bearings: (self.bearings.iter())
                .map(|bearing| bearing.in_train(&self.bearing, turns[bearing.shaft]))
                .collect(),
            churning: (self.churners.iter())
                .map(|c| churning::in_train(self.churning * c.factor(self.oil_m3), turns[c.shaft]))
                .sum(),
            seal_nm: self
                .seals
                .iter()
                .map(|seal| turns[seal.shaft] * seal.torque_nm())
                .sum(),
            bearing_share: loaded(0) + loaded(1),
        }
    }
}

impl GearTrain {
    /// The train at a speed of shaft 0 in its oil, with the torque at shaft 0 that the demanded power gives (GT-1).
    pub fn turning(&self, first_rad_s: f64, demand_nm: f64, oil: OilState) -> TurningTrain {
        if first_rad_s <= 0.0 {
            return TurningTrain::default();
        }
        let [log_nu, log_eta, log_n, log_first] = ln_each([
            oil.kinematic_m2_s,
            1e3 * oil.kinematic_m2_s * oil.density_kg_m3,
            first_rad_s * (1e6 / RPM),
            first_rad_s,
        ]);
        let powers = bearing::film_powers(log_nu + log_n);
        let bearing_nm = (self.bearings.iter()).map(|b| b.torque_nm(first_rad_s, powers));
        let [first, second] = Mesh::shares(self.meshes.each_ref(), first_rad_s, demand_nm, log_eta);
        let mesh_share = first + second;
        let share = mesh_share + self.bearing_share;
        let held = if share > MAX_SHARE {
            MAX_SHARE / share
        } else {
            1.0
        };
        TurningTrain {
            bearing_nm: bearing_nm.sum(), // GT-1
            churning_nm: churning::torque_nm(self.churning, oil.density_kg_m3, log_first, log_nu),
            seal_nm: self.seal_nm,
            mesh_share: held * mesh_share,
            bearing_share: held * self.bearing_share,
        }
    }
}

impl TrainLosses {
    /// The same number for each.
    pub const fn all(number: f64) -> Self {
        TrainLosses {
            mesh: number,
            bearing: number,
            churning: number,
            seal: number,
        }
    }
}

impl TurningTrain {
    /// Each loss times its factor (CV-7, MB-6).
    pub fn times(&self, factor: &TrainLosses) -> Self {
        TurningTrain {
            bearing_nm: factor.bearing * self.bearing_nm,
            churning_nm: factor.churning * self.churning_nm,
            seal_nm: factor.seal * self.seal_nm,
            mesh_share: factor.mesh * self.mesh_share,
            bearing_share: factor.bearing * self.bearing_share,
        }
    }

    /// Torque without load, at shaft 0, Nm (GT-1).
    #[inline]
    pub fn no_load_nm(&self) -> f64 {
        self.bearing_nm + self.churning_nm + self.seal_nm // GT-1
    }

    /// Share of the power that is lost under load (GT-2).
    #[inline]
    pub fn share(&self) -> f64 {
        self.mesh_share + self.bearing_share
    }

    /// Torque at shaft 0 for a torque behind the train, both at the speed of shaft 0, Nm (GT-2).
    #[inline]
    pub fn input_nm(&self, output_nm: f64) -> f64 {
        let (through, kept) = (output_nm + self.no_load_nm(), 1.0 - self.share());
        if through >= 0.0 {
            through / kept
        } else {
            through * kept
        } // GT-2
    }

    /// Torque behind the train for a torque at shaft 0: the inverse of GT-2.
    #[inline]
    pub fn output_nm(&self, input_nm: f64) -> f64 {
        let kept = 1.0 - self.share();
        let through = if input_nm >= 0.0 {
            input_nm * kept
        } else {
            input_nm / kept
        };
        through - self.no_load_nm() // GT-2
    }

    /// Losses by part for a torque behind the train; their sum is the torque before it less the one behind it.
    pub fn losses(&self, output_nm: f64) -> TrainLosses {
        let through_nm = (output_nm + self.no_load_nm()).abs();
        let larger_nm = larger(through_nm, self.input_nm(output_nm).abs());
        TrainLosses {
            mesh: self.mesh_share * larger_nm,
            bearing: self.bearing_nm + self.bearing_share * larger_nm,
            churning: self.churning_nm,
            seal: self.seal_nm,
        }
    }
}
