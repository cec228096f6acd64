//! A speed trace: intervals over which speed is linear, and their division into steps.

use super::gears::{GearColumns, GearCommand};
use crate::math::{Real, exp, larger, ln, physics};
use std::borrow::Cow;
use std::sync::Arc;

/// Speed below which a car is at rest, m/s: 0.1 km/h. ASSUMED, between the noise of wheel speed sensors at rest, up to 0.05 km/h, and the least speed of a
/// shipped cycle that moves, 0.16 km/h (0.1 mph); a table in steps of 0.1 km/h keeps all of its speeds.
pub const STANDSTILL_M_S: f64 = 0.1 / 3.6;

/// Speed by which a car may be slower than its trace, m/s, where the procedure of the cycle says nothing else: 2 km/h (TR-3).
pub const TOLERANCE_M_S: f64 = 2.0 / 3.6;

/// True for the speed of a car at rest, m/s.
#[must_use]
pub fn is_standstill(speed_m_s: f64) -> bool {
    speed_m_s < STANDSTILL_M_S
}

/// Share of an interval next to its ends in which it is not cut where a speed is passed: parts so short would say no more than the interval.
const LEAST_SHARE: f64 = 1e-3;

/// One interval of a trace, from one row of its table to the next. Speed is linear within it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Time at the start, s from the start of the cycle.
    pub start_s: f64,
    /// Time at the end, s; always greater than the start.
    pub end_s: f64,
    /// Speed at the start, m/s.
    pub start_speed_m_s: f64,
    /// Speed at the end, m/s.
    pub end_speed_m_s: f64,
    /// Index into [`super::Cycle::phases`]; 0 in a cycle without phases.
    pub phase: u16,
    /// Slope of the road, rise over run; uphill is positive.
    pub grade: f64,
    /// True if the engine is off by prescription (the soak of FTP75).
    pub engine_off: bool,
}

impl Interval {
    /// Distance driven, m: exact, since speed is linear.
    pub fn distance_m(&self) -> f64 {
        0.5 * (self.start_speed_m_s + self.end_speed_m_s) * (self.end_s - self.start_s)
    }

    /// True if the car moves in it. The intervals of a trace have 0 where it is at rest.
    fn moves(&self) -> bool {
        self.start_speed_m_s > 0.0 || self.end_speed_m_s > 0.0
    }

    /// The interval with 0 for each end at which the car is at rest.
    fn at_rest(self) -> Self {
        let speed_m_s = |own: f64| if is_standstill(own) { 0.0 } else { own };
        Interval {
            start_speed_m_s: speed_m_s(self.start_speed_m_s),
            end_speed_m_s: speed_m_s(self.end_speed_m_s),
            ..self
        }
    }

    // 1e-9: an interval that is a multiple of max_dt up to rounding is not cut once more
    #[inline]
    fn parts(&self, max_dt_s: f64) -> usize {
        if self.end_s - self.start_s <= max_dt_s {
            return 1; // the usual case, without a division
        }
        let parts = ((self.end_s - self.start_s) / max_dt_s - 1e-9).ceil();
        if max_dt_s > 0.0 && parts > 1.0 {
            parts as usize
        } else {
            1
        }
    }

    // The division points come from the index alone, so that they neither drift nor differ between neighbours.
    fn point(&self, index: usize, parts: usize) -> (f64, f64) {
        if index == parts {
            return (self.end_s, self.end_speed_m_s);
        }
        let share = index as f64 / parts as f64;
        let time_s = self.start_s + share * (self.end_s - self.start_s);
        (
            time_s,
            self.start_speed_m_s + share * (self.end_speed_m_s - self.start_speed_m_s),
        )
    }

    fn motion(&self) -> Motion {
        Motion::between(
            self.start_speed_m_s,
            self.end_speed_m_s,
            self.end_s - self.start_s,
        )
    }

    /// The whole interval as one step.
    #[inline]
    fn whole(&self, interval: usize, motion: Motion) -> Step {
        Step {
            time_s: self.end_s,
            dt_s: self.end_s - self.start_s,
            start_speed_m_s: self.start_speed_m_s,
            end_speed_m_s: self.end_speed_m_s,
            motion,
            phase: self.phase,
            grade: self.grade,
            engine_off: self.engine_off,
            interval,
        }
    }

