//! Drive cycles: what speed is asked of the car at what time, in which gear, on which slope.
//!
//! SI units throughout: kilometres per hour and percent end where a table is read.

pub mod distance;
pub mod gears;
pub mod gtr15;
mod trace;

pub use gears::{GearColumns, GearCommand};
pub use trace::{
    Interval, Motion, STANDSTILL_M_S, Step, TOLERANCE_M_S, Trace, is_standstill, mean_powers,
};

/// How the fuel of the phases is put together to the cycle's one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// Fuel of the whole cycle over its distance.
    None,
    /// 40 CFR 86.144: phases `cold_transient` (ct), `stabilised` (s), `hot_soak`, `hot_transient` (ht);
    /// Y = 0.43 (Y_ct + Y_s)/(D_ct + D_s) + 0.57 (Y_ht + Y_s)/(D_ht + D_s). The soak counts in no bag.
    Ftp75,
}

impl Weighting {
    /// Share of the cold test in [`Weighting::Ftp75`] (40 CFR 86.144: 43 % of trips start cold).
    pub const FTP75_COLD: f64 = 0.43;
    /// Share of the hot test in [`Weighting::Ftp75`].
    pub const FTP75_HOT: f64 = 0.57;
}

/// A drive cycle: one name, and one trace each for manual and for automatic cars.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    /// Name under which it was asked for; a user's file gives its name without the extension.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Names of the phases as written in the table, in the order in which they first occur;
    /// [`Interval::phase`] is the index into this list. Empty for a cycle without phases (all intervals then bear phase 0).
    pub phases: Vec<String>,
    /// How the phases are weighted.
    pub weighting: Weighting,
    /// Trace of a car with a manual box.
    pub manual: Trace,
    /// Trace of an automatic or a CVT; the manual trace if `None`.
    pub automatic: Option<Trace>,
    /// How its file was read, where it was not written as the program's own are: separators, names and units of other programs.
    pub read_as: Option<String>,
    /// How its recording was repaired, and what is doubted; none of a cycle that was written as one.
    pub recording: Option<Box<Recording>>,
    /// True for a WLTC with a speed a second, where the gears of a manual car follow UN GTR 15.
    pub is_wltc: bool,
}

/// How a recording became a cycle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Repairs that were made.
    pub repairs: Vec<Repair>,
    /// Doubts, each a sentence without its full stop.
    pub doubts: Vec<String>,
    /// Traces with less and more smoothing, which the recording does not rule out.
    pub bounds: Vec<Trace>,
    /// Half width by which fuel (per cent) and difference (points) are open beyond these (LG-6); none where nothing is.
    pub left: Option<[f64; 2]>,
    /// True where rows come at a rate, so that it is a log and no schedule.
    pub is_log: bool,
    /// Other quantities of the car that were recorded with its speed.
    pub measured: Vec<Measured>,
}

/// A quantity of a car that was recorded with its speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Name of the quantity: `engine_speed` in rad/s, `fuel` in kg/s, `coolant`, `engine_oil`, `sump` and `ambient` in degC.
    pub quantity: String,
    /// Times, s from the start of the cycle.
    pub time_s: Vec<f64>,
    /// Values; NaN where there is none.
    pub values: Vec<f64>,
}

impl Measured {
    /// Mean over an interval of time, by the values within it, or by the line between the neighbours of an interval without one; none beyond the
    /// recording, or without a number.
    #[must_use]
    pub fn mean(&self, from_s: f64, to_s: f64) -> Option<f64> {
        let first = self.time_s.partition_point(|time| *time <= from_s);
        let end = self.time_s.partition_point(|time| *time <= to_s);
        let within = self.values[first..end]
            .iter()
            .filter(|value| value.is_finite());
        let (count, sum) =
            within.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
        if count > 0.0 {
            return Some(sum / count);
        }
        let (low, high) = (first.checked_sub(1)?, end);
        let (before, behind) = (*self.values.get(low)?, *self.values.get(high)?);
        let share =
            (0.5 * (from_s + to_s) - self.time_s[low]) / (self.time_s[high] - self.time_s[low]);
        let value = before + share * (behind - before);
        value.is_finite().then_some(value)
    }
}

impl Recording {
    /// Time within which a channel begins, s.
    const BEGIN_S: f64 = 30.0;

    /// First value of a quantity, in the first half minute.
    #[must_use]
    pub fn first(&self, quantity: &str) -> Option<f64> {
        let own = self.measured.iter().find(|own| own.quantity == quantity)?;
        let at = own.values.iter().position(|value| value.is_finite())?;
        (own.time_s[at] <= Recording::BEGIN_S).then_some(own.values[at])
    }
}

