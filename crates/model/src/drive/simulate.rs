//! The loop over the steps of a trace. No I/O, no allocation a step, no failure.

use super::step::Drive;
use super::{Car, EnergyTerms, Row};
use crate::cycle::Trace;
use crate::engine::Running;
use crate::engine::start_stop::StartStopState;
use crate::math::Real;
use crate::thermal::Heat;
use crate::transmission::TransmissionState;

/// State of a drive between steps.
#[derive(Clone, Copy, Debug)]
pub struct State<R: Real = f64, S = TransmissionState> {
    /// Temperatures.
    pub heat: Heat<R>,
    /// Transmission; none before the first step.
    pub transmission: Option<S>,
    /// Rotating energy of engine and primary side, J; NaN before the first step.
    pub kinetic_j: R,
    /// State of the engine's start.
    pub running: Running<R>,
    /// Temperature of the tyres, K.
    pub tyre_k: R,
    /// State of start-stop.
    pub start_stop: StartStopState,
    /// Speed by which the car is slower than its trace, m/s (TR-3).
    pub behind_m_s: R,
}

impl<R: Real, S> State<R, S> {
    /// Everything at one temperature, engine about to start.
    pub fn at(temp_k: R) -> Self {
        let zero = temp_k.splat(0.0);
        State {
            heat: Heat::uniform(temp_k),
            transmission: None,
            kinetic_j: temp_k.splat(f64::NAN),
            running: Running {
                since_s: 0.0,
                start_k: zero,
                speed_rad_s: zero,
                end_rad_s: zero,
            },
            tyre_k: temp_k,
            start_stop: StartStopState::default(),
            behind_m_s: zero,
        }
    }
}

/// Receives the rows of a drive in order.
pub trait Recorder<R: Real = f64> {
    /// One row and its energy terms.
    fn record(&mut self, row: &Row<R>, terms: &EnergyTerms<R>);
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
