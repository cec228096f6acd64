//! One implicit solve a step: secondary pressure (through throttle), slip and engine speed, and the output torque where the engine binds.

use super::Cvt;
use super::answer::{Outcome, finish, standstill};
use super::controller::{ClampLaw, ClampSignals};
use super::prepare::prepare;
use super::spin::SpinNow;
use super::variator::{BeltAtRatio, BeltLoad, BeltState, belt_state};
use crate::numeric::ramp;
use crate::results::Flags;
use crate::thermal::SUMP;
use crate::transmission::loss_map::{LossMap, MapPoint};
use crate::transmission::{Drive, DriveState, Surroundings};

/// The solve stops when slip and, relatively, pressure and engine speed move less than this.
pub(super) const TOLERANCE: f64 = 1e-7;
/// Closer than this two pressures say nothing of the slope, slip and speed moving as well, Pa.
const SECANT_FROM_PA: f64 = 200.0;
/// Largest slope of the pressure's fixed point that the secant believes: above it the step would overshoot.
const MOST_GAIN: f64 = 0.06;
/// Evaluations after which the solve goes on without secants and in half steps: slower, and stable for steeper couplings.
const DAMPED_FROM: u16 = 16;
/// Kick-down ends where the route would reckon with a lower efficiency than this (RC-7).
const LEAST_ROUTE_EFFICIENCY: f64 = 0.4;
/// Largest number of evaluations.
pub(super) const MOST_EVALUATIONS: u16 = 60;

/// Everything of a step that does not change during the solve.
pub(super) struct Step<'a> {
    pub cvt: &'a Cvt,
    pub around: &'a Surroundings<'a>,
    pub at: BeltAtRatio,
    pub secondary_rad_s: f64,
    pub spin: SpinNow,
    pub drive_nm: f64,
    pub viscous_factor: f64,
    pub eta_sump: f64,
    pub load: BeltLoad,
    pub radius_factor: f64,
    pub shift_flow_m3_s: f64,
    pub engine_before: f64,
    pub coupled: bool,
}

/// Unknowns of the solve.
#[derive(Clone, Copy)]
pub(super) struct Guess {
    pub output_nm: f64,
    /// Only an answer: it acts through the pressure.
    pub throttle: f64,
    pub slip: f64,
    pub engine_rad_s: f64,
    pub pressure_pa: f64,
}

impl Guess {
    /// The middle between two guesses.
    fn halfway(&self, other: &Guess) -> Guess {
        let mid = |a: f64, b: f64| 0.5 * (a + b);
        Guess {
            output_nm: mid(self.output_nm, other.output_nm),
            throttle: self.throttle,
            slip: mid(self.slip, other.slip),
            engine_rad_s: mid(self.engine_rad_s, other.engine_rad_s),
            pressure_pa: mid(self.pressure_pa, other.pressure_pa),
        }
    }
}

/// One evaluation: torques that follow from a guess, and the guess that follows from them.
pub(super) struct Point {
    pub guess: Guess,
    pub next: Guess,
    pub secondary_nm: f64,
    pub primary_rad_s: f64,
    pub primary_nm: f64,
    pub belt: BeltState,
    pub belt_map_nm: Option<f64>,
    pub clutch_nm: f64,
    pub pump_nm: f64,
    pub shaft_nm: f64,
    pub flow_limited: bool,
    pub oil_flow_m3_s: f64,
    pub inside_maps: bool,
}

impl Point {
    /// Torque at the flywheel, Nm: what the clutch passes on, pump and shaft (CV-2, CV-6).
    pub(super) fn flywheel_nm(&self) -> f64 {
        self.clutch_nm() + self.pump_nm + self.shaft_nm
    }

    /// Torque of the launch clutch at the engine, Nm.
    fn clutch_nm(&self) -> f64 {
        engine_side_nm(self.primary_nm, self.primary_rad_s, self.guess.engine_rad_s)
    }

    fn moved(&self) -> f64 {
        let (a, b) = (&self.guess, &self.next);
        let mut most = (a.pressure_pa / b.pressure_pa - 1.0).abs();
        for d in [(a.slip - b.slip).abs(), (a.engine_rad_s / b.engine_rad_s - 1.0).abs()] {
            most = if d > most { d } else { most };
        }
        most
    }
}

/// Clutch torque at the engine for a torque at the primary (CV-6): the same in drive; in overrun the power passes unchanged, since a
/// clutch whose engine is still running down from a higher speed can neither give nor take energy.
fn engine_side_nm(primary_nm: f64, primary_rad_s: f64, engine_rad_s: f64) -> f64 {
    if primary_nm < 0.0 { primary_nm * primary_rad_s / engine_rad_s } else { primary_nm }
}

