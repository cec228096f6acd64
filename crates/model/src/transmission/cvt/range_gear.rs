//! A planetary set behind the secondary with two ranges: its ratio in the low range, 1 in the high one, where it turns as a block.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RG-1 | w_s = i w_fd; i = i_low in the low range, 1 in the high one | derived: layout of Jatco's CVT7, a set with low brake and high clutch between pulleys and differential |
//! | RG-2 | with I* i the target speed over w_fd: to the high range where I* i < I_up i_low, with the coupling locked, back where I* i > I_down; target and w_fd linear within a step; low at rest; a held ratio (RC-12) keeps the range, of a paced one (RC-15) I i at the end of a step decides what the next one does | ASSUMED: I_up the highest ratio of the belt, so that the step ends in the middle of its range; I_down above I_up i_low by a hysteresis |
//! | RG-3 | while the range changes ln i goes to its new value at the rate ln i_low/t, and the belt follows its target the other way, within RC-4 and RC-5 | ASSUMED: t 0.4 to 1.2 s; an exact coordination has the engine turn on as without a step |
//! | RG-4 | P_s = f P_fd + RG-5; engaged in low f = 1 + e driving, 1/(1 + e) dragged, in high 1; changing f = i driving, i/i_low dragged; the mean over the step by time | derived: of the two clutches the one of the high range carries a driving torque while both slip, that of the low range a dragging one; e 0.5 to 1.5 % ASSUMED |
//! | RG-6 | launch gear: a pair of gears from the primary to the final drive, i = I_g/I_low while it has the torque, the belt at its lowest ratio without load; what the low range carries by RG-4 goes past the belt | derived: layout of Toyota's K120; friction clutches of gear and belt ASSUMED |
//! | RG-7 | RG-2 with w* < I_up w_fd or w_P < I_g w_fd for the belt, w* > I_down w_fd for the gear, w_P of RC-8 | ASSUMED: I_up between I_low and I_g, so that the engine is as far above its target before a change as it is below after it; I_down above I_g, so that the gear gives no more than the target |
//! | RG-5 | drag of the open one at w_fd: CD-1, CD-2 | derived: with the ring driven and the sun braked, an open clutch or brake slips at the speed of the carrier |
//!
//! w_s speed of the secondary (of the shaft behind the clutch LO-1), w_fd that into the final drive. No torque is interrupted, and the pressure of brake
//! and clutch is that of PC-5's control pressure.

use super::clutch_drag::{CLEARANCE_M, ClutchDrag};
use super::controller::RatioControl;
use super::viscosity_power;
use crate::keys::{Key, Values, keys};
use crate::math::{Gather, Mask, Real, physics};

/// Part of the torque that a belt next to a launch gear is taken to carry at least, where it bounds that of the wheels. ASSUMED, numerical.
const LEAST_BY_BELT: f64 = 0.01;

/// The checked set.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct RangeGear<R: Real = f64> {
    /// Ratio i_low of the low range.
    pub low: R,
    /// Belt ratio I_up in the low range below which the high one is taken.
    pub up_ratio: R,
    /// Belt ratio I_down in the high range above which the low one is taken.
    pub down_ratio: R,
    /// Time t of a change, s.
    pub change_s: R,
    /// Speed into the final drive at which the low range ends, rad/s (RG-7); infinite in a box whose belt goes on in it.
    pub most_behind_rad_s: R,
    /// True for a launch gear, whose power goes past the belt (RG-6).
    #[gather(same)]
    pub past_belt: bool,
    /// Loss e of the low range over its power.
    pub mesh_share: R,
    /// Drag of the clutch or brake that is open.
    pub drag: ClutchDrag<R>,
}

/// The range at the end of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InRange<R: Real = f64> {
    /// Ratio i; 1 in a box without ranges.
    pub ratio: R,
    /// True where the low range is engaged or on its way.
    pub low: R::Mask,
}

/// The set in a step.
#[derive(Clone, Copy)]
pub(crate) struct RangeStep<R: Real = f64> {
    /// Ratio at the beginning and end.
    pub ends: [R; 2],
    /// Mean ratio by time.
    pub mean: R,
    /// Power into the set over that out of it where it drives, without drag.
    drives: R,
    /// The same where it is dragged.
    drags: R,
    /// Parts of both that the low range carries.
    by_low: [R; 2],
}

