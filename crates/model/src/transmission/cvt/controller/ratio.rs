//! Ratio control: a variogram with a limited shift rate.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RC-1 | target speed: 1700 rpm at 15 % power, + g (P/P_max - 15 %) above it | 1700 rpm source: thesis 1.1.2, Fig 1-6; 15 % and rise ASSUMED |
//! | RC-2 | below 15 % power the target falls linearly to that without power, which holds in overrun too | source: thesis 3.7 and 1.1.2 (J of Fig 1-6) in words; size ASSUMED |
//! | RC-13 | target in place of RC-1 and RC-2: n_d(u) of the drive line, n_o(v) of the overrun line while P <= 0, where the file has these lines; at least 1.006 times 1.2 idle speed, where the clutch stays locked (LC-5) | derived: any target of a controller that sees demand and speed; lines for a car by DP-12 |
//! | RC-12 | a held step has its own ratio and clamp law in place of RC-1 to RC-14 and PC-1 to PC-6 | derived: definition |
//! | RC-15 | a step for which a ratio is demanded goes towards it within RC-4 and RC-5, in place of RC-1 to RC-3 and RC-6 to RC-14 | derived: definition; the box's own limits hold for any controller |
//! | RC-16 | a ratio that is imposed (RC-12) is that of the whole step, its end included, unless another one is imposed for its end | derived: definition |
//! | RC-17 | within a step ln I waits as RC-6 and RC-10 have it, goes to ln I* at the rates of RC-4 and RC-5 until it meets it, then follows it within these; ln I* linear between its values by speeds and demand at both ends of the step, level where I* is at an end of the ratio; losses at exp(mean of ln I), the next step from its end | derived: integral of a way of straight parts, so that the rates hold at every instant and not once a step |
//! | RC-3 | never below the speed at which full load gives the power asked for, over an efficiency | source: thesis 1.1.2, route G-H-F in words; efficiency ASSUMED |
//! | RC-7 | where full load does not suffice, RC-3 is asked again with 0.995 min(eta, P/P_e), P_e the engine power of that try, until it does at the end of the step, the ratio no longer changes, or 40 %; RC-10 holds none of it back | derived: kick-down, within RC-4 and RC-5 |
//! | RC-8 | target never above the speed of greatest power | source: thesis 1.1.2, maximum power route |
//! | RC-4 | \|d ln I/dt\| <= rate min(1, n_p/n_ref), up and down rates apart, n_p the speed of the primary; none while the belt is at rest | source: thesis 2.4, 3.7 in words; values ASSUMED |
//! | RC-6 | no up-shift before the launch clutch has locked, which it has within a step once I w_s has come to the engine's speed before it | source: thesis 1.1.2, order A-B-C-D of the variogram |
//! | RC-9 | RC-1 and RC-2 look at u, tau du/dt = P/P_max - u, solved over a step in which P is linear; RC-3 at P itself | ASSUMED: tau 0 to 3 s |
//! | RC-10 | a change against the last one is made where \|ln(I*/I)\| > h, then in full; always to the ends of the ratio, to the speed of greatest power (RC-8), and below 1.2 idle speed of the primary | ASSUMED: spools have friction and a pitot signal is a difference; h 0.02 to 0.10 |
//! | RC-11 | cold: target + r clip((T_to - T)/(T_to - T_from), 0, 1) u_1, T of coolant or sump, u_1 rising from 0 without power to 1 at 1 % of rated power | ASSUMED: r 300 to 1000 rpm, gone by 40 to 60 degC coolant in modern cars; none in overrun |
//! | RC-5 | and <= V_left / (A 2 tan th \|dR/d ln I\|), V_left by PU-7 at the end of the step, with the pressure that this rate needs (PC-5): the largest rate that fulfils it | derived: thesis 9.1; at the end of the step as all else in it; solved to 1e-6 of the demanded flow |
//!
//! The power asked for is wheel power, so the ratio never chases its own losses.

use super::shift_map::{ShiftMap, shift_map};
use crate::keys::{Bound, Choice, Values, curve, keys};
use crate::math::{Gather, Mask, Real, physics, ramp};
use std::sync::Arc;

