//! Failing regions, several starts, threads, interruption, and groups left out.

use std::sync::atomic::{AtomicUsize, Ordering};

use cvtcycle::calibrate::solve::{
    Fit, FitEnd, Options, Residuals, fit, leave_out, not_identified, uncertainty,
};
use cvtcycle::output::progress::{NoProgress, Progress};

use super::{Model, ONCE, curve, fitted, near, parameter};

const X: [f64; 9] = [0.0, 0.4, 0.8, 1.2, 1.6, 2.0, 2.4, 2.8, 3.2];

/// sqrt(a - 1) + b x against a truth; undefined for a below 1 or b above `most`.
fn rooted(truth: [f64; 2], most: f64) -> impl Residuals {
    let f = move |a: f64, b: f64, x: f64| (a - 1.0).sqrt() + b * x;
    Model(X.len(), move |v: &[f64]| {
        if v[1] > most {
            return Err(format!("no operating point above b = {most}"));
        }
        Ok(X.iter()
            .map(|x| (f(v[0], v[1], *x) - f(truth[0], truth[1], *x)) / 0.1)
            .collect())
    })
}

#[test]
fn steps_into_failing_regions_are_refused() {
    let parameters = [
        parameter("a", 9.0, [0.0, 10.0]),
        parameter("b", 0.1, [0.0, 10.0]),
    ];
    let found = fitted(&rooted([1.02, 1.9], 2.0), &parameters);
    assert_eq!(found.end, FitEnd::Converged);
    assert!(
        near(found.values[0], 1.02, 1e-6) && near(found.values[1], 1.9, 1e-6),
        "{found:?}"
    );
}

#[test]
fn a_minimum_beyond_the_failing_edge_is_no_convergence() {
    let parameters = [
        parameter("a", 2.0, [0.0, 10.0]),
        parameter("b", 0.1, [0.0, 10.0]),
    ];
    let found = fitted(&rooted([2.0, 3.0], 2.0), &parameters);
    assert_eq!(
        (found.end, found.starts[0].failure.as_deref()),
        (FitEnd::Stalled, Some("no operating point above b = 2"))
    );
    assert!(
        found.values[1] > 1.5 && found.values[1] <= 2.0 && found.cost < found_cost(&[2.0, 0.1]),
        "{found:?}"
    );
}

fn found_cost(values: &[f64]) -> f64 {
    rooted([2.0, 3.0], 2.0)
        .at(values)
        .expect("inside")
        .iter()
        .map(|r| r * r)
        .sum()
}

#[test]
fn starts_that_fail_say_why_and_the_others_go_on() {
    let parameters = [
        parameter("a", 0.5, [0.0, 10.0]),
        parameter("b", 5.0, [0.0, 10.0]),
    ];
    let options = Options { starts: 12, ..ONCE };
    let found =
        fit(&rooted([3.0, 1.0], 2.0), &parameters, &options, &NoProgress).expect("some start");
    let first = &found.starts[0];
    assert_eq!(
        (first.end, first.failure.as_deref(), first.evaluations),
        (FitEnd::Stalled, Some("no operating point above b = 2"), 1)
    );
    assert!(
        first.cost.is_infinite() && found.best != 0 && near(found.values[0], 3.0, 1e-6),
        "{found:?}"
    );
    let numbers = found
        .starts
        .iter()
        .map(|start| start.evaluations)
        .sum::<usize>();
    assert!(numbers <= found.evaluations && found.evaluations <= numbers + 12);

    let refused = fit(
        &rooted([3.0, 1.0], -1.0),
        &parameters,
        &Options { starts: 3, ..ONCE },
        &NoProgress,
    )
    .expect_err("fails everywhere");
    assert_eq!((refused.reasons.len(), refused.starts.len()), (3, 3));
    assert_eq!(
        refused.reasons[0],
        "start 1 at a = 0.5, b = 5: no operating point above b = -1"
    );
}

