//! One step of a drive: wheel to fuel, and the heat that results.
//!
//! | label | statement | status |
//! |---|---|---|
//! | SI-1 | crank torque = flywheel torque + accessories + T_k, T_k w = change of rotating energy / dt | derived |
//! | SI-2 | rotating energy = J w2/2 after every step, w the speed at its end; T_k within the engine's room, drag below and full load above; only what full load cannot give follows later | derived: power is what the shafts pass on |
//! | SI-5 | an engine that wheels turn which are braked, too, takes the energy to turn faster, as after a change down, from what the brakes take, as far as that goes; the rest follows later | derived: the closing clutch pulls it up; it burns nothing for it, whatever the step |
//! | SI-4 | rotating energy of a slower engine that its drag and load do not take up makes up for a deficit or goes to the brakes, or into a coupling that slips | derived: it comes through the locked clutch to the wheels |
//! | TR-3 | m_e dv/dt = F - R, v >= 0 the speed by which the car is slower than its trace, F the force missing at full load, else R = (1/throttle - 1) P/v_0 what full load has left at the engine's speed; v = 0 where no power is asked for; missed where v is above the tolerance of the test | derived: force over mass; a driver who is behind gives full load, and where the trace slows down lets it come to the car; tolerances: 40 CFR 1066.425 (2 mph), UN Regulation 83 and UN GTR 15 (2 km/h), from memory |
//! | SI-3 | heat: engine to coolant and oil, 70 % of belt loss to the belt, input shaft to the metal, other losses to the sump | fitted share; rest ASSUMED |

use super::row::{Inertia, Input, Solved, row};
use super::stopping::{Stopping, add_start};
use super::{Car, EnergyTerms, Row, State};
use crate::cycle::{GearCommand, Step, TOLERANCE_M_S, Trace};
use crate::engine::start_stop::Electric;
use crate::engine::{Burn, EngineAtTemperature, Running};
use crate::flags::Flags;
use crate::math::{Mask, Real, physics};
use crate::prime_mover::PrimeMover;
use crate::road::WheelDemand;
use crate::thermal::{BELT, COOLANT, ENGINE_OIL, Heat, HeatInput, HeatStep, METAL, NODES, SUMP};
use crate::transmission::component::{ByComponent, Component, HeatTo};
use crate::transmission::cvt::Hold;
use crate::transmission::{Driveline, StepInput, StepOutput, Transmission};

/// Rotating energy below 0 that is rounding of the sum of its changes, J: 1e-9 of that at 1000 rpm of a small engine.
const ROUNDING_J: f64 = 1e-6;

/// A car on its way: steps in, rows out, no allocation. [`simulate`](super::simulate) is a loop over [`Drive::step`].
///
/// ```
/// use cvtcycle_config::{cycle::embedded, setup::{Options, load}};
/// use cvtcycle_model::drive::{Drive, State};
///
/// let car = load("rover_216_cvt", &Options::default()).expect("a shipped car").car(263.15);
/// let cycle = embedded("ece15").expect("a shipped cycle");
/// let mut drive = Drive::along(&car, cycle.trace_for(true), State::at(263.15));
/// for step in cycle.trace_for(true).steps(1.0) {
///     let (row, _) = drive.step(&step);
///     assert!(row.power_ledger_error < 1e-9);
/// }
/// assert!(drive.state().heat.node_k.iter().all(|temp_k| *temp_k > 263.15));
/// ```
#[derive(Clone, Debug)]
pub struct Drive<'a> {
    car: &'a Car,
    /// Trace driven, if known before.
    trace: Option<&'a Trace>,
    /// Gears of the cycle, one an interval.
    gears: Option<&'a [GearCommand]>,
    state: State,
}

impl<'a> Drive<'a> {
    /// A car in a state; a manual box shifts by its shift speeds, and start-stop does not know when the car moves again.
    pub fn new(car: &'a Car, state: State) -> Self {
        Drive {
            car,
            trace: None,
            gears: None,
            state,
        }
    }

