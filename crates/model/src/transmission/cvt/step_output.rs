//! From the solved point to the driveline's output: powers, brake, flags, state; and the step at standstill.

use super::WarmStart;
use super::controller::{ClampLaw, PressurePoint};
use super::driveline::{PartTorques, Shaft};
use super::evaluate::{Limit, MAX_EVALUATIONS, Point, Step, TOLERANCE};
use super::variator::{BeltLoad, belt_capacity_nm};
use crate::flags::Flags;
use crate::fluid::VALID_K;
use crate::math::clamp;
use crate::prime_mover::{FULL_LOAD_LIMIT, PrimeMover};
use crate::thermal::{BELT, SUMP};
use crate::transmission::clamp_cause::ClampCause;
use crate::transmission::component::Component;
use crate::transmission::step::{DrivelineState, StepOutput};

/// What pump and clamp law settle on with the car at rest in gear.
struct Idling {
    pressure_pa: f64,
    clamp_cause: ClampCause,
    torques: PartTorques,
    throttle: f64,
    /// Engine torque over full load.
    load_share: f64,
    residual: f64,
    evaluations: u16,
    inside_maps: bool,
    flow_limited: bool,
    oil_flow_m3_s: f64,
}

/// Fixed point of throttle and pressure with an engine at `w` that passes on `creep_nm` and takes `coupling_nm` for it.
fn idling<P: PrimeMover>(
    step: &Step<P>,
    w: f64,
    (creep_nm, coupling_nm): (f64, f64),
    throttle: f64,
) -> Idling {
    let (line, engine) = (&step.line, step.input.engine);
    let mut at = Idling {
        pressure_pa: 0.0,
        clamp_cause: ClampCause::Law,
        torques: PartTorques::default(),
        throttle,
        load_share: 0.0,
        residual: f64::INFINITY,
        evaluations: 0,
        inside_maps: true,
        flow_limited: false,
        oil_flow_m3_s: 0.0,
    };
    let load = || BeltLoad {
        output_torque_nm: creep_nm * line.at.geometry.ratio,
        ..step.load
    };
    at.torques.secondary = creep_nm * line.at.geometry.ratio;
    let shaft = line.engine_shaft(w);
    let (accessories_nm, full_load_nm) = (engine.accessories_nm(w), engine.full_load_nm(w));
    while at.residual > TOLERANCE && at.evaluations < MAX_EVALUATIONS {
        let signals = line.signals(at.throttle, w);
        let cvt = line.cvt;
        let (set_pa, cause) = cvt.pressure_by(step.clamp, &signals, line.at, load, 0.0);
        at.clamp_cause = cause;
        (at.pressure_pa, at.flow_limited) = line.held_pa(set_pa, &shaft.pump, step.shift_flow_m3_s);
        let pump = line.turn_engine(
            &mut at.torques,
            &shaft,
            at.pressure_pa,
            step.shift_flow_m3_s,
            &mut at.inside_maps,
        );
        line.rest(&mut at.torques);
        at.oil_flow_m3_s = pump.working_m3_s;
        at.load_share = (at.torques.flywheel_nm(coupling_nm) + accessories_nm) / full_load_nm;
        let next = clamp(at.load_share, 0.0, 1.0);
        at.residual = (next - at.throttle).abs();
        at.throttle = next;
        at.evaluations += 1;
    }
    at
}

