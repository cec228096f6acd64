//! Points of the designs: order, balance, independence, and dependence on the index only.
#![allow(clippy::unwrap_used, reason = "tests say what they found")]

use std::collections::BTreeSet;

use cvtcycle::study::design::{Level, MAX_SOBOL_SAMPLES, Role, saltelli_role};
use cvtcycle::study::plan::{Design, Factor, FactorValue, Plan};
use proptest::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

const DRAWN: &str = "status = \"assumed\"\ndistribution.uniform = { low = 0, high = 1 }\n";

/// Factors as in a plan: lists of a number of entries, distributions for 0.
fn factors(entries: &[usize]) -> Vec<Factor> {
    let factor = |(k, &n): (usize, &usize)| {
        let list: Vec<String> = (0..n).map(|k| k.to_string()).collect();
        let values = if n == 0 {
            DRAWN.to_owned()
        } else {
            format!("values = [{}]\n", list.join(", "))
        };
        format!("[[factor]]\nkey = \"a.b{k}\"\n{values}")
    };
    let text: String = entries.iter().enumerate().map(factor).collect();
    Plan::read(
        "p.toml",
        &format!("study.design = \"one_at_a_time\"\n{text}"),
    )
    .unwrap()
    .factors
}

fn levels(design: Design, factors: &[Factor], point: u64) -> Vec<Level> {
    (0..factors.len())
        .map(|factor| design.level(factors, point, factor))
        .collect()
}

fn share(design: Design, factors: &[Factor], point: u64, factor: usize) -> f64 {
    match design.level(factors, point, factor) {
        Level::Share(share) => share,
        other => panic!("{other:?}"),
    }
}

fn shares(design: Design, count: usize, factor: usize) -> Vec<f64> {
    let f = factors(&vec![0; count]);
    (0..design.points(&f).unwrap())
        .map(|point| share(design, &f, point, factor))
        .collect()
}

/// Random designs of about `samples` points.
fn drawn(samples: u64, seed: u64) -> [Design; 4] {
    [
        Design::LatinHypercube { samples, seed },
        Design::Sobol { samples, seed },
        Design::MonteCarlo { samples, seed },
        Design::Saltelli { samples, seed },
    ]
}

fn correlation(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len() as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let (mx, my) = (mean(x), mean(y));
    let sum = |f: &dyn Fn(f64, f64) -> f64| {
        x.iter()
            .zip(y)
            .map(|(&a, &b)| f(a - mx, b - my))
            .sum::<f64>()
    };
    sum(&|a, b| a * b) / (sum(&|a, _| a * a) * sum(&|_, b| b * b)).sqrt()
}

/// p-value of chi-squared for counts in equal classes.
fn chance(counts: &[u64]) -> f64 {
    let expected = counts.iter().sum::<u64>() as f64 / counts.len() as f64;
    let chi2: f64 = counts
        .iter()
        .map(|&count| (count as f64 - expected).powi(2) / expected)
        .sum();
    ChiSquared::new(counts.len() as f64 - 1.0).unwrap().sf(chi2)
}

/// By hand: 2 x 3 values, the last factor fastest.
#[test]
fn val_order_of_a_grid() {
    let f = factors(&[2, 3]);
    assert_eq!(Design::Grid.points(&f), Some(6));
    let order: Vec<Vec<Level>> = (0..6)
        .map(|point| levels(Design::Grid, &f, point))
        .collect();
    let expected = [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]];
    assert_eq!(order, expected.map(|pair| pair.map(Level::Entry).to_vec()));
    assert_eq!(
        (Design::Grid.points(&[]), levels(Design::Grid, &[], 0)),
        (Some(1), vec![])
    );
}

/// By hand: the base, two entries, two quantiles, one entry.
#[test]
fn val_order_of_one_at_a_time() {
    let f = factors(&[2, 0, 1]);
    let design = Design::OneAtATime { quantile: 0.1 };
    let (base, entry, part) = (Level::Base, Level::Entry, Level::Share);
    assert_eq!(design.points(&f), Some(6));
    let order: Vec<Vec<Level>> = (0..6).map(|point| levels(design, &f, point)).collect();
    let expected = [
        [base, base, base],
        [entry(0), base, base],
        [entry(1), base, base],
        [base, part(0.1), base],
        [base, part(0.9), base],
        [base, base, entry(0)],
    ];
    assert_eq!(order, expected.map(|levels| levels.to_vec()));
}

