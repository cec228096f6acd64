//! A manual box with final drive in one case: mesh, bearings, churning, seals, and its clutch.
//!
//! | label | statement | status |
//! |---|---|---|
//! | MB-1 | torque at the input shaft for one at the wheels: GT-2, shaft 0 the input, 1 the output, 2 the differential; stage 1 is the gear engaged | derived; geometry ASSUMED |
//! | MB-2 | seals: LS-1 | source: ISO/TR 14179-2; sizes ASSUMED |
//! | MB-3 | bearings: BR-1 to BR-3 of all shafts | source: Palmgren, SKF; sizes and preload ASSUMED |
//! | MB-4 | churning: CH-1 of the packet of wheels on the output shaft and of the differential's wheel | source: form of Changenet and Velex; factor fitted to the published hot loss |
//! | MB-5 | gears: the cycle's, on a WLTC GS-1 to GS-6, else shift speeds with hysteresis; a lower gear where the one in force lacks torque, and one where the cycle has none and the car would fall behind | prescribed gears source: UN R83, UN GTR 15; rest derived |
//! | MB-6 | GT-1 and GT-2 with f_bearing (M_0 + M_pre) and the bearings' part of k, f_churning C, f_seal T_seal, f_mesh the teeth's part of k; a map f times | derived: definition of losses changed by the factors f of `loss_factor`, for their price |
//!
//! At 80 degC the mean of gears 3 to 5 without load follows the published 0.925 Nm + 0.000407 Nm/rpm within 25 % from 1000 to 4000 rpm, and
//! flatter. In neutral the engine turns the input shaft and a share of the losses in top gear; declutched, the wheels turn the box.
//! A gear change is driven in the gear that follows it. After a change up the clutch slips until the engine has come down to the box (EN-12).

mod engaged;
mod gears;
mod keys;
mod step;

pub use engaged::{Engaged, PartLosses};
pub use gears::ShiftSpeeds;
pub use keys::ManualKeys;

use self::step::ManualStep;
use super::component::Component;
use super::coupling::{Launch, PartialLoss};
use super::gear_train::GearTrain;
use super::loss_factor::{self, LossFactors, UNCHANGED, product};
use super::step::{DrivelineState, StepInput, StepOutput};
use crate::cycle::GearCommand;
use crate::flags::Flags;
use crate::fluid::VALID_K;
use crate::maps::LossMap;
use crate::math::larger;
use crate::prime_mover::PrimeMover;
use crate::thermal::SUMP;

/// The checked manual box.
#[derive(Clone, Debug)]
pub struct Manual {
    /// Overall ratios from first gear, engine speed over wheel speed.
    pub overall: Vec<f64>,
    /// Gear and final drive in each gear, from first.
    pub trains: Vec<GearTrain>,
    /// Share of the load-independent losses in top gear that turns in neutral.
    pub neutral_share: f64,
    /// Shift speeds where the cycle prescribes no gears.
    pub shifts: ShiftSpeeds,
    /// Coupling to the engine.
    pub coupling: Launch,
    /// Measured map of the whole box in place of bearings, churning, seals and mesh.
    pub map: Option<LossMap>,
    /// Factors on the losses (MB-6), if there are any.
    pub factor: Option<Box<LossFactors>>,
}

impl Manual {
    /// Factors on the losses of the box (MB-6), the coupling apart.
    pub fn loss_factors(&self) -> LossFactors {
        self.factor.as_deref().copied().unwrap_or(UNCHANGED)
    }

    /// Multiplies each loss by a factor (MB-6, LC-6).
    pub fn scale_losses(&mut self, factors: &LossFactors) {
        let launch = factors[Component::LaunchClutch];
        self.coupling = PartialLoss::of(self.coupling.clone(), launch);
        let mut own = product(&self.loss_factors(), factors);
        own[Component::LaunchClutch] = 1.0; // the coupling has it
        self.factor = loss_factor::changes(&own).then(|| Box::new(own));
    }

    /// State at the beginning of a cycle.
    pub fn start<P: PrimeMover>(&self, step: &StepInput<P>) -> DrivelineState {
        let gear = if step.wheel.wheel_rad_s > 0.0 {
            self.shifts
                .for_speed(step.wheel.speed_m_s, 1, self.overall.len())
        } else {
            0
        };
        let input = if gear > 0 {
            self.overall[usize::from(gear) - 1] * step.wheel.wheel_rad_s
        } else {
            0.0
        };
        let idle = step.engine.idle_rad_s();
        DrivelineState {
            gear,
            engine_rad_s: larger(input, idle),
            throttle: 0.0,
            secondary_pa: 0.0,
            coupled: input > idle,
            stood: true,
            rested_s: 0.0,
        }
    }

