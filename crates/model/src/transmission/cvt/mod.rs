//! The CVT, backward from the wheel: final drive, variator, reverse clutch, launch clutch, pump and input shaft.
//!
//! | label | statement | status |
//! |---|---|---|
//! | CV-1 | w_s = i i_fd w_wheel, w_p = I w_s / (1 - slip); i = 1 without ranges (RG-1) | derived |
//! | CV-2 | T_flywheel = T_p + T_pump(w_e) + T_shaft(w_e), T_p = T_belt + T_drag + T_bearing + T_ring; the belt carries T_s = T_FD + bearing and rings of the secondary | source: thesis 1.1 (layout: pump and shaft turn with the engine) |
//! | CV-3 | T_p >= creep torque below idle speed, >= -share (drag + accessories + pump + shaft) above it; the brakes take the rest | derived: engine can absorb no more; share LC-3 |
//! | CV-4 | T_flywheel + accessories <= full load; the rest is a deficit | derived |
//! | CV-6 | launch clutch: T_engine = T_p, loss T_p (w_e - w_p) for T_p >= 0; in overrun T_engine w_e = T_p w_p, no loss | derived |
//! | CV-5 | unknowns pressure (through throttle), slip, engine speed (and output torque where CV-3 or CV-4 bind) by fixed point with secant, bounded | derived |
//! | CV-7 | T' = f T of a part's torque or its map's, slip s' = f s with its loss and \|s'\| <= 0.8, final drive GT-2 with f T_0 and f k | derived: definition of a loss changed by a factor f of `loss_factor`, for its price; the bound ASSUMED, that of SL-9 at its largest: only gross slip is beyond it |
//!
//! The last iterate is accepted and every torque follows from it, so that the ledger closes whatever residual is left.

pub mod circuit;
mod clamping;
pub mod clutch_drag;
pub mod controller;
pub mod final_drive;
pub mod pulley_bearing;
pub mod pump;
pub mod range_gear;
pub mod seal_ring;
pub mod shaft_drag;
pub mod variator;
pub(crate) mod driveline;
mod evaluate;
pub mod floors;
mod keys;
mod launch_behind;
mod prepare;
mod secant;
pub mod selector;
mod shift_flow;
mod solve;
mod step_output;

pub use driveline::Parts;
pub use keys::CvtKeys;
pub(crate) use secant::Series;
pub use secant::{Slopes, Trend, WarmStart};

use self::circuit::LineCircuit;
use self::clamping::Clamping;
use self::clutch_drag::ClutchDrag;
use self::controller::{ClampLaw, ClampSignals, PressureTable, RatioControl, ShiftPoint};
use self::final_drive::FinalDrive;
use self::floors::Floors;
use self::pulley_bearing::PulleyBearing;
use self::pump::Pump;
use self::range_gear::{InRange, RangeGear};
use self::seal_ring::SealRing;
use self::selector::{Selector, SelectorSignals};
use self::shaft_drag::ShaftDrag;
use self::variator::{Belt, BeltAtRatio, BeltLoad};
use super::clamp_cause::ClampCause;
use super::component::{ByComponent, Component};
use super::coupling::{Coupling, Launch, PartialLoss};
use super::loss_factor::{self, LossFactors, UNCHANGED, product};
use super::step::{DrivelineState, StepInput, StepOutput};
use crate::cycle::{GearCommand, Step, Trace};
use crate::maps::LossMap;
use crate::math::{Gather, Mask, Real, physics};
use crate::prime_mover::PrimeMover;
use crate::road::WheelDemand;
use crate::thermal::{COOLANT, SUMP};
use std::sync::Arc;

/// Kinematic viscosity nu_80 to which the constants of the shafts' drags refer, m2/s.
pub const NU_REFERENCE_M2_S: f64 = 11.0e-6;

/// Logarithm of the reference viscosity.
const LN_NU_REFERENCE: f64 = -11.417_615_285_165_903;

/// The power (nu/nu_80)^m of the shafts' drags (IS-1, CD-1).
pub fn viscosity_power<R: Real>(nu_m2_s: R, exponent: R) -> R {
    (exponent * (nu_m2_s.ln() - LN_NU_REFERENCE)).exp()
}

/// Power in W of a torque in Nm at a speed in rad/s: two numbers of one run, where numbers are otherwise those of several.
fn product_of(torque_nm: f64, speed_rad_s: f64) -> f64 {
    torque_nm * speed_rad_s
}

