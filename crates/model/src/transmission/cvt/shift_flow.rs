//! The flow that a shift may take: the largest that the pump has left once the clamp that this shift needs is fed (RC-5, PU-7).
//!
//! The flow left for the shift falls with the flow that the shift takes, for a faster shift needs more pressure (PC-5). So a step is solved for the
//! shift that the controller demands, and where the pump has less, again for others between none and that one: by secant and false position
//! (Illinois), then by halves, since the flow left may jump where the primary has the pressure of no shift. Few steps need it; each run has its own
//! search.

use super::evaluate::{Point, Step};
use crate::math::{Mask, Real, physics};

/// Flow that may be missing or unused, over that of the demanded shift.
const TOLERANCE: f64 = 1e-6;
/// Tries after which the interval is halved, and after which a run takes what it knows that there is.
const HALVED_FROM: u8 = 8;
const MOST_TRIES: u8 = 40;

/// A flow, m3/s, and what is left beyond it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tried {
    flow: f64,
    beyond: f64,
}

/// An end of the interval that holds the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Low,
    High,
}

/// The search of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Search {
    /// Largest flow of the next try, m3/s.
    most: f64,
    /// Flow of the demanded shift, m3/s.
    asked: f64,
    /// Largest flow that there is, if one is known.
    low: Option<Tried>,
    /// Smallest flow that there is not.
    high: Tried,
    /// The end that the try before moved.
    moved: Option<End>,
    tries: u8,
    /// True where the next try is the last.
    last: bool,
    done: bool,
}

impl Search {
    /// Before the first try.
    const NEW: Search = Search {
        most: f64::INFINITY,
        asked: 0.0,
        low: None,
        high: Tried {
            flow: f64::INFINITY,
            beyond: 0.0,
        },
        moved: None,
        tries: 0,
        last: false,
        done: false,
    };

    /// Takes a try with a flow that left another, m3/s; true if another try is needed.
    fn takes(&mut self, flow: f64, left: f64) -> bool {
        let now = Tried {
            flow,
            beyond: left - flow,
        };
        if self.tries == 0 {
            self.asked = flow;
        }
        let tolerance = TOLERANCE * self.asked;
        let unused = now.beyond >= 0.0 && flow < self.most - tolerance;
        let settled = now.beyond.abs() <= tolerance || !now.beyond.is_finite();
        if self.done || self.last || unused || settled {
            self.done = true;
            return false;
        }
        self.tries += 1;
        self.most = match now.beyond > 0.0 {
            true => self.after_low(now),
            false => self.after_high(now, left),
        };
        let lowest = self.low.map_or(0.0, |low| low.flow);
        if self.tries >= MOST_TRIES || self.high.flow - lowest <= tolerance {
            (self.most, self.last) = (lowest, true);
        }
        true
    }

    /// The next flow after one that there is.
    fn after_low(&mut self, now: Tried) -> f64 {
        if self.moved == Some(End::Low) {
            self.high.beyond *= 0.5; // Illinois: the same end moves again
        }
        self.moved = Some(End::Low);
        self.low = Some(now);
        self.between(now)
    }

    /// The next flow after one that there is not, which left another.
    fn after_high(&mut self, now: Tried, left: f64) -> f64 {
        let before = std::mem::replace(&mut self.high, now);
        let moved = self.moved.replace(End::High);
        if let Some(low) = &mut self.low {
            if moved == Some(End::High) {
                low.beyond *= 0.5; // Illinois: the same end moves again
            }
            let low = *low;
            return self.between(low);
        }
        let slope = (before.beyond - now.beyond) / (before.flow - now.flow);
        match slope < 0.0 {
            true => (now.flow - now.beyond / slope).max(0.0),
            false => left,
        }
    }

    fn between(&self, low: Tried) -> f64 {
        let width = self.high.flow - low.flow;
        let share = match self.tries < HALVED_FROM {
            true => low.beyond / (low.beyond - self.high.beyond),
            false => 0.5,
        };
        low.flow + share * width
    }
}

/// The searches of all runs.
pub(super) struct ShiftFlow<R: Real> {
    /// Largest flow of the next try, m3/s.
    pub most_m3_s: R,
    /// None before one is needed.
    searches: Option<R::PerLane<Search>>,
}

#[physics]
impl<R: Real> ShiftFlow<R> {
    /// Before the first try; `like` has the lanes.
    pub(super) fn new(like: R) -> Self {
        ShiftFlow {
            most_m3_s: like.splat(f64::INFINITY),
            searches: None,
        }
    }

    /// Takes a solved try; the runs that need another one.
    #[inline]
    pub(super) fn takes<P>(&mut self, step: &Step<'_, P, R>, point: &Point<R>) -> R::Mask {
        let (flow, left) = (step.shift_flow_m3_s, point.left_m3_s);
        let is_short = step.clamp_first && flow.gt(left).any();
        if !is_short && self.searches.is_none() {
            return flow.splat_mask(false);
        }
        self.search(flow, left)
    }

    #[cold]
    fn search(&mut self, flow: R, left: R) -> R::Mask {
        let searches = (self.searches).get_or_insert_with(|| R::per_lane(|_| Search::NEW));
        let mut more = [false; crate::math::MAX_LANES];
        for (lane, more) in more.iter_mut().enumerate().take(R::LANES) {
            *more = R::get_mut(searches, lane).takes(flow.lane(lane), left.lane(lane));
        }
        self.most_m3_s = flow.map_lanes(|lane| R::get(searches, lane).most);
        flow.mask_lanes(|lane| more[lane])
    }
}
