//! Start-stop in a step of a drive: what the engine does, and what store and starter give for it.

use super::Car;
use super::row::Input;
use crate::cycle::{GearCommand, Step, Trace};
use crate::engine::start_stop::{Command, Conditions, Electric, StartStopState};
use crate::engine::starter_generator::Flow;
use crate::engine::{Burn, EngineAtTemperature, StartStop};
use crate::math::{Real, larger, physics};
use crate::thermal::{COOLANT, Heat, SUMP};
use crate::transmission::component::Component;
use crate::transmission::{StepOutput, Transmission, TransmissionState};

/// Start-stop of a car in a step.
pub(super) struct Stopping<'a> {
    on: &'a StartStop,
    command: Command,
    /// Shaft power of alternator or starter-generator in the step.
    flow: Flow,
}

impl<'a> Stopping<'a> {
    /// Action of the engine of a car with start-stop in a step of a trace.
    pub fn new(
        car: &'a Car,
        trace: Option<&Trace>,
        gear: Option<GearCommand>,
        step: &Step,
        heat: &Heat,
        past: &mut StartStopState,
    ) -> Option<Self> {
        let on = car.engine.start_stop.as_ref()?;
        if step.engine_off {
            let drawn_j = past.drawn_j;
            *past = StartStopState {
                drawn_j,
                ..StartStopState::default()
            };
            return None;
        }
        let from_s = step.time_s - step.dt_s;
        let now = Conditions {
            coolant_k: heat.node_k[COOLANT],
            sump_k: car.transmission.is_cvt().then_some(heat.node_k[SUMP]),
            ambient_k: car.ambient_k,
            speed_m_s: larger(step.start_speed_m_s, step.end_speed_m_s),
            rest_s: trace.map_or(f64::INFINITY, |trace| trace.rest_s(step.interval, from_s)),
            neutral: gear.is_none_or(|gear| gear == GearCommand::Neutral),
            dt_s: step.dt_s,
        };
        let command = on.command(&now, past);
        Some(Stopping {
            on,
            command,
            flow: Flow::default(),
        })
    }

    /// True with the engine at rest.
    pub fn stopped(&self) -> bool {
        self.command == Command::Stop
    }

    /// Sets what alternator or starter-generator of a running engine does in a step, by the power at the wheels, W, and the engine's speed, rad/s; the power
    /// at its shaft, W, less that of the consumers which the store feeds.
    pub fn charging_w(
        &mut self,
        engine: &EngineAtTemperature,
        at: (f64, f64),
        past: &StartStopState,
        dt_s: f64,
    ) -> f64 {
        if self.command == Command::Run {
            self.flow = self.on.flow(engine, at, past, dt_s);
        }
        self.flow.shaft_w - self.flow.consumers * engine.engine.electrical_w
    }

    /// Advances store, starter and alternator by the step, and pressure and electric pump of a stopped CVT.
    pub fn electric(
        &self,
        input: &Input,
        (car, transmission): (&Car, &TransmissionState),
        output: &mut StepOutput,
        past: &mut StartStopState,
    ) -> Electric {
        let (on, engine) = (self.on, input.engine);
        let electric = match self.command {
            Command::Stop => {
                let pump_w = match &car.transmission {
                    Transmission::Cvt(cvt) => {
                        let before_pa = transmission.driveline.secondary_pa;
                        output.secondary_pa = on.held_pa(before_pa, past.stopped_s);
                        let sump_k = input.heat.node_k[SUMP];
                        let eta_pa_s =
                            input.oil.kinematic_m2_s(sump_k) * input.oil.density_kg_m3(sump_k);
                        on.pump_w(cvt.pump.steady_need_m3_s(on.pump_pa, eta_pa_s))
                    }
                    Transmission::Manual(_) => 0.0,
                };
                output.loss_w[Component::Pump] += pump_w;
                Electric::stopped(on, engine.engine, pump_w)
            }
            Command::Start => {
                Electric::starting(on, engine, input.heat.node_k[COOLANT], input.dt_s)
            }
            Command::Run => Electric::running(on, engine, output.engine_rad_s, &self.flow),
        };
        past.drawn_j = electric.drawn_j(on, past.drawn_j, input.dt_s);
        electric
    }
}

/// Adds to what the engine burns the fuel of a start, and the heat of cranking.
#[physics]
pub(super) fn add_start<R: Real>(
    burn: &mut Burn<R>,
    electric: &Electric<R>,
    heating_value_j_kg: R,
) {
    let start_w = electric.start_kg_s * heating_value_j_kg;
    burn.fuel_kg_s = burn.fuel_kg_s + electric.start_kg_s;
    burn.fuel_w = burn.fuel_w + start_w;
    burn.exhaust_w = burn.exhaust_w + start_w; // SS-3, as EN-9
    burn.to_coolant_w = burn.to_coolant_w + electric.crank_w; // SS-4
}
