//! One step of the manual box: engaged, declutched or in neutral.

use super::engaged::sum_nm;
use super::{Engaged, Manual, PartLosses};
use crate::flags::Flags;
use crate::fluid::OilState;
use crate::math::{clamp, larger, smaller};
use crate::prime_mover::{FULL_LOAD_LIMIT, PrimeMover};
use crate::thermal::SUMP;
use crate::transmission::component::Component;
use crate::transmission::coupling::{Coupling, CouplingLoad, Turning};
use crate::transmission::step::{DrivelineState, StepInput, StepOutput};

/// The box in a step, in its oil.
pub(super) struct ManualStep<'a, P> {
    pub manual: &'a Manual,
    pub step: &'a StepInput<'a, P>,
    pub state: &'a DrivelineState,
    pub oil: OilState,
}

impl<P: PrimeMover> ManualStep<'_, P> {
    /// The box in a gear at an input speed and a demanded torque.
    fn box_in(&self, gear: u8, input_rad_s: f64, demand_nm: f64) -> Engaged<'_> {
        let oil_k = self.step.heat.node_k[SUMP];
        self.manual
            .engaged(gear, input_rad_s, demand_nm, (self.oil, oil_k))
    }

    /// The highest gear.
    fn top(&self) -> u8 {
        self.manual.overall.len() as u8
    }

    /// Speed of the free engine at the end of the step, rad/s.
    fn free_engine_rad_s(&self) -> f64 {
        self.step
            .reach(self.state.engine_rad_s, 0.0)
            .nearest(self.step.engine.idle_rad_s())
    }

    /// Declutched, unless the car would then slow down more than it should: the driver lets the clutch slip in that gear or a lower one.
    pub fn coasting(&self, gear: u8, output: &mut StepOutput) {
        self.declutched(gear, output);
        if output.deficit_w > 0.0 {
            self.engaged(gear.max(1), output);
        }
    }

    pub fn neutral(&self, output: &mut StepOutput) {
        let w = self.free_engine_rad_s();
        let losses = self.box_in(self.top(), w, 0.0).unloaded_nm();
        let share = self.manual.neutral_share;
        output.engine_rad_s = w;
        output.shaft_nm = share * sum_nm(&losses);
        lose(output, &losses, share * w);
        self.set_throttle(output, self.step.engine.full_load_nm(w));
    }

    /// Clutch open, the wheels turn the box in `gear` (0: its highest), the engine idles.
    fn declutched(&self, gear: u8, output: &mut StepOutput) {
        let gear = if gear == 0 { self.top() } else { gear };
        let input = self.manual.overall[usize::from(gear) - 1] * self.step.wheel.wheel_rad_s;
        let losses = self.box_in(gear, input, 0.0).unloaded_nm();
        output.engine_rad_s = self.free_engine_rad_s();
        output.gear = gear;
        output.flags.set(Flags::CLUTCH_OPEN, true);
        if input > 0.0 {
            let output_nm = -sum_nm(&losses);
            lose(output, &losses, input);
            output.split_brake_and_shortfall(self.step.wheel, output_nm * input);
        }
        let full_load_nm = self.step.engine.full_load_nm(output.engine_rad_s);
        self.set_throttle(output, full_load_nm);
    }

    /// The box in a gear, or in a lower one where that lacks torque; fills the output anew.
    pub fn engaged(&self, gear: u8, output: &mut StepOutput) {
        let mut gear = gear;
        while self.in_gear(gear, output) && self.may_shift_down(gear) {
            gear -= 1;
        }
    }

    /// True where there is a gear below, and the engine may turn as fast as the wheels would have it there.
    fn may_shift_down(&self, gear: u8) -> bool {
        let below = usize::from(gear).checked_sub(2);
        below.is_some_and(|below| {
            self.manual.overall[below] * self.step.wheel.wheel_rad_s < self.step.engine.max_rad_s()
        })
    }

    /// Sets the throttle, for the engine's full load at its speed.
    fn set_throttle(&self, output: &mut StepOutput, full_load_nm: f64) {
        let engine = self.step.engine;
        let crank_nm = output.shaft_nm + engine.accessories_nm(output.engine_rad_s);
        let share = crank_nm / full_load_nm;
        output.throttle = clamp(share, 0.0, 1.0);
        output
            .flags
            .set(Flags::OUTSIDE_VALIDITY, share > FULL_LOAD_LIMIT);
    }

    /// The box in a gear: the torque demanded, or the one at the engine's limit. True where the gear lacks torque; it does too where only an
    /// engine that still comes down from a lower gear has enough.
    fn in_gear(&self, gear: u8, output: &mut StepOutput) -> bool {
        let (engine, wheel) = (self.step.engine, self.step.wheel);
        let input = self.manual.overall[usize::from(gear) - 1] * wheel.wheel_rad_s;
        let demand_nm = wheel.power_w / input;
        let engaged = self.box_in(gear, input, demand_nm);
        let mut at = engaged.at(demand_nm); // MB-1
        let mut speed = self.engine_speed(at.input_nm, input);
        let w = speed.end_rad_s;
        let accessories_nm = engine.accessories_nm(w);
        let absorbed_nm = engine.drag_nm(w) + accessories_nm;
        let turning = Turning {
            output_rad_s: input,
            engine_rad_s: w,
            idle_rad_s: engine.idle_rad_s(),
            locked: false,
        };
        let least = self.manual.coupling.min_output_nm(&turning, absorbed_nm);
        let mut full_load_nm = engine.full_load_nm(w);
        let most_at = |w: f64| {
            // An engine too weak for its own accessories in the cold drives nothing; the row is flagged.
            let engine_nm = larger(engine.full_load_nm(w) - engine.accessories_nm(w), 0.0);
            self.manual.coupling.output_nm(engine_nm, input, w)
        };
        let most = most_at(w);
        let lacks_torque = at.input_nm > most || at.input_nm > most_at(speed.settled_rad_s);
        let limit = if at.input_nm < least {
            Some(least)
        } else if at.input_nm > most {
            Some(most)
        } else {
            None
        };
        *output = StepOutput {
            gear,
            iterations: 1,
            ..StepOutput::at_rest()
        };
        if let Some(torque) = limit {
            output.flags.set(Flags::MISSED_TRACE, at.input_nm > most);
            let output_nm;
            (output_nm, output.iterations) = engaged.output_for(torque);
            at = engaged.at(output_nm);
            output.residual = (at.input_nm - torque).abs() / full_load_nm;
            if torque <= least {
                speed = self.engine_speed(torque, input);
                full_load_nm = engine.full_load_nm(speed.end_rad_s);
            }
        }
        let w = speed.end_rad_s;
        output.engine_rad_s = w;
        let side = self.manual.coupling.engine_side(at.input_nm, input, w);
        output.shaft_nm = side.engine_nm;
        output.add_loss(Component::LaunchClutch, side.loss_w);
        lose(output, &at.losses_nm, input);
        if limit.is_some() {
            output.split_brake_and_shortfall(wheel, at.output_nm * input);
        } else {
            output.output_w = wheel.power_w;
        }
        let flags = &mut output.flags;
        flags.set(
            Flags::CLUTCH_SLIPPING,
            w > input * (1.0 + 1e-9) && at.input_nm > 0.0,
        );
        flags.set(Flags::OVERRUN, at.input_nm < 0.0);
        flags.set(Flags::OUTSIDE_VALIDITY, !at.inside_map);
        flags.set(Flags::NOT_CONVERGED, output.residual > 1e-8);
        self.set_throttle(output, full_load_nm);
        // On its way down the engine is faster than at the end, and the clutch slips more; its rotating energy pays for it. Where that lags at
        // full load nothing else may: no more than full load is passed on.
        let mean_rad_s = w + speed.excess_rad_s;
        let at_mean = (self.manual.coupling).engine_side(at.input_nm, input, mean_rad_s);
        let room_nm = full_load_nm - engine.accessories_nm(w) - side.engine_nm;
        let on_the_way_w = smaller(at_mean.loss_w - side.loss_w, larger(room_nm, 0.0) * w);
        output.shaft_nm += on_the_way_w / w;
        output.add_loss(Component::LaunchClutch, on_the_way_w);
        lacks_torque
    }

    /// Engine speed over the coupling in this step: at once that of a faster box; over a slower one, as after a change up, the coupling slips
    /// until the engine's rotating energy is spent.
    fn engine_speed(&self, input_nm: f64, input_rad_s: f64) -> EngineSpeed {
        let wanted = self.manual.coupling.engine_rad_s(&CouplingLoad {
            output_nm: input_nm,
            output_rad_s: input_rad_s,
            idle_rad_s: self.step.engine.idle_rad_s(),
            coupled: self.state.coupled,
        });
        let least = self.manual.coupling.min_engine_rad_s(input_rad_s);
        let before_rad_s = self.state.engine_rad_s;
        // What passes on at full load is no more than that; the rest of a demand is missing.
        let passed_nm = clamp(input_nm, 0.0, self.step.engine.full_load_nm(before_rad_s));
        let reach = self.step.reach(before_rad_s, passed_nm);
        let end_rad_s = larger(reach.nearest(wanted), least);
        EngineSpeed {
            end_rad_s,
            settled_rad_s: larger(wanted, least),
            excess_rad_s: reach.mean_excess_rad_s(end_rad_s),
        }
    }
}

/// Engine speed over a coupling in a step, rad/s.
struct EngineSpeed {
    /// At the end of the step.
    end_rad_s: f64,
    /// On which it settles.
    settled_rad_s: f64,
    /// Mean over the step above that at its end, of an engine that comes down.
    excess_rad_s: f64,
}

fn lose(output: &mut StepOutput, losses_nm: &PartLosses, speed: f64) {
    for (component, nm) in losses_nm {
        output.add_loss(*component, nm * speed);
    }
}
