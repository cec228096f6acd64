//! One evaluation of the driveline: torques that follow from a guess of the unknowns, and what follows from those torques.
//!
//! An evaluation takes slip in at once: the belt is evaluated at the speed of a guessed slip, which it feels through centrifugal
//! force only, and everything behind it at the speed of the slip that comes out. At the wheels' demand it takes in the engine's speed
//! at once too.

use super::Shifting;
use super::controller::ClampLaw;
use super::driveline::{Clamp, Driveline, PartTorques, ShiftNeed};
use super::variator::BeltLoad;
use crate::math::{Mask, Real, physics};
use crate::prime_mover::PrimeMover;
use crate::transmission::coupling::{Coupling, CouplingLoad, EngineSide, Hold, Reach, Turning};
use crate::transmission::gear_train::TurningTrain;
use crate::transmission::step::StepInput;

/// The solve stops when slip and, relatively, pressure and engine speed move less than this.
pub(super) const TOLERANCE: f64 = 1e-7;
/// Largest number of evaluations of a run.
pub(super) const MAX_EVALUATIONS: u16 = 120;

/// Everything of a step that does not change during the solve.
pub(super) struct Step<'a, P, R: Real = f64> {
    pub line: Driveline<'a, R>,
    pub input: &'a StepInput<'a, P, R>,
    pub secondary_rad_s: R,
    /// The final drive at the speed and the demand of the wheels.
    pub drive: TurningTrain<R>,
    pub load: BeltLoad<R>,
    pub shift_flow_m3_s: R,
    /// True where the clamp is fed before the shift (PU-7), false for an imposed ratio.
    pub clamp_first: bool,
    /// True while the largest flow that there is for the shift is searched (RC-5).
    pub searched: bool,
    /// True where pump flow held the shift back.
    pub shift_held: R::Mask,
    /// State of the ratio control.
    pub shifting: Shifting<R>,
    /// Engine speeds within reach.
    pub reach: Reach<R>,
    /// Clamp law in force.
    pub clamp: &'a ClampLaw<R>,
    /// Secondary pressure before the step, Pa.
    pub pressure_before_pa: R,
    /// How the coupling holds engine and primary together.
    pub hold: Hold<R>,
    /// Speed of the primary at the end of the step, rad/s.
    pub end_rad_s: R,
    /// True where a launch clutch that slips locks within the step.
    pub locks: R::Mask,
}

/// Unknowns of the solve.
#[derive(Clone, Copy)]
pub(super) struct Guess<R: Real = f64> {
    pub output_nm: R,
    pub slip: R,
    pub engine_rad_s: R,
    pub pressure_pa: R,
}

#[physics]
impl<R: Real> Guess<R> {
    /// The middle between two guesses.
    pub(super) fn halfway(&self, other: &Self) -> Self {
        Guess {
            output_nm: 0.5 * (self.output_nm + other.output_nm),
            slip: 0.5 * (self.slip + other.slip),
            engine_rad_s: 0.5 * (self.engine_rad_s + other.engine_rad_s),
            pressure_pa: 0.5 * (self.pressure_pa + other.pressure_pa),
        }
    }

    /// `yes` where the mask says so, else `no`.
    pub(super) fn select(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        Guess {
            output_nm: mask.select(yes.output_nm, no.output_nm),
            slip: mask.select(yes.slip, no.slip),
            engine_rad_s: mask.select(yes.engine_rad_s, no.engine_rad_s),
            pressure_pa: mask.select(yes.pressure_pa, no.pressure_pa),
        }
    }

    /// All zero; `like` has the lanes.
    pub(super) fn none(like: R) -> Self {
        let none = like.splat(0.0);
        Guess {
            output_nm: none,
            slip: none,
            engine_rad_s: none,
            pressure_pa: none,
        }
    }
}