/// The set in a step, in oil.
#[derive(Clone, Copy)]
pub(crate) struct TurningRange<'a, R: Real = f64> {
    set: &'a RangeGear<R>,
    step: RangeStep<R>,
    /// Power of viscosity in the drag.
    viscosity: R,
}

#[physics]
impl<R: Real> InRange<R> {
    /// Without ranges; `like` has the lanes.
    pub fn only(like: R) -> Self {
        InRange {
            ratio: like.splat(1.0),
            low: like.splat_mask(false),
        }
    }
}

#[physics]
impl<R: Real> RangeGear<R> {
    /// The low range, engaged.
    pub(super) fn in_low(&self) -> InRange<R> {
        InRange {
            ratio: self.low,
            low: self.low.splat_mask(true),
        }
    }

    /// The range in which a car rolls for a target speed over that of the final drive (RG-2).
    pub(super) fn rolling(&self, overall: R) -> InRange<R> {
        let low = overall.gt(self.down_ratio);
        InRange {
            ratio: low.select(self.low, self.low.splat(1.0)),
            low,
        }
    }

    /// True where the low range is wanted for a target speed with the final drive at a speed, rad/s, after a range (RG-2).
    pub(super) fn wants_low(
        &self,
        now: &InRange<R>,
        target: R,
        behind: R,
        coupled: R::Mask,
    ) -> R::Mask {
        let ends = self.most_behind_rad_s.lt(behind); // RG-7
        let up = coupled & ((self.up_ratio * self.low * behind).gt(target) | ends);
        (now.low & !up) | target.gt(self.down_ratio * behind)
    }

    /// The high range, engaged.
    pub(super) fn in_high(&self) -> RangeStep<R> {
        let one = self.low.splat(1.0);
        RangeStep {
            ends: [one; 2],
            mean: one,
            drives: one,
            drags: one,
            by_low: [one.splat(0.0); 2],
        }
    }

    /// Goes on from the range at the end of the step before (RG-3).
    pub(super) fn step(&self, now: &InRange<R>, time_s: R) -> RangeStep<R> {
        let (zero, one) = (self.low.splat(0.0), self.low.splat(1.0));
        let target = now.low.select(self.low, one);
        let driven = now.low.select(one + self.mesh_share, one); // RG-4
        let engaged = RangeStep {
            ends: [target; 2],
            mean: target,
            drives: driven,
            drags: one / driven,
            by_low: [driven, one / driven].map(|all| now.low.select(all, zero)),
        };
        let settled = now.ratio.bits_eq(target);
        if settled.all() {
            return engaged;
        }
        let [log_low, away] = R::ln_array([self.low, target / now.ratio]);
        let most = log_low * time_s / self.change_s; // RG-3
        let moved = away.clamp(-most, most);
        let end = moved.bits_eq(away).select(target, now.ratio * moved.exp());
        let moves = moved.abs().gt(0.0);
        // The mean of a ratio whose logarithm is linear.
        let changing = moves.select((end - now.ratio) / moved, now.ratio);
        let share = moves.select(moved.abs() / most, one);
        // RG-4: who carries the torque meanwhile.
        let on_way = [zero, changing / self.low];
        let over_step = |on_way: R, then: R| then + share * (on_way - then);
        RangeStep {
            ends: [now.ratio, settled.select(target, end)],
            mean: settled.select(target, over_step(changing, end)),
            drives: settled.select(engaged.drives, over_step(changing, engaged.drives)), // RG-4
            drags: settled.select(engaged.drags, over_step(changing / self.low, engaged.drags)),
            by_low: [0, 1].map(|k| {
                let then = engaged.by_low[k];
                settled.select(then, over_step(on_way[k], then))
            }),
        }
    }

