//! Engine and box in a step at a ratio, by the model's own step.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DP-13 | a coupling that locks by command does so by its law from the state before (TC-7): two layers of ratios, locked and open, and from each into the one that the law leads to at the ratio of the step; open, the engine has the speed at which it stays (TC-2, TC-6) | derived: its law looks at the ratio; reach of the open engine left out, which changes single steps of a launch |
//! | DP-14 | lock-up by temperature is that of the reference; tolerance + \|J - J with the sump 1.5 K warmer for it\|; in DP-7 no step changes its mode | ASSUMED: 1.5 K; what oil warmer than that would save is not in the bound |
//! | DP-4 | free clamp: of the laws PC-3 with S times 1 to 3.4, the one that burns least at the speeds of the node, slip at most its limit | derived: pressure has no memory; any admissible pressure is one of PC-3 with some S |

use cvtcycle_model::drive::{Row, State, loss_heat_w};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::prime_mover::PrimeMover;
use cvtcycle_model::thermal::SUMP;
use cvtcycle_model::transmission::coupling::Coupling;
use cvtcycle_model::transmission::cvt::Hold;
use cvtcycle_model::transmission::cvt::WarmStart;
use cvtcycle_model::transmission::cvt::controller::ClampLaw;

use super::Clamp;
use super::node::{At, Mode, Node};
use super::reference::Reference;
use super::scene::{Scene, free_law};

/// Safety factors that are tried for a free clamp, over the least one.
const SAFETIES: [f64; 5] = [1.0, 1.3, 1.7, 2.3, 3.4];
/// Halvings of the distance between them about the best one.
const HALVINGS: usize = 2;
/// Spacing of the ratios at which the best free clamp is searched: one in so many.
const SEARCHED: usize = 4;
/// Share of fuel by which a higher pressure has to be better.
const CLEARLY: f64 = 1e-6;
/// Residual of a solve that does for the fuel of a step.
const SOLVED: f64 = 1e-3;
/// Most steps in which the engine over an open coupling gets to the speed at which it stays.
const PASSES: usize = 12;
/// Change of that speed over the length of the step, 1/s, below which it is there: no engine is as slow.
const STEADY_PER_S: f64 = 0.08;

impl Scene<'_> {
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
            // The ratio before is the one at the end: the shift itself is left out (DP-2).
            let ratios = (place.ratio, self.level(k, place.ratio));
            let mut before = self.rolling_at(before, ratios, engine_rad_s, place.mode);
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
            end: Some(self.level(k, ratio)),
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
            end_rad_s: by.engine_end_rad_s,
            accessories_nm,
            brake_w: fired.brake_w,
            fired_nm: fired.engine_torque_nm + accessories_nm,
            cut_nm: cut.engine_torque_nm + accessories_nm,
            drag_nm,
            full_load_nm: engine.full_load_nm(w),
            own_drag_nm,
            heat_w: loss_heat_w(self.car, &cut.loss_w),
            safety: f64::NAN,
            deficit_w: match fired.flags.contains(Flags::FULL_LOAD) {
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
