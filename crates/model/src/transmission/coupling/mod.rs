//! The coupling between engine and box: friction clutch, torque converter.
//!
//! Torques and speeds at the box's side are called output, those at the flywheel engine. A coupling may multiply torque: a box sees
//! the engine's torque only through [`Coupling::engine_side`] and [`Coupling::output_nm`].

mod friction_clutch;
mod launch;
mod partial_loss;
mod torque_converter;

pub use friction_clutch::FrictionClutch;
pub use launch::Launch;
pub use partial_loss::DriverClutch;
pub(super) use partial_loss::PartialLoss;
pub use torque_converter::{LockUp, TorqueConverter};

use self::friction_clutch::FrictionClutchKeys;
use self::torque_converter::TorqueConverterKeys;
use crate::keys::{Choice, Key, Values, spec};
use crate::math::{Mask, Real, physics, ramp};
use std::fmt::Debug;

const CLUTCH: Choice = Choice::new(
    "friction_clutch",
    "friction clutch, wet or dry",
    FrictionClutchKeys::TABLE,
);

const CONVERTER: Choice = Choice::new(
    "torque_converter",
    "hydrodynamic torque converter with lock-up clutch",
    TorqueConverterKeys::TABLE,
);

/// Row of the key `launch` of a CVT.
pub(super) const LAUNCH: spec::Spec = launch(&[CLUTCH, CONVERTER]);

/// Row of the key `launch` of a manual box, whose clutch the driver opens.
pub(super) const MANUAL_LAUNCH: spec::Spec = launch(&[CLUTCH]);

const fn launch(choices: &'static [Choice]) -> spec::Spec {
    spec::or_word("friction_clutch", spec::options(choices))
}

/// The coupling of a box; `creep_nm` is the default of a clutch's creep torque.
pub(super) fn from_values<V: Values>(s: &V, key: &Key<'static>, creep_nm: f64) -> Launch {
    let (kind, own) = s.choose(key);
    match kind {
        "torque_converter" => Launch::Converter(TorqueConverter::from_values(&own)),
        _ => Launch::clutch(FrictionClutch::from_values(&own, creep_nm)),
    }
}

/// The clutch of a manual box.
pub(super) fn drivers_clutch<V: Values>(s: &V, key: &Key<'static>) -> DriverClutch {
    let (_, own) = s.choose(key);
    DriverClutch::new(FrictionClutch::from_values(&own, 0.0))
}

/// Load that the coupling passes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingLoad<R: Real = f64> {
    /// Torque into the box, Nm; negative in overrun.
    pub output_nm: R,
    /// Speed of the box's input shaft, rad/s.
    pub output_rad_s: R,
    /// Idle speed of the engine, rad/s.
    pub idle_rad_s: R,
    /// True where the coupling had locked before the step.
    pub coupled: R::Mask,
}

#[physics]
impl<R: Real> CouplingLoad<R> {
    /// A torque into the box, Nm, at its speed over an engine with an idle speed, rad/s.
    pub fn new(output_nm: R, output_rad_s: R, idle_rad_s: R, coupled: R::Mask) -> Self {
        CouplingLoad {
            output_nm,
            output_rad_s,
            idle_rad_s,
            coupled,
        }
    }
}

/// The engine's side of a coupling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EngineSide<R: Real = f64> {
    /// Torque at the flywheel, Nm.
    pub engine_nm: R,
    /// Engine speed, rad/s.
    pub engine_rad_s: R,
    /// Loss of the coupling, W.
    pub loss_w: R,
}

#[physics]
impl<R: Real> EngineSide<R> {
    /// `yes` where the mask says so, else `no`.
    pub(super) fn select(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        EngineSide {
            engine_nm: mask.select(yes.engine_nm, no.engine_nm),
            engine_rad_s: mask.select(yes.engine_rad_s, no.engine_rad_s),
            loss_w: mask.select(yes.loss_w, no.loss_w),
        }
    }
}

/// Inputs of the command of a coupling that locks by command, before a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LockSignals<R: Real = f64> {
    /// Mean road speed of the step, m/s.
    pub speed_m_s: f64,
    /// Oil in the sump, K.
    pub sump_k: R,
    /// Speed of the box's input shaft, rad/s.
    pub output_rad_s: R,
    /// Idle speed of the engine, rad/s.
    pub idle_rad_s: R,
    /// Speed by which the engine is faster than the box's input shaft at the beginning of the step, rad/s: where the clutch is closing what was left of
    /// it, else as it is.
    pub faster_rad_s: R,
    /// Length of the step, s.
    pub dt_s: f64,
}

/// How a coupling holds engine and box together in a step, decided before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold<R: Real = f64> {
    /// True where it had locked, or locks by command.
    pub coupled: R::Mask,
    /// Output speed from which it stays locked, rad/s; infinite where it is open.
    pub locked_from_rad_s: R,
    /// Speed by which the engine is faster where it is locked, rad/s.
    pub slip_rad_s: R,
    /// What is left at the end of the step of the speed by which it was faster when the clutch began to close, rad/s (TC-9).
    pub closing_rad_s: R,
    /// Speed by which the engine is faster at the end of the step over its mean; 1 where nothing closes.
    pub left_share: R,
}

/// The speeds around a coupling, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning<R: Real = f64> {
    /// The box's input shaft.
    pub output_rad_s: R,
    /// The engine.
    pub engine_rad_s: R,
    /// The idling engine.
    pub idle_rad_s: R,
    /// True where the coupling is locked.
    pub locked: R::Mask,
}

