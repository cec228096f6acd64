//! Prepares a step of the CVT: the ratio after shifting, and everything that depends on ratio and temperature only.

use super::controller::{FREE_OVER_IDLE, Moment, RatioDemand, Shifted, direction_after};
use super::driveline::{Driveline, Parts, PulleyShafts, ViscosityPowers, final_drive};
use super::evaluate::Step;
use super::pump::{LN_ETA_REFERENCE, PumpAtTemperature};
use super::range_gear::{InRange, RangeGear, RangeStep};
use super::variator::{BeltAtRatio, BeltLoad, Geometry};
use super::{Cvt, Hold, LN_NU_REFERENCE, Shifting};
use crate::lubricant::OilState;
use crate::math::{Mask, Real, physics};
use crate::prime_mover::PrimeMover;
use crate::thermal::{BELT, COOLANT, SUMP};
use crate::transmission::coupling::{Coupling, LockSignals};
use crate::transmission::step::{DrivelineState, StepInput};

/// Oil volume for a unit of ln I: secondary cylinder towards low, primary cylinder towards high, m3 (PU-3).
#[physics]
fn sheave_volumes_m3<R: Real>(cvt: &Cvt<R>, g: &Geometry<R>) -> (R, R) {
    let slope = g.secondary_radius_slope_m();
    let primary = (g.secondary_radius_m - slope) / g.ratio;
    let travel = 2.0 * cvt.belt.tan_wedge;
    (
        cvt.secondary_piston_m2 * travel * slope,
        cvt.primary_piston_m2 * travel * primary,
    )
}

/// The geometry before the step, what the ratio control kept of it, and what is imposed on the step.
pub(super) type Before<'a, R> = (&'a Geometry<R>, &'a Shifting<R>, &'a Option<Hold<R>>);

/// Demand of a try of the solve on the shift.
#[derive(Clone, Copy)]
pub(super) struct Try<R: Real> {
    /// Efficiency that the route at full load reckons with (RC-3, RC-7).
    pub efficiency: R,
    /// Largest flow into the pulleys, m3/s (RC-5).
    pub most_flow_m3_s: R,
}

/// Inputs of the shift.
struct Route<R: Real> {
    asked: Try<R>,
    /// Direction that a small change must not turn round; 0 in a kick-down (RC-7).
    last_direction: R::PerLane<i8>,
}

/// Outcome of the shift.
struct Shift<R: Real> {
    /// Mean ratio of the step.
    ratio: R,
    /// Mean rate of ln I, 1/s.
    rate_per_s: R,
    flow_m3_s: R,
    /// True where pump flow held it back.
    held: R::Mask,
    /// State of the control.
    kept: Shifting<R>,
    /// Speeds of the primary at the beginning and end of the step, slip apart, rad/s.
    primaries: [R; 2],
    /// True where a launch clutch that slips locks within the step (RC-6).
    locks: R::Mask,
    /// Set behind the secondary, in a box with two ranges.
    range: Option<RangeStep<R>>,
}

/// Share of the power of full load at a target up to which the route at full load (RC-3) is surely not above it, with a margin for what three
/// passes leave, and is not worked out (ASSUMED; the test of control.rs has cars, temperatures and air for which it holds).
const AMPLE: f64 = 0.8;

/// Speed of the engine over the route at full load for a power, rad/s (RC-3); 0 where the target is surely above it.
#[physics]
fn full_load_rad_s<P: PrimeMover<R>, R: Real>(
    cvt: &Cvt<R>,
    engine: &P,
    demand: &RatioDemand<R>,
    efficiency: R,
) -> R {
    let power_w = demand.power_w / efficiency;
    let target_rad_s = cvt.ratio.target_rad_s(demand);
    let ample_w = AMPLE * engine.full_load_nm(target_rad_s) * target_rad_s;
    if (power_w.gt(0.0) & !ample_w.gt(power_w)).any() {
        return cvt.full_load_rad_s(engine, power_w);
    }
    power_w.splat(0.0)
}

#[physics]
impl<R: Real> Shift<R> {
    /// Nothing turns: the ratio stays, and the low range is engaged (RC-4, RG-2).
    fn at_rest(share: R, kept: &Shifting<R>, sets: Option<&RangeGear<R>>) -> Self {
        let zero = share.splat(0.0);
        Shift {
            ratio: kept.ratio,
            rate_per_s: zero,
            flow_m3_s: zero,
            held: zero.splat_mask(false),
            kept: Shifting {
                share,
                direction: kept.direction.clone(),
                ratio: kept.ratio,
                range: sets.map_or(kept.range, |set| set.in_low()),
            },
            primaries: [zero; 2],
            locks: zero.splat_mask(false),
            range: sets.map(|set| set.step(&set.in_low(), zero)),
        }
    }
}

