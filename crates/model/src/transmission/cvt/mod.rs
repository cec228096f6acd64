//! The CVT, backward from the wheel: final drive, variator, reverse clutch, launch clutch, pump and input shaft.
//!
//! | label | statement | status |
//! |---|---|---|
//! | CV-1 | w_s = i_fd w_wheel, w_p = I w_s / (1 - slip) | derived |
//! | CV-2 | T_flywheel = T_p + T_pump(w_e) + T_shaft(w_e), T_p = T_belt + T_drag + T_bearing + T_ring; the belt carries T_s = T_FD + bearing and rings of the secondary | source: thesis 1.1 (layout: pump and shaft turn with the engine) |
//! | CV-3 | T_p >= creep torque below idle speed, >= -share (drag + accessories + pump + shaft) above it; the brakes take the rest | derived: engine can absorb no more; share LC-3 |
//! | CV-4 | T_flywheel + accessories <= full load; the rest is a deficit | derived |
//! | CV-6 | launch clutch: T_engine = T_p, loss T_p (w_e - w_p) for T_p >= 0; in overrun T_engine w_e = T_p w_p, no loss | derived |
//! | CV-5 | unknowns pressure (through throttle), slip, engine speed (and output torque where CV-3 or CV-4 bind) by fixed point with secant, bounded | derived |
//! | CV-7 | T' = f T of a part's torque or its map's, slip s' = f s with its loss, final drive GT-2 with f T_0 and f k | derived: definition of a loss changed by a factor f of `loss_factor`, for its price |
//!
//! The last iterate is accepted and every torque follows from it, so that the ledger closes whatever residual is left.

mod clamping;
pub mod clutch_drag;
pub mod controller;
pub mod final_drive;
pub mod pulley_bearing;
pub mod pump;
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
mod solve;
mod step_output;

pub use driveline::Parts;
pub use keys::CvtKeys;
pub use secant::{Slopes, Trend, WarmStart};

use self::clamping::Clamping;
use self::clutch_drag::ClutchDrag;
use self::controller::{ClampLaw, ClampSignals, PressureTable, RatioControl, ShiftPoint};
use self::final_drive::FinalDrive;
use self::floors::Floors;
use self::pulley_bearing::PulleyBearing;
use self::pump::Pump;
use self::seal_ring::SealRing;
use self::selector::Selector;
use self::shaft_drag::ShaftDrag;
use self::variator::{Belt, BeltAtRatio, BeltLoad};
use super::clamp_cause::ClampCause;
use super::component::{ByComponent, Component};
use super::coupling::{Coupling, PartialLoss};
use super::loss_factor::{self, LossFactors, UNCHANGED, product};
use super::step::{DrivelineState, StepInput, StepOutput};
use crate::maps::LossMap;
use crate::math::{Curve, exp, larger, ln};
use crate::prime_mover::PrimeMover;
use crate::thermal::{COOLANT, SUMP};
use std::sync::Arc;

/// Kinematic viscosity nu_80 to which the constants of the shafts' drags refer, m2/s.
pub const NU_REFERENCE_M2_S: f64 = 11.0e-6;

/// The power (nu/nu_80)^m of the shafts' drags (IS-1, CD-1).
pub fn viscosity_power(nu_m2_s: f64, exponent: f64) -> f64 {
    exp(exponent * ln(nu_m2_s / NU_REFERENCE_M2_S))
}