/// The checked controller.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct RatioControl<R: Real = f64> {
    /// Lowest gear: largest belt ratio.
    pub low: R,
    /// Highest gear: smallest belt ratio.
    pub high: R,
    /// Speed in gentle acceleration, rad/s.
    pub gentle_rad_s: R,
    /// Share of rated power in gentle acceleration.
    pub gentle_share: R,
    /// Rise of speed over the share of rated power above it, rad/s.
    pub rise_rad_s: R,
    /// Speed without power and in overrun, rad/s.
    pub overrun_rad_s: R,
    /// Highest target speed: that of the engine's greatest power, rad/s.
    pub highest_rad_s: R,
    /// Wheel power over engine power that RC-3 reckons with.
    pub route_efficiency: R,
    /// Rate towards high, 1/s in ln I.
    pub up_per_s: R,
    /// Rate towards low, 1/s in ln I.
    pub down_per_s: R,
    /// Primary speed from which the full rates hold, rad/s.
    pub rate_speed_rad_s: R,
    /// Change of ln I from which the ratio turns round.
    pub hysteresis: R,
    /// Time constant of the demand that gentle driving looks at, s; 0 without a filter.
    pub filter_s: R,
    /// Lines in place of gentle driving, if there are any.
    pub line: Option<Box<OperatingLine<R>>>,
    /// A table in place of gentle driving, if there is one; lines come before it.
    pub shift_map: Option<R::PerLane<Arc<ShiftMap>>>,
    /// Rise of the target in a cold car.
    pub cold: ColdRise<R>,
}

/// Target speeds in place of RC-1 and RC-2 (RC-13).
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct OperatingLine<R: Real = f64> {
    /// Engine speed over the share of rated power asked for, rad/s.
    pub drive: Option<R::Curve>,
    /// Engine speed over road speed in m/s while no power is asked for, rad/s.
    pub overrun: Option<R::Curve>,
}

impl Default for OperatingLine {
    fn default() -> Self {
        OperatingLine {
            drive: None,
            overrun: None,
        }
    }
}

#[physics]
impl<R: Real> OperatingLine<R> {
    /// The target at a demand, rad/s, where a line has it, else `other`.
    fn target_rad_s(&self, d: &RatioDemand<R>, other: R) -> R {
        let locked_rad_s = ABOVE_LOCK * d.free_up_to_rad_s;
        let drives = d.power_w.gt(0.0);
        let mut target = other;
        if let Some(line) = &self.drive {
            let own = d.share.interpolate(line).max(locked_rad_s); // RC-13
            target = drives.select(own, target);
        }
        if let Some(line) = &self.overrun {
            let speed = d.share.splat(d.speed_m_s);
            let own = speed.interpolate(line).max(locked_rad_s); // RC-13
            target = drives.select(target, own);
        }
        target
    }
}

/// Rise of the target of engine speed in a cold car (RC-11).
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct ColdRise<R: Real = f64> {
    /// Rise in full, rad/s.
    pub rise_rad_s: R,
    /// Temperature up to which it is in full, K.
    pub from_k: R,
    /// Temperature from which there is none, K.
    pub to_k: R,
    /// True where the sump's temperature counts, false for the coolant's.
    #[gather(same)]
    pub by_sump: bool,
}

impl ColdRise {
    /// None.
    pub const NONE: ColdRise = ColdRise {
        rise_rad_s: 0.0,
        from_k: 0.0,
        to_k: 1.0,
        by_sump: false,
    };
}

#[physics]
impl<R: Real> ColdRise<R> {
    /// The rise at the temperatures of coolant and sump, K, rad/s.
    pub fn at(&self, coolant_k: R, sump_k: R) -> R {
        let temp_k = if self.by_sump { sump_k } else { coolant_k };
        self.rise_rad_s * (1.0 - ramp(temp_k, self.from_k, self.to_k)) // RC-11
    }
}

/// Inputs of the target at the beginning of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment<R: Real = f64> {
    /// Speed of the secondary once the clutch has locked, rad/s.
    pub secondary_rad_s: R,
    /// Road speed, m/s.
    pub speed_m_s: f64,
    /// Wheel power asked for, W.
    pub power_w: R,
    /// Share of rated power that RC-1 and RC-2 look at (RC-9).
    pub share: R,
    /// Lowest speed at which full load gives the power asked for, rad/s.
    pub full_load_rad_s: R,
    /// Engine speed of the shift map, rad/s (RC-14); `None` without one.
    pub mapped_rad_s: Option<R>,
}