/// A repair of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Repair {
    /// Name, as `--repair` has it.
    pub name: String,
    /// Number of rows, samples or gaps.
    pub count: usize,
    /// Description of what was done.
    pub what: String,
}

impl Cycle {
    /// A cycle from intervals, one trace for all cars, without prescribed gears. Phases are named `phase_1`, `phase_2` and so on, where
    /// there is more than one.
    ///
    /// ```
    /// use cvtcycle_model::cycle::{Cycle, Interval};
    ///
    /// let start = Interval {
    ///     start_s: 0.0,
    ///     end_s: 10.0,
    ///     start_speed_m_s: 0.0,
    ///     end_speed_m_s: 15.0,
    ///     phase: 0,
    ///     grade: 0.0,
    ///     engine_off: false,
    /// };
    /// let cruise = Interval { start_s: 10.0, end_s: 70.0, start_speed_m_s: 15.0, ..start };
    /// let cycle = Cycle::from_intervals("cruise", vec![start, cruise])?;
    /// assert_eq!(cycle.manual.distance_m(), 75.0 + 900.0);
    /// assert!(Cycle::from_intervals("gap", vec![cruise]).is_err());
    /// # Ok::<(), String>(())
    /// ```
    ///
    /// # Errors
    /// A sentence that names the first interval, counted from 1, that does not begin where the one before ends (the first: at 0 s), does
    /// not end after its beginning, or has a speed below zero or a number that is not finite.
    pub fn from_intervals(name: &str, intervals: Vec<Interval>) -> Result<Self, String> {
        let mut end = (0.0, intervals.first().map_or(0.0, |i| i.start_speed_m_s));
        for (number, i) in (1..).zip(&intervals) {
            let speeds = [i.start_speed_m_s, i.end_speed_m_s];
            if (i.start_s - end.0).abs() > 0.0 || (i.start_speed_m_s - end.1).abs() > 0.0 {
                return Err(format!(
                    "interval {number} does not begin at {} s and {} m/s",
                    end.0, end.1
                ));
            }
            if !(i.end_s > i.start_s && i.end_s.is_finite()) {
                return Err(format!(
                    "interval {number} does not end after its beginning"
                ));
            }
            if !(i.grade.is_finite() && speeds.iter().all(|v| *v >= 0.0 && v.is_finite())) {
                return Err(format!(
                    "interval {number} has a speed or grade out of range"
                ));
            }
            end = (i.end_s, i.end_speed_m_s);
        }
        let Some(last) = intervals.iter().map(|i| i.phase).max() else {
            return Err("a cycle has at least one interval".to_owned());
        };
        Ok(Cycle {
            name: name.to_owned(),
            title: name.to_owned(),
            phases: (1..=last + u16::from(last > 0))
                .map(|k| format!("phase_{k}"))
                .collect(),
            weighting: Weighting::None,
            manual: Trace::without_gears(intervals),
            automatic: None,
            read_as: None,
            recording: None,
            is_wltc: false,
        })
    }

    /// The trace that a car drives: with `automatic` the one of an automatic or CVT, without it that of a manual gearbox.
    /// Most cycles have one trace for both; the ECE cycles hold the speed during gear changes, for manual cars only.
    pub fn trace_for(&self, automatic: bool) -> &Trace {
        match &self.automatic {
            Some(trace) if automatic => trace,
            _ => &self.manual,
        }
    }

    /// True if the manual trace prescribes gears, for any number of gears.
    pub fn has_gears(&self) -> bool {
        self.manual.has_gears()
    }

    /// Groups of phases for the report: name in lower case and the phase indices in it, in the order of the cycle.
    /// `ECE15_1` to `ECE15_4` are one group `ece15`; a cycle without phases is one group with the cycle's name.
    pub fn phase_groups(&self) -> Vec<(String, Vec<u16>)> {
        if self.phases.is_empty() {
            return vec![(self.name.clone(), vec![0])];
        }
        let mut groups: Vec<(String, Vec<u16>)> = Vec::new();
        for (phase, name) in (0_u16..).zip(&self.phases) {
            let name = phase_group(name);
            match groups.iter_mut().find(|group| group.0 == name) {
                Some(group) => group.1.push(phase),
                None => groups.push((name, vec![phase])),
            }
        }
        groups
    }
}

/// The group to which a phase of that name belongs.
pub fn phase_group(phase: &str) -> String {
    let lower = phase.to_lowercase();
    match lower.strip_prefix("ece15_") {
        Some("1" | "2" | "3" | "4") => "ece15".to_owned(),
        _ => lower,
    }
}
