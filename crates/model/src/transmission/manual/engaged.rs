//! The box in a gear: its gear train, or the measured map in place of it.

use super::Manual;
use crate::fluid::OilState;
use crate::maps::{LossMap, MapPoint};
use crate::transmission::component::Component;
use crate::transmission::gear_train::{TrainLosses, TurningTrain};

/// Losses by component, Nm at the input shaft.
pub type PartLosses = [(Component, f64); 5];

/// The box in a gear at a speed and an oil temperature: what does not depend on the torque that passes is known.
pub struct Engaged<'a> {
    map: Option<&'a LossMap>,
    /// Factor on the loss of the map.
    map_factor: f64,
    gear: u8,
    input_rad_s: f64,
    oil_k: f64,
    /// Nothing where a map holds the losses.
    train: TurningTrain,
}

/// The box at a torque, Nm at the input shaft.
pub(super) struct Loaded {
    pub output_nm: f64,
    pub input_nm: f64,
    pub losses_nm: PartLosses,
    pub inside_map: bool,
}

impl Manual {
    /// The box in a gear at a speed of its input shaft, in its oil at a temperature, K, with the torque at that shaft that the demanded power
    /// gives.
    pub fn engaged(
        &self,
        gear: u8,
        input_rad_s: f64,
        demand_nm: f64,
        (oil, oil_k): (OilState, f64),
    ) -> Engaged<'_> {
        let train = match self.map {
            Some(_) => TurningTrain::default(),
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
            None => (train, 1.0),
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
fn by_component(train: TrainLosses, map_nm: f64) -> PartLosses {
    [
        (Component::GearMesh, train.mesh),
        (Component::Bearing, train.bearing),
        (Component::Churning, train.churning),
        (Component::Seal, train.seal),
        (Component::BoxMap, map_nm),
    ]
}

/// Sum of the losses, Nm.
pub(super) fn sum_nm(losses: &PartLosses) -> f64 {
    losses.iter().map(|(_, nm)| nm).sum()
}

impl Engaged<'_> {
    /// Losses for an output torque referred to the input, Nm (MB-1 to MB-4), and whether the map, if there is one, holds the point.
    pub fn losses_nm(&self, output_nm: f64) -> (PartLosses, bool) {
        match self.map {
            Some(map) => {
                let (loss, inside) = self.map_loss(map, output_nm);
                (by_component(TrainLosses::default(), loss), inside)
            }
            None => (by_component(self.train.losses(output_nm), 0.0), true),
        }
    }

    /// Losses of the box with nothing on its input shaft, or the map's without torque.
    pub(super) fn unloaded_nm(&self) -> PartLosses {
        match self.map {
            Some(map) => by_component(TrainLosses::default(), self.map_loss(map, 0.0).0),
            None => by_component(self.train.losses(-self.train.no_load_nm()), 0.0),
        }
    }

    /// Input torque and losses for an output torque referred to the input (MB-1).
    pub(super) fn at(&self, output_nm: f64) -> Loaded {
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
    pub(super) fn output_for(&self, input_nm: f64) -> (f64, u16) {
        let Some(map) = self.map else {
            return (self.train.output_nm(input_nm), 1);
        };
        let mut x = input_nm;
        let mut count = 0;
        while count < 60 {
            let miss = x + self.map_loss(map, x).0 - input_nm;
            count += 1;
            if miss.abs() <= 1e-10 * (1.0 + input_nm.abs()) {
                break;
            }
            x -= miss;
        }
        (x, count)
    }

    /// Loss of a measured map, whose torque axis is the input torque, for an output torque (MP-4).
    fn map_loss(&self, map: &LossMap, output_nm: f64) -> (f64, bool) {
        let behind = MapPoint {
            ratio: f64::from(self.gear),
            input_speed_rad_s: self.input_rad_s,
            torque_nm: output_nm,
            pressure_pa: 0.0,
            oil_k: self.oil_k,
        };
        map.loss_behind_nm(&behind, self.map_factor) // MB-6
    }
}
