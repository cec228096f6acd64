//! The numeric core of a calibration: against certified fits, closed forms, counting over many seeds, and set-ups that do not identify.

mod behaviour;
mod nist;
mod starts;
mod unidentified;
mod worth;

use cvtcycle::study::NoProgress;
use cvtcycle::study::fit::solve::{Fit, Options, Parameter, Prior, Residuals, fit};

/// A model that is a function.
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
