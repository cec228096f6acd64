//! What engine and box do in a step at a ratio, by the model's own step.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-4 | free clamp: of the laws PC-3 with S times 1 to 3.4, the one that burns least at the speeds of the node, slip at most its limit | derived: pressure has no memory; any admissible pressure is one of PC-3 with some S |

use cvtcycle_model::cycle::Step;
use cvtcycle_model::drive::{Car, Drive, Row, State, loss_heat_w};
use cvtcycle_model::engine::{EngineAtTemperature, Running};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::thermal::{COOLANT, ENGINE_OIL, NODES};
use cvtcycle_model::transmission::cvt::WarmStart;
use cvtcycle_model::transmission::cvt::controller::ClampLaw;
use cvtcycle_model::transmission::cvt::variator::BeltAtRatio;
use cvtcycle_model::transmission::cvt::{Cvt, Hold};

use super::program::Place;
use super::reference::Reference;
use super::{Clamp, Limits};

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

/// A car on a trace.
pub struct Scene<'a> {
    /// The car.
    pub car: &'a Car,
    /// Its box.
    pub cvt: &'a Cvt,
    /// The steps of the trace.
    pub steps: &'a [Step],
    /// Speed of the secondary in each step, rad/s.
    pub secondary_rad_s: Vec<f64>,
    /// What clamps the belt.
    pub clamp: Clamp,
}

/// Engine and box in a step at one ratio, with the coupling locked.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Engine speed, rad/s.
    pub engine_rad_s: f64,
    /// Crank torque without inertia where fuel is not cut in overrun, Nm.
    pub fired_nm: f64,
    /// The same where it is cut.
    pub cut_nm: f64,
    /// What a full cut takes from it at most, Nm.
    pub drag_nm: f64,
    /// Full load, Nm.
    pub full_load_nm: f64,
    /// Drag without fuel, Nm.
    pub own_drag_nm: f64,
    /// Heat of the losses into each node, W.
    pub heat_w: [f64; NODES],
    /// Safety factor of the clamp law, where the clamp is free.
    pub safety: f64,
    /// Power that full load does not give, W.
    pub deficit_w: f64,
    /// Least speed at which the coupling stays locked, rad/s.
    pub locked_rad_s: f64,
    /// Whether the clutch stays locked, the belt holds, and the engine is no faster than it may be.
    pub ok: bool,
}

impl Node {
    pub fn between(a: &Node, b: &Node, share: f64) -> Node {
        let mid = |get: fn(&Node) -> f64| get(a) + share * (get(b) - get(a));
        let mut heat_w = a.heat_w;
        for (heat, next) in heat_w.iter_mut().zip(b.heat_w) {
            *heat += share * (next - *heat);
        }
        Node {
            engine_rad_s: mid(|n| n.engine_rad_s),
            fired_nm: mid(|n| n.fired_nm),
            cut_nm: mid(|n| n.cut_nm),
            drag_nm: mid(|n| n.drag_nm),
            full_load_nm: mid(|n| n.full_load_nm),
            own_drag_nm: mid(|n| n.own_drag_nm),
            heat_w,
            safety: mid(|n| n.safety),
            deficit_w: mid(|n| n.deficit_w),
            locked_rad_s: mid(|n| n.locked_rad_s),
            ok: a.ok && b.ok,
        }
    }

    /// The node at a place.
    pub fn of(nodes: &[Node], at: Place) -> Node {
        match at.share > 0.0 {
            true => Node::between(&nodes[at.node], &nodes[at.node + 1], at.share),
            false => nodes[at.node],
        }
    }
}

impl<'a> Scene<'a> {
    /// A car with a CVT on the steps of a trace; none for another box.
    pub fn new(car: &'a Car, cvt: &'a Cvt, steps: &'a [Step], clamp: Clamp) -> Self {
        let secondary = |step: &Step| {
            let wheel = car.road_load.wheel(step, 0.0);
            cvt.final_drive.ratio * wheel.wheel_rad_s
        };
        Scene {
            car,
            cvt,
            steps,
            secondary_rad_s: steps.iter().map(secondary).collect(),
            clamp,
        }
    }

    /// Steps in which no ratio holds the engine: at rest, where even low is too slow, and from there until the clutch of the reference has locked.
    pub fn open(&self, reference: &Reference) -> Vec<bool> {
        let mut open = true;
        let mut of = |k: usize| {
            let (before, step) = (&reference.before[k], &self.steps[k]);
            let engine = self.engine(before, step, before.running.speed_rad_s);
            let locked_rad_s = self.cvt.coupling.locked_from_rad_s(engine.idle_rad_s());
            let fastest_rad_s = self.cvt.ratio.low * self.secondary_rad_s[k];
            let slow = k == 0 || step.engine_off || fastest_rad_s < LOCKED * locked_rad_s;
            open = slow || open && !reference.coupled_before(k);
            open
        };
        (0..self.steps.len()).map(&mut of).collect()
    }

