//! One implicit solve a step: secondary pressure (through throttle), slip and engine speed, and the output torque where the engine limits it.
//!
//! An evaluation leaves mainly one number open, the pressure; its fixed point is found by a secant with the slope that the step
//! before ended with. Where the engine limits it, a second secant finds the output torque.

use super::controller::ClampLaw;
use super::evaluate::{Guess, Limit, MAX_EVALUATIONS, Point, Step, TOLERANCE};
use super::prepare::prepare;
use super::secant::{Slopes, TorqueSecant};
use super::step_output::{Outcome, finish, standstill};
use super::variator::BeltLoad;
use super::{Cvt, CvtState, WarmStart};
use crate::flags::Flags;
use crate::math::{clamp, larger, smaller};
use crate::prime_mover::PrimeMover;
use crate::transmission::step::{DrivelineState, StepInput, StepOutput};

/// Evaluations after which a run goes on without secants and in half steps: slower, and stable for steeper couplings.
const DAMPED_FROM: u16 = 10;
/// Kick-down ends where the route would reckon with a lower efficiency than this (RC-7).
const MIN_ROUTE_EFFICIENCY: f64 = 0.4;
/// Factor on the efficiency of a failed try for another one: smaller than the route is wrong by, so that the ratio changes (RC-7).
const KICK_DOWN: f64 = 0.995;
/// Share of full load by which a demand must miss what the engine can do before a run leaves it unconverged, ...
const CLEARLY: f64 = 0.02;
/// ... and how far it may still be from its fixed point: so near, no torque moves by as much.
const NEAR: f64 = 0.02;

