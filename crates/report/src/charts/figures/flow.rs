//! The energy flow of one car: all of it from fuel to wheel, and its transmission enlarged.

use super::sankey::{Sankey, SankeyBranch, SankeyStage, sankey};
use super::{Term, finite};
use crate::charts::picture::Picture;
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
    #[must_use]
    pub fn transmission_kj(&self) -> f64 {
        self.losses_kj.iter().map(|(_, kj)| finite(*kj)).sum()
    }

    /// Work into the transmission at the flywheel, kJ: what leaves it again as losses, at the brakes and at the wheels.
    #[must_use]
    pub fn flywheel_kj(&self) -> f64 {
        self.transmission_kj() + finite(self.brake_kj) + finite(self.wheels_kj)
    }

    fn at_wheels(&self) -> SankeyStage {
        let branches = vec![
            SankeyBranch::term("Brakes", Term::Brake, self.brake_kj),
            SankeyBranch::term("Rolling and air", Term::Wheels, self.wheels_kj),
        ];
        SankeyStage {
            name: "Wheels".to_owned(),
            branches,
        }
    }
}

/// From fuel to wheel; the transmission is one branch.
#[must_use]
pub fn energy_flow(car: &CarEnergy) -> Picture {
    let stage = |name: &str, branches: Vec<SankeyBranch>| SankeyStage {
        name: name.to_owned(),
        branches,
    };
    let engine = vec![
        SankeyBranch::term("Exhaust", Term::Exhaust, car.exhaust_kj),
        SankeyBranch::term("Heat to the engine", Term::EngineHeat, car.engine_heat_kj),
    ];
    let flywheel = vec![
        SankeyBranch::term("Accessories", Term::Accessories, car.accessories_kj),
        SankeyBranch::term("Rotating parts", Term::Kinetic, car.kinetic_kj),
    ];
    let transmission = vec![SankeyBranch::term(
        "Transmission losses",
        Term::Transmission,
        car.transmission_kj(),
    )];
    sankey(&Sankey {
        title: "Energy from fuel to wheel".to_owned(),
        subject: car.subject.clone(),
        source: ("Fuel".to_owned(), car.fuel_kj),
        stages: vec![
            stage("Engine", engine),
            stage("Crankshaft", flywheel),
            stage("Transmission", transmission),
            car.at_wheels(),
        ],
        shares_of: vec![("the fuel".to_owned(), car.fuel_kj)],
    })
}

/// From the flywheel to the wheels, with a branch for each component.
#[must_use]
pub fn transmission_flow(car: &CarEnergy) -> Picture {
    let source = car.flywheel_kj();
    let mut stages: Vec<SankeyStage> = car
        .losses_kj
        .iter()
        .map(|(c, kj)| SankeyStage {
            name: String::new(),
            branches: vec![SankeyBranch::of(*c, *kj)],
        })
        .collect();
    stages.push(car.at_wheels());
    sankey(&Sankey {
        title: "Energy through the transmission, flywheel to wheel".to_owned(),
        subject: car.subject.clone(),
        source: ("Flywheel".to_owned(), source),
        stages,
        shares_of: vec![
            ("flywheel work".to_owned(), source),
            ("the fuel".to_owned(), car.fuel_kj),
        ],
    })
}
