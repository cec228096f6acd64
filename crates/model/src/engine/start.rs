//! History of the engine before a step, for the laws that follow a start and the fuel cut.
//!
//! | label | statement | status |
//! |---|---|---|
//! | EN-9 | fuel of a start: m(t) = m_0 clip((60 degC - T_start)/60 K, 0, 1) F(t/tau), F(u) = 2u - u2 up to u = 1, then 1 | form: enrichment that fades in some 30 s (manuals of the 1990s), by coolant at the start; size ASSUMED |
//! | EN-11 | share of overrun in which fuel is cut: from none to all over 1 K of coolant above T_cut, times the mean over the step of from none to all between n_back and n_cut, speed linear: of a box with gears that of the wheels, of a CVT that before the step, at most that in low | source: Saab 900 workshop manual 1987 (45 degC, 1400 to 1750 rpm, back 1300 to 1450 rpm); ramps ASSUMED in place of hysteresis |
//!
//! With ramps in place of a hysteresis the fuel of a step is a continuous function of what went before, and no state is carried.

use super::Engine;
use crate::lubricant::ZERO_DEGC_K;
use crate::math::{Mask, Real, both, mean_ramp, physics};

/// Coolant from which a start is warm, K (EN-1, EN-3, EN-9).
pub(super) const COLD_K: f64 = 60.0 + ZERO_DEGC_K;

/// History of the engine before a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Running<R: Real = f64> {
    /// Time since the start, s: 0 at the start, infinite where it is long ago.
    pub since_s: f64,
    /// Coolant at the start, K.
    pub start_k: R,
    /// Speed at the beginning of the step, rad/s.
    pub speed_rad_s: R,
    /// Speed that it has at the end of it as far as that is known before, rad/s.
    pub end_rad_s: R,
}

impl Running {
    /// At rest, before a start.
    pub const STOPPED: Running = Running {
        since_s: 0.0,
        start_k: 0.0,
        speed_rad_s: 0.0,
        end_rad_s: 0.0,
    };

    /// Started long ago.
    pub const LONG: Running = Running {
        since_s: f64::INFINITY,
        start_k: f64::INFINITY,
        ..Running::STOPPED
    };
}

#[physics]
impl<R: Real> Running<R> {
    /// The same with the coolant of the start, K, where it starts now.
    #[must_use]
    pub fn started(self, coolant_k: R) -> Running<R> {
        if self.since_s > 0.0 {
            return self;
        }
        Running {
            start_k: coolant_k,
            ..self
        }
    }

    /// The same with the speeds that the engine has at the beginning and at the end of a step in overrun, rad/s, so that EN-11 has no lag of a step.
    #[must_use]
    pub fn turning(self, [speed_rad_s, end_rad_s]: [R; 2]) -> Running<R> {
        Running {
            speed_rad_s,
            end_rad_s,
            ..self
        }
    }

    /// After a step of a running engine, or of one that is off, at the end of which it has a speed, rad/s.
    #[must_use]
    pub fn after(self, off: bool, dt_s: f64, engine_rad_s: R) -> Running<R> {
        if off {
            let zero = engine_rad_s.splat(0.0);
            return Running {
                since_s: 0.0,
                start_k: zero,
                speed_rad_s: zero,
                end_rad_s: zero,
            };
        }
        let mut since_s = self.since_s;
        since_s += dt_s;
        Running {
            since_s,
            speed_rad_s: engine_rad_s,
            end_rad_s: engine_rad_s,
            ..self
        }
    }
}

#[physics]
impl<R: Real> Running<R> {
    /// Rate in a step at which what fades over `within_s` is spent, 1/s: its mean, so that every step length spends the same.
    pub(super) fn spending_per_s(&self, within_s: R, dt_s: f64) -> R {
        let zero = within_s.splat(0.0);
        let since = within_s.splat(self.since_s);
        let over = since.ge(within_s);
        if over.all() {
            return zero; // all is spent
        }
        let u = both!(end => ([since, since + dt_s][end] / within_s).min(1.0));
        let spent = both!(end => u[end] * (2.0 - u[end]));
        over.select(zero, (spent[1] - spent[0]) / dt_s)
    }
}

/// Share of the fuel of a start that it takes at a temperature of the coolant, K.
#[physics]
pub(super) fn cold_share<R: Real>(coolant_k: R) -> R {
    ((COLD_K - coolant_k) * 60_f64.recip()).clamp(0.0, 1.0)
}

#[physics]
impl<R: Real> Engine<R> {
    /// Fuel of the start in a step, kg/s.
    pub(super) fn start_kg_s(&self, running: &Running<R>, dt_s: f64) -> R {
        let cold = cold_share(running.start_k);
        self.start_kg * cold * running.spending_per_s(self.start_s, dt_s) // EN-9
    }

    /// Share of the overrun drag that is taken up with fuel cut; decided before the solve, so that nothing jumps within one.
    pub(super) fn cut_share(&self, coolant_k: R, running: &Running<R>) -> R {
        let warm = (coolant_k - self.cut_from_k).clamp(0.0, 1.0);
        let speeds = [running.speed_rad_s, running.end_rad_s];
        warm * mean_ramp(speeds, self.fuel_back_rad_s, self.cut_above_rad_s) // EN-11
    }
}
