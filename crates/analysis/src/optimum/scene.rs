//! A car on the steps of a trace: its states, what its engine and coupling do in a step, and the ratios within reach.

use super::node::Mode;
use super::reference::Reference;
use super::{Clamp, Limits, Task};
use cvtcycle_model::cycle::{Step, Trace};
use cvtcycle_model::drive::{Car, Drive, Row, State, loss_heat_w};
use cvtcycle_model::engine::{EngineAtTemperature, Running};
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::thermal::{COOLANT, ENGINE_OIL, NODES, SUMP};
use cvtcycle_model::transmission::coupling::{Coupling, LockSignals};
use cvtcycle_model::transmission::cvt::controller::ClampLaw;
use cvtcycle_model::transmission::cvt::variator::BeltAtRatio;
use cvtcycle_model::transmission::cvt::{Cvt, Hold};

/// Engine speed over that from which the coupling stays locked, so that other temperatures do not open it.
const LOCKED: f64 = 1.005;
/// More of it for a coupling that locks by the speed of the box: slip in the belt differs a little from ratio to ratio.
const BY_COMMAND: f64 = 1.001;
/// Warmer oil of another controller where the temperature of the sump locks the coupling, K (DP-14). ASSUMED: at -10 degC the oil of lines from
/// 1100 to 1700 rpm differs by 1.3 K at most while it is near 20 degC, on FTP75 and on ECE15+EUDC.
const WARMER_K: f64 = 1.5;

/// A car on a trace.
pub struct Scene<'a> {
    /// The car.
    pub car: &'a Car,
    /// CVT of the car.
    pub cvt: &'a Cvt,
    /// The steps of the trace.
    pub steps: &'a [Step],
    /// The trace.
    trace: &'a Trace,
    /// Mean speed of the car in each step, m/s.
    speed_m_s: Vec<f64>,
    /// Speed of the secondary in each step, rad/s.
    pub secondary_rad_s: Vec<f64>,
    /// Mean speed of each step over that at its end; none for a car that stops.
    over_end: Vec<Option<f64>>,
    /// Control of the clamping pressure.
    pub clamp: Clamp,
    /// By how much the sump may be warmer than that of the reference where its temperature locks the coupling, K (DP-14).
    pub warmer_k: f64,
}

impl<'a> Scene<'a> {
    /// The car of a task with a CVT on its steps.
    pub fn new(task: &Task<'a>) -> Self {
        let (car, cvt) = (task.car, task.cvt);
        let wheels = task.steps.iter().map(|step| {
            let wheel = car.road_load.wheel(step, 0.0);
            (wheel.speed_m_s, cvt.final_drive.ratio * wheel.wheel_rad_s)
        });
        let (speed_m_s, secondary_rad_s): (Vec<f64>, Vec<f64>) = wheels.unzip();
        let each = task.steps.iter().zip(&speed_m_s);
        let over_end = each.map(|(step, mean)| {
            let end = step.end_speed_m_s;
            (end > 0.0).then(|| mean / end)
        });
        let over_end = over_end.collect();
        Scene {
            car,
            cvt,
            steps: task.steps,
            trace: task.trace,
            speed_m_s,
            secondary_rad_s,
            over_end,
            clamp: task.clamp,
            warmer_k: 0.0,
        }
    }

