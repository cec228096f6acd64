//! The energy flow of one car: all of it from fuel to wheel, and its transmission enlarged.

use super::sankey::{Sankey, Stage, Whole, branch, sankey};
use super::{Term, finite};
use crate::charts::picture::Picture;
use crate::number::capital;
use cvtcycle_output::Component;

/// Energies of one run, kJ: fuel = exhaust + heat to the engine + accessories + rotating energy + losses + brakes + wheels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarEnergy {
    /// Name of the car.
    pub subject: String,
    /// Fuel, lower heating value.
    pub fuel_kj: f64,
    /// Heat and unburnt fuel into the exhaust.
    pub exhaust_kj: f64,
    /// Heat to the engine.
    pub engine_heat_kj: f64,
    /// Accessories.
    pub accessories_kj: f64,
    /// Change of rotating energy; negative where it was given back.
    pub kinetic_kj: f64,
    /// Losses of the transmission in the order of the power flow.
    pub losses_kj: Vec<(Component, f64)>,
    /// Wheel brakes.
    pub brake_kj: f64,
    /// Net work at the wheels, against rolling and air resistance.
    pub wheels_kj: f64,
}

impl CarEnergy {
    /// All losses of the transmission, kJ.
    pub fn transmission_kj(&self) -> f64 {
        self.losses_kj.iter().map(|(_, kj)| finite(*kj)).sum()
    }

    /// Work into the transmission at the flywheel, kJ: what leaves it again as losses, at the brakes and at the wheels.
    pub fn flywheel_kj(&self) -> f64 {
        self.transmission_kj() + finite(self.brake_kj) + finite(self.wheels_kj)
    }

    fn at_wheels(&self) -> Stage {
        let brakes = branch("Brakes", Term::Brake, self.brake_kj);
        let rolling = branch("Rolling and air", Term::Wheels, self.wheels_kj);
        Stage::new("Wheels", vec![brakes, rolling])
    }

    fn whole(&self) -> Whole {
        Whole::new("the fuel", self.fuel_kj)
    }
}

/// From fuel to wheel; the transmission is one branch.
pub fn energy_flow(car: &CarEnergy) -> Picture {
    let engine = vec![
        branch("Exhaust", Term::Exhaust, car.exhaust_kj),
        branch("Heat to the engine", Term::EngineHeat, car.engine_heat_kj),
    ];
    let crankshaft = vec![
        branch("Accessories", Term::Accessories, car.accessories_kj),
        branch("Rotating parts", Term::Kinetic, car.kinetic_kj),
    ];
    let losses = branch(
        "Transmission losses",
        Term::Transmission,
        car.transmission_kj(),
    );
    sankey(Sankey {
        title: "Energy from fuel to wheel",
        subject: &car.subject,
        source: Whole::new("Fuel", car.fuel_kj),
        stages: vec![
            Stage::new("Engine", engine),
            Stage::new("Crankshaft", crankshaft),
            Stage::new("Transmission", vec![losses]),
            car.at_wheels(),
        ],
        shares_of: vec![car.whole()],
    })
}

/// From the flywheel to the wheels, with a branch for each component.
pub fn transmission_flow(car: &CarEnergy) -> Picture {
    let source = car.flywheel_kj();
    let component = |(c, kj): &(Component, f64)| {
        let branch = branch(&capital(c.name()), Term::Component(*c), *kj);
        Stage::new("", vec![branch])
    };
    let stages = car.losses_kj.iter().map(component);
    sankey(Sankey {
        title: "Energy through the transmission, flywheel to wheel",
        subject: &car.subject,
        source: Whole::new("Flywheel", source),
        stages: stages.chain([car.at_wheels()]).collect(),
        shares_of: vec![Whole::new("flywheel work", source), car.whole()],
    })
}
