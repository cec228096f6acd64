//! One implicit solve a step: secondary pressure (through throttle), slip and engine speed, and the output torque where the engine limits it.
//!
//! An evaluation leaves mainly one number open, the pressure; its fixed point is found by a secant with the slope that the step
//! before ended with. Where the engine limits it, a second secant finds the output torque.
//!
//! Several runs side by side are solved in lockstep, each by its own way: a lane that is done, or that a run of evaluations does not concern, keeps
//! its guess and its limit, and an evaluation of the same guess gives the same point. So only the few numbers that steer a lane are held by masks.

use super::controller::ClampLaw;
use super::evaluate::{Guess, Limit, MAX_EVALUATIONS, Point, Step, TOLERANCE};
use super::prepare::{Try, prepare};
use super::range_gear::TurningRange;
use super::secant::{Slopes, TorqueSecant};
use super::shift_flow::ShiftFlow;
use super::step_output::{Outcome, finish, standstill};
use super::variator::BeltLoad;
use super::{Cvt, CvtState, WarmStart};
use crate::flags::Flags;
use crate::math::{Mask, Real, physics};
use crate::prime_mover::PrimeMover;
use crate::transmission::coupling::Coupling;
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

#[physics]
impl<P: PrimeMover<R>, R: Real> Step<'_, P, R> {
    /// The limit that a point at the demanded torque violates; violations within `margin_nm` are ignored.
    fn violated(&self, p: &Point<R>, margin_nm: R) -> Limit<R::Mask> {
        let above_idle = p.over_rad_s.ge(self.input.engine.idle_rad_s());
        let partly = p.throttle.splat(1.0).gt(p.throttle);
        let open = !(above_idle & p.passed_nm.ge(0.0) & partly);
        let mut limit = Limit::none(margin_nm.splat_mask(false));
        if !open.any() {
            return limit; // CV-3 is below zero here, CV-4 above
        }
        let at = self.turning(p.over_rad_s, p.guess.engine_rad_s);
        let least_nm = self.min_passed_nm(&at, p.spin_nm) - margin_nm;
        limit.engine_drag = open & least_nm.gt(p.passed_nm);
        let open = open & !limit.engine_drag;
        if open.any() {
            let most_nm = self.max_passed_nm(&at, p.spin_nm) + margin_nm;
            limit.full_load = open & p.passed_nm.gt(most_nm);
        }
        limit
    }

    /// The route's efficiency for another try, after one with `efficiency` that full load does not give (RC-7).
    fn kick_down(&self, efficiency: R, p: &Point<R>) -> R {
        let w = p.guess.engine_rad_s;
        let asked_w = (p.flywheel_nm + self.input.engine.accessories_nm(w)) * w;
        let had = self.input.wheel.power_w / asked_w;
        (KICK_DOWN * had.min(efficiency)).max(MIN_ROUTE_EFFICIENCY) // RC-7
    }

    /// Where full load at the end of the step does not give what is asked for then: the mean of a step may lack what a ratio on its way gives later (RC-7).
    fn lacks_at_end(&self, p: &Point<R>) -> R::Mask {
        let (engine, w) = (self.input.engine, p.guess.engine_rad_s);
        let asked_w = (p.flywheel_nm + engine.accessories_nm(w)) * w;
        let wheel = self.input.wheel;
        let grows = 1.0 + 0.5 * wheel.rise_w / wheel.power_w;
        let end = w.max(self.end_rad_s);
        (asked_w * grows).gt(engine.full_load_nm(end) * end)
    }

    /// Slip and loss torque in Nm that go on as in the steps before.
    fn extrapolated(&self, warm_start: &WarmStart<R>) -> (R, R) {
        let (slip, loss_nm) = warm_start.trend.next(self.input.wheel.accel_m_s2);
        (self.possible(slip), loss_nm)
    }

    /// The nearest slip that the belt can have: a line through slips leads anywhere, and at a slip of 1 no speed belongs to it (CV-1).
    fn possible(&self, slip: R) -> R {
        let most = 2.0 * self.line.cvt.belt.slip_bound;
        slip.clamp(-most, most)
    }

    /// Where the solve begins: slip and losses of the step before, at the new ratio and demand.
    fn first_guess(&self, warm_start: &WarmStart<R>) -> Guess<R> {
        let (slip, loss_nm) = self.extrapolated(warm_start);
        let engine_rad_s = self.first_engine_rad_s(slip);
        let output_nm = self.input.wheel.power_w / self.secondary_rad_s;
        let engine = self.input.engine;
        let flywheel = output_nm / self.line.at.geometry.ratio + loss_nm;
        let crank_nm = flywheel + engine.accessories_nm(engine_rad_s);
        let throttle = (crank_nm / engine.full_load_nm(engine_rad_s)).clamp(0.0, 1.0);
        let signals = self.line.signals(throttle, engine_rad_s);
        let pressure_pa = match self.clamp {
            ClampLaw::SlipLimited { .. } => self.pressure_before_pa,
            _ => {
                let cvt = self.line.cvt;
                let speed = self.secondary_rad_s;
                cvt.pressure_by(
                    self.clamp,
                    &signals,
                    self.line.at,
                    || BeltLoad {
                        output_torque_nm: output_nm,
                        ..self.load
                    },
                    speed,
                )
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

    fn first_engine_rad_s(&self, slip: R) -> R {
        let primary = self.primary_rad_s(slip);
        let from = self.reach.from_rad_s;
        (self.locked(primary) | primary.gt(from)).select(primary, from)
    }

    /// Output torque at which the engine's least torque is likely to be the limit: its drag with the losses that are expected, Nm.
    fn likely_overrun_nm(&self, warm_start: &WarmStart<R>) -> R {
        let engine = self.input.engine;
        let (slip, loss_nm) = self.extrapolated(warm_start);
        let w = self.first_engine_rad_s(slip);
        let share = self.line.cvt.coupling.overrun_share(w, engine.idle_rad_s());
        -self.line.at.geometry.ratio
            * (share * (engine.drag_nm(w) + engine.accessories_nm(w)) + loss_nm)
    }

    /// Solves the lanes of `runs` with the output torque fixed by `limit`, from a first guess; the result is in `work.point`. A run at the
    /// demanded torque that may leave ends early where the engine clearly cannot.
    #[inline(never)]
    fn run(
        &self,
        first: &Guess<R>,
        limit: &Limit<R::Mask>,
        may_leave: bool,
        runs: R::Mask,
        work: &mut Work<R>,
    ) {
        first.slip.vectorize(|| {
            work.guess = Guess::select(runs, first, &work.guess);
            work.limit = Limit::select(runs, limit, &work.limit);
            self.iterate(may_leave, runs, work);
        });
    }

    /// Evaluates until no lane of `busy` moves any more.
    fn iterate(&self, may_leave: bool, mut busy: R::Mask, work: &mut Work<R>) {
        let by_command = self.line.cvt.coupling.by_command();
        let mut last: Option<(Guess<R>, R)> = None;
        let (ratio, first_nm) = (self.line.at.geometry.ratio, work.guess.output_nm);
        let past = self.line.range.as_ref().map(TurningRange::output_over_belt);
        let mut torque = TorqueSecant::new(ratio, first_nm, past);
        let mut count = 0;
        loop {
            self.evaluate(&work.guess, &work.limit, &mut work.point);
            let point = &work.point;
            count += 1;
            work.count = busy.select(work.count + 1.0, work.count);
            let mut residual = point.moved();
            if let Some((before, before_next_pa)) = &last {
                let open = !point.locked & residual.splat_mask(by_command);
                work.slopes.update((before, *before_next_pa), point, open);
            }
            let scale = point.full_load_nm.max(1.0);
            let damped = count > DAMPED_FROM;
            let mut next_nm = work.guess.output_nm;
            let bound = work.limit.binds() & busy;
            if bound.any() {
                let (bound_nm, stopped) = torque.next_nm(point, &mut work.slopes, damped, bound);
                next_nm = bound.select(bound_nm, next_nm);
                let relative = point.miss_nm.abs() / scale;
                let larger = bound & relative.gt(residual) & !stopped;
                residual = larger.select(relative, residual);
            }
            work.residual = busy.select(residual, work.residual);
            busy = busy & residual.gt(TOLERANCE); // no where it is no number
            if may_leave && busy.any() {
                let near = busy & residual.splat(NEAR).gt(residual);
                if near.any() {
                    let violated = self.violated(point, CLEARLY * scale).binds();
                    busy = busy & !(near & violated);
                }
            }
            if count >= MAX_EVALUATIONS || !busy.any() {
                return;
            }
            last = Some((point.guess, point.next_pressure_pa));
            let next = self.next_guess(next_nm, damped, point, &work.slopes);
            work.guess = Guess::select(busy, &next, &work.guess);
        }
    }

    /// The guess that follows from an evaluation by the secants, or damped half the way to it.
    fn next_guess(
        &self,
        next_nm: R,
        damped: bool,
        point: &Point<R>,
        slopes: &Slopes<R>,
    ) -> Guess<R> {
        let cvt = self.line.cvt;
        let least_pa = cvt.floors.control_pa.min(point.next_pressure_pa);
        let pressure_pa = slopes.pressure_pa(point).clamp(least_pa, cvt.cap_pa); // CV-5
        let slip = point.guess.slip + slopes.slip_per_pa * (pressure_pa - point.guess.pressure_pa);
        let guess = Guess {
            output_nm: next_nm,
            slip: self.possible(slip), // CV-5
            engine_rad_s: point.next_engine_rad_s,
            pressure_pa,
        };
        if damped {
            return guess.halfway(&Guess {
                slip: point.slip_guessed,
                ..point.guess
            });
        }
        guess
    }

    /// Finds the limit that fixes the output torque of the lanes of `open`, and solves with it. The engine's drag is the limit exactly when
    /// it leaves more at the output than the wheels demand, full load when it leaves less; so a limit may be tried before it is certain: in
    /// overrun that of the step before, else that of a run at the demand that ends early. The lanes for which full load is the limit, and is
    /// not wanted yet.
    fn limited(
        &self,
        warm_start: &WarmStart<R>,
        full_load_wanted: R::Mask,
        mut open: R::Mask,
        work: &mut Work<R>,
    ) -> R::Mask {
        let guess = self.first_guess(warm_start);
        let demand_nm = guess.output_nm;
        let no = demand_nm.splat_mask(false);
        let mut short = no;
        let power_w = self.input.wheel.power_w;
        let overrun = open & warm_start.overrun & power_w.splat(0.0).gt(power_w);
        if overrun.any() {
            let near = Guess {
                output_nm: self.likely_overrun_nm(warm_start),
                ..guess
            };
            let drag = Limit {
                engine_drag: overrun,
                full_load: no,
            };
            self.run(&near, &drag, false, overrun, work);
            open = open & !(overrun & work.point.guess.output_nm.gt(demand_nm));
        }
        let mut may_leave = true;
        while open.any() {
            self.run(&guess, &Limit::none(no), may_leave, open, work);
            let limit = self.violated(&work.point, demand_nm.splat(0.0));
            open = open & limit.binds();
            let lacks = open & limit.full_load & !full_load_wanted;
            if lacks.any() {
                if may_leave {
                    let next = work.point.next();
                    self.run(&next, &Limit::none(no), false, lacks, work); // for what was asked of the engine
                }
                short = short | lacks;
                open = open & !lacks;
            }
            if !open.any() {
                break;
            }
            let from = work.point.next();
            self.run(&from, &limit, false, open, work);
            if !may_leave {
                break;
            }
            let x = work.point.guess.output_nm;
            let settled =
                (limit.engine_drag & x.gt(demand_nm)) | (limit.full_load & demand_nm.gt(x));
            open = open & !settled;
            may_leave = false;
        }
        short
    }
}

/// Effort and success of the solve.
struct Work<R: Real> {
    /// The last evaluation, and the guess and the limit that it is of.
    point: Point<R>,
    guess: Guess<R>,
    limit: Limit<R::Mask>,
    /// Evaluations.
    count: R,
    residual: R,
    slopes: Slopes<R>,
}

#[physics]
impl<R: Real> Work<R> {
    /// Before the first evaluation, with the slopes of the step before.
    fn new(slopes: Slopes<R>) -> Self {
        let like = slopes.pressure;
        Work {
            point: Point::none(like),
            guess: Guess::none(like),
            limit: Limit::none(like.splat_mask(false)),
            count: like.splat(0.0),
            residual: like.splat(0.0),
            slopes,
        }
    }

    /// How the solve ended.
    fn outcome(&self) -> Outcome<R> {
        Outcome {
            limit: self.limit,
            residual: self.residual,
            evaluations: self.count,
        }
    }
}

/// The engine is off.
fn engine_off<P: PrimeMover<R>, R: Real>(
    input: &StepInput<P, R>,
    (ratio, range_ratio): (R, R),
    past: &mut DrivelineState<R>,
    rest: &mut StepOutput<R>,
) {
    let none = ratio.splat(0.0);
    past.engine_rad_s = input.engine.idle_rad_s(); // the starter brings it back there
    past.stood = true;
    past.rested_s = 0.0;
    past.coupled = none.splat_mask(false);
    past.closing_rad_s = none;
    rest.belt_ratio = ratio;
    rest.range_ratio = range_ratio;
    rest.secondary_pa = none;
    rest.primary_pa = none;
    rest.slip = none;
    rest.clamp_safety = none.splat(f64::INFINITY);
    rest.flag(Flags::ENGINE_OFF, none.splat_mask(true));
}

/// Solves one step of the CVT; the belt of `own` follows the ratio, and an output at rest is filled.
#[physics]
pub(super) fn solve<P: PrimeMover<R>, R: Real>(
    cvt: &Cvt<R>,
    input: &StepInput<P, R>,
    own: &mut CvtState<R>,
    past: &mut DrivelineState<R>,
    output: &mut StepOutput<R>,
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
        if let Some(set) = &cvt.ranges {
            shifting.range = set.in_low(); // RG-2
        }
        return engine_off(input, (shifting.ratio, shifting.range.ratio), past, output);
    }
    let mut begun = None;
    let mut efficiency = cvt.ratio.route_efficiency;
    let (yes, no) = (efficiency.splat_mask(true), efficiency.splat_mask(false));
    let mut tried_ratio = efficiency.splat(f64::NAN);
    let mut trying = yes;
    let mut flow = ShiftFlow::new(efficiency);
    loop {
        let before = (&before, &*shifting, &hold);
        let asked = Try {
            efficiency,
            most_flow_m3_s: flow.most_m3_s,
        };
        let step = prepare(cvt, input, past, before, belt, asked);
        // All runs of a group are at rest together.
        let rests = !step.secondary_rad_s.gt(0.0).any();
        if rests && !cvt.launch_behind {
            standstill(&step, past, warm_start, output);
            *shifting = step.shifting;
            return;
        }
        let work = match &mut begun {
            Some(work) => work,
            none => none.insert(Work::new(warm_start.slopes)),
        };
        if rests {
            let guess = Guess {
                output_nm: efficiency.splat(0.0),
                slip: efficiency.splat(0.0),
                engine_rad_s: past.engine_rad_s,
                pressure_pa: past.secondary_pa,
            };
            step.run(&guess, &Limit::none(no), false, trying, work); // LO-4
        } else {
            let ratio = step.line.at.geometry.ratio;
            let last = ratio.bits_eq(tried_ratio)
                | efficiency.splat(MIN_ROUTE_EFFICIENCY).ge(efficiency)
                | efficiency.splat_mask(hold.is_some());
            let short = step.limited(warm_start, last, trying, work);
            if short.any() {
                // Kick-down: losses are larger than RC-3 reckons with, so a higher speed is tried (RC-7).
                tried_ratio = short.select(ratio, tried_ratio);
                let lower = step.kick_down(efficiency, &work.point);
                let lacks = short & step.lacks_at_end(&work.point);
                efficiency = lacks.select(lower, efficiency);
                trying = short;
                continue;
            }
        }
        let lacks = flow.takes(&step, &work.point);
        if lacks.any() {
            trying = lacks;
            continue; // RC-5
        }
        if !rests {
            warm_start.slopes = work.slopes;
            warm_start.overrun = work.limit.engine_drag;
        }
        finish(
            &step,
            &work.point,
            (past, warm_start),
            &work.outcome(),
            output,
        );
        *shifting = step.shifting;
        return;
    }
}