/// The car is at rest in gear: the coupling slips at creep torque, pump and shaft turn. Fills an output at rest.
pub(super) fn standstill<P: PrimeMover>(
    step: &Step<P>,
    past: &mut DrivelineState,
    warm_start: &mut WarmStart,
    output: &mut StepOutput,
) {
    let (line, cvt) = (&step.line, step.line.cvt);
    let idle = step.input.engine.idle_rad_s();
    let creep = (1.0 - step.input.neutral_share) * cvt.coupling.creep_nm(0.0, idle); // SE-3
    let w = step.reach.nearest(idle);
    let side = cvt.coupling.engine_side(creep, 0.0, w);
    let at = idling(step, w, (creep, side.engine_nm), past.throttle);
    let clamped = BeltLoad {
        secondary_clamp_n: cvt.secondary_clamp_n(at.pressure_pa, 0.0),
        ..step.load
    };
    let capacity = belt_capacity_nm(&cvt.belt, line.at, &clamped);
    let ratio = line.at.geometry.ratio;
    output.engine_rad_s = w;
    output.shaft_nm = at.torques.flywheel_nm(side.engine_nm);
    output.throttle = at.throttle;
    output.belt_ratio = ratio;
    output.primary_pa = primary_pa(step, at.pressure_pa, 0.0);
    output.secondary_pa = at.pressure_pa;
    output.clamp_cause = at.clamp_cause;
    output.slip = 0.0;
    output.clamp_safety = if creep > 0.0 {
        capacity / (creep * ratio)
    } else {
        f64::INFINITY
    };
    output.oil_flow_m3_s = at.oil_flow_m3_s;
    output.residual = at.residual;
    output.iterations = at.evaluations;
    output.alternator_w = at.torques.alternator * w;
    output.add_loss(Component::LaunchClutch, side.loss_w);
    add_part_losses(output, &at.torques, [w, 0.0, 0.0, 0.0]);
    let flags = &mut output.flags;
    flags.set(Flags::CLUTCH_SLIPPING, true);
    flags.set(Flags::FLOW_LIMITED, at.flow_limited);
    flags.set(Flags::NOT_CONVERGED, !converged(at.residual));
    let valid = at.inside_maps && at.load_share <= FULL_LOAD_LIMIT;
    let valid = valid && table_holds(step, creep * ratio, 0.0);
    common_flags(step, output, valid);
    remember(past, output, Some(step.input.dt_s));
    warm_start.trend.reset_at_standstill();
    past.coupled = false;
}

/// Adds the losses of all parts at the speeds of engine, primary, secondary and the shaft into the final drive, rad/s.
#[inline(always)]
fn add_part_losses(
    output: &mut StepOutput,
    torques: &PartTorques,
    [engine, primary, secondary, output_shaft]: [f64; 4],
) {
    torques.for_each_loss(|component, shaft, torque_nm| {
        let speed_rad_s = match shaft {
            Shaft::Engine => engine,
            Shaft::Primary => primary,
            Shaft::Secondary => secondary,
            Shaft::Output => output_shaft,
        };
        output.add_loss(component, torque_nm * speed_rad_s);
    });
}

fn primary_pa<P>(step: &Step<P>, pa: f64, secondary_rad_s: f64) -> f64 {
    let cvt = step.line.cvt;
    cvt.primary_pa(cvt.secondary_clamp_n(pa, secondary_rad_s), step.line.at)
}

/// True for a residual within tolerance, false for NaN.
fn converged(residual: f64) -> bool {
    residual <= TOLERANCE
}

/// How the solve ended.
pub(super) struct Outcome {
    pub limit: Limit,
    pub residual: f64,
    pub evaluations: u16,
}

/// Fills an output at rest with that of a solved step.
pub(super) fn finish<P: PrimeMover>(
    step: &Step<P>,
    p: &Point,
    (past, warm_start): (&mut DrivelineState, &mut WarmStart),
    outcome: &Outcome,
    output: &mut StepOutput,
) {
    let (g, ratio) = (&p.guess, step.line.at.geometry.ratio);
    let (wp, we) = (p.primary_rad_s, g.engine_rad_s);
    output.engine_rad_s = we;
    output.shaft_nm = p.flywheel_nm;
    output.throttle = p.throttle;
    output.belt_ratio = ratio;
    output.primary_pa = primary_pa(step, g.pressure_pa, p.secondary_rad_s);
    output.secondary_pa = g.pressure_pa;
    output.clamp_cause = p.clamp_cause;
    output.slip = g.slip;
    output.primary_nm = p.primary_nm - p.torques.primary_nm();
    output.secondary_nm = p.torques.secondary;
    output.clamp_safety = p.torques.belt.capacity_nm / p.torques.secondary.abs();
    output.oil_flow_m3_s = p.oil_flow_m3_s;
    output.residual = outcome.residual;
    output.iterations = outcome.evaluations;
    let speeds = [we, wp, p.secondary_rad_s, step.secondary_rad_s];
    add_part_losses(output, &p.torques, speeds);
    output.add_loss(Component::LaunchClutch, p.coupling_w);
    output.alternator_w = p.torques.alternator * we;
    if outcome.limit == Limit::None {
        output.output_w = step.input.wheel.power_w;
    } else {
        output.split_brake_and_shortfall(step.input.wheel, g.output_nm * step.secondary_rad_s);
    }
    solve_flags(step, p, past, outcome, output);
    let rests = step.secondary_rad_s <= 0.0;
    if rests {
        warm_start.trend.reset_at_standstill();
    } else {
        let loss_nm = output.shaft_nm - g.output_nm / ratio;
        let trend = &mut warm_start.trend;
        trend.push(step.input.wheel.accel_m_s2, g.slip, loss_nm);
    }
    remember(past, output, rests.then_some(step.input.dt_s));
    let turns_together = we <= p.over_rad_s * (1.0 + 1e-4);
    past.coupled = p.locked || (turns_together && !step.line.cvt.coupling.by_command());
}