/// Inputs of the controller: those that change within a step are those at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioDemand<R: Real = f64> {
    /// The same at the beginning of the step; `None` where nothing changes within it.
    pub begins: Option<Moment<R>>,
    /// Speed of the secondary once the clutch has locked, rad/s.
    pub secondary_rad_s: R,
    /// Speed of the primary with the ratio before the step, its mean over the step, rad/s.
    pub primary_rad_s: R,
    /// Road speed, m/s.
    pub speed_m_s: f64,
    /// Wheel power asked for, W.
    pub power_w: R,
    /// Share of rated power that RC-1 and RC-2 look at (RC-9).
    pub share: R,
    /// Lowest speed at which full load gives the power asked for, rad/s.
    pub full_load_rad_s: R,
    /// Engine speed of the shift map, rad/s (RC-14); `None` without one.
    pub mapped_rad_s: Option<R>,
    /// Rise of the target in a cold car, rad/s.
    pub cold_rad_s: R,
    /// Ratio before the step.
    pub ratio_before: R,
    /// Limit from pump flow towards low, 1/s.
    pub flow_down_per_s: R,
    /// Limit from pump flow towards high, 1/s.
    pub flow_up_per_s: R,
    /// True with the launch clutch locked.
    pub coupled: R::Mask,
    /// Share of the step after which a launch clutch that slips has locked; 1 and more where it does not within the step (RC-6).
    pub locks_at: R,
    /// Direction of the last change: 1 towards low, -1 towards high, 0 before the first.
    pub last_direction: R::PerLane<i8>,
    /// Primary speed up to which the ratio turns round at once, rad/s.
    pub free_up_to_rad_s: R,
    /// Step, s.
    pub dt_s: f64,
}

#[physics]
impl<R: Real> RatioControl<R> {
    /// Target primary speed, rad/s (RC-1 to RC-3, RC-11, RC-13, RC-14).
    pub fn target_rad_s(&self, d: &RatioDemand<R>) -> R {
        let mut speed = match d.mapped_rad_s {
            Some(mapped) => mapped.max(ABOVE_LOCK * d.free_up_to_rad_s), // RC-14
            None => self.gentle_target_rad_s(d.share),
        };
        if let Some(line) = &self.line {
            speed = line.target_rad_s(d, speed);
        }
        let cold = d.cold_rad_s.gt(0.0);
        if cold.any() {
            let raised = speed + d.cold_rad_s * (d.share / MIN_GENTLE_SHARE).clamp(0.0, 1.0); // RC-11
            speed = cold.select(raised, speed);
        }
        let binds = d.power_w.gt(0.0) & d.full_load_rad_s.gt(speed);
        binds
            .select(d.full_load_rad_s, speed) // RC-3
            .min(self.highest_rad_s)
    }

    /// Target at a share of rated power, rad/s.
    fn gentle_target_rad_s(&self, share: R) -> R {
        let drive = (share / self.gentle_share.max(MIN_GENTLE_SHARE)).clamp(0.0, 1.0);
        let speed = self.overrun_rad_s + drive * (self.gentle_rad_s - self.overrun_rad_s); // RC-2
        let risen = speed + self.rise_rad_s * (share - self.gentle_share); // RC-1
        share.gt(self.gentle_share).select(risen, speed)
    }

    /// Share of rated power that RC-1 and RC-2 look at after a step, from that before and the ones asked for at its beginning and end, between which
    /// the demand is linear (RC-9).
    pub fn filtered_share(&self, before: R, asked: [R; 2], dt_s: f64) -> R {
        let filters = self.filter_s.gt(0.0);
        if !filters.any() {
            return asked[1];
        }
        let lag = (asked[1] - asked[0]) / dt_s * self.filter_s;
        let settled = asked[1] - lag;
        let filtered = settled + (before - asked[0] + lag) * (-dt_s / self.filter_s).exp(); // RC-9
        filters.select(filtered, asked[1])
    }

