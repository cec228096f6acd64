//! Engine and box in a step at one ratio: the numbers of a node, and those interpolated between two of them.

use cvtcycle_model::thermal::NODES;

use super::place::Place;

/// How the coupling holds engine and box together in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Locked.
    Locked,
    /// Not locked.
    Open,
}

/// Where a step is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct At {
    /// Belt ratio.
    pub ratio: f64,
    /// Mode of the coupling.
    pub mode: Mode,
    /// Guess of the speed of an engine over an open coupling, rad/s.
    pub guess_rad_s: f64,
}

/// Engine and box in a step at one ratio, with the coupling in one mode.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// Engine speed, rad/s.
    pub engine_rad_s: f64,
    /// Engine speed at the end of the step, rad/s.
    pub end_rad_s: f64,
    /// Torque of the accessories, Nm.
    pub accessories_nm: f64,
    /// Power of the brakes where fuel is not cut in overrun, W.
    pub brake_w: f64,
    /// Crank torque without inertia where fuel is not cut in overrun, Nm.
    pub fired_nm: f64,
    /// The same where it is cut.
    pub cut_nm: f64,
    /// Maximum torque taken by a full fuel cut, Nm.
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
    /// True if the coupling stays in this mode, the belt holds, and the engine is within its maximum speed.
    pub ok: bool,
    /// Mode of the coupling.
    pub mode: Mode,
    /// Result of the lock-up law here for a coupling that was open before, and for one that was locked: true if locked.
    pub locks: [bool; 2],
}

impl Node {
    /// A mode that the law of the coupling leads to from no place.
    pub fn never(at: &At, engine_rad_s: f64, locked_rad_s: f64, locks: [bool; 2]) -> Node {
        Node {
            engine_rad_s,
            end_rad_s: engine_rad_s,
            accessories_nm: 0.0,
            brake_w: 0.0,
            fired_nm: 0.0,
            cut_nm: 0.0,
            drag_nm: 0.0,
            full_load_nm: 0.0,
            own_drag_nm: 0.0,
            heat_w: [0.0; NODES],
            safety: f64::NAN,
            deficit_w: 0.0,
            locked_rad_s,
            ok: false,
            mode: at.mode,
            locks,
        }
    }

    /// True where the law of the coupling leads to this mode from a step in which it was locked, or was not (DP-13).
    pub fn follows(&self, was_locked: bool) -> bool {
        self.locks[usize::from(was_locked)] == (self.mode == Mode::Locked)
    }

    pub fn between(a: &Node, b: &Node, share: f64) -> Node {
        let mid = |get: fn(&Node) -> f64| get(a) + share * (get(b) - get(a));
        let mut heat_w = a.heat_w;
        for (heat, next) in heat_w.iter_mut().zip(b.heat_w) {
            *heat += share * (next - *heat);
        }
        Node {
            engine_rad_s: mid(|n| n.engine_rad_s),
            end_rad_s: mid(|n| n.end_rad_s),
            accessories_nm: mid(|n| n.accessories_nm),
            brake_w: mid(|n| n.brake_w),
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
            mode: a.mode,
            locks: [0, 1].map(|was| match a.mode {
                Mode::Locked => a.locks[was] && b.locks[was],
                Mode::Open => a.locks[was] || b.locks[was],
            }),
        }
    }

    /// The node at a place.
    pub fn at_place(nodes: &[Node], at: Place) -> Node {
        match at.share > 0.0 {
            true => Node::between(&nodes[at.node], &nodes[at.node + 1], at.share),
            false => nodes[at.node],
        }
    }
}
