//! Faults of recordings that have one remedy: each has a name, is counted, and can be switched off.

use super::samples::Samples;
use super::smooth::{Resolution, smoothed};
use crate::channel::Repairs;
use crate::{Problem, Setting, readable};
use cvtcycle_model::cycle::{Repair, is_standstill};

/// Speed above which a car is moving, m/s.
const MOVING_M_S: f64 = 0.5;
/// Speeds down to here are those of a sensor at rest, m/s (1 km/h).
const MIN_SPEED_M_S: f64 = -1.0 / 3.6;
/// A step of a recording is a gap from here on, s, and in steps.
const GAP: (f64, f64) = (10.0, 10.0);
/// Tyres cannot do more, m/s2.
const JUMP_M_S2: f64 = 12.0;
/// Steps of a fast raster, s, in which speeds may change by this beyond it, m/s.
const FAST_S: f64 = 0.2;
const FAST_M_S: f64 = 0.5;
/// Most gaps and jumps that are bridged, and one of so many rows.
const CUTS: usize = 5;
const CUTS_PER_ROW: usize = 200;
/// Acceleration with which a cut is bridged, as in a cycle over distance (CY-1), m/s2: up and down.
const BRIDGE_M_S2: [f64; 2] = [1.0, 1.5];
/// A gap at rest from which on two drives are likelier than one, s.
const REST_S: f64 = 120.0;
/// Step from which on a drive is not known by its rows, s.
const SLOW_RATE_S: f64 = 2.5;
/// Half width by which fuel and difference are open besides what the strength of the smoothing leaves: per cent, and points. Twice the rms error of UDDS, HWFET,
/// US06, NYCC and Artemis urban, rounded to whole km/h and mph at 10, 4, 2 and 1 Hz or with 0.05 m/s of noise, and smoothed.
const LEFT: [f64; 2] = [1.0, 0.5];
/// Least error of a recorded speed, m/s. ASSUMED: half of a whole km/h, in which cars say their speed; a tyre's wear changes 100 km/h by more.
const ACCURACY_M_S: f64 = 0.5 / 3.6;
/// Error of a speed up to which this holds, m/s: that of whole km/h.
const FINE_M_S: f64 = 0.1;

/// A repair that was made.
pub(super) fn made(name: &'static str, count: usize, what: String) -> Repair {
    Repair {
        name: name.to_owned(),
        count,
        what,
    }
}

/// A recording after its repairs.
#[derive(Debug)]
pub(crate) struct Treated {
    pub samples: Samples,
    /// The same with other strengths of smoothing.
    pub bounds: Vec<Vec<f64>>,
    pub resolution: Option<Resolution>,
    pub repairs: Vec<Repair>,
    pub doubts: Vec<String>,
    /// True where most steps are alike.
    pub is_recording: bool,
    /// Half width by which fuel (per cent) and difference (points) are open beyond the bounds (LG-6); none where nothing is.
    pub left: Option<[f64; 2]>,
}

fn kmh(speed_m_s: f64) -> String {
    readable(3.6 * speed_m_s, 1)
}

/// A recording, what was done to it so far, and what was found.
struct Treatment<'p> {
    samples: Samples,
    wanted: Repairs,
    place: &'p dyn Fn(u32) -> Problem,
    repairs: Vec<Repair>,
    problems: Vec<Problem>,
    doubts: Vec<String>,
    bounds: Vec<Vec<f64>>,
}

