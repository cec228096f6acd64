//! The loop: cycle step by step, wheel to fuel, and the heat that comes of it. No I/O, no allocation a step, no failure.
//!
//! | label | statement | status |
//! |---|---|---|
//! | SI-1 | crank torque = flywheel torque + accessories + T_k, T_k w = change of rotating energy / dt | derived |
//! | SI-2 | T_k within the engine's room (drag below, full load above) and its largest value; rotating energy follows later otherwise | ASSUMED: a clutch slips in a shift; keeps the inertia bounded for any step |
//! | SI-4 | braking with the clutch locked, rotating energy that the engine cannot take up goes to the brakes | derived |
//! | SI-3 | heat: engine to coolant and oil, 70 % of belt loss to the belt, input shaft to the metal, other losses to the sump | fitted share; rest ASSUMED |

use crate::cycle::Trace;
use crate::drive::{Component, Flags, Row, Terms};
use crate::engine::{Burn, Engine};
use crate::fluid::Lubricant;
use crate::math::held;
use crate::road::RoadLoad;
use crate::thermal::{
    BELT, COOLANT, ENGINE_OIL, Heat, HeatInput, HeatStep, METAL, NODES, Network, SUMP,
};
use crate::transmission::{Drive, DriveState, Surroundings, Transmission};

/// A car ready to drive: every part checked, for one ambient.
#[derive(Clone, Debug)]
pub struct Car {
    /// Name of the vehicle file.
    pub name: String,
    /// Road load for the ambient.
    pub road_load: RoadLoad,
    /// Transmission.
    pub transmission: Transmission,
    /// Engine.
    pub engine: Engine,
    /// Thermal network.
    pub network: Network,
    /// Transmission oil.
    pub oil: Lubricant,
    /// Engine oil.
    pub engine_oil: Lubricant,
    /// Ambient temperature, K.
    pub ambient_k: f64,
    /// Full-load factor of altitude.
    pub full_load_factor: f64,
    /// Share of belt loss that heats the belt node.
    pub belt_heat_share: f64,
}

/// What a run carries from step to step.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Temperatures.
    pub heat: Heat,
    /// Driveline.
    pub drive: Option<DriveState>,
    /// Rotating energy of engine and primary side, J.
    pub kinetic_j: f64,
}

impl State {
    /// Everything at one temperature, engine at idle.
    #[must_use]
    pub fn at(temp_k: f64) -> Self {
        State {
            heat: Heat::uniform(temp_k),
            drive: None,
            kinetic_j: f64::NAN,
        }
    }
}

/// Takes the rows as they come.
pub trait Recorder {
    /// One row and its ledger terms.
    fn record(&mut self, row: &Row, terms: &Terms);
}

/// Drives a trace from a state, gives every row to the recorder and returns the state at the end.
///
/// What a recorder does not look at is not computed: rows are built in place and seen through by the compiler.
pub fn simulate(
    car: &Car,
    trace: &Trace,
    max_dt_s: f64,
    start: State,
    recorder: &mut impl Recorder,
) -> State {
    let State {
        mut heat,
        mut drive,
        mut kinetic_j,
    } = start;
    let gears = match &car.transmission {
        Transmission::Manual(manual) => trace.gears(manual.overall.len()),
        Transmission::Cvt(_) => None,
    };
    let unlike = car.engine.unlike_reference(&car.engine_oil);
    trace.for_each_step(max_dt_s, |step| {
        let wheel = car.road_load.wheel(&step);
        let engine = car.engine.at_temperatures(
            heat.node_k[COOLANT],
            heat.node_k[ENGINE_OIL],
            unlike,
            car.full_load_factor,
        );
        let around = Surroundings {
            wheel: &wheel,
            engine: &engine,
            oil: &car.oil,
            heat: &heat,
            gear: gears.map(|g| g[step.interval]),
            dt_s: step.dt_s,
            engine_off: step.engine_off,
        };
        let memory = drive.get_or_insert_with(|| car.transmission.start(&around));
        if kinetic_j.is_nan() {
            let begun = 0.5
                * car.engine.inertia_kg_m2
                * memory.past.engine_rad_s
                * memory.past.engine_rad_s;
            kinetic_j = if step.engine_off { 0.0 } else { begun };
        }
        let mut drive = car.transmission.solve(&around, memory);
        let inertia = inertia(car, &around, &drive, kinetic_j, memory.past.coupled);
        drive.brake_w += inertia.to_brake_w;
        let mut burn = engine.burn(drive.engine_rad_s, inertia.crank_nm);
        if step.engine_off {
            burn.to_coolant_w = -inertia.kinetic_w; // the engine runs out against its own friction
        }
        let drive_stands = drive.engine_rad_s <= 0.0;
        let power_w = node_power(car, &drive, &burn);
        let heat_step = advance(car, power_w, &drive, (&around, step.motion.speed_power_07));
        let (row, terms) = row(
            car,
            &step,
            &around,
            &Answer {
                drive: &drive,
                inertia: &inertia,
                burn: &burn,
                power_w,
                heat: &heat_step,
            },
        );
        recorder.record(&row, &terms);
        heat = heat_step.heat;
        // What stands has none, not even a rest of rounding.
        kinetic_j = if drive_stands {
            0.0
        } else {
            kinetic_j + inertia.kinetic_w * step.dt_s
        };
    });
    State {
        heat,
        drive,
        kinetic_j,
    }
}