/// Flags of a solved step.
#[inline(always)]
fn solve_flags<P: PrimeMover>(
    step: &Step<P>,
    p: &Point,
    past: &DrivelineState,
    outcome: &Outcome,
    output: &mut StepOutput,
) {
    let (wp, we) = (p.over_rad_s, p.guess.engine_rad_s);
    let rests = step.secondary_rad_s <= 0.0;
    let (belt, ratio) = (&p.torques.belt, step.line.at.geometry.ratio);
    let flags = &mut output.flags;
    flags.set(Flags::MISSED_TRACE, outcome.limit == Limit::FullLoad);
    flags.set(
        Flags::GROSS_SLIP,
        belt.gross_slip && p.torques.belt_map.is_none(),
    );
    flags.set(
        Flags::LOW_CLAMP,
        belt.capacity_nm < p.torques.secondary.abs(),
    );
    flags.set(Flags::FLOW_LIMITED, p.flow_limited || step.shift_held);
    let by_command = step.line.cvt.coupling.by_command();
    // A lock-up clutch that closes slips until the engine has come down.
    let closes = p.locked && !past.coupled && past.engine_rad_s > wp;
    flags.set(
        Flags::CLUTCH_SLIPPING,
        (we > wp * (1.0 + 1e-9) && p.passed_nm > 0.0) || closes || rests,
    );
    flags.set(Flags::LOCKUP_OPEN, by_command && !p.locked);
    let below_idle = wp < step.input.engine.idle_rad_s();
    flags.set(
        Flags::CLUTCH_OPEN,
        outcome.limit == Limit::EngineDrag && below_idle && !by_command,
    );
    flags.set(Flags::OVERRUN, p.passed_nm < 0.0);
    flags.set(Flags::NOT_CONVERGED, !converged(outcome.residual));
    flags.set(
        Flags::LAUNCH_NOT_IN_LOW,
        past.stood && !rests && ratio < 0.99 * step.line.cvt.ratio.low,
    );
    let share = (p.flywheel_nm + step.input.engine.accessories_nm(we)) / p.full_load_nm;
    let inside = p.inside_maps && table_holds(step, p.torques.secondary, step.secondary_rad_s);
    common_flags(step, output, inside && share <= FULL_LOAD_LIMIT);
}

/// Whether a clamp law that is a table has the belt's ratio, its torque at the secondary, Nm, and its speed, rad/s; of another law true (PC-6).
fn table_holds<P>(step: &Step<P>, secondary_nm: f64, secondary_rad_s: f64) -> bool {
    if *step.clamp != ClampLaw::Table {
        return true;
    }
    let at = PressurePoint::of_belt(secondary_nm, step.line.at.geometry.ratio, secondary_rad_s);
    let table = step.line.cvt.pressure_table.as_ref();
    table.is_none_or(|table| table.holds(&at))
}

/// Flags of any step; `valid` from maps and full load.
fn common_flags<P: PrimeMover>(step: &Step<P>, output: &mut StepOutput, valid: bool) {
    let t = &step.input.heat.node_k;
    let valid = VALID_K.contains(&t[SUMP]) && VALID_K.contains(&t[BELT]) && valid;
    let ratio = step.line.at.geometry.ratio;
    let limits = &step.line.cvt.ratio;
    output.flags.set(Flags::OUTSIDE_VALIDITY, !valid);
    output.flags.set(
        Flags::RATIO_LIMIT,
        ratio <= limits.high * (1.0 + 1e-9) || ratio >= limits.low * (1.0 - 1e-9),
    );
    let line_pa = output.secondary_pa + step.line.cvt.pump.line_drop_pa;
    output.flags.set(
        Flags::PRIMARY_PRESSURE_SHORT,
        output.primary_pa > line_pa * (1.0 + 1e-9),
    );
    output.flags.set(
        Flags::OVERSPEED,
        output.engine_rad_s > step.input.engine.max_rad_s(),
    );
}

/// Keeps what the next step looks at; `rest_s`: how long a car at rest was.
fn remember(past: &mut DrivelineState, output: &StepOutput, rest_s: Option<f64>) {
    past.engine_rad_s = output.engine_rad_s;
    past.throttle = output.throttle;
    past.secondary_pa = output.secondary_pa;
    past.stood = rest_s.is_some();
    past.rested_s = rest_s.map_or(0.0, |rest_s| past.rested_s + rest_s);
}