/// Losses that are not those of the models.
#[derive(Clone, Debug, Gather)]
pub struct LossChanges<R: Real = f64> {
    /// Measured maps in place of models.
    pub maps: ByComponent<Option<R::PerLane<LossMap>>>,
    /// Factors on the losses (CV-7).
    pub factor: ByComponent<R>,
    /// Loss of a box that is a map with the car at rest, Nm, where it is known (MP-3).
    pub at_rest_nm: Option<R>,
}

impl Default for LossChanges {
    fn default() -> Self {
        LossChanges {
            maps: ByComponent::default(),
            factor: UNCHANGED,
            at_rest_nm: None,
        }
    }
}

/// The checked CVT.
#[derive(Clone, Debug, Gather)]
pub struct Cvt<R: Real = f64> {
    /// Final drive.
    pub final_drive: FinalDrive<R>,
    /// Belt and pulleys.
    pub belt: Belt<R>,
    /// Secondary piston area, m2.
    pub secondary_piston_m2: R,
    /// Primary piston area, m2.
    pub primary_piston_m2: R,
    /// Spring force on the secondary, N.
    pub spring_n: R,
    /// Uncompensated share of the centrifugal head times rho (r_o4 - r_i4) pi/4, N s2/rad2.
    pub centrifugal_n_s2: R,
    /// Hydraulic circuit of the cylinders.
    pub circuit: LineCircuit<R>,
    /// Pump.
    pub pump: Pump<R>,
    /// Input shaft.
    pub shaft_drag: ShaftDrag<R>,
    /// Reverse clutch.
    pub clutch_drag: ClutchDrag<R>,
    /// Bearings of the pulley shafts under the belt's pull.
    pub pulley_bearing: PulleyBearing<R>,
    /// Rings that seal the oil feed of a pulley.
    pub seal_ring: SealRing<R>,
    /// Planetary set behind the secondary; `None` in a box with one range.
    pub ranges: Option<Box<RangeGear<R>>>,
    /// Ratio control.
    pub ratio: RatioControl<R>,
    /// Clamp law.
    pub clamp: ClampLaw<R>,
    /// Table of the law that is one (PC-6).
    pub pressure_table: Option<R::PerLane<Arc<PressureTable>>>,
    /// Exponent of the primary radius in the clamp map.
    pub radius_exponent: R,
    /// Causes of a smallest secondary pressure.
    pub floors: Floors<R>,
    /// Largest secondary pressure, Pa.
    pub cap_pa: R,
    /// Primary radius in low, m.
    pub low_radius_m: R,
    /// Launch device.
    pub coupling: Launch<R>,
    /// True where that is a clutch behind the variator, so that belt and pulleys turn with the engine (LO-1).
    #[gather(same)]
    pub launch_behind: bool,
    /// Selector at rest.
    pub selector: Selector<R>,
    /// Engine speed for a power at full load, W to rad/s.
    pub full_load_route: R::Curve,
    /// Losses that are not those of the models, if there are any.
    pub changes: Option<Box<LossChanges<R>>>,
    /// Share of belt loss that heats the belt node.
    pub belt_heat_share: R,
}

/// State of the CVT after the step before.
#[derive(Clone, Debug)]
pub struct CvtState<R: Real = f64> {
    /// Belt at the ratio in force.
    pub belt: BeltAtRatio<R>,
    /// Start of the solve.
    pub warm_start: WarmStart<R>,
    /// State of the ratio control after the step before.
    pub shifting: Shifting<R>,
    /// Imposed values of the next step, if any.
    pub hold: Option<Hold<R>>,
}

impl Copy for CvtState {}

/// Values imposed on a CVT in a step, in place of its controller (RC-12).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold<R: Real = f64> {
    /// Belt ratio of the step, its target if it is paced; the one before at rest.
    pub ratio: R,
    /// Belt ratio at the end of the step, where that is another one (RC-17).
    pub end: Option<R>,
    /// Clamp law; that of the box without one.
    pub clamp: Option<ClampLaw<R>>,
    /// True if the ratio is a target: the box goes there as fast as it can (RC-4, RC-5).
    pub paced: bool,
}