    /// The same with target speeds and those of the final drive at both ends of the step, rad/s, linear in it: where they ask for the other range, the change
    /// begins within the step (RG-2). The range at its end with it.
    pub(super) fn driven(
        &self,
        now: &InRange<R>,
        (targets, behind): ([R; 2], [R; 2]),
        coupled: R::Mask,
        dt_s: f64,
    ) -> (RangeStep<R>, InRange<R>) {
        let one = self.low.splat(1.0);
        let [first, last] = [0, 1].map(|k| self.wants_low(now, targets[k], behind[k], coupled));
        let other = |low: R::Mask| (now.low & !low) | (low & !now.low);
        let changes = other(last);
        if !changes.any() {
            let step = self.step(now, one * dt_s);
            let ratio = step.ends[1];
            return (step, InRange { ratio, ..*now });
        }
        let bound = now.low.select(self.up_ratio * self.low, self.down_ratio);
        let ends = now.low.select(self.most_behind_rad_s, one * f64::INFINITY);
        let [from, to] = [0, 1].map(|k| (targets[k] / bound).min(ends) - behind[k]);
        let at_once = other(first);
        let crosses = at_once.select(one.splat(0.0), (from / (from - to)).clamp(0.0, 1.0));
        let share = changes.select(crosses, one);
        let before = self.step(now, share * dt_s);
        let ratio = before.ends[1];
        let after = self.step(&InRange { ratio, low: last }, (one - share) * dt_s);
        let both = |a: R, b: R| b + share * (a - b);
        let step = RangeStep {
            ends: [now.ratio, after.ends[1]],
            mean: both(before.mean, after.mean),
            drives: both(before.drives, after.drives),
            drags: both(before.drags, after.drags),
            by_low: [0, 1].map(|k| both(before.by_low[k], after.by_low[k])),
        };
        let ratio = step.ends[1];
        (step, InRange { ratio, low: last })
    }

    /// A step of the set in oil of a kinematic viscosity, m2/s.
    pub(super) fn in_oil(&self, step: RangeStep<R>, nu_m2_s: R) -> TurningRange<'_, R> {
        TurningRange {
            set: self,
            step,
            viscosity: viscosity_power(nu_m2_s, self.drag.exponent),
        }
    }
}

#[physics]
impl<R: Real> TurningRange<'_, R> {
    /// Mean ratio i of the step.
    pub fn ratio(&self) -> R {
        self.step.mean
    }

    /// Loss torque for a torque into the final drive, both at the secondary, Nm, at its speed (RG-4, RG-5).
    pub fn loss_nm(&self, final_drive_nm: R, secondary_rad_s: R) -> R {
        let drives = final_drive_nm.gt(0.0);
        let over = drives.select(self.step.drives, self.step.drags) - 1.0;
        let behind_rad_s = secondary_rad_s / self.step.mean; // RG-1
        let drag_nm = self.set.drag.torque_nm(self.viscosity, behind_rad_s); // RG-5
        final_drive_nm * over + drag_nm / self.step.mean
    }

    /// Largest torque into the final drive for one of the belt, both at the secondary, without drag (RG-4, RG-6).
    pub fn output_over_belt(&self) -> R {
        let step = &self.step;
        let past = |k: usize| match self.set.past_belt {
            true => step.by_low[k],
            false => step.drives.splat(0.0),
        };
        let by_belt = (step.drives - past(0)).min(step.drags - past(1));
        1.0 / by_belt.max(LEAST_BY_BELT)
    }

    /// Torque that goes past the belt of one into the final drive, both at the secondary, Nm (RG-6).
    pub fn past_belt_nm(&self, final_drive_nm: R) -> R {
        if !self.set.past_belt {
            return final_drive_nm.splat(0.0);
        }
        let [drives, drags] = self.step.by_low;
        final_drive_nm * final_drive_nm.gt(0.0).select(drives, drags)
    }
}