/// 1 where the engine is no faster than the box, falling to 0 at 2 % more: a slipping coupling whose engine is faster cannot take torque from
/// the box; faded, so that a solve sees no step.
#[physics]
fn together<R: Real>(at: &Turning<R>) -> R {
    let one = at.engine_rad_s.splat(1.0);
    let ahead = at.engine_rad_s.gt(at.output_rad_s);
    if !ahead.any() {
        return one;
    }
    let over = at.engine_rad_s / at.output_rad_s;
    let faded = 1.0 - ramp(over, one, one.splat(1.02));
    ahead.select(faded, one)
}

/// A coupling between engine and box.
pub trait Coupling<R: Real = f64>: Debug + Send + Sync {
    /// Engine speed in steady state for a torque into the box, rad/s.
    fn engine_rad_s(&self, load: &CouplingLoad<R>) -> R;

    /// Lowest engine speed over a box that turns at a speed, rad/s. A clutch cannot give energy back: its engine is never slower.
    #[physics]
    fn min_engine_rad_s(&self, output_rad_s: R) -> R {
        output_rad_s
    }

    /// Output speed from which a locked coupling stays locked, rad/s; infinite for one that never locks.
    fn locked_from_rad_s(&self, idle_rad_s: R) -> R;

    /// True for a coupling that locks by command. Any other has locked once engine and box turn together, and the box stays in low until then.
    fn by_command(&self) -> bool {
        false
    }

    /// How it holds engine and box together in a step; `past`: it had locked before.
    #[physics]
    fn hold(&self, now: &LockSignals<R>, past: R::Mask) -> Hold<R> {
        let idle_rad_s = now.idle_rad_s;
        let never = idle_rad_s.splat(f64::INFINITY);
        Hold {
            coupled: past,
            locked_from_rad_s: past.select(self.locked_from_rad_s(idle_rad_s), never),
            slip_rad_s: idle_rad_s.splat(0.0),
            closing_rad_s: idle_rad_s.splat(0.0),
            left_share: idle_rad_s.splat(1.0),
        }
    }

    /// The engine's side where the coupling is locked, with the slip of [`Coupling::hold`].
    #[physics]
    fn locked_side(&self, output_nm: R, output_rad_s: R, _slip_rad_s: R) -> EngineSide<R> {
        self.engine_side(output_nm, output_rad_s, output_rad_s)
    }

    /// The engine's side for a torque into the box at known speeds; `output_nm` over its torque is the torque ratio.
    fn engine_side(&self, output_nm: R, output_rad_s: R, engine_rad_s: R) -> EngineSide<R>;

    /// Torque into the box for a torque of the driving engine, Nm: the inverse of [`Coupling::engine_side`].
    fn output_nm(&self, engine_nm: R, output_rad_s: R, engine_rad_s: R) -> R;

    /// Torque into the box that the idling engine passes on, Nm.
    fn creep_nm(&self, output_rad_s: R, idle_rad_s: R) -> R;

    /// Share of the engine's overrun torque that the coupling carries, 0..1.
    fn overrun_share(&self, output_rad_s: R, idle_rad_s: R) -> R;

    /// Least torque into the box, Nm, with an engine that absorbs `absorbed_nm`: the creep torque below idle speed, the overrun above.
    #[physics]
    fn min_output_nm(&self, at: &Turning<R>, absorbed_nm: R) -> R {
        let creeps = at.output_rad_s.lt(at.idle_rad_s);
        let mut least_nm = absorbed_nm.splat(0.0);
        if creeps.any() {
            least_nm = self.creep_nm(at.output_rad_s, at.idle_rad_s);
        }
        if !creeps.all() {
            let share = self.overrun_share(at.output_rad_s, at.idle_rad_s);
            least_nm = creeps.select(least_nm, -together(at) * share * absorbed_nm);
        }
        least_nm
    }

    /// The same device with an engine that never is faster than it has to be while it slips (LC-7); none where speed and torque are bound to
    /// each other.
    fn at_least_speed(&self) -> Option<Launch<R>> {
        None
    }

    /// Name of the device as in files.
    fn device(&self) -> &'static str {
        CLUTCH.name
    }

    /// Factor on its loss (LC-6); none where it loses what its model says.
    #[physics]
    fn loss_factor(&self) -> Option<R> {
        None
    }

    /// The engine's side for a torque into the box, its speed the one of steady state as far as `reach` has it.
    #[physics]
    fn solve(&self, load: &CouplingLoad<R>, reach: &Reach<R>) -> EngineSide<R> {
        let reached = reach.nearest(self.engine_rad_s(load));
        let least = self.min_engine_rad_s(load.output_rad_s);
        self.engine_side(load.output_nm, load.output_rad_s, reached.max(least))
    }
}

/// Speeds that the inertia of a free engine allows within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach<R: Real = f64> {
    /// Speed before the step, rad/s.
    pub from_rad_s: R,
    /// Speed to which it falls without fuel, rad/s.
    pub slowest_rad_s: R,
    /// Speed to which it can rise, rad/s.
    pub fastest_rad_s: R,
}

#[physics]
impl<R: Real> Reach<R> {
    /// The nearest speed within reach, rad/s.
    pub fn nearest(&self, wanted_rad_s: R) -> R {
        wanted_rad_s.clamp(self.slowest_rad_s, self.fastest_rad_s)
    }

    /// Mean over the step of how much faster over its box the engine is than at its end, for a fall of that as fast as it can, rad/s.
    pub fn mean_excess_rad_s(&self, fall: R) -> R {
        let most = self.from_rad_s - self.slowest_rad_s;
        let falls = fall.gt(0.0) & most.gt(0.0);
        let none = fall.splat(0.0);
        if !falls.any() {
            return none;
        }
        falls.select(0.5 * fall * (fall / most).min(1.0), none) // EN-12
    }
}