/// By hand: two factors, so blocks of four: A, B, A with the first of B, A with the second of B.
#[test]
fn val_blocks_of_saltelli() {
    let f = factors(&[0, 0]);
    let design = Design::Saltelli {
        samples: 8,
        seed: 3,
    };
    assert_eq!(design.points(&f), Some(32));
    let roles: Vec<(u64, Role)> = (4..9).map(|point| saltelli_role(2, point)).collect();
    assert_eq!(
        roles,
        [
            (1, Role::A),
            (1, Role::B),
            (1, Role::AB(0)),
            (1, Role::AB(1)),
            (2, Role::A)
        ]
    );
    // The whole block is one point of a Sobol sequence in four dimensions.
    let four = factors(&[0; 4]);
    for sample in 0..8 {
        let wide = levels(
            Design::Sobol {
                samples: 8,
                seed: 3,
            },
            &four,
            sample,
        );
        let block: Vec<Vec<Level>> = (0..4)
            .map(|column| levels(design, &f, 4 * sample + column))
            .collect();
        let (a, b) = (&wide[..2], &wide[2..]);
        assert_eq!(
            block,
            [a.to_vec(), b.to_vec(), vec![b[0], a[1]], vec![a[0], b[1]]]
        );
    }
}

#[test]
fn a_latin_hypercube_hits_each_stratum_once() {
    for n in (2..120).chain([127, 128, 129, 1000, 1024, 5000, 30_011]) {
        for seed in 0..3 {
            for factor in 0..3 {
                let strata: BTreeSet<u64> =
                    shares(Design::LatinHypercube { samples: n, seed }, 3, factor)
                        .iter()
                        .map(|u| (u * n as f64) as u64)
                        .collect();
                assert!(
                    strata.len() as u64 == n && strata.last() == Some(&(n - 1)),
                    "n {n}, seed {seed}, factor {factor}"
                );
            }
        }
    }
}

/// Truth: of independent columns, the correlation times sqrt(n - 1) has mean 0 and variance 1, whatever n is. Over 400 seeds and
/// 3 pairs the mean lies within 4 / sqrt(1200) and the variance within 4 sqrt(2 / 1200) of that.
#[test]
fn val_factors_of_a_latin_hypercube_are_uncorrelated() {
    for samples in [5, 16, 100] {
        let scaled = |seed: u64| {
            let column = |factor| shares(Design::LatinHypercube { samples, seed }, 3, factor);
            let (x, y, z) = (column(0), column(1), column(2));
            [
                correlation(&x, &y),
                correlation(&y, &z),
                correlation(&z, &x),
            ]
            .map(|r| r * (samples as f64 - 1.0).sqrt())
        };
        let all: Vec<f64> = (0..400).flat_map(scaled).collect();
        let mean = all.iter().sum::<f64>() / 1200.0;
        let variance = all.iter().map(|r| r * r).sum::<f64>() / 1200.0;
        assert!(
            mean.abs() < 0.115 && (variance - 1.0).abs() < 0.17,
            "n {samples}: mean {mean}, variance {variance}"
        );
    }
}

/// Truth: the place within its stratum is uniform: chi-squared over 20 classes.
#[test]
fn val_jitter_is_uniform() {
    let mut counts = [0_u64; 20];
    for u in shares(
        Design::LatinHypercube {
            samples: 20_000,
            seed: 5,
        },
        1,
        0,
    ) {
        counts[((u * 20_000.0).fract() * 20.0) as usize] += 1;
    }
    assert!(chance(&counts) > 1e-3, "{counts:?}");
}

/// Truth: chi-squared distribution; one factor in 50 classes, two factors and two following points in 10 x 10.
#[test]
fn val_monte_carlo_is_uniform_and_independent() {
    for seed in [1, 2, u64::MAX] {
        let design = Design::MonteCarlo {
            samples: 50_000,
            seed,
        };
        let columns: Vec<Vec<f64>> = (0..4).map(|factor| shares(design, 4, factor)).collect();
        for x in &columns {
            let mut counts = [0_u64; 50];
            x.iter().for_each(|u| counts[(u * 50.0) as usize] += 1);
            assert!(chance(&counts) > 1e-4, "seed {seed}: {counts:?}");
            let mut largest = 0.0_f64;
            let mut sorted = x.clone();
            sorted.sort_by(f64::total_cmp);
            sorted
                .iter()
                .enumerate()
                .for_each(|(k, u)| largest = largest.max((u - (k as f64 + 0.5) / 50_000.0).abs()));
            // Kolmogorov and Smirnov: 1.95 / sqrt(n) is exceeded by one in a thousand.
            assert!(largest < 1.95 / 50_000_f64.sqrt(), "seed {seed}: {largest}");
        }
        let other = shares(
            Design::MonteCarlo {
                samples: 50_000,
                seed: seed.wrapping_add(1),
            },
            4,
            0,
        );
        let pairs = [
            (&columns[0], &columns[1], 0),
            (&columns[2], &columns[3], 0),
            (&columns[0], &columns[0], 1),
            (&columns[0], &other, 0),
        ];
        for (x, y, lag) in pairs {
            let mut counts = [0_u64; 100];
            x.iter()
                .zip(&y[lag..])
                .for_each(|(u, v)| counts[(u * 10.0) as usize * 10 + (v * 10.0) as usize] += 1);
            assert!(chance(&counts) > 1e-4, "seed {seed}, lag {lag}: {counts:?}");
        }
    }
}

