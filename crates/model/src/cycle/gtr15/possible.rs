//! The gears that engine speed and power allow in each second, and the first choice among them (GS-1 to GS-4).

use super::GtrVehicle;
use super::phases::{Change, Phases, REST_KMH};

/// Acceleration below which a car slows down, m/s2.
const SLOWS_M_S2: f64 = -0.1389;
/// Rotating parts over the test mass.
const ROTATING: f64 = 1.03;
/// Share of rated power that bounds the engine speed.
const NEARLY_RATED: f64 = 0.95;
/// Share of full load at the highest car speed.
const AT_TOP: f64 = 0.9;
/// Steps in which the highest car speed is looked for, and how many make a km/h.
const TOP_STEPS: u32 = 5000;
const STEPS_PER_KMH: f64 = 10.0;
/// Rounding of n at a limit, rpm.
const ROUNDING_RPM: f64 = 1e-9;
/// No gear is the least.
pub(super) const NO_GEAR: i32 = 99;
/// A moving car without a possible gear.
const NONE_POSSIBLE: i32 = -9;

/// Limits of engine speed (GS-1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub n95_rpm: f64,
    pub highest_rpm: f64,
    /// Gear of the highest car speed, from 0.
    pub top_gear: usize,
    pub top_kmh: f64,
}

/// Possible gears in each second.
#[derive(Clone, Debug)]
pub(super) struct Possible {
    pub limits: Limits,
    pub gears: usize,
    pub idle_rpm: f64,
    /// Engine speed in second gear, as the car speed has it, rpm.
    pub second_rpm: Vec<f64>,
    /// Least gear, [`NO_GEAR`] for none.
    pub least: Vec<i32>,
    /// Greatest gear, 0 for none.
    pub greatest: Vec<i32>,
    /// First choice (GS-4).
    pub chosen: Vec<i32>,
    /// True if first gear is possible.
    first: Vec<bool>,
    /// True with a clutch open or slipping, by second and gear from first.
    slips: Vec<bool>,
}

/// A rounded speed, as the regulation has it.
fn rounded(x: f64) -> f64 {
    (x + 0.5).floor()
}

/// Linear between points, the ends' values outside.
fn between(points: &[[f64; 3]], x: f64, y: impl Fn(&[f64; 3]) -> f64) -> f64 {
    let k = points.partition_point(|p| p[0] <= x);
    match (k.checked_sub(1).map(|k| &points[k]), points.get(k)) {
        (Some(a), Some(b)) => y(a) + (y(b) - y(a)) / (b[0] - a[0]) * (x - a[0]),
        (Some(end), None) | (None, Some(end)) => y(end),
        (None, None) => 0.0,
    }
}

impl Limits {
    fn new(trace_kmh: &[f64], car: &GtrVehicle) -> Limits {
        let curve = &car.full_load;
        let rated_kw = curve.iter().map(|p| p[1]).fold(0.0, f64::max);
        let nearly = NEARLY_RATED * rated_kw;
        let power = |n: f64| between(curve, n, |p| p[1]);
        let crossing = curve
            .windows(2)
            .rev()
            .find(|pair| (pair[0][1] >= nearly) != (pair[1][1] >= nearly));
        let last_rpm = curve.last().map_or(0.0, |p| p[0]);
        let mut n95_rpm = match (curve.last(), crossing) {
            (Some(last), Some([a, b])) if last[1] < nearly => {
                a[0] + (nearly - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            }
            _ => last_rpm,
        }; // GS-1
        let (mut top_gear, top_kmh) = top(car);
        let limit = car.maker.highest_rpm;
        let has_limit = limit > 0.0;
        if has_limit && limit < n95_rpm && power(limit) > nearly {
            n95_rpm = limit;
        }
        let fastest_kmh = trace_kmh.iter().copied().fold(0.0, f64::max);
        let ndv = car.rpm_per_kmh.get(top_gear).copied().unwrap_or(0.0);
        let mut highest_rpm = ndv * fastest_kmh; // GS-1
        if has_limit {
            highest_rpm = highest_rpm.min(limit);
            if limit < ndv * top_kmh {
                top_gear = car.rpm_per_kmh.len() - 1;
            }
        }
        Limits {
            n95_rpm,
            highest_rpm,
            top_gear,
            top_kmh,
        }
    }
}

/// The gear of the highest car speed, from 0, and that speed in km/h (GS-1).
fn top(car: &GtrVehicle) -> (usize, f64) {
    let curve = &car.full_load;
    let ends = curve
        .first()
        .zip(curve.last())
        .map_or((0.0, 0.0), |(a, b)| (a[0], b[0]));
    let best = |ndv: f64| {
        // Above the last speed of the engine the power is none.
        let drives = |step: u32| {
            let v = f64::from(step) / STEPS_PER_KMH;
            let n = v * ndv;
            let load_kw =
                (car.load[0] * v + car.load[1] * v * v + car.load[2] * v * v * v) / 3600.0;
            (ends.0..=ends.1).contains(&n) && load_kw < AT_TOP * between(curve, n, |p| p[1])
        };
        let from = (ends.1 / ndv * STEPS_PER_KMH)
            .ceil()
            .clamp(1.0, f64::from(TOP_STEPS - 1));
        let mut steps = (1..=from as u32).rev();
        steps
            .find(|step| drives(*step) != drives(*step + 1))
            .map(|step| f64::from(step) / STEPS_PER_KMH)
    };
    let bests: Vec<Option<f64>> = car.rpm_per_kmh.iter().map(|ndv| best(*ndv)).collect();
    let is_top = |g: &usize| match (bests[*g], bests[*g - 1]) {
        (Some(own), Some(below)) => own >= below,
        _ => false,
    };
    let found = (1..bests.len()).rev().find(is_top);
    let gear = found.unwrap_or(bests.len().saturating_sub(1));
    (gear, bests.get(gear).copied().flatten().unwrap_or(0.0))
}

/// The car and its trace while the gears of a second are found.
struct Second<'a> {
    car: &'a GtrVehicle,
    limits: Limits,
    rated_rpm: f64,
}