/// Which condition fixes the output torque.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Bind {
    /// The wheels' demand.
    Demand,
    /// The least primary torque (CV-3).
    Least,
    /// Full load (CV-4).
    FullLoad,
}

impl Step<'_> {
    pub(super) fn mapped(&self, map: Option<&LossMap>, speed: f64, torque: f64, pa: f64, inside: &mut bool) -> Option<f64> {
        let map = map?;
        let (loss, ok) = map.loss_nm(&MapPoint {
            ratio: self.at.geometry.ratio,
            input_speed_rad_s: speed,
            torque_nm: torque,
            pressure_pa: pa,
            oil_k: self.around.heat.node_k[SUMP],
        });
        *inside &= ok;
        Some(loss)
    }

    fn evaluate(&self, g: &Guess) -> Point {
        let (cvt, maps) = (self.cvt, &self.cvt.maps);
        let ratio = self.at.geometry.ratio;
        let mut inside_maps = true;
        let primary_rad_s = ratio * self.secondary_rad_s / (1.0 - g.slip); // CV-1
        let pa = g.pressure_pa;
        // Never slower than the primary, and the same while locked, so that the clutch cannot give energy back.
        let engine_rad_s = if g.engine_rad_s > primary_rad_s && !self.locked(primary_rad_s) { g.engine_rad_s } else { primary_rad_s };
        let secondary_nm = match self.mapped(maps.final_drive.as_ref(), primary_rad_s, g.output_nm, pa, &mut inside_maps) {
            Some(loss) => g.output_nm + loss * primary_rad_s / self.secondary_rad_s,
            None => cvt.spin.secondary_torque_nm(self.drive_nm, g.output_nm),
        };
        let load = BeltLoad {
            primary_speed_rad_s: primary_rad_s,
            output_torque_nm: secondary_nm,
            secondary_clamp_n: cvt.secondary_clamp_n(pa, self.secondary_rad_s),
            ..self.load
        };
        let belt = belt_state(&cvt.belt, &self.at, &load);
        let belt_map_nm = self.mapped(maps.belt.as_ref(), primary_rad_s, secondary_nm, pa, &mut inside_maps);
        let belt_loss = belt_map_nm.unwrap_or_else(|| belt.loss_nm());
        let clutch_nm = self.mapped(maps.clutch_drag.as_ref(), primary_rad_s, 0.0, pa, &mut inside_maps).unwrap_or(self.spin.clutch_nm);
        // VA-1 with the slip in force, so that the power balance holds for this iterate exactly.
        let primary_nm = secondary_nm * self.secondary_rad_s / primary_rad_s + belt_loss + clutch_nm;
        let need = cvt.pump.steady_need_m3_s(pa, self.eta_sump) + self.shift_flow_m3_s;
        let pump = cvt.pump.state(engine_rad_s, pa, need, self.viscous_factor);
        let pump_nm = self.mapped(maps.pump.as_ref(), engine_rad_s, 0.0, pa, &mut inside_maps).unwrap_or(pump.torque_nm);
        let shaft_nm = self
            .mapped(maps.input_shaft.as_ref(), engine_rad_s, 0.0, pa, &mut inside_maps)
            .unwrap_or_else(|| self.spin.shaft_nm(engine_rad_s));
        let flywheel = engine_side_nm(primary_nm, primary_rad_s, engine_rad_s) + pump_nm + shaft_nm;
        let slip = if belt_map_nm.is_some() { 0.0 } else { belt.slip_total };
        let next = self.next(g, flywheel, primary_nm, primary_rad_s, slip, &load);
        Point {
            guess: Guess { engine_rad_s, ..*g },
            next,
            secondary_nm,
            primary_rad_s,
            primary_nm,
            belt,
            belt_map_nm,
            clutch_nm,
            pump_nm,
            shaft_nm,
            flow_limited: pump.flow_limited,
            oil_flow_m3_s: pump.working_m3_s,
            inside_maps,
        }
    }

    /// Whether the launch device holds engine and primary together (LC-5).
    pub(super) fn locked(&self, primary_rad_s: f64) -> bool {
        self.coupled && self.cvt.launch.holds(primary_rad_s, self.around.engine.idle_rad_s)
    }

    fn next(&self, g: &Guess, flywheel: f64, primary_nm: f64, primary_rad_s: f64, slip: f64, load: &BeltLoad) -> Guess {
        let engine = self.around.engine;
        let wanted = self.cvt.launch.engine_speed_rad_s(primary_nm, primary_rad_s, engine.idle_rad_s, self.coupled);
        let pace = engine.engine.inertia_torque_nm / engine.engine.inertia_kg_m2 * self.around.dt_s;
        let limited = wanted.clamp(self.engine_before - pace, self.engine_before + pace);
        let free = limited > primary_rad_s && !self.locked(primary_rad_s);
        let engine_rad_s = if free { limited } else { primary_rad_s };
        let full = engine.full_load_nm(engine_rad_s);
        let throttle = ((flywheel + engine.accessories_nm(engine_rad_s)) / full).clamp(0.0, 1.0);
        let signals = self.signals(throttle, engine_rad_s);
        let pressure_pa = self.cvt.pressure_pa(&signals, &self.at, load, self.secondary_rad_s);
        Guess { output_nm: g.output_nm, throttle, slip, engine_rad_s, pressure_pa }
    }

    /// Least primary torque that the engine and the launch device leave to the belt, Nm (CV-3).
    fn least_primary_nm(&self, p: &Point) -> f64 {
        let engine = self.around.engine;
        let idle = engine.idle_rad_s;
        if p.primary_rad_s < idle {
            return self.cvt.launch.creep_torque_nm(p.primary_rad_s, idle);
        }
        let w = p.guess.engine_rad_s;
        // A slipping clutch whose engine is faster cannot take torque from the belt; faded in, so that the solve sees no step.
        let together = 1.0 - ramp(w / p.primary_rad_s, 1.0, 1.02);
        let share = self.cvt.launch.overrun_share(p.primary_rad_s, idle);
        -together * share * (engine.drag_nm(w) + engine.accessories_nm(w) + p.pump_nm + p.shaft_nm)
    }

    fn most_primary_nm(&self, p: &Point) -> f64 {
        let engine = self.around.engine;
        let w = p.guess.engine_rad_s;
        engine.full_load_nm(w) - engine.accessories_nm(w) - p.pump_nm - p.shaft_nm
    }

    /// Where the solve begins: slip and losses of the step before, at the new ratio and demand.
    fn first_guess(&self, state: &DriveState) -> Guess {
        let primary = self.at.geometry.ratio * self.secondary_rad_s / (1.0 - state.slip);
        let engine_rad_s = if self.locked(primary) || primary > self.engine_before { primary } else { self.engine_before };
        let output_nm = self.around.wheel.power_w / self.secondary_rad_s;
        let engine = self.around.engine;
        let flywheel = output_nm / self.at.geometry.ratio + state.loss_nm;
        let throttle = ((flywheel + engine.accessories_nm(engine_rad_s)) / engine.full_load_nm(engine_rad_s)).clamp(0.0, 1.0);
        let signals = self.signals(throttle, engine_rad_s);
        let load = BeltLoad { output_torque_nm: output_nm, ..self.load };
        let pressure_pa = match &self.cvt.clamp {
            ClampLaw::SlipLimited { .. } => state.secondary_pa,
            _ => self.cvt.pressure_pa(&signals, &self.at, &load, self.secondary_rad_s),
        };
        Guess { output_nm, throttle, slip: state.slip, engine_rad_s, pressure_pa }
    }

    pub(super) fn signals(&self, throttle: f64, engine_rad_s: f64) -> ClampSignals {
        ClampSignals { throttle, engine_rad_s, oil_k: self.around.heat.node_k[SUMP], radius_factor: self.radius_factor }
    }

    /// Solves with the output torque bound by `bind`, from a first guess; the evaluations so far stand in `work`.
    fn run(&self, first: Guess, bind: Bind, work: &mut Work) -> Point {
        let mut guess = first;
        let mut before: Option<(f64, f64)> = None;
        let mut last: Option<(f64, f64)> = None;
        let scale = self.around.engine.full_load_nm(self.engine_before);
        let scale = if scale > 1.0 { scale } else { 1.0 };
        loop {
            let point = self.evaluate(&guess);
            work.count += 1;
            work.left = point.moved();
            guess = point.next;
            let (p, g) = (point.guess.pressure_pa, point.next.pressure_pa);
            if let Some((p0, g0)) = last
                && (p - p0).abs() > SECANT_FROM_PA
            {
                work.gain = ((g - g0) / (p - p0)).clamp(-MOST_GAIN, MOST_GAIN);
            }
            let secant = p + (g - p) / (1.0 - work.gain); // CV-5
            guess.pressure_pa = secant.clamp(self.cvt.floor_pa, self.cvt.cap_pa);
            last = Some((p, g));
            if bind != Bind::Demand {
                let miss = point.primary_nm - self.target_nm(&point, bind);
                let relative = miss.abs() / scale;
                work.left = if relative > work.left { relative } else { work.left };
                let x = point.guess.output_nm;
                let plain = 1.0 / self.at.geometry.ratio;
                let slope = match before {
                    Some((x0, m0)) if (x - x0).abs() > 1e-12 && work.count <= DAMPED_FROM => {
                        ((miss - m0) / (x - x0)).clamp(0.5 * plain, 2.0 * plain)
                    }
                    _ => plain,
                };
                before = Some((x, miss));
                // The belt carries no more than its capacity, whatever the engine could take or give (VA-2).
                let carried = 1.05 * point.belt.capacity_nm;
                let carried = if carried > first.output_nm.abs() { carried } else { first.output_nm.abs() };
                guess.output_nm = (x - miss / slope).clamp(-carried, carried); // CV-5
                if (guess.output_nm - x).abs() <= 1e-9 * carried {
                    work.left = point.moved();
                }
            }
            if work.count > DAMPED_FROM {
                guess = guess.halfway(&point.guess);
            }
            if work.left <= TOLERANCE || work.count >= work.most || work.left.is_nan() {
                return point;
            }
        }
    }

    fn target_nm(&self, point: &Point, bind: Bind) -> f64 {
        if bind == Bind::Least { self.least_primary_nm(point) } else { self.most_primary_nm(point) }
    }
}

