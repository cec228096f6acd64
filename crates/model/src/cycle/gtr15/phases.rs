//! The phases of a trace (GS-6).

/// Below this a car is at rest, km/h.
pub(super) const REST_KMH: f64 = 1.0;
/// A smaller change within a second is none, km/h.
const CONSTANT_KMH: f64 = 1e-3;
/// A rise or a fall of no more seconds belongs to no phase.
const SHORT: usize = 2;

/// Change of speed from a second to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    Rest,
    Constant,
    Rise,
    Fall,
}

/// Seconds of one kind of phase, first and last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    pub change: Change,
    pub first: usize,
    pub last: usize,
    /// A rise after a rest, a fall before one.
    pub at_rest: bool,
    /// It is too short to be a phase.
    pub is_short: bool,
}

/// A trace by its phases.
#[derive(Clone, Debug)]
pub(super) struct Phases {
    /// Change of speed in each second.
    pub change: Vec<Change>,
    /// In their order.
    pub runs: Vec<Run>,
    /// Seconds of an acceleration phase.
    pub rises: Vec<bool>,
    /// Seconds of a constant phase.
    pub holds: Vec<bool>,
    /// Seconds of a deceleration phase.
    pub slows: Vec<bool>,
    /// Seconds of a deceleration to a standstill.
    pub stops: Vec<bool>,
}

impl Phases {
    pub(super) fn new(trace_kmh: &[f64]) -> Phases {
        let change = |t: usize| {
            let now = trace_kmh[t];
            let by = trace_kmh.get(t + 1).map_or(-now, |next| next - now);
            match by {
                _ if now < REST_KMH => Change::Rest,
                by if by.abs() < CONSTANT_KMH => Change::Constant,
                by if by > 0.0 => Change::Rise,
                _ => Change::Fall,
            } // GS-6
        };
        let change: Vec<Change> = (0..trace_kmh.len()).map(change).collect();
        let runs = runs(&change);
        let seconds = |is: &dyn Fn(&Run) -> bool| {
            let mut list = vec![false; change.len()];
            for run in runs.iter().filter(|run| is(run) && !run.is_short) {
                list[run.first..=run.last].fill(true);
            }
            list
        };
        Phases {
            rises: seconds(&|run| run.change == Change::Rise),
            holds: seconds(&|run| run.change == Change::Constant),
            slows: seconds(&|run| run.change == Change::Fall),
            stops: seconds(&|run| run.change == Change::Fall && run.at_rest),
            change,
            runs,
        }
    }

    /// The phases in which the speed rises.
    pub(super) fn accelerations(&self) -> impl Iterator<Item = &Run> {
        let runs = self.runs.iter();
        runs.filter(|run| run.change == Change::Rise && !run.is_short)
    }

    /// The phases in which the speed falls.
    pub(super) fn decelerations(&self) -> impl Iterator<Item = &Run> {
        let runs = self.runs.iter();
        runs.filter(|run| run.change == Change::Fall && !run.is_short)
    }
}

fn runs(change: &[Change]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (t, change) in change.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if run.change == *change => run.last = t,
            _ => runs.push(Run {
                change: *change,
                first: t,
                last: t,
                at_rest: false,
                is_short: false,
            }),
        }
    }
    let is_rest = |change: Option<&Change>| change == Some(&Change::Rest);
    for run in &mut runs {
        run.at_rest = match run.change {
            Change::Rise => is_rest(run.first.checked_sub(1).and_then(|t| change.get(t))),
            Change::Fall => is_rest(change.get(run.last + 1)),
            Change::Rest | Change::Constant => false,
        };
        let is_moving = matches!(run.change, Change::Rise | Change::Fall);
        run.is_short = is_moving && run.last - run.first < SHORT; // GS-6
    }
    runs
}