    /// A car in a state at the beginning of a trace, whose gears a manual box follows.
    pub fn along(car: &'a Car, trace: &'a Trace, state: State) -> Self {
        let gears = match &car.transmission {
            Transmission::Manual(manual) => trace.gears(manual.overall.len()),
            Transmission::Cvt(_) => None,
        };
        Drive {
            trace: Some(trace),
            gears,
            ..Drive::new(car, state)
        }
    }

    /// A car in a state whose manual box follows gears, one an interval.
    pub(super) fn in_gears(car: &'a Car, gears: Option<&'a [GearCommand]>, state: State) -> Self {
        Drive {
            gears,
            ..Drive::new(car, state)
        }
    }

    /// The state after the last step.
    pub fn state(&self) -> State {
        self.state
    }

    /// Drives one step: its row and its energy terms.
    #[physics]
    pub fn step(&mut self, step: &Step) -> (Row, EnergyTerms) {
        let car = self.car;
        let state = &mut self.state;
        let gear = self.gears.and_then(|g| g.get(step.interval).copied());
        let start_stop = &mut state.start_stop;
        let mut stopping = Stopping::new(car, self.trace, gear, step, &state.heat, start_stop);
        let engine_off = step.engine_off || stopping.as_ref().is_some_and(Stopping::stopped);
        // First, so that nothing is between the oils of engine and transmission: a processor works on both at once.
        let mut output = StepOutput::at_rest();
        let wheel = wheel(car, step, &mut state.tyre_k);
        let driven = (state.transmission.as_ref(), gear);
        let mut engine = engine(car, step, &wheel, driven, &state.heat, &mut state.running);
        if let Some(stopping) = &mut stopping {
            let at = (wheel.power_w, state.running.speed_rad_s);
            engine.charging_w = stopping.charging_w(&engine, at, start_stop, step.dt_s);
        }
        let engine = engine;
        let mut input = StepInput {
            wheel: &wheel,
            engine: &engine,
            oil: &car.oil,
            heat: &state.heat,
            gear,
            dt_s: step.dt_s,
            engine_off,
            neutral_share: car.transmission.neutral_share(
                state.transmission.as_ref(),
                self.trace,
                step,
                state.running.since_s,
            ),
            kinetic_j: state.kinetic_j,
        };
        let transmission = begun(
            car,
            step,
            &input,
            &mut state.transmission,
            &mut state.kinetic_j,
        );
        input.kinetic_j = state.kinetic_j;
        car.transmission
            .solve_into(&input, transmission, &mut output);
        let mut electric = Electric::default();
        if let Some(stopping) = &stopping {
            electric = stopping.electric(&input, (car, transmission), &mut output, start_stop);
            state.kinetic_j += electric.kinetic_w * step.dt_s;
        }
        let past = Past {
            kinetic_j: &mut state.kinetic_j,
            running: &mut state.running,
            tyre_k: state.tyre_k,
            behind_m_s: &mut state.behind_m_s,
            tolerance_m_s: self.trace.map_or(TOLERANCE_M_S, Trace::tolerance_m_s),
        };
        let (result, heat) = end(car, step, &input, (&mut output, &electric), past);
        state.heat = heat;
        result
    }

    /// The same with a CVT that is held at a ratio and a clamp law: any controller drives some sequence of these (RC-12). The first step of a
    /// drive, which begins the box, has nothing to hold.
    pub fn step_held(&mut self, step: &Step, hold: &Hold) -> (Row, EnergyTerms) {
        let transmission = self.state.transmission.as_mut();
        if let Some(own) = transmission.and_then(|own| own.cvt.as_mut()) {
            own.hold = Some(*hold);
        }
        self.step(step)
    }
}

/// Computes the demand of a step at the wheels; the tyres warm up meanwhile.
#[physics]
pub(super) fn wheel<R: Real, T>(car: &Car<R, T>, step: &Step, tyre_k: &mut R) -> WheelDemand<R> {
    let wheel = car.road_load.wheel(step, car.tyre.extra_n(*tyre_k));
    *tyre_k = car
        .tyre
        .advance_k(*tyre_k, car.ambient_k, &step.motion, step.dt_s);
    wheel
}

