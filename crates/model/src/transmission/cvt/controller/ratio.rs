//! Which ratio the box takes: a variogram with a limited shift rate.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RC-1 | target speed: 1700 rpm at 15 % power, + g (P/P_max - 15 %) above it | 1700 rpm source: thesis 1.1.2, Fig 1-6; 15 % and rise ASSUMED |
//! | RC-2 | below 15 % power the target falls linearly to that without power, which holds in overrun too | source: thesis 3.7 and 1.1.2 (J of Fig 1-6) in words; size ASSUMED |
//! | RC-13 | target in place of RC-1 and RC-2: n_d(u) of the drive line, n_o(v) of the overrun line while P <= 0, where the file has these lines; at least 1.006 times 1.2 idle speed, where the clutch stays locked (LC-5) | derived: any target of a controller that sees demand and speed; lines for a car by DP-12 |
//! | RC-12 | a held step has its own ratio and clamp law in place of RC-1 to RC-14 and PC-1 to PC-6 | derived: definition |
//! | RC-15 | a step that asks for a ratio goes towards it within RC-4 and RC-5, in place of RC-1 to RC-3 and RC-6 to RC-14 | derived: definition; the box's own limits hold for any controller |
//! | RC-3 | never below the speed at which full load gives the power asked for, over an efficiency | source: thesis 1.1.2, route G-H-F in words; efficiency ASSUMED |
//! | RC-7 | where full load does not suffice, RC-3 is asked again with 0.995 min(eta, P/P_e), P_e the engine power of that try, until it does, the ratio no longer changes, or 40 %; RC-10 holds none of it back | derived: kick-down, within RC-4 and RC-5 |
//! | RC-8 | target never above the speed of greatest power | source: thesis 1.1.2, maximum power route |
//! | RC-4 | \|d ln I/dt\| <= rate min(1, n_p/n_ref), up and down rates apart, n_p the speed of the primary; none while the belt is at rest | source: thesis 2.4, 3.7 in words; values ASSUMED |
//! | RC-6 | no up-shift before the launch clutch has locked | source: thesis 1.1.2, order A-B-C-D of the variogram |
//! | RC-9 | RC-1 and RC-2 look at u <- u + (P/P_max - u)(1 - exp(-dt/tau)); RC-3 at P itself | ASSUMED: tau 0 to 3 s |
//! | RC-10 | a change against the last one is made where \|ln(I*/I)\| > h, then in full; always to the ends of the ratio, and below 1.2 idle speed of the primary | ASSUMED: spools have friction and a pitot signal is a difference; h 0.02 to 0.10 |
//! | RC-11 | cold: target + r clip((T_to - T)/(T_to - T_from), 0, 1) u_1, T of coolant or sump, u_1 rising from 0 without power to 1 at 1 % of rated power | ASSUMED: r 300 to 1000 rpm, gone by 40 to 60 degC coolant in modern cars; none in overrun |
//! | RC-5 | and <= free pump flow / (A 2 tan th \|dR/d ln I\|) | derived: thesis 9.1 |
//!
//! The power asked for is wheel power, so the ratio never chases its own losses.

use super::shift_map::{ShiftMap, shift_map};
use crate::keys::{Bound, Choice, Values, curve, keys};
use crate::math::{Curve, clamp, exp, larger, ln, ramp, smaller};
use std::sync::Arc;

/// The checked controller.
#[derive(Clone, Debug, PartialEq)]
pub struct RatioControl {
    /// Lowest gear: largest belt ratio.
    pub low: f64,
    /// Highest gear: smallest belt ratio.
    pub high: f64,
    /// Speed in gentle acceleration, rad/s.
    pub gentle_rad_s: f64,
    /// Share of rated power in gentle acceleration.
    pub gentle_share: f64,
    /// Rise of speed over the share of rated power above it, rad/s.
    pub rise_rad_s: f64,
    /// Speed without power and in overrun, rad/s.
    pub overrun_rad_s: f64,
    /// Highest target speed: that of the engine's greatest power, rad/s.
    pub highest_rad_s: f64,
    /// Wheel power over engine power that RC-3 reckons with.
    pub route_efficiency: f64,
    /// Rate towards high, 1/s in ln I.
    pub up_per_s: f64,
    /// Rate towards low, 1/s in ln I.
    pub down_per_s: f64,
    /// Primary speed from which the full rates hold, rad/s.
    pub rate_speed_rad_s: f64,
    /// Change of ln I from which the ratio turns round.
    pub hysteresis: f64,
    /// Time constant of the demand that gentle driving looks at, s; 0 without a filter.
    pub filter_s: f64,
    /// Lines in place of gentle driving, if there are any.
    pub line: Option<Box<OperatingLine>>,
    /// A table in place of gentle driving, if there is one; lines come before it.
    pub shift_map: Option<Arc<ShiftMap>>,
    /// What a cold car adds to the target.
    pub cold: ColdRise,
}

