//! Bounds, priors and intervals against closed forms and coverage.

use cvtcycle::calibrate::solve::{Bound, FitEnd, uncertainty};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, Normal};

use super::{curve, fitted, near, parameter, with_prior};

const TIMES: [f64; 8] = [0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0];

fn decay(values: &[f64], t: f64) -> f64 {
    values[0] * (-values[1] * t).exp()
}

#[test]
fn val_an_active_bound_leaves_the_linear_fit_of_the_other() {
    let y: Vec<f64> = TIMES.iter().map(|t| decay(&[2.0, 0.8], *t)).collect();
    let sd = 0.05;
    for (bounds, held, bound) in [
        ([0.1, 0.5], 0.5, Bound::High),
        ([1.2, 3.0], 1.2, Bound::Low),
    ] {
        // With a fixed rate the amplitude is linear: A = sum e y / sum e^2, with variance sd^2 / sum e^2.
        let e: Vec<f64> = TIMES.iter().map(|t| (-held * t).exp()).collect();
        let squares: f64 = e.iter().map(|e| e * e).sum();
        let amplitude = e.iter().zip(&y).map(|(e, y)| e * y).sum::<f64>() / squares;
        for start in [0.3 * bounds[0] + 0.7 * bounds[1], bounds[0], bounds[1]] {
            let parameters = [
                parameter("A", 1.0, [0.1, 10.0]),
                parameter("k", start, bounds),
            ];
            let found = fitted(&curve(TIMES.to_vec(), y.clone(), sd, decay), &parameters);
            let worth = uncertainty(&found, &parameters);
            assert_eq!(
                (found.end, found.values[1].to_bits()),
                (FitEnd::Converged, held.to_bits()),
                "{found:?}"
            );
            assert_eq!(
                (&worth.at_bound[..], worth.standard_error[1]),
                (&[None, Some(bound)][..], None)
            );
            assert!(
                near(found.values[0], amplitude, 1e-7),
                "{} {amplitude}",
                found.values[0]
            );
            assert!(
                worth.standard_error[0].is_some_and(|se| near(se, sd / squares.sqrt(), 1e-6)),
                "{:?}",
                worth.standard_error
            );
            assert_eq!(worth.degrees_of_freedom, TIMES.len() - 1);
        }
    }
}

#[test]
fn a_start_on_a_bound_or_beyond_finds_the_minimum_inside() {
    let y: Vec<f64> = TIMES.iter().map(|t| decay(&[2.0, 0.8], *t)).collect();
    for start in [-5.0, 0.0, 0.1, 3.0, 77.0] {
        let parameters = [
            parameter("A", start, [0.0, 10.0]),
            parameter("k", start, [0.0, 3.0]),
        ];
        let found = fitted(&curve(TIMES.to_vec(), y.clone(), 0.05, decay), &parameters);
        assert!(
            near(found.values[0], 2.0, 1e-6) && near(found.values[1], 0.8, 1e-6),
            "{start}: {found:?}"
        );
    }
}

