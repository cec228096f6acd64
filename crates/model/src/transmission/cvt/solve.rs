//! One implicit solve a step: secondary pressure (through throttle), slip and engine speed, and the output torque where the engine binds.
//!
//! An evaluation leaves mainly one number open, the pressure; its fixed point is found by a secant with the slope that the step
//! before ended with. Where the engine binds, a second secant finds the output torque.

use super::Cvt;
use super::answer::{Outcome, finish, standstill};
use super::controller::ClampLaw;
use super::evaluate::{Bind, Guess, Point, Step};
use super::prepare::prepare;
use super::secant::{Slopes, TorqueSecant};
use super::variator::{BeltAtRatio, BeltLoad};
use crate::drive::Flags;
use crate::math::held;
use crate::transmission::{Drive, Past, Surroundings};

/// The solve stops when slip and, relatively, pressure and engine speed move less than this.
pub(super) const TOLERANCE: f64 = 1e-7;
/// Evaluations after which a run goes on without secants and in half steps: slower, and stable for steeper couplings.
const DAMPED_FROM: u16 = 10;
/// Kick-down ends where the route would reckon with a lower efficiency than this (RC-7).
const LEAST_ROUTE_EFFICIENCY: f64 = 0.4;
/// Largest number of evaluations of a run.
pub(super) const MOST_EVALUATIONS: u16 = 60;
/// Share of full load by which a demand must miss what the engine can do before a run leaves it unconverged, ...
const CLEARLY: f64 = 0.02;
/// ... and how far it may still be from its fixed point: so near, no torque moves by as much.
const NEAR: f64 = 0.02;