/// Target speeds in place of RC-1 and RC-2 (RC-13).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OperatingLine {
    /// Engine speed over the share of rated power asked for, rad/s.
    pub drive: Option<Curve>,
    /// Engine speed over road speed in m/s while no power is asked for, rad/s.
    pub overrun: Option<Curve>,
}

impl OperatingLine {
    /// The target at a demand, rad/s, where a line has it.
    fn target_rad_s(&self, d: &RatioDemand) -> Option<f64> {
        let (line, x) = if d.power_w > 0.0 {
            (&self.drive, d.share)
        } else {
            (&self.overrun, d.speed_m_s)
        };
        let locked_rad_s = ABOVE_LOCK * d.free_up_to_rad_s;
        line.as_ref().map(|line| larger(line.at(x), locked_rad_s)) // RC-13
    }
}

/// What a cold car adds to the target of engine speed (RC-11).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColdRise {
    /// Rise in full, rad/s.
    pub rise_rad_s: f64,
    /// Temperature up to which it is in full, K.
    pub from_k: f64,
    /// Temperature from which there is none, K.
    pub to_k: f64,
    /// True where the sump's temperature counts, false for the coolant's.
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

    /// The rise at the temperatures of coolant and sump, K, rad/s.
    #[inline]
    pub fn at(&self, coolant_k: f64, sump_k: f64) -> f64 {
        let temp_k = if self.by_sump { sump_k } else { coolant_k };
        self.rise_rad_s * (1.0 - ramp(temp_k, self.from_k, self.to_k)) // RC-11
    }
}

/// What the controller looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioDemand {
    /// Speed of the secondary once the clutch has locked, rad/s.
    pub secondary_rad_s: f64,
    /// Speed of the primary, rad/s.
    pub primary_rad_s: f64,
    /// Road speed, m/s.
    pub speed_m_s: f64,
    /// Wheel power asked for, W.
    pub power_w: f64,
    /// Share of rated power that RC-1 and RC-2 look at (RC-9).
    pub share: f64,
    /// Lowest speed at which full load gives the power asked for, rad/s.
    pub full_load_rad_s: f64,
    /// What the shift map has for it, rad/s (RC-14); none without one.
    pub mapped_rad_s: Option<f64>,
    /// What a cold car adds to the target, rad/s.
    pub cold_rad_s: f64,
    /// Ratio before the step.
    pub ratio_before: f64,
    /// Limit from pump flow towards low, 1/s.
    pub flow_down_per_s: f64,
    /// Limit from pump flow towards high, 1/s.
    pub flow_up_per_s: f64,
    /// Whether the launch clutch has locked.
    pub coupled: bool,
    /// Direction of the last change: 1 towards low, -1 towards high, 0 before the first.
    pub last_direction: i8,
    /// Primary speed up to which the ratio turns round at once, rad/s.
    pub free_up_to_rad_s: f64,
    /// Step, s.
    pub dt_s: f64,
}

impl RatioControl {
    /// Target primary speed, rad/s (RC-1 to RC-3, RC-11, RC-13, RC-14).
    pub fn target_rad_s(&self, d: &RatioDemand) -> f64 {
        let line = self.line.as_ref().and_then(|line| line.target_rad_s(d));
        let given = line.or_else(|| {
            let locked_rad_s = ABOVE_LOCK * d.free_up_to_rad_s;
            d.mapped_rad_s.map(|mapped| larger(mapped, locked_rad_s)) // RC-14
        });
        let mut speed = given.unwrap_or_else(|| self.gentle_target_rad_s(d.share));
        if d.cold_rad_s > 0.0 {
            speed += d.cold_rad_s * clamp(d.share / LEAST_GENTLE_SHARE, 0.0, 1.0); // RC-11
        }
        if d.power_w > 0.0 && d.full_load_rad_s > speed {
            speed = d.full_load_rad_s; // RC-3
        }
        smaller(speed, self.highest_rad_s)
    }

