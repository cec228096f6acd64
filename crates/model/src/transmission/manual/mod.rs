//! A manual box with final drive in one case: mesh, bearings, churning, seals, and its clutch.
//!
//! | label | statement | status |
//! |---|---|---|
//! | MB-1 | input torque = T_wheel/i / eta + T_seal + T_bearing + T_churning in drive, x eta in overrun | eta ASSUMED 0.985 for two meshes (gear and final drive) |
//! | MB-2 | seals: c (nu/nu_r)^m | split of the CO2MPAS hot loss ASSUMED |
//! | MB-3 | bearings: c (n/2000 nu/nu_r)^(2/3), by FH-1 | source: SKF / Palmgren load-independent form; size from the split |
//! | MB-4 | churning: c n/2000 (nu/nu_r)^m | form ASSUMED; size from the split |
//! | MB-5 | gears: the cycle's, else shift speeds with hysteresis; a lower gear where the one in force lacks torque | prescribed gears source: UN R83; rest derived |
//!
//! nu_r is the gear oil's viscosity at 80 degC. At that temperature the sum follows the published 0.925 Nm + 0.000407 Nm/rpm within 5 %
//! from 1000 to 4000 rpm; cold it rises about as viscosity^0.3. In neutral the engine turns the input shaft and a share of the losses; declutched, the wheels turn the box.
//! A gear change is driven in the gear that follows it: the plateau's load is small and the engine's loss of speed is not resolved.

mod gears;
mod keys;
mod losses;

pub use gears::ShiftSpeeds;
pub use keys::ManualKeys;

use self::losses::Spin;
use super::component::Component;
use super::coupling::{Coupling, CouplingLoad, EngineSide};
use super::step::{DrivelineState, StepInput, StepOutput};
use super::viscous_self_heating::ViscousSelfHeating;
use crate::cycle::GearCommand;
use crate::flags::Flags;
use crate::fluid::VALID_K;
use crate::maps::LossMap;
use crate::math::{clamp, larger};
use crate::prime_mover::{FULL_LOAD_LIMIT, PrimeMover};
use crate::thermal::SUMP;
use std::sync::Arc;

/// The checked manual box.
#[derive(Clone, Debug)]
pub struct Manual {
    /// Overall ratios from first gear, engine speed over wheel speed.
    pub overall: Vec<f64>,
    /// Mesh efficiency of gear and final drive together.
    pub mesh_efficiency: f64,
    /// Seal torque at reference viscosity, Nm.
    pub seal_nm: f64,
    /// Seal exponent.
    pub seal_exponent: f64,
    /// Bearing torque at 2000 rpm and reference viscosity, Nm.
    pub bearing_nm: f64,
    /// Heating of the bearings' films (FH-1).
    pub bearing_heating: ViscousSelfHeating,
    /// Churning torque at 2000 rpm and reference viscosity, Nm.
    pub churning_nm: f64,
    /// Churning exponent.
    pub churning_exponent: f64,
    /// Reference viscosity, m2/s.
    pub reference_m2_s: f64,
    /// Share of the load-independent losses that turns in neutral.
    pub neutral_share: f64,
    /// Shift speeds where the cycle prescribes no gears.
    pub shifts: ShiftSpeeds,
    /// Coupling to the engine.
    pub coupling: Arc<dyn Coupling>,
    /// Measured map of the whole box in place of bearings, churning, seals and mesh.
    pub map: Option<LossMap>,
}

impl Manual {
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

