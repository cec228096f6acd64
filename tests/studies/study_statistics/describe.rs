//! Summaries, quantiles and shares.

use super::USUAL;
use cvtcycle::study::statistics::{Confidence, Share, Spread, Summary, quantile_of_sorted};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// First column of the golden table.
fn column() -> Vec<f64> {
    let table = include_str!("../../golden/sobol_outputs.csv");
    table
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().unwrap().parse().unwrap())
        .collect()
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

/// Truth: numpy 2.4 (`mean`, `std(ddof=1)`, `quantile`) and scipy 1.17 (`t.interval`, `binom.ppf`).
#[test]
fn val_summary_as_in_numpy_and_scipy() {
    let s = Summary::new(&column(), USUAL);
    assert_eq!((s.n, s.missing), (64, 0));
    assert!(
        near(s.mean, 13.43517654912861) && near(s.sd, 3.7526493749343626),
        "{} {}",
        s.mean,
        s.sd
    );
    let truth = [
        5.845685790608638,
        6.897910638918214,
        10.894498360266246,
        13.99576194728524,
        15.936844388895043,
        19.168449348880287,
        19.570741674378226,
    ];
    for ((quantile, p), truth) in s.quantiles.iter().zip(USUAL.quantiles()).zip(truth) {
        assert!(
            quantile.p == p && near(quantile.value, truth) && near(s.quantile(p), truth),
            "{quantile:?} against {truth}"
        );
    }
    let [low, high] = s.mean_interval.unwrap();
    assert!(
        near(low, 12.497792625654053) && near(high, 14.372560472603165),
        "{low} {high}"
    );
    // Ranks 24 and 41 of 64 for the median; for 0.025 no rank below, rank 5 above.
    assert_eq!(
        s.quantiles[3].interval,
        [Some(11.797796580644007), Some(15.173771333753265)]
    );
    assert_eq!(s.quantiles[0].interval, [None, Some(7.742877964412257)]);
    assert_eq!(s.quantiles[5].interval, [Some(17.720609745437105), None]);
}

#[test]
fn missing_values_are_counted_and_change_nothing_else() {
    let full = column();
    let mut gaps = full.clone();
    gaps.splice(10..10, [f64::NAN, f64::INFINITY, f64::NEG_INFINITY]);
    let (a, b) = (Summary::new(&full, USUAL), Summary::new(&gaps, USUAL));
    let spread = Spread {
        missing: 3,
        ..a.spread
    };
    assert_eq!(Summary { spread, ..a }, b);
    let none = Summary::new(&[f64::NAN], USUAL);
    assert!(
        none.n == 0
            && none.missing == 1
            && none.mean.is_nan()
            && none.min.is_nan()
            && none.quantiles[3].value.is_nan()
    );
    assert!(none.mean_interval.is_none() && Summary::new(&[], USUAL).quantile(0.5).is_nan());
    let one = Summary::new(&[2.5], USUAL);
    assert_eq!(
        (one.mean, one.min, one.max, one.quantile(0.05)),
        (2.5, 2.5, 2.5, 2.5)
    );
    assert!(one.sd.is_nan() && one.mean_interval.is_none());
    assert!(one.quantile(0.3).is_nan(), "not one of the summary's");
}

#[test]
fn a_small_spread_about_a_large_mean_keeps_its_digits() {
    // By hand: 0, 1, 2 repeated about 10^9 has variance 2/3 n / (n - 1).
    let values: Vec<f64> = (0..3000).map(|i| 1e9 + f64::from(i % 3)).collect();
    let s = Summary::new(&values, USUAL);
    assert!(
        near(s.mean, 1e9 + 1.0) && near(s.sd, (2.0 / 3.0 * 3000.0 / 2999.0_f64).sqrt()),
        "{}",
        s.sd
    );
    let same = Summary::new(&[0.1; 1000], USUAL);
    assert!(same.sd < 1e-17 && same.mean == 0.1, "{}", same.sd);
}

#[test]
fn quantiles_meet_their_ends_and_lie_between_neighbours() {
    let sorted = [1.0, 2.0, 4.0, 8.0];
    // By hand, h = 3 p from 0.
    for (p, truth) in [
        (0.0, 1.0),
        (1.0, 8.0),
        (0.5, 3.0),
        (0.25, 1.75),
        (0.9, 6.8),
        (-1.0, 1.0),
        (2.0, 8.0),
    ] {
        assert!(near(quantile_of_sorted(&sorted, p), truth), "{p}");
    }
}

#[test]
fn shares_leave_out_what_is_missing() {
    let d = [7.2 - 7.0, 0.0, f64::NAN, f64::NAN, f64::NAN];
    let share = Share::above_zero(&d, Some(USUAL));
    assert_eq!(
        (share.k, share.n, share.missing, share.share),
        (1, 2, 3, 0.5)
    );
    let share = Share::new(&[1.0, 2.0, 3.0, 4.0], Some(USUAL), |x| x >= 2.0);
    assert_eq!((share.k, share.n), (3, 4));
    assert!(
        share
            .interval
            .is_some_and(|[low, high]| low < 0.75 && 0.75 < high)
    );
    assert!(Share::above_zero(&[], None).share.is_nan());
}

/// Draws of a lognormal variable: the median is 1, the mean exp(1/2 s^2). The standard deviation of a count is 6.9 of 95 %, 12.6 of 80 %. The
/// intervals of median and share cover at least that often, because their ends are ranks.
#[test]
fn val_intervals_hold_the_truth_as_often_as_they_say() {
    for (confidence, mean, ranks) in [
        (USUAL, 925..=975, 935..=985),
        (Confidence::from_level(0.8), 755..=845, 775..=875),
    ] {
        let hits = hits(confidence);
        println!("mean, median, share: {hits:?} of 1000, {confidence:?}");
        assert!(mean.contains(&hits[0]), "{hits:?}");
        assert!(hits[1..].iter().all(|hit| ranks.contains(hit)), "{hits:?}");
    }
}

fn hits(confidence: Confidence) -> [usize; 3] {
    let (seeds, n, s): (usize, usize, f64) = (1000, 200, 0.3);
    let mut hits = [0; 3];
    for seed in 0..seeds {
        let mut random = Pcg64::seed_from_u64(seed as u64);
        let mut normal = || {
            (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt()
                * (std::f64::consts::TAU * random.random::<f64>()).cos()
        };
        let values: Vec<f64> = (0..n).map(|_| (s * normal()).exp()).collect();
        let summary = Summary::new(&values, confidence);
        let within = |[low, high]: [f64; 2], truth: f64| usize::from(low <= truth && truth <= high);
        hits[0] += within(summary.mean_interval.unwrap(), (0.5 * s * s).exp());
        let median = summary.quantiles.iter().find(|q| q.p == 0.5).unwrap();
        let [low, high] = median.interval;
        hits[1] += within([low.unwrap(), high.unwrap()], 1.0);
        hits[2] += within(
            Share::new(&values, Some(confidence), |x| x > 1.0)
                .interval
                .unwrap(),
            0.5,
        );
    }
    hits
}
