//! A coupling with a part of its loss.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LC-6 | P_loss' = f P_loss, T_e' = T_e - (1 - f) P_loss/w_e, speeds and torques at the box as before; for f > 1 full load passes on less | derived: power balance of a coupling that loses a part; f = 0 passes power on at any ratio of speeds |

use super::FrictionClutch;
use super::{Coupling, CouplingLoad, EngineSide, Hold, Launch, LockSignals, Turning};
use crate::math::{Gather, Mask, Real, physics};

/// The clutch of a manual box, which the driver opens, with factors on its loss.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct DriverClutch<R: Real = f64> {
    /// The clutch.
    pub clutch: FrictionClutch<R>,
    /// Factors on its loss, one after the other (LC-6).
    pub factors: Vec<R>,
}

impl<R: Real> DriverClutch<R> {
    /// A clutch that loses what its model says.
    pub(super) fn new(clutch: FrictionClutch<R>) -> Self {
        DriverClutch {
            clutch,
            factors: Vec::new(),
        }
    }
}

impl DriverClutch {
    /// Multiplies its loss by a factor.
    pub(crate) fn scale(&mut self, factor: f64) {
        if (factor - 1.0).abs() > 0.0 {
            self.factors.push(factor);
        }
    }
}

#[physics]
impl<R: Real> DriverClutch<R> {
    /// The engine's side with the first of the factors.
    fn side(
        &self,
        factors: usize,
        output_nm: R,
        [output_rad_s, engine_rad_s]: [R; 2],
    ) -> EngineSide<R> {
        let mut side = (self.clutch).engine_side(output_nm, output_rad_s, engine_rad_s);
        for factor in &self.factors[..factors] {
            side = side.with_loss_times(*factor);
        }
        side
    }
}

#[physics]
impl<R: Real> Coupling<R> for DriverClutch<R> {
    fn engine_rad_s(&self, load: &CouplingLoad<R>) -> R {
        self.clutch.engine_rad_s(load)
    }

    fn locked_from_rad_s(&self, idle_rad_s: R) -> R {
        self.clutch.locked_from_rad_s(idle_rad_s)
    }

    fn engine_side(&self, output_nm: R, output_rad_s: R, engine_rad_s: R) -> EngineSide<R> {
        self.side(self.factors.len(), output_nm, [output_rad_s, engine_rad_s])
    }

    /// A clutch without loss does not pass on more at full load; one with more loss passes on less, in proportion.
    fn output_nm(&self, engine_nm: R, output_rad_s: R, engine_rad_s: R) -> R {
        let mut most_nm = (self.clutch).output_nm(engine_nm, output_rad_s, engine_rad_s);
        for number in 0..self.factors.len() {
            let needed = self.side(number + 1, most_nm, [output_rad_s, engine_rad_s]);
            most_nm = passed_nm(most_nm, needed.engine_nm, engine_nm);
        }
        most_nm
    }

    fn creep_nm(&self, output_rad_s: R, idle_rad_s: R) -> R {
        self.clutch.creep_nm(output_rad_s, idle_rad_s)
    }

    fn overrun_share(&self, output_rad_s: R, idle_rad_s: R) -> R {
        self.clutch.overrun_share(output_rad_s, idle_rad_s)
    }

    #[inline]
    fn at_least_speed(&self) -> Option<Launch<R>> {
        Some(Launch::Clutch(DriverClutch {
            clutch: self.clutch.of_least_speed(),
            factors: self.factors.clone(),
        }))
    }

    fn loss_factor(&self) -> Option<R> {
        let (first, others) = self.factors.split_first()?;
        let mut product = *first;
        for factor in others {
            product = *factor * product;
        }
        Some(product)
    }
}

/// A coupling whose loss is multiplied by a factor.
#[derive(Clone, Debug)]
pub(crate) struct PartialLoss {
    inner: Launch,
    factor: f64,
}

