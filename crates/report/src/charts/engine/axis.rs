//! Axes: a range, ticks and their labels.

use crate::number::minus;

/// An axis.
#[derive(Clone, Debug, Default)]
pub(crate) struct Axis {
    /// Title with its unit.
    pub title: String,
    /// Value at the left or lower end.
    pub low: f64,
    /// Value at the right or upper end.
    pub high: f64,
    /// Ticks with their labels, ascending.
    pub ticks: Vec<(f64, String)>,
}

impl Axis {
    /// An axis over all finite `values`, its ends on round numbers, or half-way between two where data would run along the frame. Data may touch
    /// an end at zero.
    pub fn round(title: &str, values: impl Iterator<Item = f64>, max_ticks: usize) -> Self {
        let (low, high) = range(values).unwrap_or((0.0, 1.0));
        let (low, high) = widened(low, high);
        let step = round_step((high - low) / max_ticks.max(2) as f64);
        let first = (low / step + 1e-9).floor();
        let last = (high / step - 1e-9).ceil();
        let near = |end: f64, value: f64| value.abs() > 0.0 && (end - value).abs() < 0.1 * step;
        let half = |end: f64, value: f64| if near(end * step, value) { 0.5 } else { 0.0 };
        let (low, high) = (first - half(first, low), last + half(last, high));
        Self::with_step(title, low * step, high * step, step)
    }

    /// An axis whose ends are those of the data, with ticks on round numbers between them.
    pub fn exact(title: &str, low: f64, high: f64, max_ticks: usize) -> Self {
        let ordered = low.is_finite() && high.is_finite() && low < high;
        let (low, high) = if ordered { (low, high) } else { (0.0, 1.0) };
        let (low, high) = widened(low, high);
        let step = round_step((high - low) / max_ticks.max(2) as f64);
        Self::with_step(title, low, high, step)
    }

    fn with_step(title: &str, low: f64, high: f64, step: f64) -> Self {
        let first = (low / step - 1e-9).ceil();
        let count = ((high - first * step) / step + 1e-9).floor();
        let count = count.clamp(0.0, 50.0) as i32;
        // Adding zero turns a negative zero into a plain one.
        let ticks = (0..=count)
            .map(|i| (first + f64::from(i)) * step + 0.0)
            .map(|value| (value, number(value, step)))
            .collect();
        Self::labelled(title, (low, high), ticks)
    }

    /// An axis without ticks, for labels drawn by other means.
    pub fn bare(low: f64, high: f64) -> Self {
        Axis {
            low,
            high,
            ..Axis::default()
        }
    }

    /// An axis with labels at given values.
    pub fn labelled(title: &str, (low, high): (f64, f64), ticks: Vec<(f64, String)>) -> Self {
        Axis {
            title: title.to_owned(),
            low,
            high,
            ticks,
        }
    }

    /// Relative position of a value between the ends, 0 to 1.
    pub fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }
}

/// Minimum and maximum finite value.
pub(crate) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .filter(|x| x.is_finite())
        .fold(None, |range, x| match range {
            None => Some((x, x)),
            Some((low, high)) => Some((low.min(x), high.max(x))),
        })
}

/// Formats a number with the decimals needed to distinguish neighbours at this step.
pub(crate) fn number(value: f64, step: f64) -> String {
    if step < 1e-4 && value.abs() < 1e-9 * step {
        return "0".to_owned();
    }
    if value.abs() >= 1e7 || step < 1e-4 {
        // Digits needed to distinguish neighbours.
        let digits = (value.abs().log10() + 1e-9).floor() - (step.log10() + 1e-9).floor();
        let digits = digits.clamp(1.0, 12.0) as usize;
        return format!("{value:.digits$e}");
    }
    let decimals = (-(step.log10() + 1e-9).floor()).clamp(0.0, 5.0) as usize;
    minus(&format!("{value:.decimals$}"))
}

/// Formats a cell with the decimals needed at this step; empty if not finite.
pub fn cell(value: f64, step: f64) -> String {
    if value.is_finite() {
        number(value, step)
    } else {
        String::new()
    }
}

/// As [`cell`], for a number that may be missing.
pub(crate) fn optional_cell(value: Option<f64>, step: f64) -> String {
    cell(value.unwrap_or(f64::NAN), step)
}

/// 1, 2 or 5 times a power of ten, not below `x`.
pub(crate) fn round_step(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let factor = x / power;
    let round = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|f| factor <= f * (1.0 + 1e-9));
    power * round.unwrap_or(10.0)
}

/// Widens a range too narrow to divide by.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    if high - low > 1e-9 * size {
        (low.max(-1e290), high.min(1e290))
    } else if size < 1e-300 {
        (0.0, 1.0)
    } else {
        (low.clamp(-1e290, 0.0), high.clamp(0.0, 1e290))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_ends() {
        let axis = Axis::exact("t", 0.0, 1180.0, 8);
        let places = |axis: &Axis| axis.ticks.iter().map(|tick| tick.0).collect::<Vec<_>>();
        assert_eq!(places(&axis), [0.0, 200.0, 400.0, 600.0, 800.0, 1000.0]);
        assert_eq!(axis.ticks[1].1, "200");
        let axis = Axis::round("T", [-7.0, 91.0].into_iter(), 6);
        assert_eq!(
            axis.ticks.first().zip(axis.ticks.last()),
            Some((
                &(-20.0, "\u{2212}20".to_owned()),
                &(100.0, "100".to_owned())
            ))
        );
        let axis = Axis::round("I", [0.44, 2.31].into_iter(), 5);
        assert_eq!(axis.ticks[0].1, "0.0");
        // Neighbours differ, even if the step is tiny relative to the values.
        let label = |value, step| number(value, step);
        assert_eq!(
            [label(7.0, 1e-5), label(7.000_01, 1e-5)],
            ["7.00000e0", "7.00001e0"]
        );
        assert_eq!(
            [label(0.0, 5e-8), label(7.5e-7, 5e-8), label(2e7, 1e7)],
            ["0", "7.5e-7", "2.0e7"]
        );
    }

    #[test]
    fn any_range_makes_an_axis() {
        for (low, high) in [
            (0.0, 0.0),
            (5.0, 5.0),
            (-3.0, -3.0),
            (f64::MIN, f64::MAX),
            (0.0, 1e-320),
            (1e16, 1e16),
        ] {
            let axis = Axis::round("x", [low, high, f64::NAN, f64::INFINITY].into_iter(), 5);
            assert!(axis.high > axis.low && !axis.ticks.is_empty() && axis.ticks.len() < 60);
            assert!(
                axis.low.is_finite() && axis.high.is_finite() && (axis.high - axis.low).is_finite()
            );
        }
        assert!(Axis::round("x", std::iter::empty(), 5).high > 0.5);
    }
}
