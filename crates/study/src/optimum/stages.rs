//! The stages of a car on a trace: what engine and wheels do at each ratio, by the model's own step.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-2 | c_t(x, u) = m_f(w(u), T) dt - sum of worth_i P_i dt; T = T_fly(u) + T_acc + J (w(u)2 - w(x)2)/(2 w(u) dt) within SI-2, at most (1 - r) full load; w(u), T_fly(u), P_i by the step held at u | derived: the drive of a step from its ratio before and after; shift flow and PC-5's share of shifting left out, which only lowers it |
//! | DP-5 | with a clutch, a step in which low gives less than the least speed, or before the clutch has locked, goes to low as fast as RC-4 allows; with a torque converter such a step has no limit of speed | derived: RC-6, LC-5; no ratio holds the engine there |

use cvtcycle_model::drive::State;
use cvtcycle_model::engine::EngineAtTemperature;
use cvtcycle_model::flags::Flags;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::thermal::{COOLANT, ENGINE_OIL, NODES};
use cvtcycle_model::transmission::coupling::Coupling;
use cvtcycle_model::transmission::cvt::Hold;
use rayon::prelude::*;

use super::Limits;
use super::node::{At, Mode, Node};
use super::nodes::{Scene, free_law};
use super::program::{Path, Place, Stages};
use super::reference::Reference;

/// Of so many ratios one is enough where the ratio hardly matters.
const SPARSE: usize = 16;
/// Launch in a ratio below this share of low is not one in low.
const IN_LOW: f64 = 0.99;
/// Relative margin of a speed limit.
const NEAR: f64 = 1e-6;

/// The stages of a scene before a limit on the engine's speed: nodes on one grid, none in steps that no ratio holds.
pub struct Table {
    /// Logarithms of the ratio, ascending to low.
    pub grid: Vec<f64>,
    /// Of each step in which a ratio is chosen: with the coupling locked and open; the latter empty with a clutch.
    nodes: Vec<Option<[Vec<Node>; 2]>>,
}

impl Table {
    /// Evaluates every ratio of a grid in every step.
    pub fn new(scene: &Scene, reference: &Reference, count: usize) -> Self {
        let (high, low) = (scene.cvt.ratio.high.ln(), scene.cvt.ratio.low.ln());
        let step = (low - high) / (count - 1) as f64;
        let grid: Vec<f64> = (0..count).map(|k| high + step * k as f64).collect();
        let by_law = scene.by_law(reference);
        let by_command = scene.cvt.coupling.by_command();
        let nodes = (0..scene.steps.len()).into_par_iter().map(|k| {
            let of = |mode: Mode| scene.nodes(reference, k, &grid, mode);
            let open = || by_command.then(|| of(Mode::Open));
            (!by_law[k]).then(|| [of(Mode::Locked), open().unwrap_or_default()])
        });
        let nodes = nodes.collect();
        Table { grid, nodes }
    }

    /// Speeds below which the coupling does not stay locked, rad/s, in some steps.
    pub fn floors_rad_s(&self, steps: &[bool]) -> Vec<Option<f64>> {
        let floor = |(nodes, wanted): (&Option<[Vec<Node>; 2]>, &bool)| {
            let [locked, _] = nodes.as_ref().filter(|_| *wanted)?;
            locked.last().map(|node| node.locked_rad_s)
        };
        self.nodes.iter().zip(steps).map(floor).collect()
    }

    /// Every `stride`-th ratio of it.
    #[must_use]
    pub fn coarser(&self, stride: usize) -> Table {
        let own = |modes: &[Vec<Node>; 2]| {
            [0, 1].map(|mode| modes[mode].iter().step_by(stride).copied().collect())
        };
        Table {
            grid: self.grid.iter().step_by(stride).copied().collect(),
            nodes: self.nodes.iter().map(|n| n.as_ref().map(own)).collect(),
        }
    }
}

/// Fuel of a driven step, kg/s, and its heat into each node, W.
type Driven = (f64, [f64; NODES]);