impl<P: PrimeMover> Step<'_, P> {
    /// The limit that a point at the demanded torque violates; violations within `margin_nm` are ignored.
    fn violated(&self, p: &Point, margin_nm: f64) -> Limit {
        let above_idle = p.over_rad_s >= self.input.engine.idle_rad_s();
        if above_idle && p.passed_nm >= 0.0 && p.throttle < 1.0 {
            return Limit::None; // CV-3 is below zero here, CV-4 above
        }
        let at = self.turning(p.over_rad_s, p.guess.engine_rad_s);
        if p.passed_nm < self.min_passed_nm(&at, p.spin_nm) - margin_nm {
            Limit::EngineDrag
        } else if p.passed_nm > self.max_passed_nm(&at, p.spin_nm) + margin_nm {
            Limit::FullLoad
        } else {
            Limit::None
        }
    }

    /// The route's efficiency for another try, after one with `efficiency` that full load does not give (RC-7).
    fn kick_down(&self, efficiency: f64, p: &Point) -> f64 {
        let w = p.guess.engine_rad_s;
        let asked_w = (p.flywheel_nm + self.input.engine.accessories_nm(w)) * w;
        let had = self.input.wheel.power_w / asked_w;
        larger(KICK_DOWN * smaller(had, efficiency), MIN_ROUTE_EFFICIENCY) // RC-7
    }

    /// Slip and loss torque in Nm that go on as in the steps before.
    fn extrapolated(&self, warm_start: &WarmStart) -> (f64, f64) {
        let (slip, loss_nm) = warm_start.trend.next(self.input.wheel.accel_m_s2);
        (self.possible(slip), loss_nm)
    }

    /// The nearest slip that the belt can have: a line through slips leads anywhere, and at a slip of 1 no speed belongs to it (CV-1).
    fn possible(&self, slip: f64) -> f64 {
        let most = 2.0 * self.line.cvt.belt.slip_bound;
        clamp(slip, -most, most)
    }

    /// Where the solve begins: slip and losses of the step before, at the new ratio and demand.
    fn first_guess(&self, warm_start: &WarmStart) -> Guess {
        let (slip, loss_nm) = self.extrapolated(warm_start);
        let engine_rad_s = self.first_engine_rad_s(slip);
        let output_nm = self.input.wheel.power_w / self.secondary_rad_s;
        let engine = self.input.engine;
        let flywheel = output_nm / self.line.at.geometry.ratio + loss_nm;
        let throttle = clamp(
            (flywheel + engine.accessories_nm(engine_rad_s)) / engine.full_load_nm(engine_rad_s),
            0.0,
            1.0,
        );
        let signals = self.line.signals(throttle, engine_rad_s);
        let load = || BeltLoad {
            output_torque_nm: output_nm,
            ..self.load
        };
        let pressure_pa = match self.clamp {
            ClampLaw::SlipLimited { .. } => self.pressure_before_pa,
            _ => {
                let cvt = self.line.cvt;
                let speed = self.secondary_rad_s;
                cvt.pressure_by(self.clamp, &signals, self.line.at, load, speed)
                    .0
            }
        };
        Guess {
            output_nm,
            slip,
            engine_rad_s,
            pressure_pa,
        }
    }

    fn first_engine_rad_s(&self, slip: f64) -> f64 {
        let primary = self.primary_rad_s(slip);
        if self.locked(primary) || primary > self.reach.from_rad_s {
            primary
        } else {
            self.reach.from_rad_s
        }
    }

    /// Output torque at which the engine's least torque is likely to be the limit: its drag with the losses that are expected, Nm.
    fn likely_overrun_nm(&self, warm_start: &WarmStart) -> f64 {
        let engine = self.input.engine;
        let (slip, loss_nm) = self.extrapolated(warm_start);
        let w = self.first_engine_rad_s(slip);
        let share = self.line.cvt.coupling.overrun_share(w, engine.idle_rad_s());
        -self.line.at.geometry.ratio
            * (share * (engine.drag_nm(w) + engine.accessories_nm(w)) + loss_nm)
    }

    /// Solves with the output torque fixed by `limit`, from a first guess; the result is in `work.point`. A run at the demanded
    /// torque that may leave ends early where the engine clearly cannot.
    fn run(&self, first: &Guess, limit: Limit, may_leave: bool, work: &mut Work) {
        let mut guess = *first;
        let mut last: Option<(Guess, f64)> = None;
        let mut torque = TorqueSecant::new(self.line.at.geometry.ratio, first.output_nm);
        let mut count = 0;
        loop {
            self.evaluate(&guess, limit, &mut work.point);
            let point = &work.point;
            count += 1;
            work.residual = point.moved();
            if let Some((before, before_next_pa)) = &last {
                let open = !point.locked && self.line.cvt.coupling.by_command();
                work.slopes.update((before, *before_next_pa), point, open);
            }
            let scale = larger(point.full_load_nm, 1.0);
            let damped = count > DAMPED_FROM;
            let mut next_nm = guess.output_nm;
            if limit != Limit::None {
                let stopped;
                (next_nm, stopped) = torque.next_nm(point, &mut work.slopes, damped);
                let relative = point.miss_nm.abs() / scale;
                work.residual = if relative > work.residual && !stopped {
                    relative
                } else {
                    work.residual
                };
            }
            let done =
                work.residual <= TOLERANCE || count >= MAX_EVALUATIONS || work.residual.is_nan();
            if done
                || (may_leave
                    && work.residual < NEAR
                    && self.violated(point, CLEARLY * scale) != Limit::None)
            {
                work.count += count;
                return;
            }
            last = Some((point.guess, point.next_pressure_pa));
            let cvt = self.line.cvt;
            let least_pa = smaller(cvt.floors.control_pa, point.next_pressure_pa);
            let pressure_pa = clamp(work.slopes.pressure_pa(point), least_pa, cvt.cap_pa); // CV-5
            let slip = point.guess.slip
                + work.slopes.slip_per_pa * (pressure_pa - point.guess.pressure_pa);
            guess = Guess {
                output_nm: next_nm,
                slip: self.possible(slip), // CV-5
                engine_rad_s: point.next_engine_rad_s,
                pressure_pa,
            };
            if damped {
                guess = guess.halfway(&Guess {
                    slip: point.slip_guessed,
                    ..point.guess
                });
            }
        }
    }

    /// Finds the limit that fixes the output torque, and solves with it. The engine's drag is the limit exactly when it leaves more at
    /// the output than the wheels demand, full load when it leaves less; so a limit may be tried before it is certain: in overrun that
    /// of the step before, else that of a run at the demand that ends early. `None`: full load is the limit, and is not wanted yet.
    fn limited(
        &self,
        warm_start: &WarmStart,
        full_load_wanted: bool,
        work: &mut Work,
    ) -> Option<Limit> {
        let guess = self.first_guess(warm_start);
        let demand_nm = guess.output_nm;
        if warm_start.overrun && self.input.wheel.power_w < 0.0 {
            let near = Guess {
                output_nm: self.likely_overrun_nm(warm_start),
                ..guess
            };
            self.run(&near, Limit::EngineDrag, false, work);
            if work.point.guess.output_nm > demand_nm {
                return Some(Limit::EngineDrag);
            }
        }
        let mut may_leave = true;
        loop {
            self.run(&guess, Limit::None, may_leave, work);
            let limit = self.violated(&work.point, 0.0);
            if limit == Limit::None {
                return Some(limit);
            }
            if limit == Limit::FullLoad && !full_load_wanted {
                if may_leave {
                    self.run(&work.point.next(), Limit::None, false, work); // for what was asked of the engine
                }
                return None;
            }
            let from = work.point.next();
            self.run(&from, limit, false, work);
            let x = work.point.guess.output_nm;
            if !may_leave
                || (limit == Limit::EngineDrag && x > demand_nm)
                || (limit == Limit::FullLoad && x < demand_nm)
            {
                return Some(limit);
            }
            may_leave = false;
        }
    }
}

