//! Distributions of a factor: value at a probability, mean, standard deviation, ends.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PD-1 | normal: x = mean + sd z(u), z the inverse of the standard normal distribution | source: Johnson, Kotz, Balakrishnan, Continuous Univariate Distributions 1, ch. 13 |
//! | PD-2 | truncated normal: z between a = (low - mean)/sd and b = (high - mean)/sd from N(z) = N(a) + u (N(b) - N(a)); in the upper half from N(-z) = N(-b) + (1 - u)(N(-a) - N(-b)), which keeps its digits there | source: the same; second form derived |
//! | PD-3 | uniform: x = low + u (high - low) | source: the same, vol. 2, ch. 26 |
//! | PD-4 | triangular: x = low + sqrt(u (high - low)(mode - low)) up to u = (mode - low)/(high - low), x = high - sqrt((1 - u)(high - low)(high - mode)) from there | derived: integral of the density |
//! | PD-5 | lognormal: x = median exp(s z(u)), s = ln g; mean = median exp(s2/2), sd = mean sqrt(exp(s2) - 1) | source: the same, vol. 1, ch. 14 |
//! | PD-6 | mean and variance of the truncated normal: Simpson's rule over density times z, about the mean; the closed form loses its digits in narrow cuts and far tails | derived |
//!
//! Symbols: u probability, g geometric standard deviation, N the standard normal distribution. All in the unit of the factor.

use statrs::distribution::{ContinuousCDF, Normal};

use super::{Acts, Distribution};

/// Halves of the intervals of Simpson's rule (PD-6): error below 1e-10 of the standard deviation.
const INTERVALS: u32 = 4000;
/// Fall of the exponent beyond which a tail weighs nothing (PD-6).
const NEGLIGIBLE: f64 = 40.0;

impl Distribution {
    /// The same draws over a value: as factors on it, which is above zero, or as differences from it.
    pub(crate) fn over(self, base: f64, acts: Acts) -> Self {
        let of = |x: f64| match acts {
            Acts::Value => x,
            Acts::Scale => x / base,
            Acts::Offset => x - base,
        };
        let scale = if acts == Acts::Scale { base } else { 1.0 };
        match self {
            Distribution::Normal { mean, sd } => Distribution::Normal {
                mean: of(mean),
                sd: sd / scale,
            },
            Distribution::TruncatedNormal {
                mean,
                sd,
                low,
                high,
            } => Distribution::TruncatedNormal {
                mean: of(mean),
                sd: sd / scale,
                low: of(low),
                high: of(high),
            },
            Distribution::Uniform { low, high } => Distribution::Uniform {
                low: of(low),
                high: of(high),
            },
            Distribution::Triangular { low, mode, high } => Distribution::Triangular {
                low: of(low),
                mode: of(mode),
                high: of(high),
            },
            Distribution::Lognormal {
                median,
                geometric_sd,
            } => Distribution::Lognormal {
                median: of(median),
                geometric_sd,
            },
        }
    }

    /// Value below which a share `u` of the distribution lies; `u` within 0 and 1, both ends excluded where the distribution is unbounded.
    pub fn inverse_cdf(&self, u: f64) -> f64 {
        match *self {
            Distribution::Normal { mean, sd } => mean + sd * standard(u), // PD-1
            Distribution::TruncatedNormal { mean, sd, .. } => {
                let (a, b) = self.standard_ends(mean, sd);
                let (low, high) = self.support();
                within(mean + sd * between(a, b, u), low, high)
            }
            Distribution::Uniform { low, high } => within(low + u * (high - low), low, high), // PD-3
            Distribution::Triangular { low, mode, high } => {
                let width = high - low;
                let x = if u * width < mode - low {
                    low + (u * width * (mode - low)).sqrt() // PD-4
                } else {
                    high - ((1.0 - u) * width * (high - mode)).sqrt() // PD-4
                };
                within(x, low, high)
            }
            Distribution::Lognormal {
                median,
                geometric_sd,
            } => median * (geometric_sd.ln() * standard(u)).exp(), // PD-5
        }
    }

    /// Mean.
    pub fn mean(&self) -> f64 {
        self.moments().0
    }

    /// Standard deviation.
    pub fn sd(&self) -> f64 {
        self.moments().1
    }

