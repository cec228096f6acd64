//! How sure intervals are, and how much of a sample lies between the ends that are printed of it.

use cvtcycle_output::number::plain;
use serde::Serialize;

/// Quantiles of every summary.
const QUANTILES: [f64; 7] = [0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975];

/// Two probabilities: of intervals, which say how well an estimate is known, and of the draws between two quantiles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Confidence {
    /// Probability with which an interval holds the truth.
    pub intervals: f64,
    /// Share of the draws between the two ends that are printed of an output.
    pub draws: f64,
}

impl Default for Confidence {
    fn default() -> Self {
        Confidence {
            intervals: 0.95,
            draws: 0.9,
        }
    }
}

impl Confidence {
    /// The same probability for both; above 0 and below 1.
    pub fn from_level(level: f64) -> Self {
        Confidence {
            intervals: level,
            draws: level,
        }
    }

    /// Half of what an interval leaves out.
    pub(super) fn tail(self) -> f64 {
        outside(self.intervals)
    }

    /// Probabilities of the two quantiles between which that share of the draws lies.
    pub fn ends(self) -> [f64; 2] {
        let low = outside(self.draws);
        [low, 1.0 - low]
    }

    /// Confidence of intervals, per cent: `95`.
    pub fn percent(self) -> String {
        of_hundred(self.intervals)
    }

    /// Share of the draws between the two ends, per cent: `90`.
    pub fn draws_percent(self) -> String {
        of_hundred(self.draws)
    }

    /// Probabilities of the quantiles of a summary, ascending.
    pub fn quantiles(self) -> Vec<f64> {
        let mut list = QUANTILES.to_vec();
        let is_new = |p: &f64| QUANTILES.iter().all(|known| (known - p).abs() > 1e-9);
        list.extend(self.ends().into_iter().filter(is_new));
        list.sort_unstable_by(f64::total_cmp);
        list
    }
}

/// Per cent, without the rounding of the product.
pub fn of_hundred(p: f64) -> String {
    const DIGITS: f64 = 1e9;
    plain((100.0 * p * DIGITS).round() / DIGITS)
}

/// Half of the rest to 1, without the rounding of the difference: 0.025 of 0.95.
fn outside(level: f64) -> f64 {
    const DIGITS: f64 = 1e12;
    ((1.0 - level) / 2.0 * DIGITS).round() / DIGITS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_what_tables_of_statistics_have() {
        let usual = Confidence::default();
        assert_eq!(usual.tail().to_bits(), 0.025_f64.to_bits());
        assert_eq!(
            usual.ends().map(f64::to_bits),
            [0.05, 0.95].map(f64::to_bits)
        );
        assert_eq!(usual.quantiles(), QUANTILES);
        assert_eq!([usual.percent(), usual.draws_percent()], ["95", "90"]);
        assert_eq!(Confidence::from_level(0.999).percent(), "99.9");
        let given = Confidence::from_level(0.8);
        assert_eq!(given.ends().map(f64::to_bits), [0.1, 0.9].map(f64::to_bits));
        assert_eq!(given.quantiles()[2..8], [0.1, 0.25, 0.5, 0.75, 0.9, 0.95]);
        assert_eq!(Confidence::from_level(0.95).quantiles(), QUANTILES);
    }
}
