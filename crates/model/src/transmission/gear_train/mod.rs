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
use crate::lubricant::OilState;
use crate::math::{Gather, Mask, Real, larger, physics};
use std::f64::consts::LN_10;

/// Largest share of the power that a train loses under load.
const MAX_SHARE: f64 = 0.1;
/// Logarithm of the factor from rad/s and m2/s to rpm and mm2/s, for their product: ln(30e6/pi) (BR-1).
const LN_MICRO_RPM: f64 = 16.071_978_053_777_03;
/// Logarithm of the factor from Pa s to mPa s (GM-2).
const LN_MILLI: f64 = 3.0 * LN_10;

/// The parts of a train, whatever the ratios of its stages.
#[derive(Clone, Debug, PartialEq)]
pub struct GearParts {
    /// The two pairs of wheels.
    pub stages: [Stage; 2],
    /// Surface and oil of the teeth.
    pub teeth: Teeth,
    /// Bearings.
    pub bearings: Vec<Bearing>,
    /// Data shared by the bearings.
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
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct GearTrain<R: Real = f64> {
    meshes: [Mesh<R>; 2],
    bearings: Vec<TrainBearing<R>>,
    /// Factor of the churners at the speed of shaft 0 (CH-1).
    churning: R,
    /// Lip seals, at shaft 0, Nm.
    seal_nm: R,
    /// Lost in the bearings under the load of both stages (BR-3).
    bearing_share: R,
}

/// A train at a speed, an oil and a demand: what does not depend on the torque that passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurningTrain<R: Real = f64> {
    /// Bearings without load, at shaft 0, Nm.
    pub bearing_nm: R,
    /// Churning, at shaft 0, Nm.
    pub churning_nm: R,
    /// Lip seals, at shaft 0, Nm.
    pub seal_nm: R,
    /// Share of the power that the teeth lose.
    pub mesh_share: R,
    /// Share of the power that the bearings lose under load.
    pub bearing_share: R,
}

/// Loss torques of a train at shaft 0, Nm, or a factor on each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainLosses<R: Real = f64> {
    /// Teeth.
    pub mesh: R,
    /// Bearings, without load and under it.
    pub bearing: R,
    /// Churning.
    pub churning: R,
    /// Lip seals.
    pub seal: R,
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

#[physics]
impl<R: Real> GearTrain<R> {
    /// The train at a speed of shaft 0 in its oil, with the torque at shaft 0 that the demanded power gives (GT-1).
    pub fn turning(&self, first_rad_s: R, demand_nm: R, oil: OilState<R>) -> TurningTrain<R> {
        let rests = first_rad_s.splat(0.0).ge(first_rad_s);
        if rests.all() {
            return TurningTrain::at_rest(first_rad_s);
        }
        let log_first = first_rad_s.ln();
        let powers = bearing::film_powers(oil.log_nu + log_first + LN_MICRO_RPM);
        let mut bearing_nm = first_rad_s.splat(-0.0);
        for bearing in &self.bearings {
            bearing_nm = bearing_nm + bearing.torque_nm(first_rad_s, powers); // GT-1
        }
        let [first, second] = Mesh::shares(
            self.meshes.each_ref(),
            first_rad_s,
            demand_nm,
            [oil.log_eta + LN_MILLI, oil.log_gear_factor],
        );
        let mesh_share = first + second;
        let share = mesh_share + self.bearing_share;
        let held = share
            .gt(MAX_SHARE)
            .select(MAX_SHARE / share, share.splat(1.0));
        let churning_nm =
            churning::torque_nm(self.churning, oil.density_kg_m3, log_first, oil.log_nu);
        let none = share.splat(0.0);
        TurningTrain {
            bearing_nm: rests.select(none, bearing_nm),
            churning_nm: rests.select(none, churning_nm),
            seal_nm: rests.select(none, self.seal_nm),
            mesh_share: rests.select(none, held * mesh_share),
            bearing_share: rests.select(none, held * self.bearing_share),
        }
    }
}

impl<R: Real> TrainLosses<R> {
    /// The same number for each.
    pub const fn all(number: R) -> Self {
        TrainLosses {
            mesh: number,
            bearing: number,
            churning: number,
            seal: number,
        }
    }
}

#[physics]
impl<R: Real> TurningTrain<R> {
    /// Nothing is lost; `like` has the lanes.
    pub(crate) fn at_rest(like: R) -> Self {
        let none = like.splat(0.0);
        TurningTrain {
            bearing_nm: none,
            churning_nm: none,
            seal_nm: none,
            mesh_share: none,
            bearing_share: none,
        }
    }

    /// Each loss times its factor (CV-7, MB-6).
    pub fn times(&self, factor: &TrainLosses<R>) -> Self {
        TurningTrain {
            bearing_nm: factor.bearing * self.bearing_nm,
            churning_nm: factor.churning * self.churning_nm,
            seal_nm: factor.seal * self.seal_nm,
            mesh_share: factor.mesh * self.mesh_share,
            bearing_share: factor.bearing * self.bearing_share,
        }
    }

    /// Torque without load, at shaft 0, Nm (GT-1).
    pub fn no_load_nm(&self) -> R {
        self.bearing_nm + self.churning_nm + self.seal_nm // GT-1
    }

    /// Share of the power that is lost under load (GT-2).
    pub fn share(&self) -> R {
        self.mesh_share + self.bearing_share
    }

    /// Torque at shaft 0 for a torque behind the train, both at the speed of shaft 0, Nm (GT-2).
    pub fn input_nm(&self, output_nm: R) -> R {
        let (through, kept) = (output_nm + self.no_load_nm(), 1.0 - self.share());
        through.ge(0.0).select(through / kept, through * kept) // GT-2
    }

    /// Torque behind the train for a torque at shaft 0: the inverse of GT-2.
    pub fn output_nm(&self, input_nm: R) -> R {
        let kept = 1.0 - self.share();
        let through = input_nm.ge(0.0).select(input_nm * kept, input_nm / kept);
        through - self.no_load_nm() // GT-2
    }

    /// Losses by part for a torque behind the train; their sum is the torque before it less the one behind it.
    pub fn losses(&self, output_nm: R) -> TrainLosses<R> {
        let through_nm = (output_nm + self.no_load_nm()).abs();
        let larger_nm = through_nm.max(self.input_nm(output_nm).abs());
        TrainLosses {
            mesh: self.mesh_share * larger_nm,
            bearing: self.bearing_nm + self.bearing_share * larger_nm,
            churning: self.churning_nm,
            seal: self.seal_nm,
        }
    }
}
