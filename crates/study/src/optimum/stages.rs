//! The stages of a car on a trace: what engine and wheels do at each ratio, by the model's own step.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-2 | c_t(x, u) = m_f(w(u), T) dt - sum of worth_i P_i dt; T = T_fly(u) + T_acc + J (w(u)2 - w(x)2)/(2 w(u) dt) within SI-2, at most (1 - r) full load; w(u), T_fly(u), P_i by the step held at u | derived: the drive of a step from its ratio before and after; shift flow and PC-5's share of shifting left out, which only lowers it |
//! | DP-4 | free clamp: of the laws PC-3 with S times 1 to 3.4, the one that burns least at rest in u, slip at most its limit | derived: pressure has no memory; any admissible pressure is one of PC-3 with some S |
//! | DP-5 | a step in which low gives less than the least speed, or before the clutch has locked, goes to low as fast as RC-4 allows | derived: RC-6, LC-5; no ratio holds the engine there |

use cvtcycle_model::cycle::Step;
use cvtcycle_model::drive::{Car, Drive, Row, State, loss_heat_w};
use cvtcycle_model::engine::{EngineAtTemperature, Running};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::thermal::{COOLANT, ENGINE_OIL, NODES};
use cvtcycle_model::transmission::Hold;
use cvtcycle_model::transmission::cvt::variator::BeltAtRatio;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::controller::ClampLaw;
use rayon::prelude::*;

use super::program::{Path, Place, Stages};
use super::reference::Reference;
use super::{Clamp, Limits};

/// Safety factors that are tried for a free clamp, over the least one.
const SAFETIES: [f64; 5] = [1.0, 1.3, 1.7, 2.3, 3.4];
/// Halvings of the distance between them about the best one.
const HALVINGS: usize = 2;
/// Of so many ratios one is enough where the ratio hardly matters.
const SPARSE: usize = 16;
/// Of so many ratios one is searched for its best free clamp.
const SEARCHED: usize = 4;
/// Share of fuel by which a higher pressure has to be better.
const CLEARLY: f64 = 1e-6;
/// Launch in a ratio below this share of low is not one in low.
const IN_LOW: f64 = 0.99;
/// Relative margin of a speed limit.
const NEAR: f64 = 1e-6;
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
    fired_nm: f64,
    /// The same where it is cut.
    cut_nm: f64,
    /// What a full cut takes from it at most, Nm.
    drag_nm: f64,
    full_load_nm: f64,
    own_drag_nm: f64,
    /// Heat of the losses into each node, W.
    heat_w: [f64; NODES],
    /// Safety factor of the clamp law, where the clamp is free.
    safety: f64,
    /// Power that full load does not give, W.
    deficit_w: f64,
    /// Least speed at which the coupling stays locked, rad/s.
    locked_rad_s: f64,
    ok: bool,
}