/// A step with its nodes.
struct Stage {
    x: Vec<f64>,
    /// Engine and box at each, locked ones first; empty where no ratio is chosen (DP-5).
    nodes: Vec<Node>,
    /// How many of them are locked.
    locked: usize,
    /// Whether low gives the least engine speed, so that the limits count.
    limited: bool,
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
    /// Whether the coupling was locked.
    locked: bool,
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

    /// True where the limits of speed and reserve count in a step while the coupling is locked.
    pub fn limited(&self, k: usize) -> bool {
        self.stages[k].limited
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
            let hold = self.scene.law_held(self.reach(k, x).1.exp());
            let mut drive = self.scene.drive(before);
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
                let scene = self.scene;
                scene.rolling_at(before, x.exp(), node.engine_rad_s, node.mode)
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
        if !node.follows(from.locked) {
            return None; // DP-13
        }
        let w = node.engine_rad_s;
        let cut = from.engine.cut_share;
        let steady_nm = node.cut_nm.max(node.fired_nm - cut * node.drag_nm);
        let wanted_nm = (self.scene.kinetic_j(w) - from.kinetic_j) / dt_s / w;
        let most_nm = (1.0 - self.limits.reserve) * node.full_load_nm;
        let free = node.deficit_w > 0.0 || node.mode == Mode::Open;
        if !free && steady_nm + wanted_nm.max(0.0) > most_nm {
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
            let mut hold = self.scene.law_held(path.x[k].exp());
            if let (Some(law), false) = (&mut hold.clamp, nodes.is_empty()) {
                *law = free_law(Node::of(nodes, path.places[k]).safety);
            }
            hold
        };
        (0..self.count()).map(hold).collect()
    }

