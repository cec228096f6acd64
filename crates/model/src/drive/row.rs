//! One row: everything that is known about one time step.

use super::EnergyTerms;
use crate::cycle::Step;
use crate::engine::start_stop::Electric;
use crate::engine::{Burn, EngineAtTemperature, HIGHEST_COOLANT_K};
use crate::flags::Flags;
use crate::lubricant::VALID_K;
use crate::math::{Mask, Real, physics};
use crate::thermal::{BELT, COOLANT, ENGINE_OIL, HeatStep, METAL, NODES, SUMP};
use crate::transmission::clamp_cause::ClampCause;
use crate::transmission::component::ByComponent;
use crate::transmission::{StepInput, StepOutput, set_flag};

/// Nodes with the highest temperature, K, that each of them may have; above it a row is too hot.
pub const HIGHEST_K: [(usize, f64); 3] = [
    (COOLANT, HIGHEST_COOLANT_K),
    (ENGINE_OIL, *VALID_K.end()),
    (SUMP, *VALID_K.end()),
];

/// One time step: means over the step that ends at `time_s`; temperatures are those at its end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row<R: Real = f64> {
    /// End of the step, s from the start of the cycle.
    pub time_s: f64,
    /// Length of the step, s.
    pub dt_s: f64,
    /// Index into the cycle's phases.
    pub phase: u16,
    /// Mean vehicle speed, m/s.
    pub speed_m_s: f64,
    /// Vehicle acceleration, m/s2.
    pub accel_m_s2: f64,
    /// Distance in the step, m.
    pub distance_m: f64,
    /// Demanded mean torque at the driven wheels, Nm.
    pub wheel_torque_nm: R,
    /// Demanded mean power at the driven wheels, W.
    pub wheel_power_w: R,
    /// Demanded work in the drive parts of the step, J, never negative.
    pub wheel_work_positive_j: R,
    /// Demanded work in the braking parts of the step, J, never positive.
    pub wheel_work_negative_j: R,
    /// Power that could not be delivered, W.
    pub deficit_w: R,
    /// Speed by which the car is slower than its trace at the end of the step, m/s (TR-3).
    pub behind_m_s: R,
    /// Engine speed, rad/s.
    pub engine_speed_rad_s: R,
    /// Engine speed at the end of the step, rad/s.
    pub engine_end_rad_s: R,
    /// Torque at the flywheel into the transmission, without rotating inertia, Nm.
    pub engine_torque_nm: R,
    /// Engine torque with accessories, without inertia, over full-load torque at that speed, 0..1.
    pub throttle: R,
    /// Gear of a manual box; 0 neutral or CVT.
    pub gear: R::PerLane<u8>,
    /// Belt ratio I = R_sec / R_pri (thesis eq. 5); NaN for a manual box.
    pub belt_ratio: R,
    /// Speed of the secondary over that into the final drive (RG-1); 1 in a CVT with one range, NaN for a manual box.
    pub range_ratio: R,
    /// Engine speed over wheel speed; NaN at standstill.
    pub overall_ratio: R,
    /// Primary pressure, Pa; NaN for a manual box.
    pub primary_pressure_pa: R,
    /// Secondary pressure, Pa; NaN for a manual box.
    pub secondary_pressure_pa: R,
    /// Cause of the secondary pressure (PC-5); without meaning for a manual box.
    pub clamp_cause: R::PerLane<ClampCause>,
    /// Belt slip as a fraction; NaN for a manual box.
    pub slip: R,
    /// Torque that the primary pulley takes from its shaft, Nm; NaN without a belt that turns.
    pub primary_nm: R,
    /// Torque that the secondary pulley gives to its shaft, Nm; NaN without a belt that turns.
    pub secondary_nm: R,
    /// Torque capacity over torque of the belt; infinite at zero torque; NaN for a manual box.
    pub clamp_safety: R,
    /// Loss power of each component, W, never negative.
    pub loss_w: ByComponent<R>,
    /// Power of the accessories, W; charging of the electric store with it.
    pub accessories_w: R,
    /// Power into the wheel brakes, W.
    pub brake_w: R,
    /// Change of rotating kinetic energy of engine and transmission over the step length, W.
    pub kinetic_w: R,
    /// Fuel mass flow, kg/s.
    pub fuel_kg_s: R,
    /// Fuel power (lower heating value), W.
    pub fuel_power_w: R,
    /// Heat into the engine's thermal nodes, W.
    pub engine_heat_w: R,
    /// Heat and unburnt fuel into the exhaust, W.
    pub exhaust_w: R,
    /// Coolant and block, K.
    pub coolant_k: R,
    /// Engine oil, K.
    pub engine_oil_k: R,
    /// Transmission oil in the sump, K.
    pub sump_k: R,
    /// Transmission case and shafts, K.
    pub metal_k: R,
    /// Belt, pulleys and the oil sprayed off them, K; NaN for a manual box.
    pub belt_spray_k: R,
    /// Oil to the cooler, K; NaN without one.
    pub cooler_in_k: R,
    /// Oil from the cooler, K; NaN without one.
    pub cooler_out_k: R,
    /// Tyres, K.
    pub tyre_k: R,
    /// Heat stored in the nodes, W.
    pub stored_w: R,
    /// Heat given to the air, W.
    pub to_air_w: R,
    /// Power ledger: |in - out| over the sum of absolute terms.
    pub power_ledger_error: R,
    /// Heat ledger: |in - stored - to air| over the sum of absolute terms.
    pub heat_ledger_error: R,
    /// Residual of the implicit solve, as a fraction of full-load torque.
    pub solve_residual: R,
    /// Evaluations of the driveline that the implicit solve needed.
    pub iterations: R::PerLane<u16>,
    /// States and departures from validity.
    pub flags: R::PerLane<Flags>,
}

