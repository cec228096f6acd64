//! A car before the ambient temperature is known.

use super::Car;
use crate::engine::Engine;
use crate::lubricant::Lubricant;
use crate::road::RoadLoadInput;
use crate::transmission::Transmission;
use crate::transmission::loss_factor::LossFactors;

/// A checked car with its fluids; [`Vehicle::car`] makes it ready to drive at an ambient temperature.
#[derive(Clone, Debug)]
pub struct Vehicle {
    car: Car,
    /// Road load before the ambient temperature is known.
    pub road_load: RoadLoadInput,
}

impl Vehicle {
    /// From a car for 20 degC, and road load data for any temperature.
    pub fn new(car: Car, road_load: RoadLoadInput) -> Self {
        Vehicle { car, road_load }
    }

    /// The car at an ambient temperature, K.
    pub fn car(&self, ambient_k: f64) -> Car {
        self.clone().into_car(ambient_k)
    }

    /// The car at an ambient temperature, K, without a copy.
    pub fn into_car(self, ambient_k: f64) -> Car {
        Car {
            road_load: self.road_load.at(ambient_k),
            charge: self.road_load.charge(ambient_k),
            ambient_k,
            ..self.car
        }
    }

    /// The car with each loss of its transmission times a factor more (CV-7, MB-6, LC-6).
    #[must_use]
    pub fn with_losses_times(&self, factors: &LossFactors) -> Self {
        let mut changed = self.clone();
        changed.car.transmission.scale_losses(factors);
        changed
    }

    /// The transmission.
    pub fn transmission(&self) -> &Transmission {
        &self.car.transmission
    }

    /// The engine.
    pub fn engine(&self) -> &Engine {
        &self.car.engine
    }

    /// Transmission oil and engine oil.
    pub fn oils(&self) -> (&Lubricant, &Lubricant) {
        (&self.car.oil, &self.car.engine_oil)
    }
}