    /// Way of the ratio within the step (RC-4, RC-5, RC-17).
    pub fn step(&self, d: &RatioDemand<R>) -> Shifted<R> {
        let before = d.ratio_before;
        let zero = before.splat(0.0);
        let rests = zero.ge(d.primary_rad_s); // RC-4
        if rests.all() {
            return Shifted::none(before);
        }
        let wanted = self.wanted(d);
        let (mut begins, mut bends_at) = (wanted, before.splat(1.0));
        if let Some(moment) = &d.begins {
            let at = d.at(moment);
            begins = self.wanted(&at);
            bends_at = self.bends_at([&at, d], [begins, wanted]);
        }
        let stays = rests | (wanted.bits_eq(before) & begins.bits_eq(before));
        if stays.all() {
            return Shifted::none(before);
        }
        self.limited(d, ([begins, wanted], bends_at), stays)
    }

    /// Share of a step at which the target leaves an end of the ratio, or comes to one, with engine and car speeds that are linear between both ends of the
    /// step; 1 where it does neither.
    fn bends_at(&self, ends: [&RatioDemand<R>; 2], wanted: [R; 2]) -> R {
        let one = wanted[0].splat(1.0);
        let at_end = |k: usize| wanted[k].le(self.high) | wanted[k].ge(self.low);
        let (first, last) = (at_end(0), at_end(1));
        let bends = (first & !last) | (last & !first);
        if !bends.any() {
            return one;
        }
        let ratio = first.select(wanted[0], wanted[1]);
        let over = |d: &RatioDemand<R>| self.target_rad_s(d) - ratio * d.secondary_rad_s;
        let (from, to) = (over(ends[0]), over(ends[1]));
        let share = (from / (from - to)).clamp(0.0, 1.0);
        bends.select(share, one)
    }

    /// Ratio at which the engine has its target speed at the end of a step.
    fn wanted(&self, d: &RatioDemand<R>) -> R {
        (self.target_rad_s(d) / d.secondary_rad_s).clamp(self.high, self.low)
    }

    /// The same towards a ratio that is asked for from outside (RC-15).
    pub fn paced(&self, d: &RatioDemand<R>, asked: R) -> Shifted<R> {
        let before = d.ratio_before;
        let wanted = asked.clamp(self.high, self.low);
        let stays = wanted.bits_eq(before);
        if stays.all() {
            return Shifted {
                mean: wanted,
                end: wanted,
                ..Shifted::none(before)
            };
        }
        let away = (wanted / before).ln();
        let at_once = RatioDemand {
            coupled: before.splat_mask(true),
            ..d.clone()
        };
        let whole = before.splat(1.0);
        let waits = (before.splat(0.0), self.hysteresis);
        let way = self.way(&at_once, ([away; 3], whole), waits, stays);
        self.shifted(before, [wanted; 2], &way, stays)
    }

    /// As much of the way from the ratio before to the ones wanted at the beginning and end of the step as the rates allow; none where the ratio stays.
    #[inline(never)]
    fn limited(&self, d: &RatioDemand<R>, ends: ([R; 2], R), stays: R::Mask) -> Shifted<R> {
        d.ratio_before
            .vectorize(|| self.limited_between(d, ends, stays))
    }

    fn limited_between(
        &self,
        d: &RatioDemand<R>,
        (wanted, bends_at): ([R; 2], R),
        stays: R::Mask,
    ) -> Shifted<R> {
        let before = d.ratio_before;
        let away = R::ln_array([wanted[0] / before, wanted[1] / before]);
        // RC-10: an engine at the end of its speeds is not let above them.
        let is_fastest = (wanted[1] * d.secondary_rad_s).ge(AT_FASTEST * self.highest_rad_s);
        let hysteresis = is_fastest.select(before.splat(0.0), self.hysteresis);
        let waits_s = self.waits_s(d, (wanted[1], hysteresis), away);
        // At an end of the ratio the target stays.
        let at_end = wanted[0].le(self.high) | wanted[0].ge(self.low);
        let bend = (at_end & bends_at.lt(1.0)).select(away[0], away[1]);
        let ends = ([away[0], bend, away[1]], bends_at);
        let way = self.way(d, ends, (waits_s, hysteresis), stays);
        self.shifted(before, wanted, &way, stays)
    }

