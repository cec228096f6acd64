//! Several cars through one cycle in lockstep: one text of the physics, a car in each lane.
//!
//! Each run has the bits that [`drive_into`](super::drive_into) gives it alone. Cars can be in one group that are of one kind (see
//! [`Gather::alike`]) and drive the same trace; those with start-stop, with a slip-limited clamp or with a shift map drive alone. A run that fails keeps its numbers that are none to itself.

#![cfg_attr(
    not(any(
        target_arch = "x86",
        target_arch = "x86_64",
        target_arch = "aarch64",
        all(target_arch = "wasm32", target_feature = "simd128")
    )),
    allow(dead_code, unused_imports, reason = "no lanes: see HAS_LANES")
)]

use std::borrow::Cow;

use super::run::{Conditions, Outcome, Start, drive_into, own_trace};
use super::simulate::{Recorder, State};
use super::step::{Past, begun, end, engine, wheel};
use super::{Car, CarTrace, EnergyTerms, Row, Totals, Vehicle};
use crate::cycle::{Cycle, GearCommand, Step, Trace};
use crate::engine::start_stop::Electric;
use crate::math::{Gather, Level, Real, Simd, four, physics};
use crate::thermal::Heat;
use crate::transmission::cvt::Cvt;
use crate::transmission::manual::Manual;
use crate::transmission::{Driveline, StepInput, StepOutput, Transmission};

/// One run of many on a cycle.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The car.
    pub vehicle: &'a Vehicle,
    /// How it is driven.
    pub conditions: Conditions,
}

/// Drives runs through a cycle, side by side where they can be; what comes of each, in their order. No rows are kept.
pub fn drive_each(runs: &[Run], cycle: &Cycle) -> Vec<Outcome> {
    drive_each_on(Level::new(), runs, cycle)
}

/// The same with the instructions of a level.
pub fn drive_each_on(level: Level, runs: &[Run], cycle: &Cycle) -> Vec<Outcome> {
    if !HAS_LANES {
        let alone = |run: &Run| drive_into(run.vehicle, cycle, &run.conditions, None);
        return runs.iter().map(alone).collect();
    }
    let mut left: Vec<(usize, Prepared)> = runs
        .iter()
        .map(|run| Prepared::new(run, cycle))
        .enumerate()
        .collect();
    let mut outcomes: Vec<(usize, Outcome)> = Vec::with_capacity(runs.len());
    while !left.is_empty() {
        let (group, others) = take_group(left, width(level));
        left = others;
        let (places, group): (Vec<usize>, Vec<Prepared>) = group.into_iter().unzip();
        let side_by_side = match group.as_slice() {
            [_] => None,
            group => together(level, group, cycle.phases.len()),
        };
        let alone = || group.iter().map(Prepared::alone).collect();
        let driven: Vec<Outcome> = side_by_side.unwrap_or_else(alone);
        outcomes.extend(places.into_iter().zip(driven));
    }
    outcomes.sort_by_key(|(place, _)| *place);
    outcomes.into_iter().map(|(_, outcome)| outcome).collect()
}

/// A run with its place among those that were asked for.
type Placed<'a> = (usize, Prepared<'a>);

/// The first run with those that can be in one group with it, up to `most` in all, and the others in their order.
fn take_group(runs: Vec<Placed>, most: usize) -> (Vec<Placed>, Vec<Placed>) {
    let mut group: Vec<Placed> = Vec::with_capacity(most);
    let mut others = Vec::new();
    for run in runs {
        let joins = match group.first() {
            Some((_, first)) => group.len() < most && first.groups_with(&run.1),
            None => true,
        };
        if joins {
            group.push(run);
        } else {
            others.push(run);
        }
    }
    (group, others)
}

/// Most runs that are side by side.
pub const MAX_TOGETHER: usize = 8;

/// True in a build for processors that may have vectors. The simulator of a page leaves the lanes out, which would only enlarge it.
const HAS_LANES: bool = cfg!(any(
    target_arch = "x86",
    target_arch = "x86_64",
    target_arch = "aarch64",
    all(target_arch = "wasm32", target_feature = "simd128")
));

/// How many runs are side by side at a level: eight pay with the wide vectors of newer processors.
fn width(level: Level) -> usize {
    #[cfg(all(
        any(target_arch = "x86", target_arch = "x86_64"),
        not(debug_assertions)
    ))]
    if level.as_avx2().is_some() {
        return MAX_TOGETHER;
    }
    let _ = level;
    4
}

/// A run with its car for its ambient and its trace.
struct Prepared<'a> {
    run: &'a Run<'a>,
    cycle: &'a Cycle,
    car: Car,
    trace: Cow<'a, Trace>,
    schedule: &'static str,
}

impl<'a> Prepared<'a> {
    fn new(run: &'a Run, cycle: &'a Cycle) -> Self {
        let CarTrace { trace, schedule } = run.vehicle.trace(cycle);
        let car = run.vehicle.car(run.conditions.ambient_k);
        let trace = match trace {
            Cow::Borrowed(trace) => own_trace(&car, trace),
            Cow::Owned(trace) => Cow::Owned(own_trace(&car, &trace).into_owned()),
        };
        Prepared {
            run,
            cycle,
            car,
            trace,
            schedule,
        }
    }