impl Second<'_> {
    /// Least engine speed in a gear, from 0 (GS-2).
    fn least_rpm(&self, t: usize, gear: usize, accel_m_s2: f64, stops: bool) -> f64 {
        let (idle, maker) = (self.car.idle_rpm, &self.car.maker);
        let speeds_up = accel_m_s2 >= SLOWS_M_S2;
        let of_maker = |up: f64, down: f64| if speeds_up { up } else { down };
        match gear {
            0 => rounded(idle),
            1 if stops => rounded(idle),
            1 => rounded(0.9 * idle),
            _ => {
                let drive = idle + 0.125 * (self.rated_rpm - idle);
                let mut least = rounded(drive.max(maker.least_rpm[0]));
                least = least.max(of_maker(maker.least_rpm[1], maker.least_rpm[2]));
                if maker.start_s > 0.0 && t as f64 <= maker.start_s {
                    least = least.max(of_maker(maker.start_rpm[0], maker.start_rpm[1]));
                }
                least
            }
        } // GS-2
    }

    /// The engine's speed while the clutch keeps it from falling, and whether it has to (GS-2).
    fn held_rpm(&self, n: f64, gear: usize, change: Change) -> (f64, bool) {
        let idle = self.car.idle_rpm;
        let lowest = self.car.full_load.first().map_or(0.0, |p| p[0]);
        let (held, slips) = match change {
            Change::Rest => (idle, false),
            Change::Fall if n < idle => (idle, true),
            Change::Rise | Change::Constant if n < (1.15 * idle).max(lowest) => {
                ((1.15 * idle).max(n), true)
            }
            _ => (n, false),
        };
        (if gear == 1 { held.max(idle) } else { held }, slips) // GS-2
    }

    /// Power that is available at an engine speed, kW (GS-3).
    fn available_kw(&self, n: f64, gear: usize) -> f64 {
        let curve = &self.car.full_load;
        let y = |p: &[f64; 3]| p[1] * (1.0 - (self.car.safety + p[2]));
        let on =
            |a: &[f64; 3], b: &[f64; 3], x: f64| y(a) + (y(b) - y(a)) / (b[0] - a[0]) * (x - a[0]);
        match curve.as_slice() {
            [a, b, ..] if gear >= 2 && n < a[0] => on(a, b, n),
            [.., a, b] if gear >= 2 && n > b[0] => {
                y(b) + (y(b) - y(a)) / (b[0] - a[0]) * (n - b[0])
            }
            [.., b] if gear < 2 && n > b[0] => f64::NEG_INFINITY,
            _ => between(curve, n, y),
        } // GS-3
    }
}

impl Possible {
    pub(super) fn new(trace_kmh: &[f64], car: &GtrVehicle, phases: &Phases) -> Possible {
        let gears = car.rpm_per_kmh.len();
        let rated = car
            .full_load
            .iter()
            .fold([0.0; 3], |best, p| if p[1] > best[1] { *p } else { best });
        let at = Second {
            car,
            limits: Limits::new(trace_kmh, car),
            rated_rpm: rated[0],
        };
        let second = car.rpm_per_kmh.get(1).copied().unwrap_or(f64::INFINITY);
        let mut all = Possible {
            limits: at.limits,
            gears,
            idle_rpm: car.idle_rpm,
            second_rpm: trace_kmh.iter().map(|v| v * second).collect(),
            least: Vec::with_capacity(trace_kmh.len()),
            greatest: Vec::with_capacity(trace_kmh.len()),
            chosen: Vec::with_capacity(trace_kmh.len()),
            first: Vec::with_capacity(trace_kmh.len()),
            slips: Vec::with_capacity(trace_kmh.len() * gears),
        };
        for t in 0..trace_kmh.len() {
            all.add_second(t, trace_kmh, &at, phases);
        }
        all.engage_before_starts(trace_kmh, phases);
        all.first_until_second(phases);
        all
    }