    /// Time for which a reversal waits, s (RC-10): until it is large enough, or there is none any more.
    fn waits_s(&self, d: &RatioDemand<R>, (wanted, hysteresis): (R, R), away: [R; 2]) -> R {
        let zero = wanted.splat(0.0);
        let direction = zero.map_lanes(|lane| f64::from(*R::get(&d.last_direction, lane)));
        let back = [-direction * away[0], -direction * away[1]];
        let reverses = back[0].gt(0.0) | back[1].gt(0.0);
        let free = wanted.le(self.high)
            | wanted.ge(self.low)
            | (d.ratio_before * d.secondary_rad_s).le(d.free_up_to_rad_s)
            | zero.ge(hysteresis);
        // A ratio that follows its target begins at it but for rounding, whose sign decides nothing.
        let begins = back[0].ge(-AT_TARGET) & hysteresis.ge(back[0]);
        let held = reverses & !free & begins;
        if !held.any() {
            return zero;
        }
        let whole = zero.splat(d.dt_s);
        let grows = back[1].gt(hysteresis);
        let turns = zero.gt(back[1]);
        let apart = back[1] - back[0];
        let until_large = d.dt_s * (hysteresis - back[0]) / apart;
        let until_none = d.dt_s * back[0] / -apart;
        let waits = grows.select(until_large, turns.select(until_none, whole));
        held.select(waits, zero)
    }

    /// Way of ln I over a step to a target that is linear in it from one distance to another up to a share of the step, and from there to a third, after
    /// a time of waiting (RC-17).
    fn way(
        &self,
        d: &RatioDemand<R>,
        (away, bends_at): ([R; 3], R),
        (waits_s, hysteresis): (R, R),
        stays: R::Mask,
    ) -> Way<R> {
        let zero = waits_s.splat(0.0);
        let pace = (d.primary_rad_s / self.rate_speed_rad_s).clamp(0.0, 1.0);
        let (up, down) = (self.up_per_s * pace, self.down_per_s * pace); // RC-4
        let by_flow = [up.gt(d.flow_up_per_s), down.gt(d.flow_down_per_s)];
        let (up, down) = (d.flow_up_per_s.min(up), d.flow_down_per_s.min(down)); // RC-5
        // RC-6: towards high once the launch clutch has locked.
        let locks_s = d.dt_s * d.locks_at.clamp(0.0, 1.0);
        let early = !d.coupled & zero.gt(away[2]) & locks_s.gt(waits_s);
        let waits_s = early.select(locks_s, waits_s);
        let opens = !d.coupled & d.locks_at.ge(1.0);
        let rates = [opens.select(zero, up), down];
        let first_s = d.dt_s * bends_at;
        let whole = bends_at.ge(1.0);
        let mut part = self.part(
            (away[0], away[1] - away[0]),
            (first_s, waits_s.min(first_s)),
            (rates, hysteresis),
        );
        let mut mean = part.area / d.dt_s;
        let mut change = part.change;
        if !whole.all() {
            let left_s = d.dt_s - first_s;
            let from = away[1] - part.change;
            let waits_s = (waits_s - first_s).max(0.0);
            let second = self.part(
                (from, away[2] - away[1]),
                (left_s, waits_s),
                (rates, hysteresis),
            );
            mean = whole.select(mean, mean + (change * left_s + second.area) / d.dt_s);
            change = whole.select(change, change + second.change);
            let goes_on = second.last.abs().gt(MIN_CHANGE);
            part.last = (!whole & goes_on).select(second.last, part.last);
            part.down = whole.select(part.down, second.down);
            part.up = whole.select(part.up, second.up);
            part.tracks = whole.select(part.tracks, second.tracks);
        }
        Way {
            mean,
            change: stays.select(zero, change),
            last: stays.select(zero, part.last),
            tracks: part.tracks,
            held: !stays & ((by_flow[0] & part.up) | (by_flow[1] & part.down)),
        }
    }

