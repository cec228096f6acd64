//! A manual box with final drive in one case: mesh, bearings, churning, seals, and its clutch.
//!
//! | label | statement | status |
//! |---|---|---|
//! | MB-1 | torque at the input shaft for one at the wheels: GT-2, shaft 0 the input, 1 the output, 2 the differential; stage 1 is the gear engaged | derived; geometry ASSUMED |
//! | MB-2 | seals: LS-1 | source: ISO/TR 14179-2; sizes ASSUMED |
//! | MB-3 | bearings: BR-1 to BR-3 of all shafts | source: Palmgren, SKF; sizes ASSUMED, factors fitted to the published losses and thesis 5.5.1 |
//! | MB-4 | churning: CH-1 of the packet of wheels on the output shaft and of the differential's wheel | source: form of Changenet and Velex; factor fitted to the published losses |
//! | MB-5 | gears: the cycle's, on a WLTC GS-1 to GS-6, else shift speeds with hysteresis; a lower gear where the one in force lacks torque and the engine may turn as fast at both ends of the step, kept for 1 s while power is asked for, and one where the cycle has none and the car would fall behind | prescribed gears source: UN R83, UN GTR 15; 1 s ASSUMED: no driver changes twice in a second; rest derived |
//! | MB-6 | GT-1 and GT-2 with f_bearing (M_0 + M_pre) and the bearings' part of k, f_churning C, f_seal T_seal, f_mesh the teeth's part of k; a map f times | derived: definition of losses changed by the factors f of `loss_factor`, for their price |
//!
//! At 80 degC the mean of gears 3 to 5 without load follows the published 0.925 Nm + 0.000407 Nm/rpm within 25 % from 1000 to 4000 rpm, and
//! flatter. In neutral the engine turns the input shaft and a share of the losses in top gear; declutched, the wheels turn the box.
//! A gear change is driven in the gear that follows it; where the driver's shift speeds decide, the trace has a row there. After a change up the clutch slips until the engine has come down to the box (EN-12).

mod engaged;
mod gears;
mod keys;
mod step;

pub use engaged::{Engaged, PartLosses};
pub use gears::ShiftSpeeds;
pub use keys::ManualKeys;

use self::step::ManualStep;
use super::Driveline;
use super::component::{ByComponent, Component};
use super::coupling::{Coupling, DriverClutch};
use super::gear_train::GearTrain;
use super::loss_factor::{self, LossFactors, UNCHANGED, product};
use super::step::{DrivelineState, StepInput, StepOutput};
use crate::cycle::{GearCommand, Step, Trace};
use crate::flags::Flags;
use crate::lubricant::VALID_K;
use crate::maps::LossMap;
use crate::math::{Gather, Mask, Real, gather_each, larger, physics};
use crate::prime_mover::PrimeMover;
use crate::road::WheelDemand;
use crate::thermal::SUMP;

/// The checked manual box.
#[derive(Clone, Debug, Gather)]
pub struct Manual<R: Real = f64> {
    /// Overall ratios from first gear, engine speed over wheel speed.
    pub overall: Vec<R>,
    /// Gear and final drive in each gear, from first.
    pub trains: Vec<GearTrain<R>>,
    /// Share of the load-independent losses in top gear that turns in neutral.
    pub neutral_share: R,
    /// Shift speeds where the cycle prescribes no gears.
    pub shifts: R::PerLane<ShiftSpeeds>,
    /// Coupling to the engine.
    pub coupling: DriverClutch<R>,
    /// Measured map of the whole box in place of bearings, churning, seals and mesh.
    pub map: Option<R::PerLane<LossMap>>,
    /// Factors on the losses (MB-6), if there are any.
    pub factor: Option<Box<ByComponent<R>>>,
}

gather_each!(ShiftSpeeds, LossMap);

#[physics]
impl<R: Real> Driveline<R> for Manual<R> {
    type State = DrivelineState<R>;

    fn start<P: PrimeMover<R>>(&self, input: &StepInput<P, R>) -> DrivelineState<R> {
        self.begin(input)
    }

    fn solve_into<P: PrimeMover<R>>(
        &self,
        input: &StepInput<P, R>,
        state: &mut DrivelineState<R>,
        output: &mut StepOutput<R>,
    ) {
        self.solve(input, state, output);
    }

    fn engine_rad_s(state: &DrivelineState<R>) -> R {
        state.engine_rad_s
    }

    fn is_cvt(&self) -> bool {
        false
    }

