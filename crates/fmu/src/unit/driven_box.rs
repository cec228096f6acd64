//! Steps of a CVT driven by a torque.

use std::sync::Arc;

use cvtcycle_config::ProblemKind::WrongTransmission;
use cvtcycle_model::drive::{Forward, Given, State};
use cvtcycle_model::thermal::BELT;
use cvtcycle_model::transmission::Transmission;

use super::driving::{Driven, MODEL_STEP_S, not_started};
use super::{Refusal, StepInputs, Unit, set_outputs};
use crate::variables::{CvtResult, Get, forward};

impl Unit {
    /// Starts from wheel speed, rad/s, and temperatures of sump and engine, K.
    pub(crate) fn begin_forward(&mut self, start: [f64; 3]) {
        let [wheel_rad_s, oil_k, _] = start;
        self.saved.drive = Some(Driven {
            state: State::at(oil_k),
            fuel_kg: 0.0,
            distance_m: 0.0,
            speed: wheel_rad_s,
            start,
            steps: Arc::default(),
        });
    }

    /// Computes a step.
    pub(crate) fn drive_forward(&mut self, step: &StepInputs) -> Result<(), Refusal> {
        let driven = self.saved.drive.as_mut().ok_or_else(not_started)?;
        let [engine_nm, wheel_rad_s, ratio, sump_k, engine_k] = step.inputs;
        let manual = || Refusal::new(WrongTransmission, "a manual box is not driven by a torque");
        let mut drive = Forward::new(&self.car, driven.state).ok_or_else(manual)?;
        // Divides a longer step. Torque and heat are those of its last part.
        let parts = (step.dt_s / MODEL_STEP_S).ceil().max(1.0);
        let (from, rise) = (driven.speed, (wheel_rad_s - driven.speed) / parts);
        let mut part = |k: f64| {
            drive.step(&Given {
                engine_nm,
                wheel_rad_s: [from + k * rise, from + (k + 1.0) * rise],
                ratio,
                sump_k,
                engine_k: [engine_k; 2],
                dt_s: step.dt_s / parts,
            })
        };
        let mut turned = part(0.0);
        for k in 1..parts as u32 {
            turned = part(f64::from(k));
        }
        driven.state = drive.state();
        driven.speed = wheel_rad_s;
        Arc::make_mut(&mut driven.steps).push(*step);
        let belt_k = driven.state.heat.node_k[BELT];
        let Transmission::Cvt(cvt) = &self.car.transmission else {
            return Err(manual());
        };
        let result = CvtResult {
            turned: &turned,
            belt_k,
            cvt,
        };
        let value = |get: &Get| match get {
            Get::Cvt(output) => Some(output(&result)),
            _ => None,
        };
        set_outputs(
            &self.variables,
            &mut self.saved.values,
            &turned.output.loss_w,
            value,
        );
        Ok(())
    }

    /// Inputs for the next step.
    pub(super) fn forward_inputs(&self) -> [f64; 5] {
        [
            forward::TORQUE,
            forward::SPEED,
            forward::RATIO,
            forward::OIL,
            forward::COOLANT,
        ]
        .map(|place| self.saved.values[place])
    }
}