/// Losses that are not those of the models.
#[derive(Clone, Debug)]
pub struct LossChanges {
    /// Measured maps in place of models.
    pub maps: ByComponent<Option<LossMap>>,
    /// Factors on the losses (CV-7).
    pub factor: LossFactors,
    /// Loss of a box that is a map with the car at rest, Nm, where it is known (MP-3).
    pub at_rest_nm: Option<f64>,
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
#[derive(Clone, Debug)]
pub struct Cvt {
    /// Final drive.
    pub final_drive: FinalDrive,
    /// Belt and pulleys.
    pub belt: Belt,
    /// Secondary piston area, m2.
    pub secondary_piston_m2: f64,
    /// Primary piston area, m2.
    pub primary_piston_m2: f64,
    /// Spring force on the secondary, N.
    pub spring_n: f64,
    /// Uncompensated share of the centrifugal head times rho (r_o4 - r_i4) pi/4, N s2/rad2.
    pub centrifugal_n_s2: f64,
    /// Pump.
    pub pump: Pump,
    /// Input shaft.
    pub shaft_drag: ShaftDrag,
    /// Reverse clutch.
    pub clutch_drag: ClutchDrag,
    /// Bearings of the pulley shafts under the belt's pull.
    pub pulley_bearing: PulleyBearing,
    /// Rings that seal the oil feed of a pulley.
    pub seal_ring: SealRing,
    /// Ratio control.
    pub ratio: RatioControl,
    /// Clamp law.
    pub clamp: ClampLaw,
    /// Table of the law that is one (PC-6).
    pub pressure_table: Option<Arc<PressureTable>>,
    /// Exponent of the primary radius in the clamp map.
    pub radius_exponent: f64,
    /// Causes of a smallest secondary pressure.
    pub floors: Floors,
    /// Largest secondary pressure, Pa.
    pub cap_pa: f64,
    /// Primary radius in low, m.
    pub low_radius_m: f64,
    /// Launch device.
    pub coupling: Arc<dyn Coupling>,
    /// True where that is a clutch behind the variator, so that belt and pulleys turn with the engine (LO-1).
    pub launch_behind: bool,
    /// Selector at rest.
    pub selector: Selector,
    /// Engine speed for a power at full load, W to rad/s.
    pub full_load_route: Curve,
    /// Losses that are not those of the models, if there are any.
    pub changes: Option<Box<LossChanges>>,
    /// Share of belt loss that heats the belt node.
    pub belt_heat_share: f64,
}

/// What the CVT keeps of the step before.
#[derive(Clone, Copy, Debug)]
pub struct CvtState {
    /// Belt at the ratio in force.
    pub belt: BeltAtRatio,
    /// Start of the solve.
    pub warm_start: WarmStart,
    /// What the ratio control keeps of the step before.
    pub shifting: Shifting,
    /// What the next step is held at, if it is.
    pub hold: Option<Hold>,
}

/// What is imposed on a CVT in a step, in place of its controller (RC-12).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// Belt ratio at the end of the step; the one before at rest.
    pub ratio: f64,
    /// Clamp law; that of the box without one.
    pub clamp: Option<ClampLaw>,
    /// Whether the ratio is only asked for: the box goes there as fast as it can (RC-4, RC-5).
    pub paced: bool,
}

/// What the ratio control keeps of the step before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shifting {
    /// Direction of the last change of ratio: 1 towards low, -1 towards high, 0 before the first (RC-10).
    pub direction: i8,
    /// Share of rated power that gentle driving looks at (RC-9).
    pub share: f64,
}

impl CvtState {
    /// A belt at a ratio before its first step.
    pub fn new(belt: BeltAtRatio) -> Self {
        CvtState {
            belt,
            warm_start: WarmStart::default(),
            shifting: Shifting::default(),
            hold: None,
        }
    }
}

impl Cvt {
    /// Clamping force of the secondary at a pressure, N (VA-3).
    #[inline]
    pub fn secondary_clamp_n(&self, pressure_pa: f64, secondary_rad_s: f64) -> f64 {
        pressure_pa * self.secondary_piston_m2
            + self.spring_n
            + self.centrifugal_n_s2 * secondary_rad_s * secondary_rad_s
    }

    /// Pressure of the primary for a clamping force of the secondary, Pa (TE-1).
    #[inline]
    pub fn primary_pa(&self, secondary_clamp_n: f64, at: &BeltAtRatio) -> f64 {
        secondary_clamp_n * at.thrust_ratio / self.primary_piston_m2
    }

    /// Lowest engine speed at which full load gives a power, rad/s (RC-3). The hot line knows it at once; what air and cold friction leave of
    /// that line falls with speed, so three passes from the speed of greatest power settle it.
    #[inline]
    pub fn full_load_rad_s<P: PrimeMover>(&self, engine: &P, power_w: f64) -> f64 {
        if power_w <= 0.0 {
            return self.full_load_route.at(0.0);
        }
        let mut speed = self.ratio.highest_rad_s;
        for _ in 0..3 {
            let before = speed;
            speed = (self.full_load_route).at(power_w / engine.full_load_share(before)); // RC-3
            if speed.to_bits() == before.to_bits() {
                break; // settled: another pass gives the same
            }
        }
        speed
    }

    /// Speed that the shift map has for a share of rated power, rad/s (RC-14); none without one.
    #[inline]
    fn mapped_rad_s<P: PrimeMover>(&self, input: &StepInput<P>, share: f64) -> Option<f64> {
        let map = self.ratio.shift_map.as_ref()?;
        let engine = input.engine;
        let at = ShiftPoint {
            speed_m_s: input.wheel.speed_m_s,
            secondary_rad_s: self.final_drive.ratio * input.wheel.wheel_rad_s,
            power_w: share * engine.rated_w(),
            efficiency: self.ratio.route_efficiency,
        };
        Some(map.target_rad_s(&at, |speed| engine.full_load_nm(speed) * speed))
    }

    /// Factor (r_low/r_p)^a of the clamp map at a ratio (PC-1).
    pub fn radius_factor(&self, at: &BeltAtRatio) -> f64 {
        exp(self.radius_exponent * ln(self.low_radius_m / at.geometry.primary_radius_m))
    }