impl<R: Real> Row<R> {
    /// True at standstill, as [`crate::cycle::Motion::rests`].
    #[inline]
    pub fn rests(&self) -> bool {
        self.speed_m_s <= 0.0
    }
}

pub(super) type Input<'a, R = f64> = StepInput<'a, EngineAtTemperature<'a, R>, R>;

/// Rotating energy and crank torque of a step.
pub(super) struct Inertia<R: Real = f64> {
    pub crank_nm: R,
    pub accessories_nm: R,
    pub kinetic_w: R,
    /// Part of it that the wheels give in place of the brakes (SI-5).
    pub from_wheels_w: R,
    /// Power of a slower engine that neither its drag nor its load takes up (SI-4).
    pub surplus_w: R,
}

/// Everything that a step computed.
pub(super) struct Solved<'a, R: Real = f64> {
    pub output: &'a StepOutput<R>,
    pub inertia: &'a Inertia<R>,
    pub burn: &'a Burn<R>,
    /// Heat into each node, as the network received it.
    pub power_w: [R; NODES],
    pub heat: &'a HeatStep<R>,
    /// Store, starter and alternator of start-stop.
    pub electric: &'a Electric<R>,
    pub tyre_k: R,
    /// Speed by which the car is slower than its trace, m/s.
    pub behind_m_s: R,
    /// Tolerance of it, m/s.
    pub tolerance_m_s: f64,
}

