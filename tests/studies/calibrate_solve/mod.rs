//! Numeric core of a calibration: certified fits, closed forms, coverage over many seeds, and unidentifiable problems.

mod behaviour;
mod nist;
mod unidentified;
mod worth;

use cvtcycle::calibrate::solve::{Fit, Options, Parameter, Prior, Residuals, fit};
use cvtcycle::output::progress::NoProgress;

/// Model given by a function.
struct Model<F>(usize, F);

impl<F: Fn(&[f64]) -> Result<Vec<f64>, String> + Sync> Residuals for Model<F> {
    fn count(&self) -> usize {
        self.0
    }

    fn at(&self, values: &[f64]) -> Result<Vec<f64>, String> {
        (self.1)(values)
    }
}

/// (f(values, x) - y) / sd at each x.
fn curve(
    x: Vec<f64>,
    y: Vec<f64>,
    sd: f64,
    f: impl Fn(&[f64], f64) -> f64 + Sync,
) -> impl Residuals {
    Model(x.len(), move |values: &[f64]| {
        Ok(x.iter()
            .zip(&y)
            .map(|(x, y)| (f(values, *x) - y) / sd)
            .collect())
    })
}

fn parameter(name: &str, start: f64, [low, high]: [f64; 2]) -> Parameter {
    Parameter::new(name, start, low, high)
}

fn with_prior(parameter: Parameter, mean: f64, sd: f64) -> Parameter {
    Parameter {
        prior: Some(Prior { mean, sd }),
        ..parameter
    }
}

const ONCE: Options = Options {
    starts: 1,
    seed: 1,
    max_evaluations: 2000,
    tolerance: 1e-10,
};

fn fitted(model: &dyn Residuals, parameters: &[Parameter]) -> Fit {
    fit(model, parameters, &ONCE, &NoProgress).expect("a fit")
}

fn near(got: f64, want: f64, relative: f64) -> bool {
    (got - want).abs() <= relative * want.abs()
}

/// Initial values of all starts. The model is defined everywhere and its residuals are constant.
fn starts(parameters: &[Parameter], starts: usize, seed: u64) -> Vec<Vec<f64>> {
    let options = Options {
        starts,
        seed,
        max_evaluations: 1,
        tolerance: 1e-8,
    };
    let flat = Model(1, |_: &[f64]| Ok(vec![1.0]));
    let fit = fit(&flat, parameters, &options, &NoProgress).expect("a fit");
    fit.starts.into_iter().map(|start| start.from).collect()
}

#[test]
fn one_value_in_each_part_of_the_region_and_another_seed_elsewhere() {
    let free = || parameter("p", 1.0, [0.0, 10.0]);
    let parameters = [
        free(),
        with_prior(free(), 5.0, 1.0),
        with_prior(free(), 9.0, 1.0),
        with_prior(free(), 50.0, 1.0),
    ];
    let regions = [[0.0, 10.0], [3.0, 7.0], [7.0, 10.0], [0.0, 10.0]];
    let all = starts(&parameters, 9, 7);
    assert_eq!((all.len(), &all[0]), (9, &vec![1.0; 4]));
    for (k, [low, high]) in regions.into_iter().enumerate() {
        let mut parts: Vec<usize> = all[1..]
            .iter()
            .map(|start| ((start[k] - low) / (high - low) * 8.0) as usize)
            .collect();
        parts.sort_unstable();
        assert_eq!(parts, (0..8).collect::<Vec<_>>(), "{k}");
    }
    assert_eq!(all, starts(&parameters, 9, 7));
    assert_ne!(all, starts(&parameters, 9, 8));
    assert_eq!(starts(&parameters, 0, 7).len(), 1);
}

#[test]
fn starts_move_inside_by_a_hundredth() {
    for (x, want) in [
        (-3.0, 0.1),
        (0.0, 0.1),
        (1e-9, 0.1),
        (1e-6, 1e-6),
        (5.0, 5.0),
        (10.0, 9.9),
        (99.0, 9.9),
    ] {
        let from = starts(&[parameter("p", x, [0.0, 10.0])], 1, 0)[0][0];
        assert!((from - want).abs() < 1e-15, "{x}");
    }
}
