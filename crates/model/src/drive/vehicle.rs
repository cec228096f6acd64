//! A car before the ambient temperature is known.

use std::sync::Arc;

use super::Car;
use crate::drive::vehicle_keys::VEHICLE_FILE;
use crate::engine::Engine;
use crate::keys::Values;
use crate::lubricant::Lubricant;
use crate::road::RoadLoadInput;
use crate::thermal::Network;
use crate::transmission::Transmission;
use crate::transmission::cvt::Cvt;
use crate::transmission::cvt::final_drive::FinalDrive;
use crate::transmission::cvt::variator::Formulation;
use crate::transmission::loss_factor::LossFactors;
use crate::transmission::manual::Manual;

/// A checked car with its fluids; [`Vehicle::car`] makes it ready to drive at an ambient temperature. Copies share its large parts.
#[derive(Clone, Debug)]
pub struct Vehicle {
    name: Arc<str>,
    /// Road load before the ambient temperature is known.
    pub road_load: RoadLoadInput,
    transmission: Arc<Transmission>,
    engine: Arc<Engine>,
    network: Network,
    oil: Arc<Lubricant>,
    engine_oil: Arc<Lubricant>,
}

/// Parts of a vehicle that changed values belong to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChangedParts {
    /// Road load and tyres.
    pub road_load: bool,
    /// Engine.
    pub engine: bool,
    /// Transmission, its final drive apart.
    pub transmission: bool,
    /// Final drive of a CVT, whose gears are the dearest part of it to build.
    pub final_drive: bool,
    /// Thermal network.
    pub thermal: bool,
    /// Transmission oil.
    pub oil: bool,
    /// Engine oil.
    pub engine_oil: bool,
}

/// Tables of a vehicle's file that are a part each.
const ROAD_LOAD: &str = "road_load";
const ENGINE: &str = "engine";
const TRANSMISSION: &str = "transmission";
const THERMAL: &str = "thermal";
/// Start of the keys of a final drive: its table and its ratios.
const FINAL_DRIVE: &str = "transmission.cvt.final_drive";

impl ChangedParts {
    /// Adds the part of a key of a vehicle's file; false where the key belongs to none.
    pub fn add_key(&mut self, key: &str) -> bool {
        let part = match key.split('.').next() {
            Some(ROAD_LOAD) => &mut self.road_load,
            Some(ENGINE) => &mut self.engine,
            Some(TRANSMISSION) if key.starts_with(FINAL_DRIVE) => &mut self.final_drive,
            Some(TRANSMISSION) => &mut self.transmission,
            Some(THERMAL) => &mut self.thermal,
            _ => return false,
        };
        *part = true;
        true
    }

    /// True where the thermal network differs, whose sump the oil fills.
    fn network(&self) -> bool {
        self.thermal || self.oil
    }

    /// True where the transmission differs apart from oil level and final drive: its control is limited by the engine.
    fn transmission(&self) -> bool {
        self.transmission || self.engine || self.oil
    }

    fn driveline(&self) -> bool {
        self.network() || self.transmission() || self.final_drive
    }
}

impl Vehicle {
    /// A vehicle from the values of its file, and its oils. `base` is a vehicle of the same values but for those of some parts: the other
    /// parts are shared with it.
    pub fn from_values<V: Values>(
        root: &V,
        [oil, engine_oil]: [Arc<Lubricant>; 2],
        formulation: Formulation,
        name: &str,
        base: Option<(&Vehicle, &ChangedParts)>,
    ) -> Self {
        let kept = |changed: fn(&ChangedParts) -> bool| {
            let unchanged = base.filter(|(_, parts)| !changed(parts));
            unchanged.map(|(vehicle, _)| vehicle)
        };
        let road_load = match kept(|parts| parts.road_load) {
            Some(base) => base.road_load,
            None => RoadLoadInput::from_values(&root.table(ROAD_LOAD)),
        };
        let engine = match kept(|parts| parts.engine) {
            Some(base) => Arc::clone(&base.engine),
            None => Arc::new(Engine::from_values(&root.table(ENGINE))),
        };
        let (network, transmission) = match kept(ChangedParts::driveline) {
            Some(base) => (base.network.clone(), Arc::clone(&base.transmission)),
            None => driveline(root, &engine, &oil, formulation, base),
        };
        Vehicle {
            name: base.map_or_else(|| name.into(), |(base, _)| Arc::clone(&base.name)),
            road_load,
            transmission,
            engine,
            network,
            oil,
            engine_oil,
        }
    }

