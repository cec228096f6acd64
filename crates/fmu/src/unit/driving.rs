//! Steps of a whole car.

use std::sync::Arc;

use cvtcycle_config::ProblemKind::{Conflict, OutOfRange};
use cvtcycle_model::cycle::{GearColumns, GearCommand, Interval, Trace};
use cvtcycle_model::drive::{Drive, Row, State, own_trace};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, METAL, SUMP};

use super::{Refusal, Unit, set_outputs};
use crate::variables::{CarResult, Get, car};

/// Maximum step of the model, s, as in a run. Longer communication steps are divided.
pub(super) const MODEL_STEP_S: f64 = 1.0;

/// Number of inputs of a step, the same for all kinds of unit.
pub(crate) const INPUTS: usize = 5;

/// Inputs of one step. The following state depends on nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepInputs {
    pub from_s: f64,
    pub dt_s: f64,
    /// Car: speed, grade, ambient, gear. CVT: torque, speed, ratio, oil, engine.
    pub inputs: [f64; INPUTS],
}

/// Drive up to the current time.
#[derive(Clone, Debug)]
pub(crate) struct Driven {
    pub(super) state: State,
    pub(super) fuel_kg: f64,
    pub(super) distance_m: f64,
    /// Final speed: of the car in m/s, of the wheels of a CVT in rad/s.
    pub(super) speed: f64,
    /// Initial values: speed, ambient and temperature of a car, m/s and K; speed, oil and engine of a CVT, rad/s and K.
    pub start: [f64; 3],
    /// All steps since the start, copied on write because saved states share them.
    pub steps: Arc<Vec<StepInputs>>,
}

/// Error for a step before initialization.
pub(super) fn not_started() -> Refusal {
    Refusal::new(Conflict, "a step before the end of initialization")
}

impl Unit {
    /// Starts a drive with speed, ambient and temperature of all parts, m/s and K.
    pub(crate) fn begin(&mut self, start: [f64; 3]) -> Result<(), Refusal> {
        let [speed_m_s, ambient_k, start_k] = start;
        let lowest_k = car::AMBIENT_RANGE_K.0;
        if start_k < lowest_k {
            let name = "T_start_VEH_PNT_K";
            let message = format!(
                "{name} = {start_k} is out of range: {lowest_k} to {} K, or 0",
                car::START_RANGE_K.1
            );
            return Err(Refusal::new(OutOfRange, message).about(name));
        }
        self.car = self.setup.car(ambient_k);
        let state = State::at(start_k);
        let t = &state.heat.node_k;
        let row = Row {
            coolant_k: t[COOLANT],
            engine_oil_k: t[ENGINE_OIL],
            sump_k: t[SUMP],
            metal_k: t[METAL],
            belt_spray_k: t[BELT],
            ..Row::default()
        };
        self.saved.drive = Some(Driven {
            state,
            fuel_kg: 0.0,
            distance_m: 0.0,
            speed: speed_m_s,
            start,
            steps: Arc::default(),
        });
        self.set_row_outputs(&row);
        Ok(())
    }

    /// Computes a step.
    pub(crate) fn drive(&mut self, step: &StepInputs) -> Result<(), Refusal> {
        let Some(driven) = &mut self.saved.drive else {
            return Err(not_started());
        };
        let [speed_m_s, grade, ambient_k, gear, _] = step.inputs;
        if (ambient_k - self.car.ambient_k).abs() > 0.0 {
            self.car = self.setup.car(ambient_k);
        }
        let interval = Interval {
            start_s: step.from_s,
            end_s: step.from_s + step.dt_s,
            start_speed_m_s: driven.speed,
            end_speed_m_s: speed_m_s,
            phase: 0,
            grade,
            engine_off: false,
        };
        let command = match gear {
            gear if gear < 0.0 => None,
            gear if gear > 0.0 => Some(GearCommand::InGear(gear as u8)),
            _ => Some(GearCommand::Neutral),
        };
        let gears = GearColumns::new(None, None, command.map(|command| vec![command]));
        let trace = Trace::with_gears(vec![interval], gears);
        let trace = own_trace(&self.car, &trace);
        let mut drive = Drive::along(&self.car, &trace, driven.state);
        let (mut row, mut fuel_kg, mut distance_m) = (Row::default(), 0.0, 0.0);
        let (mut flags, mut fuel_by_step) = (Flags::default(), driven.fuel_kg);
        trace.for_each_step(MODEL_STEP_S, |step| {
            (row, _) = drive.step(&step);
            fuel_kg += row.fuel_kg_s * row.dt_s;
            fuel_by_step += row.fuel_kg_s * row.dt_s;
            distance_m += row.distance_m;
            flags = Flags(flags.0 | row.flags.0);
        });
        driven.state = drive.state();
        driven.fuel_kg = fuel_by_step;
        driven.distance_m += distance_m;
        driven.speed = speed_m_s;
        Arc::make_mut(&mut driven.steps).push(*step);
        row.fuel_kg_s = fuel_kg / step.dt_s;
        row.flags = flags;
        self.set_row_outputs(&row);
        Ok(())
    }

    fn set_row_outputs(&mut self, row: &Row) {
        let Some(driven) = &self.saved.drive else {
            return;
        };
        let result = CarResult {
            row,
            fuel_kg: driven.fuel_kg,
            distance_m: driven.distance_m,
            car: &self.car,
        };
        set_outputs(
            &self.variables,
            &mut self.saved.values,
            &row.loss_w,
            |get| match get {
                Get::Car(output) => Some(output(&result)),
                _ => None,
            },
        );
    }
}