/// State of the ratio control after the step before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shifting<R: Real = f64> {
    /// Direction of the last change of ratio: 1 towards low, -1 towards high, 0 before the first (RC-10).
    pub direction: R::PerLane<i8>,
    /// Share of rated power that gentle driving looks at (RC-9).
    pub share: R,
    /// Belt ratio at the end of the step; that of the belt is the mean over it (RC-17).
    pub ratio: R,
    /// Range at the end of the step, and the one that is wanted (RG-2).
    pub range: InRange<R>,
}

impl<R: Real> CvtState<R> {
    /// A belt at a ratio before its first step.
    pub fn new(belt: BeltAtRatio<R>) -> Self {
        let (like, ratio) = (belt.direction, belt.geometry.ratio);
        CvtState {
            belt,
            warm_start: WarmStart::new(like),
            shifting: Shifting {
                direction: R::per_lane(|_| 0),
                share: like.splat(0.0),
                ratio,
                range: InRange::only(like),
            },
            hold: None,
        }
    }
}

#[physics]
impl<R: Real> Cvt<R> {
    /// Clamping force of the secondary at a pressure, N (VA-3).
    pub fn secondary_clamp_n(&self, pressure_pa: R, secondary_rad_s: R) -> R {
        pressure_pa * self.secondary_piston_m2
            + self.spring_n
            + self.centrifugal_n_s2 * secondary_rad_s * secondary_rad_s
    }

    /// Pressure of the primary for its clamping force, Pa.
    pub fn primary_pa(&self, primary_clamp_n: R) -> R {
        primary_clamp_n / self.primary_piston_m2
    }

    /// Lowest engine speed at which full load gives a power, rad/s (RC-3). The hot line knows it at once; what air and cold friction leave of
    /// that line falls with speed, so three passes from the speed of greatest power settle it.
    pub fn full_load_rad_s<P: PrimeMover<R>>(&self, engine: &P, power_w: R) -> R {
        let zero = power_w.splat(0.0);
        let none = zero.ge(power_w);
        if none.all() {
            return zero.interpolate(&self.full_load_route);
        }
        let mut speed = self.ratio.highest_rad_s;
        for _ in 0..3 {
            let before = speed;
            speed = engine
                .warm_power_w(power_w, before)
                .interpolate(&self.full_load_route); // RC-3
            if (none | speed.bits_eq(before)).all() {
                break; // settled: another pass gives the same
            }
        }
        if none.any() {
            let least = zero.interpolate(&self.full_load_route);
            speed = none.select(least, speed);
        }
        speed
    }

    /// Speed that the shift map has for a share of rated power, rad/s (RC-14); none without one.
    fn mapped_rad_s<P: PrimeMover<R>>(
        &self,
        engine: &P,
        (speed_m_s, secondary_rad_s): (f64, R),
        share: R,
    ) -> Option<R> {
        let maps = self.ratio.shift_map.as_ref()?;
        let power_w = share * engine.rated_w();
        Some(share.map_lanes(|lane| {
            let at = ShiftPoint {
                speed_m_s,
                secondary_rad_s: secondary_rad_s.lane(lane),
                power_w: power_w.lane(lane),
                efficiency: self.ratio.route_efficiency.lane(lane),
            };
            R::get(maps, lane).target_rad_s(&at, |speed| {
                let full_load_nm = engine.full_load_nm(share.splat(speed));
                product_of(full_load_nm.lane(lane), speed)
            })
        }))
    }

    /// Factor (r_low/r_p)^a of the clamp map at a ratio (PC-1).
    #[inline]
    pub fn radius_factor(&self, at: &BeltAtRatio<R>) -> R {
        (self.radius_exponent * (self.low_radius_m / at.geometry.primary_radius_m).ln()).exp()
    }

    /// True where a measured map replaces the model of a component.
    pub fn has_map(&self, component: Component) -> bool {
        self.changes
            .as_ref()
            .is_some_and(|changes| changes.maps[component].is_some())
    }

    /// Engine speeds at both ends of a step in overrun: it holds its own, up to that in the lowest gear.
    pub(super) fn in_overrun_rad_s(
        &self,
        (wheel, [_, last]): (&WheelDemand<R>, [f64; 2]),
        engine_rad_s: R,
    ) -> [R; 2] {
        let lowest_rad_s = self.lowest_ratio() * self.final_drive.ratio * wheel.wheel_rad_s * last;
        [engine_rad_s, engine_rad_s.min(lowest_rad_s)]
    }