    /// The run by itself.
    fn alone(&self) -> Outcome {
        drive_into(self.run.vehicle, self.cycle, &self.run.conditions, None)
    }

    /// The manual box, if the car has one.
    fn manual(&self) -> Option<&Manual> {
        match &self.car.transmission {
            Transmission::Manual(manual) => Some(manual),
            Transmission::Cvt(_) => None,
        }
    }

    /// The CVT, if the car has one.
    fn cvt(&self) -> Option<&Cvt> {
        match &self.car.transmission {
            Transmission::Cvt(cvt) => Some(cvt),
            Transmission::Manual(_) => None,
        }
    }

    /// True for a car that drives alone: with start-stop, or where each run would search its own way through its clamp law or shift map.
    fn is_alone(&self) -> bool {
        let searches = self.cvt().is_some_and(Cvt::searches);
        self.car.engine.start_stop.is_some() || searches
    }

    /// True if another run can join the group of this one.
    fn groups_with(&self, other: &Self) -> bool {
        let boxes = match (&self.car.transmission, &other.car.transmission) {
            (Transmission::Manual(own), Transmission::Manual(others)) => own.groups_with(others),
            (Transmission::Cvt(own), Transmission::Cvt(others)) => own.groups_with(others),
            _ => false,
        };
        let (a, b) = (&self.car, &other.car);
        let (from, to) = (&self.run.conditions, &other.run.conditions);
        let same_trace = match (&self.trace, &other.trace) {
            (Cow::Borrowed(a), Cow::Borrowed(b)) => std::ptr::eq(*a, *b),
            (a, b) => a == b,
        };
        !self.is_alone()
            && same_trace
            && from.max_dt_s.to_bits() == to.max_dt_s.to_bits()
            && matches!(from.start, Start::Warm) == matches!(to.start, Start::Warm)
            && boxes
            && a.engine.groups_with(&b.engine)
            && a.network.groups_with(&b.network)
            && a.oil.groups_with(&b.oil)
            && a.engine_oil.groups_with(&b.engine_oil)
    }
}

/// Drives a group of runs that are alike; nothing on a processor without vectors.
///
/// Each level and width is code of its own, and costs building time: only the levels are here that make a difference. With checks for debugging there
/// is one, of four lanes; the bits are the same.
#[physics]
#[inline(never)]
fn together(level: Level, group: &[Prepared], phases: usize) -> Option<Vec<Outcome>> {
    #[cfg(all(
        any(target_arch = "x86", target_arch = "x86_64"),
        not(debug_assertions)
    ))]
    {
        if let Some(simd) = level.as_avx512() {
            return Some(simd.vectorize(|| in_lanes(crate::math::eight(simd), group, phases)));
        }
        if let Some(simd) = level.as_avx2() {
            return Some(simd.vectorize(|| in_lanes(crate::math::eight(simd), group, phases)));
        }
    }
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(simd) = level.as_sse2() {
        return Some(simd.vectorize(|| in_lanes(four(simd), group, phases)));
    }
    #[cfg(target_arch = "aarch64")]
    if let Some(simd) = level.as_neon() {
        return Some(simd.vectorize(|| in_lanes(four(simd), group, phases)));
    }
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    if let Some(simd) = level.as_wasm_simd128() {
        return Some(simd.vectorize(|| in_lanes(four(simd), group, phases)));
    }
    let _ = (level, group, phases);
    None
}

/// A group in the lanes of a number; a lane without a run repeats the last one.
#[physics]
fn in_lanes<R: Real>(like: R, group: &[Prepared], phases: usize) -> Vec<Outcome> {
    let of_lane: Vec<&Prepared> = (0..R::LANES)
        .map(|lane| &group[lane.min(group.len() - 1)])
        .collect();
    let manual: Option<Vec<&Manual>> = of_lane.iter().map(|run| run.manual()).collect();
    let cvt: Option<Vec<&Cvt>> = of_lane.iter().map(|run| run.cvt()).collect();
    if let Some(manual) = manual {
        let car = gathered(like, &of_lane, Manual::gather(like, &manual));
        let gears = group[0].trace.gears(car.transmission.overall.len());
        in_cars(like, (&car, gears), &of_lane, (group, phases))
    } else if let Some(cvt) = cvt {
        let car = gathered(like, &of_lane, Cvt::gather(like, &cvt));
        in_cars(like, (&car, None), &of_lane, (group, phases))
    } else {
        Vec::new() // no group holds boxes of both kinds
    }
}