keys! {
    /// Keys of `[transmission.cvt.ranges.two]`.
    RANGES: RangeKeys = "two" [] {
        low_ratio: number(1.05, 4.0), "speed of the secondary over that behind the set in the low range; 1 in the high range", ["RG-1"];
        up_belt_ratio: number(0.1, 5.0), "belt ratio in the low range below which the high range is taken", ["RG-2"];
        down_belt_ratio: number(0.1, 5.0), "belt ratio in the high range above which the low range is taken", ["RG-2"];
        change_s: number(0.1, 3.0), "time of a change of range", ["RG-3"];
        mesh_loss_percent: number(0.0, 10.0), "loss of the low range over the power behind it", ["RG-4"];
        drag_nm: number(0.0, 20.0), "largest drag of the open clutch or brake at 11 mm2/s", ["RG-5"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity in that drag", ["RG-5"];
        cap_nm: number(0.0, 20.0), "largest drag", ["RG-5"];
        peak_rpm: optional(number(200.0, 20_000.0)), "speed behind the set of the largest drag; absent: the same drag at every speed", ["RG-5"];
    }

    /// Keys of `[transmission.cvt.ranges.launch_gear]`.
    GEAR: LaunchGearKeys = "launch_gear" [] {
        gear_ratio: number(1.0, 10.0), "speed of the primary over that into the final drive in the launch gear", ["RG-6"];
        up_ratio: number(0.5, 10.0), "target of the engine speed over that into the final drive below which the belt takes over", ["RG-7"];
        down_ratio: number(0.5, 20.0), "the same above which the gear takes over", ["RG-7"];
        change_s: number(0.1, 3.0), "time of a change between gear and belt", ["RG-3"];
        mesh_loss_percent: number(0.0, 10.0), "loss of the gear over the power behind it", ["RG-4"];
        drag_nm: number(0.0, 20.0), "largest drag of the open clutch at 11 mm2/s", ["RG-5"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity in that drag", ["RG-5"];
        cap_nm: number(0.0, 20.0), "largest drag", ["RG-5"];
        peak_rpm: optional(number(200.0, 20_000.0)), "speed into the final drive of the largest drag; absent: the same drag at every speed", ["RG-5"];
    }
}

/// Drag of an open clutch by its size at reference viscosity, Nm, exponent and largest torque, Nm, with the speed of the peak, rad/s.
fn drag([drag_nm, exponent, cap_nm]: [f64; 3], peak_rad_s: Option<f64>) -> ClutchDrag {
    ClutchDrag {
        drag_nm,
        exponent,
        cap_nm,
        peak_rad_s,
        clearance_m: CLEARANCE_M,
        oil_share: 1.0,
        set_nm: 0.0,
        set_nm_s: 0.0,
    }
}

impl RangeGear {
    /// The set from the values of its table, of a CVT with ends of the belt ratio.
    fn from_table<V: Values>(s: &V, (low_ratio, high_ratio): (f64, f64)) -> Self {
        let set = RangeGear {
            low: s.number(&RANGES.low_ratio),
            up_ratio: s.number(&RANGES.up_belt_ratio),
            down_ratio: s.number(&RANGES.down_belt_ratio),
            change_s: s.number(&RANGES.change_s),
            most_behind_rad_s: f64::INFINITY,
            past_belt: false,
            mesh_share: s.number(&RANGES.mesh_loss_percent),
            drag: drag(
                [
                    s.number(&RANGES.drag_nm),
                    s.number(&RANGES.viscous_exponent),
                    s.number(&RANGES.cap_nm),
                ],
                s.optional(&RANGES.peak_rpm),
            ),
        };
        if set.up_ratio < high_ratio {
            s.complain(
                RANGES.up_belt_ratio.name,
                &format!("at least {high_ratio}, the highest ratio of the belt"),
                "the belt never comes to this ratio, and the low range is never left",
                "raise it, or lower transmission.cvt.ratio.high",
            );
        }
        if set.down_ratio > low_ratio {
            s.complain(
                RANGES.down_belt_ratio.name,
                &format!("at most {low_ratio}, the lowest ratio of the belt"),
                "the belt never comes to this ratio, and the high range is left at rest alone",
                "lower it, or raise transmission.cvt.ratio.low",
            );
        }
        let up = set.up_ratio * set.low;
        if set.down_ratio <= up {
            s.complain(
                RANGES.down_belt_ratio.name,
                &format!("above {up:.3}, low_ratio times up_belt_ratio"),
                "after a change to the high range the low one would be wanted again",
                "raise it, or lower up_belt_ratio",
            );
        }
        set
    }

    /// The launch gear from the values of its table, of a CVT with a ratio control.
    fn launch_gear<V: Values>(s: &V, ratio: &RatioControl) -> Self {
        let (gear, up) = (s.number(&GEAR.gear_ratio), s.number(&GEAR.up_ratio));
        let low = gear / ratio.low;
        let set = RangeGear {
            low,
            up_ratio: up / low,
            down_ratio: s.number(&GEAR.down_ratio),
            change_s: s.number(&GEAR.change_s),
            most_behind_rad_s: ratio.highest_rad_s / gear, // RG-7
            past_belt: true,
            mesh_share: s.number(&GEAR.mesh_loss_percent),
            drag: drag(
                [
                    s.number(&GEAR.drag_nm),
                    s.number(&GEAR.viscous_exponent),
                    s.number(&GEAR.cap_nm),
                ],
                s.optional(&GEAR.peak_rpm),
            ),
        };
        if low <= 1.0 {
            s.complain(
                GEAR.gear_ratio.name,
                &format!("above {}, the lowest ratio of the belt", ratio.low),
                "the belt has a lower ratio than the launch gear",
                "raise it, or lower transmission.cvt.ratio.low",
            );
        }
        if up >= gear {
            s.complain(
                GEAR.up_ratio.name,
                &format!("below {gear}, the ratio of the gear"),
                "the gear would be left with the engine below its target",
                "lower it",
            );
        }
        if set.down_ratio < gear {
            s.complain(
                GEAR.down_ratio.name,
                &format!("at least {gear}, the ratio of the gear"),
                "after a change to the belt the gear would be wanted again",
                "raise it",
            );
        }
        set
    }

    /// The set that a box with a ratio control chooses; none in a box with one range.
    pub(super) fn from_values<V: Values>(
        s: &V,
        key: &Key<'static>,
        ratio: &RatioControl,
    ) -> Option<Box<Self>> {
        let (kind, table) = s.choose(key);
        let set = match kind {
            "two" => RangeGear::from_table(&table, (ratio.low, ratio.high)),
            "launch_gear" => RangeGear::launch_gear(&table, ratio),
            _ => return None,
        };
        Some(Box::new(set))
    }
}

#[cfg(test)]
#[allow(
    clippy::float_cmp,
    reason = "a range that is engaged has its ratio exactly"
)]
mod tests {
    use super::*;

