//! What a step of the CVT knows before its solve: the ratio after shifting, and everything that depends on ratio and temperature only.

use super::controller::{FREE_OVER_IDLE, RatioDemand, direction_after};
use super::driveline::{Driveline, Parts, PulleyShafts, ViscosityPowers, final_drive};
use super::evaluate::Step;
use super::pump::{ETA_REFERENCE_PA_S, PumpAtTemperature};
use super::variator::{BeltAtRatio, BeltLoad, Geometry};
use super::{Cvt, Hold, NU_REFERENCE_M2_S, Shifting};
use crate::fluid::{FilmPowers, OilState};
use crate::math::{exp_each, larger, ln, ln_each, pair};
use crate::prime_mover::PrimeMover;
use crate::thermal::{BELT, COOLANT, SUMP};
use crate::transmission::coupling::LockSignals;
use crate::transmission::step::{DrivelineState, StepInput};

/// Oil volume for a unit of ln I: secondary cylinder towards low, primary cylinder towards high, m3 (PU-3).
fn sheave_volumes_m3(cvt: &Cvt, g: &Geometry) -> (f64, f64) {
    let slope = g.secondary_radius_slope_m();
    let primary = (g.secondary_radius_m - slope) / g.ratio;
    let travel = 2.0 * cvt.belt.tan_wedge;
    (
        cvt.secondary_piston_m2 * travel * slope,
        cvt.primary_piston_m2 * travel * primary,
    )
}

/// The geometry before the step, what the ratio control kept of it, and what is imposed on the step.
pub(super) type Before<'a> = (&'a Geometry, Shifting, &'a Option<Hold>);

/// What the shift reckons with: the pump's free flow, efficiency for the full-load route.
struct Route {
    pump: PumpAtTemperature,
    efficiency: f64,
    /// Direction that a small change must not turn round; 0 in a kick-down (RC-7).
    last_direction: i8,
}

/// Outcome of the shift.
struct Shift {
    ratio: f64,
    /// Rate of ln I, 1/s.
    rate_per_s: f64,
    flow_m3_s: f64,
    /// True where pump flow held it back.
    held: bool,
    /// What the control keeps.
    kept: Shifting,
}

fn shift<P: PrimeMover>(
    cvt: &Cvt,
    input: &StepInput<P>,
    past: &DrivelineState,
    (before, kept, held): Before,
    route: Route,
) -> Shift {
    let share = cvt.ratio.filtered_share(
        kept.share,
        input.wheel.power_w / input.engine.rated_w(),
        input.dt_s,
    );
    let secondary_rad_s = cvt.final_drive.ratio * input.wheel.wheel_rad_s;
    let primary_rad_s = cvt.primary_rad_s(before.ratio, secondary_rad_s, past);
    if primary_rad_s <= 0.0 {
        return Shift {
            ratio: before.ratio,
            rate_per_s: 0.0,
            flow_m3_s: 0.0,
            held: false,
            kept: Shifting { share, ..kept },
        }; // RC-4
    }
    let (down_m3, up_m3) = sheave_volumes_m3(cvt, before);
    let drawn = route
        .pump
        .drawn_m3_s(cvt.pump.full_flow_m3_s(past.engine_rad_s));
    let free = drawn - route.pump.need_m3_s(past.secondary_pa);
    let free = larger(free, 0.0);
    let demand = RatioDemand {
        secondary_rad_s,
        primary_rad_s,
        speed_m_s: input.wheel.speed_m_s,
        power_w: input.wheel.power_w,
        share,
        full_load_rad_s: cvt.full_load_rad_s(input.engine, input.wheel.power_w / route.efficiency),
        mapped_rad_s: cvt.mapped_rad_s(input, share),
        cold_rad_s: (cvt.ratio.cold).at(input.heat.node_k[COOLANT], input.heat.node_k[SUMP]),
        ratio_before: before.ratio,
        flow_down_per_s: free / down_m3, // RC-5
        flow_up_per_s: free / up_m3,     // RC-5
        coupled: past.coupled || cvt.coupling.by_command(),
        last_direction: route.last_direction,
        free_up_to_rad_s: FREE_OVER_IDLE * input.engine.idle_rad_s(),
        dt_s: input.dt_s,
    };
    let (ratio, change, short) = match held {
        Some(hold) if hold.paced => cvt.ratio.paced(&demand, hold.ratio), // RC-15
        Some(hold) => (hold.ratio, ln(hold.ratio / before.ratio), false), // RC-12
        None => cvt.ratio.step(&demand),
    };
    let volume = if change > 0.0 {
        down_m3 * change
    } else {
        -up_m3 * change
    };
    Shift {
        ratio,
        rate_per_s: change / input.dt_s,
        flow_m3_s: volume / input.dt_s,
        held: short,
        kept: Shifting {
            direction: direction_after(change, kept.direction),
            share,
        },
    }
}

/// Powers and exponentials of a step.
struct Powers {
    viscosity: ViscosityPowers,
    viscous_factor: f64,
    radius_factor: f64,
    films: FilmPowers,
}

/// What they are powers of.
struct Bases {
    nu_m2_s: f64,
    eta_pa_s: f64,
    film_loads: [f64; 2],
    film_exponents: [f64; 2],
}

