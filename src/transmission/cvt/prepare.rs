//! What a step of the CVT knows before its solve: the ratio after shifting, and everything that depends on ratio and temperature only.

use super::Cvt;
use super::controller::RatioDemand;
use super::evaluate::Step;
use super::variator::{BeltAtRatio, BeltLoad, sliding_speed_m_s};
use crate::numeric::ln;
use crate::thermal::{BELT, SUMP};
use crate::transmission::{DriveState, Surroundings};

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

/// Outcome of the shift.
struct Shift {
    ratio: f64,
    flow_m3_s: f64,
    /// Whether pump flow held it back.
    held: bool,
}

fn shift(cvt: &Cvt, around: &Surroundings, state: &DriveState, at: &BeltAtRatio, route: Route) -> Shift {
    let (down_m3, up_m3) = sheave_volumes_m3(cvt, at);
    let free = cvt.pump.displacement_m3_rad * state.engine_rad_s - cvt.pump.steady_need_m3_s(state.secondary_pa, route.eta_pa_s);
    let free = if free > 0.0 { free } else { 0.0 };
    let before = at.geometry.ratio;
    let demand = RatioDemand {
        secondary_rad_s: cvt.final_drive * around.wheel.wheel_rad_s,
        power_w: around.wheel.power_w,
        rated_w: around.engine.engine.rated_w,
        full_load_rad_s: cvt.full_load_route.at(around.wheel.power_w / (route.efficiency * around.engine.full_load_factor)),
        ratio_before: before,
        flow_down_per_s: free / down_m3, // RC-5
        flow_up_per_s: free / up_m3,     // RC-5
        coupled: state.coupled,
        dt_s: around.dt_s,
    };
    let (ratio, held) = cvt.ratio.step(&demand);
    if ratio.to_bits() == before.to_bits() {
        return Shift { ratio, flow_m3_s: 0.0, held };
    }
    let change = ln(ratio / before);
    let volume = if change > 0.0 { down_m3 * change } else { -up_m3 * change };
    Shift { ratio, flow_m3_s: volume / around.dt_s, held }
}

/// Prepares a step: shifts, and works out what the solve does not change.
#[inline(never)]
pub(super) fn prepare<'a>(
    cvt: &'a Cvt,
    around: &'a Surroundings<'a>,
    state: &DriveState,
    before: &BeltAtRatio,
    efficiency: f64,
) -> Step<'a> {
    let (sump_k, belt_k) = (around.heat.node_k[SUMP], around.heat.node_k[BELT]);
    let nu = around.oil.kinematic_m2_s(sump_k);
    let eta_sump = nu * around.oil.density_kg_m3(sump_k);
    let Shift { ratio, flow_m3_s, held } = shift(cvt, around, state, before, Route { eta_pa_s: eta_sump, efficiency });
    let shifted = ratio.to_bits() != before.geometry.ratio.to_bits();
    let at = if shifted { BeltAtRatio::new(&cvt.belt, ratio) } else { *before };
    let secondary_rad_s = cvt.final_drive * around.wheel.wheel_rad_s;
    let spin = cvt.spin.at(nu);
    let engine = around.engine.engine;
    Step {
        cvt,
        around,
        shifted,
        secondary_rad_s,
        drive_nm: cvt.spin.drive_nm(&spin, secondary_rad_s),
        spin,
        viscous_factor: cvt.pump.viscous_factor(eta_sump),
        eta_sump,
        load: unloaded(cvt, around, belt_k, ratio * secondary_rad_s, ratio),
        radius_factor: if shifted || state.radius_factor <= 0.0 { cvt.radius_factor(&at) } else { state.radius_factor },
        at,
        shift_flow_m3_s: flow_m3_s,
        shift_held: held,
        engine_before: state.engine_rad_s,
        pace_rad_s: engine.inertia_torque_nm / engine.inertia_kg_m2 * around.dt_s,
        coupled: state.coupled,
        locked_from_rad_s: if state.coupled { cvt.launch.holds_from_rad_s(around.engine.idle_rad_s) } else { f64::INFINITY },
        maps: cvt.maps.any().then_some(&cvt.maps),
    }
}

/// What acts on the belt before speed, torque and clamping force are known: friction and film at its temperature.
fn unloaded(cvt: &Cvt, around: &Surroundings, belt_k: f64, primary_rad_s: f64, ratio: f64) -> BeltLoad {
    // Without sliding there is no lift-off and no shear (LU-4, FI-1), and viscosity does not matter.
    let eta_pa_s = if primary_rad_s > 0.0 { around.oil.dynamic_pa_s(belt_k) } else { 0.0 };
    let sliding = if cvt.belt.formulation.has_film() { sliding_speed_m_s(&cvt.belt, ratio, primary_rad_s) } else { 0.0 };
    let friction = &around.oil.friction;
    BeltLoad {
        primary_speed_rad_s: 0.0,
        output_torque_nm: 0.0,
        secondary_clamp_n: 0.0,
        band: friction.band(belt_k, eta_pa_s, sliding),
        eta_pa_s,
        film_thickness_m: friction.film_thickness_m,
        segment_friction: friction.segment,
        flank_friction: friction.flank,
    }
}