    fn set() -> RangeGear {
        RangeGear {
            low: 1.82,
            up_ratio: 0.6,
            down_ratio: 1.8,
            change_s: 0.6,
            most_behind_rad_s: f64::INFINITY,
            past_belt: false,
            mesh_share: 0.01,
            drag: drag([0.0; 3], None),
        }
    }

    /// Means of i and of both power ratios over a step by a sum of short parts of RG-3 and RG-4 as they are written.
    fn by_parts(set: &RangeGear, now: InRange, dt_s: f64) -> [f64; 4] {
        const PARTS: u32 = 200_000;
        let (target, engaged) = if now.low {
            (set.low, 1.0 + set.mesh_share)
        } else {
            (1.0, 1.0)
        };
        let rate = set.low.ln() / set.change_s;
        let (mut sums, mut i) = ([0.0; 3], now.ratio);
        for part in 0..PARTS {
            let t = (f64::from(part) + 0.5) * dt_s / f64::from(PARTS);
            let way = (target / now.ratio).ln();
            let gone = way.signum() * (rate * t).min(way.abs());
            i = now.ratio * gone.exp();
            let changes = gone.abs() < way.abs();
            let [drives, drags] = match changes {
                true => [i, i / set.low],
                false => [engaged, 1.0 / engaged],
            };
            for (sum, value) in sums.iter_mut().zip([i, drives, drags]) {
                *sum += value / f64::from(PARTS);
            }
        }
        [sums[0], sums[1], sums[2], i]
    }

