//! Distributions of factors against statrs, against tables and against their own moments.
#![allow(clippy::unwrap_used, reason = "tests say what they found")]

use cvtcycle::study::plan::Distribution;
use proptest::prelude::*;
use statrs::distribution::{ContinuousCDF, LogNormal, Normal, Triangular, Uniform};
use statrs::statistics::Distribution as Moments;

const SHARES: [f64; 11] = [
    1e-12,
    1e-7,
    1e-3,
    0.05,
    0.3,
    0.5,
    0.7,
    0.95,
    0.999,
    1.0 - 1e-7,
    1.0 - 1e-12,
];

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance * (1.0 + expected.abs()),
        "{found} instead of {expected}"
    );
}

/// Compares values with an inverse, and moments with a distribution of statrs.
fn against<D: ContinuousCDF<f64, f64> + Moments<f64>>(own: Distribution, truth: &D) {
    for u in SHARES {
        let x = own.inverse_cdf(u);
        near(truth.cdf(x), u, 1e-10);
    }
    near(own.mean(), truth.mean().unwrap(), 1e-12);
    near(own.sd(), truth.std_dev().unwrap(), 1e-12);
}

/// Truth: distribution functions and moments of statrs, independent of the closed forms here.
#[test]
fn val_against_statrs() {
    against(
        Distribution::Normal { mean: 3.0, sd: 0.5 },
        &Normal::new(3.0, 0.5).unwrap(),
    );
    against(
        Distribution::Uniform {
            low: -2.0,
            high: 5.0,
        },
        &Uniform::new(-2.0, 5.0).unwrap(),
    );
    against(
        Distribution::Lognormal {
            median: 2.0,
            geometric_sd: 1.3,
        },
        &LogNormal::new(2.0_f64.ln(), 1.3_f64.ln()).unwrap(),
    );
    for mode in [1.0, 1.2, 2.0, 3.9, 4.0] {
        against(
            Distribution::Triangular {
                low: 1.0,
                mode,
                high: 4.0,
            },
            &Triangular::new(1.0, 4.0, mode).unwrap(),
        );
    }
}

/// Truth: tables of the standard normal distribution (Abramowitz and Stegun 26.2 and 26.5 for the tails).
#[test]
fn val_quantiles_of_the_normal_distribution() {
    let own = Distribution::Normal { mean: 0.0, sd: 1.0 };
    for (u, z) in [
        (0.975, 1.959_963_984_540_054),
        (0.995, 2.575_829_303_548_901),
        (1e-3, -3.090_232_306_167_813),
        (1e-9, -5.997_807_015_007_773),
    ] {
        near(own.inverse_cdf(u), z, 1e-9);
    }
    // Mirrored values are equal to the last digit, so that designs are symmetric.
    assert_eq!(
        own.inverse_cdf(0.25).to_bits(),
        (-own.inverse_cdf(0.75)).to_bits()
    );
}

fn cut(low: f64, high: f64) -> Distribution {
    Distribution::TruncatedNormal {
        mean: 0.0,
        sd: 1.0,
        low,
        high,
    }
}

/// Truth: half-normal distribution, mean sqrt(2/pi) and variance 1 - 2/pi; cut at one standard deviation either way, variance
/// 1 - 2 phi(1) / (2 Phi(1) - 1) = 0.291125; without an effective cut, the normal distribution.
#[test]
fn val_moments_of_the_truncated_normal() {
    let pi = std::f64::consts::PI;
    near(cut(0.0, 60.0).mean(), (2.0 / pi).sqrt(), 1e-9);
    near(cut(0.0, 60.0).sd(), (1.0 - 2.0 / pi).sqrt(), 1e-9);
    near(cut(-1.0, 1.0).sd(), 0.291_125_f64.sqrt(), 1e-6);
    near(cut(-30.0, 30.0).sd(), 1.0, 1e-9);
    // Far in the tail the excess over the cut is nearly exponential: mean 1/a - 2/a^3 + 10/a^5 (continued fraction of Mills' ratio).
    let a = 30.0_f64;
    near(
        (cut(a, 1e3).mean() - a) * a,
        1.0 - 2.0 / a.powi(2) + 10.0 / a.powi(4),
        1e-3,
    );
    // With a narrow cut it is uniform.
    near(cut(1.0, 1.0 + 1e-6).sd() * 12.0_f64.sqrt() * 1e6, 1.0, 1e-6);
}

