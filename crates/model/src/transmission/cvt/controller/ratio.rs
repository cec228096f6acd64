//! Ratio control: a variogram with a limited shift rate.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RC-1 | target speed: 1700 rpm at 15 % power, + g (P/P_max - 15 %) above it | 1700 rpm source: thesis 1.1.2, Fig 1-6; 15 % and rise ASSUMED |
//! | RC-2 | below 15 % power the target falls linearly to that without power, which holds in overrun too | source: thesis 3.7 and 1.1.2 (J of Fig 1-6) in words; size ASSUMED |
//! | RC-13 | target in place of RC-1 and RC-2: n_d(u) of the drive line, n_o(v) of the overrun line while P <= 0, where the file has these lines; at least 1.006 times 1.2 idle speed, where the clutch stays locked (LC-5) | derived: any target of a controller that sees demand and speed; lines for a car by DP-12 |
//! | RC-12 | a held step has its own ratio and clamp law in place of RC-1 to RC-14 and PC-1 to PC-6 | derived: definition |
//! | RC-15 | a step for which a ratio is demanded goes towards it within RC-4 and RC-5, in place of RC-1 to RC-3 and RC-6 to RC-14 | derived: definition; the box's own limits hold for any controller |
//! | RC-3 | never below the speed at which full load gives the power asked for, over an efficiency | source: thesis 1.1.2, route G-H-F in words; efficiency ASSUMED |
//! | RC-7 | where full load does not suffice, RC-3 is asked again with 0.995 min(eta, P/P_e), P_e the engine power of that try, until it does, the ratio no longer changes, or 40 %; RC-10 holds none of it back | derived: kick-down, within RC-4 and RC-5 |
//! | RC-8 | target never above the speed of greatest power | source: thesis 1.1.2, maximum power route |
//! | RC-4 | \|d ln I/dt\| <= rate min(1, n_p/n_ref), up and down rates apart, n_p the speed of the primary; none while the belt is at rest | source: thesis 2.4, 3.7 in words; values ASSUMED |
//! | RC-6 | no up-shift before the launch clutch has locked | source: thesis 1.1.2, order A-B-C-D of the variogram |
//! | RC-9 | RC-1 and RC-2 look at u <- u + (P/P_max - u)(1 - exp(-dt/tau)); RC-3 at P itself | ASSUMED: tau 0 to 3 s |
//! | RC-10 | a change against the last one is made where \|ln(I*/I)\| > h, then in full; always to the ends of the ratio, and below 1.2 idle speed of the primary | ASSUMED: spools have friction and a pitot signal is a difference; h 0.02 to 0.10 |
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