impl Powers {
    /// All of a step together: five logarithms, then eight exponentials.
    #[inline(always)]
    fn new(cvt: &Cvt, at: &BeltAtRatio, b: &Bases) -> Self {
        let slides = b.film_loads.map(|x| x > 0.0);
        let films = pair(|i| if slides[i] { b.film_loads[i] } else { 1.0 });
        let [nu, pump, inner, outer, radius] = ln_each([
            b.nu_m2_s / NU_REFERENCE_M2_S,
            b.eta_pa_s / ETA_REFERENCE_PA_S,
            films[0],
            films[1],
            cvt.low_radius_m / at.geometry.primary_radius_m,
        ]);
        let [shaft, clutch] = ViscosityPowers::exponents(cvt, nu);
        let [carried, sheared] = b.film_exponents;
        let [
            shaft,
            clutch,
            viscous_factor,
            radius_factor,
            inner_carried,
            outer_carried,
            inner_sheared,
            outer_sheared,
        ] = exp_each([
            shaft,
            clutch,
            cvt.pump.viscous_exponent * pump,
            cvt.radius_exponent * radius,
            carried * inner,
            carried * outer,
            sheared * inner,
            sheared * outer,
        ]);
        let sliding = |powers: [f64; 2]| pair(|i| if slides[i] { powers[i] } else { 0.0 });
        Powers {
            viscosity: ViscosityPowers { shaft, clutch },
            viscous_factor,
            radius_factor,
            films: FilmPowers {
                carried: sliding([inner_carried, outer_carried]),
                sheared: sliding([inner_sheared, outer_sheared]),
            },
        }
    }
}

/// Prepares a step: shifts from the geometry and what the control kept `before` it, brings the belt to the new ratio, and evaluates what the solve does not change.
#[inline(never)]
pub(super) fn prepare<'a, P: PrimeMover>(
    cvt: &'a Cvt,
    input: &'a StepInput<'a, P>,
    past: &DrivelineState,
    before: Before<'a>,
    belt: &'a mut BeltAtRatio,
    efficiency: f64,
) -> Step<'a, P> {
    let (oil, friction) = (input.oil, &input.oil.friction);
    let (sump_k, belt_k) = (input.heat.node_k[SUMP], input.heat.node_k[BELT]);
    let [nu_sump, nu_belt] = oil.viscosity.kinematic_each_m2_s([sump_k, belt_k]);
    let sump = OilState {
        kinematic_m2_s: nu_sump,
        density_kg_m3: oil.density_kg_m3(sump_k),
    };
    let eta_sump = nu_sump * sump.density_kg_m3;
    let eta_belt = nu_belt * oil.density_kg_m3(belt_k);
    let inlet = cvt.pump.with_factor(eta_sump, 1.0);
    let route = Route {
        pump: inlet,
        efficiency,
        last_direction: if efficiency < cvt.ratio.route_efficiency {
            0
        } else {
            before.1.direction
        },
    };
    let shift = shift(cvt, input, past, before, route);
    if shift.ratio.to_bits() != belt.geometry.ratio.to_bits() {
        *belt = BeltAtRatio::new(&cvt.belt, shift.ratio);
    }
    let at = &*belt;
    let secondary_rad_s = cvt.final_drive.ratio * input.wheel.wheel_rad_s;
    let signals = LockSignals {
        speed_m_s: input.wheel.speed_m_s,
        sump_k,
        output_rad_s: shift.ratio * secondary_rad_s,
        idle_rad_s: input.engine.idle_rad_s(),
    };
    let sliding = cvt
        .belt
        .sliding_m_s(shift.ratio, shift.ratio * secondary_rad_s);
    let bases = Bases {
        nu_m2_s: nu_sump,
        eta_pa_s: eta_sump,
        film_loads: friction.film_loads(eta_belt, sliding),
        film_exponents: friction.film_exponents(),
    };
    let powers = Powers::new(cvt, at, &bases);
    Step {
        // The demand of the wheels decides the friction of the teeth (GM-2).
        drive: final_drive(
            cvt,
            secondary_rad_s,
            input.wheel.power_w / secondary_rad_s,
            sump,
        ),
        line: Driveline {
            cvt,
            at,
            parts: Parts::ALL,
            viscosity: powers.viscosity,
            pump: PumpAtTemperature {
                viscous_factor: powers.viscous_factor,
                ..inlet
            },
            shafts: PulleyShafts::new(cvt, at, Parts::ALL),
            radius_factor: powers.radius_factor,
            force_log: cvt.floors.force_log(
                shift.rate_per_s,
                cvt.primary_rad_s(shift.ratio, secondary_rad_s, past),
            ),
            oil_k: sump_k,
            oil: sump,
            changes: cvt.changes.as_deref(),
        },
        input,
        secondary_rad_s,
        load: BeltLoad::unloaded(
            friction,
            friction.band_on_film(belt_k, powers.films),
            at.prepared.film_area_m2,
            sliding,
        ),
        shift_flow_m3_s: shift.flow_m3_s,
        shift_held: shift.held,
        shifting: shift.kept,
        reach: input.reach(past.engine_rad_s, 0.0),
        clamp: before
            .2
            .as_ref()
            .and_then(|hold| hold.clamp.as_ref())
            .unwrap_or(&cvt.clamp),
        pressure_before_pa: past.secondary_pa,
        hold: cvt.coupling.hold(&signals, past.coupled),
    }
}
