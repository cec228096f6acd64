//! Pictures of the statistics of studies.
//!
//! Data come in the units that the axes name. Names that do not fit are cut in the middle; the full name shows up under the pointer.
//! Legend and notes stand below the plots.

mod bars;
mod convergence;
mod distribution;
mod effects;
mod rows;
pub(super) mod text;
mod tornado;

pub use bars::{RankPlot, SobolPlot, rank_plot, sobol_plot};
pub use convergence::{ConvergencePlot, convergence_plot};
pub use distribution::{DistributionPlot, DistributionSeries, distribution_plot};
pub use effects::{EffectFactor, EffectsPlot, effects_plot};
pub use tornado::{TornadoPlot, tornado_plot};

/// Width of the pictures, pixels: on A4 their text is still read.
const WIDTH: f64 = 880.0;
/// Right edge of their plots.
const RIGHT: f64 = WIDTH - 28.0;

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
        if self.unit.is_empty() {
            what.to_owned()
        } else {
            format!("{what} [{}]", self.sign())
        }
    }

    /// The unit after a number.
    fn after(&self) -> String {
        if matches!(self.unit, "" | "-") {
            String::new()
        } else {
            format!("\u{a0}{}", self.sign().replace(' ', "\u{a0}"))
        }
    }

    /// The unit as it is written.
    fn sign(&self) -> &str {
        sign(self.unit)
    }

    /// A column of a table in this output's unit.
    fn column(&self, name: impl Into<String>) -> (String, &'static str) {
        column(name.into(), self.unit)
    }
}

pub(super) fn sign(unit: &str) -> &str {
    if unit == "degC" { "\u{b0}C" } else { unit }
}

/// Name and unit of a column; a unit that no output of the program has is part of the name.
fn column(name: String, unit: &str) -> (String, &'static str) {
    const KNOWN: [&str; 11] = [
        "L/100 km", "%", "g/km", "km", "s", "g", "kJ", "\u{b0}C", "rpm", "bar", "Nm",
    ];
    match (unit, KNOWN.into_iter().find(|known| *known == sign(unit))) {
        ("" | "-", _) => (name, ""),
        (_, Some(known)) => (name, known),
        _ => (format!("{name} [{}]", sign(unit)), ""),
    }
}

/// The words with a capital first letter.
fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// The two ends of an interval as cells; empty without one.
fn interval_cells(interval: Option<[f64; 2]>, step: f64) -> [String; 2] {
    interval.map_or_else(Default::default, |ends| ends.map(|x| super::cell(x, step)))
}