    /// A part of the interval as a step.
    fn step(&self, interval: usize, index: usize, parts: usize) -> Step {
        let (_, start_speed_m_s) = self.point(index, parts);
        let (time_s, end_speed_m_s) = self.point(index + 1, parts);
        let dt_s = (self.end_s - self.start_s) / parts as f64;
        Step {
            time_s,
            dt_s,
            start_speed_m_s,
            end_speed_m_s,
            ..self.whole(
                interval,
                Motion::between(start_speed_m_s, end_speed_m_s, dt_s),
            )
        }
    }
}

/// Quantities from the speeds of a step alone: a trace computes them once for all cars and drives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Mean speed, m/s.
    pub speed_m_s: f64,
    /// Acceleration, m/s2.
    pub accel_m_s2: f64,
    /// Mean square of the speed, m2/s2.
    pub square_m2_s2: f64,
    /// Mean cube of the speed, m3/s3.
    pub cube_m3_s3: f64,
    /// Mean speed in m/s to the power of 0.7, as heat transfer to the air needs it; 0 at standstill.
    pub speed_power_07: f64,
}

/// Means of a speed that is linear from one value to another, of its square and of its cube.
#[physics]
pub fn mean_powers<R: Real>(v0: R, v1: R) -> [R; 3] {
    [
        0.5 * (v0 + v1),
        (v0 * v0 + v0 * v1 + v1 * v1) / 3.0,
        (v0 + v1) * (v0 * v0 + v1 * v1) / 4.0,
    ]
}

impl Motion {
    /// True in a step at rest. Exact: the trace has 0 at its rows where the car is at rest ([`STANDSTILL_M_S`]), and parts of the interval in which it
    /// starts or stops have a mean speed, however low, that takes work.
    #[inline]
    pub fn rests(&self) -> bool {
        self.speed_m_s <= 0.0
    }

    /// Speed linear from one value to another, m/s, within a time, s.
    #[inline]
    pub fn between(from_m_s: f64, to_m_s: f64, dt_s: f64) -> Self {
        let [speed_m_s, square_m2_s2, cube_m3_s3] = mean_powers(from_m_s, to_m_s);
        Motion {
            speed_m_s,
            accel_m_s2: (to_m_s - from_m_s) / dt_s,
            square_m2_s2,
            cube_m3_s3,
            speed_power_07: if speed_m_s > 0.0 {
                exp(0.7 * ln(speed_m_s))
            } else {
                0.0
            },
        }
    }
}

/// One step of the simulation: an interval or an equal part of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Time at the end of the step, s from the start of the cycle.
    pub time_s: f64,
    /// Length, s.
    pub dt_s: f64,
    /// Speed at the start, m/s; equal to the end speed of the step before.
    pub start_speed_m_s: f64,
    /// Speed at the end, m/s.
    pub end_speed_m_s: f64,
    /// Quantities from these speeds.
    pub motion: Motion,
    /// Index into [`super::Cycle::phases`]; 0 in a cycle without phases.
    pub phase: u16,
    /// Slope of the road, rise over run.
    pub grade: f64,
    /// True if the engine is off by prescription.
    pub engine_off: bool,
    /// Index into [`Trace::intervals`] and into [`Trace::gears`].
    pub interval: usize,
}

#[physics]
impl Step {
    /// Distance driven, m.
    pub fn distance_m(&self) -> f64 {
        self.motion.speed_m_s * self.dt_s
    }
}

/// Speed trace with grades and commands. Copies share the intervals.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The intervals in time order, each beginning where the one before ends; the first begins at 0 s.
    pub intervals: Arc<Vec<Interval>>,
    /// Quantities of every interval.
    motions: Arc<Vec<Motion>>,
    gears: GearColumns,
    selector_s: f64,
    tolerance_m_s: f64,
}

impl Trace {
    /// A trace that prescribes no gears.
    pub fn without_gears(intervals: Vec<Interval>) -> Self {
        Self::with_gears(intervals, GearColumns::default())
    }

