//! Pictures of the statistics of studies.
//!
//! Data come in the units that the axes name. Names that do not fit are cut in the middle; the full name shows up under the pointer.

mod bars;
mod convergence;
mod distribution;
mod effects;
mod rows;
mod text;
mod tornado;

pub use bars::{RankPlot, SobolPlot, rank_plot, sobol_plot};
pub use convergence::{ConvergencePlot, convergence_plot};
pub use distribution::{DistributionPlot, DistributionSeries, distribution_plot};
pub use effects::{EffectFactor, EffectsPlot, effects_plot};
pub use tornado::{TornadoPlot, tornado_plot};

/// What a picture shows, and of what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shown<'a> {
    /// The output, as people name it: `Fuel, total`.
    pub output: &'a str,
    /// Its unit; `-` or empty without one.
    pub unit: &'a str,
    /// The study: cars, cycle, number of runs.
    pub subject: &'a str,
}

impl Shown<'_> {
    /// Title of an axis of this output, or of something else of its unit.
    fn axis(&self, what: &str) -> String {
        if self.unit.is_empty() { what.to_owned() } else { format!("{what} [{}]", self.unit) }
    }

    /// The unit after a number.
    fn after(&self) -> String {
        if matches!(self.unit, "" | "-") { String::new() } else { format!("\u{a0}{}", self.unit.replace(' ', "\u{a0}")) }
    }
}