/// Repairs a recording, or says what cannot be repaired. `is_exact`: the speeds are those of a shipped cycle, which are driven as they are.
pub(crate) fn treat(
    samples: Samples,
    wanted: Repairs,
    is_exact: bool,
    place: &dyn Fn(u32) -> Problem,
) -> Result<Treated, Vec<Problem>> {
    let raster = samples.raster();
    let mut own = Treatment {
        samples,
        wanted,
        place,
        repairs: Vec::new(),
        problems: Vec::new(),
        doubts: Vec::new(),
        bounds: Vec::new(),
    };
    if !is_exact && raster.is_some() {
        own.spikes();
    }
    own.limits();
    let mut resolution = None;
    // The rows between those of a shipped cycle may be held, too.
    if raster.is_some() {
        own.held();
    }
    if !is_exact {
        if raster.is_some() {
            resolution = Resolution::of(&own.samples.time_s, &own.samples.speed_m_s);
        }
        own.gaps(raster, resolution);
        if let Some(coarse) = resolution.filter(Resolution::is_coarse) {
            own.smooth(coarse);
        }
    }
    if own.samples.first_m_s.len() == own.samples.time_s.len() {
        own.bounds.push(own.first(resolution));
    }
    let mut left = left(raster, resolution, own.bounds.is_empty());
    if !is_exact && raster.is_some() {
        own.moved(resolution);
        // Noise below LG-4 and LG-2 is not seen, and moves the fuel by up to 1 %.
        left = left.or(Some(LEFT));
    }
    if let Some(step) = raster.filter(|step| *step > SLOW_RATE_S && !is_exact) {
        own.doubts.push(format!(
            "the rows are {} s apart: accelerations between them are not in the log",
            readable(step, 1)
        ));
    }
    match own.problems.is_empty() {
        true => Ok(Treated {
            samples: own.samples,
            bounds: own.bounds,
            resolution,
            repairs: own.repairs,
            doubts: own.doubts,
            is_recording: raster.is_some(),
            left,
        }),
        false => Err(own.problems),
    }
}

/// Openness beyond the bounds (LG-6): in proportion to an error above that of whole miles an hour, and to a step above a second.
fn left(raster: Option<f64>, resolution: Option<Resolution>, is_alone: bool) -> Option<[f64; 2]> {
    let slow = raster.filter(|step| *step >= 2.0);
    if is_alone && slow.is_none() {
        return None;
    }
    let of_error = resolution.map_or(1.0, |own| (own.error_m_s / FINE_M_S).max(1.0));
    let [fuel, points] = slow.map_or([0.0, 0.0], |step| [step, 0.2 * step]);
    Some([
        (LEFT[0] * of_error).max(fuel),
        (LEFT[1] * of_error).max(points),
    ])
}