    /// Way of ln I within a time, s, to a target at a distance, which changes linearly by some, after waiting for a part of the time: as fast as the rates
    /// towards high and low, 1/s, allow until it meets the target, then with it within the rates.
    fn part(
        &self,
        (away, shifts): (R, R),
        (time_s, waits_s): (R, R),
        ([up, down], hysteresis): ([R; 2], R),
    ) -> Part<R> {
        let zero = away.splat(0.0);
        let slope = time_s.gt(0.0).select(shifts / time_s, zero);
        let left_s = time_s - waits_s;
        let first = away + slope * waits_s;
        let (is_down, is_up) = (first.gt(0.0), zero.gt(first));
        let rate = is_down.select(down, is_up.select(-up, zero));
        let closing = rate - slope;
        let meets_s = first / closing;
        let meets = (closing * first).gt(0.0) & left_s.gt(meets_s);
        let still = zero.ge(first) & first.ge(0.0);
        let moves_s = still.select(zero, meets.select(meets_s, left_s));
        let follows = slope.clamp(-up, down);
        // A reversal within the step waits for the next one (RC-10).
        let moved = (rate * moves_s).abs().gt(MIN_CHANGE);
        let reverses = zero.gt(follows * rate) & moved & hysteresis.gt(0.0);
        let then_s = left_s - moves_s;
        let is_met = still | meets;
        let part = Part {
            change: rate * moves_s + follows * then_s,
            area: rate * moves_s * (0.5 * moves_s + then_s) + 0.5 * follows * then_s * then_s,
            last: rate * moves_s + follows * then_s,
            tracks: is_met & follows.bits_eq(slope),
            down: (is_down & !is_met) | (is_met & slope.gt(down)),
            up: (is_up & !is_met) | (is_met & (-slope).gt(up)),
        };
        if !reverses.any() {
            return part;
        }
        // RC-10: the target has turned round. It waits until that is large enough, then goes after it.
        let waits_s = (hysteresis / slope.abs()).min(then_s);
        let back_s = then_s - waits_s;
        let back = slope.gt(0.0).select(down, -up);
        let meets_s = slope * waits_s / (back - slope);
        let meets = meets_s.gt(0.0) & back_s.gt(meets_s);
        let moves_back_s = meets.select(meets_s, back_s);
        let rest_s = back_s - moves_back_s;
        let (forth, change) = (rate * moves_s, back * moves_back_s + follows * rest_s);
        let area = forth * (0.5 * moves_s + then_s)
            + back * moves_back_s * (0.5 * moves_back_s + rest_s)
            + 0.5 * follows * rest_s * rest_s;
        let goes_back = back_s.gt(0.0);
        let late = goes_back & !meets;
        Part {
            change: reverses.select(forth + change, part.change),
            area: reverses.select(area, part.area),
            last: reverses.select(goes_back.select(change, forth), part.last),
            tracks: (reverses & meets & follows.bits_eq(slope)) | (!reverses & part.tracks),
            down: (reverses & late & slope.gt(0.0)) | (!reverses & part.down),
            up: (reverses & late & zero.gt(slope)) | (!reverses & part.up),
        }
    }

    /// The ratios of a way; none of it where the ratio stays.
    fn shifted(&self, before: R, wanted: [R; 2], way: &Way<R>, stays: R::Mask) -> Shifted<R> {
        let [mean, end] = R::exp_array([way.mean, way.change]);
        let within = |factor: R| (before * factor).clamp(self.high, self.low);
        Shifted {
            mean: stays.select(before, within(mean)),
            end: stays.select(before, way.tracks.select(wanted[1], within(end))),
            change: way.change,
            last: way.last,
            held: way.held,
        }
    }
}

/// Way of ln I within a part of a step.
struct Part<R: Real> {
    /// Its change.
    change: R,
    /// Integral of the change since its beginning, s.
    area: R,
    /// Its change since the ratio turned round.
    last: R,
    /// True where it ends at the target.
    tracks: R::Mask,
    /// True where the rate towards low is what holds it back, ...
    down: R::Mask,
    /// ... or that towards high.
    up: R::Mask,
}

/// Way of ln I within a step.
struct Way<R: Real> {
    /// Mean of its change since the beginning of the step.
    mean: R,
    /// Whole change.
    change: R,
    /// Change since the ratio turned round.
    last: R,
    /// True where the target is reached at the end.
    tracks: R::Mask,
    /// True where pump flow holds it back.
    held: R::Mask,
}