/// Truth: a (0, m, 1) net in each dimension, and for the first two together a (0, m, 2) net: every elementary interval of area 1/n
/// holds one of n = 2^m points.
#[test]
fn val_sobol_points_are_nets() {
    for seed in [1, 7] {
        let x: Vec<Vec<f64>> = (0..6)
            .map(|factor| {
                shares(
                    Design::Sobol {
                        samples: 1024,
                        seed,
                    },
                    6,
                    factor,
                )
            })
            .collect();
        for column in &x {
            let strata: BTreeSet<u64> = column.iter().map(|u| (u * 1024.0) as u64).collect();
            assert_eq!(strata.len(), 1024);
        }
        for split in 0..=10 {
            let (rows, columns) = (f64::from(1 << split), f64::from(1 << (10 - split)));
            let boxes: BTreeSet<(u64, u64)> = x[0]
                .iter()
                .zip(&x[1])
                .map(|(u, v)| ((u * rows) as u64, (v * columns) as u64))
                .collect();
            assert_eq!(boxes.len(), 1024, "seed {seed}: {rows} x {columns}");
        }
    }
}

/// Truth: the integral of prod (1 + (x_i - 1/2)) over the unit cube is 1. Root mean square error over 40 seeds; Monte Carlo's is
/// sqrt(((13/12)^d - 1)/n) by the variance of the product, that of a Latin hypercube is without the main effects, d/12 of the variance.
#[test]
fn val_sobol_integrates_better_than_monte_carlo() {
    let (d, n) = (8, 1024_u64);
    let error = |design: &dyn Fn(u64) -> Design| {
        let squares = (0..40).map(|seed| {
            let f = factors(&vec![0; d]);
            let product = |point| {
                (0..d)
                    .map(|factor| 0.5 + share(design(seed), &f, point, factor))
                    .product::<f64>()
            };
            ((0..n).map(product).sum::<f64>() / n as f64 - 1.0).powi(2)
        });
        (squares.sum::<f64>() / 40.0).sqrt()
    };
    let monte_carlo = error(&|seed| Design::MonteCarlo { samples: n, seed });
    let variance = (13.0 / 12.0_f64).powi(d as i32) - 1.0;
    let near =
        |found: f64, variance: f64| (found / (variance / n as f64).sqrt() - 1.0).abs() < 0.35;
    assert!(near(monte_carlo, variance), "{monte_carlo}");
    let hypercube = error(&|seed| Design::LatinHypercube { samples: n, seed });
    assert!(near(hypercube, variance - d as f64 / 12.0), "{hypercube}");
    let sobol = error(&|seed| Design::Sobol { samples: n, seed });
    println!(
        "errors: Monte Carlo {monte_carlo:.2e}, Latin hypercube {hypercube:.2e}, Sobol {sobol:.2e}"
    );
    assert!(sobol < monte_carlo / 8.0, "{sobol}, {monte_carlo}");
}

/// Truth: independent seeds give uncorrelated sequences; the last dimensions of the largest design are still uniform.
#[test]
fn sobol_seeds_and_high_dimensions() {
    let column = |seed, factor| {
        shares(
            Design::Sobol {
                samples: 4096,
                seed,
            },
            256,
            factor,
        )
    };
    assert!(correlation(&column(1, 0), &column(2, 0)).abs() < 0.06);
    for pair in [(0, 255), (127, 128), (254, 255), (100, 228)] {
        assert!(
            correlation(&column(1, pair.0), &column(1, pair.1)).abs() < 0.06,
            "{pair:?}"
        );
    }
}