/// Rotating energy and crank torque of a step.
struct Inertia {
    crank_nm: f64,
    accessories_nm: f64,
    kinetic_w: f64,
    /// Rotating energy that the brakes take up with the car's (SI-4).
    to_brake_w: f64,
}

#[inline(always)]
fn inertia(
    car: &Car,
    around: &Surroundings,
    drive: &Drive,
    kinetic_j: f64,
    coupled: bool,
) -> Inertia {
    let w = drive.engine_rad_s;
    if w <= 0.0 {
        return Inertia {
            crank_nm: 0.0,
            accessories_nm: 0.0,
            kinetic_w: -kinetic_j / around.dt_s,
            to_brake_w: 0.0,
        };
    }
    let engine = around.engine;
    let accessories_nm = engine.accessories_nm(w);
    let steady = drive.shaft_nm + accessories_nm;
    let wanted = (0.5 * car.engine.inertia_kg_m2 * w * w - kinetic_j) / around.dt_s / w;
    let bound = car.engine.inertia_torque_nm;
    // Faster takes what is left below full load, slower what drag is left; never less than nothing, never more than the bound.
    let torque = if wanted > 0.0 {
        held(
            engine.full_load_nm(w) - steady,
            0.0,
            if wanted < bound { wanted } else { bound },
        ) // SI-2
    } else {
        held(
            -(steady + engine.drag_nm(w)),
            if wanted > -bound { wanted } else { -bound },
            0.0,
        ) // SI-2
    };
    let over = if coupled && drive.brake_w > 0.0 && wanted < torque {
        torque - wanted
    } else {
        0.0
    };
    Inertia {
        crank_nm: steady + torque,
        accessories_nm,
        kinetic_w: (torque - over) * w,
        to_brake_w: over * w,
    } // SI-1, SI-4
}

#[inline(always)]
fn advance(
    car: &Car,
    power_w: [f64; NODES],
    drive: &Drive,
    (around, speed_power_07): (&Surroundings, f64),
) -> HeatStep {
    let sump_k = around.heat.node_k[SUMP];
    let oil_volume_heat_j_m3k = car.oil.density_kg_m3(sump_k) * car.oil.heat_capacity_j_kgk(sump_k);
    car.network.advance_in_wind(
        around.heat,
        &HeatInput {
            power_w,
            ambient_k: car.ambient_k,
            speed_m_s: around.wheel.speed_m_s,
            pump_rad_s: drive.engine_rad_s,
            oil_flow_m3_s: drive.oil_flow_m3_s,
            oil_volume_heat_j_m3k,
            running: !around.engine_off,
            dt_s: around.dt_s,
        },
        speed_power_07,
    )
}

/// Heat into each node, W (SI-3).
#[inline(always)]
fn node_power(car: &Car, drive: &Drive, burn: &Burn) -> [f64; NODES] {
    let mut power = loss_heat_w(car, &drive.loss_w);
    power[COOLANT] += burn.to_coolant_w;
    power[ENGINE_OIL] += burn.to_oil_w;
    power
}