#[test]
fn bad_residuals_and_bad_parameters_are_reported() {
    let short = Model(3, |_: &[f64]| Ok(vec![1.0; 2]));
    let infinite = Model(2, |_: &[f64]| Ok(vec![1.0, f64::INFINITY]));
    let good = [parameter("a", 1.0, [0.0, 2.0])];
    let why = |model: &dyn Residuals| {
        fit(model, &good, &ONCE, &NoProgress)
            .expect_err("no answer")
            .to_string()
    };
    assert_eq!(
        why(&short),
        "start 1 at a = 1: the model gives 2 residuals in place of 3"
    );
    assert_eq!(why(&infinite), "start 1 at a = 1: residual 2 is inf");
    let mut bad = vec![
        parameter("a", f64::NAN, [2.0, 1.0]),
        parameter("b", 1.0, [0.0, f64::INFINITY]),
    ];
    bad[1].prior = Some(cvtcycle::calibrate::solve::Prior { mean: 1.0, sd: 0.0 });
    assert_eq!(
        fit(&short, &bad, &ONCE, &NoProgress)
            .expect_err("bad")
            .reasons
            .len(),
        4
    );
    assert_eq!(
        fit(&Model(0, |_: &[f64]| Ok(vec![])), &[], &ONCE, &NoProgress)
            .expect_err("nothing")
            .reasons
            .len(),
        2
    );
}

fn wave() -> impl Residuals {
    let x: Vec<f64> = (0..25).map(|i| 0.3 * f64::from(i)).collect();
    let y = x
        .iter()
        .map(|x| 1.5 * (2.3 * x).sin() + 0.01 * (7.0 * x).cos())
        .collect();
    curve(x, y, 0.05, |v, x| v[0] * (v[1] * x).sin())
}

fn wave_fit(options: &Options) -> Fit {
    fit(
        &wave(),
        &[
            parameter("height", 1.0, [0.1, 5.0]),
            parameter("pulse", 4.5, [0.5, 6.0]),
        ],
        options,
        &NoProgress,
    )
    .expect("a fit")
}

#[test]
fn several_starts_find_the_better_minimum() {
    let (one, many) = (wave_fit(&ONCE), wave_fit(&Options { starts: 16, ..ONCE }));
    assert_eq!(one.end, FitEnd::Converged);
    assert_eq!(many.starts[0], one.starts[0]);
    assert!(
        many.best != 0 && many.cost < 0.01 * one.cost && near(many.values[1], 2.3, 1e-2),
        "{one:?} {many:?}"
    );
}

#[test]
fn the_same_on_any_number_of_threads() {
    let options = Options { starts: 7, ..ONCE };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| format!("{:?}", wave_fit(&options)))
    };
    let alone = on(1);
    assert!([2, 3, 8].into_iter().all(|threads| on(threads) == alone));
    assert_ne!(
        format!("{:?}", wave_fit(&Options { seed: 2, ..options })),
        alone
    );
}

struct Patience(AtomicUsize, usize);

impl Progress for Patience {
    fn advance(&self, _: u64) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed) >= self.1
    }
}

/// An earlier failure of a start does not turn an interruption into a failure.
#[test]
fn a_stop_after_a_failed_start_is_a_stop() {
    let model = Model(1, |_: &[f64]| Err("no number".to_owned()));
    let parameters = [parameter("a", 9.0, [0.0, 10.0])];
    let options = Options { starts: 64, ..ONCE };
    let watcher = Patience(AtomicUsize::new(0), 1);
    let failure = fit(&model, &parameters, &options, &watcher).expect_err("no result");
    let failed = failure.starts.iter().filter(|s| s.end == FitEnd::Stalled);
    assert!(failed.count() > 0 && failure.is_stop(), "{failure}");
    let patient = Patience(AtomicUsize::new(0), usize::MAX);
    let failure = fit(&model, &parameters, &options, &patient).expect_err("no result");
    assert!(!failure.is_stop(), "{failure}");
}

