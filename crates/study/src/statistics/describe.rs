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
use super::order::{Ordered, between};
use super::passes::{Moments, Numbers, each};
use super::spread::Spread;

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
    pub fn new(values: &[f64], confidence: Confidence) -> Self {
        let Ok(summary) = Self::over(values, confidence);
        summary
    }

    /// Describes a sample that is not in memory: in a few passes over it.
    ///
    /// # Errors
    /// Numbers that cannot be had.
    pub fn over<P: Numbers + ?Sized>(values: &P, confidence: Confidence) -> Result<Self, P::Error> {
        let spread = Spread::over(values)?;
        let ranks = |p: &f64| (*p, quantile_ranks(spread.n, *p, confidence.tail()));
        let wanted: Vec<_> = confidence.quantiles().iter().map(ranks).collect();
        let places = wanted.iter().flat_map(|(p, ends)| {
            let own = between(spread.n, *p).map(|(low, high, _)| [low, high]);
            own.into_iter()
                .flatten()
                .chain(ends.iter().copied().flatten())
        });
        let ordered = Ordered::new(values, &spread, places)?;
        let quantile = |(p, ends): &(f64, [Option<usize>; 2])| Quantile {
            p: *p,
            value: ordered.quantile(*p),
            interval: ends.map(|at| at.and_then(|place| ordered.at(place))),
        };
        Ok(Summary {
            quantiles: wanted.iter().map(quantile).collect(),
            mean_interval: spread.mean_interval(confidence),
            spread,
        })
    }

    /// The quantile at one of the probabilities that it was made for; NaN at any other probability.
    pub fn quantile(&self, p: f64) -> f64 {
        let found = self.quantiles.iter().find(|q| (q.p - p).abs() < 1e-9);
        found.map_or(f64::NAN, |q| q.value)
    }
}

impl Spread {
    /// Computes the moments of all finite values.
    pub(super) fn over<P: Numbers + ?Sized>(values: &P) -> Result<Self, P::Error> {
        Moments::compute(values)
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
    let Some((k, next, share)) = between(sorted.len(), p) else {
        return f64::NAN;
    };
    sorted[k] + share * (sorted[next] - sorted[k]) // DS-3
}

/// Quantiles by DS-3 of a sample that is not in memory.
///
/// # Errors
/// Numbers that cannot be had.
pub fn quantiles<P: Numbers + ?Sized>(
    values: &P,
    spread: &Spread,
    probabilities: &[f64],
) -> Result<Vec<f64>, P::Error> {
    let places = probabilities.iter().filter_map(|p| between(spread.n, *p));
    let places = places.flat_map(|(low, high, _)| [low, high]);
    let ordered = Ordered::new(values, spread, places)?;
    Ok(probabilities.iter().map(|p| ordered.quantile(*p)).collect())
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
    pub fn new(
        values: &[f64],
        confidence: Option<Confidence>,
        holds: impl Fn(f64) -> bool,
    ) -> Self {
        let Ok(share) = Self::over(values, confidence, holds);
        share
    }

    /// Counts over values that are not in memory.
    ///
    /// # Errors
    /// Numbers that cannot be had.
    pub fn over<P: Numbers + ?Sized>(
        values: &P,
        confidence: Option<Confidence>,
        holds: impl Fn(f64) -> bool,
    ) -> Result<Self, P::Error> {
        let (mut k, mut n, mut missing) = (0, 0, 0);
        each(values, |x| match x.is_finite() {
            true => {
                n += 1;
                k += usize::from(holds(x));
            }
            false => missing += 1,
        })?;
        Ok(Share {
            k,
            n,
            missing,
            share: k as f64 / n as f64,
            interval: confidence.map(|confidence| clopper_pearson(k, n, confidence.tail())),
        })
    }

    /// The share of the values above zero: of a difference, in how many pairs the first one has more. Equal ones are not more.
    pub fn above_zero(values: &[f64], confidence: Option<Confidence>) -> Self {
        Self::new(values, confidence, is_above_zero)
    }

    /// Counts over values that are not in memory.
    ///
    /// # Errors
    /// Numbers that cannot be had.
    pub fn over_zero<P: Numbers + ?Sized>(
        values: &P,
        confidence: Option<Confidence>,
    ) -> Result<Self, P::Error> {
        Self::over(values, confidence, is_above_zero)
    }
}

fn is_above_zero(x: f64) -> bool {
    x > 0.0
}