/// The engine at the beginning of a step, after what it did before.
#[physics]
pub(super) fn engine<'a, R: Real, T: Driveline<R>>(
    car: &'a Car<R, T>,
    step: &Step,
    wheel: &WheelDemand<R>,
    (transmission, gear): (Option<&T::State>, Option<GearCommand>),
    heat: &Heat<R>,
    running: &mut Running<R>,
) -> EngineAtTemperature<'a, R> {
    *running = running.started(heat.node_k[COOLANT]);
    let over_mean = wheel.ends_over_mean(step.dt_s);
    let own_rad_s = running.speed_rad_s;
    let speeds_rad_s =
        (car.transmission).overrun_rad_s(transmission, (wheel, over_mean), gear, own_rad_s);
    *running = running.turning(speeds_rad_s);
    car.engine.in_step(
        heat.node_k[COOLANT],
        heat.node_k[ENGINE_OIL],
        &car.engine_oil,
        car.charge,
        running,
        step.dt_s,
    )
}

/// The transmission in a step; before its first one it begins, and with it the rotating energy.
#[physics]
pub(super) fn begun<'s, R: Real, T: Driveline<R>>(
    car: &Car<R, T>,
    step: &Step,
    input: &Input<R>,
    transmission: &'s mut Option<T::State>,
    kinetic_j: &mut R,
) -> &'s mut T::State {
    // Not `get_or_insert_with`, which is a call in every step.
    let transmission = match transmission {
        Some(state) => state,
        none => none.insert(car.transmission.start(input)),
    };
    let known = kinetic_j.ge(*kinetic_j);
    if !known.all() {
        let w = T::engine_rad_s(transmission);
        let idling = 0.5 * car.engine.inertia_kg_m2 * w * w;
        let start_j = if step.engine_off {
            w.splat(0.0)
        } else {
            idling
        };
        *kinetic_j = known.select(*kinetic_j, start_j);
    }
    transmission
}

/// Parts of the state that the end of a step brings forward.
pub(super) struct Past<'s, R: Real = f64> {
    pub kinetic_j: &'s mut R,
    pub running: &'s mut Running<R>,
    /// Temperature of the tyres, K.
    pub tyre_k: R,
    pub behind_m_s: &'s mut R,
    /// Speed by which a car may be slower than its trace, m/s.
    pub tolerance_m_s: f64,
}

/// Completes a step from its solved transmission: row, energy terms, temperatures after the step, rotating energy and state of the engine.
#[physics]
pub(super) fn end<R: Real, T: Driveline<R>>(
    car: &Car<R, T>,
    step: &Step,
    input: &Input<R>,
    (output, electric): (&mut StepOutput<R>, &Electric<R>),
    past: Past<R>,
) -> ((Row<R>, EnergyTerms<R>), Heat<R>) {
    let Past {
        kinetic_j,
        running,
        tyre_k,
        ..
    } = past;
    let mut inertia = inertia(car, input, output, *kinetic_j);
    spend(car, output, inertia.surplus_w);
    output.brake_w = output.brake_w - inertia.from_wheels_w;
    let mut burn = input.engine.burn(output.engine_rad_s, inertia.crank_nm);
    if input.engine_off {
        burn.to_coolant_w = -inertia.kinetic_w; // the engine runs out against its own friction
    }
    // An engine at rest has no rotating energy, not even a rest of rounding.
    let zero = output.engine_rad_s.splat(0.0);
    let rests = zero.ge(output.engine_rad_s);
    let turning_j = *kinetic_j + inertia.kinetic_w * step.dt_s;
    // Rounding below 0 only: a negative or missing energy is left for PX-4 to find.
    let is_rounding = turning_j.ge(-ROUNDING_J) & !turning_j.ge(0.0);
    *kinetic_j = (rests | is_rounding).select(zero, turning_j);
    let cranked = electric.kinetic_w.gt(0.0);
    if cranked.any() {
        inertia.kinetic_w = inertia.kinetic_w + electric.kinetic_w; // SS-4
        add_start(&mut burn, electric, car.engine.heating_value_j_kg);
    }
    let power_w = node_power(car, output, &burn);
    *past.behind_m_s = behind_m_s(car, input, output, *past.behind_m_s);
    let heat_step = advance(car, power_w, output, input, step.motion.speed_power_07);
    let result = row(
        car.transmission.is_cvt(),
        step,
        input,
        &Solved {
            output,
            inertia: &inertia,
            burn: &burn,
            power_w,
            heat: &heat_step,
            tyre_k,
            electric,
            behind_m_s: *past.behind_m_s,
            tolerance_m_s: past.tolerance_m_s,
        },
    );
    *running = running.after(step.engine_off, step.dt_s, output.end_rad_s);
    (result, heat_step.heat)
}