    /// Target at a share of rated power, rad/s.
    #[inline]
    fn gentle_target_rad_s(&self, share: f64) -> f64 {
        let drive = clamp(
            share / larger(self.gentle_share, LEAST_GENTLE_SHARE),
            0.0,
            1.0,
        );
        let mut speed = self.overrun_rad_s + drive * (self.gentle_rad_s - self.overrun_rad_s); // RC-2
        if share > self.gentle_share {
            speed += self.rise_rad_s * (share - self.gentle_share); // RC-1
        }
        speed
    }

    /// Share of rated power that RC-1 and RC-2 look at after a step, from that before and the one asked for (RC-9).
    #[inline]
    pub fn filtered_share(&self, before: f64, asked: f64, dt_s: f64) -> f64 {
        if self.filter_s > 0.0 {
            before + (asked - before) * (1.0 - exp(-dt_s / self.filter_s)) // RC-9
        } else {
            asked
        }
    }

    /// Ratio after the step and its change in ln I (RC-4, RC-5), and whether pump flow held it back.
    pub fn step(&self, d: &RatioDemand) -> (f64, f64, bool) {
        let before = d.ratio_before;
        if d.primary_rad_s <= 0.0 {
            return (before, 0.0, false); // RC-4
        }
        let wanted = clamp(
            self.target_rad_s(d) / d.secondary_rad_s,
            self.high,
            self.low,
        );
        let wanted = if !d.coupled && wanted < before {
            before
        } else {
            wanted
        }; // RC-6
        if wanted.to_bits() == before.to_bits() {
            return (before, 0.0, false);
        }
        let change = ln(wanted / before);
        if self.stays(d, wanted, change) {
            return (before, 0.0, false); // RC-10
        }
        self.limited(d, wanted, change)
    }

    /// The same towards a ratio that is asked for from outside (RC-15).
    pub fn paced(&self, d: &RatioDemand, asked: f64) -> (f64, f64, bool) {
        let wanted = clamp(asked, self.high, self.low);
        if wanted.to_bits() == d.ratio_before.to_bits() {
            return (wanted, 0.0, false);
        }
        self.limited(d, wanted, ln(wanted / d.ratio_before))
    }

    /// As much of a change of ln I, to a wanted ratio, as the rates allow (RC-4, RC-5).
    #[inline(always)]
    fn limited(&self, d: &RatioDemand, wanted: f64, change: f64) -> (f64, f64, bool) {
        let before = d.ratio_before;
        let pace = clamp(d.primary_rad_s / self.rate_speed_rad_s, 0.0, 1.0);
        let (mut up, mut down) = (self.up_per_s * pace, self.down_per_s * pace); // RC-4
        let short_of_flow =
            (change > 0.0 && d.flow_down_per_s < down && change > d.flow_down_per_s * d.dt_s)
                || (change < 0.0 && d.flow_up_per_s < up && -change > d.flow_up_per_s * d.dt_s);
        up = smaller(d.flow_up_per_s, up);
        down = smaller(d.flow_down_per_s, down); // RC-5
        let (least, most) = (-up * d.dt_s, down * d.dt_s);
        if least <= change && change <= most {
            return (wanted, change, short_of_flow);
        }
        let change = clamp(change, least, most);
        (
            clamp(before * exp(change), self.high, self.low),
            change,
            short_of_flow,
        )
    }
}

impl RatioControl {
    /// True where a change of ln I is a reversal too small to be made (RC-10).
    fn stays(&self, d: &RatioDemand, wanted: f64, change: f64) -> bool {
        let reversal = f64::from(d.last_direction) * change < 0.0;
        reversal
            && change.abs() <= self.hysteresis
            && self.high < wanted
            && wanted < self.low
            && d.ratio_before * d.secondary_rad_s > d.free_up_to_rad_s
    }
}

/// Primary speed over idle speed up to which the ratio turns round at once: the car pulls away and stops in low (RC-10).
pub const FREE_OVER_IDLE: f64 = 1.2;

/// Least target of a line over the speed from which a locked clutch stays so: slip in overrun takes less from it (RC-13).
const ABOVE_LOCK: f64 = 1.006;

/// Least share of rated power over which the target rises from that without power, so that it does not jump (RC-2, RC-11).
const LEAST_GENTLE_SHARE: f64 = 0.01;

/// Change of ln I that counts as one (RC-10).
const LEAST_CHANGE: f64 = 1e-4;

/// Direction of the last change, after a change of ln I (RC-10).
pub fn direction_after(change: f64, last_direction: i8) -> i8 {
    if change > LEAST_CHANGE {
        1
    } else if change < -LEAST_CHANGE {
        -1
    } else {
        last_direction
    }
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