    /// Speed of the primary over that into the final drive in the lowest ratio of the box.
    pub fn lowest_ratio(&self) -> R {
        match &self.ranges {
            Some(set) => self.ratio.low * set.low,
            None => self.ratio.low,
        }
    }

    /// Speed of the primary at the beginning of a step, rad/s, at a ratio over a secondary that has a speed once the clutch has locked.
    fn primary_rad_s(&self, ratio: R, secondary_rad_s: R, past: &DrivelineState<R>) -> R {
        let locked = ratio * secondary_rad_s;
        if self.launch_behind {
            past.coupled.select(locked, past.engine_rad_s.max(locked)) // LO-1
        } else {
            locked
        }
    }

    /// Share of a step that the box is in neutral after a rest, s, with an engine that has run since its start for a time, s (SE-1, SE-2); none
    /// where the car moves, which is in drive.
    pub(super) fn neutral_share_after(
        &self,
        rested_s: f64,
        trace: Option<&Trace>,
        step: &Step,
        running_s: f64,
    ) -> R {
        if !step.motion.rests() {
            return self.selector.neutral_after_s.splat(0.0);
        }
        self.selector.neutral_share(&SelectorSignals {
            procedure_s: trace.map_or(0.0, Trace::selector_s),
            running_s,
            rested_s,
            dt_s: step.dt_s,
        })
    }

    /// State at the beginning of a cycle: in low at rest, in the ratio of the variogram when rolling.
    #[inline]
    pub fn start<P: PrimeMover<R>>(
        &self,
        input: &StepInput<P, R>,
    ) -> (CvtState<R>, DrivelineState<R>) {
        let behind = self.final_drive.ratio * input.wheel.wheel_rad_s;
        let zero = behind.splat(0.0);
        let share = input.wheel.power_w / input.engine.rated_w();
        let demand = controller::RatioDemand {
            begins: None,
            secondary_rad_s: behind,
            primary_rad_s: self.ratio.low * behind,
            speed_m_s: input.wheel.speed_m_s,
            power_w: input.wheel.power_w,
            share,
            full_load_rad_s: self.full_load_rad_s(
                input.engine,
                input.wheel.power_w / self.ratio.route_efficiency,
            ),
            mapped_rad_s: self.mapped_rad_s(input.engine, (input.wheel.speed_m_s, behind), share),
            cold_rad_s: (self.ratio.cold).at(input.heat.node_k[COOLANT], input.heat.node_k[SUMP]),
            ratio_before: self.ratio.low,
            flow_down_per_s: zero,
            flow_up_per_s: zero,
            coupled: zero.splat_mask(true),
            locks_at: zero,
            last_direction: R::per_lane(|_| 0),
            free_up_to_rad_s: zero,
            dt_s: input.dt_s,
        };
        let rolls = behind.gt(0.0);
        let mut target = self.ratio.target_rad_s(&demand) / behind;
        let (mut secondary, mut range) = (behind, InRange::only(zero));
        if let Some(set) = &self.ranges {
            range = match rolls.any() {
                true => set.rolling(target),
                false => set.in_low(),
            };
            (secondary, target) = (range.ratio * behind, target / range.ratio); // RG-1
        }
        let in_range = target.clamp(self.ratio.high, self.ratio.low);
        let ratio = rolls.select(in_range, self.ratio.low);
        let idle = input.engine.idle_rad_s();
        let primary = ratio * secondary;
        let mut own = CvtState::new(BeltAtRatio::new(&self.belt, ratio));
        own.shifting.share = share;
        own.shifting.range = range;
        let driveline = DrivelineState {
            gear: R::per_lane(|_| 0),
            engine_rad_s: primary.max(idle),
            throttle: zero.splat(0.1),
            secondary_pa: self.floors.control_pa,
            coupled: primary.gt(idle),
            closing_rad_s: zero,
            lowered_s: zero,
            stood: zero.ge(behind).all(),
            rested_s: 0.0,
        };
        (own, driveline)
    }