/// Speed by which the car is slower than its trace after a step, m/s (TR-3).
#[physics]
fn behind_m_s<R: Real, T>(
    car: &Car<R, T>,
    input: &Input<R>,
    output: &StepOutput<R>,
    before_m_s: R,
) -> R {
    let zero = before_m_s.splat(0.0);
    let lacks = output.has(Flags::FULL_LOAD) & output.deficit_w.gt(0.0);
    if !(lacks | before_m_s.gt(0.0)).any() {
        return zero;
    }
    let power_w = input.wheel.power_w;
    let left_w = power_w * (1.0 / output.throttle - 1.0);
    let missing_w = lacks.select(output.deficit_w, -left_w);
    let by_m_s = missing_w / input.wheel.speed_m_s * input.dt_s / car.road_load.inertia_kg;
    power_w.gt(0.0).select((before_m_s + by_m_s).max(0.0), zero) // TR-3
}

/// Rotating energy of a slowing engine beyond its drag and load goes into a coupling that slips, else to the wheels.
#[physics]
fn spend<R: Real, T: Driveline<R>>(car: &Car<R, T>, output: &mut StepOutput<R>, surplus_w: R) {
    let slips = output.has(Flags::CLUTCH_SLIPPING);
    if !slips.any() {
        return give_back(output, surplus_w);
    }
    // A clutch that loses a part only passes on the rest (LC-6).
    let lost = match car.transmission.coupling_factor() {
        Some(factor) => factor.min(1.0),
        None => surplus_w.splat(1.0),
    };
    let launch_w = output.loss_w[Component::LaunchClutch];
    output.loss_w[Component::LaunchClutch] = slips.select(launch_w + lost * surplus_w, launch_w); // SI-4
    give_back(output, slips.select((1.0 - lost) * surplus_w, surplus_w));
}

/// Power of the slower engine that reaches the wheels: it makes up for a deficit, or the brakes take it.
#[physics]
fn give_back<R: Real>(output: &mut StepOutput<R>, surplus_w: R) {
    let helps_w = surplus_w.min(output.deficit_w);
    output.deficit_w = output.deficit_w - helps_w;
    output.brake_w = output.brake_w + (surplus_w - helps_w); // SI-4
}

#[physics]
fn inertia<R: Real, T>(
    car: &Car<R, T>,
    input: &Input<R>,
    output: &StepOutput<R>,
    kinetic_j: R,
) -> Inertia<R> {
    let w = output.engine_rad_s;
    let zero = w.splat(0.0);
    let rests = zero.ge(w);
    let stopped_w = -kinetic_j * input.dt_s.recip();
    if rests.all() {
        return Inertia {
            crank_nm: zero,
            accessories_nm: zero,
            kinetic_w: stopped_w,
            from_wheels_w: zero,
            surplus_w: zero,
        };
    }
    let engine = input.engine;
    let accessories_nm = engine.accessories_nm(w);
    let steady = output.shaft_nm + accessories_nm;
    let end = output.end_rad_s;
    let wanted = (0.5 * car.engine.inertia_kg_m2 * end * end - kinetic_j) / (input.dt_s * w);
    // Faster takes what is left below full load, slower what drag is left; never less than nothing.
    let (faster, slower) = (wanted.gt(0.0), zero.gt(wanted));
    let (mut torque, mut from_wheels_w) = (zero, zero);
    if faster.any() {
        let braked = zero.gt(output.shaft_nm) & output.brake_w.gt(0.0) & faster;
        from_wheels_w = braked.select(output.brake_w.min(wanted * w), zero); // SI-5
        let fired_nm = (engine.full_load_nm(w) - steady).clamp(0.0, wanted); // SI-2
        torque = braked.select(zero, fired_nm);
    }
    if !faster.all() {
        let braking = (-(steady + engine.own_drag_nm(w))).clamp(wanted, 0.0); // SI-2
        torque = faster.select(torque, braking);
    }
    let over = slower.select(torque - wanted, zero);
    Inertia {
        crank_nm: rests.select(zero, steady + torque),
        accessories_nm: rests.select(zero, accessories_nm),
        kinetic_w: rests.select(stopped_w, torque.min(wanted) * w + from_wheels_w),
        from_wheels_w: rests.select(zero, from_wheels_w),
        surplus_w: rests.select(zero, over * w),
    } // SI-1
}