/// Energy terms of a step, each from the model that owns it.
#[physics]
fn terms<R: Real>(input: &Input<R>, a: &Solved<R>) -> EnergyTerms<R> {
    let (d, b, wheel) = (a.output, a.burn, input.wheel);
    let engine_heat = b.to_coolant_w + b.to_oil_w;
    let shaft_w = a.inertia.accessories_nm * d.engine_rad_s;
    let accessories = shaft_w - a.electric.charging_w + a.electric.consumers_w;
    EnergyTerms {
        fuel: b.fuel_w,
        wheels: wheel.power_w - d.deficit_w,
        brake: d.brake_w,
        accessories,
        losses: shaft_w.sum(&d.loss_w.0),
        kinetic: a.inertia.kinetic_w,
        engine_heat,
        exhaust: b.exhaust_w,
        node_heat: shaft_w.sum(&a.power_w),
        stored: a.heat.stored_w,
        to_air: a.heat.to_air_w,
        store: a.electric.store_w,
        electric_loss: a.electric.loss_w + d.alternator_w,
    }
}

/// The row of a step with its energy terms; `is_cvt`: the car has a belt.
#[physics]
pub(super) fn row<R: Real>(
    is_cvt: bool,
    step: &Step,
    input: &Input<R>,
    a: &Solved<R>,
) -> (Row<R>, EnergyTerms<R>) {
    let terms = terms(input, a);
    let (d, b, wheel) = (a.output, a.burn, input.wheel);
    let engine_rad_s = d.engine_rad_s;
    let (zero, none) = (engine_rad_s.splat(0.0), engine_rad_s.splat(f64::NAN));
    let mut flags = d.flags.clone();
    let turns = engine_rad_s.gt(0.0);
    set_flag::<R>(&mut flags, Flags::FUEL_CUT, b.cut & turns);
    set_flag::<R>(&mut flags, Flags::OUTSIDE_VALIDITY, b.outside);
    let t = &a.heat.heat.node_k;
    let [first, second, third] = HIGHEST_K;
    let hot = t[first.0].gt(first.1) | t[second.0].gt(second.1) | t[third.0].gt(third.1);
    set_flag::<R>(&mut flags, Flags::TOO_HOT, hot);
    let missed = a.behind_m_s.gt(a.tolerance_m_s);
    set_flag::<R>(&mut flags, Flags::MISSED_TRACE, missed);
    let rolls = wheel.wheel_rad_s.gt(0.0);
    let row = Row {
        time_s: step.time_s,
        dt_s: step.dt_s,
        phase: step.phase,
        speed_m_s: wheel.speed_m_s,
        accel_m_s2: wheel.accel_m_s2,
        distance_m: step.distance_m(),
        wheel_torque_nm: rolls.select(wheel.power_w / wheel.wheel_rad_s, zero),
        wheel_power_w: wheel.power_w,
        wheel_work_positive_j: wheel.positive_j,
        wheel_work_negative_j: wheel.negative_j,
        deficit_w: d.deficit_w,
        behind_m_s: a.behind_m_s,
        engine_speed_rad_s: engine_rad_s,
        engine_end_rad_s: d.end_rad_s,
        engine_torque_nm: d.shaft_nm,
        throttle: d.throttle,
        gear: d.gear.clone(),
        belt_ratio: d.belt_ratio,
        range_ratio: d.range_ratio,
        overall_ratio: rolls.select(engine_rad_s / wheel.wheel_rad_s, none),
        primary_pressure_pa: d.primary_pa,
        secondary_pressure_pa: d.secondary_pa,
        clamp_cause: d.clamp_cause.clone(),
        slip: d.slip,
        primary_nm: d.primary_nm,
        secondary_nm: d.secondary_nm,
        clamp_safety: d.clamp_safety,
        loss_w: d.loss_w,
        accessories_w: terms.accessories + a.electric.charging_w,
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
        belt_spray_k: if is_cvt { t[BELT] } else { none },
        cooler_in_k: a.heat.cooler_in_k,
        cooler_out_k: a.heat.cooler_out_k,
        tyre_k: a.tyre_k,
        stored_w: a.heat.stored_w,
        to_air_w: a.heat.to_air_w,
        power_ledger_error: terms.power_error(),
        heat_ledger_error: terms.heat_error(),
        solve_residual: d.residual,
        iterations: d.iterations.clone(),
        flags,
    };
    (row, terms)
}
