//! One implicit solve a step: throttle, slip and engine speed, and the output torque where the engine binds.

use super::Cvt;
use super::controller::{ClampSignals, RatioDemand};
use super::spin::SpinNow;
use super::variator::{BeltAtRatio, BeltLoad, BeltState, belt_state, sliding_speed_m_s};
use crate::lubricant::VALID_K;
use crate::results::{Component, Flags};
use crate::thermal::{BELT, SUMP};
use crate::transmission::loss_map::{LossMap, MapPoint};
use crate::transmission::{Drive, DriveState, Surroundings};

/// The solve stops when throttle, slip and relative engine speed move less than this.
const TOLERANCE: f64 = 1e-7;
/// Kick-down ends where the route would reckon with a lower efficiency than this (RC-7).
const LEAST_ROUTE_EFFICIENCY: f64 = 0.4;
/// Largest number of evaluations.
const MOST_EVALUATIONS: u16 = 60;

/// Everything of a step that does not change during the solve.
struct Step<'a> {
    cvt: &'a Cvt,
    around: &'a Surroundings<'a>,
    at: BeltAtRatio,
    secondary_rad_s: f64,
    spin: SpinNow,
    drive_nm: f64,
    viscous_factor: f64,
    eta_sump: f64,
    load: BeltLoad,
    radius_factor: f64,
    shift_flow_m3_s: f64,
    engine_before: f64,
    coupled: bool,
}

/// Unknowns of the solve.
#[derive(Clone, Copy)]
struct Guess {
    output_nm: f64,
    throttle: f64,
    slip: f64,
    engine_rad_s: f64,
    pressure_pa: f64,
}

/// One evaluation: torques that follow from a guess, and the guess that follows from them.
struct Point {
    guess: Guess,
    next: Guess,
    secondary_nm: f64,
    primary_rad_s: f64,
    primary_nm: f64,
    belt: BeltState,
    belt_map_nm: Option<f64>,
    clutch_nm: f64,
    pump_nm: f64,
    shaft_nm: f64,
    flow_limited: bool,
    oil_flow_m3_s: f64,
    inside_maps: bool,
}

impl Point {
    fn flywheel_nm(&self) -> f64 {
        self.primary_nm + self.pump_nm + self.shaft_nm // CV-2
    }

    fn moved(&self) -> f64 {
        let (a, b) = (&self.guess, &self.next);
        let mut most = (a.throttle - b.throttle).abs();
        let pressure = (a.pressure_pa / b.pressure_pa - 1.0).abs();
        for d in [(a.slip - b.slip).abs(), (a.engine_rad_s / b.engine_rad_s - 1.0).abs(), pressure] {
            most = if d > most { d } else { most };
        }
        most
    }
}

/// Which condition fixes the output torque.
#[derive(Clone, Copy, PartialEq)]
enum Bind {
    /// The wheels' demand.
    Demand,
    /// The least primary torque (CV-3).
    Least,
    /// Full load (CV-4).
    FullLoad,
}