/// Effort and success of the solve.
struct Work {
    count: u16,
    most: u16,
    left: f64,
    gain: f64,
}

/// Solves one step of the CVT.
pub(super) fn solve(cvt: &Cvt, around: &Surroundings, state: &mut DriveState) -> Drive {
    let Some(at) = state.belt else { return Drive::at_rest() };
    if around.engine_off {
        state.engine_rad_s = around.engine.idle_rad_s; // the starter brings it back there
        state.stood = true;
        state.coupled = false;
        let mut rest = Drive {
            belt_ratio: at.geometry.ratio,
            secondary_pa: 0.0,
            primary_pa: 0.0,
            slip: 0.0,
            clamp_safety: f64::INFINITY,
            ..Drive::at_rest()
        };
        rest.flags.set(Flags::ENGINE_OFF, true);
        return rest;
    }
    let mut work = Work { count: 0, most: MOST_EVALUATIONS, left: 0.0, gain: state.gain };
    let mut efficiency = cvt.ratio.route_efficiency;
    loop {
        let (step, held) = prepare(cvt, around, state, &at, efficiency);
        if step.secondary_rad_s <= 0.0 {
            return standstill(&step, state);
        }
        let guess = step.first_guess(state);
        work.most = work.count + MOST_EVALUATIONS;
        let (point, bind) = bound(&step, guess, state.overrun, &mut work);
        efficiency *= 0.9;
        if bind == Bind::FullLoad && efficiency > LEAST_ROUTE_EFFICIENCY {
            continue; // kick-down: losses are larger than RC-3 reckoned with, ask for more speed (RC-7)
        }
        state.gain = work.gain;
        state.overrun = (bind == Bind::Least).then_some(point.guess.output_nm / step.at.geometry.ratio);
        return finish(&step, &point, state, Outcome { bind, left: work.left, count: work.count, held });
    }
}

/// Finds which condition fixes the output torque, and solves with it. In overrun the engine's least torque is tried first: it binds
/// exactly when it leaves more at the output than the wheels demand.
fn bound(step: &Step, guess: Guess, overrun: Option<f64>, work: &mut Work) -> (Point, Bind) {
    let demand_nm = guess.output_nm;
    if let Some(primary_nm) = overrun
        && step.around.wheel.power_w < 0.0
    {
        let near = Guess { output_nm: primary_nm * step.at.geometry.ratio, ..guess };
        let point = step.run(near, Bind::Least, work);
        if point.guess.output_nm > demand_nm {
            return (point, Bind::Least);
        }
    }
    work.most = work.count + MOST_EVALUATIONS;
    let point = step.run(guess, Bind::Demand, work);
    let bind = if point.primary_nm < step.least_primary_nm(&point) {
        Bind::Least
    } else if point.primary_nm > step.most_primary_nm(&point) {
        Bind::FullLoad
    } else {
        return (point, Bind::Demand);
    };
    work.most = work.count + MOST_EVALUATIONS;
    (step.run(point.next, bind, work), bind)
}
