//! Cars and fluids of the figures.

use cvtcycle::config::render;
use cvtcycle::config::setup::{Options, Setup, load};
use cvtcycle::model::lubricant::{BandFriction, Lubricant};
use cvtcycle::model::transmission::Transmission;
use cvtcycle::model::transmission::cvt::Cvt;
use cvtcycle::model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, BeltState, Formulation, belt_state,
};
use cvtcycle::model::transmission::manual::Manual;

/// 1 rpm in rad/s.
pub const RPM: f64 = std::f64::consts::PI / 30.0;
/// Low and high ratio of the thesis's rig.
pub const LOW: f64 = 2.4169;
pub const HIGH: f64 = 0.5;

/// Reference cars.
pub struct Reference {
    pub cvt_car: Setup,
    pub manual_car: Setup,
}

fn car(name: &str) -> Result<Setup, String> {
    load(name, &Options::default()).map_err(|problems| render(&problems, false))
}

/// State of the belt in a figure.
#[derive(Clone, Copy)]
pub struct At {
    pub ratio: f64,
    pub rpm: f64,
    pub output_nm: f64,
    pub bar: f64,
}

impl Reference {
    /// Loads the cars.
    pub fn load() -> Result<Self, String> {
        Ok(Reference {
            cvt_car: car("rover_216_cvt")?,
            manual_car: car("rover_216_5mt")?,
        })
    }

    /// CVT of the reference car.
    pub fn cvt(&self) -> &Cvt {
        match self.cvt_car.transmission() {
            Transmission::Cvt(cvt) => cvt,
            Transmission::Manual(_) => unreachable!("the car has a CVT"),
        }
    }

    /// Manual box of its sister model.
    pub fn manual(&self) -> &Manual {
        match self.manual_car.transmission() {
            Transmission::Manual(manual) => manual,
            Transmission::Cvt(_) => unreachable!("the car has a manual box"),
        }
    }

    /// Transmission oil of the reference car.
    pub fn oil(&self) -> &Lubricant {
        self.cvt_car.oils().0
    }

    /// Belt in a formulation of the thesis.
    pub fn belt(&self, formulation: Formulation) -> Belt {
        Belt {
            formulation,
            ..self.cvt().belt.clone()
        }
    }

    /// Belt at 85 degC with boundary friction on the bands, without film.
    pub fn boundary(&self, belt: &Belt, at: At) -> BeltState {
        self.with_friction(belt, at, BandFriction::dry(self.oil().friction.band))
    }

    /// Belt with a given band friction.
    pub fn with_friction(&self, belt: &Belt, at: At, band: BandFriction) -> BeltState {
        let cvt = self.cvt();
        let prepared = BeltAtRatio::new(belt, at.ratio);
        belt_state(
            belt,
            &prepared,
            &BeltLoad {
                primary_speed_rad_s: at.rpm * RPM,
                output_torque_nm: at.output_nm,
                secondary_clamp_n: cvt.secondary_clamp_n(at.bar * 1e5, at.rpm * RPM / at.ratio),
                ..BeltLoad::unloaded(
                    &self.oil().friction,
                    band,
                    prepared.prepared.film_area_m2,
                    belt.sliding_m_s(at.ratio, at.rpm * RPM),
                )
            },
        )
    }
}