impl PartialLoss {
    /// A coupling with its loss times a factor; itself for 1.
    pub fn scaled(inner: Launch, factor: f64) -> Launch {
        match inner {
            Launch::Clutch(mut clutch) => {
                clutch.scale(factor);
                Launch::Clutch(clutch)
            }
            inner if (factor - 1.0).abs() > 0.0 => Launch::other(PartialLoss { inner, factor }),
            inner => inner,
        }
    }

    /// The engine's side with a part of the loss.
    fn part(&self, side: EngineSide) -> EngineSide {
        side.with_loss_times(self.factor)
    }
}

#[physics]
impl<R: Real> EngineSide<R> {
    /// The engine's side with the loss times a factor.
    fn with_loss_times(self, factor: R) -> Self {
        EngineSide {
            engine_nm: self.engine_nm - (1.0 - factor) * self.loss_w / self.engine_rad_s, // LC-6
            loss_w: factor * self.loss_w,                                                 // LC-6
            ..self
        }
    }
}

/// Torque into the box, Nm, of which the engine gives no more than its own, where it would need another.
#[physics]
fn passed_nm<R: Real>(most_nm: R, needed_nm: R, engine_nm: R) -> R {
    let lacks = needed_nm.gt(engine_nm) & engine_nm.gt(engine_nm.splat(0.0));
    lacks.select(most_nm * engine_nm / needed_nm, most_nm) // LC-6
}

impl Coupling for PartialLoss {
    fn engine_rad_s(&self, load: &CouplingLoad) -> f64 {
        self.inner.engine_rad_s(load)
    }

    fn min_engine_rad_s(&self, output_rad_s: f64) -> f64 {
        self.inner.min_engine_rad_s(output_rad_s)
    }

    fn locked_from_rad_s(&self, idle_rad_s: f64) -> f64 {
        self.inner.locked_from_rad_s(idle_rad_s)
    }

    fn by_command(&self) -> bool {
        self.inner.by_command()
    }

    fn hold(&self, now: &LockSignals, past: bool) -> Hold {
        self.inner.hold(now, past)
    }

    fn locked_side(&self, output_nm: f64, output_rad_s: f64, slip_rad_s: f64) -> EngineSide {
        let inner = &self.inner;
        self.part(inner.locked_side(output_nm, output_rad_s, slip_rad_s))
    }

    fn engine_side(&self, output_nm: f64, output_rad_s: f64, engine_rad_s: f64) -> EngineSide {
        let inner = &self.inner;
        self.part(inner.engine_side(output_nm, output_rad_s, engine_rad_s))
    }

    /// A coupling without loss does not pass on more at full load; one with more loss passes on less, in proportion.
    fn output_nm(&self, engine_nm: f64, output_rad_s: f64, engine_rad_s: f64) -> f64 {
        let most_nm = self.inner.output_nm(engine_nm, output_rad_s, engine_rad_s);
        let needed_nm = self
            .engine_side(most_nm, output_rad_s, engine_rad_s)
            .engine_nm;
        passed_nm(most_nm, needed_nm, engine_nm)
    }

    fn creep_nm(&self, output_rad_s: f64, idle_rad_s: f64) -> f64 {
        self.inner.creep_nm(output_rad_s, idle_rad_s)
    }

    fn overrun_share(&self, output_rad_s: f64, idle_rad_s: f64) -> f64 {
        self.inner.overrun_share(output_rad_s, idle_rad_s)
    }

    fn min_output_nm(&self, at: &Turning, absorbed_nm: f64) -> f64 {
        self.inner.min_output_nm(at, absorbed_nm)
    }

    fn device(&self) -> &'static str {
        self.inner.device()
    }

    fn at_least_speed(&self) -> Option<Launch> {
        let inner = self.inner.at_least_speed()?;
        Some(PartialLoss::scaled(inner, self.factor))
    }

    fn loss_factor(&self) -> Option<f64> {
        Some(self.factor * self.inner.loss_factor().unwrap_or(1.0))
    }
}
