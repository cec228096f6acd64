//! From the solved point to the driveline's output: powers, brake, flags, state; and the step at standstill.

use super::WarmStart;
use super::controller::{ClampLaw, PressurePoint};
use super::driveline::{PartTorques, Shaft};
use super::evaluate::{Guess, Limit, MAX_EVALUATIONS, Point, Step, TOLERANCE};
use super::variator::{BeltLoad, Tension, belt_capacity_nm};
use crate::flags::Flags;
use crate::lubricant::VALID_K;
use crate::math::{Mask, Real, physics};
use crate::prime_mover::{FULL_LOAD_LIMIT, PrimeMover};
use crate::thermal::{BELT, SUMP};
use crate::transmission::clamp_cause::ClampCause;
use crate::transmission::component::Component;
use crate::transmission::coupling::Coupling;
use crate::transmission::step::{DrivelineState, StepOutput};

/// Equilibrium of pump and clamp law with the car at rest in gear.
struct Idling<R: Real> {
    pressure_pa: R,
    primary_pa: R,
    /// Number of the cause.
    clamp_cause: R,
    torques: PartTorques<R>,
    throttle: R,
    /// Engine torque over full load.
    load_share: R,
    residual: R,
    evaluations: R,
    inside_maps: R::Mask,
    flow_limited: R::Mask,
    oil_flow_m3_s: R,
}

/// Fixed point of throttle and pressure with an engine at `w` that passes on `creep_nm` and takes `coupling_nm` for it. A lane that has settled
/// keeps its throttle, from which all else follows again.
#[physics]
fn idling<P: PrimeMover<R>, R: Real>(
    step: &Step<P, R>,
    w: R,
    (creep_nm, coupling_nm): (R, R),
    throttle: R,
) -> Idling<R> {
    let (line, engine, cvt) = (&step.line, step.input.engine, step.line.cvt);
    let none = w.splat(0.0);
    let mut at = Idling {
        pressure_pa: none,
        primary_pa: none,
        clamp_cause: none,
        torques: PartTorques::none(w),
        throttle,
        load_share: none,
        residual: w.splat(f64::INFINITY),
        evaluations: none,
        inside_maps: w.splat_mask(true),
        flow_limited: w.splat_mask(false),
        oil_flow_m3_s: none,
    };
    let load = BeltLoad {
        output_torque_nm: creep_nm * line.at.geometry.ratio,
        ..step.load
    };
    at.torques.secondary = creep_nm * line.at.geometry.ratio;
    let shaft = line.engine_shaft(w);
    let (accessories_nm, full_load_nm) = (engine.accessories_nm(w), engine.full_load_nm(w));
    let mut guess = throttle;
    for _ in 0..MAX_EVALUATIONS {
        let busy = at.residual.gt(TOLERANCE);
        if !busy.any() {
            break;
        }
        guess = busy.select(at.throttle, guess);
        let signals = line.signals(guess, w);
        let set_pa;
        (set_pa, at.clamp_cause) = cvt.pressure_by(step.clamp, &signals, line.at, || load, none);
        let shift = step.shift_need();
        let primary_pa = idle_primary_pa(step, &load, set_pa);
        let line_above_pa = cvt.line_above_pa(set_pa, primary_pa);
        let circuit = line.circuit(set_pa, line_above_pa, &shaft.pump, shift);
        (at.pressure_pa, at.flow_limited) = (circuit.pressure_pa, circuit.limited);
        at.primary_pa = idle_primary_pa(step, &load, at.pressure_pa);
        let pump = line.turn_engine(
            &mut at.torques,
            &shaft,
            cvt.line_pa(at.pressure_pa, at.primary_pa),
            step.shift_flow_m3_s,
            &mut at.inside_maps,
        );
        line.rest(&mut at.torques);
        at.oil_flow_m3_s = pump.working_m3_s;
        at.load_share = (at.torques.flywheel_nm(coupling_nm) + accessories_nm) / full_load_nm;
        let next = at.load_share.clamp(0.0, 1.0);
        at.residual = (next - guess).abs();
        at.throttle = next;
        at.evaluations = busy.select(at.evaluations + 1.0, at.evaluations);
    }
    at
}

