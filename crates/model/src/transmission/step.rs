//! What a driveline receives and gives in a time step.

use super::clamp_cause::ClampCause;
use super::component::{ByComponent, Component};
use super::coupling::Reach;
use crate::cycle::GearCommand;
use crate::flags::Flags;
use crate::fluid::Lubricant;
use crate::prime_mover::PrimeMover;
use crate::road::WheelDemand;
use crate::thermal::Heat;

/// What a driveline receives for a step.
#[derive(Debug)]
pub struct StepInput<'a, P> {
    /// Demand at the wheels.
    pub wheel: &'a WheelDemand,
    /// The engine at its present temperature.
    pub engine: &'a P,
    /// Transmission oil.
    pub oil: &'a Lubricant,
    /// Temperatures at the beginning of the step.
    pub heat: &'a Heat,
    /// Gear that the cycle prescribes, if it does.
    pub gear: Option<GearCommand>,
    /// Length of the step, s.
    pub dt_s: f64,
    /// True where the engine is switched off.
    pub engine_off: bool,
    /// Share of a step at rest that an automatic box is in neutral, 0..1 (SE-3).
    pub neutral_share: f64,
}

impl<P: PrimeMover> StepInput<'_, P> {
    /// Engine speeds within reach of the one before the step, for an engine that passes on at least `load_nm`.
    #[inline]
    pub(super) fn reach(&self, from_rad_s: f64, load_nm: f64) -> Reach {
        Reach {
            from_rad_s,
            slowest_rad_s: self.engine.slowed_rad_s(from_rad_s, load_nm, self.dt_s),
            fastest_rad_s: from_rad_s + self.engine.max_accel_rad_s2() * self.dt_s,
        }
    }
}

/// What a driveline keeps of the step before.
#[derive(Clone, Copy, Debug)]
pub struct DrivelineState {
    /// Manual box: gear engaged.
    pub gear: u8,
    /// Engine speed, rad/s.
    pub engine_rad_s: f64,
    /// Throttle, as a start for the solve.
    pub throttle: f64,
    /// Secondary pressure, Pa.
    pub secondary_pa: f64,
    /// True where the coupling has locked.
    pub coupled: bool,
    /// True where the car stood still.
    pub stood: bool,
    /// Time that it has, s, with the engine running; kept by a CVT.
    pub rested_s: f64,
}

/// What a driveline gives for a step, powers in W.
#[derive(Clone, Copy, Debug)]
pub struct StepOutput {
    /// Engine speed, rad/s.
    pub engine_rad_s: f64,
    /// Torque at the flywheel into the transmission, without inertia, Nm.
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
    /// What decided the secondary pressure; of no meaning for a manual box.
    pub clamp_cause: ClampCause,
    /// Belt slip; NaN for a manual box.
    pub slip: f64,
    /// Torque that the primary pulley takes from its shaft, Nm; NaN without a belt that turns.
    pub primary_nm: f64,
    /// Torque that the secondary pulley gives to its shaft, Nm; NaN without a belt that turns.
    pub secondary_nm: f64,
    /// Capacity over torque; NaN for a manual box.
    pub clamp_safety: f64,
    /// Loss power of each component, W.
    pub loss_w: ByComponent<f64>,
    /// Loss of the alternator for an electric pump, W.
    pub alternator_w: f64,
    /// Power that the driveline gives to the wheels (negative: takes from them).
    pub output_w: f64,
    /// Power into the brakes.
    pub brake_w: f64,
    /// Demanded power that could not be given.
    pub deficit_w: f64,
    /// Oil flow of the pump, m3/s.
    pub oil_flow_m3_s: f64,
    /// Residual of the solve, a fraction.
    pub residual: f64,
    /// Evaluations of the solve.
    pub iterations: u16,
    /// Flags.
    pub flags: Flags,
}

impl StepOutput {
    /// Nothing turns.
    #[inline]
    pub fn at_rest() -> Self {
        StepOutput {
            engine_rad_s: 0.0,
            shaft_nm: 0.0,
            throttle: 0.0,
            gear: 0,
            belt_ratio: f64::NAN,
            primary_pa: f64::NAN,
            secondary_pa: f64::NAN,
            clamp_cause: ClampCause::Law,
            slip: f64::NAN,
            primary_nm: f64::NAN,
            secondary_nm: f64::NAN,
            clamp_safety: f64::NAN,
            loss_w: ByComponent([0.0; Component::COUNT]),
            alternator_w: 0.0,
            output_w: 0.0,
            brake_w: 0.0,
            deficit_w: 0.0,
            oil_flow_m3_s: 0.0,
            residual: 0.0,
            iterations: 0,
            flags: Flags::default(),
        }
    }

    /// Splits the difference between the power given and the power demanded into brake and deficit.
    pub(super) fn split_brake_and_shortfall(&mut self, wheel: &WheelDemand, output_w: f64) {
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
    pub(super) fn add_loss(&mut self, component: Component, watts: f64) {
        self.loss_w[component] += watts;
    }
}
