//! One evaluation of the driveline: torques that follow from a guess of the unknowns, and what follows from those torques.
//!
//! An evaluation takes slip in at once: the belt is evaluated at the speed of a guessed slip, which it feels through centrifugal
//! force only, and everything behind it at the speed of the slip that comes out. At the wheels' demand it takes in the engine's speed
//! at once too.

use super::Shifting;
use super::controller::ClampLaw;
use super::driveline::{Clamp, Driveline, PartTorques};
use super::variator::BeltLoad;
use crate::math::{clamp, larger};
use crate::prime_mover::PrimeMover;
use crate::transmission::clamp_cause::ClampCause;
use crate::transmission::coupling::{CouplingLoad, EngineSide, Hold, Reach, Turning};
use crate::transmission::gear_train::TurningTrain;
use crate::transmission::step::StepInput;

/// The solve stops when slip and, relatively, pressure and engine speed move less than this.
pub(super) const TOLERANCE: f64 = 1e-7;
/// Largest number of evaluations of a run.
pub(super) const MAX_EVALUATIONS: u16 = 60;

/// Everything of a step that does not change during the solve.
pub(super) struct Step<'a, P> {
    pub line: Driveline<'a>,
    pub input: &'a StepInput<'a, P>,
    pub secondary_rad_s: f64,
    /// The final drive at the speed and the demand of the wheels.
    pub drive: TurningTrain,
    pub load: BeltLoad,
    pub shift_flow_m3_s: f64,
    /// True where pump flow held the shift back.
    pub shift_held: bool,
    /// What the ratio control keeps.
    pub shifting: Shifting,
    /// Engine speeds within reach.
    pub reach: Reach,
    /// Clamp law in force.
    pub clamp: &'a ClampLaw,
    /// Secondary pressure before the step, Pa.
    pub pressure_before_pa: f64,
    /// How the coupling holds engine and primary together.
    pub hold: Hold,
}

/// Unknowns of the solve.
#[derive(Clone, Copy, Default)]
pub(super) struct Guess {
    pub output_nm: f64,
    pub slip: f64,
    pub engine_rad_s: f64,
    pub pressure_pa: f64,
}

impl Guess {
    /// The middle between two guesses.
    pub(super) fn halfway(&self, other: &Guess) -> Guess {
        let mid = |a: f64, b: f64| 0.5 * (a + b);
        Guess {
            output_nm: mid(self.output_nm, other.output_nm),
            slip: mid(self.slip, other.slip),
            engine_rad_s: mid(self.engine_rad_s, other.engine_rad_s),
            pressure_pa: mid(self.pressure_pa, other.pressure_pa),
        }
    }
}

/// One evaluation: torques that follow from a guess, and what engine speed and pressure follow from them.
#[derive(Default)]
pub(super) struct Point {
    /// The guess with slip and engine speed in force.
    pub guess: Guess,
    /// Slip for which the belt was evaluated.
    pub slip_guessed: f64,
    pub next_engine_rad_s: f64,
    pub next_pressure_pa: f64,
    pub clamp_cause: ClampCause,
    pub throttle: f64,
    /// Full load at the next engine speed, Nm.
    pub full_load_nm: f64,
    pub torques: PartTorques,
    pub secondary_rad_s: f64,
    pub primary_rad_s: f64,
    pub primary_nm: f64,
    /// Torque that the coupling passes on, at the primary, Nm.
    pub passed_nm: f64,
    /// Speed of the primary with the coupling locked, rad/s.
    pub over_rad_s: f64,
    /// Torque of all losses between coupling and flywheel, Nm at the flywheel.
    pub spin_nm: f64,
    /// Torque that is passed on above the one that the engine's limit gives, Nm.
    pub miss_nm: f64,
    pub flywheel_nm: f64,
    /// Loss of the coupling, W.
    pub coupling_w: f64,
    pub flow_limited: bool,
    pub oil_flow_m3_s: f64,
    pub inside_maps: bool,
    /// True where the coupling holds engine and primary together (LC-5).
    pub locked: bool,
}

