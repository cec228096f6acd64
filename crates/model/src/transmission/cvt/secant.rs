//! What the solve learns from its evaluations: slopes for the next guess, kept from step to step as a start.

use super::evaluate::{Guess, Point};
use crate::math::{clamp, larger};

/// Closer than this two pressures say nothing of a slope, Pa.
const SECANT_FROM_PA: f64 = 200.0;
/// Closer than this two output torques say nothing of a slope, Nm: what pressure and slip still move is larger.
const SECANT_FROM_NM: f64 = 0.02;
/// Largest slope of the pressure's fixed point that is believed: above it the step would overshoot.
const MAX_GAIN: f64 = 0.06;
/// The same over an open torque converter, whose engine speed the pressure moves through the torque that passes.
const MAX_GAIN_OPEN: f64 = 0.8;

/// Largest relative change of slip per relative change of pressure that is believed.
const MAX_SLIP_GAIN: f64 = 2.0;

/// Accelerations closer than this are the same, m/s2: traces round their speeds.
const ALIKE_M_S2: f64 = 1e-3;

/// Slopes at the last evaluations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes {
    /// Pressure demand of the clamp law against the present pressure.
    pub pressure: f64,
    /// Slip against pressure, 1/Pa.
    pub slip_per_pa: f64,
    /// Primary torque against output torque over ratio.
    pub torque: f64,
}

/// How losses and slip went on over steps of equal acceleration: what the next such step begins with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trend {
    /// Acceleration of the last step, m/s2.
    accel_m_s2: f64,
    /// Steps before it with the same acceleration.
    alike: u32,
    /// Flywheel torque above output torque over ratio, Nm.
    loss: Series,
    slip: Series,
}

/// What a solve begins with, from the step before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WarmStart {
    /// Losses and slip.
    pub trend: Trend,
    /// Slopes of the secants.
    pub slopes: Slopes,
    /// True where the engine's drag fixed the output torque.
    pub overrun: bool,
}

/// Last value of a smooth series and its differences.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Series {
    value: f64,
    first: f64,
    second: f64,
}

impl Series {
    /// The value that follows, with as many differences as there are steps alike before the last.
    #[inline]
    fn next(&self, alike: u32) -> f64 {
        let first = if alike > 0 { self.first } else { 0.0 };
        self.value + first + if alike > 1 { self.second } else { 0.0 }
    }

    #[inline]
    fn push(&mut self, value: f64) {
        let first = value - self.value;
        *self = Series {
            value,
            first,
            second: first - self.first,
        };
    }
}

impl Trend {
    /// Slip and loss torque in Nm to begin a step with: those of the step before, carried on where the car is driven alike.
    #[inline]
    pub(super) fn next(&self, accel_m_s2: f64) -> (f64, f64) {
        let alike = if (accel_m_s2 - self.accel_m_s2).abs() < ALIKE_M_S2 {
            self.alike
        } else {
            0
        };
        (self.slip.next(alike), self.loss.next(alike))
    }

    /// Takes a step at standstill: nothing slips, and what follows is not like it.
    pub(super) fn reset_at_standstill(&mut self) {
        *self = Trend {
            loss: Series {
                value: self.loss.value,
                ..Series::default()
            },
            ..Trend::default()
        };
    }

    /// Takes a solved step.
    #[inline]
    pub(super) fn push(&mut self, accel_m_s2: f64, slip: f64, loss_nm: f64) {
        self.alike = if (accel_m_s2 - self.accel_m_s2).abs() < ALIKE_M_S2 {
            self.alike.saturating_add(1)
        } else {
            0
        };
        self.accel_m_s2 = accel_m_s2;
        self.slip.push(slip);
        self.loss.push(loss_nm);
    }
}

impl Default for Slopes {
    /// Before anything is known: pressure acts on nothing, torque passes without loss.
    fn default() -> Self {
        Slopes {
            pressure: 0.0,
            slip_per_pa: 0.0,
            torque: 1.0,
        }
    }
}

