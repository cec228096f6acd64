//! Which ratios a step may have: a table of all in every step, and those of it that the limits leave.

use super::Limits;
use super::node::{At, Mode, Node};
use super::reference::Reference;
use super::scene::Scene;
use cvtcycle_model::flags::Flags;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::thermal::NODES;
use cvtcycle_model::transmission::coupling::Coupling;
use rayon::prelude::*;

/// Launch in a ratio below this share of low is not one in low.
pub(super) const IN_LOW: f64 = 0.99;
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
pub(super) type Driven = (f64, [f64; NODES]);

/// A step with its nodes.
pub(super) struct Stage {
    pub(super) x: Vec<f64>,
    /// Engine and box at each, locked ones first; empty where no ratio is chosen (DP-5).
    pub(super) nodes: Vec<Node>,
    /// How many of them are locked.
    pub(super) locked: usize,
    /// Whether low gives the least engine speed, so that the limits count.
    pub(super) limited: bool,
    /// Of a step without: fuel and heat, from each place of the stage before.
    pub(super) by_law: Vec<Driven>,
    /// The car pulls away in low.
    pub(super) from_low: bool,
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
pub(super) fn stage(
    scene: &Scene,
    table: &Table,
    reference: &Reference,
    limits: Limits,
    k: usize,
) -> Stage {
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
    pub(super) fn locked(
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
