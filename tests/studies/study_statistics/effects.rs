//! Ranks, groups and tornados.

use super::USUAL;
use cvtcycle::study::statistics::{Estimate, TornadoInput, group_means, rank_sensitivity, tornado};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Columns of the golden table rounded to one decimal, which ties many values.
fn columns() -> Vec<Vec<f64>> {
    let table = include_str!("../../golden/sobol_outputs.csv");
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|l| {
            l.split(',')
                .map(|c| (c.parse::<f64>().unwrap() * 10.0).round() / 10.0)
                .collect()
        })
        .collect();
    (0..5)
        .map(|k| rows.iter().map(|row| row[k]).collect())
        .collect()
}

/// Truth: scipy 1.17 (`spearmanr`) and least squares of numpy 2.4 on `rankdata`, of AB_1 against A, B and AB_3.
#[test]
fn val_ranks_as_in_scipy() {
    let c = columns();
    let found = rank_sensitivity(&[&c[0], &c[1], &c[4]], &c[2], USUAL);
    let truth = [
        (
            0.4681928029426349,
            -0.11323125853589067,
            [-0.4841824778800534, 0.2577199608082721],
        ),
        (
            0.19881828905129106,
            0.19762831206746062,
            [-0.002408927769612823, 0.39766555190453406],
        ),
        (
            0.5974347267761683,
            0.6927780179677697,
            [0.32184567689797516, 1.0637103590375643],
        ),
    ];
    assert!(
        (found.r_squared - 0.4001677084398163).abs() < 1e-10 && found.n == 64 && found.missing == 0
    );
    for (factor, (rho, b, [low, high])) in found.factors.iter().zip(truth) {
        let [l, h] = factor.regression.interval.unwrap();
        for (found, truth) in [
            (factor.spearman.value, rho),
            (factor.regression.value, b),
            (l, low),
            (h, high),
        ] {
            assert!((found - truth).abs() < 1e-10, "{found} against {truth}");
        }
    }
    // By hand: atanh 0.46819 = 0.50772; sqrt((1 + 0.21920 / 2) / 61) = 0.134872; 1.96 of it 0.264344; tanh of both ends.
    let [low, high] = found.factors[0].spearman.interval.unwrap();
    assert!(
        (low - 0.2387).abs() < 2e-4 && (high - 0.6480).abs() < 2e-4,
        "{low} {high}"
    );
}

#[test]
fn ranks_depend_on_the_order_only() {
    let x: Vec<f64> = (0..50).map(f64::from).collect();
    let y: Vec<f64> = x.iter().map(|x| (0.3 * x).exp()).collect();
    let flat = vec![1.0; 50];
    let falling: Vec<f64> = y.iter().map(|y| -y).collect();
    for (y, sign) in [(&y, 1.0), (&falling, -1.0)] {
        let found = rank_sensitivity(&[&x, &flat], y, USUAL);
        assert!(
            (found.factors[0].spearman.value - sign).abs() < 1e-12
                && (found.r_squared - 1.0).abs() < 1e-12
        );
        assert!((found.factors[0].regression.value - sign).abs() < 1e-12);
        let [low, high] = found.factors[0].spearman.interval.unwrap();
        assert!(low <= sign && sign <= high && high <= 1.0 && low >= -1.0);
        assert!(
            found.factors[1].spearman.value.is_nan()
                && found.factors[1].regression.interval.is_none()
        );
    }
}