#[test]
fn a_stopped_fit_keeps_its_best_point_and_its_limits() {
    let parameters = [
        parameter("a", 9.0, [0.0, 10.0]),
        parameter("b", 0.1, [0.0, 1.9]),
    ];
    let model = rooted([1.5, 1.9], 2.0);
    let watched = |most| {
        let watcher = Patience(AtomicUsize::new(0), most);
        (
            fit(&model, &parameters, &ONCE, &watcher),
            watcher.0.into_inner(),
        )
    };
    let (whole, seen) = watched(usize::MAX);
    let whole = whole.expect("a fit");
    assert_eq!((whole.evaluations, whole.end), (seen, FitEnd::Converged));
    let (stopped, seen) = watched(14);
    let stopped = stopped.expect("the best so far");
    assert!(
        stopped.end == FitEnd::Stopped && (14..=16).contains(&seen),
        "{seen} {stopped:?}"
    );
    assert!(
        whole.cost < stopped.cost && stopped.cost < fitted_cost(&model),
        "{stopped:?}"
    );
    // Without derivatives no uncertainty is reported.
    let worth = uncertainty(&stopped, &parameters);
    assert!(
        stopped.jacobian.iter().all(|slope| slope.is_nan())
            && worth.standard_error == [None, None]
            && worth.dead.is_empty()
    );
    assert!(
        not_identified(&stopped, &parameters)
            .iter()
            .all(|sentence| sentence.contains("no derivative"))
    );
    assert!(watched(0).0.is_err());

    let few = fit(
        &model,
        &parameters,
        &Options {
            max_evaluations: 12,
            ..ONCE
        },
        &NoProgress,
    )
    .expect("the best so far");
    assert_eq!(few.end, FitEnd::OutOfEvaluations);
    let mut before = f64::INFINITY;
    for max_evaluations in 1..60 {
        let limited = wave_fit(&Options {
            max_evaluations,
            ..ONCE
        });
        let within = limited.starts[0].evaluations
            <= max_evaluations
                + if limited.end == FitEnd::Converged {
                    4
                } else {
                    0
                };
        assert!(
            limited.cost <= before && within,
            "{max_evaluations}: {limited:?}"
        );
        before = limited.cost;
    }
}

fn fitted_cost(model: &dyn Residuals) -> f64 {
    model
        .at(&[9.0, 0.1])
        .expect("the start")
        .iter()
        .map(|r| r * r)
        .sum()
}

#[test]
fn groups_left_out_are_predicted_as_by_a_fit_by_hand() {
    let y: Vec<f64> = X
        .iter()
        .map(|x| 1.5 * (-0.6 * x).exp() + 0.03 * (9.0 * x).sin())
        .collect();
    let f = |v: &[f64], x: f64| v[0] * (-v[1] * x).exp();
    let parameters = [
        parameter("A", 1.0, [0.1, 10.0]),
        parameter("k", 1.0, [0.01, 5.0]),
    ];
    let model = curve(X.to_vec(), y.clone(), 0.02, f);
    let groups = [4, 4, 1, 1, 1, 7, 7, 7, 7];
    let solution = fitted(&model, &parameters);
    let folds = leave_out(&model, &parameters, &groups, &solution, &ONCE, &NoProgress);
    assert_eq!(
        folds.iter().map(|fold| fold.group).collect::<Vec<_>>(),
        [1, 4, 7]
    );
    for fold in folds {
        let (kept, left): (Vec<usize>, Vec<usize>) =
            (0..X.len()).partition(|&i| groups[i] != fold.group);
        let selected =
            |all: &[f64], which: &[usize]| which.iter().map(|&i| all[i]).collect::<Vec<_>>();
        let by_hand = fitted(
            &curve(selected(&X, &kept), selected(&y, &kept), 0.02, f),
            &parameters,
        );
        assert!(
            by_hand
                .values
                .iter()
                .zip(&fold.values)
                .all(|(a, b)| near(*a, *b, 1e-6)),
            "{:?} {fold:?}",
            by_hand.values
        );
        assert!(
            (by_hand.values[0] - solution.values[0]).abs() > 1e-3,
            "the fold matters"
        );
        let want: Vec<f64> = left
            .iter()
            .map(|&i| (f(&by_hand.values, X[i]) - y[i]) / 0.02)
            .collect();
        assert_eq!(
            (fold.end, fold.failure, fold.residuals.len()),
            (FitEnd::Converged, None, want.len())
        );
        assert!(
            want.iter()
                .zip(&fold.residuals)
                .all(|(a, b)| (a - b).abs() < 1e-4),
            "{want:?} {:?}",
            fold.residuals
        );
    }
    let only = leave_out(&model, &parameters, &[3; 9], &solution, &ONCE, &NoProgress);
    assert!(only.len() == 1 && only[0].residuals.is_empty() && only[0].failure.is_some());
}
