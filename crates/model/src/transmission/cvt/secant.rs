//! Slopes from the evaluations of a solve for the next guess, kept from step to step as a start.

use super::evaluate::{Guess, Point};
use crate::math::{Mask, Real, physics};

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
pub struct Slopes<R: Real = f64> {
    /// Pressure demand of the clamp law against the present pressure.
    pub pressure: R,
    /// Slip against pressure, 1/Pa.
    pub slip_per_pa: R,
    /// Primary torque against output torque over ratio.
    pub torque: R,
}

/// How losses and slip went on over steps of equal acceleration: what the next such step begins with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trend<R: Real = f64> {
    /// Acceleration of the last step, m/s2.
    accel_m_s2: f64,
    /// Steps before it with the same acceleration.
    alike: u32,
    /// Flywheel torque above output torque over ratio, Nm.
    loss: Series<R>,
    slip: Series<R>,
}

/// Start of a solve from the step before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmStart<R: Real = f64> {
    /// Losses and slip.
    pub trend: Trend<R>,
    /// Slopes of the secants.
    pub slopes: Slopes<R>,
    /// True where the engine's drag fixed the output torque.
    pub overrun: R::Mask,
}

impl<R: Real> WarmStart<R> {
    /// Before the first step; `like` has the lanes.
    pub fn new(like: R) -> Self {
        WarmStart {
            trend: Trend::new(like),
            slopes: Slopes::new(like),
            overrun: like.splat_mask(false),
        }
    }
}

impl Default for WarmStart {
    fn default() -> Self {
        WarmStart::new(0.0)
    }
}

/// Last value of a smooth series and its differences.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Series<R: Real = f64> {
    value: R,
    first: R,
    second: R,
}

#[physics]
impl<R: Real> Series<R> {
    /// A value without a past.
    #[inline]
    fn new(value: R) -> Self {
        let none = value.splat(0.0);
        Series {
            value,
            first: none,
            second: none,
        }
    }

    /// The value that follows, with as many differences as there are steps alike before the last.
    pub fn next(&self, alike: u32) -> R {
        let none = self.value.splat(0.0);
        let first = if alike > 0 { self.first } else { none };
        self.value + first + if alike > 1 { self.second } else { none }
    }

    pub fn push(&mut self, value: R) {
        let first = value - self.value;
        *self = Series {
            value,
            first,
            second: first - self.first,
        };
    }
}

#[physics]
impl<R: Real> Trend<R> {
    /// Nothing is known; `like` has the lanes.
    #[inline]
    fn new(like: R) -> Self {
        let none = Series::new(like.splat(0.0));
        Trend {
            accel_m_s2: 0.0,
            alike: 0,
            loss: none,
            slip: none,
        }
    }

    /// Steps alike before one with an acceleration, m/s2.
    fn alike(&self, accel_m_s2: f64) -> u32 {
        if is_alike(accel_m_s2, self.accel_m_s2) {
            self.alike
        } else {
            0
        }
    }

    /// Slip and loss torque in Nm to begin a step with: those of the step before, carried on where the car is driven alike.
    pub(super) fn next(&self, accel_m_s2: f64) -> (R, R) {
        let alike = self.alike(accel_m_s2);
        (self.slip.next(alike), self.loss.next(alike))
    }

    /// Takes a step at standstill: nothing slips, and what follows is not like it.
    #[inline]
    pub(super) fn reset_at_standstill(&mut self) {
        *self = Trend {
            loss: Series::new(self.loss.value),
            ..Trend::new(self.loss.value)
        };
    }

    /// Takes a solved step.
    pub(super) fn push(&mut self, accel_m_s2: f64, slip: R, loss_nm: R) {
        self.alike = if is_alike(accel_m_s2, self.accel_m_s2) {
            self.alike.saturating_add(1)
        } else {
            0
        };
        self.accel_m_s2 = accel_m_s2;
        self.slip.push(slip);
        self.loss.push(loss_nm);
    }
}

/// True if two accelerations, m/s2, are equal but for rounding.
#[physics]
fn is_alike(a_m_s2: f64, b_m_s2: f64) -> bool {
    (a_m_s2 - b_m_s2).abs() < ALIKE_M_S2
}

