//! The box in a gear: its gear train, or the measured map in place of it.

use super::Manual;
use crate::lubricant::OilState;
use crate::maps::{LossMap, MapPoint};
use crate::math::{Mask, Real, physics};
use crate::transmission::component::Component;
use crate::transmission::gear_train::{TrainLosses, TurningTrain};

/// Losses by component, Nm at the input shaft.
pub type PartLosses<R = f64> = [(Component, R); 5];

/// The box in a gear at a speed and an oil temperature: what does not depend on the torque that passes is known.
pub struct Engaged<'a, R: Real = f64> {
    map: Option<&'a R::PerLane<LossMap>>,
    /// Factor on the loss of the map.
    map_factor: R,
    gear: u8,
    input_rad_s: R,
    oil_k: R,
    /// Nothing where a map holds the losses.
    train: TurningTrain<R>,
}

/// The box at a torque, Nm at the input shaft.
pub(super) struct Loaded<R: Real = f64> {
    pub output_nm: R,
    pub input_nm: R,
    pub losses_nm: PartLosses<R>,
    pub inside_map: R::Mask,
}

#[physics]
impl<R: Real> Loaded<R> {
    /// This one where the mask says so, else the other.
    pub fn or(self, chosen: R::Mask, other: Loaded<R>) -> Loaded<R> {
        let mut losses_nm = self.losses_nm;
        for (own, other) in losses_nm.iter_mut().zip(other.losses_nm) {
            own.1 = chosen.select(own.1, other.1);
        }
        Loaded {
            output_nm: chosen.select(self.output_nm, other.output_nm),
            input_nm: chosen.select(self.input_nm, other.input_nm),
            losses_nm,
            inside_map: chosen.select(self.inside_map, other.inside_map),
        }
    }
}

#[physics]
impl<R: Real> Manual<R> {
    /// The box in a gear at a speed of its input shaft, in its oil at a temperature, K, with the torque at that shaft that the demanded power
    /// gives.
    pub fn engaged(
        &self,
        gear: u8,
        input_rad_s: R,
        demand_nm: R,
        (oil, oil_k): (OilState<R>, R),
    ) -> Engaged<'_, R> {
        let train = match self.map {
            Some(_) => TurningTrain::at_rest(input_rad_s),
            None => self.trains[usize::from(gear) - 1].turning(input_rad_s, demand_nm, oil),
        };
        let (train, map_factor) = match &self.factor {
            Some(factor) => {
                let parts = TrainLosses {
                    mesh: factor[Component::GearMesh],
                    bearing: factor[Component::Bearing],
                    churning: factor[Component::Churning],
                    seal: factor[Component::Seal],
                };
                (train.times(&parts), factor[Component::BoxMap]) // MB-6
            }
            None => (train, input_rad_s.splat(1.0)),
        };
        Engaged {
            map: self.map.as_ref(),
            map_factor,
            gear,
            input_rad_s,
            oil_k,
            train,
        }
    }
}

/// Losses of a train, or of a whole box.
#[physics]
fn by_component<R: Real>(train: TrainLosses<R>, map_nm: R) -> PartLosses<R> {
    [
        (Component::GearMesh, train.mesh),
        (Component::Bearing, train.bearing),
        (Component::Churning, train.churning),
        (Component::Seal, train.seal),
        (Component::BoxMap, map_nm),
    ]
}

/// Sum of the losses, Nm.
#[physics]
pub(super) fn sum_nm<R: Real>(losses: &PartLosses<R>) -> R {
    let [(_, first), (_, second), (_, third), (_, fourth), (_, fifth)] = *losses;
    first + second + third + fourth + fifth
}

#[physics]
impl<R: Real> Engaged<'_, R> {
    /// Losses for an output torque referred to the input, Nm (MB-1 to MB-4), and whether the map, if there is one, holds the point.
    pub fn losses_nm(&self, output_nm: R) -> (PartLosses<R>, R::Mask) {
        let zero = output_nm.splat(0.0);
        match self.map {
            Some(maps) => {
                let (loss, inside) = self.map_loss(maps, output_nm);
                (by_component(TrainLosses::all(zero), loss), inside)
            }
            None => {
                let losses = by_component(self.train.losses(output_nm), zero);
                (losses, zero.splat_mask(true))
            }
        }
    }

    /// Losses of the box with nothing on its input shaft, or the map's without torque.
    pub(super) fn unloaded_nm(&self) -> PartLosses<R> {
        let output_nm = match self.map {
            Some(_) => self.input_rad_s.splat(0.0),
            None => -self.train.no_load_nm(),
        };
        self.losses_nm(output_nm).0
    }

    /// Input torque and losses for an output torque referred to the input (MB-1).
    pub(super) fn at(&self, output_nm: R) -> Loaded<R> {
        let (losses_nm, inside_map) = self.losses_nm(output_nm);
        let input_nm = match self.map {
            Some(_) => output_nm + sum_nm(&losses_nm),
            None => self.train.input_nm(output_nm),
        }; // MB-1
        Loaded {
            output_nm,
            input_nm,
            losses_nm,
            inside_map,
        }
    }

    /// Output torque referred to the input for an input torque, and how often losses were asked: the inverse of MB-1, by secant where a map is
    /// used.
    pub(super) fn output_for(&self, input_nm: R) -> (R, R::PerLane<u16>) {
        let Some(maps) = self.map else {
            return (self.train.output_nm(input_nm), R::per_lane(|_| 1));
        };
        let found =
            R::per_lane(|run| self.output_by_map(R::get(maps, run), input_nm.lane(run), run));
        let output_nm = input_nm.map_lanes(|run| R::get(&found, run).0);
        (output_nm, R::per_lane(|run| R::get(&found, run).1))
    }

    /// Loss of a measured map, whose torque axis is the input torque, for an output torque (MP-4).
    fn map_loss(&self, maps: &R::PerLane<LossMap>, output_nm: R) -> (R, R::Mask) {
        let found =
            R::per_lane(|run| self.map_loss_of(R::get(maps, run), output_nm.lane(run), run));
        let loss_nm = output_nm.map_lanes(|run| R::get(&found, run).0);
        (loss_nm, output_nm.mask_lanes(|run| R::get(&found, run).1))
    }
}

impl<R: Real> Engaged<'_, R> {
    /// Loss of the map of one run.
    fn map_loss_of(&self, map: &LossMap, output_nm: f64, run: usize) -> (f64, bool) {
        let behind = MapPoint {
            ratio: f64::from(self.gear),
            input_speed_rad_s: self.input_rad_s.lane(run),
            torque_nm: output_nm,
            pressure_pa: 0.0,
            oil_k: self.oil_k.lane(run),
        };
        map.loss_behind_nm(&behind, self.map_factor.lane(run)) // MB-6
    }

    /// Output torque referred to the input for an input torque of one run with a map.
    fn output_by_map(&self, map: &LossMap, input_nm: f64, run: usize) -> (f64, u16) {
        iterate_output(input_nm, |output_nm| {
            self.map_loss_of(map, output_nm, run).0
        })
    }
}

/// Output torque and iterations for an input torque: the fixed point of input minus loss.
fn iterate_output(input_nm: f64, loss_nm: impl Fn(f64) -> f64) -> (f64, u16) {
    let mut x = input_nm;
    let mut count = 0;
    while count < 60 {
        let miss = x + loss_nm(x) - input_nm;
        count += 1;
        if miss.abs() <= 1e-10 * (1.0 + input_nm.abs()) {
            break;
        }
        x -= miss;
    }
    (x, count)
}
