//! Samples of a speed: order, one row a stamp, lost samples.

use std::ops::Range;

use cvtcycle_model::cycle::is_standstill;

/// No road car gains speed faster; one that also loses it as fast is a lost sample, m/s2.
const SPIKE_M_S2: f64 = 4.0;
/// Longest spike, samples and s.
const SPIKE: (usize, f64) = (3, 3.0);
/// A signal that is lost falls from such a speed, m/s, and rises to it, faster, m/s2, and is away for less, s, the length of a gap that is no gap: no car stops
/// and starts again like that.
const LOST: (f64, f64, f64) = (2.0, 4.5, 10.0);
/// Values of a channel that is held, at least.
const HELD: usize = 20;
/// Rows of a recording at least, and the share of its steps that are not longer than so many medians.
const RECORDING: (usize, f64) = (20, 0.9);
const ALIKE: f64 = 3.0;
/// Speeds of one stamp that differ by less have a mean, m/s.
const SAME_M_S: f64 = 1.5;

/// A recording: times that rise, and speeds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Samples {
    pub time_s: Vec<f64>,
    pub speed_m_s: Vec<f64>,
    /// Line of each row.
    pub lines: Vec<u32>,
    /// The first speed of each stamp, where most have the mean of several; else empty.
    pub first_m_s: Vec<f64>,
}

fn mean(list: &[f64]) -> f64 {
    list.iter().sum::<f64>() / list.len() as f64
}

impl Samples {
    pub(super) fn step(&self, k: usize) -> f64 {
        self.time_s[k + 1] - self.time_s[k]
    }

    pub(super) fn accel(&self, k: usize) -> f64 {
        (self.speed_m_s[k + 1] - self.speed_m_s[k]) / self.step(k)
    }

    /// Median step where most steps are alike: the rows are those of a recording, not the corners of a schedule.
    pub(crate) fn raster(&self) -> Option<f64> {
        let steps: Vec<f64> = self
            .time_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        let step = super::smooth::median(steps.clone())?;
        let alike = steps.iter().filter(|own| **own <= ALIKE * step).count();
        (self.time_s.len() >= RECORDING.0 && alike as f64 >= RECORDING.1 * steps.len() as f64)
            .then_some(step)
    }

    /// True if the time falls by some steps each time: by one or two, rows are exchanged.
    pub(super) fn falls_far(&self, falls: &[usize]) -> bool {
        let steps = self.time_s.windows(2).map(|pair| pair[1] - pair[0]);
        let step = super::smooth::median(steps.filter(|step| *step > 0.0).collect());
        let least = 2.5 * step.unwrap_or(0.0);
        let mut all = falls.iter();
        all.all(|k| self.time_s[k - 1] - self.time_s[*k] > least)
    }

    /// True if the speed goes on where the time falls, in the middle of a drive: a clock that was set, and no other drive.
    pub(super) fn is_clock_set(&self, falls: &[usize]) -> bool {
        !falls.is_empty()
            && self.falls_far(falls)
            && falls.iter().all(|k| {
                let [before, after] = [self.speed_m_s[k - 1], self.speed_m_s[*k]];
                !is_standstill(before)
                    && !is_standstill(after)
                    && (after - before).abs() < 2.0 * SPIKE_M_S2
            })
    }

    /// Lets the clock run on by a median step where it falls. Returns by how many seconds it fell in all.
    pub(super) fn run_on(&mut self, falls: &[usize]) -> f64 {
        let rises = self
            .time_s
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .filter(|step| *step > 0.0);
        let step = super::smooth::median(rises.collect()).unwrap_or(1.0);
        let (mut shift, mut back, before) = (0.0, 0.0, self.time_s.clone());
        for k in 1..before.len() {
            if falls.contains(&k) {
                back += before[k - 1] - before[k];
                shift += before[k - 1] - before[k] + step;
            }
            self.time_s[k] = before[k] + shift;
        }
        back
    }