    /// The car at an ambient temperature, K.
    pub fn car(&self, ambient_k: f64) -> Car {
        self.clone().into_car(ambient_k)
    }

    /// The car at an ambient temperature, K, with a copy of those parts alone that are shared.
    pub fn into_car(self, ambient_k: f64) -> Car {
        let belt_heat_share = match &*self.transmission {
            Transmission::Cvt(cvt) => cvt.belt_heat_share,
            Transmission::Manual(_) => 0.0,
        };
        Car {
            name: self.name.as_ref().to_owned(),
            road_load: self.road_load.at(ambient_k),
            tyre: self.road_load.tyre,
            transmission: Arc::unwrap_or_clone(self.transmission),
            engine: Arc::unwrap_or_clone(self.engine),
            network: self.network,
            oil: Arc::unwrap_or_clone(self.oil),
            engine_oil: Arc::unwrap_or_clone(self.engine_oil),
            ambient_k,
            charge: self.road_load.charge(ambient_k),
            belt_heat_share,
        }
    }

    /// The car with each loss of its transmission times a factor more (CV-7, MB-6, LC-6).
    #[must_use]
    pub fn with_losses_times(&self, factors: &LossFactors) -> Self {
        let mut changed = self.clone();
        Arc::make_mut(&mut changed.transmission).scale_losses(factors);
        changed
    }

    /// The transmission.
    pub fn transmission(&self) -> &Transmission {
        &self.transmission
    }

    /// The engine.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// Transmission oil and engine oil.
    pub fn oils(&self) -> (&Lubricant, &Lubricant) {
        (&self.oil, &self.engine_oil)
    }

    /// Transmission oil and engine oil, for another vehicle to share.
    pub fn shared_oils(&self) -> [Arc<Lubricant>; 2] {
        [Arc::clone(&self.oil), Arc::clone(&self.engine_oil)]
    }
}

/// Thermal network and transmission of a vehicle, of which `base` may give the parts that are as they were.
fn driveline<V: Values>(
    root: &V,
    engine: &Engine,
    oil: &Lubricant,
    formulation: Formulation,
    base: Option<(&Vehicle, &ChangedParts)>,
) -> (Network, Arc<Transmission>) {
    let (kind, section) = root.choose(&VEHICLE_FILE.transmission);
    let network = match base.filter(|(_, parts)| !parts.network()) {
        Some((base, _)) => base.network.clone(),
        None => Network::from_values(&root.table(THERMAL), kind == "cvt", oil),
    };
    // The gears of the transmission turn in the oil of the network's sump.
    let oil_m3 = network.sump_oil_m3;
    let base = base.filter(|(base, _)| base.network.sump_oil_m3.to_bits() == oil_m3.to_bits());
    let transmission = match base.filter(|(_, parts)| !parts.transmission()) {
        Some((base, parts)) if !parts.final_drive => {
            return (network, Arc::clone(&base.transmission));
        }
        Some((base, _)) => {
            let mut transmission = Transmission::clone(&base.transmission);
            if let Transmission::Cvt(cvt) = &mut transmission {
                cvt.final_drive = FinalDrive::from_cvt_values(&section, oil_m3);
            }
            transmission
        }
        None if kind == "cvt" => {
            let known = base.filter(|(_, parts)| !parts.final_drive);
            let known = known.and_then(|(base, _)| match &*base.transmission {
                Transmission::Cvt(cvt) => Some(&cvt.final_drive),
                Transmission::Manual(_) => None,
            });
            let oil = (oil, oil_m3);
            let cvt = Cvt::from_values(&section, engine, oil, formulation, known);
            Transmission::Cvt(Box::new(cvt))
        }
        None => Transmission::Manual(Box::new(Manual::from_values(&section, oil_m3))),
    };
    (network, Arc::new(transmission))
}