    /// A trace with prescribed gears, one command an interval. Speeds below [`STANDSTILL_M_S`] become 0: noise at rest moves no car.
    pub fn with_gears(mut intervals: Vec<Interval>, gears: GearColumns) -> Self {
        for interval in &mut intervals {
            *interval = interval.at_rest();
        }
        Self::as_given(intervals, gears)
    }

    /// A trace of intervals with any speeds.
    fn as_given(intervals: Vec<Interval>, gears: GearColumns) -> Self {
        Self {
            motions: Arc::new(intervals.iter().map(Interval::motion).collect()),
            intervals: Arc::new(intervals),
            gears,
            selector_s: 0.0,
            tolerance_m_s: TOLERANCE_M_S,
        }
    }

    /// Time from a start of the engine until an automatic box is in drive, by the procedure of the cycle, s; 0 where it says nothing.
    pub fn selector_s(&self) -> f64 {
        self.selector_s
    }

    /// The same trace with a procedure that has an automatic box in drive some time after a start of the engine, s.
    #[must_use]
    pub fn with_selector_s(self, selector_s: f64) -> Self {
        Trace { selector_s, ..self }
    }

    /// Speed by which a car may be slower than the trace, m/s (TR-3).
    pub fn tolerance_m_s(&self) -> f64 {
        self.tolerance_m_s
    }

    /// The same trace with another tolerance of speed, m/s.
    #[must_use]
    pub fn with_tolerance_m_s(self, tolerance_m_s: f64) -> Self {
        Trace {
            tolerance_m_s,
            ..self
        }
    }

    /// The prescribed gears, to be changed.
    pub fn gear_columns_mut(&mut self) -> &mut GearColumns {
        &mut self.gears
    }

    /// The prescribed gears by the name of their column.
    pub fn gear_columns(&self) -> impl Iterator<Item = (&'static str, &[GearCommand])> {
        self.gears.columns()
    }

    /// True if the trace prescribes gears for some gearbox.
    pub fn has_gears(&self) -> bool {
        !self.gears.is_empty()
    }

    /// The prescribed commands for a gearbox with this many gears, one an interval. `None`: nothing is prescribed for
    /// it, and the driver's shift speeds decide. The columns `gear_5mt` and `gear_6mt` are for five and six gears only; a
    /// user's column `gear` serves every gearbox that has all the gears it names.
    pub fn gears(&self, gear_count: usize) -> Option<&[GearCommand]> {
        self.gears.for_count(gear_count)
    }

    /// Time from an instant in an interval, s, until the car moves, s; infinite where it moves no more.
    pub fn rest_s(&self, interval: usize, from_s: f64) -> f64 {
        let later = self.intervals.get(interval..).unwrap_or_default();
        let mut moving = later.iter().filter(|interval| interval.moves());
        moving.next().map_or(f64::INFINITY, |interval| {
            larger(interval.start_s - from_s, 0.0)
        })
    }

    /// Begin and end of each rest of the car, s; the end of the last may be infinite.
    pub fn rests_s(&self) -> Vec<(f64, f64)> {
        let starts = self
            .intervals
            .iter()
            .enumerate()
            .filter(|(number, interval)| {
                !interval.moves() && (*number == 0 || self.intervals[number - 1].moves())
            });
        let rest = |(number, interval): (usize, &Interval)| {
            let from_s = interval.start_s;
            (from_s, from_s + self.rest_s(number, from_s))
        };
        starts.map(rest).collect()
    }