#[test]
fn gaps_twins_and_too_few_rows() {
    let x: Vec<f64> = (0..40).map(|i| f64::from((i * 17) % 40)).collect();
    let mut y: Vec<f64> = (0..40).map(|i| f64::from((i * 23) % 40)).collect();
    let twins = rank_sensitivity(&[&x, &x], &y, USUAL);
    assert!(twins.r_squared.is_nan() && twins.factors[0].regression.value.is_nan());
    assert!(twins.factors[0].spearman.value.is_finite());
    let whole = rank_sensitivity(&[&x[..39]], &y[..39], USUAL);
    y[39] = f64::NAN;
    let gap = rank_sensitivity(&[&x], &y, USUAL);
    assert_eq!((gap.n, gap.missing), (39, 1));
    assert_eq!(whole.factors, gap.factors);
    let short = rank_sensitivity(&[&x[..30]], &y[..39], USUAL);
    assert_eq!((short.n, short.missing), (30, 9));
    let few = rank_sensitivity(&[&[1.0, 2.0], &[2.0, 1.0]], &[1.0, 2.0], USUAL);
    assert!(
        few.r_squared.is_nan()
            && few.factors[0].spearman.interval.is_none()
            && (few.factors[0].spearman.value - 1.0).abs() < 1e-12
    );
    assert!(rank_sensitivity(&[], &[1.0], USUAL).factors.is_empty());
    let constant = rank_sensitivity(&[&x], &[3.0; 40], USUAL);
    assert!(constant.factors[0].spearman.value.is_nan() && constant.r_squared.is_nan());
}

fn holds(estimate: &Estimate, truth: f64) -> usize {
    usize::from(
        estimate
            .interval
            .is_some_and(|[low, high]| low <= truth && truth <= high),
    )
}

