//! Corrections for a car that slows down (GS-5): the clutch opens in low gears, gears of a second or two are passed over, and first gear is
//! not used before a standstill.

use super::repair::Schedule;

/// Opens the clutch and passes over gears.
pub(super) fn open_clutch(schedule: &mut Schedule<'_>) {
    schedule.open_in_second();
    let ends = schedule.ends_at_rest();
    for t in 0..schedule.gear.len() {
        schedule.drop_before_rest(t);
        if schedule.pass_over(t) {
            schedule.pass_over_next(t);
        }
        schedule.none_before_rest(t, &ends);
    }
    schedule.no_first_gear();
}

impl Schedule<'_> {
    /// The gears around a second, from `before` seconds ahead of it to `after` behind it; none beyond the ends.
    fn around(&self, t: usize, before: usize, after: usize) -> Option<&[i32]> {
        self.gear.get(t.checked_sub(before)?..=t + after)
    }

    fn all(list: &[bool], t: usize, before: usize, after: usize) -> bool {
        let from = t.checked_sub(before);
        let part = from.and_then(|from| list.get(from..=t + after));
        part.is_some_and(|part| part.iter().all(|is| *is))
    }

    /// The clutch is open where second gear would turn the engine too slowly, and in up to two seconds before.
    fn open_in_second(&mut self) {
        let phases = self.phases;
        for run in phases.decelerations() {
            let idle = self.possible.idle_rpm;
            let least = if run.at_rest { idle } else { 0.9 * idle };
            let is_slow = |t: &usize| self.gear[*t] == 2 && self.possible.second_rpm[*t] < least;
            let slow: Vec<usize> = (run.first..=run.last).filter(is_slow).collect();
            for t in &slow {
                self.clutch[*t] = true; // GS-5
            }
            let Some(first) = slow.first() else { continue };
            let is_second =
                |back: usize| first.checked_sub(back).is_some_and(|t| self.gear[t] == 2);
            let before = match (is_second(1), is_second(2), is_second(3)) {
                (true, false, _) => 1,
                (true, true, false) => 2,
                _ => 0,
            };
            self.clutch[first - before..*first].fill(true); // GS-5
        }
    }

    /// Seconds at rest, and those without a gear that lead there.
    fn ends_at_rest(&self) -> Vec<bool> {
        let is_rest = |v: &f64| *v < super::phases::REST_KMH;
        let mut ends: Vec<bool> = self.trace_kmh.iter().map(is_rest).collect();
        for t in (0..ends.len().saturating_sub(1)).rev() {
            ends[t] |= self.gear[t] == 0 && ends[t + 1];
        }
        ends
    }

    /// Two seconds and then one second in falling gears before a standstill are none.
    fn drop_before_rest(&mut self, t: usize) {
        let Some(&[a, b, c, d, e, f, g]) = self.around(t, 1, 5) else {
            return;
        };
        let falls = a > b && b == c && c > d && d > e && e > 1 && f <= 1 && g <= 1;
        if falls && Self::all(&self.phases.stops, t, 1, 5) {
            self.gear[t..t + 4].fill(0); // GS-5
        }
    }

    /// A gear of one or two seconds on the way down is passed over with the clutch open; whether it was.
    fn pass_over(&mut self, t: usize) -> bool {
        let slows = &self.phases.slows;
        if let Some(&[a, b, c, d, e, f, g]) = self.around(t, 3, 3)
            && Self::all(slows, t, 3, 3)
            && (a == b && b == c && c != d && d != e && e == f && f == g)
        {
            self.open(t); // GS-5
            return true;
        }
        let goes_on = match self.around(t, 3, 4) {
            Some(&[a, b, c, d, e, f, g, h]) if Self::all(slows, t, 3, 4) => {
                a == b && b == c && c != d && d == e && e != f && f > 0 && f == g && g == h
            }
            _ => false,
        };
        let steps_down = match self.around(t, 3, 2) {
            Some(&[a, b, c, d, e, f]) if Self::all(slows, t, 1, 0) => {
                let is_one = c - 1 == d && (d == e && e - 1 == f || d - 1 == e && e == f);
                let is_more = (1..=2).contains(&(c - d)) && d >= e && e >= f && f + 3 <= c;
                a == b && b == c && f > 0 && (is_one || is_more)
            }
            _ => false,
        };
        if goes_on || steps_down {
            self.open(t);
            self.gear[t + 1] = self.gear[t + 2]; // GS-5
        }
        goes_on || steps_down
    }

    fn open(&mut self, t: usize) {
        self.gear[t] = 0;
        self.clutch[t] = true;
    }

    /// After a gear that was passed over another one of two seconds is passed over too.
    fn pass_over_next(&mut self, t: usize) {
        let Some(&[a, _, c, d, e, f]) = self.around(t, 1, 4) else {
            return;
        };
        if !(a > c + 1 && c == d && (1..=2).contains(&(d - e)) && e >= f && f > 0) {
            return;
        }
        if e + 2 >= self.possible.greatest[t + 1] {
            self.gear[t + 1..t + 3].fill(e); // GS-5
        } else {
            self.open(t + 1);
            self.gear[t + 2..t + 5].fill(f); // GS-5
        }
    }

    /// The last gear of one or two seconds before a standstill is none.
    fn none_before_rest(&mut self, t: usize, ends: &[bool]) {
        let stops = &self.phases.stops;
        let ends_at = |at: usize| ends.get(at) == Some(&true);
        if t < 2 {
            return;
        }
        let one = match self.around(t, 1, 1) {
            Some(&[a, b, c]) => {
                Self::all(stops, t, 1, 0) && ends_at(t + 1) && b > 0 && a != b && b != c
            }
            _ => false,
        };
        let two = match self.around(t, 1, 2) {
            Some(&[a, b, c, d]) => {
                Self::all(stops, t, 1, 1) && ends_at(t + 2) && b > 0 && a != b && b == c && c != d
            }
            _ => false,
        };
        if one || two {
            let last = if one { t } else { t + 1 };
            self.gear[t..=last].fill(0); // GS-5
            self.clutch[t..=last].fill(false);
        }
    }

    /// First gear is not used before a standstill.
    fn no_first_gear(&mut self) {
        let stops = &self.phases.stops;
        for t in 1..self.gear.len() {
            if stops[t] && stops[t - 1] && self.gear[t] == 1 {
                self.gear[t] = 0; // GS-5
            }
        }
        let old = self.gear.clone();
        for t in 1..old.len() {
            if stops[t] && !stops[t - 1] && old[t - 1] != 1 && old[t] == 1 && !self.clutch[t] {
                self.gear[t] = 0; // GS-5
                self.clutch[t] = true;
            }
        }
    }
}