    /// Pressure demand of the clamp law, Pa (PC-1 to PC-5), below the cap, and the number of the cause that decided it; `load` is called by
    /// the laws that use the belt.
    fn pressure_by(
        &self,
        law: &ClampLaw<R>,
        signals: &ClampSignals<R>,
        at: &BeltAtRatio<R>,
        load: impl FnOnce() -> BeltLoad<R>,
        secondary_rad_s: R,
    ) -> (R, R) {
        let (wanted, cause) = match law {
            ClampLaw::Map(map) => {
                let by_law = secondary_rad_s.splat(ClampCause::Law.number());
                (map.pressure_pa(signals), by_law)
            }
            law => Clamping {
                cvt: self,
                at,
                load: &load(),
                secondary_rad_s,
                force_log: signals.force_log,
            }
            .pressure_pa(law),
        };
        let (capped, open) = (wanted.gt(self.cap_pa), wanted.gt(self.floors.control_pa));
        let by_control = cause.splat(ClampCause::Control.number());
        let by_cap = cause.splat(ClampCause::Cap.number());
        let held_pa = open.select(wanted, self.floors.control_pa);
        let held_by = open.select(cause, by_control);
        (
            capped.select(self.cap_pa, held_pa),
            capped.select(by_cap, held_by),
        )
    }

    /// Solves one step (CV-1 to CV-5); fills an output at rest.
    pub(super) fn solve<P: PrimeMover<R>>(
        &self,
        input: &StepInput<P, R>,
        own: &mut CvtState<R>,
        past: &mut DrivelineState<R>,
        output: &mut StepOutput<R>,
    ) {
        solve::solve(self, input, own, past, output);
    }
}

#[physics]
impl<R: Real> super::Driveline<R> for Cvt<R> {
    type State = (CvtState<R>, DrivelineState<R>);

    #[inline]
    fn start<P: PrimeMover<R>>(&self, input: &StepInput<P, R>) -> Self::State {
        Cvt::start(self, input)
    }

    fn solve_into<P: PrimeMover<R>>(
        &self,
        input: &StepInput<P, R>,
        (own, past): &mut Self::State,
        output: &mut StepOutput<R>,
    ) {
        self.solve(input, own, past, output);
    }

    fn engine_rad_s((_, past): &Self::State) -> R {
        past.engine_rad_s
    }

    fn is_cvt(&self) -> bool {
        true
    }

    fn overrun_rad_s(
        &self,
        _: Option<&Self::State>,
        wheel: (&WheelDemand<R>, [f64; 2]),
        _: Option<GearCommand>,
        engine_rad_s: R,
    ) -> [R; 2] {
        self.in_overrun_rad_s(wheel, engine_rad_s)
    }

    fn neutral_share(
        &self,
        state: Option<&Self::State>,
        trace: Option<&Trace>,
        step: &Step,
        running_s: f64,
    ) -> R {
        let rested_s = state.map_or(0.0, |(_, past)| past.rested_s);
        self.neutral_share_after(rested_s, trace, step, running_s)
    }

    fn coupling_factor(&self) -> Option<R> {
        self.coupling.loss_factor()
    }
}

impl Cvt {
    /// True if a step searches through a law of the car: several cars side by side would each wait for the searches of all.
    pub fn searches(&self) -> bool {
        let by_slip = matches!(self.clamp, ClampLaw::SlipLimited { .. });
        by_slip || self.ratio.shift_map.is_some()
    }

    /// Factors on the losses of the box (CV-7), the coupling apart.
    pub fn loss_factors(&self) -> LossFactors {
        self.changes
            .as_ref()
            .map_or(UNCHANGED, |changes| changes.factor)
    }

    /// Multiplies each loss by a factor (CV-7, LC-6).
    pub fn scale_losses(&mut self, factors: &LossFactors) {
        let launch = factors[Component::LaunchClutch];
        self.coupling = PartialLoss::scaled(self.coupling.clone(), launch);
        let mut own = product(&self.loss_factors(), factors);
        own[Component::LaunchClutch] = 1.0; // the coupling has it
        if loss_factor::changes(&own) || self.changes.is_some() {
            self.changes.get_or_insert_default().factor = own;
        }
    }

    /// Pressure demand of the clamp law, Pa (PC-1 to PC-5), below the cap, and what decided it; `load` is called by the laws that use the belt.
    #[physics]
    pub fn pressure_pa(
        &self,
        signals: &ClampSignals,
        at: &BeltAtRatio,
        load: impl FnOnce() -> BeltLoad,
        secondary_rad_s: f64,
    ) -> (f64, ClampCause) {
        let (pressure_pa, cause) =
            self.pressure_by(&self.clamp, signals, at, load, secondary_rad_s);
        (pressure_pa, ClampCause::from_number(cause))
    }
}