    /// Puts the rows in the order of their times. Returns how many stood behind a later one.
    pub(super) fn sort(&mut self, others: &mut [Vec<f64>]) -> usize {
        let mut order: Vec<usize> = (0..self.time_s.len()).collect();
        let moved = self
            .time_s
            .windows(2)
            .filter(|pair| pair[1] < pair[0])
            .count();
        order.sort_by(|a, b| self.time_s[*a].total_cmp(&self.time_s[*b]));
        let pick = |list: &Vec<f64>| order.iter().map(|k| list[*k]).collect();
        (self.time_s, self.speed_m_s) = (pick(&self.time_s), pick(&self.speed_m_s));
        self.lines = order.iter().map(|k| self.lines[*k]).collect();
        for other in others {
            *other = pick(other);
        }
        moved
    }

    /// Puts one row in place of each group of rows, with the mean of their speeds, the time that `time` makes of theirs, and the first value of each other
    /// channel.
    fn join(
        &mut self,
        groups: &[Range<usize>],
        others: &mut [Vec<f64>],
        time: impl Fn(&[f64]) -> f64,
    ) {
        for (to, own) in groups.iter().enumerate() {
            self.time_s[to] = time(&self.time_s[own.clone()]);
            self.speed_m_s[to] = mean(&self.speed_m_s[own.clone()]);
            self.lines[to] = self.lines[own.start];
            for other in &mut *others {
                let first = other[own.clone()]
                    .iter()
                    .copied()
                    .find(|value| value.is_finite());
                other[to] = first.unwrap_or(f64::NAN);
            }
        }
        self.time_s.truncate(groups.len());
        self.speed_m_s.truncate(groups.len());
        self.lines.truncate(groups.len());
        others
            .iter_mut()
            .for_each(|other| other.truncate(groups.len()));
    }