/// The causes of their numbers.
#[physics]
fn causes<R: Real>(number: R) -> R::PerLane<ClampCause> {
    R::per_lane(|lane| ClampCause::from_number(number.lane(lane)))
}

/// Evaluations as whole numbers.
#[physics]
fn counts<R: Real>(number: R) -> R::PerLane<u16> {
    R::per_lane(|lane| number.lane(lane) as u16)
}

/// Speed of the secondary over that into the final drive in the step.
#[physics]
fn range_ratio<P: PrimeMover<R>, R: Real>(step: &Step<P, R>) -> R {
    match &step.line.range {
        Some(range) => range.ratio(),
        None => step.secondary_rad_s.splat(1.0),
    }
}

/// The car is at rest in gear: the coupling slips at creep torque, pump and shaft turn. Fills an output at rest.
#[physics]
#[inline(never)]
pub(super) fn standstill<P: PrimeMover<R>, R: Real>(
    step: &Step<P, R>,
    past: &mut DrivelineState<R>,
    warm_start: &mut WarmStart<R>,
    output: &mut StepOutput<R>,
) {
    step.secondary_rad_s
        .vectorize(|| rest(step, past, warm_start, output));
}

#[physics]
fn rest<P: PrimeMover<R>, R: Real>(
    step: &Step<P, R>,
    past: &mut DrivelineState<R>,
    warm_start: &mut WarmStart<R>,
    output: &mut StepOutput<R>,
) {
    let (line, cvt) = (&step.line, step.line.cvt);
    let idle = step.input.engine.idle_rad_s();
    let none = idle.splat(0.0);
    let creep = (1.0 - step.input.neutral_share) * cvt.coupling.creep_nm(none, idle); // SE-3
    let w = step.reach.nearest(idle);
    let side = cvt.coupling.engine_side(creep, none, w);
    let at = idling(step, w, (creep, side.engine_nm), past.throttle);
    let clamped = BeltLoad {
        secondary_clamp_n: cvt.secondary_clamp_n(at.pressure_pa, none),
        output_torque_nm: creep * line.at.geometry.ratio,
        ..step.load
    };
    let capacity = belt_capacity_nm(&cvt.belt, line.at, &clamped);
    let ratio = line.at.geometry.ratio;
    output.engine_rad_s = w;
    output.end_rad_s = w;
    output.shaft_nm = at.torques.flywheel_nm(side.engine_nm);
    output.throttle = at.throttle;
    output.belt_ratio = ratio;
    output.range_ratio = range_ratio(step);
    output.primary_pa = at.primary_pa;
    output.secondary_pa = at.pressure_pa;
    output.clamp_cause = causes(at.clamp_cause);
    output.slip = none;
    let safety = capacity / (creep * ratio);
    output.clamp_safety = creep.gt(0.0).select(safety, none.splat(f64::INFINITY));
    output.oil_flow_m3_s = at.oil_flow_m3_s;
    output.residual = at.residual;
    output.iterations = counts(at.evaluations);
    output.alternator_w = at.torques.alternator * w;
    output.add_loss(Component::LaunchClutch, side.loss_w);
    add_part_losses(output, &at.torques, [w, none, none, none]);
    output.flag(Flags::CLUTCH_SLIPPING, none.splat_mask(true));
    output.flag(Flags::FLOW_LIMITED, at.flow_limited);
    output.flag(Flags::NOT_CONVERGED, !converged(at.residual));
    let carried = at.load_share.splat(FULL_LOAD_LIMIT).ge(at.load_share);
    let valid = at.inside_maps & carried & table_holds(step, creep * ratio, none);
    common_flags(step, output, valid);
    remember(past, output, Some(step.input.dt_s));
    warm_start.trend.reset_at_standstill();
    past.coupled = none.splat_mask(false);
    past.closing_rad_s = none;
}

