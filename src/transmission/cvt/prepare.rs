//! What a step of the CVT knows before its solve: the ratio after shifting, and everything that depends on ratio and temperature only.

use super::Cvt;
use super::controller::RatioDemand;
use super::solve::Step;
use super::variator::{BeltAtRatio, BeltLoad, sliding_speed_m_s};
use crate::thermal::{BELT, SUMP};
use crate::transmission::{DriveState, Surroundings};

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

/// Prepares a step: shifts, and works out what the solve does not change; says whether pump flow held the shift back.
pub(super) fn prepare<'a>(
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
    // Without sliding there is no lift-off and no shear (LU-4, FI-1).
    let sliding = if cvt.belt.formulation.has_film() {
        sliding_speed_m_s(&cvt.belt, now.geometry.ratio, now.geometry.ratio * secondary_rad_s)
    } else {
        0.0
    };
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
        radius_factor: if now.geometry.ratio.to_bits() == at.geometry.ratio.to_bits() && state.radius_factor > 0.0 {
            state.radius_factor
        } else {
            cvt.radius_factor(&now)
        },
        shift_flow_m3_s: shift_flow,
        engine_before: state.engine_rad_s,
        coupled: state.coupled,
    };
    (step, held)
}