    fn overrun_rad_s(
        &self,
        state: Option<&DrivelineState<R>>,
        wheel: (&WheelDemand<R>, [f64; 2]),
        gear: Option<GearCommand>,
        _: R,
    ) -> [R; 2] {
        self.in_overrun_rad_s(state, wheel, gear)
    }

    fn neutral_share(
        &self,
        _: Option<&DrivelineState<R>>,
        _: Option<&Trace>,
        _: &Step,
        _: f64,
    ) -> R {
        self.neutral_share.splat(0.0)
    }

    fn coupling_factor(&self) -> Option<R> {
        self.coupling.loss_factor()
    }
}

/// Speed of the input shaft over idle speed below which the driver of a car that slows down opens the clutch (MB-5).
const MIN_OVER_IDLE: f64 = 1.05;
/// Time for which a driver keeps a gear below that of the shift speeds, s (MB-5): rounding is no reason to change before.
const KEPT_S: f64 = 1.0 - 1e-9;

impl Manual {
    /// Factors on the losses of the box (MB-6), the coupling apart.
    pub fn loss_factors(&self) -> LossFactors {
        self.factor.as_deref().copied().unwrap_or(UNCHANGED)
    }

    /// Speeds at which the driver of a car that slows down opens the clutch of a warm engine, m/s (MB-5).
    #[must_use]
    pub fn opens_m_s(&self, idle_rad_s: f64, wheel_radius_m: f64) -> Vec<f64> {
        self.passes_m_s(MIN_OVER_IDLE * idle_rad_s, wheel_radius_m)
    }

    /// Speeds at which the engine of a car that slows down passes a speed, rad/s, in each gear that is in force there, m/s.
    #[must_use]
    pub fn passes_m_s(&self, engine_rad_s: f64, wheel_radius_m: f64) -> Vec<f64> {
        let speed = |overall: &f64| engine_rad_s / overall * wheel_radius_m;
        let own = self.overall.iter().map(speed).enumerate();
        let down = &self.shifts.down_m_s;
        let in_force = |(place, speed): &(usize, f64)| {
            let below = place.checked_sub(1).and_then(|below| down.get(below));
            let above = down.get(*place);
            below.is_none_or(|below| speed > below) && above.is_none_or(|above| speed < above)
        };
        own.filter(in_force).map(|(_, speed)| speed).collect()
    }

    /// Multiplies each loss by a factor (MB-6, LC-6).
    pub fn scale_losses(&mut self, factors: &LossFactors) {
        let launch = factors[Component::LaunchClutch];
        self.coupling.scale(launch);
        let mut own = product(&self.loss_factors(), factors);
        own[Component::LaunchClutch] = 1.0; // the coupling has it
        self.factor = loss_factor::changes(&own).then(|| Box::new(own));
    }
}

/// Action of a driver on the box in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Action {
    /// Drives in a gear.
    Engaged(u8),
    /// Rolls with the clutch open in a gear, 0 the highest.
    Coasting(u8),
    /// At rest in neutral.
    Neutral,
}

impl<R: Real> Manual<R> {
    /// The command of the shift speeds of a run (MB-5).
    fn shifted<P: PrimeMover<R>>(
        &self,
        step: &StepInput<P, R>,
        state: &DrivelineState<R>,
        run: usize,
    ) -> GearCommand {
        let wheel = step.wheel;
        let shifts = R::get(&self.shifts, run);
        let before = *R::get(&state.gear, run);
        let mut gear = shifts.for_speed(wheel.speed_m_s, before, self.overall.len());
        if self.keeps_lower(step, state, run) {
            gear = gear.min(before);
        }
        let overall = self.overall[usize::from(gear) - 1].lane(run);
        let idle_rad_s = step.engine.idle_rad_s().lane(run);
        if wheel.power_w.lane(run) <= 0.0
            && is_below_idle(overall, wheel.wheel_rad_s.lane(run), idle_rad_s)
        {
            GearCommand::Declutched(gear)
        } else {
            GearCommand::InGear(gear)
        }
    }
}

impl<R: Real> Manual<R> {
    /// True where a run keeps the lower gear that it took for its torque (MB-5).
    fn keeps_lower<P: PrimeMover<R>>(
        &self,
        step: &StepInput<P, R>,
        state: &DrivelineState<R>,
        run: usize,
    ) -> bool {
        let lowered_s = state.lowered_s.lane(run);
        let place = usize::from(*R::get(&state.gear, run)).checked_sub(1);
        let Some(place) = place.filter(|_| 0.0 < lowered_s && lowered_s < KEPT_S) else {
            return false;
        };
        let wheel = step.wheel;
        let [first, last] = wheel.ends_over_mean(step.dt_s);
        let fastest_rad_s = larger(first, last) * self.overall[place] * wheel.wheel_rad_s;
        wheel.power_w.lane(run) > 0.0 && fastest_rad_s.lane(run) < step.engine.max_rad_s().lane(run)
    }