/// Drives the cars of a group, gathered, with the gears that the cycle prescribes.
#[physics]
fn in_cars<R: Real, T: Driveline<R>>(
    like: R,
    (car, gears): (&Car<R, T>, Option<&[GearCommand]>),
    of_lane: &[&Prepared],
    (group, phases): (&[Prepared], usize),
) -> Vec<Outcome> {
    let trace = &*group[0].trace;
    let (conditions, max_dt_s) = (group[0].run.conditions, group[0].run.conditions.max_dt_s);
    // Every lane begins as a run alone begins; a warm start drives there itself, from ambient.
    let begins = |lane: usize| {
        let conditions = &of_lane[lane].run.conditions;
        let ambient_k = conditions.ambient_k;
        match conditions.start {
            Start::At(temp_k) => (Heat::uniform(temp_k), temp_k),
            Start::Soak | Start::Warm => (Heat::uniform(ambient_k), ambient_k),
            Start::Nodes(nodes) => nodes.at(ambient_k),
        }
    };
    let mut state = State::at(like.map_lanes(|lane| begins(lane).1));
    state.heat.node_k =
        std::array::from_fn(|node| like.map_lanes(|lane| begins(lane).0.node_k[node]));
    let mut totals = Totals::like(like, phases);
    let passes = match conditions.start {
        Start::Warm => 2,
        Start::Soak | Start::At(_) | Start::Nodes(_) => 1,
    };
    // One call, so that the step is there once; what a first pass sums up is dropped.
    for _ in 0..passes {
        state.transmission = None;
        totals = Totals::like(like, phases);
        simulate_together(car, (trace, gears), max_dt_s, &mut state, &mut totals);
    }
    (0..group.len())
        .map(|lane| Outcome {
            totals: totals.of_run(lane),
            rows: Vec::new(),
            end: Heat {
                node_k: state.heat.node_k.map(|temp_k| temp_k.lane(lane)),
            },
            gear_schedule: group[lane].schedule,
        })
        .collect()
}

/// The cars of a group as one, with their transmission.
fn gathered<R: Real, T>(like: R, of: &[&Prepared], transmission: T) -> Car<R, T> {
    fn part<R: Real, P: Gather>(like: R, of: &[&Prepared], part: fn(&Car) -> &P) -> P::Together<R> {
        let parts: Vec<&P> = of.iter().map(|run| part(&run.car)).collect();
        P::gather(like, &parts)
    }
    Car {
        name: of[0].car.name.clone(),
        road_load: part(like, of, |car| &car.road_load),
        tyre: part(like, of, |car| &car.tyre),
        transmission,
        engine: part(like, of, |car| &car.engine),
        network: part(like, of, |car| &car.network),
        oil: part(like, of, |car| &car.oil),
        engine_oil: part(like, of, |car| &car.engine_oil),
        ambient_k: part(like, of, |car| &car.ambient_k),
        charge: part(like, of, |car| &car.charge),
        belt_heat_share: part(like, of, |car| &car.belt_heat_share),
    }
}

/// Drives a trace with its gears from a state on. No allocation a step.
#[physics]
fn simulate_together<R: Real, T: Driveline<R>>(
    car: &Car<R, T>,
    (trace, gears): (&Trace, Option<&[GearCommand]>),
    max_dt_s: f64,
    state: &mut State<R, T::State>,
    recorder: &mut impl Recorder<R>,
) {
    trace.for_each_step(max_dt_s, |step| {
        let gear = gears.and_then(|gears| gears.get(step.interval).copied());
        let (row, terms) = drive_step(car, trace, &step, gear, state);
        recorder.record(&row, &terms);
    });
}

/// One step of cars without start-stop.
#[physics]
fn drive_step<R: Real, T: Driveline<R>>(
    car: &Car<R, T>,
    trace: &Trace,
    step: &Step,
    gear: Option<GearCommand>,
    state: &mut State<R, T::State>,
) -> (Row<R>, EnergyTerms<R>) {
    let zero = state.tyre_k.splat(0.0);
    let mut output = StepOutput::like(zero); // first, as in `Drive::step`
    let wheel = wheel(car, step, &mut state.tyre_k);
    let driven = (state.transmission.as_ref(), gear);
    let engine = engine(car, step, &wheel, driven, &state.heat, &mut state.running);
    let mut input = StepInput {
        wheel: &wheel,
        engine: &engine,
        oil: &car.oil,
        heat: &state.heat,
        gear,
        dt_s: step.dt_s,
        engine_off: step.engine_off,
        neutral_share: car.transmission.neutral_share(
            state.transmission.as_ref(),
            Some(trace),
            step,
            state.running.since_s,
        ),
        kinetic_j: state.kinetic_j,
    };
    let (own, kinetic_j) = (&mut state.transmission, &mut state.kinetic_j);
    let transmission = begun(car, step, &input, own, kinetic_j);
    input.kinetic_j = state.kinetic_j;
    zero.vectorize(|| {
        car.transmission
            .solve_into(&input, transmission, &mut output)
    });
    let past = Past {
        kinetic_j: &mut state.kinetic_j,
        running: &mut state.running,
        tyre_k: state.tyre_k,
        behind_m_s: &mut state.behind_m_s,
        tolerance_m_s: trace.tolerance_m_s(),
    };
    let electric = Electric::none(zero);
    let (result, heat) = end(car, step, &input, (&mut output, &electric), past);
    state.heat = heat;
    result
}