    /// The same trace with rows at more times, s.
    #[must_use]
    pub fn cut(&self, at_s: &[f64]) -> Self {
        let mut at_s = at_s.to_vec();
        at_s.sort_by(f64::total_cmp);
        let mut intervals = Vec::with_capacity(self.intervals.len() + at_s.len());
        let mut from = Vec::with_capacity(intervals.capacity());
        for (number, interval) in self.intervals.iter().enumerate() {
            let mut rest = *interval;
            let later = at_s.partition_point(|time_s| *time_s <= interval.start_s);
            let within = at_s[later..]
                .iter()
                .take_while(|time_s| **time_s < interval.end_s);
            for &time_s in within {
                if rest.start_s < time_s && time_s < rest.end_s {
                    let share = (time_s - rest.start_s) / (rest.end_s - rest.start_s);
                    let rise_m_s = rest.end_speed_m_s - rest.start_speed_m_s;
                    let speed_m_s = rest.start_speed_m_s + share * rise_m_s;
                    intervals.push(Interval {
                        end_s: time_s,
                        end_speed_m_s: speed_m_s,
                        ..rest
                    });
                    from.push(number);
                    (rest.start_s, rest.start_speed_m_s) = (time_s, speed_m_s);
                }
            }
            intervals.push(rest);
            from.push(number);
        }
        // A cut in a start or a stop may lie below the speed of standstill: the motion stays the same.
        Trace {
            selector_s: self.selector_s,
            tolerance_m_s: self.tolerance_m_s,
            ..Self::as_given(intervals, self.gears.at_intervals(&from))
        }
    }

    /// The same trace with rows where its speed rises through one of `rising` or falls through one of `falling`, m/s.
    #[must_use]
    pub fn cut_at_speeds(&self, rising: &[f64], falling: &[f64]) -> Cow<'_, Self> {
        let mut at_s = Vec::new();
        for interval in self.intervals.iter() {
            let first = at_s.len();
            let (v0, v1) = (interval.start_speed_m_s, interval.end_speed_m_s);
            for speed in if v0 < v1 { rising } else { falling } {
                let share = (speed - v0) / (v1 - v0);
                if LEAST_SHARE < share && share < 1.0 - LEAST_SHARE {
                    at_s.push(interval.start_s + share * (interval.end_s - interval.start_s));
                }
            }
            at_s[first..].sort_by(f64::total_cmp);
        }
        match at_s.is_empty() {
            true => Cow::Borrowed(self),
            false => Cow::Owned(self.cut(&at_s)),
        }
    }

    /// Duration, s.
    pub fn duration_s(&self) -> f64 {
        self.intervals.last().map_or(0.0, |interval| interval.end_s)
    }

    /// Distance, m.
    pub fn distance_m(&self) -> f64 {
        self.intervals.iter().map(Interval::distance_m).sum()
    }

    /// Highest speed, m/s.
    pub fn max_speed_m_s(&self) -> f64 {
        let ends = self
            .intervals
            .iter()
            .flat_map(|interval| [interval.start_speed_m_s, interval.end_speed_m_s]);
        ends.fold(0.0, |highest, speed| larger(speed, highest))
    }

    /// Distance driven in one phase, m, over all the intervals that bear its index; 0 for a phase that does not occur.
    pub fn phase_distance_m(&self, phase: u16) -> f64 {
        self.intervals
            .iter()
            .filter(|interval| interval.phase == phase)
            .map(Interval::distance_m)
            .sum()
    }

    /// The steps of the simulation: each interval is divided into the least number of equal parts that are not longer than
    /// `max_dt_s` (s). A limit that is not a positive number divides nothing.
    pub fn steps(&self, max_dt_s: f64) -> impl Iterator<Item = Step> + '_ {
        let intervals = self.intervals.iter().zip(&*self.motions).enumerate();
        intervals.flat_map(move |(number, (interval, motion))| {
            let parts = interval.parts(max_dt_s);
            let step = move |index| {
                if parts == 1 {
                    interval.whole(number, *motion)
                } else {
                    interval.step(number, index, parts)
                }
            };
            (0..parts).map(step)
        })
    }

    /// Gives every step of [`Trace::steps`] to `take`, in order; two plain loops cost a drive less than the iterator.
    #[physics]
    pub fn for_each_step(&self, max_dt_s: f64, mut take: impl FnMut(Step)) {
        for (number, (interval, motion)) in self.intervals.iter().zip(&*self.motions).enumerate() {
            let parts = interval.parts(max_dt_s);
            for index in 0..parts {
                take(if parts == 1 {
                    interval.whole(number, *motion)
                } else {
                    interval.step(number, index, parts)
                });
            }
        }
    }

    /// How many steps [`Trace::steps`] gives.
    pub fn step_count(&self, max_dt_s: f64) -> usize {
        self.intervals.iter().fold(0, |sum: usize, interval| {
            sum.saturating_add(interval.parts(max_dt_s))
        })
    }
}