/// Normal variables with correlation r have the rank correlation 6/pi asin(r/2); a third independent one has 0.
#[test]
fn val_intervals_of_rank_correlations_hold_the_truth_in_about_95_of_100() {
    let (r, seeds): (f64, usize) = (0.7, 1000);
    let truth = 6.0 / std::f64::consts::PI * (0.5 * r).asin();
    let mut hits = [0; 3];
    for seed in 0..seeds {
        let mut random = Pcg64::seed_from_u64(900 + seed as u64);
        let mut normal = || {
            (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt()
                * (std::f64::consts::TAU * random.random::<f64>()).cos()
        };
        let x: Vec<f64> = (0..150).map(|_| normal()).collect();
        let z: Vec<f64> = (0..150).map(|_| normal()).collect();
        let y: Vec<f64> = x
            .iter()
            .map(|x| r * x + (1.0 - r * r).sqrt() * normal())
            .collect();
        let found = rank_sensitivity(&[&x, &z], &y, USUAL);
        hits[0] += holds(&found.factors[0].spearman, truth);
        hits[1] += holds(&found.factors[1].spearman, 0.0);
        hits[2] += holds(&found.factors[1].regression, 0.0);
    }
    println!("rank correlation of 0.68 and of 0, regression of 0: {hits:?} of {seeds}");
    // The standard deviation of a count is 6.9.
    assert!(hits.iter().all(|hit| (925..=975).contains(hit)), "{hits:?}");
}

#[test]
fn means_of_words_and_of_a_grid() {
    let words = ["b", "a", "b", "a", "c"];
    let found = group_means(&words, &[3.0, 1.0, 5.0, f64::NAN, f64::NAN], Some(USUAL));
    let shape: Vec<_> = found
        .groups
        .iter()
        .map(|g| (g.label.as_str(), g.n, g.missing))
        .collect();
    assert_eq!(shape, [("b", 2, 0), ("a", 1, 1), ("c", 0, 1)]);
    assert_eq!(
        (found.groups[0].mean, found.groups[1].mean, found.range),
        (4.0, 1.0, 3.0)
    );
    // t(1) = 12.706, sd = sqrt 2: 12.706 on either side.
    assert!((found.groups[0].mean_interval.unwrap()[1] - 16.7062).abs() < 1e-4);
    assert!(found.groups[1].mean_interval.is_none() && found.groups[2].mean.is_nan());
    // By hand: mean 3, all squares 8, between 2 (4 - 3)^2 + (1 - 3)^2 = 6.
    assert!((found.eta_squared - 0.75).abs() < 1e-12);

    // Grid of y = 2 i + k^2: effects of i are 2 apart, those of k 0, 1, 4; each takes its part of the variance.
    let grid: Vec<(i32, i32)> = (0..3).flat_map(|i| (0..3).map(move |k| (i, k))).collect();
    let y: Vec<f64> = grid.iter().map(|(i, k)| f64::from(2 * i + k * k)).collect();
    let [first, second] = [0, 1].map(|f| {
        group_means(
            &grid
                .iter()
                .map(|g| [g.0, g.1][f].to_string())
                .collect::<Vec<_>>(),
            &y,
            None,
        )
    });
    let means = |g: &cvtcycle::study::statistics::Groups| {
        g.groups.iter().map(|g| g.mean).collect::<Vec<_>>()
    };
    assert!(
        (means(&first)[1] - means(&first)[0] - 2.0).abs() < 1e-12
            && (first.range - 4.0).abs() < 1e-12
    );
    assert!((means(&second)[2] - means(&second)[0] - 4.0).abs() < 1e-12);
    // Not a sample: ends, without deviation and interval.
    let ends =
        |g: &cvtcycle::study::statistics::Group| (g.min, g.max, g.sd.is_nan(), g.mean_interval);
    assert_eq!(ends(&first.groups[1]), (2.0, 6.0, true, None));
    assert!((first.eta_squared + second.eta_squared - 1.0).abs() < 1e-12);
    assert!(group_means(&words, &[0.1; 5], None).eta_squared.is_nan());
    assert!(group_means(&words[..1], &[1.0], None).range.is_nan());
}

fn factor(name: &str, entries: &[(&str, f64)]) -> TornadoInput {
    TornadoInput {
        name: name.to_owned(),
        entries: entries.iter().map(|(l, y)| ((*l).to_owned(), *y)).collect(),
    }
}

#[test]
fn a_tornado_is_sorted_by_what_each_factor_moves() {
    let found = tornado(
        7.0,
        &[
            factor("lost", &[("1", f64::NAN), ("2", f64::NAN)]),
            factor("small", &[("0.1", 7.1), ("0.2", 6.9)]),
            factor("one side", &[("cold", 7.5), ("hot", 7.25)]),
            factor(
                "list",
                &[("a", 7.0), ("b", 6.8), ("c", f64::NAN), ("d", 7.9)],
            ),
            factor("one left", &[("x", f64::NAN), ("y", 6.5)]),
            factor("single", &[("z", 6.4)]),
        ],
    );
    let order: Vec<_> = found.bars.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(
        order,
        ["list", "single", "one side", "one left", "small", "lost"]
    );
    let ends = |name: &str| {
        let bar = found.bars.iter().find(|b| b.name == name).unwrap();
        let end = |e: &Option<cvtcycle::study::statistics::TornadoEnd>| {
            e.as_ref()
                .map(|e| (e.label.clone(), (e.effect * 1e6).round() / 1e6))
        };
        (end(&bar.low), end(&bar.high), bar.missing)
    };
    let some = |label: &str, effect: f64| Some((label.to_owned(), effect));
    assert_eq!(ends("list"), (some("b", -0.2), some("d", 0.9), 1));
    // All levels are kept in the order of the plan; one of them is not an end.
    let list = &found.bars[0];
    let levels: Vec<_> = list
        .entries
        .iter()
        .map(|e| (e.label.as_str(), e.output))
        .collect();
    assert_eq!(levels[..2], [("a", 7.0), ("b", 6.8)]);
    assert!(levels[2].0 == "c" && levels[2].1.is_nan() && levels[3] == ("d", 7.9));
    let between: Vec<_> = list.between().map(|e| e.label.as_str()).collect();
    assert_eq!(between, ["a"]);
    // Two values stay low and high, whatever the sign of the effect.
    assert_eq!(ends("small"), (some("0.1", 0.1), some("0.2", -0.1), 0));
    assert_eq!(ends("one side"), (some("cold", 0.5), some("hot", 0.25), 0));
    assert_eq!(ends("one left"), (None, some("y", -0.5), 1));
    assert_eq!(ends("single"), (some("z", -0.6), None, 0));
    assert_eq!(ends("lost"), (None, None, 2));
    assert!(
        (found.bars[2].swing - 0.5).abs() < 1e-12,
        "the bar begins at the base"
    );
    assert!(found.bars[5].swing.is_nan());
    assert!(
        tornado(f64::NAN, &[factor("a", &[("1", 2.0)])]).bars[0]
            .swing
            .is_nan()
    );
}