impl Slopes {
    /// Takes the slopes between two evaluations, the earlier one given by its guess and the pressure that followed from it.
    #[inline]
    pub(super) fn update(
        &mut self,
        (before, before_next_pa): (&Guess, f64),
        now: &Point,
        open: bool,
    ) {
        let most_gain = if open { MAX_GAIN_OPEN } else { MAX_GAIN };
        let step_pa = now.guess.pressure_pa - before.pressure_pa;
        if step_pa.abs() > SECANT_FROM_PA {
            self.pressure = clamp(
                (now.next_pressure_pa - before_next_pa) / step_pa,
                -most_gain,
                most_gain,
            );
            if now.guess.output_nm.to_bits() == before.output_nm.to_bits() {
                let most = MAX_SLIP_GAIN * now.guess.slip.abs() / now.guess.pressure_pa;
                self.slip_per_pa = clamp((now.guess.slip - before.slip) / step_pa, -most, most);
            }
        }
    }

    /// Pressure at which the line through an evaluation meets its fixed point, Pa (CV-5).
    #[inline]
    pub(super) fn pressure_pa(&self, now: &Point) -> f64 {
        let p = now.guess.pressure_pa;
        p + (now.next_pressure_pa - p) / (1.0 - self.pressure)
    }
}

/// Secant on the output torque where the engine binds it.
pub(super) struct TorqueSecant {
    /// Belt ratio: without loss the slope of primary against output torque is its inverse.
    ratio: f64,
    /// Output torque that is always allowed, Nm.
    allowed_nm: f64,
    last: Option<(f64, f64)>,
}

impl TorqueSecant {
    pub fn new(ratio: f64, first_nm: f64) -> Self {
        TorqueSecant {
            ratio,
            allowed_nm: first_nm.abs(),
            last: None,
        }
    }

    /// Next output torque after an evaluation, and whether it moves no more for the bound
    /// of the belt: the belt carries no more than its capacity, whatever the engine could take or give (VA-2).
    pub fn next_nm(&mut self, now: &Point, slopes: &mut Slopes, plain: bool) -> (f64, bool) {
        let (x, miss_nm) = (now.guess.output_nm, now.miss_nm);
        if let Some((x0, miss0)) = self.last
            && (x - x0).abs() > SECANT_FROM_NM
        {
            slopes.torque = clamp((miss_nm - miss0) / (x - x0) * self.ratio, 0.5, 2.0);
        }
        self.last = Some((x, miss_nm));
        let slope = if plain { 1.0 } else { slopes.torque };
        let carried = 1.05 * now.torques.belt.capacity_nm;
        let carried = larger(carried, self.allowed_nm);
        let next = clamp(x - miss_nm * self.ratio / slope, -carried, carried); // CV-5
        (next, (next - x).abs() <= 1e-9 * carried)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quadratic series is met exactly once three steps were alike; after another acceleration only the last value counts.
    #[test]
    fn trend_follows_steps_alike_and_no_others() {
        let slip = |k: f64| 0.01 + 1e-4 * k - 2e-6 * k * k;
        let mut trend = Trend::default();
        for k in 0..4 {
            trend.push(0.5, slip(f64::from(k)), 2.0 * slip(f64::from(k)));
        }
        let (next_slip, next_nm) = trend.next(0.5);
        assert!(
            (next_slip / slip(4.0) - 1.0).abs() < 1e-12
                && (next_nm / slip(4.0) - 2.0).abs() < 1e-12
        );
        assert!((trend.next(0.6).0 / slip(3.0) - 1.0).abs() < 1e-15);
        trend.push(0.6, 0.02, 1.0);
        assert!(
            (trend.next(0.6).0 - 0.02).abs() < 1e-15,
            "one step alone has no trend"
        );
        trend.reset_at_standstill();
        let (slip, loss_nm) = trend.next(0.6);
        assert!(slip.abs() < 1e-15 && (loss_nm - 1.0).abs() < 1e-15);
    }
}
