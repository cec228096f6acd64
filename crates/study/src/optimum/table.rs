//! A table of every ratio of a grid in every step, before any limit.

use super::node::{Mode, Node};
use super::reference::Reference;
use super::scene::Scene;
use rayon::prelude::*;

/// The stages of a scene before a limit on the engine's speed: nodes on one grid, none in steps that no ratio holds.
pub struct Table {
    /// Logarithms of the ratio, ascending to low.
    pub grid: Vec<f64>,
    /// Of each step in which a ratio is chosen: with the coupling locked and open; the latter empty with a clutch.
    pub(super) nodes: Vec<Option<[Vec<Node>; 2]>>,
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