    /// The same with oil that is warmer where it locks the coupling (DP-14); none where it locks in no other step of a reference.
    pub fn warmer(&self, reference: &Reference) -> Option<Scene<'a>> {
        // Fast enough for any lock-up.
        let fast = |sump_k: f64| LockSignals {
            speed_m_s: f64::INFINITY,
            sump_k,
            output_rad_s: f64::INFINITY,
            idle_rad_s: 0.0,
            faster_rad_s: 0.0,
            dt_s: 1.0,
        };
        let coupling = &self.cvt.coupling;
        let other = |before: &State| {
            let sump_k = before.heat.node_k[SUMP];
            let locks = |sump_k: f64, past: bool| coupling.hold(&fast(sump_k), past).coupled;
            [false, true]
                .iter()
                .any(|past| locks(sump_k, *past) != locks(sump_k + WARMER_K, *past))
        };
        let locks_earlier = coupling.by_command() && reference.before.iter().any(other);
        locks_earlier.then(|| Scene {
            warmer_k: WARMER_K,
            speed_m_s: self.speed_m_s.clone(),
            secondary_rad_s: self.secondary_rad_s.clone(),
            over_end: self.over_end.clone(),
            ..*self
        })
    }

    /// A drive of one step or more from a state.
    pub fn drive(&self, from: State) -> Drive<'a> {
        Drive::along(self.car, self.trace, from)
    }

    /// Steps in which no ratio is chosen: the first one, at rest, with the engine off or started by start-stop; with a clutch also where even low
    /// is too slow, and from there until the clutch of the reference has locked.
    pub fn by_law(&self, reference: &Reference) -> Vec<bool> {
        let mut open = true;
        let by_command = self.cvt.coupling.by_command();
        let mut of = |k: usize| {
            let (before, step) = (&reference.before[k], &self.steps[k]);
            let still = self.secondary_rad_s[k] <= 0.0 || before.start_stop.stopped;
            if by_command || k == 0 || step.engine_off || still {
                open = k == 0 || step.engine_off || still;
                return open;
            }
            let engine = self.engine(before, step, before.running.speed_rad_s);
            let locked_rad_s = self.cvt.coupling.locked_from_rad_s(engine.idle_rad_s());
            let fastest_rad_s = self.cvt.ratio.low * self.secondary_rad_s[k];
            let slow = fastest_rad_s < LOCKED * locked_rad_s;
            open = slow || open && !reference.coupled_before(k);
            open
        };
        (0..self.steps.len()).map(&mut of).collect()
    }

    /// A chosen hold in the temperatures of a drive: where it is one with the coupling locked, no ratio in which it would not stay so (LC-5,
    /// TC-7), none beyond the rates (RC-4), and no other one before a clutch has locked (RC-6).
    pub fn within(
        &self,
        k: usize,
        state: &State,
        (hold, mode): (Hold, Mode),
        limits: &Limits,
    ) -> Hold {
        let kept = state.transmission.as_ref();
        let Some((coupled, (before, end_before))) = kept.and_then(|kept| {
            let cvt = kept.cvt.as_ref()?;
            let ratios = (cvt.belt.geometry.ratio, cvt.shifting.ratio);
            Some((kept.driveline.coupled, ratios))
        }) else {
            return hold;
        };
        let (up, down) = self.reach(k, before.ln(), limits);
        let engine = self.engine(state, &self.steps[k], state.running.speed_rad_s);
        let locked_rad_s = LOCKED * self.cvt.coupling.locked_from_rad_s(engine.idle_rad_s());
        let least = locked_rad_s / self.secondary_rad_s[k];
        let ratio = match (coupled, self.cvt.coupling.by_command()) {
            (true, _) if mode == Mode::Locked => hold.ratio.max(least).clamp(up.exp(), down.exp()),
            (_, true) => hold.ratio.clamp(up.exp(), down.exp()),
            _ => hold.ratio.min(down.exp()).max(before),
        };
        // Nor an end beyond them: the flow of a faster shift, which is imposed, would be missing for the clamp.
        let (up, down) = self.reach(k, end_before.ln(), limits);
        let end = |_| self.level(k, ratio).clamp(up.exp(), down.exp());
        Hold {
            ratio,
            end: hold.end.map(end),
            ..hold
        }
    }

    /// Ratio at the end of a step at which the engine is as fast then as in the mean of the step (DP-2): what a controller that holds a speed has, while
    /// one ratio for the whole step brings fuel back too early where the car slows down (EN-11).
    pub fn level(&self, k: usize, ratio: f64) -> f64 {
        let control = &self.cvt.ratio;
        match self.over_end[k] {
            Some(over) => (ratio * over).clamp(control.high, control.low),
            None => control.low,
        }
    }

    /// Logarithms of the ratio between which a step can end that begins at `x` (RC-4).
    pub fn reach(&self, k: usize, x: f64, limits: &Limits) -> (f64, f64) {
        let (secondary, dt_s) = (self.secondary_rad_s[k], self.steps[k].dt_s);
        let ratio = &self.cvt.ratio;
        let pace = (x.exp() * secondary / ratio.rate_speed_rad_s).clamp(0.0, 1.0);
        let down = (x + limits.down_per_s * pace * dt_s).min(ratio.low.ln());
        let up = (x - limits.up_per_s * pace * dt_s).max(ratio.high.ln());
        (up.min(x), down.max(x))
    }

    /// The engine in a step of a drive, after a speed before it.
    pub fn engine(&self, state: &State, step: &Step, before_rad_s: f64) -> EngineAtTemperature<'_> {
        let (car, t) = (self.car, &state.heat.node_k);
        let running = Running {
            speed_rad_s: before_rad_s,
            ..state.running
        };
        let lowest = self.cvt.ratio.low * self.cvt.final_drive.ratio;
        let end_rad_s = step.end_speed_m_s / car.road_load.wheel_radius_m;
        let running = running.turning([before_rad_s, before_rad_s.min(lowest * end_rad_s)]);
        let (coolant_k, oil_k) = (t[COOLANT], t[ENGINE_OIL]);
        let mut engine = car.engine.in_step(
            coolant_k,
            oil_k,
            &car.engine_oil,
            car.charge,
            &running,
            step.dt_s,
        );
        if let Some(on) = &car.engine.start_stop {
            engine.charging_w = on.charging_w(&state.start_stop, step.dt_s); // EL-2, without recuperation
        }
        engine
    }

    /// A state after a step in another ratio, with one at its end, at an engine speed with the coupling in a mode.
    pub fn rolling_at(
        &self,
        state: &State,
        ratios: (f64, f64),
        engine_rad_s: f64,
        mode: Mode,
    ) -> State {
        let mut state = self.in_ratio(state, ratios);
        if let Some(transmission) = &mut state.transmission {
            transmission.driveline.engine_rad_s = engine_rad_s;
            transmission.driveline.coupled = mode == Mode::Locked;
            transmission.driveline.stood = false;
        }
        state.kinetic_j = self.kinetic_j(engine_rad_s);
        state.running.speed_rad_s = engine_rad_s;
        state
    }

    /// A state after a step in another ratio, with one at its end.
    pub fn in_ratio(&self, state: &State, (ratio, end): (f64, f64)) -> State {
        let mut state = *state;
        if let Some(cvt) = state.transmission.as_mut().and_then(|t| t.cvt.as_mut()) {
            cvt.belt = BeltAtRatio::new(&self.cvt.belt, ratio);
            cvt.shifting.ratio = end;
        }
        state
    }

    /// Heat that a driven step puts into each node, W.
    pub fn heat_w(&self, before: &State, k: usize, row: &Row) -> [f64; NODES] {
        let mut heat_w = loss_heat_w(self.car, &row.loss_w);
        let (w, step) = (row.engine_speed_rad_s, &self.steps[k]);
        if w > 0.0 {
            let engine = self.engine(before, step, before.running.speed_rad_s);
            // What the engine gave: not all of the rotating energy is burnt for, the brakes may have had it (SI-5).
            let crank_w = row.fuel_power_w - row.exhaust_w - row.engine_heat_w;
            let to_oil_w = engine.burn(w, crank_w / w).to_oil_w;
            heat_w[COOLANT] += row.engine_heat_w - to_oil_w;
            heat_w[ENGINE_OIL] += to_oil_w;
        }
        heat_w
    }

    /// Worth of the heat of a drive, kg.
    pub fn worth_kg(&self, reference: &Reference, worth: &[[f64; NODES]]) -> f64 {
        let of = |k: usize| {
            let heat_w = self.heat_w(&reference.before[k], k, &reference.rows[k]);
            let each = heat_w.iter().zip(&worth[k]).map(|(w, worth)| w * worth);
            each.sum::<f64>() * self.steps[k].dt_s
        };
        (0..self.steps.len()).map(of).sum()
    }

    pub fn kinetic_j(&self, engine_rad_s: f64) -> f64 {
        0.5 * self.car.engine.inertia_kg_m2 * engine_rad_s * engine_rad_s
    }

    /// Controls for a step in which no ratio is chosen.
    pub fn law_held(&self, ratio: f64) -> Hold {
        let clamp = match self.clamp {
            Clamp::Law => None,
            Clamp::Free { safety, .. } => Some(free_law(safety)),
        };
        Hold {
            ratio,
            clamp,
            end: None,
            paced: false,
        }
    }

    /// Applies the law of the coupling in a step at a ratio, for open before and locked before (TC-7). A clutch that locks by
    /// itself is locked wherever a ratio is chosen (DP-5).
    pub(super) fn locks(&self, reference: &Reference, k: usize, ratio: f64) -> [bool; 2] {
        self.locks_with(reference, k, (ratio, self.warmer_k))
    }

    /// The same with oil that is warmer, K.
    pub(super) fn locks_with(
        &self,
        reference: &Reference,
        k: usize,
        (ratio, warmer_k): (f64, f64),
    ) -> [bool; 2] {
        let coupling = &self.cvt.coupling;
        if !coupling.by_command() {
            return [true; 2];
        }
        let before = &reference.before[k];
        let engine = self.engine(before, &self.steps[k], before.running.speed_rad_s);
        let signals = LockSignals {
            speed_m_s: self.speed_m_s[k],
            sump_k: before.heat.node_k[SUMP] + warmer_k,
            output_rad_s: ratio * self.secondary_rad_s[k],
            idle_rad_s: engine.idle_rad_s(),
            faster_rad_s: 0.0,
            dt_s: self.steps[k].dt_s,
        };
        [false, true].map(|past| coupling.hold(&signals, past).coupled)
    }

    /// Least engine speed at which the coupling stays locked, for an engine at a speed in a ratio, rad/s.
    pub(super) fn locked_rad_s(&self, engine: &EngineAtTemperature, turns: (f64, f64)) -> f64 {
        let coupling = &self.cvt.coupling;
        let least_rad_s = LOCKED * coupling.locked_from_rad_s(engine.idle_rad_s());
        match coupling.by_command() {
            true => least_rad_s * BY_COMMAND * turns.0 / turns.1, // its law looks at the box
            false => least_rad_s,
        }
    }
}

/// PC-3 as a free clamp: its safety factor alone.
pub fn free_law(safety: f64) -> ClampLaw {
    ClampLaw::TorqueFollowing {
        safety,
        least_torque_nm: 0.0,
    }
}
