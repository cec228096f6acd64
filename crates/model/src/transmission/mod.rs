//! From the wheels to the engine's flywheel: what the loop sees of a transmission.

pub mod cvt;
pub mod film_heating;
pub mod launch;
pub mod loss_map;
pub mod manual;

use crate::cycle::GearCommand;
use crate::drive::{Component, Flags};
use crate::engine::EngineNow;
use crate::fluid::Lubricant;
use crate::road::WheelDemand;
use crate::thermal::Heat;

/// A transmission of either kind.
#[derive(Clone, Debug)]
pub enum Transmission {
    /// Pushing-belt CVT.
    Cvt(Box<cvt::Cvt>),
    /// Manual box.
    Manual(Box<manual::Manual>),
}

/// What surrounds the driveline in a step.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// Demand at the wheels.
    pub wheel: &'a WheelDemand,
    /// The engine at its present temperature.
    pub engine: &'a EngineNow<'a>,
    /// Transmission oil.
    pub oil: &'a Lubricant,
    /// Temperatures at the beginning of the step.
    pub heat: &'a Heat,
    /// Gear that the cycle prescribes, if it does.
    pub gear: Option<GearCommand>,
    /// Length of the step, s.
    pub dt_s: f64,
    /// Whether the engine is switched off.
    pub engine_off: bool,
}

/// What the driveline remembers from step to step.
#[derive(Clone, Copy, Debug)]
pub struct DriveState {
    /// CVT: the belt at the ratio in force.
    pub belt: Option<cvt::variator::BeltAtRatio>,
    /// Everything else; apart, so that a step can change it while it looks at the belt.
    pub past: Past,
}

/// What the driveline remembers of the step before.
#[derive(Clone, Copy, Debug)]
pub struct Past {
    /// Manual box: gear engaged.
    pub gear: u8,
    /// Engine speed, rad/s.
    pub engine_rad_s: f64,
    /// Throttle, as a start for the solve.
    pub throttle: f64,
    /// CVT: how losses and slip went on, as a start for the solve.
    pub trend: cvt::Trend,
    /// Slopes of the CVT's solve, as a start for it.
    pub slopes: cvt::Slopes,
    /// Whether the engine's least torque fixed the output torque; only a start for the solve.
    pub overrun: bool,
    /// Secondary pressure, Pa.
    pub secondary_pa: f64,
    /// Whether the launch device has locked.
    pub coupled: bool,
    /// Whether the car stood still in the step before.
    pub stood: bool,
}

/// The driveline's answer for one step, powers in W.
#[derive(Clone, Copy, Debug)]
pub struct Drive {
    /// Engine speed, rad/s.
    pub engine_rad_s: f64,
    /// Torque at the flywheel into the box, without inertia, Nm.
    pub shaft_nm: f64,
    /// Throttle 0..1.
    pub throttle: f64,
    /// Gear of a manual box, 0 otherwise.
    pub gear: u8,
    /// Belt ratio; NaN for a manual box.
    pub belt_ratio: f64,
    /// Primary pressure, Pa; NaN for a manual box.
    pub primary_pa: f64,
    /// Secondary pressure, Pa; NaN for a manual box.
    pub secondary_pa: f64,
    /// Belt slip; NaN for a manual box.
    pub slip: f64,
    /// Capacity over torque; NaN for a manual box.
    pub clamp_safety: f64,
    /// Loss power of each component, W.
    pub loss_w: [f64; Component::COUNT],
    /// Power that the driveline gives to the wheels (negative: takes from them).
    pub output_w: f64,
    /// Power into the brakes.
    pub brake_w: f64,
    /// Demanded power that could not be given.
    pub deficit_w: f64,
    /// Oil flow of the pump, m3/s.
    pub oil_flow_m3_s: f64,
    /// What the solve left, as a fraction.
    pub residual: f64,
    /// Evaluations.
    pub iterations: u16,
    /// Flags.
    pub flags: Flags,
}

impl Drive {
    /// An answer with nothing turning.
    #[must_use]
    pub fn at_rest() -> Self {
        Drive {
            engine_rad_s: 0.0,
            shaft_nm: 0.0,
            throttle: 0.0,
            gear: 0,
            belt_ratio: f64::NAN,
            primary_pa: f64::NAN,
            secondary_pa: f64::NAN,
            slip: f64::NAN,
            clamp_safety: f64::NAN,
            loss_w: [0.0; Component::COUNT],
            output_w: 0.0,
            brake_w: 0.0,
            deficit_w: 0.0,
            oil_flow_m3_s: 0.0,
            residual: 0.0,
            iterations: 0,
            flags: Flags::default(),
        }
    }

    /// Splits the difference between what the driveline gives and what the wheels demand into brake and deficit.
    pub fn settle(&mut self, wheel: &WheelDemand, output_w: f64) {
        self.output_w = output_w;
        let over = output_w - wheel.power_w;
        if over >= 0.0 {
            self.brake_w = over;
        } else {
            self.deficit_w = -over;
        }
    }

    /// Adds a loss power.
    #[inline]
    pub fn lose(&mut self, component: Component, watts: f64) {
        self.loss_w[component as usize] += watts;
    }
}

impl Transmission {
    /// State at the beginning of a cycle, with the car at `wheel`.
    #[must_use]
    pub fn start(&self, around: &Surroundings) -> DriveState {
        match self {
            Transmission::Cvt(cvt) => cvt.start(around),
            Transmission::Manual(manual) => DriveState {
                belt: None,
                past: manual.start(around),
            },
        }
    }

    /// Solves one step.
    #[must_use]
    pub fn solve(&self, around: &Surroundings, state: &mut DriveState) -> Drive {
        match self {
            Transmission::Cvt(cvt) => cvt.solve(around, state),
            Transmission::Manual(manual) => manual.solve(around, &mut state.past),
        }
    }

    /// Whether it is a CVT (drives the automatic trace).
    #[must_use]
    pub fn is_cvt(&self) -> bool {
        matches!(self, Transmission::Cvt(_))
    }
}