/// Recorded on the first run: a study resumed by a later version must get the same points.
#[test]
fn points_are_stable_between_versions() {
    let f = factors(&[0, 0, 0]);
    let found: Vec<u64> = drawn(1000, 42)
        .map(|design| share(design, &f, 617, 1).to_bits())
        .to_vec();
    let shown: Vec<f64> = found.iter().map(|bits| f64::from_bits(*bits)).collect();
    assert_eq!(found, KEPT, "{shown:?}");
}

const KEPT: [u64; 4] = [
    4599521494267026473,
    4605275378695536640,
    4599721567129739470,
    4595679480621563904,
];

/// Truth: brute force.
#[test]
fn val_span_of_the_shares() {
    for design in drawn(300, 9) {
        for factor in 0..2 {
            let mut all = shares(design, 2, factor);
            all.sort_by(f64::total_cmp);
            assert_eq!(
                design.share_span(&factors(&[0, 0]), factor),
                (all[0], all[all.len() - 1]),
                "{design:?}"
            );
        }
    }
    let (low, high) = Design::MonteCarlo {
        samples: 1 << 30,
        seed: 1,
    }
    .share_span(&factors(&[0]), 0);
    assert!(0.0 < low && low < 1e-12 && high < 1.0 && 1.0 - high < 1e-12);
    assert_eq!(
        Design::OneAtATime { quantile: 0.2 }.share_span(&factors(&[0]), 0),
        (0.2, 0.8)
    );
}

/// Truth: each of 7 entries is drawn about equally often, and a share just below 1 is the last one.
#[test]
fn lists_are_drawn_evenly() {
    let f = factors(&[7]);
    for design in drawn(7000, 4) {
        let mut counts = [0_u64; 7];
        for point in 0..7000 {
            let Some(FactorValue::Number(x)) = f[0].value(design.level(&f, point, 0)) else {
                panic!("no value")
            };
            counts[x as usize] += 1;
        }
        assert!(chance(&counts) > 1e-4, "{design:?}: {counts:?}");
    }
    assert_eq!(
        f[0].value(Level::Share(1.0)),
        Some(FactorValue::Number(6.0))
    );
    assert_eq!(
        (f[0].value(Level::Entry(7)), f[0].value(Level::Base)),
        (None, None)
    );
    let drawn = &factors(&[0])[0];
    assert_eq!(
        (drawn.value(Level::Share(0.25)), drawn.value(Level::Base)),
        (Some(FactorValue::Number(0.25)), None)
    );
}

/// Truth: published quantiles of the normal distribution, from statrs. Every share of a design gives a finite value.
#[test]
fn shares_lead_to_finite_values() {
    let normal = Normal::standard();
    for design in drawn(MAX_SOBOL_SAMPLES, 11) {
        let (low, high) = design.share_span(&factors(&[0, 0]), 1);
        assert!(
            0.0 < low
                && high < 1.0
                && normal.inverse_cdf(low).is_finite()
                && normal.inverse_cdf(high).is_finite(),
            "{design:?}"
        );
    }
}

proptest! {
    /// A point does not depend on which others are requested, nor its parts on the order of requests.
    #[test]
    fn a_point_is_a_function_of_its_index(seed: u64, entries in proptest::collection::vec(0_usize..5, 1..6), samples in 2_u64..5000, at in 0.0..1.0) {
        let f = factors(&entries);
        for design in drawn(samples, seed).into_iter().chain([Design::OneAtATime { quantile: 0.05 }]) {
            let points = design.points(&f).unwrap();
            let point = ((at * points as f64) as u64).min(points - 1);
            let first = levels(design, &f, point);
            let _ = levels(design, &f, points - 1 - point);
            let singly: Vec<Level> = (0..f.len()).rev().map(|factor| design.level(&f, point, factor)).rev().collect();
            prop_assert_eq!(&first, &levels(design, &f, point));
            prop_assert_eq!(&first, &singly);
            for (factor, level) in f.iter().zip(first) {
                if let Level::Share(share) = level {
                    prop_assert!(0.0 < share && share < 1.0);
                }
                prop_assert_eq!(factor.value(level).is_none(), level == Level::Base);
            }
        }
    }

    /// All combinations occur once.
    #[test]
    fn a_grid_is_complete(entries in proptest::collection::vec(1_usize..5, 1..5)) {
        let f = factors(&entries);
        let points = Design::Grid.points(&f).unwrap();
        let all: BTreeSet<String> = (0..points).map(|point| format!("{:?}", levels(Design::Grid, &f, point))).collect();
        prop_assert_eq!(all.len() as u64, points);
        prop_assert_eq!(points, entries.iter().product::<usize>() as u64);
    }
}