impl Point {
    /// Largest change of the unknowns by the evaluation.
    #[inline]
    pub(super) fn moved(&self) -> f64 {
        let g = &self.guess;
        let mut most = (g.pressure_pa / self.next_pressure_pa - 1.0).abs();
        let engine = if self.locked {
            0.0
        } else {
            (g.engine_rad_s / self.next_engine_rad_s - 1.0).abs()
        };
        for d in [(g.slip - self.slip_guessed).abs(), engine] {
            most = larger(d, most);
        }
        most
    }

    /// The guess that follows without a secant.
    pub(super) fn next(&self) -> Guess {
        Guess {
            engine_rad_s: self.next_engine_rad_s,
            pressure_pa: self.next_pressure_pa,
            ..self.guess
        }
    }
}

/// The box between the wheels and the engine at a guess, the parts that turn with the engine's shaft apart.
pub(super) struct Chain {
    /// The belt's load, its torque apart.
    pub load: BeltLoad,
    /// Slip in force.
    pub slip: f64,
    pub secondary_rad_s: f64,
    pub primary_rad_s: f64,
    pub primary_nm: f64,
    /// Torque that the coupling passes on, at the primary, Nm.
    pub passed_nm: f64,
    /// Speed of the primary with the coupling locked, rad/s.
    pub over_rad_s: f64,
    /// Torque of the losses between the coupling and the engine's shaft, Nm at the engine.
    pub between_nm: f64,
    /// The engine's side of the coupling.
    pub side: EngineSide,
    pub locked: bool,
}

/// The limit of the engine that fixes the output torque.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Limit {
    /// None: the wheels get what they demand.
    None,
    /// The least primary torque (CV-3).
    EngineDrag,
    /// Full load (CV-4).
    FullLoad,
}