/// Heat that the transmission's losses, W, put into each node, W (SI-3).
#[inline]
pub fn loss_heat_w(car: &Car, loss_w: &[f64; Component::COUNT]) -> [f64; NODES] {
    // First the sums of what goes the same way.
    let (mut belt, mut metal, mut clutch, mut sump) = (0.0, 0.0, 0.0, 0.0);
    for component in Component::ALL {
        *match component {
            Component::BeltBand
            | Component::BeltFilm
            | Component::BeltSlip
            | Component::BeltWedge
            | Component::BeltPenetration
            | Component::BeltMap => &mut belt,
            Component::InputShaft | Component::Bearing | Component::Seal => &mut metal,
            Component::LaunchClutch => &mut clutch,
            _ => &mut sump,
        } += loss_w[component as usize];
    }
    let mut power = [0.0; NODES];
    power[BELT] = car.belt_heat_share * belt;
    power[METAL] = metal;
    power[SUMP] = sump + (1.0 - car.belt_heat_share) * belt;
    power[if car.transmission.is_cvt() {
        SUMP
    } else {
        COOLANT
    }] += clutch;
    power
}

/// Everything that a step answered.
struct Answer<'a> {
    drive: &'a Drive,
    inertia: &'a Inertia,
    burn: &'a Burn,
    /// Heat into each node, as the network received it.
    power_w: [f64; NODES],
    heat: &'a HeatStep,
}

/// Ledger terms of a step, each from the model that owns it.
#[inline]
fn terms(around: &Surroundings, a: &Answer) -> Terms {
    let (d, b, wheel) = (a.drive, a.burn, around.wheel);
    let node_heat: f64 = a.power_w.iter().sum();
    let losses: f64 = d.loss_w.iter().sum();
    let engine_heat = b.to_coolant_w + b.to_oil_w;
    let accessories = a.inertia.accessories_nm * d.engine_rad_s;
    Terms {
        fuel: b.fuel_w,
        wheels: wheel.power_w - d.deficit_w,
        brake: d.brake_w,
        accessories,
        losses,
        kinetic: a.inertia.kinetic_w,
        engine_heat,
        exhaust: b.exhaust_w,
        node_heat,
        stored: a.heat.stored_w,
        to_air: a.heat.to_air_w,
    }
}

#[inline(always)]
fn row(car: &Car, step: &crate::cycle::Step, around: &Surroundings, a: &Answer) -> (Row, Terms) {
    let terms = terms(around, a);
    let (d, b, wheel) = (a.drive, a.burn, around.wheel);
    let mut flags = d.flags;
    flags.set(Flags::FUEL_CUT, b.cut && d.engine_rad_s > 0.0);
    flags.set(Flags::OUTSIDE_VALIDITY, b.outside);
    let t = &a.heat.heat.node_k;
    let row = Row {
        time_s: step.time_s,
        dt_s: step.dt_s,
        phase: step.phase,
        speed_m_s: wheel.speed_m_s,
        accel_m_s2: wheel.accel_m_s2,
        distance_m: wheel.speed_m_s * step.dt_s,
        wheel_torque_nm: if wheel.wheel_rad_s > 0.0 {
            wheel.power_w / wheel.wheel_rad_s
        } else {
            0.0
        },
        wheel_power_w: wheel.power_w,
        wheel_work_positive_j: wheel.positive_j,
        wheel_work_negative_j: wheel.negative_j,
        deficit_w: d.deficit_w,
        engine_speed_rad_s: d.engine_rad_s,
        engine_torque_nm: d.shaft_nm,
        throttle: d.throttle,
        gear: d.gear,
        belt_ratio: d.belt_ratio,
        overall_ratio: if wheel.wheel_rad_s > 0.0 {
            d.engine_rad_s / wheel.wheel_rad_s
        } else {
            f64::NAN
        },
        primary_pressure_pa: d.primary_pa,
        secondary_pressure_pa: d.secondary_pa,
        slip: d.slip,
        clamp_safety: d.clamp_safety,
        loss_w: d.loss_w,
        accessories_w: terms.accessories,
        brake_w: d.brake_w,
        kinetic_w: a.inertia.kinetic_w,
        fuel_kg_s: b.fuel_kg_s,
        fuel_power_w: b.fuel_w,
        engine_heat_w: terms.engine_heat,
        exhaust_w: b.exhaust_w,
        coolant_k: t[COOLANT],
        engine_oil_k: t[ENGINE_OIL],
        sump_k: t[SUMP],
        metal_k: t[METAL],
        belt_spray_k: if car.transmission.is_cvt() {
            t[BELT]
        } else {
            f64::NAN
        },
        cooler_in_k: a.heat.cooler_in_k,
        cooler_out_k: a.heat.cooler_out_k,
        stored_w: a.heat.stored_w,
        to_air_w: a.heat.to_air_w,
        power_ledger_error: terms.power_error(),
        heat_ledger_error: terms.heat_error(),
        solve_residual: d.residual,
        iterations: d.iterations,
        flags,
    };
    (row, terms)
}
