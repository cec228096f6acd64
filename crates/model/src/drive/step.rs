//! One step of a drive: wheel to fuel, and the heat that results.
//!
//! | label | statement | status |
//! |---|---|---|
//! | SI-1 | crank torque = flywheel torque + accessories + T_k, T_k w = change of rotating energy / dt | derived |
//! | SI-2 | rotating energy = J w2/2 after every step; T_k within the engine's room, drag below and full load above; only what full load cannot give follows later | derived: power is what the shafts pass on |
//! | SI-4 | rotating energy of a slower engine that its drag and load do not take up makes up for a deficit or goes to the brakes, or into a coupling that slips | derived: it comes through the locked clutch to the wheels |
//! | SI-3 | heat: engine to coolant and oil, 70 % of belt loss to the belt, input shaft to the metal, other losses to the sump | fitted share; rest ASSUMED |

use super::row::{Inertia, Input, Solved, row};
use super::stopping::{Stopping, add_start};
use super::{Car, EnergyTerms, Row, State};
use crate::cycle::{GearCommand, Step, Trace};
use crate::engine::start_stop::Electric;
use crate::engine::{Burn, Running};
use crate::flags::Flags;
use crate::math::{clamp, smaller};
use crate::prime_mover::PrimeMover;
use crate::thermal::{BELT, COOLANT, ENGINE_OIL, HeatInput, HeatStep, METAL, NODES, SUMP};
use crate::transmission::component::{ByComponent, Component, HeatTo};
use crate::transmission::cvt::Hold;
use crate::transmission::cvt::selector::SelectorSignals;
use crate::transmission::{StepInput, StepOutput, Transmission, TransmissionState};

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
    /// What is driven, where it is known before.
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

    /// The state after the last step.
    pub fn state(&self) -> State {
        self.state
    }

    /// Drives one step: its row and its energy terms.
    #[inline(always)]
    pub fn step(&mut self, step: &Step) -> (Row, EnergyTerms) {
        let car = self.car;
        let State {
            heat,
            transmission,
            kinetic_j,
            running,
            tyre_k,
            start_stop,
        } = &mut self.state;
        let gear = self.gears.and_then(|g| g.get(step.interval).copied());
        let stopping = Stopping::new(car, self.trace, gear, step, heat, start_stop);
        let engine_off = step.engine_off || stopping.as_ref().is_some_and(Stopping::stopped);
        let wheel = car.road_load.wheel(step, car.tyre.extra_n(*tyre_k));
        *tyre_k = car
            .tyre
            .advance_k(*tyre_k, car.ambient_k, &step.motion, step.dt_s);
        *running = running.started(heat.node_k[COOLANT]);
        if !car.transmission.is_cvt() {
            *running = running.rolled(wheel.wheel_rad_s); // a CVT holds its speed by its ratio
        }
        let mut engine = car.engine.in_step(
            heat.node_k[COOLANT],
            heat.node_k[ENGINE_OIL],
            &car.engine_oil,
            car.charge,
            running,
            step.dt_s,
        );
        if let Some(stopping) = &stopping {
            engine.charging_w = stopping.charging_w(start_stop, step.dt_s);
        }
        let engine = engine;
        let input = StepInput {
            wheel: &wheel,
            engine: &engine,
            oil: &car.oil,
            heat,
            gear,
            dt_s: step.dt_s,
            engine_off,
            neutral_share: neutral_share(car, self.trace, running, transmission, step),
        };
        // Not `get_or_insert_with`, which is a call in every step.
        let transmission = match transmission {
            Some(state) => state,
            none => none.insert(car.transmission.start(&input)),
        };
        if kinetic_j.is_nan() {
            let w = transmission.driveline.engine_rad_s;
            let idling = 0.5 * car.engine.inertia_kg_m2 * w * w;
            *kinetic_j = if step.engine_off { 0.0 } else { idling };
        }
        let mut output = StepOutput::at_rest();
        car.transmission
            .solve_into(&input, transmission, &mut output);
        let mut electric = Electric::default();
        if let Some(stopping) = &stopping {
            electric = stopping.electric(&input, (car, transmission), &mut output, start_stop);
            *kinetic_j += electric.kinetic_w * step.dt_s;
        }
        let mut inertia = inertia(car, &input, &output, *kinetic_j);
        spend(car, &mut output, inertia.surplus_w);
        let mut burn = engine.burn(output.engine_rad_s, inertia.crank_nm);
        if engine_off {
            burn.to_coolant_w = -inertia.kinetic_w; // the engine runs out against its own friction
        }
        // An engine at rest has no rotating energy, not even a rest of rounding.
        *kinetic_j = if output.engine_rad_s <= 0.0 {
            0.0
        } else {
            *kinetic_j + inertia.kinetic_w * step.dt_s
        };
        if electric.kinetic_w > 0.0 {
            inertia.kinetic_w += electric.kinetic_w; // SS-4
            add_start(&mut burn, &electric, car.engine.heating_value_j_kg);
        }
        let power_w = node_power(car, &output, &burn);
        let heat_step = advance(car, power_w, &output, &input, step.motion.speed_power_07);
        let result = row(
            car,
            step,
            &input,
            &Solved {
                output: &output,
                inertia: &inertia,
                burn: &burn,
                power_w,
                heat: &heat_step,
                tyre_k: *tyre_k,
                electric: &electric,
            },
        );
        *heat = heat_step.heat;
        let speeds_rad_s = (output.engine_rad_s, wheel.wheel_rad_s);
        *running = running.after(step.engine_off, step.dt_s, speeds_rad_s);
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

/// Share of a step at rest that the box is in neutral (SE-1, SE-2).
#[inline(always)]
fn neutral_share(
    car: &Car,
    trace: Option<&Trace>,
    running: &Running,
    past: &Option<TransmissionState>,
    step: &Step,
) -> f64 {
    if step.motion.speed_m_s > 0.0 {
        return 0.0; // a car that moves is in drive
    }
    match &car.transmission {
        Transmission::Cvt(cvt) => cvt.selector.neutral_share(&SelectorSignals {
            procedure_s: trace.map_or(0.0, Trace::selector_s),
            running_s: running.since_s,
            rested_s: past.as_ref().map_or(0.0, |past| past.driveline.rested_s),
            dt_s: step.dt_s,
        }),
        Transmission::Manual(_) => 0.0,
    }
}

/// What a slower engine gives beyond its drag and load goes into a coupling that slips, else to the wheels.
#[inline(always)]
fn spend(car: &Car, output: &mut StepOutput, surplus_w: f64) {
    if !output.flags.contains(Flags::CLUTCH_SLIPPING) {
        return give_back(output, surplus_w);
    }
    // A clutch that loses a part only passes on the rest (LC-6).
    let lost = smaller(car.transmission.coupling().loss_factor(), 1.0);
    output.loss_w[Component::LaunchClutch] += lost * surplus_w; // SI-4
    give_back(output, (1.0 - lost) * surplus_w);
}

/// Power of the slower engine that reaches the wheels: it makes up for a deficit, or the brakes take it.
#[inline(always)]
fn give_back(output: &mut StepOutput, surplus_w: f64) {
    let helps_w = smaller(surplus_w, output.deficit_w);
    output.deficit_w -= helps_w;
    output.brake_w += surplus_w - helps_w; // SI-4
}

#[inline(always)]
fn inertia(car: &Car, input: &Input, output: &StepOutput, kinetic_j: f64) -> Inertia {
    let w = output.engine_rad_s;
    if w <= 0.0 {
        return Inertia {
            crank_nm: 0.0,
            accessories_nm: 0.0,
            kinetic_w: -kinetic_j / input.dt_s,
            surplus_w: 0.0,
        };
    }
    let engine = input.engine;
    let accessories_nm = engine.accessories_nm(w);
    let steady = output.shaft_nm + accessories_nm;
    let wanted = (0.5 * car.engine.inertia_kg_m2 * w * w - kinetic_j) / input.dt_s / w;
    // Faster takes what is left below full load, slower what drag is left; never less than nothing.
    let torque = if wanted > 0.0 {
        clamp(engine.full_load_nm(w) - steady, 0.0, wanted) // SI-2
    } else {
        clamp(-(steady + engine.own_drag_nm(w)), wanted, 0.0) // SI-2
    };
    let over = if wanted < 0.0 { torque - wanted } else { 0.0 };
    Inertia {
        crank_nm: steady + torque,
        accessories_nm,
        kinetic_w: smaller(torque, wanted) * w,
        surplus_w: over * w,
    } // SI-1
}

#[inline(always)]
pub(super) fn advance(
    car: &Car,
    power_w: [f64; NODES],
    output: &StepOutput,
    input: &Input,
    speed_power_07: f64,
) -> HeatStep {
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
#[inline(always)]
fn node_power(car: &Car, output: &StepOutput, burn: &Burn) -> [f64; NODES] {
    let mut power = loss_heat_w(car, &output.loss_w);
    power[COOLANT] += burn.to_coolant_w;
    power[ENGINE_OIL] += burn.to_oil_w;
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
#[inline]
pub fn loss_heat_w(car: &Car, loss_w: &ByComponent<f64>) -> [f64; NODES] {
    const BELT_HEAT: [Component; 6] = heating(HeatTo::Belt);
    const METAL_HEAT: [Component; 4] = heating(HeatTo::Metal);
    const COUPLING_HEAT: [Component; 1] = heating(HeatTo::Coupling);
    const SUMP_HEAT: [Component; 7] = heating(HeatTo::Sump);
    // First the sums of what goes the same way.
    let sum = |of: &[Component]| of.iter().fold(0.0, |sum, one| sum + loss_w[*one]);
    let (belt, metal) = (sum(&BELT_HEAT), sum(&METAL_HEAT));
    let (coupling, sump) = (sum(&COUPLING_HEAT), sum(&SUMP_HEAT));
    let mut power = [0.0; NODES];
    power[BELT] = car.belt_heat_share * belt;
    power[METAL] = metal;
    power[SUMP] = sump + (1.0 - car.belt_heat_share) * belt;
    power[if car.transmission.is_cvt() {
        SUMP
    } else {
        COOLANT
    }] += coupling;
    power
}