impl Node {
    fn between(a: &Node, b: &Node, share: f64) -> Node {
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
    fn of(nodes: &[Node], at: Place) -> Node {
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
    fn open(&self, reference: &Reference) -> Vec<bool> {
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

    /// A hold in the temperatures of a drive: no ratio in which the clutch would not stay locked (LC-5).
    pub fn locked(&self, k: usize, state: &State, hold: Hold) -> Hold {
        let engine = self.engine(state, &self.steps[k], state.running.speed_rad_s);
        let locked_rad_s = LOCKED * self.cvt.coupling.locked_from_rad_s(engine.idle_rad_s());
        let least = locked_rad_s / self.secondary_rad_s[k];
        Hold {
            ratio: hold.ratio.max(least.min(self.cvt.ratio.low)),
            ..hold
        }
    }

    /// The engine in a step of a drive, after a speed before it.
    fn engine(&self, state: &State, step: &Step, before_rad_s: f64) -> EngineAtTemperature<'_> {
        let (car, t) = (self.car, &state.heat.node_k);
        let running = Running {
            speed_rad_s: before_rad_s,
            ..state.running
        };
        let (coolant_k, oil_k) = (t[COOLANT], t[ENGINE_OIL]);
        car.engine
            .in_step(coolant_k, oil_k, &car.engine_oil, car.charge, &running, step.dt_s)
    }

    /// A state with another ratio, driven before at an engine speed with the clutch locked.
    fn locked_at(&self, state: &State, ratio: f64, engine_rad_s: f64) -> State {
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
    fn in_ratio(&self, state: &State, ratio: f64) -> State {
        let mut state = *state;
        if let Some(cvt) = state.transmission.as_mut().and_then(|t| t.cvt.as_mut()) {
            cvt.belt = BeltAtRatio::new(&self.cvt.belt, ratio);
        }
        state
    }

    /// Heat that a driven step puts into each node, W.
    fn heat_w(&self, before: &State, k: usize, row: &Row) -> [f64; NODES] {
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

    fn kinetic_j(&self, engine_rad_s: f64) -> f64 {
        0.5 * self.car.engine.inertia_kg_m2 * engine_rad_s * engine_rad_s
    }

    /// Engine and box of a step at a ratio; the clamp that burns least, where it is free.
    fn node(&self, reference: &Reference, k: usize, ratio: f64) -> Node {
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
        let mut best = tried.into_iter().reduce(better).unwrap_or(tried[0]);
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
    fn by_law(&self, ratio: f64) -> Hold {
        let clamp = match self.clamp {
            Clamp::Law => None,
            Clamp::Free { safety, .. } => Some(free_law(safety)),
        };
        Hold { ratio, clamp }
    }

    /// Nodes of a step on a grid; a free clamp is searched for at some, and taken from these for those between, where it is allowed.
    fn nodes(&self, reference: &Reference, k: usize, grid: &[f64]) -> Vec<Node> {
        let ratio = |x: &f64| x.exp();
        let Clamp::Free { slip, .. } = self.clamp else {
            return grid.iter().map(|x| self.node(reference, k, ratio(x))).collect();
        };
        let searched = grid.iter().step_by(SEARCHED);
        let known: Vec<Node> = searched.map(|x| self.node(reference, k, ratio(x))).collect();
        let of = |(number, x): (usize, &f64)| {
            let (place, past) = (number / SEARCHED, number % SEARCHED);
            if past == 0 {
                return known[place];
            }
            let share = past as f64 / SEARCHED as f64;
            let safety = Node::between(&known[place], &known[place + 1], share).safety;
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
        let one = |before: State| {
            let mut drive = Drive::new(self.car, before);
            drive.step_held(step, &Hold { ratio, clamp }).0
        };
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
        let broken = Flags(Flags::NOT_CONVERGED.0 | Flags::GROSS_SLIP.0 | unlocked.0);
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
            ok: !fired.flags.any(broken) && w <= engine.max_rad_s(),
        };
        (node, fired)
    }
}

/// The stages of a scene before a limit on the engine's speed: nodes on one grid, none in steps that no ratio holds.
pub struct Table {
    /// Logarithms of the ratio, ascending to low.
    pub grid: Vec<f64>,
    /// Of each step, where the car rolls with its clutch locked.
    nodes: Vec<Option<Vec<Node>>>,
}

impl Table {
    /// Evaluates every ratio of a grid in every step.
    pub fn new(scene: &Scene, reference: &Reference, count: usize) -> Self {
        let (high, low) = (scene.cvt.ratio.high.ln(), scene.cvt.ratio.low.ln());
        let step = (low - high) / (count - 1) as f64;
        let grid: Vec<f64> = (0..count).map(|k| high + step * k as f64).collect();
        let open = scene.open(reference);
        let nodes = (0..scene.steps.len()).into_par_iter().map(|k| {
            (!open[k]).then(|| scene.nodes(reference, k, &grid))
        });
        let nodes = nodes.collect();
        Table { grid, nodes }
    }

    /// Every `stride`-th ratio of it.
    #[must_use]
    pub fn coarser(&self, stride: usize) -> Table {
        let own = |nodes: &Vec<Node>| nodes.iter().step_by(stride).copied().collect();
        Table {
            grid: self.grid.iter().step_by(stride).copied().collect(),
            nodes: self.nodes.iter().map(|n| n.as_ref().map(own)).collect(),
        }
    }
}

/// Fuel of a driven step, kg/s, and its heat into each node, W.
type Driven = (f64, [f64; NODES]);

/// PC-3 as a free clamp: its safety factor alone.
fn free_law(safety: f64) -> ClampLaw {
    ClampLaw::TorqueFollowing {
        safety,
        least_torque_nm: 0.0,
    }
}

/// A step with its nodes.
struct Stage {
    x: Vec<f64>,
    /// Engine and box at each; empty where no ratio holds the engine (DP-5).
    nodes: Vec<Node>,
    /// Of a step without: fuel and heat, from each place of the stage before.
    by_law: Vec<Driven>,
    /// The car pulls away in low.
    from_low: bool,
}

/// The problem: a scene under limits, in the temperatures of a reference drive.
pub struct Problem<'a> {
    scene: &'a Scene<'a>,
    reference: &'a Reference,
    /// Worth of heat, kg/J.
    worth: &'a [[f64; NODES]],
    limits: Limits,
    stages: Vec<Stage>,
}

/// Where a stage begins.
pub struct From<'a> {
    kinetic_j: f64,
    engine: EngineAtTemperature<'a>,
    place: Option<Place>,
    x: f64,
}

impl<'a> Problem<'a> {
    /// Stages from a table under limits.
    pub fn new(
        scene: &'a Scene<'a>,
        table: &Table,
        reference: &'a Reference,
        worth: &'a [[f64; NODES]],
        limits: Limits,
    ) -> Self {
        let stages = (0..scene.steps.len()).into_par_iter();
        let mut problem = Problem {
            scene,
            reference,
            worth,
            limits,
            stages: stages
                .map(|k| stage(scene, table, reference, limits, k))
                .collect(),
        };
        let by_law: Vec<_> = (0..scene.steps.len())
            .into_par_iter()
            .map(|k| problem.by_law(k))
            .collect();
        for (stage, by_law) in problem.stages.iter_mut().zip(by_law) {
            stage.by_law = by_law;
        }
        problem
    }

    /// True where a ratio is chosen in a step.
    pub fn chooses(&self, k: usize) -> bool {
        !self.stages[k].nodes.is_empty()
    }

    /// Fuel and heat of a step that no ratio holds, from each place of the stage before.
    fn by_law(&self, k: usize) -> Vec<Driven> {
        if self.chooses(k) {
            return Vec::new();
        }
        let start = [self.start()];
        let begins = match k.checked_sub(1) {
            Some(before) => &self.stages[before].x,
            None => &start[..],
        };
        let of = |place: usize| {
            let x = begins[place];
            let before = self.state(k, x, (k > 0).then_some(Place::at(place)));
            let mut drive = Drive::new(self.scene.car, before);
            let hold = self.scene.by_law(self.reach(k, x).1.exp());
            let row = drive.step_held(&self.scene.steps[k], &hold).0;
            (row.fuel_kg_s, self.scene.heat_w(&before, k, &row))
        };
        let chosen_before = k > 0 && self.chooses(k - 1);
        if chosen_before || begins.len() <= SPARSE {
            return (0..begins.len()).map(of).collect();
        }
        // Clutch open or car at rest before: the ratio hardly matters, so some places do for all.
        let last = begins.len() - 1;
        let places: Vec<usize> = (0..last).step_by(SPARSE).chain([last]).collect();
        let known: Vec<Driven> = places.iter().map(|place| of(*place)).collect();
        let at: Vec<f64> = places.iter().map(|place| begins[*place]).collect();
        let between = |x: &f64| Place::of(*x, &at).map_or(known[0], |place| driven(&known, place));
        begins.iter().map(between).collect()
    }

    /// The state before a step at a place of the stage before.
    fn state(&self, k: usize, x: f64, place: Option<Place>) -> State {
        let before = &self.reference.before[k];
        let nodes = k.checked_sub(1).map(|k| &self.stages[k].nodes);
        match (nodes.filter(|nodes| !nodes.is_empty()), place) {
            (Some(nodes), Some(place)) => {
                let node = Node::of(nodes, place);
                self.scene.locked_at(before, x.exp(), node.engine_rad_s)
            }
            _ => self.scene.in_ratio(before, x.exp()),
        }
    }

    /// Fuel and worth of heat of a step, kg.
    fn parts(&self, k: usize, from: &From, to: Place) -> Option<(f64, f64)> {
        let (stage, dt_s) = (&self.stages[k], self.scene.steps[k].dt_s);
        let (fuel_kg_s, heat_w) = if stage.nodes.is_empty() {
            driven(&stage.by_law, from.place.unwrap_or(Place::at(0)))
        } else {
            self.held(&Node::of(&stage.nodes, to), from, dt_s)?
        };
        let worth = heat_w.iter().zip(&self.worth[k]);
        let worth_kg_s: f64 = worth.map(|(w, worth)| w * worth).sum();
        Some((fuel_kg_s * dt_s, worth_kg_s * dt_s))
    }

    /// Fuel in kg/s and heat in W at a node, from an engine before it (DP-2); none above the torque that is allowed.
    fn held(&self, node: &Node, from: &From, dt_s: f64) -> Option<Driven> {
        let w = node.engine_rad_s;
        let cut = from.engine.cut_share;
        let steady_nm = node.cut_nm.max(node.fired_nm - cut * node.drag_nm);
        let wanted_nm = (self.scene.kinetic_j(w) - from.kinetic_j) / dt_s / w;
        let most_nm = (1.0 - self.limits.reserve) * node.full_load_nm;
        let missed = node.deficit_w > 0.0;
        if !missed && steady_nm + wanted_nm.max(0.0) > most_nm {
            return None;
        }
        let torque_nm = if wanted_nm > 0.0 {
            wanted_nm.min((node.full_load_nm - steady_nm).max(0.0))
        } else {
            wanted_nm.max(-(steady_nm + node.own_drag_nm)).min(0.0) // SI-2
        };
        let burn = from.engine.burn(w, steady_nm + torque_nm);
        let mut heat_w = node.heat_w;
        heat_w[COOLANT] += burn.to_coolant_w;
        heat_w[ENGINE_OIL] += burn.to_oil_w;
        Some((burn.fuel_kg_s, heat_w)) // DP-2
    }

    /// What drives a path.
    pub fn holds(&self, path: &Path) -> Vec<Hold> {
        let hold = |k: usize| {
            let nodes = &self.stages[k].nodes;
            let mut hold = self.scene.by_law(path.x[k].exp());
            if let (Some(law), false) = (&mut hold.clamp, nodes.is_empty()) {
                *law = free_law(Node::of(nodes, path.places[k]).safety);
            }
            hold
        };
        (0..self.count()).map(hold).collect()
    }
}

/// Fuel and heat at a place, from those at the nodes.
fn driven(by_law: &[Driven], from: Place) -> Driven {
    let (mut fuel_kg_s, mut heat_w) = by_law[from.node];
    if from.share > 0.0 {
        let (next_kg_s, next_w) = by_law[from.node + 1];
        fuel_kg_s += from.share * (next_kg_s - fuel_kg_s);
        for (heat, next) in heat_w.iter_mut().zip(next_w) {
            *heat += from.share * (next - *heat);
        }
    }
    (fuel_kg_s, heat_w)
}

/// Which ratios a step may have.
fn stage(scene: &Scene, table: &Table, reference: &Reference, limits: Limits, k: usize) -> Stage {
    let grid = &table.grid;
    let by_law = |from_low: bool| Stage {
        x: grid.clone(),
        nodes: Vec::new(),
        by_law: Vec::new(),
        from_low,
    };
    let row = &reference.rows[k];
    let stood = k == 0 || scene.secondary_rad_s[k - 1] <= 0.0;
    let rolls = scene.secondary_rad_s[k] > 0.0;
    let from_low = stood && rolls && !row.flags.contains(Flags::LAUNCH_NOT_IN_LOW);
    let Some(nodes) = &table.nodes[k] else {
        return by_law(from_low);
    };
    let last = nodes[nodes.len() - 1];
    let least = limits.least_rad_s.max(last.locked_rad_s);
    let fast = |node: &Node| node.engine_rad_s >= least * (1.0 - NEAR);
    if !fast(&last) {
        return by_law(from_low);
    }
    let most_w = row.deficit_w * 1.001 + 1.0;
    let allowed = |node: &Node| node.ok && fast(node) && node.deficit_w <= most_w;
    let mut own: Vec<(f64, Node)> = Vec::new();
    // The place in which the engine has just its least speed, which is where most of the best paths run.
    let slow = nodes.iter().rposition(|node| !fast(node));
    if let Some(slow) = slow.filter(|slow| slow + 1 < nodes.len()) {
        let (mut x, mut node) = (grid[slow + 1], nodes[slow + 1]);
        for _ in 0..3 {
            x += (least / node.engine_rad_s).ln();
            node = scene.node(reference, k, x.exp());
        }
        if allowed(&node) && x > grid[slow] && x < grid[slow + 1] - 1e-9 {
            own.push((x, node));
        }
    }
    let on_grid = grid.iter().copied().zip(nodes.iter().copied());
    own.extend(on_grid.filter(|(_, node)| allowed(node)));
    let (x, nodes): (Vec<f64>, Vec<Node>) = own.into_iter().unzip();
    if nodes.is_empty() {
        // Reported as a stage that cannot be done: one place, not allowed.
        return Stage {
            x: vec![grid[0]],
            nodes: vec![Node {
                full_load_nm: f64::NEG_INFINITY,
                ..table.nodes[k].as_ref().map_or(last, |nodes| nodes[0])
            }],
            by_law: Vec::new(),
            from_low,
        };
    }
    Stage {
        x,
        nodes,
        by_law: Vec::new(),
        from_low,
    }
}

impl<'a> Stages for Problem<'a> {
    type From = From<'a>;

    fn count(&self) -> usize {
        self.stages.len()
    }

    fn nodes(&self, stage: usize) -> &[f64] {
        &self.stages[stage].x
    }

    fn start(&self) -> f64 {
        self.reference.rows[0].belt_ratio.ln()
    }

    fn reach(&self, k: usize, x: f64) -> (f64, f64) {
        let (secondary, dt_s) = (self.scene.secondary_rad_s[k], self.scene.steps[k].dt_s);
        if secondary <= 0.0 || k == 0 {
            return (x, x);
        }
        let ratio = &self.scene.cvt.ratio;
        let pace = (x.exp() * secondary / ratio.rate_speed_rad_s).clamp(0.0, 1.0);
        let low = self.scene.cvt.ratio.low.ln();
        let down = (x + self.limits.down_per_s * pace * dt_s).min(low); // RC-4
        if self.stages[k].nodes.is_empty() {
            return (down, down); // DP-5
        }
        let up = x - self.limits.up_per_s * pace * dt_s; // RC-4
        (up, down)
    }

    fn from(&self, k: usize, x: f64, place: Option<Place>) -> From<'a> {
        let before = &self.reference.before[k];
        let nodes = k.checked_sub(1).map(|k| &self.stages[k].nodes);
        let (engine_rad_s, kinetic_j) = match (nodes.filter(|nodes| !nodes.is_empty()), place) {
            (Some(nodes), Some(place)) => {
                let w = Node::of(nodes, place).engine_rad_s;
                (w, self.scene.kinetic_j(w))
            }
            _ => (before.running.speed_rad_s, before.kinetic_j),
        };
        From {
            kinetic_j,
            engine: self.scene.engine(before, &self.scene.steps[k], engine_rad_s),
            place,
            x,
        }
    }

    fn cost(&self, k: usize, from: &From<'a>, to: Place) -> f64 {
        let low = self.scene.cvt.ratio.low;
        if self.stages[k].from_low && from.x < (IN_LOW * low).ln() {
            return f64::INFINITY; // a launch is one in low
        }
        self.parts(k, from, to)
            .map_or(f64::INFINITY, |(fuel, worth)| fuel - worth)
    }
}
