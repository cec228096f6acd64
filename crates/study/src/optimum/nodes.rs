//! What engine and box do in a step at a ratio, by the model's own step.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-13 | a coupling that locks by command does so by its law from the state before (TC-7): two layers of ratios, locked and open, and from each into the one that the law leads to at the ratio of the step; open, the engine has the speed at which it stays (TC-2, TC-6) | derived: its law looks at the ratio; reach of the open engine left out, which changes single steps of a launch |
//! | DP-14 | lock-up by temperature is that of the reference; tolerance + \|J - J with the sump 1.5 K warmer for it\|; in DP-7 no step changes its mode | ASSUMED: 1.5 K; what oil warmer than that would save is not in the bound |
//! | DP-4 | free clamp: of the laws PC-3 with S times 1 to 3.4, the one that burns least at the speeds of the node, slip at most its limit | derived: pressure has no memory; any admissible pressure is one of PC-3 with some S |

use cvtcycle_model::cycle::{Step, Trace};
use cvtcycle_model::drive::{Car, Drive, Row, State, loss_heat_w};
use cvtcycle_model::engine::{EngineAtTemperature, Running};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::thermal::{COOLANT, ENGINE_OIL, NODES, SUMP};
use cvtcycle_model::transmission::coupling::LockSignals;
use cvtcycle_model::transmission::cvt::WarmStart;
use cvtcycle_model::transmission::cvt::controller::ClampLaw;
use cvtcycle_model::transmission::cvt::variator::BeltAtRatio;
use cvtcycle_model::transmission::cvt::{Cvt, Hold};

use super::node::{At, Mode, Node};
use super::reference::Reference;
use super::{Clamp, Limits, Task};

/// Safety factors that are tried for a free clamp, over the least one.
const SAFETIES: [f64; 5] = [1.0, 1.3, 1.7, 2.3, 3.4];
/// Halvings of the distance between them about the best one.
const HALVINGS: usize = 2;
/// Of so many ratios one is searched for its best free clamp.
const SEARCHED: usize = 4;
/// Share of fuel by which a higher pressure has to be better.
const CLEARLY: f64 = 1e-6;
/// Residual of a solve that does for the fuel of a step.
const SOLVED: f64 = 1e-3;
/// Engine speed over that from which the coupling stays locked, so that other temperatures do not open it.
const LOCKED: f64 = 1.005;
/// More of it for a coupling that locks by the speed of the box: slip in the belt differs a little from ratio to ratio.
const BY_COMMAND: f64 = 1.001;
/// Warmer oil of another controller where the temperature of the sump locks the coupling, K (DP-14). ASSUMED: at -10 degC the oil of lines from
/// 1100 to 1700 rpm differs by 1.3 K at most while it is near 20 degC, on FTP75 and on ECE15+EUDC.
const WARMER_K: f64 = 1.5;
/// Most steps in which the engine over an open coupling gets to the speed at which it stays.
const PASSES: usize = 12;
/// Change of that speed over the length of the step, 1/s, below which it is there: no engine is as slow.
const STEADY_PER_S: f64 = 0.08;