    /// Solves one step.
    pub fn solve<P: PrimeMover>(
        &self,
        step: &StepInput<P>,
        state: &mut DrivelineState,
    ) -> StepOutput {
        if step.engine_off {
            state.engine_rad_s = step.engine.idle_rad_s(); // the starter brings it back there
            state.stood = true;
            state.coupled = false;
            let mut rest = StepOutput::at_rest();
            rest.flags.set(Flags::ENGINE_OFF, true);
            return rest;
        }
        let nu = step.oil.kinematic_m2_s(step.heat.node_k[SUMP]);
        let command = self.command(step, state);
        let mut output = match command {
            GearCommand::InGear(gear) | GearCommand::Change(gear)
                if step.wheel.wheel_rad_s > 0.0 && gear > 0 =>
            {
                self.engaged(step, state, gear, nu)
            }
            GearCommand::Neutral if step.wheel.wheel_rad_s <= 0.0 => self.neutral(step, state, nu),
            GearCommand::Declutched(gear)
            | GearCommand::InGear(gear)
            | GearCommand::Change(gear) => self.coasting(step, state, gear, nu),
            GearCommand::Neutral => self.coasting(step, state, state.gear, nu),
        };
        output.flags.set(
            Flags::OVERSPEED,
            output.engine_rad_s > step.engine.max_rad_s(),
        );
        let crank_nm = output.shaft_nm + step.engine.accessories_nm(output.engine_rad_s);
        let share = crank_nm / step.engine.full_load_nm(output.engine_rad_s);
        output.throttle = clamp(share, 0.0, 1.0);
        output.flags.set(
            Flags::OUTSIDE_VALIDITY,
            !VALID_K.contains(&step.heat.node_k[SUMP]) || share > FULL_LOAD_LIMIT,
        );
        state.gear = if output.gear > 0 {
            output.gear
        } else {
            state.gear
        };
        state.engine_rad_s = output.engine_rad_s;
        let turning = output.gear > 0 && !output.flags.contains(Flags::CLUTCH_OPEN);
        state.coupled = turning && !output.flags.contains(Flags::CLUTCH_SLIPPING);
        state.stood = step.wheel.wheel_rad_s <= 0.0;
        output
    }

    /// Speed of the free engine at the end of the step, rad/s.
    fn free_engine_rad_s<P: PrimeMover>(step: &StepInput<P>, state: &DrivelineState) -> f64 {
        step.reach(state.engine_rad_s)
            .nearest(step.engine.idle_rad_s())
    }

    /// Declutched, unless the car would then slow down more than it should: the driver lets the clutch slip in that gear or a lower one.
    fn coasting<P: PrimeMover>(
        &self,
        step: &StepInput<P>,
        state: &DrivelineState,
        gear: u8,
        nu: f64,
    ) -> StepOutput {
        let output = self.declutched(step, state, gear, nu);
        if output.deficit_w > 0.0 {
            self.engaged(step, state, gear.max(1), nu)
        } else {
            output
        }
    }

    fn neutral<P: PrimeMover>(
        &self,
        step: &StepInput<P>,
        state: &DrivelineState,
        nu: f64,
    ) -> StepOutput {
        let w = Self::free_engine_rad_s(step, state);
        let spin = self.unloaded(1, w, nu, step.heat.node_k[SUMP]);
        let share = self.neutral_share;
        let mut output = StepOutput {
            engine_rad_s: w,
            shaft_nm: share * spin.sum(),
            ..StepOutput::at_rest()
        };
        self.lose_spin(&mut output, &spin, share * w);
        output
    }

    /// Clutch open, the wheels turn the box in `gear` (0: its highest), the engine idles.
    fn declutched<P: PrimeMover>(
        &self,
        step: &StepInput<P>,
        state: &DrivelineState,
        gear: u8,
        nu: f64,
    ) -> StepOutput {
        let gear = if gear == 0 {
            self.overall.len() as u8
        } else {
            gear
        };
        let input = self.overall[usize::from(gear) - 1] * step.wheel.wheel_rad_s;
        let spin = self.unloaded(gear, input, nu, step.heat.node_k[SUMP]);
        let mut output = StepOutput {
            engine_rad_s: Self::free_engine_rad_s(step, state),
            gear,
            ..StepOutput::at_rest()
        };
        output.flags.set(Flags::CLUTCH_OPEN, true);
        if input > 0.0 {
            let output_nm = -spin.sum();
            self.lose_spin(&mut output, &spin, input);
            output.split_brake_and_shortfall(step.wheel, output_nm * input);
        }
        output
    }

    fn lose_spin(&self, output: &mut StepOutput, spin: &Spin, speed: f64) {
        output.add_loss(Component::Seal, spin.seal * speed);
        output.add_loss(Component::Bearing, spin.bearing * speed);
        output.add_loss(Component::Churning, spin.churning * speed);
        output.add_loss(Component::BoxMap, spin.map * speed);
    }