    /// How the coupling holds engine and box together where a path chooses a ratio.
    pub fn modes(&self, path: &Path) -> Vec<Option<Mode>> {
        let mode = |k: usize| {
            let node = self.stages[k].nodes.get(path.places[k].node);
            node.map(|node| node.mode)
        };
        (0..self.count()).map(mode).collect()
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

/// A grid with the highest ratio that counts as low, so that a launch from it is not taken for one that cannot be made (DP-6).
fn with_low(grid: &[f64]) -> Vec<f64> {
    let mut grid = grid.to_vec();
    let last = grid.len() - 1;
    let near = grid[last] + 0.99 * IN_LOW.ln();
    if grid[last - 1] < near {
        grid.insert(last, near);
    }
    grid
}

/// The one place of a stage that cannot be done, so that it is reported: not allowed at any torque.
fn impossible(x: f64, node: Node) -> (Vec<f64>, Vec<Node>) {
    let node = Node {
        full_load_nm: f64::NEG_INFINITY,
        deficit_w: 0.0,
        ..node
    };
    (vec![x], vec![node])
}

/// Which ratios a step may have.
fn stage(scene: &Scene, table: &Table, reference: &Reference, limits: Limits, k: usize) -> Stage {
    let row = &reference.rows[k];
    let stood = k > 0 && scene.secondary_rad_s[k - 1] <= 0.0;
    let rolls = scene.secondary_rad_s[k] > 0.0;
    let from_low = stood && rolls && !row.flags.contains(Flags::LAUNCH_NOT_IN_LOW);
    let by_law = || Stage {
        x: with_low(&table.grid),
        nodes: Vec::new(),
        locked: 0,
        limited: false,
        by_law: Vec::new(),
        from_low,
    };
    let Some([locked, open]) = &table.nodes[k] else {
        return by_law();
    };
    let (first, last) = (locked[0], locked[locked.len() - 1]);
    let least = limits.least_rad_s.max(last.locked_rad_s);
    let limited = last.engine_rad_s >= least * (1.0 - NEAR);
    if !limited && !scene.cvt.coupling.by_command() {
        return by_law();
    }
    let may = May {
        least_rad_s: if limited { least } else { 0.0 },
        most_w: row.deficit_w * 1.001 + 1.0,
    };
    let mut own = may.locked(scene, reference, k, (&table.grid, locked));
    let count = own.len();
    let open = table.grid.iter().copied().zip(open.iter().copied());
    own.extend(open.filter(|(_, node)| may.have(node)));
    let (x, nodes): (Vec<f64>, Vec<Node>) = own.into_iter().unzip();
    let (x, nodes) = match nodes.is_empty() {
        true => impossible(table.grid[0], first),
        false => (x, nodes),
    };
    Stage {
        x,
        locked: count,
        nodes,
        limited,
        by_law: Vec::new(),
        from_low,
    }
}

/// What a node of a step may be.
struct May {
    /// Least engine speed with the coupling locked, rad/s.
    least_rad_s: f64,
    /// Largest power that is missed, W.
    most_w: f64,
}

impl May {
    fn fast(&self, node: &Node) -> bool {
        node.engine_rad_s >= self.least_rad_s * (1.0 - NEAR)
    }

    fn have(&self, node: &Node) -> bool {
        let held = node.mode == Mode::Open || self.fast(node);
        node.ok && held && node.deficit_w <= self.most_w
    }

    /// Places with the coupling locked. Those in which the engine has just its least speed, which is where most of the best paths run, and its
    /// greatest are among them: so no ratio is cut off from the next one by a distance of the grid that takes more than a step.
    fn locked(
        &self,
        scene: &Scene,
        reference: &Reference,
        k: usize,
        (grid, nodes): (&[f64], &[Node]),
    ) -> Vec<(f64, Node)> {
        let mut own: Vec<(f64, Node)> = Vec::new();
        let between = |k_below: usize, w: f64| {
            let (mut x, mut node) = (*grid.get(k_below + 1)?, *nodes.get(k_below + 1)?);
            for _ in 0..3 {
                x += (w / node.engine_rad_s).ln();
                let place = At {
                    ratio: x.exp(),
                    mode: Mode::Locked,
                    guess_rad_s: w,
                };
                node = scene.node(reference, k, place);
            }
            let inside = x > grid[k_below] + 1e-9 && x < grid[k_below + 1] - 1e-9;
            (inside && self.have(&node)).then_some((x, node))
        };
        let slow = nodes.iter().rposition(|node| !self.fast(node));
        own.extend(slow.and_then(|below| between(below, self.least_rad_s)));
        let on_grid = grid.iter().copied().zip(nodes.iter().copied());
        own.extend(on_grid.filter(|(_, node)| self.have(node)));
        let engine = scene.engine(&reference.before[k], &scene.steps[k], 0.0);
        let most = engine.max_rad_s() * (1.0 - NEAR);
        let below = nodes.partition_point(|node| node.engine_rad_s <= most);
        own.extend(below.checked_sub(1).and_then(|below| between(below, most)));
        own
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

    fn second_layer(&self, stage: usize) -> usize {
        let stage = &self.stages[stage];
        match stage.nodes.is_empty() {
            true => stage.x.len(),
            false => stage.locked,
        }
    }

    fn start(&self) -> f64 {
        self.reference.rows[0].belt_ratio.ln()
    }

    fn reach(&self, k: usize, x: f64) -> (f64, f64) {
        if self.scene.secondary_rad_s[k] <= 0.0 || k == 0 {
            return (x, x);
        }
        let (up, down) = self.scene.reach(k, x, &self.limits);
        match self.chooses(k) {
            true => (up, down),
            false => (down, down), // DP-5
        }
    }

    fn from(&self, k: usize, x: f64, place: Option<Place>) -> From<'a> {
        let before = &self.reference.before[k];
        let nodes = k.checked_sub(1).map(|k| &self.stages[k].nodes);
        let nodes = nodes.filter(|nodes| !nodes.is_empty());
        let (engine_rad_s, kinetic_j, locked) = match (nodes, place) {
            (Some(nodes), Some(place)) => {
                let node = Node::of(nodes, place);
                let w = node.engine_rad_s;
                (w, self.scene.kinetic_j(w), node.mode == Mode::Locked)
            }
            _ => {
                let locked = self.reference.coupled_before(k);
                (before.running.speed_rad_s, before.kinetic_j, locked)
            }
        };
        From {
            kinetic_j,
            engine: self
                .scene
                .engine(before, &self.scene.steps[k], engine_rad_s),
            place,
            x,
            locked,
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