/// A car on a trace.
pub struct Scene<'a> {
    /// The car.
    pub car: &'a Car,
    /// Its box.
    pub cvt: &'a Cvt,
    /// The steps of the trace.
    pub steps: &'a [Step],
    /// The trace.
    trace: &'a Trace,
    /// Mean speed of the car in each step, m/s.
    speed_m_s: Vec<f64>,
    /// Speed of the secondary in each step, rad/s.
    pub secondary_rad_s: Vec<f64>,
    /// What clamps the belt.
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
        let (speed_m_s, secondary_rad_s) = wheels.unzip();
        Scene {
            car,
            cvt,
            steps: task.steps,
            trace: task.trace,
            speed_m_s,
            secondary_rad_s,
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
        let Some((coupled, before)) = kept.and_then(|kept| {
            let belt = kept.cvt.as_ref().map(|cvt| cvt.belt.geometry.ratio);
            Some((kept.driveline.coupled, belt?))
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
        Hold { ratio, ..hold }
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
            engine.charging_w = on.charging_w(&state.start_stop, step.dt_s); // EL-2
        }
        engine
    }

    /// A state with another ratio, driven before at an engine speed with the coupling in a mode.
    pub fn rolling_at(&self, state: &State, ratio: f64, engine_rad_s: f64, mode: Mode) -> State {
        let mut state = self.in_ratio(state, ratio);
        if let Some(transmission) = &mut state.transmission {
            transmission.driveline.engine_rad_s = engine_rad_s;
            transmission.driveline.coupled = mode == Mode::Locked;
            transmission.driveline.stood = false;
        }
        state.kinetic_j = self.kinetic_j(engine_rad_s);
        state.running.speed_rad_s = engine_rad_s;
        state
    }

    /// A state with another ratio.
    pub fn in_ratio(&self, state: &State, ratio: f64) -> State {
        let mut state = *state;
        if let Some(cvt) = state.transmission.as_mut().and_then(|t| t.cvt.as_mut()) {
            cvt.belt = BeltAtRatio::new(&self.cvt.belt, ratio);
        }
        state
    }

    /// Heat that a driven step puts into each node, W.
    pub fn heat_w(&self, before: &State, k: usize, row: &Row) -> [f64; NODES] {
        let mut heat_w = loss_heat_w(self.car, &row.loss_w);
        let (w, step) = (row.engine_speed_rad_s, &self.steps[k]);
        if w > 0.0 {
            let engine = self.engine(before, step, before.running.speed_rad_s);
            let crank_w = row.engine_torque_nm * w + row.accessories_w + row.kinetic_w;
            let burn = engine.burn(w, crank_w / w);
            heat_w[COOLANT] += burn.to_coolant_w;
            heat_w[ENGINE_OIL] += burn.to_oil_w;
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

    /// Engine and box of a step at a ratio; the clamp that burns least, where it is free.
    pub fn node(&self, reference: &Reference, k: usize, place: At) -> Node {
        let Clamp::Free { safety, slip } = self.clamp else {
            return self.clamped(reference, k, place, None).0;
        };
        let at = |factor: f64| {
            let law = free_law(safety * factor);
            let (mut node, row) = self.clamped(reference, k, place, Some(law));
            node.safety = safety * factor;
            let held = row.slip.abs() <= slip && !row.flags.contains(Flags::LOW_CLAMP);
            (self.steady_kg_s(reference, k, &node), factor, held, node)
        };
        type Tried = (f64, f64, bool, Node);
        let better = |a: Tried, b: Tried| match (a.2, b.2) {
            (true, false) => a,
            (false, true) => b,
            _ if b.0 < a.0 * (1.0 - CLEARLY) => b,
            _ => a,
        };
        let tried = SAFETIES.map(at);
        let mut best = tried.into_iter().reduce(better).unwrap_or(tried[0]); // DP-4
        let mut step = SAFETIES[1] / SAFETIES[0];
        for _ in 0..HALVINGS {
            step = step.sqrt();
            for factor in [best.1 / step, best.1 * step] {
                if factor > 1.0 {
                    best = better(best, at(factor));
                }
            }
        }
        Node {
            ok: best.3.ok && best.2,
            ..best.3
        }
    }

    /// What a step that no ratio holds is driven with.
    pub fn law_held(&self, ratio: f64) -> Hold {
        let clamp = match self.clamp {
            Clamp::Law => None,
            Clamp::Free { safety, .. } => Some(free_law(safety)),
        };
        Hold {
            ratio,
            clamp,
            paced: false,
        }
    }

    /// What the law of the coupling does in a step at a ratio where it was open before, and where it was locked (TC-7). A clutch that locks by
    /// itself is locked wherever a ratio is chosen (DP-5).
    fn locks(&self, reference: &Reference, k: usize, ratio: f64) -> [bool; 2] {
        self.locks_with(reference, k, (ratio, self.warmer_k))
    }

    /// The same with oil that is warmer, K.
    fn locks_with(
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
        };
        [false, true].map(|past| coupling.hold(&signals, past).coupled)
    }

    /// Least engine speed at which the coupling stays locked, for an engine at a speed in a ratio, rad/s.
    fn locked_rad_s(&self, engine: &EngineAtTemperature, turns: (f64, f64)) -> f64 {
        let coupling = &self.cvt.coupling;
        let least_rad_s = LOCKED * coupling.locked_from_rad_s(engine.idle_rad_s());
        match coupling.by_command() {
            true => least_rad_s * BY_COMMAND * turns.0 / turns.1, // its law looks at the box
            false => least_rad_s,
        }
    }

    /// Nodes of a step on a grid in a mode; a free clamp is searched for at some, and taken from these for those between, where it is allowed.
    pub fn nodes(&self, reference: &Reference, k: usize, grid: &[f64], mode: Mode) -> Vec<Node> {
        let engine = self.engine(&reference.before[k], &self.steps[k], 0.0);
        let mut guess_rad_s = engine.idle_rad_s();
        let mut at = |x: f64, other: &mut dyn FnMut(At) -> Node| {
            let place = At {
                ratio: x.exp(),
                mode,
                guess_rad_s,
            };
            let locks = self.locks(reference, k, place.ratio);
            let reached = match mode {
                Mode::Locked => locks[1],
                Mode::Open => !locks[0],
            };
            if !reached {
                let primary_rad_s = place.ratio * self.secondary_rad_s[k];
                let least = self.locked_rad_s(&engine, (primary_rad_s, primary_rad_s));
                return Node::never(&place, primary_rad_s, least, locks);
            }
            let node = other(place);
            guess_rad_s = node.engine_rad_s;
            node
        };
        let mut full = |place: At| self.node(reference, k, place);
        let Clamp::Free { slip, .. } = self.clamp else {
            return grid.iter().map(|x| at(*x, &mut full)).collect();
        };
        let searched = grid.iter().step_by(SEARCHED);
        let known: Vec<Node> = searched.map(|x| at(*x, &mut full)).collect();
        let mut of = |(number, x): (usize, &f64)| {
            let (before, past) = (number / SEARCHED, number % SEARCHED);
            if past == 0 {
                return known[before];
            }
            // The last ones may have no searched one after them.
            let next = known.get(before + 1);
            let pair = |next: &&Node| [*next, &known[before]].iter().all(|n| n.safety.is_finite());
            let Some(next) = next.filter(pair) else {
                return at(*x, &mut full);
            };
            let share = past as f64 / SEARCHED as f64;
            let safety = Node::between(&known[before], next, share).safety;
            at(*x, &mut |place: At| {
                let (node, row) = self.clamped(reference, k, place, Some(free_law(safety)));
                match row.slip.abs() <= slip {
                    true => Node { safety, ..node },
                    false => self.node(reference, k, place),
                }
            })
        };
        grid.iter().enumerate().map(&mut of).collect()
    }

    /// Fuel of both kinds of overrun at a constant speed in a node, kg/s.
    fn steady_kg_s(&self, reference: &Reference, k: usize, node: &Node) -> f64 {
        let engine = self.engine(&reference.before[k], &self.steps[k], node.engine_rad_s);
        let fuel_kg_s = |nm: f64| engine.burn(node.engine_rad_s, nm).fuel_kg_s;
        fuel_kg_s(node.fired_nm) + fuel_kg_s(node.cut_nm)
    }

    /// A step from a state whose solve may have begun far from this ratio.
    fn held(&self, k: usize, mut before: State, hold: &Hold) -> Row {
        let one = |before: State| self.drive(before).step_held(&self.steps[k], hold).0;
        let row = one(before);
        if !row.flags.contains(Flags::NOT_CONVERGED) {
            return row;
        }
        if let Some(own) = before.transmission.as_mut().and_then(|t| t.cvt.as_mut()) {
            own.warm_start = WarmStart::default();
        }
        one(before)
    }

    /// A step in one mode of the coupling, with the share of overrun cut that belongs to an engine speed before it; over an open coupling with
    /// the engine at the speed at which it stays.
    fn driven(
        &self,
        reference: &Reference,
        k: usize,
        place: &At,
        (hold, cut_rad_s): (&Hold, f64),
    ) -> Row {
        let mut engine_rad_s = match place.mode {
            Mode::Locked => place.ratio * self.secondary_rad_s[k],
            Mode::Open => place.guess_rad_s,
        };
        let mut left = PASSES;
        // As warm as it has to be for this mode (DP-14).
        let [_, stays] = match self.warmer_k > 0.0 {
            true => self.locks_with(reference, k, (place.ratio, 0.0)),
            false => [true; 2],
        };
        let warmer_k = match place.mode == Mode::Locked && !stays {
            true => self.warmer_k,
            false => 0.0,
        };
        loop {
            let before = &reference.before[k];
            let mut before = self.rolling_at(before, place.ratio, engine_rad_s, place.mode);
            before.running.speed_rad_s = cut_rad_s;
            before.heat.node_k[SUMP] += warmer_k;
            let row = self.held(k, before, hold);
            left -= 1;
            let moved = (row.engine_speed_rad_s / engine_rad_s - 1.0).abs();
            let there = moved <= STEADY_PER_S * self.steps[k].dt_s;
            if place.mode == Mode::Locked || there || left == 0 {
                return row;
            }
            engine_rad_s = row.engine_speed_rad_s;
        }
    }

    fn clamped(
        &self,
        reference: &Reference,
        k: usize,
        place: At,
        clamp: Option<ClampLaw>,
    ) -> (Node, Row) {
        let step = &self.steps[k];
        let ratio = place.ratio;
        let hold = Hold {
            ratio,
            clamp,
            paced: false,
        };
        let one = |cut_rad_s: f64| self.driven(reference, k, &place, (&hold, cut_rad_s));
        let fired = one(0.0); // nothing cut
        let cut = if fired.wheel_power_w < 0.0 {
            one(f64::INFINITY) // all cut (EN-11)
        } else {
            fired
        };
        let before = &reference.before[k];
        let mut engine = self.engine(before, step, fired.engine_speed_rad_s);
        let open = place.mode == Mode::Open;
        // Over an open coupling the engine that is dragged is slower than one that turns itself.
        let by = if open && engine.cut_share > 0.5 {
            &cut
        } else {
            &fired
        };
        let w = by.engine_speed_rad_s;
        engine = self.engine(before, step, w);
        let coupling = &self.cvt.coupling;
        let own_drag_nm = engine.own_drag_nm(w);
        let accessories_nm = engine.accessories_nm(w);
        let drag_nm = match (open, coupling.by_command()) {
            (true, _) => (fired.engine_torque_nm - cut.engine_torque_nm).max(0.0),
            (_, true) => own_drag_nm,
            _ => coupling.overrun_share(w, engine.idle_rad_s()) * own_drag_nm,
        };
        let node = Node {
            engine_rad_s: w,
            fired_nm: fired.engine_torque_nm + accessories_nm,
            cut_nm: cut.engine_torque_nm + accessories_nm,
            drag_nm,
            full_load_nm: engine.full_load_nm(w),
            own_drag_nm,
            heat_w: loss_heat_w(self.car, &cut.loss_w),
            safety: f64::NAN,
            deficit_w: match fired.flags.contains(Flags::MISSED_TRACE) {
                true => fired.deficit_w,
                false => 0.0,
            },
            locked_rad_s: self.locked_rad_s(&engine, (w, ratio * self.secondary_rad_s[k])),
            ok: self.in_mode(&fired, place.mode)
                && w <= engine.max_rad_s()
                && fired.solve_residual.max(cut.solve_residual) <= SOLVED,
            mode: place.mode,
            locks: self.locks(reference, k, ratio),
        };
        (node, fired)
    }

    /// True for a step whose coupling is in a mode and whose belt holds.
    fn in_mode(&self, row: &Row, mode: Mode) -> bool {
        let unlocked = match self.cvt.coupling.by_command() {
            true => row.flags.contains(Flags::LOCKUP_OPEN),
            false => row
                .flags
                .any(Flags(Flags::CLUTCH_SLIPPING.0 | Flags::CLUTCH_OPEN.0)),
        };
        unlocked == (mode == Mode::Open) && !row.flags.contains(Flags::GROSS_SLIP)
    }
}

/// PC-3 as a free clamp: its safety factor alone.
pub fn free_law(safety: f64) -> ClampLaw {
    ClampLaw::TorqueFollowing {
        safety,
        least_torque_nm: 0.0,
    }
}