/// One evaluation: torques that follow from a guess, and what engine speed and pressure follow from them.
pub(super) struct Point<R: Real = f64> {
    /// The guess with slip and engine speed in force.
    pub guess: Guess<R>,
    /// Slip for which the belt was evaluated.
    pub slip_guessed: R,
    pub next_engine_rad_s: R,
    pub next_pressure_pa: R,
    /// Number of the cause that decided the pressure.
    pub clamp_cause: R,
    pub throttle: R,
    /// Full load at the next engine speed, Nm.
    pub full_load_nm: R,
    pub torques: PartTorques<R>,
    pub secondary_rad_s: R,
    pub primary_rad_s: R,
    pub primary_nm: R,
    /// Torque that the coupling passes on, at the primary, Nm.
    pub passed_nm: R,
    /// Speed of the primary with the coupling locked, rad/s.
    pub over_rad_s: R,
    /// Torque of all losses between coupling and flywheel, Nm at the flywheel.
    pub spin_nm: R,
    /// Torque that is passed on above the one that the engine's limit gives, Nm.
    pub miss_nm: R,
    pub flywheel_nm: R,
    /// Loss of the coupling, W.
    pub coupling_w: R,
    pub flow_limited: R::Mask,
    /// Flow that the clamp leaves for the shift, m3/s (PU-7).
    pub left_m3_s: R,
    pub inside_maps: R::Mask,
    /// True where the coupling holds engine and primary together (LC-5).
    pub locked: R::Mask,
}

#[physics]
impl<R: Real> Point<R> {
    /// Before the first evaluation; `like` has the lanes.
    pub(super) fn none(like: R) -> Self {
        let (none, no) = (like.splat(0.0), like.splat_mask(false));
        Point {
            guess: Guess::none(like),
            slip_guessed: none,
            next_engine_rad_s: none,
            next_pressure_pa: none,
            clamp_cause: none,
            throttle: none,
            full_load_nm: none,
            torques: PartTorques::none(like),
            secondary_rad_s: none,
            primary_rad_s: none,
            primary_nm: none,
            passed_nm: none,
            over_rad_s: none,
            spin_nm: none,
            miss_nm: none,
            flywheel_nm: none,
            coupling_w: none,
            flow_limited: no,
            left_m3_s: none,
            inside_maps: no,
            locked: no,
        }
    }

    /// Largest change of the unknowns by the evaluation.
    pub(super) fn moved(&self) -> R {
        let g = &self.guess;
        let pressure = (g.pressure_pa / self.next_pressure_pa - 1.0).abs();
        let slip = (g.slip - self.slip_guessed).abs();
        let mut engine = slip.splat(0.0);
        if !self.locked.all() {
            let moved = (g.engine_rad_s / self.next_engine_rad_s - 1.0).abs();
            engine = self.locked.select(engine, moved);
        }
        engine.max(slip.max(pressure))
    }

    /// The guess that follows without a secant.
    pub(super) fn next(&self) -> Guess<R> {
        Guess {
            engine_rad_s: self.next_engine_rad_s,
            pressure_pa: self.next_pressure_pa,
            ..self.guess
        }
    }
}

/// The box between the wheels and the engine at a guess, the parts that turn with the engine's shaft apart.
pub(super) struct Chain<R: Real = f64> {
    /// The belt's load, its torque apart.
    pub load: BeltLoad<R>,
    /// Slip in force.
    pub slip: R,
    pub secondary_rad_s: R,
    pub primary_rad_s: R,
    pub primary_nm: R,
    /// Torque that the coupling passes on, at the primary, Nm.
    pub passed_nm: R,
    /// Speed of the primary with the coupling locked, rad/s.
    pub over_rad_s: R,
    /// Torque of the losses between the coupling and the engine's shaft, Nm at the engine.
    pub between_nm: R,
    /// The engine's side of the coupling.
    pub side: EngineSide<R>,
    pub locked: R::Mask,
}

/// The limit of the engine that fixes the output torque: none where neither is true, and the wheels get what they demand.
#[derive(Clone, Copy)]
pub(super) struct Limit<M> {
    /// The least primary torque (CV-3).
    pub engine_drag: M,
    /// Full load (CV-4).
    pub full_load: M,
}