impl<P: PrimeMover> Step<'_, P> {
    /// Primary speed at a slip, rad/s (CV-1).
    #[inline]
    pub(super) fn primary_rad_s(&self, slip: f64) -> f64 {
        self.line.at.geometry.ratio * self.secondary_rad_s / (1.0 - slip) // CV-1
    }

    /// Sets the torques of final drive, belt, pulley shafts and reverse clutch at a guess.
    #[inline(always)]
    fn turn_box(
        &self,
        g: &Guess,
        primary_rad_s: f64,
        clamp: &Clamp,
        load: impl FnOnce(f64) -> BeltLoad,
        inside: &mut bool,
        torques: &mut PartTorques,
    ) {
        let line = &self.line;
        line.secondary(
            g.output_nm,
            || self.drive,
            (primary_rad_s, self.secondary_rad_s),
            clamp,
            inside,
            torques,
        );
        let secondary_nm = torques.secondary;
        torques.belt = line.belt_losses(&load(secondary_nm));
        torques.belt_map = line.belt_map_nm(secondary_nm, primary_rad_s, clamp.pressure_pa, inside);
        line.turn_primary(torques, primary_rad_s, clamp, inside);
    }

    /// From the wheels to a launch device in front of the variator.
    #[inline(always)]
    fn launch_ahead(
        &self,
        g: &Guess,
        limit: Limit,
        inside: &mut bool,
        torques: &mut PartTorques,
    ) -> Chain {
        let (line, cvt) = (&self.line, self.line.cvt);
        let belt_rad_s = self.primary_rad_s(g.slip);
        let clamp = Clamp {
            pressure_pa: g.pressure_pa,
            secondary_n: cvt.secondary_clamp_n(g.pressure_pa, self.secondary_rad_s),
        };
        let load = BeltLoad {
            primary_speed_rad_s: belt_rad_s,
            secondary_clamp_n: clamp.secondary_n,
            ..self.load
        };
        let with = |output_torque_nm: f64| BeltLoad {
            output_torque_nm,
            ..load
        };
        self.turn_box(g, belt_rad_s, &clamp, with, inside, torques);
        let (slip, belt_nm) = torques.belt_in_force();
        let primary_rad_s = self.primary_rad_s(slip);
        let locked = self.locked(primary_rad_s);
        // VA-1 with the slip in force, so that the power balance holds for this iterate exactly.
        let primary_nm = torques.secondary * ((1.0 - slip) * line.at.prepared.inv_ratio)
            + belt_nm
            + torques.primary_nm();
        Chain {
            load,
            slip,
            secondary_rad_s: self.secondary_rad_s,
            primary_rad_s,
            primary_nm,
            passed_nm: primary_nm,
            over_rad_s: primary_rad_s,
            between_nm: 0.0,
            side: self.engine_side(g, limit, (primary_nm, primary_rad_s), locked),
            locked,
        }
    }

    /// Evaluates a guess, in place: a point is large.
    ///
    /// Under a limit of the engine, pressure and engine speed follow from the torque of that limit, not from the one that the guessed
    /// output torque gives: so the two unknowns do not disturb each other.
    pub(super) fn evaluate(&self, g: &Guess, limit: Limit, point: &mut Point) {
        if self.line.cvt.launch_behind {
            return self.evaluate_behind(g, limit, point);
        }
        let mut inside_maps = true;
        let chain = self.launch_ahead(g, limit, &mut inside_maps, &mut point.torques);
        self.follow(g, limit, chain, inside_maps, point);
    }

    /// The same with a clutch behind the variator.
    #[inline(never)]
    fn evaluate_behind(&self, g: &Guess, limit: Limit, point: &mut Point) {
        let mut inside_maps = true;
        let chain = self.launch_behind(g, limit, &mut inside_maps, &mut point.torques);
        self.follow(g, limit, chain, inside_maps, point);
    }

    /// What follows from the torques up to the engine, which are in the point: those of its own shaft, and engine speed, throttle and pressure under a limit.
    #[inline(always)]
    fn follow(
        &self,
        g: &Guess,
        limit: Limit,
        chain: Chain,
        mut inside_maps: bool,
        point: &mut Point,
    ) {
        let (line, cvt, engine) = (&self.line, self.line.cvt, self.input.engine);
        let torques = &mut point.torques;
        let (over_rad_s, own) = (chain.over_rad_s, chain.side);
        let engine_rad_s = own.engine_rad_s;
        let shaft = line.engine_shaft(engine_rad_s);
        let pump = line.turn_engine(
            torques,
            &shaft,
            g.pressure_pa,
            self.shift_flow_m3_s,
            &mut inside_maps,
        );
        let spin_nm = torques.engine_nm() + chain.between_nm;
        let turning = self.turning(over_rad_s, engine_rad_s);
        let wanted_nm = match limit {
            Limit::None => chain.passed_nm,
            Limit::EngineDrag => self.min_passed_nm(&turning, spin_nm),
            Limit::FullLoad => self.max_passed_nm(&turning, spin_nm),
        };
        let flywheel_nm = own.engine_nm + spin_nm; // CV-2, CV-6
        let (wanted_flywheel_nm, next_engine_rad_s, next_pump) = if limit == Limit::None {
            (flywheel_nm, engine_rad_s, shaft.pump)
        } else {
            let speeds = (over_rad_s, engine_rad_s);
            let (nm, rad_s) = self.under_limit(wanted_nm, speeds, chain.locked, spin_nm);
            (nm, rad_s, line.turning_pump(rad_s))
        };
        let crank_nm = wanted_flywheel_nm + engine.accessories_nm(next_engine_rad_s);
        let full_load_nm = engine.full_load_nm(next_engine_rad_s);
        let throttle = clamp(crank_nm / full_load_nm, 0.0, 1.0);
        let signals = line.signals(throttle, next_engine_rad_s);
        let secondary_nm = torques.secondary;
        let load = || BeltLoad {
            output_torque_nm: secondary_nm,
            ..chain.load
        };
        let (set_pa, clamp_cause) =
            cvt.pressure_by(self.clamp, &signals, line.at, load, chain.secondary_rad_s);
        let (next_pressure_pa, flow_limited) =
            line.held_pa(set_pa, &next_pump, self.shift_flow_m3_s);
        point.guess = Guess {
            engine_rad_s,
            slip: chain.slip,
            ..*g
        };
        point.slip_guessed = g.slip;
        point.next_engine_rad_s = next_engine_rad_s;
        point.next_pressure_pa = next_pressure_pa;
        point.clamp_cause = clamp_cause;
        point.throttle = throttle;
        point.full_load_nm = full_load_nm;
        point.secondary_rad_s = chain.secondary_rad_s;
        point.primary_rad_s = chain.primary_rad_s;
        point.primary_nm = chain.primary_nm;
        point.passed_nm = chain.passed_nm;
        point.over_rad_s = over_rad_s;
        point.spin_nm = spin_nm;
        point.miss_nm = chain.passed_nm - wanted_nm;
        point.flywheel_nm = flywheel_nm;
        point.coupling_w = own.loss_w;
        point.flow_limited = flow_limited;
        point.oil_flow_m3_s = pump.working_m3_s;
        point.inside_maps = inside_maps;
        point.locked = chain.locked;
    }

    /// Torque at the flywheel, Nm, and engine speed, rad/s, where a limit has the coupling pass on a torque at the speeds of its two sides.
    #[inline(always)]
    fn under_limit(
        &self,
        passed_nm: f64,
        (over_rad_s, engine_rad_s): (f64, f64),
        locked: bool,
        spin_nm: f64,
    ) -> (f64, f64) {
        let coupling = &self.line.cvt.coupling;
        let (side, next) = if locked {
            let slip_rad_s = self.hold.slip_rad_s;
            let side = coupling.locked_side(passed_nm, over_rad_s, slip_rad_s);
            (side, engine_rad_s)
        } else {
            let side = coupling.engine_side(passed_nm, over_rad_s, engine_rad_s);
            (side, self.free_engine(passed_nm, over_rad_s).engine_rad_s)
        };
        (side.engine_nm + spin_nm, next)
    }

    /// The engine's side of the coupling at a guess. A clutch has its engine never slower than the primary, and at the same speed while
    /// locked, so that it cannot give energy back.
    #[inline(always)]
    pub(super) fn engine_side(
        &self,
        g: &Guess,
        limit: Limit,
        (primary_nm, primary_rad_s): (f64, f64),
        locked: bool,
    ) -> EngineSide {
        let coupling = &self.line.cvt.coupling;
        if locked {
            return coupling.locked_side(primary_nm, primary_rad_s, self.hold.slip_rad_s);
        }
        if limit == Limit::None {
            return self.free_engine(primary_nm, primary_rad_s); // at once: nothing before it feels the engine's speed
        }
        let least = coupling.min_engine_rad_s(primary_rad_s);
        let engine_rad_s = if g.engine_rad_s > least {
            g.engine_rad_s
        } else {
            least
        };
        coupling.engine_side(primary_nm, primary_rad_s, engine_rad_s)
    }

    /// True where the coupling holds engine and primary together (LC-5).
    #[inline]
    pub(super) fn locked(&self, primary_rad_s: f64) -> bool {
        primary_rad_s >= self.hold.locked_from_rad_s
    }

    /// Engine over a slipping coupling, within the speeds that its inertia allows.
    fn free_engine(&self, primary_nm: f64, primary_rad_s: f64) -> EngineSide {
        let load = CouplingLoad {
            output_nm: primary_nm,
            output_rad_s: primary_rad_s,
            idle_rad_s: self.input.engine.idle_rad_s(),
            coupled: self.hold.coupled,
        };
        self.line.cvt.coupling.solve(&load, &self.reach)
    }

    /// The speeds around the coupling.
    pub(super) fn turning(&self, primary_rad_s: f64, engine_rad_s: f64) -> Turning {
        Turning {
            output_rad_s: primary_rad_s,
            engine_rad_s,
            idle_rad_s: self.input.engine.idle_rad_s(),
            locked: self.locked(primary_rad_s),
        }
    }

    /// Least torque that engine and coupling pass on, Nm at the primary, with all between them taking `spin_nm` (CV-3).
    pub(super) fn min_passed_nm(&self, at: &Turning, spin_nm: f64) -> f64 {
        let (engine, w) = (self.input.engine, at.engine_rad_s);
        let absorbed_nm = engine.drag_nm(w) + engine.accessories_nm(w) + spin_nm;
        self.line.cvt.coupling.min_output_nm(at, absorbed_nm)
    }

    /// Largest torque passed on at full load, Nm at the primary (CV-4).
    pub(super) fn max_passed_nm(&self, at: &Turning, spin_nm: f64) -> f64 {
        let (engine, w) = (self.input.engine, at.engine_rad_s);
        let engine_nm = engine.full_load_nm(w) - engine.accessories_nm(w) - spin_nm;
        if at.locked {
            return engine_nm;
        }
        let coupling = &self.line.cvt.coupling;
        coupling.output_nm(engine_nm, at.output_rad_s, w)
    }
}
