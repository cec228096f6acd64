//! From the solved point to the driveline's answer: powers, brake, flags, memory; and the step at standstill.

use super::evaluate::{Bind, Point, Step};
use super::solve::{MOST_EVALUATIONS, TOLERANCE};
use super::variator::{BeltLoad, belt_capacity_nm};
use crate::drive::{Component, Flags};
use crate::engine::FULL;
use crate::fluid::VALID_K;
use crate::math::held;
use crate::thermal::{BELT, SUMP};
use crate::transmission::{Drive, Past};

/// The car stands in gear: the clutch slips at creep torque, pump and shaft turn.
pub(super) fn standstill(step: &Step, past: &mut Past) -> Drive {
    let (cvt, engine) = (step.cvt, step.around.engine);
    let idle = engine.idle_rad_s;
    let creep = cvt.launch.creep_torque_nm(0.0, idle);
    let w = held(
        idle,
        past.engine_rad_s - step.pace_rad_s,
        past.engine_rad_s + step.pace_rad_s,
    );
    let mut throttle = past.throttle;
    let (mut pa, mut pump_nm, mut shaft_nm, mut share, mut left, mut count) =
        (0.0, 0.0, 0.0, 0.0, f64::INFINITY, 0);
    let mut inside = true;
    let mut flow_limited = false;
    let mut oil_flow_m3_s = 0.0;
    while left > TOLERANCE && count < MOST_EVALUATIONS {
        let signals = step.signals(throttle, w);
        let load = || BeltLoad {
            output_torque_nm: creep * step.at.geometry.ratio,
            ..step.load
        };
        pa = cvt.pressure_pa(&signals, step.at, load, 0.0);
        let (pump, shaft) = step.pump_and_shaft(w, pa, &mut inside);
        (pump_nm, shaft_nm) = (pump.torque_nm, shaft);
        (flow_limited, oil_flow_m3_s) = (pump.flow_limited, pump.working_m3_s);
        share = (creep + pump_nm + shaft_nm + engine.accessories_nm(w)) / engine.full_load_nm(w);
        let next = held(share, 0.0, 1.0);
        left = (next - throttle).abs();
        throttle = next;
        count += 1;
    }
    let clamped = BeltLoad {
        secondary_clamp_n: cvt.secondary_clamp_n(pa, 0.0),
        ..step.load
    };
    let capacity = belt_capacity_nm(&cvt.belt, step.at, &clamped);
    let mut drive = Drive {
        engine_rad_s: w,
        shaft_nm: creep + pump_nm + shaft_nm,
        throttle,
        belt_ratio: step.at.geometry.ratio,
        primary_pa: primary_pa(step, pa),
        secondary_pa: pa,
        slip: 0.0,
        clamp_safety: if creep > 0.0 {
            capacity / (creep * step.at.geometry.ratio)
        } else {
            f64::INFINITY
        },
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
    drive.flags.set(Flags::NOT_CONVERGED, !converged(left));
    common_flags(step, &mut drive, inside && share <= FULL);
    remember(past, &drive, true);
    past.trend.stand();
    past.coupled = false;
    drive
}

fn primary_pa(step: &Step, pa: f64) -> f64 {
    let cvt = step.cvt;
    cvt.secondary_clamp_n(pa, step.secondary_rad_s) * step.at.thrust_ratio / cvt.primary_piston_m2
}

/// Whether a residual is within tolerance; what is not a number is not.
fn converged(left: f64) -> bool {
    left <= TOLERANCE
}

/// How the solve ended.
pub(super) struct Outcome {
    pub bind: Bind,
    pub left: f64,
    pub count: u16,
}

pub(super) fn finish(step: &Step, p: &Point, past: &mut Past, outcome: Outcome) -> Drive {
    let g = &p.guess;
    let (wp, we) = (p.primary_rad_s, g.engine_rad_s);
    let idle = step.around.engine.idle_rad_s;
    let mut drive = Drive {
        engine_rad_s: we,
        shaft_nm: p.flywheel_nm,
        throttle: p.throttle,
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
    drive.lose(
        Component::FinalDrive,
        (p.secondary_nm - g.output_nm) * step.secondary_rad_s,
    );
    drive.lose(Component::ClutchDrag, p.clutch_nm * wp);
    drive.lose(Component::Pump, p.pump_nm * we);
    drive.lose(Component::InputShaft, p.shaft_nm * we);
    let slipping_nm = if p.primary_nm > 0.0 {
        p.primary_nm
    } else {
        0.0
    };
    drive.lose(Component::LaunchClutch, slipping_nm * (we - wp)); // LC-4, CV-6
    if outcome.bind == Bind::Demand {
        drive.output_w = step.around.wheel.power_w;
    } else {
        drive.settle(step.around.wheel, g.output_nm * step.secondary_rad_s);
    }
    let flags = &mut drive.flags;
    flags.set(Flags::MISSED_TRACE, outcome.bind == Bind::FullLoad);
    flags.set(
        Flags::GROSS_SLIP,
        p.belt.gross_slip && p.belt_map_nm.is_none(),
    );
    flags.set(Flags::LOW_CLAMP, p.belt.capacity_nm < p.secondary_nm.abs());
    flags.set(Flags::FLOW_LIMITED, p.flow_limited || step.shift_held);
    flags.set(
        Flags::CLUTCH_SLIPPING,
        we > wp * (1.0 + 1e-9) && p.primary_nm > 0.0,
    );
    flags.set(Flags::CLUTCH_OPEN, outcome.bind == Bind::Least && wp < idle);
    flags.set(Flags::OVERRUN, p.primary_nm < 0.0);
    flags.set(Flags::NOT_CONVERGED, !converged(outcome.left));
    flags.set(
        Flags::LAUNCH_NOT_IN_LOW,
        past.stood && step.at.geometry.ratio < 0.99 * step.cvt.ratio.low,
    );
    let share = (p.flywheel_nm + step.around.engine.accessories_nm(we)) / p.full_load_nm;
    common_flags(step, &mut drive, p.inside_maps && share <= FULL);
    let loss_nm = drive.shaft_nm - g.output_nm / step.at.geometry.ratio;
    past.trend
        .push(step.around.wheel.accel_m_s2, g.slip, loss_nm);
    remember(past, &drive, false);
    past.coupled = p.locked || we <= wp * (1.0 + 1e-4);
    drive
}

fn common_flags(step: &Step, drive: &mut Drive, inside_maps: bool) {
    let t = &step.around.heat.node_k;
    let valid = VALID_K.contains(&t[SUMP]) && VALID_K.contains(&t[BELT]) && inside_maps;
    drive.flags.set(Flags::OUTSIDE_VALIDITY, !valid);
    let ratio = step.at.geometry.ratio;
    let limits = &step.cvt.ratio;
    drive.flags.set(
        Flags::RATIO_LIMIT,
        ratio <= limits.high * (1.0 + 1e-9) || ratio >= limits.low * (1.0 - 1e-9),
    );
    drive.flags.set(
        Flags::OVERSPEED,
        drive.engine_rad_s > step.around.engine.engine.highest_rad_s,
    );
}

fn remember(past: &mut Past, drive: &Drive, stood: bool) {
    past.engine_rad_s = drive.engine_rad_s;
    past.throttle = drive.throttle;
    past.secondary_pa = drive.secondary_pa;
    past.stood = stood;
}
