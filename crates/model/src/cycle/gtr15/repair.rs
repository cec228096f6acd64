//! Corrections of the first choice for driving (GS-5): accelerations, excursions, and no rise while the car slows down.

use super::phases::{Change, Phases, REST_KMH, Run};
use super::possible::{NO_GEAR, Possible};

/// Seconds in which a gear has to be used twice to count.
const WINDOW: usize = 10;
/// Seconds after a dip that are all in a higher gear.
const AFTER_DIP: usize = 6;
/// An excursion of no more seconds is taken back.
const EXCURSION: usize = 4;
/// A constant phase of so many seconds may be entered two gears higher.
const LONG_HOLD: usize = 6;
/// Rounds after which a fixed point is surely there.
const MAX_ROUNDS: usize = 5000;

/// The gears while they are corrected.
#[derive(Clone, Debug)]
pub(super) struct Schedule<'a> {
    pub trace_kmh: &'a [f64],
    pub possible: Possible,
    pub phases: &'a Phases,
    /// Gear of each second, 0 for none, below 0 where none is possible.
    pub gear: Vec<i32>,
    /// True with the clutch open.
    pub clutch: Vec<bool>,
    /// Seconds of decelerations that were held down once.
    held_down: Vec<bool>,
    /// Seconds with a lower gear than before and after.
    dips: Vec<bool>,
    /// Seconds before an acceleration that begins two gears lower.
    drops: Vec<bool>,
}

impl<'a> Schedule<'a> {
    pub(super) fn new(trace_kmh: &'a [f64], possible: Possible, phases: &'a Phases) -> Self {
        let none = vec![false; trace_kmh.len()];
        Schedule {
            trace_kmh,
            gear: possible.chosen.clone(),
            possible,
            phases,
            clutch: none.clone(),
            held_down: none.clone(),
            dips: none.clone(),
            drops: none,
        }
    }

    fn len(&self) -> usize {
        self.gear.len()
    }

    /// One round of the corrections that choose gears.
    pub(super) fn repair(&mut self) {
        self.dips.fill(false);
        self.drops.fill(false);
        for run in self.phases.accelerations() {
            self.accelerate(run);
        }
        for _ in 0..MAX_ROUNDS {
            let before = self.gear.clone();
            self.drop_peaks();
            self.hold_two_seconds(true);
            self.hold_two_seconds(false);
            self.step_by_step();
            if self.gear == before {
                break;
            }
        }
        self.fill_dips();
        for _ in 0..2 {
            self.take_back_excursions();
        }
        for run in self.phases.decelerations() {
            self.slow_down(run);
        }
        self.open_at_drops();
    }

    /// In an acceleration no gear is higher than what its rest needs, and none counts that is used once only (GS-5).
    fn accelerate(&mut self, run: &Run) {
        let highest = self.possible.gears as i32;
        let before = run.first.checked_sub(1).map(|t| self.gear[t]);
        let own = &mut self.gear[run.first..=run.last];
        let mut later = NO_GEAR;
        for gear in own.iter_mut().rev() {
            if *gear > 1 {
                later = later.min(*gear);
            }
            if *gear > 0 {
                *gear = (*gear).min((later + 1).min(highest));
            }
        } // GS-5
        let is_used = |q: usize| {
            let window = &own[(q + 1).saturating_sub(WINDOW)..=q];
            own[q] > 1 && window.iter().filter(|gear| **gear == own[q]).count() >= 2
        };
        let used: Vec<bool> = (0..own.len()).map(is_used).collect();
        let mut later = NO_GEAR;
        for (gear, is_used) in own.iter_mut().zip(used).rev() {
            if is_used {
                later = later.min(*gear);
            }
            if *gear > 0 {
                *gear = (*gear).min(later);
            }
        } // GS-5
        for q in 0..own.len() {
            let last = if q == 0 {
                before.unwrap_or(own[0])
            } else {
                own[q - 1]
            };
            let next = own.get(q + 1).copied().unwrap_or(own[q]);
            if own[q] > 1 && last > own[q] && own[q] < next {
                self.dips[run.first + q] = true;
            }
        }
        if before.is_some_and(|before| own[0] - before < -1) {
            self.drops[run.first - 1] = true;
        }
    }