    /// Least and largest possible value; infinite where there is none.
    pub fn support(&self) -> (f64, f64) {
        match *self {
            Distribution::Normal { .. } => (f64::NEG_INFINITY, f64::INFINITY),
            Distribution::Lognormal { .. } => (0.0, f64::INFINITY),
            Distribution::TruncatedNormal { low, high, .. }
            | Distribution::Uniform { low, high }
            | Distribution::Triangular { low, high, .. } => (low, high),
        }
    }

    /// Both ends in standard deviations from a mean (PD-2).
    pub(super) fn standard_ends(&self, mean: f64, sd: f64) -> (f64, f64) {
        let (low, high) = self.support();
        ((low - mean) / sd, (high - mean) / sd)
    }

    /// Mean and standard deviation.
    fn moments(&self) -> (f64, f64) {
        match *self {
            Distribution::Normal { mean, sd } => (mean, sd),
            Distribution::TruncatedNormal { mean, sd, .. } => {
                let (a, b) = self.standard_ends(mean, sd);
                let (m, s) = cut_moments(a, b);
                (mean + sd * m, sd * s)
            }
            Distribution::Uniform { low, high } => {
                (low + 0.5 * (high - low), (high - low) / 12.0_f64.sqrt())
            } // PD-3
            Distribution::Triangular { low, mode, high } => {
                let (m, w) = (mode - low, high - low); // PD-4
                (low + (m + w) / 3.0, ((m * m + w * w - m * w) / 18.0).sqrt())
            }
            Distribution::Lognormal {
                median,
                geometric_sd,
            } => {
                let s2 = geometric_sd.ln().powi(2);
                let mean = median * (0.5 * s2).exp(); // PD-5
                (mean, mean * s2.exp_m1().sqrt())
            }
        }
    }
}

/// z(u) of the standard normal distribution; the upper half from the lower one, so that the two mirror each other (PD-1).
fn standard(u: f64) -> f64 {
    let normal = Normal::standard();
    if u > 0.5 {
        -normal.inverse_cdf(1.0 - u)
    } else {
        normal.inverse_cdf(u)
    }
}

/// Share of the standard normal distribution between two ends.
pub(super) fn mass(a: f64, b: f64) -> f64 {
    let normal = Normal::standard();
    // The side with the smaller probabilities keeps its digits.
    if a > 0.0 {
        normal.cdf(-a) - normal.cdf(-b)
    } else {
        normal.cdf(b) - normal.cdf(a)
    }
}

/// z at a share u of the standard normal distribution between two ends (PD-2).
fn between(a: f64, b: f64, u: f64) -> f64 {
    let normal = Normal::standard();
    let lower = normal.cdf(a) + u * mass(a, b); // PD-2
    let z = if lower <= 0.5 {
        normal.inverse_cdf(lower)
    } else {
        -normal.inverse_cdf(normal.cdf(-b) + (1.0 - u) * mass(a, b)) // PD-2
    };
    within(z, a, b)
}

/// Mean and standard deviation of the standard normal distribution between two ends (PD-6).
fn cut_moments(a: f64, b: f64) -> (f64, f64) {
    let peak = within(0.0, a, b);
    let reach = (peak * peak + 2.0 * NEGLIGIBLE).sqrt();
    let (from, to) = (a.max(-reach), b.min(reach));
    let step = (to - from) / f64::from(INTERVALS);
    let density = |t: f64| {
        let z = from + t;
        (0.5 * (peak - z) * (peak + z)).exp()
    };
    let sum = |f: &dyn Fn(f64) -> f64| {
        let weight = |i: u32| {
            if i == 0 || i == INTERVALS {
                1.0
            } else {
                f64::from(2 + 2 * (i % 2))
            }
        };
        (0..=INTERVALS)
            .map(|i| weight(i) * f(f64::from(i) * step))
            .sum::<f64>()
    };
    let whole = sum(&density); // PD-6
    let mean = sum(&|t| t * density(t)) / whole;
    let variance = sum(&|t| (t - mean) * (t - mean) * density(t)) / whole;
    (from + mean, variance.sqrt())
}

/// `x` moved onto the nearer end where rounding has carried it out.
fn within(x: f64, low: f64, high: f64) -> f64 {
    if x < low {
        low
    } else if x > high {
        high
    } else {
        x
    }
}