impl Default for Slopes {
    fn default() -> Self {
        Slopes::new(0.0)
    }
}

impl<R: Real> Slopes<R> {
    /// Before anything is known: pressure acts on nothing, torque passes without loss. `like` has the lanes.
    pub fn new(like: R) -> Self {
        Slopes {
            pressure: like.splat(0.0),
            slip_per_pa: like.splat(0.0),
            torque: like.splat(1.0),
        }
    }
}

#[physics]
impl<R: Real> Slopes<R> {
    /// Takes the slopes between two evaluations, the earlier one given by its guess and the pressure that followed from it. `open`: over a
    /// torque converter that is not locked.
    pub(super) fn update(
        &mut self,
        (before, before_next_pa): (&Guess<R>, R),
        now: &Point<R>,
        open: R::Mask,
    ) {
        let step_pa = now.guess.pressure_pa - before.pressure_pa;
        let moved = step_pa.abs().gt(SECANT_FROM_PA);
        if !moved.any() {
            return;
        }
        let most_gain = open.select(step_pa.splat(MAX_GAIN_OPEN), step_pa.splat(MAX_GAIN));
        let gain = (now.next_pressure_pa - before_next_pa) / step_pa;
        self.pressure = moved.select(gain.clamp(-most_gain, most_gain), self.pressure);
        let alone = moved & now.guess.output_nm.bits_eq(before.output_nm);
        if alone.any() {
            let most = MAX_SLIP_GAIN * now.guess.slip.abs() / now.guess.pressure_pa;
            let slope = ((now.guess.slip - before.slip) / step_pa).clamp(-most, most);
            self.slip_per_pa = alone.select(slope, self.slip_per_pa);
        }
    }

    /// Pressure at which the line through an evaluation meets its fixed point, Pa (CV-5).
    pub(super) fn pressure_pa(&self, now: &Point<R>) -> R {
        let p = now.guess.pressure_pa;
        p + (now.next_pressure_pa - p) / (1.0 - self.pressure)
    }
}

/// Secant on the output torque where the engine binds it.
pub(super) struct TorqueSecant<R: Real> {
    /// Belt ratio: without loss the slope of primary against output torque is its inverse.
    ratio: R,
    /// Output torque that is always allowed, Nm.
    allowed_nm: R,
    /// Output torque over that of the belt; `None` where they are one.
    over_belt: Option<R>,
    last: Option<(R, R)>,
}

#[physics]
impl<R: Real> TorqueSecant<R> {
    #[inline]
    pub fn new(ratio: R, first_nm: R, over_belt: Option<R>) -> Self {
        TorqueSecant {
            ratio,
            allowed_nm: first_nm.abs(),
            over_belt,
            last: None,
        }
    }

    /// Next output torque after an evaluation, and whether it moves no more for the bound
    /// of the belt: the belt carries no more than its capacity, whatever the engine could take or give (VA-2). `bound` where the engine binds it.
    pub fn next_nm(
        &mut self,
        now: &Point<R>,
        slopes: &mut Slopes<R>,
        plain: bool,
        bound: R::Mask,
    ) -> (R, R::Mask) {
        let (x, miss_nm) = (now.guess.output_nm, now.miss_nm);
        if let Some((x0, miss0)) = self.last {
            let moved = bound & (x - x0).abs().gt(SECANT_FROM_NM);
            if moved.any() {
                let slope = ((miss_nm - miss0) / (x - x0) * self.ratio).clamp(0.5, 2.0);
                slopes.torque = moved.select(slope, slopes.torque);
            }
        }
        self.last = Some((x, miss_nm));
        let slope = if plain { x.splat(1.0) } else { slopes.torque };
        let mut carried = 1.05 * now.torques.belt.capacity_nm;
        if let Some(over_belt) = self.over_belt {
            carried = carried * over_belt; // RG-4, RG-6
        }
        let carried = carried.max(self.allowed_nm);
        let next = (x - miss_nm * self.ratio / slope).clamp(-carried, carried); // CV-5
        (next, (1e-9 * carried).ge((next - x).abs()))
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