#[test]
fn val_linear_with_priors_is_the_gaussian_posterior() {
    let x = [-1.0, 0.0, 0.5, 2.0];
    let y = [1.2, 0.9, 1.9, 4.2];
    let sd = 0.3;
    let (mean, prior_sd) = ([0.5, 1.0], [0.2, 0.4]);
    let parameters = [
        with_prior(parameter("a", 0.0, [-20.0, 20.0]), mean[0], prior_sd[0]),
        with_prior(parameter("b", 0.0, [-20.0, 20.0]), mean[1], prior_sd[1]),
        with_prior(parameter("idle", 3.0, [-20.0, 20.0]), 2.0, 0.7),
    ];
    let found = fitted(
        &curve(x.to_vec(), y.to_vec(), sd, |v, x| v[0] + v[1] * x),
        &parameters,
    );
    let worth = uncertainty(&found, &parameters);
    // H = X'X / sd^2 + P^-1, posterior mean H^-1 (X'y / sd^2 + P^-1 mean), covariance H^-1: two by two, by hand.
    let sum = |f: &dyn Fn(f64, f64) -> f64| {
        x.iter().zip(&y).map(|(x, y)| f(*x, *y)).sum::<f64>() / (sd * sd)
    };
    let known = prior_sd.map(|sd: f64| 1.0 / (sd * sd));
    let h = [
        sum(&|_, _| 1.0) + known[0],
        sum(&|x, _| x),
        sum(&|x, _| x * x) + known[1],
    ];
    let g = [
        sum(&|_, y| y) + known[0] * mean[0],
        sum(&|x, y| x * y) + known[1] * mean[1],
    ];
    let det = h[0] * h[2] - h[1] * h[1];
    let covariance = [h[2] / det, -h[1] / det, h[0] / det];
    let posterior = [
        covariance[0] * g[0] + covariance[1] * g[1],
        covariance[1] * g[0] + covariance[2] * g[1],
    ];
    for k in 0..2 {
        assert!(
            near(found.values[k], posterior[k], 1e-6),
            "{:?} {posterior:?}",
            found.values
        );
        assert!(near(worth.covariance[(k, k)], covariance[2 * k], 1e-7));
        assert!(near(
            worth.prior_share[k].expect("share"),
            covariance[2 * k] / prior_sd[k].powi(2),
            1e-7
        ));
    }
    assert!(near(worth.covariance[(0, 1)], covariance[1], 1e-6));
    assert!(near(
        worth.correlation[(1, 0)],
        covariance[1] / (covariance[0] * covariance[2]).sqrt(),
        1e-6
    ));
    // The data do not contain the third parameter, which stays at its prior.
    assert!(
        near(found.values[2], 2.0, 1e-6)
            && near(worth.standard_error[2].expect("prior"), 0.7, 1e-9)
    );
    assert!(near(worth.prior_share[2].expect("share"), 1.0, 1e-9));
    assert_eq!((worth.dead, worth.degrees_of_freedom), (vec![2], 4 + 3 - 3));
    assert_eq!(found.prior_residuals.len(), 3);
    // Four degrees of freedom: 1 - F(c) = (1 + c / 2) exp(-c / 2).
    let half = 0.5 * found.cost;
    assert!(
        near(
            worth.chi2_probability.expect("freedom"),
            (1.0 + half) * (-half).exp(),
            1e-9
        ),
        "{:?}",
        worth.chi2_probability
    );
    let squares = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    assert!(near(
        found.cost,
        squares(&found.residuals) + squares(&found.prior_residuals),
        1e-14
    ));
}

/// Range of counts of `n` allowed by probability `p`, both tails together 1e-4.
fn allowed(p: f64, n: u64) -> std::ops::RangeInclusive<u64> {
    let binomial = Binomial::new(p, n).expect("a binomial");
    binomial.inverse_cdf(5e-5)..=binomial.inverse_cdf(1.0 - 5e-5)
}

#[test]
fn val_intervals_cover_as_often_as_they_say() {
    let (seeds, sd) = (600_u64, 0.04);
    let normal = Normal::standard();
    for prior in [false, true] {
        let (mut within, mut cost, mut freedom, mut unlikely) = ([[0_u64; 2]; 2], 0.0, 0, 0);
        for seed in 0..seeds {
            let mut draw = Pcg64::seed_from_u64(seed);
            let mut noise = || {
                normal.inverse_cdf(((draw.next_u64() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64)
            };
            // With a prior the truth is drawn from it.
            let truth = [2.0, if prior { 0.7 + 0.05 * noise() } else { 0.7 }];
            let y = TIMES
                .iter()
                .map(|t| decay(&truth, *t) + sd * noise())
                .collect();
            let rate = parameter("k", 0.4, [0.05, 3.0]);
            let parameters = [
                parameter("A", 1.0, [0.1, 10.0]),
                if prior {
                    with_prior(rate, 0.7, 0.05)
                } else {
                    rate
                },
            ];
            let found = fitted(&curve(TIMES.to_vec(), y, sd, decay), &parameters);
            let worth = uncertainty(&found, &parameters);
            for k in 0..2 {
                let off = (found.values[k] - truth[k]).abs()
                    / worth.standard_error[k].expect("identified");
                within[k][0] += u64::from(off <= 1.0);
                within[k][1] += u64::from(off <= 1.959_964);
            }
            cost += found.cost;
            freedom += worth.degrees_of_freedom;
            unlikely += u64::from(worth.chi2_probability.expect("freedom") < 0.1);
        }
        for count in within {
            assert!(
                allowed(0.682_689, seeds).contains(&count[0])
                    && allowed(0.95, seeds).contains(&count[1]),
                "{within:?}"
            );
        }
        assert!(allowed(0.1, seeds).contains(&unlikely), "{unlikely}");
        let all = ChiSquared::new(freedom as f64)
            .expect("chi squared")
            .cdf(cost);
        assert!((1e-4..=1.0 - 1e-4).contains(&all), "{cost} {freedom}");
    }
}