    /// Time in which a run has had the gear in force after the step, where that is below the one of the shift speeds, s; else 0 (MB-5).
    fn lowered_s<P: PrimeMover<R>>(
        &self,
        step: &StepInput<P, R>,
        state: &DrivelineState<R>,
        (gear, run): (u8, usize),
    ) -> f64 {
        if step.gear.is_some() || gear == 0 {
            return 0.0;
        }
        let before = *R::get(&state.gear, run);
        let shifts = R::get(&self.shifts, run);
        let by_speed = shifts.for_speed(step.wheel.speed_m_s, before, self.overall.len());
        match gear < by_speed {
            true if gear == before => sum_s(state.lowered_s.lane(run), step.dt_s),
            true => step.dt_s,
            false => 0.0,
        }
    }
}

/// Sum of two times of one run, s: the bounds of a method over lanes hide the sum of plain numbers.
fn sum_s(a: f64, b: f64) -> f64 {
    a + b
}

/// True where a closed clutch would turn the engine near or below its idle speed.
fn is_below_idle(overall: f64, wheel_rad_s: f64, idle_rad_s: f64) -> bool {
    overall * wheel_rad_s < MIN_OVER_IDLE * idle_rad_s
}

#[physics]
impl<R: Real> Manual<R> {
    /// State at the beginning of a cycle.
    pub(super) fn begin<P: PrimeMover<R>>(&self, step: &StepInput<P, R>) -> DrivelineState<R> {
        let wheel = step.wheel;
        let rolls = wheel.wheel_rad_s.gt(0.0);
        let count = self.overall.len();
        let gear = R::per_lane(|run| {
            if rolls.lane(run) {
                R::get(&self.shifts, run).for_speed(wheel.speed_m_s, 1, count)
            } else {
                0
            }
        });
        let input = self.input_rad_s(&gear, wheel.wheel_rad_s);
        let idle = step.engine.idle_rad_s();
        let zero = idle.splat(0.0);
        DrivelineState {
            gear,
            engine_rad_s: input.max(idle),
            throttle: zero,
            secondary_pa: zero,
            coupled: input.gt(idle),
            closing_rad_s: zero,
            lowered_s: zero,
            stood: true,
            rested_s: 0.0,
        }
    }

    /// Speeds of the input shaft at both ends of a step in the gear that the driver chooses by speed, rad/s.
    pub(super) fn in_overrun_rad_s(
        &self,
        state: Option<&DrivelineState<R>>,
        (wheel, [first, last]): (&WheelDemand<R>, [f64; 2]),
        command: Option<GearCommand>,
    ) -> [R; 2] {
        let count = self.overall.len();
        let gear = R::per_lane(|run| match command {
            Some(command) => command.gear().min(count as u8),
            None => {
                let before = state.map_or(1, |state| *R::get(&state.gear, run));
                R::get(&self.shifts, run).for_speed(wheel.speed_m_s, before, count)
            }
        });
        let mean = self.input_rad_s(&gear, wheel.wheel_rad_s);
        [first * mean, last * mean]
    }

    /// Speed of the input shaft in the gear of each run, rad/s; 0 without one.
    fn input_rad_s(&self, gear: &R::PerLane<u8>, wheel_rad_s: R) -> R {
        let first = *R::get(gear, 0);
        if (1..R::LANES).all(|run| *R::get(gear, run) == first) {
            return match usize::from(first).checked_sub(1) {
                Some(place) => self.overall[place] * wheel_rad_s,
                None => wheel_rad_s.splat(0.0),
            };
        }
        let ratio = wheel_rad_s.map_lanes(|run| {
            let place = usize::from(*R::get(gear, run)).checked_sub(1);
            place.map_or(0.0, |place| self.overall[place].lane(run))
        });
        ratio * wheel_rad_s
    }