/// The set in a step, with the speeds of the final drive at its ends, rad/s, and the range after it (RG-2).
#[physics]
fn set_in_step<R: Real>(
    set: &RangeGear<R>,
    (kept, held): (&Shifting<R>, &Option<Hold<R>>),
    cvt: &Cvt<R>,
    (demand, begins): (&RatioDemand<R>, &Moment<R>),
    behind: [R; 2],
) -> (RangeStep<R>, InRange<R>) {
    let Some(hold) = held else {
        let targets = [
            cvt.ratio.target_rad_s(&demand.at(begins)),
            cvt.ratio.target_rad_s(demand),
        ];
        return set.driven(&kept.range, (targets, behind), demand.coupled, demand.dt_s);
    };
    let step = set.step(&kept.range, behind[0].splat(demand.dt_s));
    let mut next = kept.range;
    next.ratio = step.ends[1];
    if hold.paced {
        let asked = hold.ratio * step.ends[1] * behind[1];
        next.low = set.wants_low(&kept.range, asked, behind[1], demand.coupled);
    }
    (step, next)
}

/// The way of the ratio in a step.
#[physics]
fn made<R: Real>(
    cvt: &Cvt<R>,
    demand: &RatioDemand<R>,
    held: Option<&Hold<R>>,
    next: &InRange<R>,
) -> Shifted<R> {
    let made = match held {
        Some(hold) if hold.paced => cvt.ratio.paced(demand, hold.ratio), // RC-15
        Some(hold) => {
            let end = hold.end.unwrap_or(hold.ratio);
            let change = (end / demand.ratio_before).ln();
            return Shifted {
                mean: hold.ratio,
                end,
                change,
                last: change,
                held: change.splat_mask(false),
            }; // RC-12, RC-16
        }
        None => cvt.ratio.step(demand),
    };
    match &cvt.ranges {
        // RG-6: the belt waits in low.
        Some(set) if set.past_belt && next.low.any() => {
            let waits = cvt.ratio.paced(demand, cvt.ratio.low);
            made.replaced(next.low, &waits)
        }
        _ => made,
    }
}

