//! A coupling with a part of its loss.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LC-6 | P_loss' = f P_loss, T_e' = T_e - (1 - f) P_loss/w_e, speeds and torques at the box as before; for f > 1 full load passes on less | derived: power balance of a coupling that loses a part; f = 0 passes power on at any ratio of speeds |

use super::{Coupling, CouplingLoad, EngineSide, Hold, Launch, LockSignals, Turning};

/// A coupling whose loss is multiplied by a factor.
#[derive(Clone, Debug)]
pub(crate) struct PartialLoss {
    inner: Launch,
    factor: f64,
}

impl PartialLoss {
    /// A coupling with its loss times a factor; itself for 1.
    pub fn of(inner: Launch, factor: f64) -> Launch {
        if (factor - 1.0).abs() > 0.0 {
            Launch::other(PartialLoss { inner, factor })
        } else {
            inner
        }
    }

    /// The engine's side with a part of the loss.
    fn part(&self, side: EngineSide) -> EngineSide {
        EngineSide {
            engine_nm: side.engine_nm - (1.0 - self.factor) * side.loss_w / side.engine_rad_s, // LC-6
            loss_w: self.factor * side.loss_w, // LC-6
            ..side
        }
    }
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
        if needed_nm > engine_nm && engine_nm > 0.0 {
            most_nm * engine_nm / needed_nm // LC-6
        } else {
            most_nm
        }
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
        Some(PartialLoss::of(inner, self.factor))
    }

    fn loss_factor(&self) -> f64 {
        self.factor * self.inner.loss_factor()
    }
}