    /// Action of the driver of a run: the command of the cycle, else that of the shift speeds (MB-5).
    fn action<P: PrimeMover<R>>(
        &self,
        step: &StepInput<P, R>,
        state: &DrivelineState<R>,
        rolls: bool,
        run: usize,
    ) -> Action {
        let count = self.overall.len() as u8;
        let before = *R::get(&state.gear, run);
        let command = match step.gear {
            Some(GearCommand::Change(gear)) => GearCommand::InGear(gear),
            Some(GearCommand::InGear(gear)) => GearCommand::InGear(gear.min(count)),
            Some(GearCommand::Declutched(gear)) => GearCommand::Declutched(gear.min(count)),
            Some(GearCommand::Neutral) => GearCommand::Neutral,
            None if !rolls => GearCommand::Neutral,
            None => self.shifted(step, state, run),
        };
        match command {
            GearCommand::InGear(gear) | GearCommand::Change(gear) if rolls && gear > 0 => {
                Action::Engaged(gear)
            }
            GearCommand::Neutral if !rolls => Action::Neutral,
            GearCommand::Declutched(gear)
            | GearCommand::InGear(gear)
            | GearCommand::Change(gear) => Action::Coasting(gear),
            GearCommand::Neutral => Action::Coasting(before),
        }
    }

    /// Where the cycle has no gear in force, and one was needed to drive the car faster.
    fn is_wrong_gear<P: PrimeMover<R>>(step: &StepInput<P, R>, output: &StepOutput<R>) -> R::Mask {
        let no_gear = matches!(
            step.gear,
            Some(GearCommand::Neutral | GearCommand::Declutched(_))
        );
        if no_gear && step.wheel.accel_m_s2 > 0.0 {
            !output.has(Flags::CLUTCH_OPEN) & step.wheel.power_w.gt(0.0)
        } else {
            output.engine_rad_s.splat_mask(false)
        }
    }

    /// Solves one step; fills an output at rest.
    pub(super) fn solve<P: PrimeMover<R>>(
        &self,
        step: &StepInput<P, R>,
        state: &mut DrivelineState<R>,
        output: &mut StepOutput<R>,
    ) {
        let yes = step.wheel.wheel_rad_s.splat_mask(true);
        if step.engine_off {
            state.engine_rad_s = step.engine.idle_rad_s(); // the starter brings it back there
            state.stood = true;
            state.coupled = !yes;
            output.flag(Flags::ENGINE_OFF, yes);
            return;
        }
        let sump_k = step.heat.node_k[SUMP];
        let at = ManualStep {
            manual: self,
            step,
            state,
            oil: step.oil.state(sump_k),
        };
        // The road speed is that of all runs.
        let rolls = step.wheel.wheel_rad_s.gt(0.0).any();
        let actions = R::per_lane(|run| self.action(step, at.state, rolls, run));
        at.act(&actions, output);
        output.flag(
            Flags::OVERSPEED,
            output.engine_rad_s.gt(step.engine.max_rad_s()),
        );
        output.flag(Flags::WRONG_GEAR, Self::is_wrong_gear(step, output));
        let (coldest_k, hottest_k) = (*VALID_K.start(), *VALID_K.end());
        let valid = sump_k.ge(coldest_k) & sump_k.le(hottest_k);
        output.flag(Flags::OUTSIDE_VALIDITY, !valid);
        self.keep(step, state, output);
    }

    /// Keeps of a step what the next one needs.
    fn keep<P: PrimeMover<R>>(
        &self,
        step: &StepInput<P, R>,
        state: &mut DrivelineState<R>,
        output: &StepOutput<R>,
    ) {
        if step.gear.is_none() {
            let gear = |run: usize| *R::get(&output.gear, run);
            let like = state.engine_rad_s;
            state.lowered_s = like.map_lanes(|run| self.lowered_s(step, state, (gear(run), run)));
        }
        for run in 0..R::LANES {
            let gear = *R::get(&output.gear, run);
            let kept = R::get_mut(&mut state.gear, run);
            *kept = if gear > 0 { gear } else { *kept };
        }
        state.engine_rad_s = output.end_rad_s;
        let in_gear = output
            .residual
            .mask_lanes(|run| *R::get(&output.gear, run) > 0);
        let turning = in_gear & !output.has(Flags::CLUTCH_OPEN);
        // A clutch that was locked and slips after a change up only has the engine come down: it is no launch (LC-5), unless the box is slower
        // than the idling engine, where LC-5 lets both slip alike.
        let input_rad_s = self.input_rad_s(&output.gear, step.wheel.wheel_rad_s);
        let locks = input_rad_s.ge(step.engine.idle_rad_s());
        let slips = output.has(Flags::CLUTCH_SLIPPING);
        state.coupled = turning & (!slips | (state.coupled & locks));
        state.stood = step.wheel.wheel_rad_s.le(0.0).any(); // the road speed is that of all runs
    }
}