#[physics]
fn shift<P: PrimeMover<R>, R: Real>(
    cvt: &Cvt<R>,
    input: &StepInput<P, R>,
    past: &DrivelineState<R>,
    (before, kept, held): Before<R>,
    route: Route<R>,
) -> Shift<R> {
    let (wheel, engine) = (input.wheel, input.engine);
    let half_rise_w = 0.5 * wheel.rise_w;
    let powers_w = [wheel.power_w - half_rise_w, wheel.power_w + half_rise_w];
    let asked = [
        powers_w[0] / engine.rated_w(),
        powers_w[1] / engine.rated_w(),
    ];
    let share = cvt.ratio.filtered_share(kept.share, asked, input.dt_s);
    let behind_rad_s = cvt.final_drive.ratio * wheel.wheel_rad_s;
    let sets = cvt.ranges.as_deref();
    // The range before the step.
    let in_range = |behind: R| match sets {
        Some(_) => kept.range.ratio * behind, // RG-1
        None => behind,
    };
    let primary_rad_s = cvt.primary_rad_s(kept.ratio, in_range(behind_rad_s), past);
    let zero = share.splat(0.0);
    if zero.ge(primary_rad_s).all() {
        return Shift::at_rest(share, kept, sets); // RC-4
    }
    let (down_m3, up_m3) = sheave_volumes_m3(cvt, before);
    let most = route.asked.most_flow_m3_s;
    let speeds_m_s = wheel.end_speeds_m_s(input.dt_s);
    let of_mean = wheel.ends_over_mean(input.dt_s);
    let behind = [behind_rad_s * of_mean[0], behind_rad_s * of_mean[1]];
    let mut secondaries = behind.map(in_range);
    let mapped =
        |k: usize, share: R| cvt.mapped_rad_s(engine, (speeds_m_s[k], secondaries[k]), share);
    let efficiency = route.asked.efficiency;
    let mut demand = RatioDemand {
        begins: None,
        secondary_rad_s: secondaries[1],
        primary_rad_s,
        speed_m_s: speeds_m_s[1],
        power_w: powers_w[1],
        share,
        full_load_rad_s: zero,
        mapped_rad_s: mapped(1, share),
        cold_rad_s: (cvt.ratio.cold).at(input.heat.node_k[COOLANT], input.heat.node_k[SUMP]),
        ratio_before: kept.ratio,
        flow_down_per_s: most / down_m3, // RC-5
        flow_up_per_s: most / up_m3,     // RC-5
        coupled: past.coupled | zero.splat_mask(cvt.coupling.by_command()),
        locks_at: zero,
        last_direction: route.last_direction,
        free_up_to_rad_s: FREE_OVER_IDLE * engine.idle_rad_s(),
        dt_s: input.dt_s,
    };
    demand.full_load_rad_s = full_load_rad_s(cvt, engine, &demand, efficiency);
    let first_share = cvt.ratio.filter_s.gt(0.0).select(kept.share, asked[0]);
    let mut begins = Moment {
        secondary_rad_s: secondaries[0],
        speed_m_s: speeds_m_s[0],
        power_w: powers_w[0],
        share: first_share,
        full_load_rad_s: zero,
        mapped_rad_s: mapped(0, first_share),
    };
    begins.full_load_rad_s = full_load_rad_s(cvt, engine, &demand.at(&begins), efficiency);
    let (mut range, mut next) = (None, kept.range);
    if let Some(set) = sets {
        let step;
        (step, next) = set_in_step(set, (kept, held), cvt, (&demand, &begins), behind);
        secondaries = [step.ends[0] * behind[0], step.ends[1] * behind[1]]; // RG-1
        demand.secondary_rad_s = secondaries[1];
        demand.primary_rad_s = cvt.primary_rad_s(kept.ratio, step.mean * behind_rad_s, past);
        range = Some(step);
    }
    demand.begins = Some(begins);
    if !demand.coupled.all() {
        demand.locks_at = locks_at(past.engine_rad_s / kept.ratio, secondaries);
    }
    let made = made(cvt, &demand, held.as_ref(), &next);
    let change = made.change;
    let volume = change.gt(0.0).select(down_m3 * change, -up_m3 * change);
    let per_s = input.dt_s.recip();
    Shift {
        ratio: made.mean,
        rate_per_s: change * per_s,
        flow_m3_s: volume * per_s,
        held: made.held,
        kept: Shifting {
            direction: direction_after(made.last * per_s, &kept.direction),
            share,
            ratio: made.end,
            range: next,
        },
        primaries: [kept.ratio * secondaries[0], made.end * secondaries[1]],
        locks: !demand.coupled & demand.locks_at.lt(1.0),
        range,
    }
}

/// Share of a step after which the secondary has reached a speed, rad/s; 1 where it does not, 0 or less where it has before.
#[physics]
fn locks_at<R: Real>(lock_rad_s: R, [first, last]: [R; 2]) -> R {
    let (zero, one) = (first.splat(0.0), first.splat(1.0));
    let share = (lock_rad_s - first) / (last - first);
    (last.gt(first) & last.gt(lock_rad_s)).select(share, lock_rad_s.gt(first).select(one, zero))
}

/// Powers of a step.
struct Powers<R: Real> {
    viscosity: ViscosityPowers<R>,
    viscous_factor: R,
    radius_factor: R,
}

#[physics]
impl<R: Real> Powers<R> {
    /// All of them together.
    fn new(cvt: &Cvt<R>, at: &BeltAtRatio<R>, sump: &OilState<R>) -> Self {
        let [shaft, clutch] = ViscosityPowers::exponents(cvt, sump.log_nu - LN_NU_REFERENCE);
        let radius = cvt.low_radius_m * (at.geometry.ratio * at.prepared.inv_secondary_radius); // GE-1
        let [shaft, clutch, viscous_factor, radius_factor] = R::exp_array([
            shaft,
            clutch,
            cvt.pump.viscous_exponent * (sump.log_eta - LN_ETA_REFERENCE),
            cvt.radius_exponent * radius.ln(),
        ]);
        Powers {
            viscosity: ViscosityPowers { shaft, clutch },
            viscous_factor,
            radius_factor,
        }
    }
}

/// Prepares a step: shifts from the geometry and what the control kept `before` it, brings the belt to the new ratio, and evaluates what the solve does not change.
#[physics]
#[inline(never)]
pub(super) fn prepare<'a, P: PrimeMover<R>, R: Real>(
    cvt: &'a Cvt<R>,
    input: &'a StepInput<'a, P, R>,
    past: &DrivelineState<R>,
    before: Before<'a, R>,
    belt: &'a mut BeltAtRatio<R>,
    asked: Try<R>,
) -> Step<'a, P, R> {
    (asked.efficiency).vectorize(|| prepared(cvt, input, past, before, belt, asked))
}