#[physics]
impl<M: Mask> Limit<M> {
    /// No limit; `no` in every lane.
    pub(super) fn none(no: M) -> Self {
        Limit {
            engine_drag: no,
            full_load: no,
        }
    }

    /// Where there is a limit.
    pub(super) fn binds(&self) -> M {
        self.engine_drag | self.full_load
    }

    /// `yes` where the mask says so, else `no`.
    pub(super) fn select(mask: M, yes: &Self, no: &Self) -> Self {
        Limit {
            engine_drag: mask.select(yes.engine_drag, no.engine_drag),
            full_load: mask.select(yes.full_load, no.full_load),
        }
    }
}

#[physics]
impl<P: PrimeMover<R>, R: Real> Step<'_, P, R> {
    /// The shift as the pump's circuit sees it.
    pub(super) fn shift_need(&self) -> ShiftNeed<R> {
        ShiftNeed {
            flow_m3_s: self.shift_flow_m3_s,
            clamp_first: self.clamp_first,
            searched: self.searched,
        }
    }

    /// Primary speed at a slip, rad/s (CV-1).
    pub(super) fn primary_rad_s(&self, slip: R) -> R {
        self.line.at.geometry.ratio * self.secondary_rad_s / (1.0 - slip) // CV-1
    }

    /// Sets the torques of final drive, belt, pulley shafts and reverse clutch at a guess.
    fn turn_box(
        &self,
        g: &Guess<R>,
        primary_rad_s: R,
        clamp: &Clamp<R>,
        load: &BeltLoad<R>,
        inside: &mut R::Mask,
        torques: &mut PartTorques<R>,
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
        torques.belt = line.belt_losses(&BeltLoad {
            output_torque_nm: secondary_nm,
            ..*load
        });
        torques.belt_map = line.belt_map_nm(secondary_nm, primary_rad_s, clamp.pressure_pa, inside);
        let primary_n = torques.belt.holding_n;
        line.turn_primary(torques, primary_rad_s, (clamp, primary_n), inside);
    }

    /// From the wheels to a launch device in front of the variator.
    fn launch_ahead(
        &self,
        g: &Guess<R>,
        limit: &Limit<R::Mask>,
        inside: &mut R::Mask,
        torques: &mut PartTorques<R>,
    ) -> Chain<R> {
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
        self.turn_box(g, belt_rad_s, &clamp, &load, inside, torques);
        let (slip, belt_nm) = torques.belt_in_force();
        let primary_rad_s = self.primary_rad_s(slip);
        let locked = self.locked(primary_rad_s);
        // VA-1 with the slip in force, so that the power balance holds for this iterate exactly.
        let behind_nm = torques.secondary + torques.past_belt; // RG-6
        let primary_nm = behind_nm * ((1.0 - slip) * line.at.geometry.inv_ratio)
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
            between_nm: primary_nm.splat(0.0),
            side: self.engine_side(g, limit, (primary_nm, primary_rad_s), locked),
            locked,
        }
    }

    /// Evaluates a guess, in place: a point is large.
    ///
    /// Under a limit of the engine, pressure and engine speed follow from the torque of that limit, not from the one that the guessed
    /// output torque gives: so the two unknowns do not disturb each other.
    #[inline(never)]
    pub(super) fn evaluate(&self, g: &Guess<R>, limit: &Limit<R::Mask>, point: &mut Point<R>) {
        g.slip.vectorize(|| {
            let mut inside_maps = g.slip.splat_mask(true);
            let chain = if self.line.cvt.launch_behind {
                self.launch_behind(g, limit, &mut inside_maps, &mut point.torques)
            } else {
                self.launch_ahead(g, limit, &mut inside_maps, &mut point.torques)
            };
            self.follow(g, limit, chain, inside_maps, point);
        });
    }

    /// Torque that the coupling passes on under a limit, Nm: that of the chain where there is none.
    fn wanted_nm(
        &self,
        limit: &Limit<R::Mask>,
        passed_nm: R,
        turning: &Turning<R>,
        spin_nm: R,
    ) -> R {
        let mut wanted_nm = passed_nm;
        if limit.engine_drag.any() {
            let least_nm = self.min_passed_nm(turning, spin_nm);
            wanted_nm = limit.engine_drag.select(least_nm, wanted_nm);
        }
        if limit.full_load.any() {
            let most_nm = self.max_passed_nm(turning, spin_nm);
            wanted_nm = limit.full_load.select(most_nm, wanted_nm);
        }
        wanted_nm
    }

    /// Continues from the torques up to the engine, which are in the point: adds those of the engine's shaft, engine speed, throttle and pressure under a limit.
    fn follow(
        &self,
        g: &Guess<R>,
        limit: &Limit<R::Mask>,
        chain: Chain<R>,
        mut inside_maps: R::Mask,
        point: &mut Point<R>,
    ) {
        let (line, cvt, engine) = (&self.line, self.line.cvt, self.input.engine);
        let torques = &mut point.torques;
        let (over_rad_s, own) = (chain.over_rad_s, chain.side);
        let engine_rad_s = own.engine_rad_s;
        let shaft = line.engine_shaft(engine_rad_s);
        let primary_pa = cvt.primary_pa(torques.belt.holding_n);
        line.turn_engine(
            torques,
            &shaft,
            cvt.line_pa(g.pressure_pa, primary_pa),
            self.shift_flow_m3_s,
            &mut inside_maps,
        );
        let spin_nm = torques.engine_nm() + chain.between_nm;
        let turning = self.turning(over_rad_s, engine_rad_s);
        let wanted_nm = self.wanted_nm(limit, chain.passed_nm, &turning, spin_nm);
        let flywheel_nm = own.engine_nm + spin_nm; // CV-2, CV-6
        let (mut wanted_flywheel_nm, mut next_engine_rad_s) = (flywheel_nm, engine_rad_s);
        let mut next_pump = shaft.pump;
        let bound = limit.binds();
        if bound.any() {
            let speeds = (over_rad_s, engine_rad_s);
            let (nm, rad_s) = self.under_limit(wanted_nm, speeds, chain.locked, spin_nm);
            wanted_flywheel_nm = bound.select(nm, wanted_flywheel_nm);
            next_engine_rad_s = bound.select(rad_s, next_engine_rad_s);
            next_pump = line.turning_pump(next_engine_rad_s);
        }
        let crank_nm = wanted_flywheel_nm + engine.accessories_nm(next_engine_rad_s);
        let full_load_nm = engine.full_load_nm(next_engine_rad_s);
        let throttle = (crank_nm / full_load_nm).clamp(0.0, 1.0);
        let signals = line.signals(throttle, next_engine_rad_s);
        let secondary_nm = torques.secondary;
        let (set_pa, clamp_cause) = cvt.pressure_by(
            self.clamp,
            &signals,
            line.at,
            || BeltLoad {
                output_torque_nm: secondary_nm,
                ..chain.load
            },
            chain.secondary_rad_s,
        );
        let shift = self.shift_need();
        let line_above_pa = cvt.line_above_pa(g.pressure_pa, primary_pa);
        let circuit = line.circuit(set_pa, line_above_pa, &next_pump, shift);
        point.guess = Guess {
            engine_rad_s,
            slip: chain.slip,
            ..*g
        };
        point.slip_guessed = g.slip;
        point.next_engine_rad_s = next_engine_rad_s;
        point.next_pressure_pa = circuit.pressure_pa;
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
        point.flow_limited = circuit.limited;
        point.left_m3_s = circuit.left_m3_s;
        point.inside_maps = inside_maps;
        point.locked = chain.locked;
    }

    /// Torque at the flywheel, Nm, and engine speed, rad/s, where a limit has the coupling pass on a torque at the speeds of its two sides.
    fn under_limit(
        &self,
        passed_nm: R,
        (over_rad_s, engine_rad_s): (R, R),
        locked: R::Mask,
        spin_nm: R,
    ) -> (R, R) {
        let coupling = &self.line.cvt.coupling;
        let (mut engine_nm, mut next) = (passed_nm, engine_rad_s);
        if !locked.all() {
            engine_nm = coupling
                .engine_side(passed_nm, over_rad_s, engine_rad_s)
                .engine_nm;
            next = self.free_engine(passed_nm, over_rad_s).engine_rad_s;
        }
        if locked.any() {
            let slip_rad_s = self.hold.slip_rad_s;
            let side = coupling.locked_side(passed_nm, over_rad_s, slip_rad_s);
            engine_nm = locked.select(side.engine_nm, engine_nm);
            next = locked.select(engine_rad_s, next);
        }
        (engine_nm + spin_nm, next)
    }

    /// The engine's side of the coupling at a guess. A clutch has its engine never slower than the primary, and at the same speed while
    /// locked, so that it cannot give energy back.
    pub(super) fn engine_side(
        &self,
        g: &Guess<R>,
        limit: &Limit<R::Mask>,
        (primary_nm, primary_rad_s): (R, R),
        locked: R::Mask,
    ) -> EngineSide<R> {
        let coupling = &self.line.cvt.coupling;
        let mut side = EngineSide {
            engine_nm: primary_nm,
            engine_rad_s: primary_rad_s,
            loss_w: primary_nm,
        };
        let bound = limit.binds() & !locked;
        if !(bound | locked).all() {
            side = self.free_engine(primary_nm, primary_rad_s); // at once: nothing before it feels the engine's speed
        }
        if bound.any() {
            let engine_rad_s = g.engine_rad_s.max(coupling.min_engine_rad_s(primary_rad_s));
            let guessed = coupling.engine_side(primary_nm, primary_rad_s, engine_rad_s);
            side = EngineSide::select(bound, &guessed, &side);
        }
        if locked.any() {
            let held = coupling.locked_side(primary_nm, primary_rad_s, self.hold.slip_rad_s);
            side = EngineSide::select(locked, &held, &side);
        }
        side
    }

    /// True where the coupling holds engine and primary together (LC-5).
    pub(super) fn locked(&self, primary_rad_s: R) -> R::Mask {
        primary_rad_s.ge(self.hold.locked_from_rad_s)
    }

    /// Engine over a slipping coupling, within the speeds that its inertia allows.
    fn free_engine(&self, primary_nm: R, primary_rad_s: R) -> EngineSide<R> {
        let load = CouplingLoad {
            output_nm: primary_nm,
            output_rad_s: primary_rad_s,
            idle_rad_s: self.input.engine.idle_rad_s(),
            coupled: self.hold.coupled,
        };
        self.line.cvt.coupling.solve(&load, &self.reach)
    }

    /// The speeds around the coupling.
    pub(super) fn turning(&self, primary_rad_s: R, engine_rad_s: R) -> Turning<R> {
        Turning {
            output_rad_s: primary_rad_s,
            engine_rad_s,
            idle_rad_s: self.input.engine.idle_rad_s(),
            locked: self.locked(primary_rad_s),
        }
    }

    /// Least torque that engine and coupling pass on, Nm at the primary, with all between them taking `spin_nm` (CV-3).
    pub(super) fn min_passed_nm(&self, at: &Turning<R>, spin_nm: R) -> R {
        let (engine, w) = (self.input.engine, at.engine_rad_s);
        let absorbed_nm = engine.drag_nm(w) + engine.accessories_nm(w) + spin_nm;
        self.line.cvt.coupling.min_output_nm(at, absorbed_nm)
    }

    /// Largest torque passed on at full load, Nm at the primary (CV-4).
    pub(super) fn max_passed_nm(&self, at: &Turning<R>, spin_nm: R) -> R {
        let (engine, w) = (self.input.engine, at.engine_rad_s);
        let engine_nm = engine.full_load_nm(w) - engine.accessories_nm(w) - spin_nm;
        if at.locked.all() {
            return engine_nm;
        }
        let coupling = &self.line.cvt.coupling;
        let passed_nm = coupling.output_nm(engine_nm, at.output_rad_s, w);
        at.locked.select(engine_nm, passed_nm)
    }
}