/// Inputs of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioDemand<R: Real = f64> {
    /// Speed of the secondary once the clutch has locked, rad/s.
    pub secondary_rad_s: R,
    /// Speed of the primary, rad/s.
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

    /// Share of rated power that RC-1 and RC-2 look at after a step, from that before and the one asked for (RC-9).
    pub fn filtered_share(&self, before: R, asked: R, dt_s: f64) -> R {
        let filters = self.filter_s.gt(0.0);
        if !filters.any() {
            return asked;
        }
        let filtered = before + (asked - before) * (1.0 - (-dt_s / self.filter_s).exp()); // RC-9
        filters.select(filtered, asked)
    }

    /// Ratio after the step and its change in ln I (RC-4, RC-5), and whether pump flow held it back.
    pub fn step(&self, d: &RatioDemand<R>) -> (R, R, R::Mask) {
        let before = d.ratio_before;
        let zero = before.splat(0.0);
        let rests = zero.ge(d.primary_rad_s); // RC-4
        if rests.all() {
            return (before, zero, before.splat_mask(false));
        }
        let wanted = (self.target_rad_s(d) / d.secondary_rad_s).clamp(self.high, self.low);
        let too_early = !d.coupled & before.gt(wanted); // RC-6
        let wanted = too_early.select(before, wanted);
        let mut stays = rests | wanted.bits_eq(before);
        if stays.all() {
            return (before, zero, before.splat_mask(false));
        }
        let change = (wanted / before).ln();
        stays = stays | self.stays(d, wanted, change); // RC-10
        if stays.all() {
            return (before, zero, before.splat_mask(false));
        }
        self.limited(d, (wanted, change), stays)
    }

    /// The same towards a ratio that is asked for from outside (RC-15).
    pub fn paced(&self, d: &RatioDemand<R>, asked: R) -> (R, R, R::Mask) {
        let before = d.ratio_before;
        let wanted = asked.clamp(self.high, self.low);
        let stays = wanted.bits_eq(before);
        if stays.all() {
            return (wanted, before.splat(0.0), before.splat_mask(false));
        }
        self.limited(d, (wanted, (wanted / before).ln()), stays)
    }

    /// As much of a change of ln I, to a wanted ratio, as the rates allow (RC-4, RC-5); none where the ratio stays.
    fn limited(
        &self,
        d: &RatioDemand<R>,
        (wanted, change): (R, R),
        stays: R::Mask,
    ) -> (R, R, R::Mask) {
        let before = d.ratio_before;
        let zero = before.splat(0.0);
        let pace = (d.primary_rad_s / self.rate_speed_rad_s).clamp(0.0, 1.0);
        let (up, down) = (self.up_per_s * pace, self.down_per_s * pace); // RC-4
        let (flow_up, flow_down) = (d.flow_up_per_s, d.flow_down_per_s);
        let short_down = change.gt(0.0) & down.gt(flow_down) & change.gt(flow_down * d.dt_s);
        let short_up = zero.gt(change) & up.gt(flow_up) & (-change).gt(flow_up * d.dt_s);
        let (up, down) = (flow_up.min(up), flow_down.min(down)); // RC-5
        let (least, most) = (-up * d.dt_s, down * d.dt_s);
        let free = change.ge(least) & most.ge(change);
        let (mut ratio, mut made) = (wanted, change);
        if !(free | stays).all() {
            let held = change.clamp(least, most);
            let moved = (before * held.exp()).clamp(self.high, self.low);
            ratio = free.select(wanted, moved);
            made = free.select(change, held);
        }
        (
            stays.select(before, ratio),
            stays.select(zero, made),
            !stays & (short_down | short_up),
        )
    }

    /// True where a change of ln I is a reversal too small to be made (RC-10).
    fn stays(&self, d: &RatioDemand<R>, wanted: R, change: R) -> R::Mask {
        let direction = change.map_lanes(|lane| f64::from(*R::get(&d.last_direction, lane)));
        change.splat(0.0).gt(direction * change)
            & self.hysteresis.ge(change.abs())
            & wanted.gt(self.high)
            & self.low.gt(wanted)
            & (d.ratio_before * d.secondary_rad_s).gt(d.free_up_to_rad_s)
    }
}

/// Primary speed over idle speed up to which the ratio turns round at once: the car pulls away and stops in low (RC-10).
pub const FREE_OVER_IDLE: f64 = 1.2;

/// Least target of a line over the speed from which a locked clutch stays so: slip in overrun takes less from it (RC-13).
const ABOVE_LOCK: f64 = 1.006;

/// Least share of rated power over which the target rises from that without power, so that it does not jump (RC-2, RC-11).
const MIN_GENTLE_SHARE: f64 = 0.01;

/// Change of ln I that counts as one (RC-10).
const MIN_CHANGE: f64 = 1e-4;

/// Direction of the last change, after a change of ln I (RC-10).
#[physics]
pub fn direction_after<R: Real>(change: R, last_direction: &R::PerLane<i8>) -> R::PerLane<i8> {
    R::per_lane(|lane| match change.lane(lane) {
        change if change > MIN_CHANGE => 1,
        change if change < -MIN_CHANGE => -1,
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