impl Step<'_> {
    /// Which condition a point at the demanded torque calls for, misses within a margin in Nm pardoned.
    fn called_for(&self, p: &Point, margin_nm: f64) -> Bind {
        let above_idle = p.primary_rad_s >= self.around.engine.idle_rad_s;
        if above_idle && p.primary_nm >= 0.0 && p.throttle < 1.0 {
            return Bind::Demand; // CV-3 is below zero here, CV-4 above
        }
        let (w, spin_nm) = (p.guess.engine_rad_s, p.pump_nm + p.shaft_nm);
        if p.primary_nm < self.least_primary_nm(p.primary_rad_s, w, spin_nm) - margin_nm {
            Bind::Least
        } else if p.primary_nm > self.most_primary_nm(w, spin_nm) + margin_nm {
            Bind::FullLoad
        } else {
            Bind::Demand
        }
    }

    /// Slip and loss torque in Nm that go on as in the steps before.
    fn onward(&self, past: &Past) -> (f64, f64) {
        let (slip, loss_nm) = past.trend.onward(self.around.wheel.accel_m_s2);
        (self.possible(slip), loss_nm)
    }

    /// The nearest slip that the belt can have: a line through slips leads anywhere, and at a slip of 1 no speed belongs to it (CV-1).
    fn possible(&self, slip: f64) -> f64 {
        let most = 2.0 * self.cvt.belt.slip_bound;
        held(slip, -most, most)
    }

    /// Where the solve begins: slip and losses of the step before, at the new ratio and demand.
    fn first_guess(&self, past: &Past) -> Guess {
        let (slip, loss_nm) = self.onward(past);
        let engine_rad_s = self.first_engine_rad_s(slip);
        let output_nm = self.around.wheel.power_w / self.secondary_rad_s;
        let engine = self.around.engine;
        let flywheel = output_nm / self.at.geometry.ratio + loss_nm;
        let throttle = held(
            (flywheel + engine.accessories_nm(engine_rad_s)) / engine.full_load_nm(engine_rad_s),
            0.0,
            1.0,
        );
        let signals = self.signals(throttle, engine_rad_s);
        let load = || BeltLoad {
            output_torque_nm: output_nm,
            ..self.load
        };
        let pressure_pa = match &self.cvt.clamp {
            ClampLaw::SlipLimited { .. } => past.secondary_pa,
            _ => self
                .cvt
                .pressure_pa(&signals, self.at, load, self.secondary_rad_s),
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
        if self.locked(primary) || primary > self.engine_before {
            primary
        } else {
            self.engine_before
        }
    }

    /// Output torque at which the engine's least torque is likely to bind: its drag with the losses that are expected, Nm.
    fn likely_overrun_nm(&self, past: &Past) -> f64 {
        let engine = self.around.engine;
        let (slip, loss_nm) = self.onward(past);
        let w = self.first_engine_rad_s(slip);
        let share = self.cvt.launch.overrun_share(w, engine.idle_rad_s);
        -self.at.geometry.ratio * (share * (engine.drag_nm(w) + engine.accessories_nm(w)) + loss_nm)
    }

    /// Solves with the output torque bound by `bind`, from a first guess; the answer stands in `work.point`. A run at the demanded
    /// torque that may leave ends early where the engine clearly cannot.
    fn run(&self, first: &Guess, bind: Bind, may_leave: bool, work: &mut Work) {
        let mut guess = *first;
        let mut last: Option<(Guess, f64)> = None;
        let mut torque = TorqueSecant::new(self.at.geometry.ratio, first.output_nm);
        let mut count = 0;
        loop {
            self.evaluate(&guess, bind, &mut work.point);
            let point = &work.point;
            count += 1;
            work.left = point.moved();
            if let Some((before, before_next_pa)) = &last {
                work.slopes.learn(before, *before_next_pa, point);
            }
            let scale = if point.full_load_nm > 1.0 {
                point.full_load_nm
            } else {
                1.0
            };
            let damped = count > DAMPED_FROM;
            let mut next_nm = guess.output_nm;
            if bind != Bind::Demand {
                let stopped;
                (next_nm, stopped) = torque.next_nm(point, &mut work.slopes, damped);
                let relative = point.miss_nm.abs() / scale;
                work.left = if relative > work.left && !stopped {
                    relative
                } else {
                    work.left
                };
            }
            let done = work.left <= TOLERANCE || count >= MOST_EVALUATIONS || work.left.is_nan();
            if done
                || (may_leave
                    && work.left < NEAR
                    && self.called_for(point, CLEARLY * scale) != Bind::Demand)
            {
                work.count += count;
                return;
            }
            last = Some((point.guess, point.next_pressure_pa));
            let pressure_pa = held(
                work.slopes.pressure_pa(point),
                self.cvt.floor_pa,
                self.cvt.cap_pa,
            ); // CV-5
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

    /// Finds which condition fixes the output torque, and solves with it. The engine's least torque binds exactly when it leaves more
    /// at the output than the wheels demand, full load when it leaves less; so what binds may be tried before it is certain: in
    /// overrun from the step before, else from a run at the demand that leaves early. `None`: full load binds, and is not wanted yet.
    fn bound(&self, past: &Past, full_load_wanted: bool, work: &mut Work) -> Option<Bind> {
        let guess = self.first_guess(past);
        let demand_nm = guess.output_nm;
        if past.overrun && self.around.wheel.power_w < 0.0 {
            let near = Guess {
                output_nm: self.likely_overrun_nm(past),
                ..guess
            };
            self.run(&near, Bind::Least, false, work);
            if work.point.guess.output_nm > demand_nm {
                return Some(Bind::Least);
            }
        }
        let mut may_leave = true;
        loop {
            self.run(&guess, Bind::Demand, may_leave, work);
            let bind = self.called_for(&work.point, 0.0);
            if bind == Bind::Demand {
                return Some(bind);
            }
            if bind == Bind::FullLoad && !full_load_wanted {
                return None;
            }
            let from = work.point.next();
            self.run(&from, bind, false, work);
            let x = work.point.guess.output_nm;
            if !may_leave
                || (bind == Bind::Least && x > demand_nm)
                || (bind == Bind::FullLoad && x < demand_nm)
            {
                return Some(bind);
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
    left: f64,
    slopes: Slopes,
}

/// The engine stands still.
fn engine_off(around: &Surroundings, ratio: f64, past: &mut Past) -> Drive {
    past.engine_rad_s = around.engine.idle_rad_s; // the starter brings it back there
    past.stood = true;
    past.coupled = false;
    let mut rest = Drive {
        belt_ratio: ratio,
        secondary_pa: 0.0,
        primary_pa: 0.0,
        slip: 0.0,
        clamp_safety: f64::INFINITY,
        ..Drive::at_rest()
    };
    rest.flags.set(Flags::ENGINE_OFF, true);
    rest
}

/// Solves one step of the CVT; `belt` is the one at the ratio in force, and follows it.
pub(super) fn solve(
    cvt: &Cvt,
    around: &Surroundings,
    belt: &mut BeltAtRatio,
    past: &mut Past,
) -> Drive {
    let before = belt.geometry;
    if around.engine_off {
        return engine_off(around, before.ratio, past);
    }
    let mut work = Work::default();
    let mut efficiency = cvt.ratio.route_efficiency;
    work.slopes = past.slopes;
    loop {
        let step = prepare(cvt, around, past, &before, belt, efficiency);
        if step.secondary_rad_s <= 0.0 {
            return standstill(&step, past);
        }
        efficiency *= 0.9;
        let Some(bind) = step.bound(past, efficiency <= LEAST_ROUTE_EFFICIENCY, &mut work) else {
            continue; // kick-down: losses are larger than RC-3 reckoned with, ask for more speed (RC-7)
        };
        past.slopes = work.slopes;
        past.overrun = bind == Bind::Least;
        return finish(
            &step,
            &work.point,
            past,
            Outcome {
                bind,
                left: work.left,
                count: work.count,
            },
        );
    }
}