    /// True where a measured map replaces the model of a component.
    pub fn has_map(&self, component: Component) -> bool {
        self.changes
            .as_ref()
            .is_some_and(|changes| changes.maps[component].is_some())
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
        self.coupling = PartialLoss::of(Arc::clone(&self.coupling), launch);
        let mut own = product(&self.loss_factors(), factors);
        own[Component::LaunchClutch] = 1.0; // the coupling has it
        if loss_factor::changes(&own) || self.changes.is_some() {
            self.changes.get_or_insert_default().factor = own;
        }
    }

    /// Speed of the primary at the beginning of a step, rad/s, at a ratio over a secondary that has a speed once the clutch has locked.
    #[inline]
    fn primary_rad_s(&self, ratio: f64, secondary_rad_s: f64, past: &DrivelineState) -> f64 {
        let locked = ratio * secondary_rad_s;
        if self.launch_behind && !past.coupled {
            larger(past.engine_rad_s, locked) // LO-1
        } else {
            locked
        }
    }

    /// State at the beginning of a cycle: in low at rest, in the ratio of the variogram when rolling.
    pub fn start<P: PrimeMover>(&self, input: &StepInput<P>) -> (CvtState, DrivelineState) {
        let secondary = self.final_drive.ratio * input.wheel.wheel_rad_s;
        let share = input.wheel.power_w / input.engine.rated_w();
        let demand = controller::RatioDemand {
            secondary_rad_s: secondary,
            primary_rad_s: self.ratio.low * secondary,
            speed_m_s: input.wheel.speed_m_s,
            power_w: input.wheel.power_w,
            share,
            full_load_rad_s: self.full_load_rad_s(
                input.engine,
                input.wheel.power_w / self.ratio.route_efficiency,
            ),
            mapped_rad_s: self.mapped_rad_s(input, share),
            cold_rad_s: (self.ratio.cold).at(input.heat.node_k[COOLANT], input.heat.node_k[SUMP]),
            ratio_before: self.ratio.low,
            flow_down_per_s: 0.0,
            flow_up_per_s: 0.0,
            coupled: true,
            last_direction: 0,
            free_up_to_rad_s: 0.0,
            dt_s: input.dt_s,
        };
        let ratio = if secondary > 0.0 {
            (self.ratio.target_rad_s(&demand) / secondary).clamp(self.ratio.high, self.ratio.low)
        } else {
            self.ratio.low
        };
        let idle = input.engine.idle_rad_s();
        let primary = ratio * secondary;
        let mut own = CvtState::new(BeltAtRatio::new(&self.belt, ratio));
        own.shifting.share = share;
        let driveline = DrivelineState {
            gear: 0,
            engine_rad_s: larger(primary, idle),
            throttle: 0.1,
            secondary_pa: self.floors.control_pa,
            coupled: primary > idle,
            stood: secondary <= 0.0,
            rested_s: 0.0,
        };
        (own, driveline)
    }

    /// Pressure demand of the clamp law, Pa (PC-1 to PC-5), below the cap, and what decided it; `load` is called by the laws that use the belt.
    #[inline(always)]
    pub fn pressure_pa(
        &self,
        signals: &ClampSignals,
        at: &BeltAtRatio,
        load: impl FnOnce() -> BeltLoad,
        secondary_rad_s: f64,
    ) -> (f64, ClampCause) {
        self.pressure_by(&self.clamp, signals, at, load, secondary_rad_s)
    }

    /// The same by any law.
    #[inline(always)]
    fn pressure_by(
        &self,
        law: &ClampLaw,
        signals: &ClampSignals,
        at: &BeltAtRatio,
        load: impl FnOnce() -> BeltLoad,
        secondary_rad_s: f64,
    ) -> (f64, ClampCause) {
        let (wanted, cause) = match law {
            ClampLaw::Map(map) => (map.pressure_pa(signals), ClampCause::Law),
            law => Clamping {
                cvt: self,
                at,
                load: &load(),
                secondary_rad_s,
                force_log: signals.force_log,
            }
            .pressure_pa(law),
        };
        if wanted > self.cap_pa {
            (self.cap_pa, ClampCause::Cap)
        } else if wanted > self.floors.control_pa {
            (wanted, cause)
        } else {
            (self.floors.control_pa, ClampCause::Control)
        }
    }

    /// Solves one step (CV-1 to CV-5); fills an output at rest.
    pub(super) fn solve<P: PrimeMover>(
        &self,
        input: &StepInput<P>,
        own: &mut CvtState,
        past: &mut DrivelineState,
        output: &mut StepOutput,
    ) {
        solve::solve(self, input, own, past, output);
    }
}
