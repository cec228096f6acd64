//! Input, state and output of a driveline in a time step.

use super::clamp_cause::ClampCause;
use super::component::{ByComponent, Component};
use super::coupling::Reach;
use crate::cycle::GearCommand;
use crate::flags::Flags;
use crate::lubricant::Lubricant;
use crate::math::{Mask, Real, physics};
use crate::prime_mover::PrimeMover;
use crate::road::WheelDemand;
use crate::thermal::Heat;

/// Input of a driveline for a step.
#[derive(Debug)]
pub struct StepInput<'a, P, R: Real = f64> {
    /// Demand at the wheels.
    pub wheel: &'a WheelDemand<R>,
    /// The engine at its present temperature.
    pub engine: &'a P,
    /// Transmission oil.
    pub oil: &'a Lubricant<R>,
    /// Temperatures at the beginning of the step.
    pub heat: &'a Heat<R>,
    /// Gear that the cycle prescribes, if it does.
    pub gear: Option<GearCommand>,
    /// Length of the step, s.
    pub dt_s: f64,
    /// True where the engine is switched off.
    pub engine_off: bool,
    /// Share of a step at rest that an automatic box is in neutral, 0..1 (SE-3).
    pub neutral_share: R,
    /// Rotating energy of the engine before the step, J: less than that of its speed where it lags (SI-2, SI-5).
    pub kinetic_j: R,
}

#[physics]
impl<P: PrimeMover<R>, R: Real> StepInput<'_, P, R> {
    /// Engine speeds within reach of the one before the step, for an engine that passes on at least `load_nm`.
    pub(super) fn reach(&self, from_rad_s: R, load_nm: R) -> Reach<R> {
        Reach {
            from_rad_s,
            slowest_rad_s: self.engine.slowed_rad_s(from_rad_s, load_nm, self.dt_s),
            fastest_rad_s: from_rad_s + self.engine.max_accel_rad_s2() * self.dt_s,
        }
    }
}

/// State of a driveline after the step before.
#[derive(Clone, Copy, Debug)]
pub struct DrivelineState<R: Real = f64> {
    /// Manual box: gear engaged.
    pub gear: R::PerLane<u8>,
    /// Engine speed at the end of the step, rad/s.
    pub engine_rad_s: R,
    /// Throttle, as a start for the solve.
    pub throttle: R,
    /// Secondary pressure, Pa.
    pub secondary_pa: R,
    /// True where the coupling has locked.
    pub coupled: R::Mask,
    /// Speed by which the engine is faster over a lock-up clutch that closes, at the end of the step, rad/s (TC-9).
    pub closing_rad_s: R,
    /// Manual box: time in which it has been in a gear below that of the shift speeds, s; else 0 (MB-5).
    pub lowered_s: R,
    /// True where the car stood still.
    pub stood: bool,
    /// Time that it has, s, with the engine running; kept by a CVT.
    pub rested_s: f64,
}

/// Output of a driveline for a step, powers in W.
#[derive(Clone, Copy, Debug)]
pub struct StepOutput<R: Real = f64> {
    /// Engine speed, rad/s.
    pub engine_rad_s: R,
    /// Engine speed at the end of the step, rad/s.
    pub end_rad_s: R,
    /// Torque at the flywheel into the transmission, without inertia, Nm.
    pub shaft_nm: R,
    /// Throttle 0..1.
    pub throttle: R,
    /// Gear of a manual box, 0 otherwise.
    pub gear: R::PerLane<u8>,
    /// Belt ratio; NaN for a manual box.
    pub belt_ratio: R,
    /// Speed of the secondary over that into the final drive; NaN for a manual box.
    pub range_ratio: R,
    /// Primary pressure, Pa; NaN for a manual box.
    pub primary_pa: R,
    /// Secondary pressure, Pa; NaN for a manual box.
    pub secondary_pa: R,
    /// Cause of the secondary pressure; without meaning for a manual box.
    pub clamp_cause: R::PerLane<ClampCause>,
    /// Belt slip; NaN for a manual box.
    pub slip: R,
    /// Torque that the primary pulley takes from its shaft, Nm; NaN without a belt that turns.
    pub primary_nm: R,
    /// Torque that the secondary pulley gives to its shaft, Nm; NaN without a belt that turns.
    pub secondary_nm: R,
    /// Capacity over torque; NaN for a manual box.
    pub clamp_safety: R,
    /// Loss power of each component, W.
    pub loss_w: ByComponent<R>,
    /// Loss of the alternator for an electric pump, W.
    pub alternator_w: R,
    /// Power that the driveline gives to the wheels (negative: takes from them).
    pub output_w: R,
    /// Power into the brakes.
    pub brake_w: R,
    /// Demanded power that could not be given.
    pub deficit_w: R,
    /// Oil flow of the pump, m3/s.
    pub oil_flow_m3_s: R,
    /// Residual of the solve, a fraction.
    pub residual: R,
    /// Evaluations of the solve.
    pub iterations: R::PerLane<u16>,
    /// Flags.
    pub flags: R::PerLane<Flags>,
}