    /// The gears of a second (GS-3), and the highest of them (GS-4).
    fn add_second(&mut self, t: usize, trace_kmh: &[f64], at: &Second<'_>, phases: &Phases) {
        let (car, v) = (at.car, trace_kmh[t]);
        let next = trace_kmh.get(t + 1).copied().unwrap_or(v);
        let accel_m_s2 = (next - v) / 3.6;
        let load = car.load[0] * v + car.load[1] * v * v + car.load[2] * v * v * v;
        let required_kw = load / 3600.0 + ROTATING * accel_m_s2 * v * car.test_mass_kg / 3600.0;
        let at_rest = v < REST_KMH;
        let mut most: Option<(f64, usize)> = None;
        let mut list = [(false, false); MAX_GEARS];
        for (gear, ndv) in car.rpm_per_kmh.iter().enumerate().take(MAX_GEARS) {
            let n = v * ndv;
            let least = at.least_rpm(t, gear, accel_m_s2, phases.stops[t]);
            let limit = if gear < at.limits.top_gear {
                at.limits.n95_rpm
            } else {
                at.limits.highest_rpm
            };
            let is_possible =
                !at_rest && ((least..=limit + ROUNDING_RPM).contains(&n) || gear == 0 && n < least);
            let (held, slips) = at.held_rpm(n, gear, phases.change[t]);
            self.slips.push(slips);
            if !is_possible {
                continue;
            }
            let available = at.available_kw(held, gear);
            list[gear] = (true, gear < 2 || available >= required_kw);
            if most.is_none_or(|(kw, _)| available >= kw) {
                most = Some((available, gear));
            }
        }
        if let Some((_, gear)) = most {
            list[gear].1 = true; // GS-3
        }
        let is_allowed = |gear: &usize| list[*gear] == (true, true);
        let mut allowed = (0..self.gears.min(MAX_GEARS)).filter(is_allowed);
        let least = allowed.next();
        let greatest = allowed.next_back().or(least);
        let gear = |found: Option<usize>, none: i32| found.map_or(none, |gear| gear as i32 + 1);
        self.first.push(least == Some(0));
        self.least
            .push(if at_rest { 0 } else { gear(least, NO_GEAR) });
        self.greatest.push(gear(greatest, 0));
        self.chosen
            .push(gear(greatest, if at_rest { 0 } else { NONE_POSSIBLE })); // GS-4
    }

    /// First gear a second before each start (GS-4).
    fn engage_before_starts(&mut self, trace_kmh: &[f64], phases: &Phases) {
        for run in phases.accelerations().filter(|run| run.at_rest) {
            let mut before = run.first - 1;
            while before >= 2 && trace_kmh[before + 1] > trace_kmh[before] {
                before -= 1;
            }
            self.chosen[before..run.first].fill(1);
            self.least[before..run.first].fill(1); // GS-4
        }
    }

    /// First gear until second is chosen, and second only from 1.15 idle after first (GS-4).
    fn first_until_second(&mut self, phases: &Phases) {
        for run in phases.accelerations().filter(|run| run.at_rest) {
            self.chosen[run.first] = 1;
            let second = (run.first..=run.last).find(|t| self.chosen[*t] == 2);
            if let Some(second) = second {
                self.chosen[run.first..second].fill(1);
            }
        }
        let least = rounded(1.15 * self.idle_rpm);
        let mut from_first = false;
        for t in 0..self.chosen.len() {
            match self.chosen[t] {
                1 => from_first = true,
                2 if from_first && self.second_rpm[t] < least && self.first[t] => {
                    self.chosen[t] = 1
                }
                _ => from_first = false,
            }
        } // GS-4
    }

    /// True if the clutch is open or slips in a gear (GS-2).
    pub(super) fn slips(&self, t: usize, gear: i32) -> bool {
        (1..=self.gears as i32).contains(&gear) && self.slips[t * self.gears + gear as usize - 1]
    }

    /// The clutch is closed in a gear after all.
    pub(super) fn closes(&mut self, t: usize, gear: i32) {
        if (1..=self.gears as i32).contains(&gear) {
            self.slips[t * self.gears + gear as usize - 1] = false;
        }
    }
}

/// No manual box has more gears.
const MAX_GEARS: usize = 10;
