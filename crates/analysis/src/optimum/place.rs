//! A place between two nodes of a stage, and the value there (DP-6 of `program`).

/// Places nearer than this are one.
pub const NEAR: f64 = 1e-12;

/// A place between two nodes of a stage: a share of the way from one to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The node at or below.
    pub node: usize,
    /// Share of the way to the next, 0 to less than 1.
    pub share: f64,
}

impl Place {
    /// A node itself.
    pub const fn at(node: usize) -> Self {
        Place { node, share: 0.0 }
    }

    /// Where `x` is among ascending `nodes`; none outside them.
    pub fn of(x: f64, nodes: &[f64]) -> Option<Self> {
        let above = nodes.partition_point(|node| *node < x - NEAR);
        let node = *nodes.get(above)?;
        if node <= x + NEAR {
            return Some(Place::at(above));
        }
        let below = above.checked_sub(1)?;
        Some(Place {
            node: below,
            share: (x - nodes[below]) / (node - nodes[below]),
        })
    }

    /// The same place among nodes that begin later.
    pub(super) fn later(self, by: usize) -> Self {
        Place {
            node: self.node + by,
            ..self
        }
    }

    /// A quantity here from its values at the nodes, linear between them; infinite next to an infinite one (DP-6).
    pub fn value(&self, at_nodes: &[f64]) -> f64 {
        let here = at_nodes[self.node];
        if self.share <= 0.0 {
            return here;
        }
        let next = at_nodes[self.node + 1];
        if here.is_finite() && next.is_finite() {
            here + self.share * (next - here)
        } else {
            f64::INFINITY // DP-6
        }
    }
}