impl Treatment<'_> {
    /// The speeds of the moving car lower and higher by what a recording leaves open (LG-6): a plateau may lie on a speed of a shift.
    fn moved(&mut self, resolution: Option<Resolution>) {
        let error_m_s = resolution.map_or(0.0, |own| own.error_m_s);
        let by_m_s = (2.0 * error_m_s).max(ACCURACY_M_S);
        for by in [-by_m_s, by_m_s] {
            let own = |speed: &f64| match is_standstill(*speed) {
                true => *speed,
                false => (speed + by).max(0.0),
            };
            let moved = self.samples.speed_m_s.iter().map(own).collect();
            self.bounds.push(moved);
        }
    }

    /// The first speeds of the stamps in place of their means, repaired like these.
    fn first(&self, resolution: Option<Resolution>) -> Vec<f64> {
        let Samples {
            time_s,
            speed_m_s,
            first_m_s,
            ..
        } = &self.samples;
        let coarse = resolution.filter(|own| self.wanted.smooth && own.is_coarse());
        let first = match coarse {
            Some(coarse) => smoothed(time_s, first_m_s, coarse.error_m_s, 1.0),
            None => first_m_s.clone(),
        };
        // Where a mean was repaired the repaired one holds.
        let near = |(own, mean): (f64, &f64)| match (own - mean).abs() < JUMP_M_S2 {
            true if !is_standstill(*mean) => own.max(0.0),
            _ => *mean,
        };
        first.into_iter().zip(speed_m_s).map(near).collect()
    }

    /// Values that are repeated until the next one is measured.
    fn held(&mut self) {
        let mut mended = self.samples.clone();
        let Some((rows, period_s)) = mended.follow() else {
            return;
        };
        let text = format!(
            "{} repeat a value that is measured each {} s",
            number_of(rows, "row"),
            readable(period_s, 2)
        );
        match self.wanted.held {
            true => {
                self.samples = mended;
                let what = format!("{text}, replaced by the line between the values");
                self.repairs.push(made("held", rows, what));
            }
            false => self.doubts.push(format!("{text}: the speed has steps")),
        }
    }

    /// A problem of a row.
    fn problem(&mut self, line: u32, problem: Problem) {
        let Problem { place, .. } = (self.place)(line);
        let key = "speed".to_owned();
        self.problems.push(Problem {
            place,
            key,
            ..problem
        });
    }

    /// Rows whose speeds are out of a range.
    fn rows(&self, is_out: impl Fn(f64) -> bool) -> Vec<usize> {
        let speeds = self.samples.speed_m_s.iter().enumerate();
        speeds
            .filter(|(_, speed)| is_out(**speed))
            .map(|(k, _)| k)
            .collect()
    }

    /// Speeds below 0 and above what cars drive; noise of a car at rest becomes 0.
    fn limits(&mut self) {
        let negative = self.rows(|speed| speed < 0.0);
        let speeds = negative.iter().map(|k| self.samples.speed_m_s[*k]);
        let worst = speeds.fold(0.0, f64::min);
        let count = negative.len();
        match negative.first() {
            None => {}
            Some(_) if worst >= MIN_SPEED_M_S && self.wanted.negative => {
                for k in negative {
                    self.samples.speed_m_s[k] = 0.0;
                }
                let speeds = number_of(count, "small negative speed");
                let what = format!("{speeds} of a sensor at rest set to 0");
                self.repairs.push(made("negative", count, what));
            }
            Some(first) => {
                let speeds = number_of(count, "speed");
                let message = format!("{speeds} below 0, down to {} km/h", kmh(worst));
                let problem = Problem::out_of_range(message)
                    .allowed("0 to 300 km/h")
                    .hint("reversing cannot be driven: is a sign of the direction in the column?");
                self.problem(self.samples.lines[*first], problem);
            }
        }
        for speed in self.samples.speed_m_s.iter_mut() {
            *speed = match is_standstill(*speed) {
                true => speed.min(0.0),
                false => *speed,
            };
        }
        let fast = self.rows(|speed| 3.6 * speed > 300.0);
        if let Some(first) = fast.first().copied() {
            let (speeds, first_kmh) = (
                number_of(fast.len(), "speed"),
                kmh(self.samples.speed_m_s[first]),
            );
            let message = format!("{speeds} above 300 km/h, the first {first_kmh} km/h");
            let problem = Problem::out_of_range(message).allowed("0 to 300 km/h");
            let problem = problem.hint("is the column in another unit?");
            self.problem(self.samples.lines[first], problem);
        }
    }

    /// Samples against both neighbours.
    fn spikes(&mut self) {
        let mut mended = self.samples.clone();
        let spikes = mended.spikes();
        let Some((first, speed)) = spikes.first().copied() else {
            return;
        };
        let (line, times) = (self.samples.lines[first], &self.samples.time_s);
        let text = format!(
            "{} against both neighbours, the first {} km/h at {} s (line {line})",
            number_of(spikes.len(), "sample"),
            kmh(speed),
            readable(times[first] - times[0], 2)
        );
        if self.wanted.spikes {
            self.samples = mended;
            let what = format!("{text}, replaced by the line between these");
            self.repairs.push(made("spikes", spikes.len(), what));
            return;
        }
        let problem = Problem::out_of_range(text)
            .allowed("speeds that a car can drive")
            .hint("let the repair `spikes` replace them")
            .repair("spikes")
            .settings(&[Setting::Repair]);
        self.problem(line, problem);
    }

    /// Smooths speeds that are coarse for their rate, or doubts them.
    fn smooth(&mut self, coarse: Resolution) {
        let steps = match coarse.is_rounded() {
            true => format!(
                "speeds in steps of {} km/h",
                readable(3.6 * coarse.speed_m_s, 3)
            ),
            false => format!(
                "speeds with a noise of {} km/h",
                readable(3.6 * coarse.error_m_s, 2)
            ),
        };
        let error_m_s2 = std::f64::consts::SQRT_2 * coarse.error_m_s / coarse.step_s;
        let words = format!(
            "{steps} at {} Hz, accelerations to {} m/s2",
            readable(1.0 / coarse.step_s, 1),
            readable(error_m_s2, 2)
        );
        if !self.wanted.smooth {
            self.doubts.push(format!(
                "{words}; the differences of the speeds are noise, and the fuel is that of the noise"
            ));
            return;
        }
        let Samples {
            time_s, speed_m_s, ..
        } = &self.samples;
        let with = |factor| smoothed(time_s, speed_m_s, coarse.error_m_s, factor);
        self.bounds = vec![with(0.25), with(4.0)];
        self.samples.speed_m_s = with(1.0);
        let what = format!("{words}; smoothed (LG-3)");
        let count = self.samples.time_s.len();
        self.repairs.push(made("smooth", count, what));
    }

    /// Gaps at rest that are longer than a stop: doubted, or taken out with the other gaps.
    fn rests(&mut self, raster: f64) -> Vec<usize> {
        let samples = &self.samples;
        let is_long = |k: &usize| {
            samples.step(*k) > REST_S.max(GAP.1 * raster)
                && samples.speed_m_s[*k].max(samples.speed_m_s[k + 1]) <= MOVING_M_S
        };
        let rests: Vec<usize> = (0..samples.time_s.len() - 1).filter(is_long).collect();
        let seconds: f64 = rests.iter().map(|k| samples.step(*k)).sum();
        if let Some(first) = rests.first().filter(|_| !self.wanted.cut) {
            self.doubts.push(format!(
                "{} at rest without rows, {} s in all, the first at {} s, with the engine at idle: are these drives of their own? the repair `cut` takes the time out",
                number_of(rests.len(), "gap"),
                readable(seconds, 0),
                readable(samples.time_s[*first] - samples.time_s[0], 0)
            ));
        }
        rests
    }

    /// Gaps while the car moves, and jumps that no car drives beyond what the resolution explains: refused, or bridged.
    fn gaps(&mut self, raster: Option<f64>, resolution: Option<Resolution>) {
        let rests = raster.map_or_else(Vec::new, |step| self.rests(step));
        let samples = &self.samples;
        let noise = resolution.map_or(0.0, |own| 3.0 * own.speed_m_s.max(2.0 * own.error_m_s));
        // Sensors of fast rasters are not as fine as their steps.
        let noise = match raster {
            Some(step) if step < FAST_S => noise.max(FAST_M_S),
            _ => noise,
        };
        let is_gap = |k: &usize| {
            let moving = samples.speed_m_s[*k].max(samples.speed_m_s[k + 1]) > MOVING_M_S;
            let least = raster.map_or(f64::INFINITY, |step| GAP.0.max(GAP.1 * step));
            moving && samples.step(*k) > least
        };
        let is_jump = |k: &usize| {
            let change = (samples.speed_m_s[k + 1] - samples.speed_m_s[*k]).abs();
            change > JUMP_M_S2 * samples.step(*k) + noise
        };
        let last = samples.time_s.len() - 1;
        let gaps: Vec<usize> = (0..last).filter(is_gap).collect();
        let jumps: Vec<usize> = (0..last).filter(is_jump).collect();
        if gaps.is_empty() && jumps.is_empty() {
            if self.wanted.cut && !rests.is_empty() {
                self.samples.bridge(&rests, raster.unwrap_or(0.0));
                let what = format!("{} at rest taken out", number_of(rests.len(), "gap"));
                self.repairs.push(made("cut", rests.len(), what));
            }
            return;
        }
        let text = samples.in_words(&gaps, &jumps);
        let few = CUTS.max(samples.time_s.len() / CUTS_PER_ROW);
        if self.wanted.cut && raster.is_some() && gaps.len() + jumps.len() <= few {
            let both: Vec<usize> = gaps.iter().chain(&jumps).chain(&rests).copied().collect();
            let metres = self.samples.bridge(&both, raster.unwrap_or(0.0));
            let what = format!(
                "{text}; bridged at 1.0 and 1.5 m/s2 over {} m",
                readable(metres, 0)
            );
            self.repairs.push(made("cut", both.len(), what));
            return;
        }
        let first = gaps.first().into_iter().chain(&jumps).min().copied();
        let line = samples.lines[first.unwrap_or_default() + 1];
        let from_rest = jumps
            .first()
            .is_some_and(|k| is_standstill(samples.speed_m_s[*k]));
        let hint = match (gaps.is_empty(), raster) {
            (false, _) => "fill the gap with rows, or let the repair `cut` take its time out",
            (true, _) if from_rest && jumps.len() == 1 => {
                "for times at full throttle see `cvtcycle accelerate`; else: is the time in seconds, are samples lost?"
            }
            (true, Some(_)) if jumps.len() <= few => {
                "is the speed in the unit that is stated? where samples are lost, let the repair `cut` bridge the jump"
            }
            (true, _) => {
                "is the speed in the unit that is stated? is the time in seconds? are samples lost?"
            }
        };
        let allowed = match raster {
            Some(step) if !gaps.is_empty() => format!(
                "up to {} s from row to row while the car moves",
                readable(GAP.0.max(GAP.1 * step), 1)
            ),
            _ => "-12 to 12 m/s2".to_owned(),
        };
        let settings: &[Setting] = match hint.contains("repair") {
            true => &[Setting::Repair],
            false => &[],
        };
        let problem = Problem::conflict(text).allowed(allowed).hint(hint);
        let problem = match settings.is_empty() || gaps.len() + jumps.len() > few {
            true => problem,
            false => problem.repair("cut"),
        };
        self.problem(line, problem.settings(settings));
    }
}