    /// Truth: RG-3 and RG-4, summed up in short parts: at rest in a range, and changes that end within the step and beyond it.
    #[test]
    fn means_of_a_step() {
        let set = set();
        for (low, ratio) in [
            (true, 1.82),
            (false, 1.0),
            (false, 1.82),
            (true, 1.0),
            (true, 1.3),
            (false, 1.3),
        ] {
            for dt_s in [0.0, 0.05, 0.3, 0.6, 1.0, 5.0] {
                let now = InRange { ratio, low };
                let step = set.step(&now, dt_s);
                let [mean, drives, drags, end] = by_parts(&set, now, dt_s);
                let found = [step.mean, step.drives, step.drags, step.ends[1]];
                for (got, want) in found.into_iter().zip([mean, drives, drags, end]) {
                    assert!(
                        (got - want).abs() < 2e-5,
                        "{low} {ratio} {dt_s}: {got} for {want}"
                    );
                }
            }
        }
    }

    /// The worked point of the page: a change to the high range within a step of 1 s.
    #[test]
    fn val_the_worked_point_of_two_ranges() {
        let step = set().step(
            &InRange {
                ratio: 1.82,
                low: false,
            },
            1.0,
        );
        let near = |got: f64, want: f64| assert!((got - want).abs() < 1e-5, "{got} for {want}");
        near(step.mean, 1.221_593); // 0.6 (1.82 - 1)/ln 1.82 + 0.4
        near(step.drives, 1.221_593);
        near(step.drags, 0.851_424); // 0.6 0.82/(1.82 ln 1.82) + 0.4
        let set = set();
        let turning = set.in_oil(step, super::super::NU_REFERENCE_M2_S);
        near(turning.loss_nm(50.0, 200.0), 11.079_66); // 50 0.221593
        near(turning.loss_nm(-50.0, 200.0), 7.428_76); // 50 (1 - 0.851424)
    }

    /// Truth: RG-2 as it is written, on both sides of each bound.
    #[test]
    fn the_range_that_is_wanted() {
        let set = set();
        let (low, high) = (set.in_low(), InRange::only(0.0));
        let wants = |now, overall: f64, coupled| set.wants_low(now, 10.0 * overall, 10.0, coupled);
        let up = 0.6 * 1.82;
        assert!(wants(&low, up + 1e-9, true) && !wants(&low, up - 1e-9, true));
        assert!(wants(&low, up - 1e-9, false));
        assert!(!wants(&high, 1.8 - 1e-9, true) && wants(&high, 1.8 + 1e-9, true));
        assert!(set.rolling(1.9).low && !set.rolling(1.7).low);
        assert!(set.rolling(1.9).ratio == 1.82 && set.rolling(1.7).ratio == 1.0);
    }

    /// Truth: a bound that is crossed within a step, by the same step in two parts; targets beyond it at the beginning change at once.
    #[test]
    fn a_change_begins_within_a_step() {
        let set = set();
        let low = set.in_low();
        // The target falls from 1.2 to 0.992 times the speed of the final drive: through 1.092 after 0.519 of the step.
        let share = (1.2 - 1.092) / (1.2 - 0.992);
        let (step, next) = set.driven(&low, ([120.0, 99.2], [100.0, 100.0]), true, 1.0);
        let after = set.step(&InRange { low: false, ..low }, 1.0 - share);
        let near = |got: f64, want: f64| assert!((got - want).abs() < 1e-12, "{got} for {want}");
        near(step.mean, share * 1.82 + (1.0 - share) * after.mean);
        near(step.drives, share * 1.01 + (1.0 - share) * after.drives);
        near(step.drags, share / 1.01 + (1.0 - share) * after.drags);
        near(next.ratio, after.ends[1]);
        assert!(!next.low && next.ratio > 1.0);
        let (step, _) = set.driven(&low, ([100.0, 99.0], [100.0, 100.0]), true, 1.0);
        near(
            step.mean,
            set.step(&InRange { low: false, ..low }, 1.0).mean,
        );
        let (step, next) = set.driven(&low, ([130.0, 120.0], [100.0, 100.0]), true, 1.0);
        assert!(next == low && step.mean == 1.82);
        // From rest: the final drive begins at no speed.
        let (step, next) = set.driven(&low, ([130.0, 130.0], [0.0, 50.0]), true, 1.0);
        assert!(next == low && step.mean == 1.82);
    }
}