    fn engaged<P: PrimeMover>(
        &self,
        step: &StepInput<P>,
        state: &DrivelineState,
        gear: u8,
        nu: f64,
    ) -> StepOutput {
        let mut gear = gear;
        loop {
            let output = self.in_gear(step, state, gear, nu);
            let next = self
                .overall
                .get(usize::from(gear).wrapping_sub(2))
                .map(|r| r * step.wheel.wheel_rad_s);
            match next {
                Some(speed)
                    if output.flags.contains(Flags::MISSED_TRACE)
                        && speed < step.engine.max_rad_s() =>
                {
                    gear -= 1
                }
                _ => return output,
            }
        }
    }

    /// The box in a gear: the torque demanded, or the one at the engine's limit.
    fn in_gear<P: PrimeMover>(
        &self,
        step: &StepInput<P>,
        state: &DrivelineState,
        gear: u8,
        nu: f64,
    ) -> StepOutput {
        let (engine, wheel) = (step.engine, step.wheel);
        let input = self.overall[usize::from(gear) - 1] * wheel.wheel_rad_s;
        let turning = self.turning(gear, input, nu, step.heat.node_k[SUMP]);
        let mut at = turning.at(wheel.power_w / input); // MB-1
        let mut w = self.engine_rad_s(step, state, at.input_nm, input);
        let accessories_nm = engine.accessories_nm(w);
        let absorbed_nm = engine.drag_nm(w) + accessories_nm;
        let least = self
            .coupling
            .min_output_nm(input, w, engine.idle_rad_s(), absorbed_nm);
        let engine_nm = engine.full_load_nm(w) - accessories_nm;
        let most = self.coupling.output_nm(engine_nm, input, w);
        let limit = if at.input_nm < least {
            Some(least)
        } else if at.input_nm > most {
            Some(most)
        } else {
            None
        };
        let mut output = StepOutput {
            gear,
            iterations: 1,
            ..StepOutput::at_rest()
        };
        if let Some(torque) = limit {
            output.flags.set(Flags::MISSED_TRACE, at.input_nm > most);
            let output_nm;
            (output_nm, output.iterations) = turning.output_for(torque);
            at = turning.at(output_nm);
            output.residual = (at.input_nm - torque).abs() / engine.full_load_nm(w);
            w = if torque > least {
                w
            } else {
                self.engine_rad_s(step, state, torque, input)
            };
        }
        output.engine_rad_s = w;
        // A box that drives the engine has it at one torque with its input; below a limit's zero there is only rounding.
        let side = if at.input_nm < 0.0 {
            EngineSide {
                engine_nm: at.input_nm,
                engine_rad_s: w,
                loss_w: at.input_nm * (w - input), // LC-4
            }
        } else {
            self.coupling.engine_side(at.input_nm, input, w)
        };
        output.shaft_nm = side.engine_nm;
        output.add_loss(Component::LaunchClutch, side.loss_w);
        self.lose_spin(&mut output, &at.spin, input);
        output.add_loss(Component::GearMesh, at.mesh_nm * input);
        if limit.is_some() {
            output.split_brake_and_shortfall(wheel, at.output_nm * input);
        } else {
            output.output_w = wheel.power_w;
        }
        let flags = &mut output.flags;
        flags.set(
            Flags::CLUTCH_SLIPPING,
            w > input * (1.0 + 1e-9) && at.input_nm > 0.0,
        );
        flags.set(Flags::OVERRUN, at.input_nm < 0.0);
        flags.set(Flags::OUTSIDE_VALIDITY, !at.inside_map);
        flags.set(Flags::NOT_CONVERGED, output.residual > 1e-8);
        output
    }

    /// Engine speed over the coupling, rad/s; a coupling that locks takes the engine along at once.
    fn engine_rad_s<P: PrimeMover>(
        &self,
        step: &StepInput<P>,
        state: &DrivelineState,
        input_nm: f64,
        input_rad_s: f64,
    ) -> f64 {
        let wanted = self.coupling.engine_rad_s(&CouplingLoad {
            output_nm: input_nm,
            output_rad_s: input_rad_s,
            idle_rad_s: step.engine.idle_rad_s(),
            coupled: state.coupled,
        });
        let least = self.coupling.min_engine_rad_s(input_rad_s);
        let reached = step.reach(state.engine_rad_s).nearest(wanted);
        if reached > least && wanted > least {
            reached
        } else {
            least
        }
    }
}