    /// A gear that is higher for one second only falls by one.
    fn drop_peaks(&mut self) {
        let old = self.gear.clone();
        for t in 1..self.len().saturating_sub(1) {
            let steps = (old[t] - old[t - 1], old[t + 1] - old[t]);
            let is_peak = matches!(steps, (1, -1 | -2) | (2, -1));
            let lower = self.gear[t] - 1;
            if is_peak && lower >= self.possible.least[t] && lower >= 1 {
                self.gear[t] = lower; // GS-5
            }
        }
    }

    /// A gear that is newly taken is held for another second, where the next one is higher, or else lower.
    fn hold_two_seconds(&mut self, next_is_higher: bool) {
        let (gear, least) = (&self.gear, &self.possible.least);
        let (rises, holds) = (&self.phases.rises, &self.phases.holds);
        let is_new = |t: usize| {
            let starts = rises[t] && !rises[t - 1];
            let holds_on = if next_is_higher {
                gear[t] < gear[t + 1] && gear[t] >= least[t + 1]
            } else {
                gear[t] > gear[t + 1] && gear[t + 1] >= least[t]
            };
            let is_taken = gear[t] > gear[t - 1] || gear[t] == gear[t - 1] && starts;
            (rises[t] || holds[t]) && gear[t] >= 0 && is_taken && holds_on
        };
        let count = self.len();
        let mut new = vec![false; count];
        for (t, new) in new
            .iter_mut()
            .enumerate()
            .take(count.saturating_sub(1))
            .skip(1)
        {
            *new = is_new(t);
        }
        let comes_up = |t: usize| t < 2 || gear[t - 1] >= gear[t - 2];
        // For a higher one the first of neighbours counts, for a lower one the first of those that are left.
        let counted: Vec<bool> = (0..count)
            .map(|t| new[t] && (next_is_higher || comes_up(t)))
            .collect();
        let chosen = |t: &usize| counted[*t] && !(*t > 0 && counted[*t - 1]) && comes_up(*t);
        let chosen: Vec<usize> = (0..count).filter(chosen).collect();
        let held: Vec<(usize, i32)> = chosen.iter().map(|t| (t + 1, gear[*t])).collect();
        for (t, gear) in held {
            self.gear[t] = gear; // GS-5
        }
    }

    /// No gear is skipped on the way up, and none is taken in the first two seconds of a rise.
    fn step_by_step(&mut self) {
        let old = self.gear.clone();
        let is_rise = |t: usize| self.phases.change[t] == Change::Rise;
        let may_fall = |t: usize, old: &[i32]| old[t] > self.possible.least[t];
        for t in 2..self.len() {
            let begins = !is_rise(t - 2) && is_rise(t - 1) && is_rise(t);
            let is_one_up = old[t - 2] >= old[t - 1] && old[t - 1] + 1 == old[t];
            if begins && is_one_up && may_fall(t, &old) && !self.dips[t - 1] {
                self.gear[t] -= 1; // GS-5
            }
        }
        let old = self.gear.clone();
        for t in 1..self.len() {
            let skips = old[t - 1] > 0 && self.phases.rises[t] && old[t] - old[t - 1] > 1;
            if skips && may_fall(t, &old) && !self.dips[t - 1] {
                self.gear[t] -= 1; // GS-5
            }
        }
        let old = self.gear.clone();
        let holds = &self.phases.holds;
        for t in 1..self.len() {
            let enters = old[t - 1] > 0 && self.phases.rises[t - 1] && holds[t];
            let is_long = holds
                .get(t..t + LONG_HOLD)
                .is_some_and(|long| long.iter().all(|is| *is));
            let most = if is_long { 2 } else { 1 };
            if enters && may_fall(t, &old) && old[t] - old[t - 1] > most {
                self.gear[t] -= 1; // GS-5
            }
        }
    }

