//! The stages of a car on a trace: what engine and wheels do at each ratio, by the model's own step.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-2 | c_t(x, u) = m_f(w(u), T) dt - sum of worth_i P_i dt; T = T_fly(u) + T_acc + J (w(u)2 - w(x)2)/(2 w(u) dt) within SI-2 and SI-5, at most (1 - r) full load; w(u), T_fly(u), P_i by the step held at u, with a ratio at its end at which the engine is as fast then as in its mean | derived: the drive of a step from its ratio before and after; shift flow and PC-5's share of shifting left out, which only lowers it; energy that lags by SI-5 is burnt at once, which is in the tolerance (DP-11); other ways within a step (RC-17) burn up to 0.1 % less |
//! | DP-5 | with a clutch, a step in which low gives less than the least speed, or before the clutch has locked, goes to low as fast as RC-4 allows; with a torque converter such a step has no limit of speed | derived: RC-6, LC-5; no ratio holds the engine there |

use cvtcycle_model::drive::State;
use cvtcycle_model::engine::EngineAtTemperature;
use cvtcycle_model::thermal::{COOLANT, ENGINE_OIL, NODES};
use cvtcycle_model::transmission::cvt::Hold;
use rayon::prelude::*;

use super::Limits;
use super::node::{Mode, Node};
use super::place::Place;
use super::program::{Path, Stages};
use super::reference::Reference;
use super::scene::{Scene, free_law};
use super::stage::{Driven, IN_LOW, Stage, Table, stage};

/// Spacing of the ratios where the ratio hardly matters: one in so many.
const SPARSE: usize = 16;

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
    /// True if the coupling was locked.
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
        let between =
            |x: &f64| Place::locate(*x, &at).map_or(known[0], |place| driven(&known, place));
        begins.iter().map(between).collect()
    }

    /// The state before a step at a place of the stage before.
    fn state(&self, k: usize, x: f64, place: Option<Place>) -> State {
        let before = &self.reference.before[k];
        let nodes = k.checked_sub(1).map(|k| &self.stages[k].nodes);
        match (nodes.filter(|nodes| !nodes.is_empty()), place) {
            (Some(nodes), Some(place)) => {
                let node = Node::at_place(nodes, place);
                let scene = self.scene;
                let ratio = x.exp();
                let end = scene.level(k - 1, ratio);
                scene.rolling_at(before, (ratio, end), node.end_rad_s, node.mode)
            }
            _ => self.scene.in_ratio(before, (x.exp(), x.exp())),
        }
    }

    /// Fuel and worth of heat of a step, kg.
    fn parts(&self, k: usize, from: &From, to: Place) -> Option<(f64, f64)> {
        let (stage, dt_s) = (&self.stages[k], self.scene.steps[k].dt_s);
        let (fuel_kg_s, heat_w) = if stage.nodes.is_empty() {
            driven(&stage.by_law, from.place.unwrap_or(Place::at(0)))
        } else {
            self.held(&Node::at_place(&stage.nodes, to), from, dt_s)?
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
        let wanted_nm = (self.scene.kinetic_j(node.end_rad_s) - from.kinetic_j) / dt_s / w;
        let braked_w = node.brake_w - (node.fired_nm - steady_nm) * w;
        let most_nm = (1.0 - self.limits.reserve) * node.full_load_nm;
        let free = node.deficit_w > 0.0 || node.mode == Mode::Open;
        if !free && steady_nm + wanted_nm.max(0.0) > most_nm {
            return None;
        }
        let torque_nm = if wanted_nm > 0.0 && braked_w > 0.0 && steady_nm < node.accessories_nm {
            // SI-5: the brakes give what they take; the rest lags in a drive, and is burnt at once here.
            (wanted_nm - braked_w / w).clamp(0.0, (node.full_load_nm - steady_nm).max(0.0))
        } else if wanted_nm > 0.0 {
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

    /// Gives the controls along a path.
    pub fn holds(&self, path: &Path) -> Vec<Hold> {
        let hold = |k: usize| {
            let nodes = &self.stages[k].nodes;
            let mut hold = self.scene.law_held(path.x[k].exp());
            if !nodes.is_empty() {
                hold.end = Some(self.scene.level(k, hold.ratio));
            }
            if let (Some(law), false) = (&mut hold.clamp, nodes.is_empty()) {
                *law = free_law(Node::at_place(nodes, path.places[k]).safety);
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
                let node = Node::at_place(nodes, place);
                let w = node.end_rad_s;
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
