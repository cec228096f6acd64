//! The loop over the steps of a trace. No I/O, no allocation a step, no failure.

use super::step::Drive;
use super::{Car, EnergyTerms, Row};
use crate::cycle::Trace;
use crate::engine::Running;
use crate::engine::start_stop::StartStopState;
use crate::thermal::Heat;
use crate::transmission::TransmissionState;

/// What a drive carries from step to step.
#[derive(Clone, Copy, Debug)]
pub struct State {
    /// Temperatures.
    pub heat: Heat,
    /// Transmission; none before the first step.
    pub transmission: Option<TransmissionState>,
    /// Rotating energy of engine and primary side, J; NaN before the first step.
    pub kinetic_j: f64,
    /// What the engine did.
    pub running: Running,
    /// Temperature of the tyres, K.
    pub tyre_k: f64,
    /// What start-stop did.
    pub start_stop: StartStopState,
}

impl State {
    /// Everything at one temperature, engine about to start.
    pub fn at(temp_k: f64) -> Self {
        State {
            heat: Heat::uniform(temp_k),
            transmission: None,
            kinetic_j: f64::NAN,
            running: Running::STOPPED,
            tyre_k: temp_k,
            start_stop: StartStopState::default(),
        }
    }
}

/// Receives the rows of a drive in order.
pub trait Recorder {
    /// One row and its energy terms.
    fn record(&mut self, row: &Row, terms: &EnergyTerms);
}

/// Drives a trace from a state, gives every row to the recorder and returns the state at the end: a loop over [`Drive::step`].
///
/// The parts of a row that a recorder does not read are not computed: the step is inlined into the loop.
pub fn simulate(
    car: &Car,
    trace: &Trace,
    max_dt_s: f64,
    start: State,
    recorder: &mut impl Recorder,
) -> State {
    let mut drive = Drive::along(car, trace, start);
    trace.for_each_step(max_dt_s, |step| {
        let (row, terms) = drive.step(&step);
        recorder.record(&row, &terms);
    });
    drive.state()
}