#[physics]
pub(super) fn advance<R: Real, T>(
    car: &Car<R, T>,
    power_w: [R; NODES],
    output: &StepOutput<R>,
    input: &Input<R>,
    speed_power_07: f64,
) -> HeatStep<R> {
    let sump_k = input.heat.node_k[SUMP];
    let oil_volume_heat_j_m3k = car.oil.density_kg_m3(sump_k) * car.oil.heat_capacity_j_kgk(sump_k);
    car.network.advance_in_wind(
        input.heat,
        &HeatInput {
            power_w,
            ambient_k: car.ambient_k,
            speed_m_s: input.wheel.speed_m_s,
            pump_rad_s: output.engine_rad_s,
            oil_flow_m3_s: output.oil_flow_m3_s,
            oil_volume_heat_j_m3k,
            running: !input.engine_off,
            dt_s: input.dt_s,
        },
        speed_power_07,
    )
}

/// Heat into each node, W (SI-3).
#[physics]
fn node_power<R: Real, T: Driveline<R>>(
    car: &Car<R, T>,
    output: &StepOutput<R>,
    burn: &Burn<R>,
) -> [R; NODES] {
    let mut power = loss_heat_w(car, &output.loss_w);
    power[COOLANT] = power[COOLANT] + burn.to_coolant_w;
    power[ENGINE_OIL] = power[ENGINE_OIL] + burn.to_oil_w;
    power
}

/// The components whose heat goes the same way; how many there are is checked when this is compiled.
const fn heating<const COUNT: usize>(to: HeatTo) -> [Component; COUNT] {
    let mut found = [Component::LaunchClutch; COUNT];
    let (mut number, mut count) = (0, 0);
    while number < Component::COUNT {
        let component = Component::ALL[number];
        if component.heat() as u8 == to as u8 {
            found[count] = component;
            count += 1;
        }
        number += 1;
    }
    assert!(count == COUNT);
    found
}

/// Heat that the transmission's losses, W, put into each node, W (SI-3).
#[physics]
pub fn loss_heat_w<R: Real, T: Driveline<R>>(
    car: &Car<R, T>,
    loss_w: &ByComponent<R>,
) -> [R; NODES] {
    const BELT_HEAT: [Component; 8] = heating(HeatTo::Belt);
    const METAL_HEAT: [Component; 4] = heating(HeatTo::Metal);
    const COUPLING_HEAT: [Component; 1] = heating(HeatTo::Coupling);
    const SUMP_HEAT: [Component; 8] = heating(HeatTo::Sump);
    // First the sums of what goes the same way.
    let zero = car.belt_heat_share.splat(0.0);
    // Written out, so that the sums stay in registers.
    macro_rules! sum {
        ($components:ident: $($place:literal)*) => {
            zero $(+ loss_w[$components[$place]])*
        };
    }
    let belt = sum!(BELT_HEAT: 0 1 2 3 4 5 6 7);
    let metal = sum!(METAL_HEAT: 0 1 2 3);
    let coupling = sum!(COUPLING_HEAT: 0);
    let sump = sum!(SUMP_HEAT: 0 1 2 3 4 5 6 7);
    let mut power = [zero; NODES];
    power[BELT] = car.belt_heat_share * belt;
    power[METAL] = metal;
    power[SUMP] = sump + (1.0 - car.belt_heat_share) * belt;
    let node = if car.transmission.is_cvt() {
        SUMP
    } else {
        COOLANT
    };
    power[node] = power[node] + coupling;
    power
}