/// Ratio in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shifted<R: Real = f64> {
    /// Mean over the step: what the belt runs at.
    pub mean: R,
    /// At the end of the step: where the next one begins.
    pub end: R,
    /// Change of ln I from the beginning to the end, ...
    pub change: R,
    /// ... and that since the ratio turned round within the step.
    pub last: R,
    /// True where pump flow held it back.
    pub held: R::Mask,
}

#[physics]
impl<R: Real> Shifted<R> {
    /// No shift.
    pub fn none(ratio: R) -> Self {
        Shifted {
            mean: ratio,
            end: ratio,
            change: ratio.splat(0.0),
            last: ratio.splat(0.0),
            held: ratio.splat_mask(false),
        }
    }

    /// `by` where the mask says so.
    pub(in crate::transmission::cvt) fn replaced(self, mask: R::Mask, by: &Self) -> Self {
        Shifted {
            mean: mask.select(by.mean, self.mean),
            end: mask.select(by.end, self.end),
            change: mask.select(by.change, self.change),
            last: mask.select(by.last, self.last),
            held: mask.select(by.held, self.held),
        }
    }
}

#[physics]
impl<R: Real> RatioDemand<R> {
    /// The demand at the beginning of the step.
    pub(in crate::transmission::cvt) fn at(&self, begins: &Moment<R>) -> Self {
        RatioDemand {
            begins: None,
            secondary_rad_s: begins.secondary_rad_s,
            speed_m_s: begins.speed_m_s,
            power_w: begins.power_w,
            share: begins.share,
            full_load_rad_s: begins.full_load_rad_s,
            mapped_rad_s: begins.mapped_rad_s,
            ..self.clone()
        }
    }
}

/// Primary speed over idle speed up to which the ratio turns round at once: the car pulls away and stops in low (RC-10).
pub const FREE_OVER_IDLE: f64 = 1.2;

/// Least target of a line over the speed from which a locked clutch stays so: slip in overrun takes less from it (RC-13).
const ABOVE_LOCK: f64 = 1.006;

/// Least share of rated power over which the target rises from that without power, so that it does not jump (RC-2, RC-11).
const MIN_GENTLE_SHARE: f64 = 0.01;

/// Change of ln I within a step that counts as one: less is rounding (RC-10).
const MIN_CHANGE: f64 = 1e-6;

/// Distance in ln I from which a ratio counts as away from its target (RC-10).
const AT_TARGET: f64 = 1e-9;

/// Engine speed over that of greatest power from which it counts as that, but for rounding (RC-10).
const AT_FASTEST: f64 = 1.0 - 1e-9;

/// Rate of ln I that counts as a change, 1/s (RC-10).
const MIN_RATE_PER_S: f64 = 1e-4;

/// Direction of the last change, after the rate of ln I since it turned round, 1/s (RC-10).
#[physics]
pub fn direction_after<R: Real>(rate_per_s: R, last_direction: &R::PerLane<i8>) -> R::PerLane<i8> {
    R::per_lane(|lane| match rate_per_s.lane(lane) {
        rate if rate > MIN_RATE_PER_S => 1,
        rate if rate < -MIN_RATE_PER_S => -1,
        _ => *R::get(last_direction, lane),
    })
}