/// Adds the losses of all parts at the speeds of engine, primary, secondary and the shaft into the final drive, rad/s.
#[physics]
fn add_part_losses<R: Real>(
    output: &mut StepOutput<R>,
    torques: &PartTorques<R>,
    [engine, primary, secondary, output_shaft]: [R; 4],
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

/// Pressure of the primary at rest under a load with a pressure of the secondary, Pa.
#[physics]
fn idle_primary_pa<P, R: Real>(step: &Step<P, R>, load: &BeltLoad<R>, pa: R) -> R {
    let cvt = step.line.cvt;
    let clamped = BeltLoad {
        secondary_clamp_n: cvt.secondary_clamp_n(pa, pa.splat(0.0)),
        ..*load
    };
    let tension = Tension::driving(&cvt.belt, step.line.at, &clamped);
    cvt.primary_pa(tension.holding_n(
        &cvt.belt,
        step.line.at,
        load.output_torque_nm,
        load.segment_friction,
    ))
}

/// True for a residual within tolerance, false for NaN.
#[physics]
fn converged<R: Real>(residual: R) -> R::Mask {
    residual.splat(TOLERANCE).ge(residual)
}

/// How the solve ended.
pub(super) struct Outcome<R: Real> {
    pub limit: Limit<R::Mask>,
    pub residual: R,
    /// Evaluations.
    pub evaluations: R,
}

/// Fills an output at rest with that of a solved step.
#[physics]
#[inline(never)]
pub(super) fn finish<P: PrimeMover<R>, R: Real>(
    step: &Step<P, R>,
    p: &Point<R>,
    kept: (&mut DrivelineState<R>, &mut WarmStart<R>),
    outcome: &Outcome<R>,
    output: &mut StepOutput<R>,
) {
    step.secondary_rad_s
        .vectorize(|| finished(step, p, kept, outcome, output));
}

#[physics]
fn finished<P: PrimeMover<R>, R: Real>(
    step: &Step<P, R>,
    p: &Point<R>,
    (past, warm_start): (&mut DrivelineState<R>, &mut WarmStart<R>),
    outcome: &Outcome<R>,
    output: &mut StepOutput<R>,
) {
    let (g, ratio) = (&p.guess, step.line.at.geometry.ratio);
    let (wp, we) = (p.primary_rad_s, g.engine_rad_s);
    output.engine_rad_s = we;
    output.end_rad_s = end_rad_s(step, p);
    output.shaft_nm = p.flywheel_nm;
    output.throttle = p.throttle;
    output.belt_ratio = ratio;
    output.range_ratio = range_ratio(step);
    output.primary_pa = (step.line.cvt).primary_pa(p.torques.belt.holding_n);
    output.secondary_pa = g.pressure_pa;
    output.clamp_cause = causes(p.clamp_cause);
    output.slip = g.slip;
    let past_belt_nm = p.torques.past_belt * ((1.0 - g.slip) / ratio);
    output.primary_nm = p.primary_nm - p.torques.primary_nm() - past_belt_nm;
    output.secondary_nm = p.torques.secondary;
    output.clamp_safety = p.torques.belt.capacity_nm / p.torques.secondary.abs();
    let line = &step.line;
    let line_pa = line.cvt.line_pa(g.pressure_pa, output.primary_pa);
    output.oil_flow_m3_s = line.oil_flow_m3_s(we, line_pa, step.shift_flow_m3_s);
    output.residual = outcome.residual;
    output.iterations = counts(outcome.evaluations);
    let speeds = [we, wp, p.secondary_rad_s, step.secondary_rad_s];
    add_part_losses(output, &p.torques, speeds);
    output.add_loss(Component::LaunchClutch, p.coupling_w);
    output.alternator_w = p.torques.alternator * we;
    give(step, g, outcome.limit.binds(), output);
    solve_flags(step, p, past, outcome, output);
    // All runs of a group are at rest together.
    let rests = !step.secondary_rad_s.gt(0.0).any();
    if rests {
        warm_start.trend.reset_at_standstill();
    } else {
        let loss_nm = output.shaft_nm - g.output_nm / ratio;
        let trend = &mut warm_start.trend;
        trend.push(step.input.wheel.accel_m_s2, g.slip, loss_nm);
    }
    remember(past, output, rests.then_some(step.input.dt_s));
    past.closing_rad_s = p.locked.select(step.hold.closing_rad_s, we.splat(0.0));
    let turns_together = (p.over_rad_s * TOGETHER).ge(we);
    past.coupled = if step.line.cvt.coupling.by_command() {
        p.locked
    } else {
        p.locked | turns_together | step.locks
    };
}

/// Engine speed at the end of the step, rad/s: that of the locked box there; a free engine has its speed in the step.
#[physics]
fn end_rad_s<P: PrimeMover<R>, R: Real>(step: &Step<P, R>, p: &Point<R>) -> R {
    let we = p.guess.engine_rad_s;
    let mean_rad_s = step.line.at.geometry.ratio * step.secondary_rad_s;
    let box_rad_s = p.over_rad_s * (step.end_rad_s / mean_rad_s);
    let locked = box_rad_s + (we - p.over_rad_s) * step.hold.left_share;
    let by_command = we.splat_mask(step.line.cvt.coupling.by_command());
    // The engine over a clutch is never slower than the box.
    let free = by_command.select(we, we.max(box_rad_s));
    let end = p.locked.select(locked, free);
    mean_rad_s.gt(0.0).select(end, we)
}

/// Engine speed over that of the box up to which the two turn together.
const TOGETHER: f64 = 1.0 + 1e-4;
/// A ratio or a speed up to which another one is the same but for rounding.
const JUST_ABOVE: f64 = 1.0 + 1e-9;
const JUST_BELOW: f64 = 1.0 - 1e-9;

/// Splits the power at the wheels: their demand, or under a limit the power there is, with the rest to the brakes or as a deficit.
#[physics]
fn give<P: PrimeMover<R>, R: Real>(
    step: &Step<P, R>,
    g: &Guess<R>,
    bound: R::Mask,
    output: &mut StepOutput<R>,
) {
    let wheel = step.input.wheel;
    output.output_w = wheel.power_w;
    if bound.any() {
        let (brake_w, deficit_w) = (output.brake_w, output.deficit_w);
        output.split_brake_and_shortfall(wheel, g.output_nm * step.secondary_rad_s);
        output.output_w = bound.select(output.output_w, wheel.power_w);
        output.brake_w = bound.select(output.brake_w, brake_w);
        output.deficit_w = bound.select(output.deficit_w, deficit_w);
    }
}

/// Flags of a solved step.
#[physics]
fn solve_flags<P: PrimeMover<R>, R: Real>(
    step: &Step<P, R>,
    p: &Point<R>,
    past: &DrivelineState<R>,
    outcome: &Outcome<R>,
    output: &mut StepOutput<R>,
) {
    let (wp, we) = (p.over_rad_s, p.guess.engine_rad_s);
    let zero = we.splat(0.0);
    let rests = !step.secondary_rad_s.gt(0.0).any();
    let (belt, ratio) = (&p.torques.belt, step.line.at.geometry.ratio);
    output.flag(Flags::FULL_LOAD, outcome.limit.full_load);
    if p.torques.belt_map.is_none() {
        output.flag(Flags::GROSS_SLIP, belt.gross_slip);
    }
    let carried = p.torques.secondary.abs();
    output.flag(Flags::LOW_CLAMP, carried.gt(belt.capacity_nm));
    output.flag(Flags::FLOW_LIMITED, p.flow_limited | step.shift_held);
    let by_command = step.line.cvt.coupling.by_command();
    // A lock-up clutch that closes slips until the engine has come down (TC-9).
    let closes = p.locked & step.hold.closing_rad_s.gt(0.0);
    let slips = we.gt(wp * JUST_ABOVE) & p.passed_nm.gt(0.0);
    output.flag(
        Flags::CLUTCH_SLIPPING,
        slips | closes | zero.splat_mask(rests),
    );
    if by_command {
        output.flag(Flags::LOCKUP_OPEN, !p.locked);
    } else {
        let below_idle = step.input.engine.idle_rad_s().gt(wp);
        output.flag(Flags::CLUTCH_OPEN, outcome.limit.engine_drag & below_idle);
    }
    output.flag(Flags::OVERRUN, zero.gt(p.passed_nm));
    output.flag(Flags::NOT_CONVERGED, !converged(outcome.residual));
    if past.stood && !rests {
        let in_low = 0.99 * step.line.cvt.ratio.low;
        let mut not_low = in_low.gt(ratio);
        if let (Some(set), Some(range)) = (&step.line.cvt.ranges, &step.line.range) {
            not_low = not_low | set.low.gt(range.ratio());
        }
        output.flag(Flags::LAUNCH_NOT_IN_LOW, not_low);
    }
    let share = (p.flywheel_nm + step.input.engine.accessories_nm(we)) / p.full_load_nm;
    let inside = p.inside_maps & table_holds(step, p.torques.secondary, step.secondary_rad_s);
    let within = share.splat(FULL_LOAD_LIMIT).ge(share);
    common_flags(step, output, inside & within);
}

/// True if the table of a clamp law covers the belt's ratio, its torque at the secondary, Nm, and its speed, rad/s; true for other laws (PC-6).
#[physics]
fn table_holds<P, R: Real>(step: &Step<P, R>, secondary_nm: R, secondary_rad_s: R) -> R::Mask {
    let (ClampLaw::Table, Some(tables)) = (step.clamp, &step.line.cvt.pressure_table) else {
        return secondary_nm.splat_mask(true);
    };
    let ratio = step.line.at.geometry.ratio;
    secondary_nm.mask_lanes(|lane| {
        let (nm, rad_s) = (secondary_nm.lane(lane), secondary_rad_s.lane(lane));
        let at = PressurePoint::of_belt(nm, ratio.lane(lane), rad_s);
        R::get(tables, lane).holds(&at)
    })
}

/// Where a temperature, K, is one for which the fluid models hold.
#[physics]
fn is_valid<R: Real>(temp_k: R) -> R::Mask {
    let (least, most) = (*VALID_K.start(), *VALID_K.end());
    temp_k.ge(temp_k.splat(least)) & temp_k.splat(most).ge(temp_k)
}

/// Flags of any step; `valid` from maps and full load.
#[physics]
fn common_flags<P: PrimeMover<R>, R: Real>(
    step: &Step<P, R>,
    output: &mut StepOutput<R>,
    valid: R::Mask,
) {
    let t = &step.input.heat.node_k;
    let valid = is_valid(t[SUMP]) & is_valid(t[BELT]) & valid;
    let ratio = step.line.at.geometry.ratio;
    let limits = &step.line.cvt.ratio;
    output.flag(Flags::OUTSIDE_VALIDITY, !valid);
    let mut at_high = (limits.high * JUST_ABOVE).ge(ratio);
    let mut at_low = ratio.ge(limits.low * JUST_BELOW);
    if let (Some(set), Some(range)) = (&step.line.cvt.ranges, &step.line.range) {
        // Elsewhere the other range goes on.
        at_high = at_high & range.ratio().le(1.0);
        at_low = at_low & range.ratio().ge(set.low);
    }
    let at_end = at_high | at_low;
    output.flag(Flags::RATIO_LIMIT, at_end);
    let most_pa = (step.line.cvt).most_primary_pa(output.secondary_pa);
    let short = output.primary_pa.gt(most_pa * JUST_ABOVE);
    output.flag(Flags::PRIMARY_PRESSURE_SHORT, short);
    let fast = output.engine_rad_s.gt(step.input.engine.max_rad_s());
    output.flag(Flags::OVERSPEED, fast);
}

/// Keeps what the next step looks at; `rest_s`: how long a car at rest was.
#[physics]
fn remember<R: Real>(past: &mut DrivelineState<R>, output: &StepOutput<R>, rest_s: Option<f64>) {
    past.engine_rad_s = output.end_rad_s;
    past.throttle = output.throttle;
    past.secondary_pa = output.secondary_pa;
    past.stood = rest_s.is_some();
    match rest_s {
        Some(rest_s) => past.rested_s += rest_s,
        None => past.rested_s = 0.0,
    }
}
