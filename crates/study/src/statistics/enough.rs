//! Sample sizes that the statistics need.
//!
//! | label | statement | status |
//! |---|---|---|
//! | ES-1 | the median of n draws has an interval from the n of IV-4 on: 6 of 95 % | derived from IV-4 |
//! | ES-2 | where all n draws agree, at least a^(1/n) of all would, a the tail of the confidence: 90 % from n = 36 on with 95 % | derived from IV-2 |
//! | ES-3 | the two ends have an interval of their own from the n of IV-4 on: the 5 % and 95 % points from n = 72 on with 95 % | derived from IV-4 |

use serde::Serialize;

use super::confidence::{Confidence, of_hundred};
use super::intervals::{clopper_pearson, least_draws};

/// Share of cases that "in nearly all" means.
const NEARLY_ALL: f64 = 0.9;

/// Statements that a number of draws allows.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Enough {
    /// Draws.
    pub n: usize,
    /// An interval of the median (ES-1).
    pub median: bool,
    /// That something holds in 90 % of all cases, if it holds in all draws (ES-2).
    pub nearly_all: bool,
    /// Intervals of the 5 % and 95 % points (ES-3).
    pub ends: bool,
    /// Share of all cases in which something holds at least that holds in all draws.
    pub at_most_shown: f64,
}

impl Enough {
    /// Evaluates ES-1 to ES-3 for a number of draws.
    pub fn from_draws(n: usize, confidence: Confidence) -> Self {
        let reaches = |p: f64| n >= least_draws(p, confidence);
        let at_most_shown = match n {
            0 => 0.0,
            n => clopper_pearson(n, n, confidence.tail())[0],
        };
        Enough {
            n,
            median: reaches(0.5),
            nearly_all: at_most_shown >= NEARLY_ALL,
            ends: reaches(confidence.ends()[0]),
            at_most_shown,
        }
    }

    /// Lists statements that the draws do not allow, a sentence each; empty if there are enough.
    pub fn doubts(&self, confidence: Confidence) -> Vec<String> {
        let n = self.n;
        if n < 2 {
            return vec!["no varied runs: nothing is known of the certainty".to_owned()];
        }
        let percent = (100.0 * self.at_most_shown).floor();
        let [low, high] = confidence.ends();
        let least = |p: f64| least_draws(p, confidence);
        let (ends, nearly) = ([low, high].map(of_hundred), of_hundred(NEARLY_ALL));
        let doubts = [
            (
                self.median,
                format!(
                    "{n} varied runs give no interval of a median: {} do",
                    least(0.5)
                ),
            ),
            (
                self.nearly_all,
                format!(
                    "{n} varied runs that agree show no more than that {percent} % of all do: {} show {nearly} %",
                    least(NEARLY_ALL)
                ),
            ),
            (
                self.ends,
                format!(
                    "the {} % and {} % points of {n} varied runs have no interval: those of {} do",
                    ends[0],
                    ends[1],
                    least(low)
                ),
            ),
        ];
        let unmet = doubts.into_iter().filter(|(met, _)| !met);
        unmet.map(|(_, doubt)| doubt).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: ES-1 to ES-3 by hand: 2 (1/2)^5 > 0.05 >= 2 (1/2)^6, 0.025^(1/35) < 0.9 <= 0.025^(1/36), 0.95^71 > 0.025 >= 0.95^72.
    #[test]
    fn val_least_numbers_of_draws() {
        let usual = Confidence::default();
        let at = |n: usize| Enough::from_draws(n, usual);
        assert!(!at(5).median && at(6).median);
        assert!(!at(35).nearly_all && at(36).nearly_all);
        assert!(!at(71).ends && at(72).ends);
        assert!((at(16).at_most_shown - 0.025_f64.powf(1.0 / 16.0)).abs() < 1e-9);
        assert_eq!(
            [1, 5, 16, 71, 72].map(|n| at(n).doubts(usual).len()),
            [1, 3, 2, 1, 0]
        );
        assert!(at(16).doubts(usual)[0].contains("79 %"));
    }
}
