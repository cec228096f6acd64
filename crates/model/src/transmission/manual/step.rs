//! One step of the manual box: engaged, declutched or in neutral.

use super::engaged::sum_nm;
use super::{Action, Engaged, Manual, PartLosses};
use crate::flags::Flags;
use crate::lubricant::OilState;
use crate::math::{Mask, Real, larger, physics};
use crate::prime_mover::{FULL_LOAD_LIMIT, PrimeMover};
use crate::thermal::SUMP;
use crate::transmission::component::Component;
use crate::transmission::coupling::{Coupling, CouplingLoad, Turning};
use crate::transmission::step::{DrivelineState, StepInput, StepOutput};

/// Speed over that of the box from which a coupling slips, but for rounding.
const SLIPS_FROM: f64 = 1.0 + 1e-9;

/// The box in a step, in its oil.
pub(super) struct ManualStep<'a, P, R: Real = f64> {
    pub manual: &'a Manual<R>,
    pub step: &'a StepInput<'a, P, R>,
    pub state: &'a DrivelineState<R>,
    pub oil: OilState<R>,
}

#[physics]
impl<P: PrimeMover<R>, R: Real> ManualStep<'_, P, R> {
    /// Computes each kind of action once for all runs and selects it in the runs that take it.
    pub fn act(&self, actions: &R::PerLane<Action>, output: &mut StepOutput<R>) {
        let like = self.oil.density_kg_m3;
        if R::LANES == 1 {
            return self.act_alike(*R::get(actions, 0), output);
        }
        let mut left = like.splat_mask(true);
        for run in 0..R::LANES {
            if !left.lane(run) {
                continue;
            }
            let action = *R::get(actions, run);
            let alike = left & like.mask_lanes(|run| *R::get(actions, run) == action);
            let mut of_action = StepOutput::like(like);
            self.act_alike(action, &mut of_action);
            if alike.all() {
                *output = of_action;
                return;
            }
            output.take(alike, &of_action);
            left = left & !alike;
        }
    }

    /// Computes one action for all runs.
    fn act_alike(&self, action: Action, output: &mut StepOutput<R>) {
        match action {
            Action::Engaged(gear) => {
                self.engaged(gear, self.oil.density_kg_m3.splat_mask(true), output);
            }
            Action::Coasting(gear) => self.coasting(gear, output),
            Action::Neutral => self.neutral(output),
        }
    }

    /// The box in a gear at an input speed and a demanded torque.
    fn box_in(&self, gear: u8, input_rad_s: R, demand_nm: R) -> Engaged<'_, R> {
        let oil_k = self.step.heat.node_k[SUMP];
        self.manual
            .engaged(gear, input_rad_s, demand_nm, (self.oil, oil_k))
    }

    /// The highest gear.
    #[inline]
    fn top(&self) -> u8 {
        self.manual.overall.len() as u8
    }

    /// Speed of the free engine at the end of the step, rad/s.
    fn free_engine_rad_s(&self) -> R {
        let before_rad_s = self.state.engine_rad_s;
        self.step
            .reach(before_rad_s, before_rad_s.splat(0.0))
            .nearest(self.step.engine.idle_rad_s())
    }

    /// Declutched, unless the car would then slow down more than it should: the driver lets the clutch slip in that gear or a lower one.
    fn coasting(&self, gear: u8, output: &mut StepOutput<R>) {
        self.declutched(gear, output);
        let lags = output.deficit_w.gt(0.0);
        if lags.any() {
            self.engaged(gear.max(1), lags, output);
        }
    }

    fn neutral(&self, output: &mut StepOutput<R>) {
        let w = self.free_engine_rad_s();
        let losses = self.box_in(self.top(), w, w.splat(0.0)).unloaded_nm();
        let share = self.manual.neutral_share;
        output.engine_rad_s = w;
        output.end_rad_s = w;
        output.shaft_nm = share * sum_nm(&losses);
        lose(output, &losses, share * w);
        self.set_throttle(output, self.step.engine.full_load_nm(w));
    }

    /// Clutch open, the wheels turn the box in `gear` (0: its highest), the engine idles.
    fn declutched(&self, gear: u8, output: &mut StepOutput<R>) {
        let gear = if gear == 0 { self.top() } else { gear };
        let input = self.manual.overall[usize::from(gear) - 1] * self.step.wheel.wheel_rad_s;
        let losses = self.box_in(gear, input, input.splat(0.0)).unloaded_nm();
        output.engine_rad_s = self.free_engine_rad_s();
        output.end_rad_s = output.engine_rad_s;
        output.gear = R::per_lane(|_| gear);
        output.flag(Flags::CLUTCH_OPEN, input.splat_mask(true));
        let turns = input.gt(0.0);
        if turns.any() {
            let output_nm = -sum_nm(&losses);
            lose(output, &losses, input);
            output.split_of(turns, self.step.wheel, output_nm * input);
        }
        let full_load_nm = self.step.engine.full_load_nm(output.engine_rad_s);
        self.set_throttle(output, full_load_nm);
    }

    /// The box in a gear, or in a lower one where that lacks torque; fills the output of the runs of a mask anew.
    #[inline]
    fn engaged(&self, gear: u8, runs: R::Mask, output: &mut StepOutput<R>) {
        let like = self.oil.density_kg_m3;
        like.vectorize(|| {
            let (mut gear, mut open) = (gear, runs);
            loop {
                let mut other = StepOutput::like(like);
                let alone = R::LANES == 1;
                let lacks = self.in_gear(gear, if alone { &mut *output } else { &mut other });
                if !alone {
                    output.take(open, &other);
                }
                open = open & lacks;
                if !open.any() {
                    break;
                }
                open = open & self.may_shift_down(gear);
                if !open.any() {
                    break;
                }
                gear -= 1;
            }
        });
    }

    /// Where there is a gear below, and the engine may turn as fast as the wheels would have it there, at the faster end of the step.
    fn may_shift_down(&self, gear: u8) -> R::Mask {
        let wheel = self.step.wheel;
        let [first, last] = wheel.ends_over_mean(self.step.dt_s);
        let wheel_rad_s = larger(first, last) * wheel.wheel_rad_s;
        match usize::from(gear).checked_sub(2) {
            Some(below) => {
                (self.manual.overall[below] * wheel_rad_s).lt(self.step.engine.max_rad_s())
            }
            None => wheel_rad_s.splat_mask(false),
        }
    }

    /// Sets the throttle, for the engine's full load at its speed.
    fn set_throttle(&self, output: &mut StepOutput<R>, full_load_nm: R) {
        let engine = self.step.engine;
        let crank_nm = output.shaft_nm + engine.accessories_nm(output.engine_rad_s);
        let share = crank_nm / full_load_nm;
        output.throttle = share.clamp(0.0, 1.0);
        output.flag(Flags::OUTSIDE_VALIDITY, share.gt(FULL_LOAD_LIMIT));
    }

    /// The box in a gear: the torque demanded, or the one at the engine's limit. Yes where the gear lacks torque; it does too where only an
    /// engine that still comes down from a lower gear has enough.
    fn in_gear(&self, gear: u8, output: &mut StepOutput<R>) -> R::Mask {
        let (engine, wheel) = (self.step.engine, self.step.wheel);
        let coupling = &self.manual.coupling;
        let input = self.manual.overall[usize::from(gear) - 1] * wheel.wheel_rad_s;
        let demand_nm = wheel.power_w / input;
        let engaged = self.box_in(gear, input, demand_nm);
        let mut at = engaged.at(demand_nm); // MB-1
        let mut speed = self.engine_speed(at.input_nm, input);
        let w = speed.end_rad_s;
        let absorbed_nm = engine.drag_nm(w) + engine.accessories_nm(w);
        let turning = Turning {
            output_rad_s: input,
            engine_rad_s: w,
            idle_rad_s: engine.idle_rad_s(),
            locked: w.splat_mask(false),
        };
        let least = coupling.min_output_nm(&turning, absorbed_nm);
        let mut full_load_nm = engine.full_load_nm(w);
        let most = self.most_nm(input, w, full_load_nm);
        let mut lacks_torque = at.input_nm.gt(most);
        let settled = speed.settled_rad_s;
        if (settled.gt(w) | w.gt(settled)).any() {
            let settled_nm = self.most_nm(input, settled, engine.full_load_nm(settled));
            lacks_torque = lacks_torque | at.input_nm.gt(settled_nm);
        }
        let below = at.input_nm.lt(least);
        let above = at.input_nm.gt(most);
        let limited = below | above;
        *output = StepOutput {
            gear: R::per_lane(|_| gear),
            iterations: R::per_lane(|_| 1),
            ..StepOutput::like(input)
        };
        if limited.any() {
            output.flag(Flags::FULL_LOAD, above);
            let torque = below.select(least, most);
            let (output_nm, iterations) = engaged.output_for(torque);
            for run in (0..R::LANES).filter(|run| limited.lane(*run)) {
                *R::get_mut(&mut output.iterations, run) = *R::get(&iterations, run);
            }
            let held = engaged.at(output_nm);
            let residual = (held.input_nm - torque).abs() / full_load_nm;
            output.residual = limited.select(residual, output.residual);
            at = held.or(limited, at);
            let drags = limited & torque.le(least);
            if drags.any() {
                speed = self.engine_speed(torque, input).or(drags, speed);
                let dragged_nm = engine.full_load_nm(speed.end_rad_s);
                full_load_nm = drags.select(dragged_nm, full_load_nm);
            }
        }
        let w = speed.end_rad_s;
        output.engine_rad_s = w;
        let [_, last] = wheel.ends_over_mean(self.step.dt_s);
        let together = (input * SLIPS_FROM).ge(w);
        output.end_rad_s = together.select(last * input, w.max(last * input));
        let side = coupling.engine_side(at.input_nm, input, w);
        output.shaft_nm = side.engine_nm;
        output.add_loss(Component::LaunchClutch, side.loss_w);
        lose(output, &at.losses_nm, input);
        output.output_w = wheel.power_w;
        if limited.any() {
            output.split_of(limited, wheel, at.output_nm * input);
        }
        let slips = w.gt(input * SLIPS_FROM) & at.input_nm.gt(0.0);
        output.flag(Flags::CLUTCH_SLIPPING, slips);
        output.flag(Flags::OVERRUN, at.input_nm.lt(0.0));
        output.flag(Flags::OUTSIDE_VALIDITY, !at.inside_map);
        output.flag(Flags::NOT_CONVERGED, output.residual.gt(1e-8));
        self.set_throttle(output, full_load_nm);
        // On its way down the engine is faster than at the end, and the clutch slips more; its rotating energy pays for it, and
        // what full load leaves.
        let mean_rad_s = w + speed.excess_rad_s;
        let at_mean = coupling.engine_side(at.input_nm, input, mean_rad_s);
        let room_nm = full_load_nm - engine.accessories_nm(w) - side.engine_nm;
        // Not that of the speed before: after a change down in overrun the energy lags (SI-5), and what is not there would be burnt beyond full load.
        let released_j = self.step.kinetic_j - engine.rotating_j(output.end_rad_s);
        let room_w = room_nm.max(0.0) * w + released_j.max(0.0) / self.step.dt_s;
        let on_the_way_w = (at_mean.loss_w - side.loss_w).min(room_w);
        output.shaft_nm = output.shaft_nm + on_the_way_w / w;
        output.add_loss(Component::LaunchClutch, on_the_way_w);
        lacks_torque
    }

    /// Torque into the box at the engine's full load, Nm, at speeds of box and engine.
    fn most_nm(&self, input_rad_s: R, engine_rad_s: R, full_load_nm: R) -> R {
        let engine = self.step.engine;
        // An engine too weak for its own accessories in the cold drives nothing; the row is flagged.
        let engine_nm = (full_load_nm - engine.accessories_nm(engine_rad_s)).max(0.0);
        (self.manual.coupling).output_nm(engine_nm, input_rad_s, engine_rad_s)
    }

    /// Engine speed over the coupling in this step: at once that of a faster box; over a slower one, as after a change up, the coupling slips
    /// until the engine's rotating energy is spent.
    fn engine_speed(&self, input_nm: R, input_rad_s: R) -> EngineSpeed<R> {
        let wanted = self.manual.coupling.engine_rad_s(&CouplingLoad {
            output_nm: input_nm,
            output_rad_s: input_rad_s,
            idle_rad_s: self.step.engine.idle_rad_s(),
            coupled: self.state.coupled,
        });
        let least = self.manual.coupling.min_engine_rad_s(input_rad_s);
        let before_rad_s = self.state.engine_rad_s;
        // Full load bounds the torque that passes; the rest of a demand is missing.
        let passed_nm = input_nm.clamp(0.0, self.step.engine.full_load_nm(before_rad_s));
        let reach = self.step.reach(before_rad_s, passed_nm);
        let end_rad_s = reach.nearest(wanted).max(least);
        let [first, _] = self.step.wheel.ends_over_mean(self.step.dt_s);
        let faster_rad_s = before_rad_s - first * input_rad_s;
        EngineSpeed {
            end_rad_s,
            settled_rad_s: wanted.max(least),
            excess_rad_s: reach.mean_excess_rad_s(faster_rad_s - (end_rad_s - input_rad_s)),
        }
    }
}

/// Engine speed over a coupling in a step, rad/s.
struct EngineSpeed<R> {
    /// At the end of the step.
    end_rad_s: R,
    /// On which it settles.
    settled_rad_s: R,
    /// Mean over the step above that at its end, of an engine that comes down.
    excess_rad_s: R,
}

#[physics]
impl<R: Real> EngineSpeed<R> {
    /// This one where the mask says so, else the other.
    fn or(self, chosen: R::Mask, other: EngineSpeed<R>) -> EngineSpeed<R> {
        EngineSpeed {
            end_rad_s: chosen.select(self.end_rad_s, other.end_rad_s),
            settled_rad_s: chosen.select(self.settled_rad_s, other.settled_rad_s),
            excess_rad_s: chosen.select(self.excess_rad_s, other.excess_rad_s),
        }
    }
}

#[physics]
fn lose<R: Real>(output: &mut StepOutput<R>, losses_nm: &PartLosses<R>, speed: R) {
    for (component, nm) in losses_nm {
        output.add_loss(*component, *nm * speed);
    }
}