#[physics]
fn prepared<'a, P: PrimeMover<R>, R: Real>(
    cvt: &'a Cvt<R>,
    input: &'a StepInput<'a, P, R>,
    past: &DrivelineState<R>,
    before: Before<'a, R>,
    belt: &'a mut BeltAtRatio<R>,
    asked: Try<R>,
) -> Step<'a, P, R> {
    let (oil, friction) = (input.oil, &input.oil.friction);
    let (sump_k, belt_k) = (input.heat.node_k[SUMP], input.heat.node_k[BELT]);
    // At rest nothing slides, and the oil of the belt carries nothing.
    let rests = !input.wheel.wheel_rad_s.gt(0.0).any();
    let [nu_sump, nu_belt] = match rests {
        true => [oil.viscosity.kinematic_m2_s(sump_k), sump_k.splat(0.0)],
        false => oil.viscosity.kinematic_each_m2_s([sump_k, belt_k]),
    };
    let sump = OilState::new(nu_sump, oil.density_kg_m3(sump_k))
        .with_gear_factor(friction.log_gear_factor);
    let eta_belt = nu_belt * oil.density_kg_m3(belt_k);
    let inlet = cvt.pump.with_factor(sump.dynamic_pa_s, sump_k.splat(1.0));
    let route = Route {
        asked,
        last_direction: {
            let kicks = cvt.ratio.route_efficiency.gt(asked.efficiency);
            R::per_lane(|lane| match kicks.lane(lane) {
                true => 0,
                false => *R::get(&before.1.direction, lane),
            })
        },
    };
    let shift = shift(cvt, input, past, before, route);
    if !shift.ratio.bits_eq(belt.geometry.ratio).all() {
        belt.move_to(&cvt.belt, shift.ratio);
    }
    let at = &*belt;
    let behind_rad_s = cvt.final_drive.ratio * input.wheel.wheel_rad_s;
    let over_set = shift.range.as_ref().map(|range| range.mean * behind_rad_s); // RG-1
    let secondary_rad_s = over_set.unwrap_or(behind_rad_s);
    let signals = LockSignals {
        speed_m_s: input.wheel.speed_m_s,
        sump_k,
        output_rad_s: shift.ratio * secondary_rad_s,
        idle_rad_s: input.engine.idle_rad_s(),
        faster_rad_s: past.coupled.select(
            past.closing_rad_s,
            (past.engine_rad_s - shift.primaries[0]).max(0.0),
        ),
        dt_s: input.dt_s,
    };
    let sliding = cvt
        .belt
        .sliding_m_s(shift.ratio, shift.ratio * secondary_rad_s);
    let powers = Powers::new(cvt, at, &sump);
    let films = friction.film_powers(friction.film_loads(eta_belt, sliding));
    Step {
        // The demand of the wheels decides the friction of the teeth (GM-2).
        drive: final_drive(cvt, behind_rad_s, input.wheel.power_w / behind_rad_s, sump),
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
            range: (cvt.ranges.as_deref())
                .zip(shift.range)
                .map(|(set, step)| set.in_oil(step, nu_sump)),
            changes: cvt.changes.as_deref(),
        },
        input,
        secondary_rad_s,
        load: BeltLoad::unloaded(
            friction,
            friction.band_on_film(belt_k, films),
            at.prepared.film_area_m2,
            sliding,
        )
        .with_elements(friction.elements(
            belt_k,
            eta_belt,
            at.geometry.belt_m_s(shift.ratio * secondary_rad_s),
        )),
        shift_flow_m3_s: shift.flow_m3_s,
        clamp_first: !matches!(before.2, Some(hold) if !hold.paced), // PU-7
        searched: (asked.most_flow_m3_s.splat(f64::INFINITY))
            .gt(asked.most_flow_m3_s)
            .any(),
        shift_held: shift.held,
        shifting: shift.kept,
        reach: input.reach(past.engine_rad_s, sump_k.splat(0.0)),
        clamp: before
            .2
            .as_ref()
            .and_then(|hold| hold.clamp.as_ref())
            .unwrap_or(&cvt.clamp),
        pressure_before_pa: past.secondary_pa,
        hold: cvt.coupling.hold(&signals, past.coupled),
        end_rad_s: shift.primaries[1],
        locks: shift.locks,
    }
}
