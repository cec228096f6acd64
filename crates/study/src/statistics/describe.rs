//! Outputs described: moments, quantiles and shares with their intervals.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DS-1 | mean = mean_0 + sum(x - mean_0) / n, mean_0 = sum(x) / n; sd^2 = (sum(d^2) - sum(d)^2 / n) / (n - 1), d = x - mean | source: two passes with correction, Chan, Golub and LeVeque 1983 |
//! | DS-2 | interval of the mean: mean -+ t(n - 1) sd / sqrt(n) | source: Student 1908 |
//! | DS-3 | quantile p = x_k + (h - k) (x_(k+1) - x_k), h = 1 + (n - 1) p, k = floor(h), x_1 <= x_2 <= ... | source: Hyndman and Fan 1996, type 7 |
//!
//! DS-2 and the intervals of quantiles and shares are made for independent draws. Points of a Latin hypercube or of a Sobol sequence fill
//! the space more evenly: there the true error is smaller, and the intervals are too wide rather than too narrow. Of a Saltelli design only
//! the rows of A and B may go in: the mixed rows repeat all values but one of A.

use std::ops::Deref;

use serde::Serialize;

use super::Confidence;
use super::intervals::{clopper_pearson, quantile_ranks, student};

/// An output in numbers; read through it, the fields of [`Spread`] are its own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Number, mean, spread and ends.
    #[serde(flatten)]
    pub spread: Spread,
    /// Quantiles at [`Confidence::quantiles`].
    pub quantiles: Vec<Quantile>,
    /// Interval of the mean.
    pub mean_interval: Option<[f64; 2]>,
}

impl Deref for Summary {
    type Target = Spread;

    fn deref(&self) -> &Spread {
        &self.spread
    }
}

/// One quantile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quantile {
    /// Probability of lying below it.
    pub p: f64,
    /// The quantile of the sample.
    pub value: f64,
    /// Interval of the quantile of the population, whatever the distribution: two values of the sample. `None` on a side on which the
    /// sample does not reach far enough to tell.
    pub interval: [Option<f64>; 2],
}

impl Summary {
    /// Describes a sample.
    pub fn of(values: &[f64], confidence: Confidence) -> Self {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
        let spread = Spread::of(values.iter().copied());
        sorted.sort_unstable_by(f64::total_cmp);
        let quantile = |p: f64| {
            let value = |at: Option<usize>| at.and_then(|i| sorted.get(i).copied());
            Quantile {
                p,
                value: quantile_of_sorted(&sorted, p),
                interval: quantile_ranks(spread.n, p, confidence.tail()).map(value),
            }
        };
        Summary {
            quantiles: confidence.quantiles().into_iter().map(quantile).collect(),
            mean_interval: spread.mean_interval(confidence),
            spread,
        }
    }

    /// The quantile at one of the probabilities that it was made for; NaN at any other probability.
    pub fn quantile(&self, p: f64) -> f64 {
        let found = self.quantiles.iter().find(|q| (q.p - p).abs() < 1e-9);
        found.map_or(f64::NAN, |q| q.value)
    }
}

/// What needs no order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Number of values.
    pub n: usize,
    /// Number of cells without a value.
    pub missing: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation of the population, from n - 1; NaN of fewer than two values.
    pub sd: f64,
    /// Least value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

impl Spread {
    /// Of all finite values.
    pub(super) fn of(values: impl Iterator<Item = f64> + Clone) -> Self {
        let finite = || values.clone().filter(|x| x.is_finite());
        let n = finite().count();
        let count = n as f64;
        let rough = finite().sum::<f64>() / count;
        let mean = rough + finite().map(|x| x - rough).sum::<f64>() / count; // DS-1
        let (sum, squares) = finite()
            .map(|x| x - mean)
            .fold((0.0, 0.0), |(s, q), d| (s + d, q + d * d));
        let sd = match n {
            0 | 1 => f64::NAN,
            _ => ((squares - sum * sum / count).max(0.0) / (count - 1.0)).sqrt(), // DS-1
        };
        Spread {
            n,
            missing: values.clone().count() - n,
            mean,
            sd,
            min: finite().fold(f64::NAN, |low, x| x.min(low)),
            max: finite().fold(f64::NAN, |high, x| x.max(high)),
        }
    }

    /// Interval of the mean, for independent values.
    pub(super) fn mean_interval(&self, confidence: Confidence) -> Option<[f64; 2]> {
        let count = self.n as f64;
        let half = student(count - 1.0, confidence.tail()) * self.sd / count.sqrt(); // DS-2
        half.is_finite()
            .then_some([self.mean - half, self.mean + half])
    }
}

/// Quantile of ascending finite values by DS-3; NaN of none.
pub fn quantile_of_sorted(sorted: &[f64], p: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let h = last as f64 * p.clamp(0.0, 1.0); // DS-3, counted from 0
    let k = (h.floor() as usize).min(last);
    let (low, high) = (sorted[k], sorted[(k + 1).min(last)]);
    low + (h - h.floor()) * (high - low) // DS-3
}

/// In how many of the cases something holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Number of cases in which it holds.
    pub k: usize,
    /// Number of cases in which it is known.
    pub n: usize,
    /// Number of cases in which it cannot, for there is no value.
    pub missing: usize,
    /// k / n; NaN of none.
    pub share: f64,
    /// Clopper and Pearson's interval of the probability; none of cases that are no sample.
    pub interval: Option<[f64; 2]>,
}

impl Share {
    /// The share of the values for which `holds`. Without a confidence the values are no sample.
    pub fn of(values: &[f64], confidence: Option<Confidence>, holds: impl Fn(f64) -> bool) -> Self {
        let known = || values.iter().filter(|x| x.is_finite());
        let n = known().count();
        let k = known().filter(|x| holds(**x)).count();
        Share {
            k,
            n,
            missing: values.len() - n,
            share: k as f64 / n as f64,
            interval: confidence.map(|confidence| clopper_pearson(k, n, confidence.tail())),
        }
    }

    /// The share of the values above zero: of a difference, in how many pairs the first one has more. Equal ones are not more.
    pub fn above_zero(values: &[f64], confidence: Option<Confidence>) -> Self {
        Self::of(values, confidence, |x| x > 0.0)
    }
}