    /// A dip is filled where the gears after it stay higher.
    fn fill_dips(&mut self) {
        let count = self.len();
        let gear = &self.gear;
        let is_filled = |t: &usize| {
            let t = *t;
            let after = (1..=AFTER_DIP).filter(|q| t + q + 1 < count);
            self.dips[t]
                && gear[t] < gear[t - 1]
                && gear[t + 1] > gear[t]
                && after.into_iter().all(|q| gear[t + q] > gear[t])
        };
        let filled: Vec<usize> = (1..count.saturating_sub(1)).filter(is_filled).collect();
        let before: Vec<i32> = filled.iter().map(|t| gear[t - 1]).collect();
        for (t, gear) in filled.into_iter().zip(before) {
            self.gear[t] = gear; // GS-5
            self.possible.closes(t, gear);
        }
    }

    /// One or two gears up and back within a few seconds are taken back.
    fn take_back_excursions(&mut self) {
        let count = self.len();
        for b in 0..count.saturating_sub(2) {
            let own = self.gear[b];
            let (up, stays) = (self.gear[b + 1] - own, self.gear[b + 2] == self.gear[b + 1]);
            let to = match up {
                1 if own > 0 && stays => own,
                2 if own > 0 && stays => own + 1,
                _ => continue,
            };
            let is_away = |gear: &&i32| {
                if up == 1 {
                    **gear > own
                } else {
                    **gear != own + 1
                }
            };
            let ahead = self.gear[b + 2..].iter().take(EXCURSION + 1);
            let away = ahead.take_while(is_away).count();
            if away <= EXCURSION {
                for t in b + 1..b + 2 + away {
                    let least = self.possible.least[t];
                    self.gear[t] = if least == NO_GEAR { to } else { to.max(least) }; // GS-5
                }
            }
        }
    }

    /// No gear rises while the car slows down.
    fn slow_down(&mut self, run: &Run) {
        let (first, last) = (run.first, run.last);
        if self.held_down[first..=last].iter().any(|held| *held) {
            return;
        }
        let count = self.len();
        let begin = &self.gear[first..=last.min(first + 2)];
        let most = begin.iter().copied().max().unwrap_or(0);
        let before = first.checked_sub(1).map_or(0, |t| self.gear[t]);
        let falls = |gear: i32| most > gear || gear == 0;
        if before > 0
            && most > before
            && last + 2 < count
            && (falls(self.gear[last + 1]) || falls(self.gear[last + 2]))
        {
            let limit = if most - before == 1 {
                before
            } else {
                before + 1
            };
            for gear in &mut self.gear[first..=last] {
                *gear = (*gear).min(limit); // GS-5
            }
            self.held_down[first..=last].fill(true);
        }
        let mut end = last;
        if let Some([next, after]) = self.trace_kmh.get(last + 1..last + 3) {
            let goes_on = (after - next).abs() < 1e-3 || after > next;
            if *next >= REST_KMH && goes_on {
                end = last + 1;
            }
        }
        let mut lowest = NO_GEAR;
        for gear in &mut self.gear[first..=end] {
            if *gear > 0 {
                lowest = lowest.min(*gear);
                *gear = lowest; // GS-5
            }
        }
    }

    /// A step of two gears down at the begin of an acceleration is made with the clutch open.
    fn open_at_drops(&mut self) {
        let count = self.len();
        for t in 0..count.saturating_sub(1) {
            if self.drops[t] && self.gear[t + 1] - self.gear[t] < -1 {
                self.gear[t] = 0; // GS-5
                self.clutch[t] = true;
            }
        }
        for t in 1..count.saturating_sub(1) {
            let (before, after) = (self.gear[t - 1], self.gear[t + 1]);
            if self.gear[t] == 0 && before - 1 == after && after > 0 {
                self.gear[t] = before; // GS-5
                self.clutch[t] = false;
            }
        }
    }
}