/// Effort and success of the solve.
#[derive(Default)]
struct Work {
    /// The last evaluation.
    point: Point,
    count: u16,
    residual: f64,
    slopes: Slopes,
}

impl Work {
    /// How a solve with a limit ended.
    fn outcome(&self, limit: Limit) -> Outcome {
        Outcome {
            limit,
            residual: self.residual,
            evaluations: self.count,
        }
    }
}

/// The engine is off.
fn engine_off<P: PrimeMover>(
    input: &StepInput<P>,
    ratio: f64,
    past: &mut DrivelineState,
    rest: &mut StepOutput,
) {
    past.engine_rad_s = input.engine.idle_rad_s(); // the starter brings it back there
    past.stood = true;
    past.rested_s = 0.0;
    past.coupled = false;
    rest.belt_ratio = ratio;
    rest.secondary_pa = 0.0;
    rest.primary_pa = 0.0;
    rest.slip = 0.0;
    rest.clamp_safety = f64::INFINITY;
    rest.flags.set(Flags::ENGINE_OFF, true);
}

/// Solves one step of the CVT; the belt of `own` follows the ratio, and an output at rest is filled.
pub(super) fn solve<P: PrimeMover>(
    cvt: &Cvt,
    input: &StepInput<P>,
    own: &mut CvtState,
    past: &mut DrivelineState,
    output: &mut StepOutput,
) {
    let CvtState {
        belt,
        warm_start,
        shifting,
        hold,
    } = own;
    let before = belt.geometry;
    let hold = hold.take();
    if input.engine_off {
        return engine_off(input, before.ratio, past, output);
    }
    let mut work = Work::default();
    let mut efficiency = cvt.ratio.route_efficiency;
    work.slopes = warm_start.slopes;
    let mut tried_ratio = f64::NAN;
    loop {
        let step = prepare(
            cvt,
            input,
            past,
            (&before, *shifting, &hold),
            belt,
            efficiency,
        );
        if step.secondary_rad_s <= 0.0 {
            *shifting = step.shifting;
            if !cvt.launch_behind {
                return standstill(&step, past, warm_start, output);
            }
            let guess = Guess {
                output_nm: 0.0,
                slip: 0.0,
                engine_rad_s: past.engine_rad_s,
                pressure_pa: past.secondary_pa,
            };
            step.run(&guess, Limit::None, false, &mut work); // LO-4
            let outcome = work.outcome(Limit::None);
            return finish(&step, &work.point, (past, warm_start), &outcome, output);
        }
        let ratio = step.line.at.geometry.ratio;
        let again = ratio.to_bits() == tried_ratio.to_bits();
        let last = again || efficiency <= MIN_ROUTE_EFFICIENCY;
        let full_load_wanted = last || hold.is_some();
        let Some(limit) = step.limited(warm_start, full_load_wanted, &mut work) else {
            tried_ratio = ratio;
            efficiency = step.kick_down(efficiency, &work.point);
            continue; // kick-down: losses are larger than RC-3 reckons with, so a higher speed is tried (RC-7)
        };
        warm_start.slopes = work.slopes;
        *shifting = step.shifting;
        warm_start.overrun = limit == Limit::EngineDrag;
        let outcome = work.outcome(limit);
        return finish(&step, &work.point, (past, warm_start), &outcome, output);
    }
}