keys! {
    /// Keys of `[transmission.cvt.ratio]`.
    RATIO: RatioKeys = "ratio" [] {
        low: number(0.3, 3.3), "belt ratio of the lowest gear";
        high: number(0.3, 3.3), "belt ratio of the highest gear";
        gentle_rpm: number(500.0, 10_000.0), "engine speed in gentle acceleration", ["RC-1"];
        gentle_power_share: number(0.0, 1.0), "share of rated power in gentle acceleration", ["RC-1", "RC-2"];
        rise_rpm: number(0.0, 20_000.0), "rise of engine speed over the share of rated power above it", ["RC-1"];
        overrun_rpm: optional(number(500.0, 10_000.0)), "engine speed without power and in overrun; absent: that of gentle acceleration", ["RC-2"];
        route_efficiency: or(0.85, number(0.3, 1.0)), "wheel power over engine power on the full-load route", ["RC-3"];
        up_per_s: above(0.0, 20.0), "rate of ln I towards high", ["RC-4"];
        down_per_s: above(0.0, 20.0), "rate of ln I towards low", ["RC-4"];
        rate_speed_rpm: number(500.0, 10_000.0), "primary speed from which the full rates hold", ["RC-4"];
        hysteresis: or(0.05, number(0.0, 0.5)), "change of ln I from which the ratio turns round", ["RC-10"];
        filter_s: or(1.0, number(0.0, 10.0)), "time constant of the demand in gentle driving", ["RC-9"];
        drive_line: optional(rows(&[("power_percent", Bound::closed(0.0, 200.0)), ("speed_rpm", Bound::closed(300.0, 12_000.0))])), "target over demand in place of gentle_rpm and rise_rpm: rows [share of rated power %, engine speed rpm]", ["RC-13"];
        overrun_line: optional(rows(&[("speed_kmh", Bound::closed(0.0, 400.0)), ("speed_rpm", Bound::closed(300.0, 12_000.0))])), "target without power and in overrun in place of overrun_rpm: rows [road speed km/h, engine speed rpm]", ["RC-13"];
        shift_map: optional(csv()), "CSV of the target over road speed and demand in place of gentle_rpm, rise_rpm and overrun_rpm; columns speed_kmh, pedal_percent or power_kw, and input_speed_rpm, engine_speed_rpm or belt_ratio", ["RC-14"];
        cold_rise_rpm: or(0.0, number(0.0, 2000.0)), "rise of engine speed in a cold car", ["RC-11"];
        cold_from_degc: or(0.0, number(-60.0, 110.0)), "temperature up to which that is in full", ["RC-11"];
        cold_to_degc: or(50.0, number(-50.0, 120.0)), "temperature from which there is none of it", ["RC-11"];
        cold_by: words(&[
            Choice::word("coolant", "the temperature is that of the coolant"),
            Choice::word("sump", "the temperature is that of the transmission oil"),
        ], "coolant"), "whose temperature that is", ["RC-11"];
    }
}

/// The lines that the file gives.
fn line<V: Values>(s: &V) -> Option<Box<OperatingLine>> {
    let own = |key| {
        let rows = s.rows(key).filter(|rows| !rows.is_empty());
        rows.map(|rows| curve(s, key, &rows))
    };
    let line = OperatingLine {
        drive: own(&RATIO.drive_line),
        overrun: own(&RATIO.overrun_line),
    };
    (line != OperatingLine::default()).then(|| Box::new(line))
}

impl RatioControl {
    /// The ratio control from the values of its table; `highest_rad_s` ends the full-load route.
    pub fn from_values<V: Values>(s: &V, highest_rad_s: f64) -> Self {
        let gentle_rad_s = s.number(&RATIO.gentle_rpm);
        let control = RatioControl {
            low: s.number(&RATIO.low),
            high: s.number(&RATIO.high),
            gentle_rad_s,
            gentle_share: s.number(&RATIO.gentle_power_share),
            rise_rad_s: s.number(&RATIO.rise_rpm),
            overrun_rad_s: s.optional(&RATIO.overrun_rpm).unwrap_or(gentle_rad_s),
            highest_rad_s,
            route_efficiency: s.number(&RATIO.route_efficiency),
            up_per_s: s.number(&RATIO.up_per_s),
            down_per_s: s.number(&RATIO.down_per_s),
            rate_speed_rad_s: s.number(&RATIO.rate_speed_rpm),
            hysteresis: s.number(&RATIO.hysteresis),
            filter_s: s.number(&RATIO.filter_s),
            line: line(s),
            shift_map: shift_map(
                s,
                &RATIO.shift_map,
                &[&RATIO.drive_line, &RATIO.overrun_line],
            ),
            cold: ColdRise {
                rise_rad_s: s.number(&RATIO.cold_rise_rpm),
                from_k: s.number(&RATIO.cold_from_degc),
                to_k: s.number(&RATIO.cold_to_degc),
                by_sump: s.word(&RATIO.cold_by) == "sump",
            },
        };
        if control.cold.to_k <= control.cold.from_k {
            s.complain(
                RATIO.cold_to_degc.name,
                "above cold_from_degc",
                "the line of a cold car would end before it is in full",
                "raise it or lower `cold_from_degc`",
            );
        }
        if control.low <= control.high {
            s.complain(
                "low",
                "above `high`",
                "low must be the larger belt ratio",
                "I = R_sec / R_pri: above 1 is low, below 1 is high",
            );
        }
        control
    }
}