impl Samples {
    /// Gaps and jumps in words.
    fn in_words(&self, gaps: &[usize], jumps: &[usize]) -> String {
        let mut texts = Vec::new();
        if let Some(first) = gaps.first().copied() {
            let gap_s: f64 = gaps.iter().map(|k| self.step(*k)).sum();
            texts.push(format!(
                "{} while the car moves, {} s in all: the first of {} s from {} km/h to {} km/h",
                number_of(gaps.len(), "gap"),
                readable(gap_s, 1),
                readable(self.step(first), 1),
                kmh(self.speed_m_s[first]),
                kmh(self.speed_m_s[first + 1])
            ));
        }
        if let Some(first) = jumps.first().copied() {
            texts.push(format!(
                "the speed jumps{}: {} m/s2 from the row above, {} to {} km/h",
                match jumps.len() {
                    1 => String::new(),
                    n => format!(" {n} times, first here"),
                },
                readable(self.accel(first), 1),
                kmh(self.speed_m_s[first]),
                kmh(self.speed_m_s[first + 1])
            ));
        }
        texts.join("; ")
    }

    /// Puts a ramp in place of these steps. Returns the metres that it adds.
    fn bridge(&mut self, steps: &[usize], least_s: f64) -> f64 {
        let (mut shift, mut metres, before) = (0.0, 0.0, self.time_s.clone());
        for k in 0..before.len() - 1 {
            if steps.contains(&k) {
                let [from, to] = [self.speed_m_s[k], self.speed_m_s[k + 1]];
                let up_s = (to - from) / BRIDGE_M_S2[0];
                let bridge_s = up_s.max((from - to) / BRIDGE_M_S2[1]).max(least_s);
                metres += 0.5 * (from + to) * bridge_s;
                shift += before[k + 1] - before[k] - bridge_s;
            }
            self.time_s[k + 1] = before[k + 1] - shift;
        }
        metres
    }
}

/// `1 sample`, `3 samples`.
pub(super) fn number_of(count: usize, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}
