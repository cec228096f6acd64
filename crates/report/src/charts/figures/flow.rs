//! Energy flow of one car: from fuel to wheel, and its transmission enlarged.

use super::sankey::{Branch, Sankey, Stage, Whole, branch, sankey};
use super::{Term, drive_subtitle, finite};
use crate::charts::picture::Picture;
use crate::number::{capital, capital_first, grouped};
use cvtcycle_output::Component;

/// Energies of one run over its distance, kJ/km: fuel = exhaust + heat to the engine + accessories + rotating energy + losses + brakes + wheels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarEnergy {
    /// Name of the car.
    pub subject: String,
    /// Cycle, ambient temperature and start.
    pub conditions: String,
    /// Fuel, lower heating value.
    pub fuel_kj_km: f64,
    /// Heat and unburnt fuel into the exhaust.
    pub exhaust_kj_km: f64,
    /// Heat to the engine.
    pub engine_heat_kj_km: f64,
    /// Accessories.
    pub accessories_kj_km: f64,
    /// Change of rotating energy; negative where it was returned.
    pub kinetic_kj_km: f64,
    /// Losses of the transmission in the order of the power flow.
    pub losses_kj_km: Vec<(Component, f64)>,
    /// Wheel brakes.
    pub brake_kj_km: f64,
    /// Net work at the wheels, against rolling and air resistance.
    pub wheels_kj_km: f64,
    /// Largest fuel, and work at the flywheel, of the report's cars, kJ/km: all are drawn on one scale.
    pub largest_kj_km: [f64; 2],
}

/// Share of the fuel, or of the work at the flywheel, below which the energy of the rotating parts is drawn with the accessories, and a part of
/// the transmission with the other small ones.
const THIN: f64 = 0.005;

impl CarEnergy {
    /// All losses of the transmission, kJ/km.
    pub fn transmission_kj_km(&self) -> f64 {
        self.losses_kj_km
            .iter()
            .map(|(_, kj_km)| finite(*kj_km))
            .sum()
    }

    /// Work into the transmission at the flywheel, kJ/km: the sum of losses, brakes and wheels.
    pub fn flywheel_kj_km(&self) -> f64 {
        self.transmission_kj_km() + finite(self.brake_kj_km) + finite(self.wheels_kj_km)
    }

    fn at_wheels(&self) -> Stage {
        let brakes = branch("Brakes", Term::Brake, self.brake_kj_km);
        let rolling = branch("Rolling and air", Term::Wheels, self.wheels_kj_km);
        Stage::new("Wheels", vec![brakes, rolling])
    }

    /// Share of the work at the flywheel that reaches brakes and wheels; `None` without work.
    pub fn passed(&self) -> Option<f64> {
        let flywheel = self.flywheel_kj_km();
        let passed = 1.0 - self.transmission_kj_km() / flywheel;
        (flywheel > 0.0 && passed.is_finite()).then_some(passed)
    }

    /// Accessories; the rotating parts are separate if large enough to be seen.
    fn crankshaft(&self) -> Vec<Branch> {
        let (accessories, kinetic) = (self.accessories_kj_km, self.kinetic_kj_km);
        if kinetic.abs() < THIN * self.fuel_kj_km {
            let name = "Accessories etc.";
            return vec![branch(name, Term::Accessories, accessories + kinetic)];
        }
        vec![
            branch("Accessories", Term::Accessories, accessories),
            branch("Rotating parts", Term::Kinetic, kinetic),
        ]
    }

    /// Names the drawn energy, the car and the conditions.
    fn subtitle(&self) -> String {
        format!(
            "Energy in kJ/km; {}",
            drive_subtitle(&self.subject, &self.conditions)
        )
    }

    fn whole(&self) -> Whole {
        Whole::new("the fuel", self.fuel_kj_km)
    }
}

/// Flow from fuel to wheel; the transmission is one branch.
pub fn energy_flow(car: &CarEnergy) -> Picture {
    let engine = vec![
        branch("Exhaust", Term::Exhaust, car.exhaust_kj_km),
        branch(
            "Heat to the engine",
            Term::EngineHeat,
            car.engine_heat_kj_km,
        ),
    ];
    let losses = branch(
        "Transmission losses",
        Term::Transmission,
        car.transmission_kj_km(),
    );
    sankey(Sankey {
        title: fuel_title(car),
        subject: &car.subtitle(),
        largest_kj_km: car.largest_kj_km[0],
        source: Whole::new("Fuel", car.fuel_kj_km),
        stages: vec![
            Stage::new("Engine", engine),
            Stage::new("Crankshaft", car.crankshaft()),
            Stage::new("Transmission", vec![losses]),
            car.at_wheels(),
        ],
        shares_of: vec![car.whole()],
    })
}

/// Flow from the flywheel to the wheels, with a branch for each component.
pub fn transmission_flow(car: &CarEnergy) -> Picture {
    let source = car.flywheel_kj_km();
    let component = |(c, kj_km): &(Component, f64)| {
        let branch = branch(&capital(c.name()), Term::Component(*c), *kj_km);
        Stage::new("", vec![branch])
    };
    let is_thin = |loss: &&(Component, f64)| loss.1.abs() < THIN * source;
    let thin: Vec<&(Component, f64)> = car.losses_kj_km.iter().filter(is_thin).collect();
    // Combining a single small part would only lose its name.
    let folded = thin.len() > 1;
    let shown = car.losses_kj_km.iter();
    let shown = shown
        .filter(|loss| !folded || !is_thin(loss))
        .map(component);
    let names: Vec<&str> = thin.iter().map(|(c, _)| c.title()).collect();
    let rest = folded.then(|| {
        let sum = thin.iter().map(|(_, kj_km)| finite(*kj_km)).sum();
        let name = capital_first(&names.join(", ").to_lowercase());
        Stage::new("", vec![branch(&name, Term::Other, sum)])
    });
    let stages = shown.chain(rest);
    sankey(Sankey {
        title: box_title(car),
        subject: &car.subtitle(),
        largest_kj_km: car.largest_kj_km[1],
        source: Whole::new("Flywheel", source),
        stages: stages.chain([car.at_wheels()]).collect(),
        shares_of: vec![Whole::new("flywheel work", source), car.whole()],
    })
}

/// Title: shares of the fuel that reach the wheels and are lost in the transmission.
fn fuel_title(car: &CarEnergy) -> String {
    let share = |kj_km: f64| 100.0 * kj_km / car.fuel_kj_km;
    let [wheels, lost] = [car.wheels_kj_km, car.transmission_kj_km()].map(share);
    if !(wheels.is_finite() && lost.is_finite()) {
        return "Energy from fuel to wheel".to_owned();
    }
    format!(
        "Of the fuel of {} {} % reach the road; the transmission loses {} %",
        car.subject,
        grouped(wheels, 1),
        grouped(lost, 1)
    )
}

/// Title: share of the work at the flywheel that the transmission passes on.
fn box_title(car: &CarEnergy) -> String {
    match car.passed() {
        Some(share) => format!(
            "The transmission of {} passes {} % of the flywheel's work to brakes and wheels",
            car.subject,
            grouped(100.0 * share, 1)
        ),
        None => "Energy through the transmission, flywheel to wheel".to_owned(),
    }
}
