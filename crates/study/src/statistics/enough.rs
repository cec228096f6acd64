//! Whether a sample is large enough for what is asked of it.
//!
//! | label | statement | status |
//! |---|---|---|
//! | ES-1 | the median of n draws has an interval of 95 % from n = 6 on: 2 (1/2)^n <= 0.05 | derived from IV-3 |
//! | ES-2 | where all n draws agree, at least 0.025^(1/n) of all would: 90 % from n = 36 on | derived from IV-2 |
//! | ES-3 | the 5 % and 95 % points have an interval of their own from n = 72 on: 0.95^n <= 0.025 | derived from IV-3 |

use serde::Serialize;

use super::intervals::{clopper_pearson, quantile_ranks};

/// Share of cases that "in nearly all" means.
const NEARLY_ALL: f64 = 0.9;
/// The points between which 90 % of the draws lie.
const LOW: f64 = 0.05;

/// What a number of draws can tell.
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
    /// Of a number of draws.
    pub fn of(n: usize) -> Self {
        let reaches = |p: f64| n > 0 && quantile_ranks(n, p)[0].is_some();
        let at_most_shown = clopper_pearson(n, n)[0];
        Enough {
            n,
            median: reaches(0.5),
            nearly_all: at_most_shown >= NEARLY_ALL,
            ends: reaches(LOW),
            at_most_shown,
        }
    }

    /// What it cannot tell, a sentence each; nothing of enough draws.
    pub fn doubts(&self) -> Vec<String> {
        let n = self.n;
        if n < 2 {
            return vec!["no draws: nothing is known of the certainty".to_owned()];
        }
        let percent = (100.0 * self.at_most_shown).floor();
        let doubts = [
            (
                self.median,
                format!("{n} draws give no interval of a median: 6 do"),
            ),
            (
                self.nearly_all,
                format!(
                    "{n} draws that agree show no more than that {percent} % of all do: 36 show 90 %"
                ),
            ),
            (
                self.ends,
                format!("the 5 % and 95 % points of {n} draws have no interval: those of 72 do"),
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
        let at = |n: usize| Enough::of(n);
        assert!(!at(5).median && at(6).median);
        assert!(!at(35).nearly_all && at(36).nearly_all);
        assert!(!at(71).ends && at(72).ends);
        assert!((at(16).at_most_shown - 0.025_f64.powf(1.0 / 16.0)).abs() < 1e-9);
        assert_eq!(
            [1, 5, 16, 71, 72].map(|n| at(n).doubts().len()),
            [1, 3, 2, 1, 0]
        );
        assert!(at(16).doubts()[0].contains("79 %"));
    }
}