impl Step<'_> {
    fn mapped(&self, map: Option<&LossMap>, speed: f64, torque: f64, pa: f64, inside: &mut bool) -> Option<f64> {
        let point = MapPoint {
            ratio: self.at.geometry.ratio,
            input_speed_rad_s: speed,
            torque_nm: torque,
            pressure_pa: pa,
            oil_k: self.around.heat.node_k[SUMP],
        };
        map.map(|m| {
            let (loss, ok) = m.loss_nm(&point);
            *inside &= ok;
            loss
        })
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
        let flywheel = primary_nm + pump_nm + shaft_nm;
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
    fn locked(&self, primary_rad_s: f64) -> bool {
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
        let signals = ClampSignals { throttle, engine_rad_s, oil_k: self.around.heat.node_k[SUMP], radius_factor: self.radius_factor };
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
        if w > p.primary_rad_s {
            return 0.0; // a slipping clutch whose engine is faster cannot take torque from the belt
        }
        let share = self.cvt.launch.overrun_share(p.primary_rad_s, idle);
        -share * (engine.drag_nm(w) + engine.accessories_nm(w) + p.pump_nm + p.shaft_nm)
    }

    fn most_primary_nm(&self, p: &Point) -> f64 {
        let engine = self.around.engine;
        let w = p.guess.engine_rad_s;
        engine.full_load_nm(w) - engine.accessories_nm(w) - p.pump_nm - p.shaft_nm
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
            let (u, g) = (point.guess.throttle, point.next.throttle);
            if let Some((u0, g0)) = last
                && (u - u0).abs() > 1e-9
            {
                work.gain = ((g - g0) / (u - u0)).clamp(-0.5, 0.5);
            }
            guess.throttle = (u + (g - u) / (1.0 - work.gain)).clamp(0.0, 1.0); // CV-5
            last = Some((u, g));
            if bind != Bind::Demand {
                let miss = point.primary_nm - self.target_nm(&point, bind);
                let relative = miss.abs() / scale;
                work.left = if relative > work.left { relative } else { work.left };
                let x = point.guess.output_nm;
                let plain = 1.0 / self.at.geometry.ratio;
                let slope = match before {
                    Some((x0, m0)) if (x - x0).abs() > 1e-12 => ((miss - m0) / (x - x0)).clamp(0.5 * plain, 2.0 * plain),
                    _ => plain,
                };
                before = Some((x, miss));
                guess.output_nm = x - miss / slope; // CV-5
            }
            if work.left <= TOLERANCE || work.count >= work.most {
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

/// Shift flow and the limits that free pump flow sets to the shift rate, 1/s towards low and high (RC-5).
fn flow_limits(cvt: &Cvt, at: &BeltAtRatio, state: &DriveState, eta: f64) -> (f64, f64) {
    let free = cvt.pump.displacement_m3_rad * state.engine_rad_s - cvt.pump.steady_need_m3_s(state.secondary_pa, eta);
    let free = if free > 0.0 { free } else { 0.0 };
    let (down, up) = sheave_volumes_m3(cvt, at);
    (free / down, free / up)
}

/// Oil volume for a unit of ln I: secondary cylinder towards low, primary cylinder towards high, m3 (PU-3).
fn sheave_volumes_m3(cvt: &Cvt, at: &BeltAtRatio) -> (f64, f64) {
    let slope = at.geometry.secondary_radius_slope_m();
    let primary = (at.geometry.secondary_radius_m - slope) / at.geometry.ratio;
    let travel = 2.0 * cvt.belt.tan_wedge;
    (cvt.secondary_piston_m2 * travel * slope, cvt.primary_piston_m2 * travel * primary)
}

/// What the shift reckons with: viscosity for the pump's flow, efficiency for the full-load route.
struct Route {
    eta_pa_s: f64,
    efficiency: f64,
}

fn shift(cvt: &Cvt, around: &Surroundings, state: &DriveState, at: &BeltAtRatio, route: Route) -> (BeltAtRatio, f64, bool) {
    let (flow_down_per_s, flow_up_per_s) = flow_limits(cvt, at, state, route.eta_pa_s);
    let before = at.geometry.ratio;
    let demand = RatioDemand {
        secondary_rad_s: cvt.final_drive * around.wheel.wheel_rad_s,
        power_w: around.wheel.power_w,
        rated_w: around.engine.engine.rated_w,
        full_load_rad_s: cvt.full_load_route.at(around.wheel.power_w / (route.efficiency * around.engine.full_load_factor)),
        ratio_before: before,
        flow_down_per_s,
        flow_up_per_s,
        coupled: state.coupled,
        dt_s: around.dt_s,
    };
    let (ratio, held) = cvt.ratio.step(&demand);
    let change = (ratio / before).ln();
    let now = if change.abs() > 0.0 { BeltAtRatio::new(&cvt.belt, ratio) } else { *at };
    let (down, up) = sheave_volumes_m3(cvt, at);
    let flow = if change > 0.0 { down * change } else { -up * change } / around.dt_s;
    (now, flow, held)
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
        let guess = Guess {
            output_nm: around.wheel.power_w / step.secondary_rad_s,
            throttle: state.throttle,
            slip: state.slip,
            engine_rad_s: state.engine_rad_s,
            pressure_pa: state.secondary_pa,
        };
        work.most = work.count + MOST_EVALUATIONS;
        let (point, bind) = bound(&step, guess, state.overrun, &mut work);
        efficiency *= 0.9;
        if bind == Bind::FullLoad && efficiency > LEAST_ROUTE_EFFICIENCY {
            continue; // kick-down: losses are larger than RC-3 reckoned with, ask for more speed (RC-7)
        }
        state.gain = work.gain;
        state.overrun = bind == Bind::Least;
        return finish(&step, &point, state, Outcome { bind, left: work.left, count: work.count, held });
    }
}

/// Finds which condition fixes the output torque, and solves with it. In overrun the engine's least torque is tried first: it binds
/// exactly when it leaves more at the output than the wheels demand.
fn bound(step: &Step, guess: Guess, overrun: bool, work: &mut Work) -> (Point, Bind) {
    let demand_nm = guess.output_nm;
    if overrun && step.around.wheel.power_w < 0.0 {
        let point = step.run(guess, Bind::Least, work);
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

fn prepare<'a>(
    cvt: &'a Cvt,
    around: &'a Surroundings<'a>,
    state: &DriveState,
    at: &BeltAtRatio,
    efficiency: f64,
) -> (Step<'a>, bool) {
    let (sump_k, belt_k) = (around.heat.node_k[SUMP], around.heat.node_k[BELT]);
    let nu = around.oil.kinematic_m2_s(sump_k);
    let eta_sump = nu * around.oil.density_kg_m3(sump_k);
    let (now, shift_flow, held) = shift(cvt, around, state, at, Route { eta_pa_s: eta_sump, efficiency });
    let secondary_rad_s = cvt.final_drive * around.wheel.wheel_rad_s;
    let eta_belt = around.oil.dynamic_pa_s(belt_k);
    let sliding = sliding_speed_m_s(&cvt.belt, now.geometry.ratio, now.geometry.ratio * secondary_rad_s);
    let friction = &around.oil.friction;
    let spin = cvt.spin.at(nu);
    let step = Step {
        cvt,
        around,
        at: now,
        secondary_rad_s,
        drive_nm: cvt.spin.drive_nm(&spin, secondary_rad_s),
        spin,
        viscous_factor: cvt.pump.viscous_factor(eta_sump),
        eta_sump,
        load: BeltLoad {
            primary_speed_rad_s: 0.0,
            output_torque_nm: 0.0,
            secondary_clamp_n: 0.0,
            band: friction.band(belt_k, eta_belt, sliding),
            eta_pa_s: eta_belt,
            film_thickness_m: friction.film_thickness_m,
            segment_friction: friction.segment,
            flank_friction: friction.flank,
        },
        radius_factor: (cvt.radius_exponent * (cvt.low_radius_m / now.geometry.primary_radius_m).ln()).exp(),
        shift_flow_m3_s: shift_flow,
        engine_before: state.engine_rad_s,
        coupled: state.coupled,
    };
    (step, held)
}

/// The car stands in gear: the clutch slips at creep torque, pump and shaft turn.
fn standstill(step: &Step, state: &mut DriveState) -> Drive {
    let (cvt, engine) = (step.cvt, step.around.engine);
    let idle = engine.idle_rad_s;
    let creep = cvt.launch.creep_torque_nm(0.0, idle);
    let pace = engine.engine.inertia_torque_nm / engine.engine.inertia_kg_m2 * step.around.dt_s;
    let w = idle.clamp(state.engine_rad_s - pace, state.engine_rad_s + pace);
    let mut throttle = state.throttle;
    let (mut pa, mut pump_nm, mut shaft_nm, mut left, mut count) = (0.0, 0.0, 0.0, f64::INFINITY, 0);
    let mut inside = true;
    let mut flow_limited = false;
    let mut oil_flow_m3_s = 0.0;
    while left > TOLERANCE && count < MOST_EVALUATIONS {
        let signals = ClampSignals { throttle, engine_rad_s: w, oil_k: step.around.heat.node_k[SUMP], radius_factor: step.radius_factor };
        pa = cvt.pressure_pa(&signals, &step.at, &BeltLoad { output_torque_nm: creep * step.at.geometry.ratio, ..step.load }, 0.0);
        let pump = cvt.pump.state(w, pa, cvt.pump.steady_need_m3_s(pa, step.eta_sump), step.viscous_factor);
        flow_limited = pump.flow_limited;
        oil_flow_m3_s = pump.working_m3_s;
        pump_nm = step.mapped(cvt.maps.pump.as_ref(), w, 0.0, pa, &mut inside).unwrap_or(pump.torque_nm);
        shaft_nm = step.mapped(cvt.maps.input_shaft.as_ref(), w, 0.0, pa, &mut inside).unwrap_or_else(|| step.spin.shaft_nm(w));
        let next = ((creep + pump_nm + shaft_nm + engine.accessories_nm(w)) / engine.full_load_nm(w)).clamp(0.0, 1.0);
        left = (next - throttle).abs();
        throttle = next;
        count += 1;
    }
    let capacity = belt_state(
        &cvt.belt,
        &step.at,
        &BeltLoad { output_torque_nm: creep * step.at.geometry.ratio, secondary_clamp_n: cvt.secondary_clamp_n(pa, 0.0), ..step.load },
    )
    .capacity_nm;
    let mut drive = Drive {
        engine_rad_s: w,
        shaft_nm: creep + pump_nm + shaft_nm,
        throttle,
        belt_ratio: step.at.geometry.ratio,
        primary_pa: primary_pa(step, pa),
        secondary_pa: pa,
        slip: 0.0,
        clamp_safety: if creep > 0.0 { capacity / (creep * step.at.geometry.ratio) } else { f64::INFINITY },
        oil_flow_m3_s,
        residual: left,
        iterations: count,
        ..Drive::at_rest()
    };
    drive.lose(Component::LaunchClutch, creep * w); // LC-4
    drive.lose(Component::Pump, pump_nm * w);
    drive.lose(Component::InputShaft, shaft_nm * w);
    drive.flags.set(Flags::CLUTCH_SLIPPING, true);
    drive.flags.set(Flags::FLOW_LIMITED, flow_limited);
    drive.flags.set(Flags::NOT_CONVERGED, left > TOLERANCE);
    common_flags(step, &mut drive, inside);
    remember(state, &drive, step.at, true);
    state.coupled = false;
    drive
}

fn primary_pa(step: &Step, pa: f64) -> f64 {
    let cvt = step.cvt;
    cvt.secondary_clamp_n(pa, step.secondary_rad_s) * step.at.thrust_ratio / cvt.primary_piston_m2
}

/// How the solve ended.
struct Outcome {
    bind: Bind,
    left: f64,
    count: u16,
    held: bool,
}

fn finish(step: &Step, p: &Point, state: &mut DriveState, outcome: Outcome) -> Drive {
    let g = &p.guess;
    let (wp, we) = (p.primary_rad_s, g.engine_rad_s);
    let idle = step.around.engine.idle_rad_s;
    let mut drive = Drive {
        engine_rad_s: we,
        shaft_nm: p.flywheel_nm(),
        throttle: p.next.throttle,
        belt_ratio: step.at.geometry.ratio,
        primary_pa: primary_pa(step, g.pressure_pa),
        secondary_pa: g.pressure_pa,
        slip: g.slip,
        clamp_safety: p.belt.capacity_nm / p.secondary_nm.abs(),
        oil_flow_m3_s: p.oil_flow_m3_s,
        residual: outcome.left,
        iterations: outcome.count,
        ..Drive::at_rest()
    };
    match p.belt_map_nm {
        Some(loss) => drive.lose(Component::BeltMap, loss * wp),
        None => {
            drive.lose(Component::BeltBand, p.belt.band_nm * wp);
            drive.lose(Component::BeltFilm, p.belt.film_nm * wp);
            drive.lose(Component::BeltSlip, p.belt.slip_nm * wp);
            drive.lose(Component::BeltWedge, p.belt.wedge_nm * wp);
            drive.lose(Component::BeltPenetration, p.belt.penetration_nm * wp);
        }
    }
    drive.lose(Component::FinalDrive, (p.secondary_nm - g.output_nm) * step.secondary_rad_s);
    drive.lose(Component::ClutchDrag, p.clutch_nm * wp);
    drive.lose(Component::Pump, p.pump_nm * we);
    drive.lose(Component::InputShaft, p.shaft_nm * we);
    drive.lose(Component::LaunchClutch, p.primary_nm * (we - wp)); // LC-4
    if outcome.bind == Bind::Demand {
        drive.output_w = step.around.wheel.power_w;
    } else {
        drive.settle(step.around.wheel, g.output_nm * step.secondary_rad_s);
    }
    let flags = &mut drive.flags;
    flags.set(Flags::MISSED_TRACE, outcome.bind == Bind::FullLoad);
    flags.set(Flags::GROSS_SLIP, p.belt.gross_slip && p.belt_map_nm.is_none());
    flags.set(Flags::LOW_CLAMP, p.belt.capacity_nm < p.secondary_nm.abs());
    flags.set(Flags::FLOW_LIMITED, p.flow_limited || outcome.held);
    flags.set(Flags::CLUTCH_SLIPPING, we > wp * (1.0 + 1e-9) && p.primary_nm > 0.0);
    flags.set(Flags::CLUTCH_OPEN, outcome.bind == Bind::Least && wp < idle);
    flags.set(Flags::OVERRUN, p.primary_nm < 0.0);
    flags.set(Flags::NOT_CONVERGED, outcome.left > TOLERANCE);
    flags.set(Flags::LAUNCH_NOT_IN_LOW, state.stood && step.at.geometry.ratio < 0.99 * step.cvt.ratio.low);
    common_flags(step, &mut drive, p.inside_maps);
    remember(state, &drive, step.at, false);
    state.coupled = step.locked(wp) || we <= wp * (1.0 + 1e-4);
    drive
}

fn common_flags(step: &Step, drive: &mut Drive, inside_maps: bool) {
    let t = &step.around.heat.node_k;
    let valid = VALID_K.contains(&t[SUMP]) && VALID_K.contains(&t[BELT]) && inside_maps;
    drive.flags.set(Flags::OUTSIDE_VALIDITY, !valid);
    let ratio = step.at.geometry.ratio;
    let limits = &step.cvt.ratio;
    drive.flags.set(Flags::RATIO_LIMIT, ratio <= limits.high * (1.0 + 1e-9) || ratio >= limits.low * (1.0 - 1e-9));
    drive.flags.set(Flags::OVERSPEED, drive.engine_rad_s > step.around.engine.engine.highest_rad_s);
}

fn remember(state: &mut DriveState, drive: &Drive, at: BeltAtRatio, stood: bool) {
    state.belt = Some(at);
    state.engine_rad_s = drive.engine_rad_s;
    state.throttle = drive.throttle;
    state.slip = drive.slip;
    state.secondary_pa = drive.secondary_pa;
    state.stood = stood;
}