    /// Rows of one stamp become one with the mean of their speeds. Returns the number of rows that are gone.
    ///
    /// # Errors
    /// One stamp has speeds too different for a mean: the index of its second row.
    pub(super) fn merge(&mut self, others: &mut [Vec<f64>]) -> Result<usize, usize> {
        let n = self.time_s.len();
        let mut groups = Vec::new();
        let mut k = 0;
        while k < n {
            let same = |at: &usize| self.time_s[*at] <= self.time_s[k];
            let end = k + 1 + (k + 1..n).take_while(same).count();
            let own = &self.speed_m_s[k..end];
            let (low, high) = own
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                    (low.min(*v), high.max(*v))
                });
            // Rows of a second may differ by what a car gains in it.
            let next_s = self
                .time_s
                .get(end)
                .map_or(1.0, |next| next - self.time_s[k]);
            if high - low > SAME_M_S + SPIKE_M_S2 * next_s.min(2.0) {
                return Err(k + 1);
            }
            groups.push(k..end);
            k = end;
        }
        // Means over a step take accelerations away; the first speeds, of which none is a mean, are as far to the other side.
        let several = groups.iter().filter(|own| own.len() > 1).count();
        let first = groups.iter().map(|own| self.speed_m_s[own.start]);
        self.first_m_s = match 2 * several > groups.len() {
            true => first.collect(),
            false => Vec::new(),
        };
        self.join(&groups, others, |times| times[0]);
        Ok(n - groups.len())
    }

    /// Replaces rows that repeat the value of the one above by the line between two values, where a channel is written more often than it is measured. Returns
    /// the number of these rows and the time from value to value, s.
    pub(super) fn follow(&mut self) -> Option<(usize, f64)> {
        let n = self.time_s.len();
        let moves =
            |k: usize| !(is_standstill(self.speed_m_s[k]) && is_standstill(self.speed_m_s[k - 1]));
        let new: Vec<usize> = (1..n)
            .filter(|k| moves(*k) && (self.speed_m_s[*k] - self.speed_m_s[k - 1]).abs() > 1e-9)
            .collect();
        let moving = (1..n).filter(|k| moves(*k)).count();
        if new.len() < HELD || 10 * new.len() > 6 * moving {
            return None;
        }
        // Steps of a coarse resolution are repeated, too: there nearly all changes are of one step.
        let mut changes: Vec<f64> = new
            .iter()
            .map(|k| (self.speed_m_s[*k] - self.speed_m_s[k - 1]).abs())
            .collect();
        changes.sort_by(f64::total_cmp);
        let (least, middle) = (changes[changes.len() / 20], changes[changes.len() / 2]);
        let rows: Vec<f64> = new
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) as f64)
            .collect();
        let held = super::smooth::median(rows.clone())?;
        let regular = rows
            .iter()
            .filter(|own| (**own - held).abs() <= 0.5 * held)
            .count();
        if held < 2.0 || middle < 3.0 * least || 10 * regular < 7 * rows.len() {
            return None;
        }
        let held = held as usize;
        let mut kept = vec![true; n];
        let (mut start, mut count) = (0, 0);
        for k in 1..=n {
            if k < n && (self.speed_m_s[k] - self.speed_m_s[start]).abs() <= 1e-9 {
                continue;
            }
            for (own, row) in (start..k).enumerate() {
                let is_value =
                    own % held == 0 && (own == 0 || 2 * (k - row) > held) || row + 1 == n;
                kept[row] = is_value;
                count += usize::from(!is_value);
            }
            start = k;
        }
        let values: Vec<usize> = (0..n).filter(|k| kept[*k]).collect();
        for pair in values.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let slope =
                (self.speed_m_s[to] - self.speed_m_s[from]) / (self.time_s[to] - self.time_s[from]);
            for k in from + 1..to {
                self.speed_m_s[k] =
                    self.speed_m_s[from] + slope * (self.time_s[k] - self.time_s[from]);
            }
        }
        let step = super::smooth::median(
            self.time_s
                .windows(2)
                .map(|pair| pair[1] - pair[0])
                .collect(),
        )?;
        Some((count, held as f64 * step))
    }

    /// Puts the mean of each second in place of its rows, at their mean time; a second with a rest and a drive keeps its mean. Returns the number of rows
    /// before.
    pub(super) fn mean_each_second(&mut self, others: &mut [Vec<f64>]) -> usize {
        let n = self.time_s.len();
        let first_s = self.time_s[0];
        let second = |k: usize| (self.time_s[k] - first_s).floor();
        let mut groups = Vec::new();
        let mut k = 0;
        while k < n {
            let end = (k..n).find(|at| second(*at) > second(k)).unwrap_or(n);
            groups.push(k..end);
            k = end;
        }
        self.join(&groups, others, mean);
        n
    }

    /// Replaces samples against both neighbours by the line between these; returns their indices.
    pub(super) fn spikes(&mut self) -> Vec<(usize, f64)> {
        let n = self.time_s.len();
        let mut found = Vec::new();
        let mut k = 0;
        while k + 2 < n {
            let first = self.accel(k);
            let least = |k: usize| SPIKE_M_S2.max(1.0 / self.step(k).max(0.05));
            let width = (1..=SPIKE.0).find(|width| {
                let end = k + width;
                end + 1 < n
                    && self.time_s[end + 1] - self.time_s[k] <= SPIKE.1 + 1.0
                    && first.abs() > least(k)
                    && self.accel(end).abs() > least(end)
                    && first * self.accel(end) < 0.0
                    // Within it the speed stays: it does not come back by itself.
                    && (k + 1..end).all(|k| self.accel(k).abs() < SPIKE_M_S2)
                    && (self.speed_m_s[end + 1] - self.speed_m_s[k]).abs() < 0.3 * (self.speed_m_s[k + 1] - self.speed_m_s[k]).abs()
            });
            let Some(width) = width.or_else(|| self.lost(k)) else {
                k += 1;
                continue;
            };
            let end = k + width + 1;
            let slope =
                (self.speed_m_s[end] - self.speed_m_s[k]) / (self.time_s[end] - self.time_s[k]);
            for at in k + 1..end {
                found.push((at, self.speed_m_s[at]));
                self.speed_m_s[at] = self.speed_m_s[k] + slope * (self.time_s[at] - self.time_s[k]);
            }
            k = end;
        }
        found
    }

    /// Length of a loss of the signal behind a row: the speed is 0 at once, and as high as before at once.
    fn lost(&self, k: usize) -> Option<usize> {
        let before = self.speed_m_s[k];
        if before < LOST.0 || !is_standstill(self.speed_m_s[k + 1]) || self.accel(k) > -LOST.1 {
            return None;
        }
        let end = (k + 2..self.time_s.len()).find(|at| !is_standstill(self.speed_m_s[*at]))?;
        let is_back =
            self.accel(end - 1) > LOST.1 && (self.speed_m_s[end] - before).abs() < 0.3 * before;
        (is_back && self.time_s[end] - self.time_s[k] <= LOST.2 + self.step(k))
            .then_some(end - 1 - k)
    }
}