    /// A chosen hold in the temperatures of a drive: no ratio in which the clutch would not stay locked (LC-5), none beyond the rates (RC-4),
    /// and no other one before it has locked (RC-6).
    pub fn locked(&self, k: usize, state: &State, hold: Hold, limits: &Limits) -> Hold {
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
        let ratio = match coupled {
            true => hold.ratio.max(least).clamp(up.exp(), down.exp()),
            false => hold.ratio.min(down.exp()).max(before),
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
        car.engine.in_step(
            coolant_k,
            oil_k,
            &car.engine_oil,
            car.charge,
            &running,
            step.dt_s,
        )
    }

    /// A state with another ratio, driven before at an engine speed with the clutch locked.
    pub fn locked_at(&self, state: &State, ratio: f64, engine_rad_s: f64) -> State {
        let mut state = self.in_ratio(state, ratio);
        if let Some(transmission) = &mut state.transmission {
            transmission.driveline.engine_rad_s = engine_rad_s;
            transmission.driveline.coupled = true;
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
    pub fn node(&self, reference: &Reference, k: usize, ratio: f64) -> Node {
        let Clamp::Free { safety, slip } = self.clamp else {
            return self.clamped(reference, k, ratio, None).0;
        };
        let at = |factor: f64| {
            let law = free_law(safety * factor);
            let (mut node, row) = self.clamped(reference, k, ratio, Some(law));
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
    pub fn by_law(&self, ratio: f64) -> Hold {
        let clamp = match self.clamp {
            Clamp::Law => None,
            Clamp::Free { safety, .. } => Some(free_law(safety)),
        };
        Hold { ratio, clamp }
    }

    /// Nodes of a step on a grid; a free clamp is searched for at some, and taken from these for those between, where it is allowed.
    pub fn nodes(&self, reference: &Reference, k: usize, grid: &[f64]) -> Vec<Node> {
        let ratio = |x: &f64| x.exp();
        let Clamp::Free { slip, .. } = self.clamp else {
            return grid
                .iter()
                .map(|x| self.node(reference, k, ratio(x)))
                .collect();
        };
        let searched = grid.iter().step_by(SEARCHED);
        let known: Vec<Node> = searched
            .map(|x| self.node(reference, k, ratio(x)))
            .collect();
        let of = |(number, x): (usize, &f64)| {
            let (place, past) = (number / SEARCHED, number % SEARCHED);
            if past == 0 {
                return known[place];
            }
            // The last ones may have no searched one after them.
            let Some(next) = known.get(place + 1) else {
                return self.node(reference, k, ratio(x));
            };
            let share = past as f64 / SEARCHED as f64;
            let safety = Node::between(&known[place], next, share).safety;
            let (node, row) = self.clamped(reference, k, ratio(x), Some(free_law(safety)));
            match row.slip.abs() <= slip {
                true => Node { safety, ..node },
                false => self.node(reference, k, ratio(x)),
            }
        };
        grid.iter().enumerate().map(of).collect()
    }

    /// Fuel of both kinds of overrun at a constant speed in a node, kg/s.
    fn steady_kg_s(&self, reference: &Reference, k: usize, node: &Node) -> f64 {
        let engine = self.engine(&reference.before[k], &self.steps[k], node.engine_rad_s);
        let fuel_kg_s = |nm: f64| engine.burn(node.engine_rad_s, nm).fuel_kg_s;
        fuel_kg_s(node.fired_nm) + fuel_kg_s(node.cut_nm)
    }

    /// A step from a state whose solve may have begun far from this ratio.
    fn held(&self, k: usize, mut before: State, hold: &Hold) -> Row {
        let one = |before: State| {
            Drive::new(self.car, before)
                .step_held(&self.steps[k], hold)
                .0
        };
        let row = one(before);
        if !row.flags.contains(Flags::NOT_CONVERGED) {
            return row;
        }
        if let Some(own) = before.transmission.as_mut().and_then(|t| t.cvt.as_mut()) {
            own.warm_start = WarmStart::default();
        }
        one(before)
    }

    fn clamped(
        &self,
        reference: &Reference,
        k: usize,
        ratio: f64,
        clamp: Option<ClampLaw>,
    ) -> (Node, Row) {
        let step = &self.steps[k];
        let primary_rad_s = ratio * self.secondary_rad_s[k];
        let mut before = self.locked_at(&reference.before[k], ratio, primary_rad_s);
        let one = |before: State| self.held(k, before, &Hold { ratio, clamp });
        before.running.speed_rad_s = 0.0; // nothing cut
        let fired = one(before);
        let cut = if fired.wheel_power_w < 0.0 {
            before.running.speed_rad_s = f64::INFINITY; // all cut (EN-11)
            one(before)
        } else {
            fired
        };
        let w = fired.engine_speed_rad_s;
        let engine = self.engine(&before, step, w);
        let coupling = &self.cvt.coupling;
        let own_drag_nm = engine.own_drag_nm(w);
        let unlocked = Flags(Flags::CLUTCH_SLIPPING.0 | Flags::CLUTCH_OPEN.0);
        let broken = Flags(Flags::GROSS_SLIP.0 | unlocked.0);
        let accessories_nm = engine.accessories_nm(w);
        let locked_rad_s = LOCKED * coupling.locked_from_rad_s(engine.idle_rad_s());
        let node = Node {
            engine_rad_s: w,
            fired_nm: fired.engine_torque_nm + accessories_nm,
            cut_nm: cut.engine_torque_nm + accessories_nm,
            drag_nm: coupling.overrun_share(w, engine.idle_rad_s()) * own_drag_nm,
            full_load_nm: engine.full_load_nm(w),
            own_drag_nm,
            heat_w: loss_heat_w(self.car, &cut.loss_w),
            safety: f64::NAN,
            deficit_w: match fired.flags.contains(Flags::MISSED_TRACE) {
                true => fired.deficit_w,
                false => 0.0,
            },
            locked_rad_s,
            ok: !fired.flags.any(broken)
                && w <= engine.max_rad_s()
                && fired.solve_residual.max(cut.solve_residual) <= SOLVED,
        };
        (node, fired)
    }
}

/// PC-3 as a free clamp: its safety factor alone.
pub fn free_law(safety: f64) -> ClampLaw {
    ClampLaw::TorqueFollowing {
        safety,
        least_torque_nm: 0.0,
    }
}