/// Truth: Simpson's rule over the density from the lower end, also where statrs' distribution function has lost all digits.
#[test]
fn val_quantiles_of_the_truncated_normal() {
    for (low, high) in [
        (-1.0, 1.0),
        (0.5, 3.0),
        (-3.0, -0.5),
        (-6.0, 0.2),
        (8.0, 9.0),
        (-9.0, -8.0),
        (20.0, 20.5),
        (-0.001, 0.001),
    ] {
        let density = |z: f64| (0.5 * (low * low - z * z)).exp();
        let integral = |to: f64| {
            let step = (to - low) / 2000.0;
            let weight = |k: u32| {
                if k == 0 || k == 2000 {
                    1.0
                } else {
                    f64::from(2 + 2 * (k % 2))
                }
            };
            step / 3.0
                * (0..=2000)
                    .map(|k| weight(k) * density(low + f64::from(k) * step))
                    .sum::<f64>()
        };
        for u in [1e-6, 0.01, 0.2, 0.5, 0.8, 0.99, 1.0 - 1e-6] {
            near(
                integral(cut(low, high).inverse_cdf(u)) / integral(high),
                u,
                2e-9,
            );
        }
    }
}

#[test]
fn ends_and_tails() {
    let normal = Distribution::Normal { mean: 1.0, sd: 2.0 };
    assert_eq!(normal.support(), (f64::NEG_INFINITY, f64::INFINITY));
    let tail = 2.0 * 1.959_963_984_540_054;
    near(normal.inverse_cdf(0.025), 1.0 - tail, 1e-9);
    near(normal.inverse_cdf(0.975), 1.0 + tail, 1e-9);
    let lognormal = Distribution::Lognormal {
        median: 1.0,
        geometric_sd: 1.1,
    };
    assert!(lognormal.support().0.abs() < 1e-300 && lognormal.inverse_cdf(0.025) > 0.8);
    let triangular = Distribution::Triangular {
        low: 1.0,
        mode: 1.0,
        high: 2.0,
    };
    assert_eq!(triangular.support(), (1.0, 2.0));
    assert_eq!(cut(-1.0, 2.0).support(), (-1.0, 2.0));
}

fn any_distribution() -> impl Strategy<Value = Distribution> {
    let ends = (-1e3..1e3_f64, 1e-3..1e3_f64);
    prop_oneof![
        (-1e3..1e3_f64, 1e-3..1e2_f64).prop_map(|(mean, sd)| Distribution::Normal { mean, sd }),
        ends.clone().prop_map(|(low, width)| Distribution::Uniform {
            low,
            high: low + width
        }),
        (ends, 0.0..=1.0_f64).prop_map(|((low, width), share)| {
            let high = low + width;
            Distribution::Triangular {
                low,
                mode: (low + share * width).min(high),
                high,
            }
        }),
        (-4.0..2.0_f64, 0.05..4.0_f64, 0.1..50.0_f64).prop_map(|(a, width, sd)| {
            Distribution::TruncatedNormal {
                mean: 5.0,
                sd,
                low: 5.0 + a * sd,
                high: 5.0 + (a + width) * sd,
            }
        }),
        (1e-3..1e3_f64, 1.001..3.0_f64).prop_map(|(median, geometric_sd)| {
            Distribution::Lognormal {
                median,
                geometric_sd,
            }
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Monotone, within the ends, and with mean and standard deviation of 40 000 equidistant draws (midpoint rule; the tolerance is its error
    /// in the tails of unbounded distributions).
    #[test]
    fn quantiles_agree_with_the_moments(own in any_distribution()) {
        let n = 40_000;
        let x: Vec<f64> = (0..n).map(|k| own.inverse_cdf((f64::from(k) + 0.5) / f64::from(n))).collect();
        let (low, high) = own.support();
        prop_assert!(x.windows(2).all(|pair| pair[0] <= pair[1]) && low <= x[0] && x[x.len() - 1] <= high, "{:?}", own);
        let mean = x.iter().sum::<f64>() / f64::from(n);
        let sd = (x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / f64::from(n)).sqrt();
        prop_assert!((mean - own.mean()).abs() <= 2e-3 * own.sd(), "{:?}: {} {}", own, mean, own.mean());
        prop_assert!((sd / own.sd() - 1.0).abs() <= 2e-2, "{:?}: {} {}", own, sd, own.sd());
    }
}
