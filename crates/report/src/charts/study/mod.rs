//! Pictures of the statistics of studies.
//!
//! Data are in the units of the axes. Names that do not fit are cut in the middle; the full name shows as a tooltip.

mod bars;
mod convergence;
mod distribution;
mod effects;
mod tornado;

pub use bars::{rank_plot, sobol_plot};
pub use convergence::convergence_plot;
pub use distribution::{DistributionSeries, KnownValue, distribution_plot};
pub use effects::{EffectFactor, effects_plot};
pub use tornado::tornado_plot;

use super::engine::{PLOT_LEFT, Point, WIDTH, number, optional_cell, round_step};
use crate::number::{sign, with_unit};
use cvtcycle_study::statistics::{Confidence, Estimate};

/// Right edge of the plots, and their width, pixels.
const RIGHT: f64 = WIDTH - 28.0;
const WIDE: f64 = RIGHT - PLOT_LEFT;
/// Left edge and width of blocks below plots, and below rows, pixels.
const FOOT: Point = (PLOT_LEFT, WIDE);
const WIDE_FOOT: Point = (MARGIN, RIGHT - MARGIN);
/// Left edge of titles, legends and notes of pictures with rows, pixels.
const MARGIN: f64 = 12.0;
/// Height of a row, pixels.
const ROW: f64 = 27.0;
/// Maximum number of rows that fit on a page.
const MAX_ROWS: usize = 30;

/// Subject of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shown<'a> {
    /// Name of the output for people: `Fuel, total`.
    pub output: &'a str,
    /// Unit; `-` or empty without one.
    pub unit: &'a str,
    /// The study: cars, cycle, number of runs.
    pub subject: &'a str,
    /// Confidence of all intervals.
    pub confidence: Confidence,
}

impl Shown<'_> {
    /// Axis title of this output, or of another quantity in its unit.
    fn axis(&self, what: &str) -> String {
        with_unit(what, self.unit)
    }

    /// The unit after a number.
    fn after(&self) -> String {
        if matches!(self.unit, "" | "-") {
            String::new()
        } else {
            format!("\u{a0}{}", sign(self.unit).replace(' ', "\u{a0}"))
        }
    }

    /// A column of a table in this output's unit.
    fn column(&self, name: impl Into<String>) -> (String, &'static str) {
        column(name.into(), self.unit)
    }
}

/// Name and unit of a column; an unknown unit becomes part of the name.
fn column(name: String, unit: &str) -> (String, &'static str) {
    const KNOWN: [&str; 11] = [
        "L/100 km", "%", "g/km", "km", "s", "g", "kJ", "\u{b0}C", "rpm", "bar", "Nm",
    ];
    match (
        unit,
        KNOWN.into_iter().find(|known| sign(known) == sign(unit)),
    ) {
        ("" | "-", _) => (name, ""),
        (_, Some(known)) => (name, known),
        _ => (with_unit(&name, unit), ""),
    }
}

/// Columns of an estimate: the estimate and the two ends of its interval.
fn estimate_columns(name: &str, confidence: Confidence) -> [(String, &'static str); 3] {
    let level = confidence.percent();
    let ends = [format!("{name}: {level} % from"), format!("{name}: to")];
    let [from, to] = ends.map(|name| (name, ""));
    [(name.to_owned(), ""), from, to]
}

/// Cells of an estimate and the two ends of its interval; empty without one.
fn estimate_cells(estimate: &Estimate) -> [String; 3] {
    let ends = estimate.interval;
    let [from, to] = [0, 1].map(|k| ends.map(|ends| ends[k]));
    [Some(estimate.value), from, to].map(|x| optional_cell(x, 1e-3))
}

/// Sorts by descending size, unknown sizes last.
fn by_size<T>(list: &mut [T], size: impl Fn(&T) -> f64) {
    list.sort_by(|a, b| {
        let last = size(a).is_nan().cmp(&size(b).is_nan());
        last.then(size(b).total_cmp(&size(a)))
    });
}

/// Formats a value with the digits that its spread supports.
pub(crate) fn value(x: f64, spread: f64) -> String {
    if !x.is_finite() {
        return "not known".to_owned();
    }
    let wide = spread.is_finite() && spread > 1e-12 * x.abs();
    let scale = if wide { spread } else { x.abs().max(1e-300) };
    number(x, round_step(scale / 200.0))
}

/// Formats a share of 0 to 1 in percent, with one decimal; more close to an end.
fn percent(share: f64) -> String {
    let off = share.min(1.0 - share);
    let decimals = if off > 0.0 && off < 0.001 { 3 } else { 1 };
    format!("{:.decimals$}", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_follow_the_spread() {
        assert_eq!(value(7.214_3, 0.9), "7.214");
        assert_eq!(value(-0.5, 0.0), "\u{2212}0.500");
        assert_eq!(value(1234.0, 800.0), "1234");
        assert_eq!(value(f64::NAN, 1.0), "not known");
        assert_eq!(
            (
                percent(0.934_2).as_str(),
                percent(0.999_7).as_str(),
                percent(1.0).as_str()
            ),
            ("93.4", "99.970", "100.0")
        );
    }
}