#[physics]
impl StepOutput {
    /// Nothing turns.
    pub fn at_rest() -> Self {
        StepOutput::like(0.0)
    }
}

#[physics]
impl<R: Real> StepOutput<R> {
    /// Nothing turns in any of the runs of a number.
    pub fn like(number: R) -> Self {
        let (zero, none) = (number.splat(0.0), number.splat(f64::NAN));
        StepOutput {
            engine_rad_s: zero,
            end_rad_s: zero,
            shaft_nm: zero,
            throttle: zero,
            gear: R::per_lane(|_| 0),
            belt_ratio: none,
            range_ratio: none,
            primary_pa: none,
            secondary_pa: none,
            clamp_cause: R::per_lane(|_| ClampCause::Law),
            slip: none,
            primary_nm: none,
            secondary_nm: none,
            clamp_safety: none,
            loss_w: ByComponent([zero; Component::COUNT]),
            alternator_w: zero,
            output_w: zero,
            brake_w: zero,
            deficit_w: zero,
            oil_flow_m3_s: zero,
            residual: zero,
            iterations: R::per_lane(|_| 0),
            flags: R::per_lane(|_| Flags::default()),
        }
    }

    /// Splits the difference between the power given and the power demanded into brake and deficit.
    pub(super) fn split_brake_and_shortfall(&mut self, wheel: &WheelDemand<R>, output_w: R) {
        self.split_of(output_w.splat_mask(true), wheel, output_w);
    }

    /// The same for the runs of a mask.
    pub(super) fn split_of(&mut self, runs: R::Mask, wheel: &WheelDemand<R>, output_w: R) {
        let over = output_w - wheel.power_w;
        let brakes = over.ge(0.0);
        self.output_w = runs.select(output_w, self.output_w);
        self.brake_w = (runs & brakes).select(over, self.brake_w);
        self.deficit_w = (runs & !brakes).select(-over, self.deficit_w);
    }

    /// Adds a loss power.
    pub(super) fn add_loss(&mut self, component: Component, watts: R) {
        self.loss_w[component] = self.loss_w[component] + watts;
    }

    /// Sets a flag where the mask says so.
    pub fn flag(&mut self, flag: Flags, on: R::Mask) {
        set_flag::<R>(&mut self.flags, flag, on);
    }

    /// Where a flag is set.
    pub fn has(&self, flag: Flags) -> R::Mask {
        let has = |run| R::get(&self.flags, run).contains(flag);
        self.engine_rad_s.mask_lanes(has)
    }

    /// Takes over what another output has for the runs of a mask.
    pub(super) fn take(&mut self, runs: R::Mask, other: &StepOutput<R>) {
        macro_rules! numbers {
            ($($field:ident),*) => {
                $(self.$field = runs.select(other.$field, self.$field);)*
            };
        }
        numbers!(
            engine_rad_s,
            end_rad_s,
            shaft_nm,
            throttle,
            belt_ratio,
            primary_pa,
            secondary_pa,
            slip
        );
        numbers!(
            primary_nm,
            secondary_nm,
            clamp_safety,
            alternator_w,
            output_w,
            brake_w
        );
        numbers!(deficit_w, oil_flow_m3_s, residual);
        for (own, other) in self.loss_w.iter_mut().zip(&other.loss_w) {
            *own = runs.select(*other, *own);
        }
        for run in 0..R::LANES {
            if runs.lane(run) {
                *R::get_mut(&mut self.gear, run) = *R::get(&other.gear, run);
                *R::get_mut(&mut self.clamp_cause, run) = *R::get(&other.clamp_cause, run);
                *R::get_mut(&mut self.iterations, run) = *R::get(&other.iterations, run);
                *R::get_mut(&mut self.flags, run) = *R::get(&other.flags, run);
            }
        }
    }
}

/// Sets a flag of the runs where the mask says so.
#[physics]
pub(crate) fn set_flag<R: Real>(flags: &mut R::PerLane<Flags>, flag: Flags, on: R::Mask) {
    if R::LANES == 1 {
        R::get_mut(flags, 0).set(flag, on.any());
    } else if on.any() {
        for run in 0..R::LANES {
            R::get_mut(flags, run).set(flag, on.lane(run));
        }
    }
}