    /// Command in force: the cycle's, else from the shift speeds (MB-5).
    fn command<P: PrimeMover>(&self, step: &StepInput<P>, state: &DrivelineState) -> GearCommand {
        let count = self.overall.len();
        match step.gear {
            Some(GearCommand::Change(g)) => GearCommand::InGear(g),
            Some(GearCommand::InGear(g)) if usize::from(g) > count => {
                GearCommand::InGear(count as u8)
            }
            Some(GearCommand::Declutched(g)) if usize::from(g) > count => {
                GearCommand::Declutched(count as u8)
            }
            Some(command) => command,
            None if step.wheel.wheel_rad_s <= 0.0 => GearCommand::Neutral,
            None => {
                let gear = self
                    .shifts
                    .for_speed(step.wheel.speed_m_s, state.gear, count);
                let input = self.overall[usize::from(gear) - 1] * step.wheel.wheel_rad_s;
                if step.wheel.power_w <= 0.0 && input < 1.05 * step.engine.idle_rad_s() {
                    GearCommand::Declutched(gear)
                } else {
                    GearCommand::InGear(gear)
                }
            }
        }
    }

    /// True where the cycle has no gear in force, and one was needed to drive the car faster.
    fn is_wrong_gear<P: PrimeMover>(step: &StepInput<P>, output: &StepOutput) -> bool {
        let no_gear = matches!(
            step.gear,
            Some(GearCommand::Neutral | GearCommand::Declutched(_))
        );
        let engaged = !output.flags.contains(Flags::CLUTCH_OPEN);
        no_gear && engaged && step.wheel.power_w > 0.0 && step.wheel.accel_m_s2 > 0.0
    }

    /// Solves one step; fills an output at rest.
    pub(super) fn solve<P: PrimeMover>(
        &self,
        step: &StepInput<P>,
        state: &mut DrivelineState,
        output: &mut StepOutput,
    ) {
        if step.engine_off {
            state.engine_rad_s = step.engine.idle_rad_s(); // the starter brings it back there
            state.stood = true;
            state.coupled = false;
            output.flags.set(Flags::ENGINE_OFF, true);
            return;
        }
        let at = ManualStep {
            manual: self,
            step,
            state,
            oil: step.oil.state(step.heat.node_k[SUMP]),
        };
        match self.command(step, state) {
            GearCommand::InGear(gear) | GearCommand::Change(gear)
                if step.wheel.wheel_rad_s > 0.0 && gear > 0 =>
            {
                at.engaged(gear, output);
            }
            GearCommand::Neutral if step.wheel.wheel_rad_s <= 0.0 => at.neutral(output),
            GearCommand::Declutched(gear)
            | GearCommand::InGear(gear)
            | GearCommand::Change(gear) => at.coasting(gear, output),
            GearCommand::Neutral => at.coasting(state.gear, output),
        }
        output.flags.set(
            Flags::OVERSPEED,
            output.engine_rad_s > step.engine.max_rad_s(),
        );
        let wrong_gear = Self::is_wrong_gear(step, output);
        output.flags.set(Flags::WRONG_GEAR, wrong_gear);
        output.flags.set(
            Flags::OUTSIDE_VALIDITY,
            !VALID_K.contains(&step.heat.node_k[SUMP]),
        );
        state.gear = if output.gear > 0 {
            output.gear
        } else {
            state.gear
        };
        state.engine_rad_s = output.engine_rad_s;
        let turning = output.gear > 0 && !output.flags.contains(Flags::CLUTCH_OPEN);
        // A clutch that was locked and slips after a change up only has the engine come down: it is no launch (LC-5), unless the box is slower
        // than the idling engine, where LC-5 lets both slip alike.
        let input_rad_s = match output.gear {
            0 => 0.0,
            gear => self.overall[usize::from(gear) - 1] * step.wheel.wheel_rad_s,
        };
        let locks = input_rad_s >= step.engine.idle_rad_s();
        let slips = output.flags.contains(Flags::CLUTCH_SLIPPING);
        state.coupled = turning && (!slips || (state.coupled && locks));
        state.stood = step.wheel.wheel_rad_s <= 0.0;
    }
}
