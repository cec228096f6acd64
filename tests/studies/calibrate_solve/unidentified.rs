//! Unidentifiable problems are reported as such, with solver noise in the model.

use cvtcycle::calibrate::solve::{FitEnd, Parameter, Residuals, not_identified, uncertainty};

use super::{Model, fitted, parameter, with_prior};

const X: [f64; 6] = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0];

/// Relative noise of 1e-9 that depends on every bit of the values.
fn noise(values: &[f64], i: usize) -> f64 {
    let bits = values.iter().fold(i as u64, |hash, x| {
        (hash ^ x.to_bits())
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .rotate_left(29)
    });
    1e-9 * ((bits >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
}

fn noisy(f: fn(&[f64], f64) -> f64, truth: &'static [f64]) -> impl Residuals {
    noisy_at(0.01, f, truth)
}

fn noisy_at(sd: f64, f: fn(&[f64], f64) -> f64, truth: &'static [f64]) -> impl Residuals {
    Model(X.len(), move |values: &[f64]| {
        let residual =
            |(i, x): (usize, &f64)| (f(values, *x) * (1.0 + noise(values, i)) - f(truth, *x)) / sd;
        Ok(X.iter().enumerate().map(residual).collect())
    })
}

fn said(f: fn(&[f64], f64) -> f64, truth: &'static [f64], parameters: &[Parameter]) -> Vec<String> {
    let found = fitted(&noisy(f, truth), parameters);
    assert_eq!(found.end, FitEnd::Converged);
    not_identified(&found, parameters)
}

fn several(names: &[&str]) -> Vec<Parameter> {
    names
        .iter()
        .enumerate()
        .map(|(i, name)| parameter(name, 1.0 + 0.2 * i as f64, [0.2, 5.0]))
        .collect()
}

#[test]
fn products_ratios_and_powers_have_their_names() {
    let two = several(&["pump", "pressure"]);
    assert_eq!(
        said(|v, x| v[0] * v[1] * x, &[2.0, 1.0], &two),
        ["pump and pressure: only their product is known"]
    );
    assert_eq!(
        said(|v, x| v[0] / v[1] * x.sin(), &[2.0, 1.0], &two),
        ["pump and pressure: only their ratio is known"]
    );
    assert_eq!(
        said(|v, x| v[0].powf(0.7) * v[1] * x, &[2.0, 1.0], &two),
        ["pump and pressure: only pump^0.70 x pressure is known"]
    );
    assert_eq!(
        said(|v, x| v[0] * v[1].powf(-0.5) + x, &[2.0, 1.0], &two),
        ["pump and pressure: only pump x pressure^-0.50 is known"]
    );
    let three = several(&["a", "b", "c"]);
    assert_eq!(
        said(|v, x| v[0] * v[1] * v[2] * x, &[1.0, 1.0, 1.5], &three),
        ["a, b and c: only a x b x c is known"]
    );
    assert_eq!(
        said(
            |v, x| v[0] * x + v[1] * v[2] * x * x,
            &[1.0, 1.0, 1.5],
            &three
        ),
        ["b and c: only their product is known"]
    );
    assert!(
        said(
            |v, x| v[0] * x + v[1] * x * x + v[2],
            &[1.0, 1.0, 1.5],
            &three
        )
        .is_empty()
    );
}

#[test]
fn groups_are_separated() {
    let five = several(&["a", "b", "c", "d", "e"]);
    let f = |v: &[f64], x: f64| v[0] * v[2] * x + v[1] / v[4] * x * x + v[3];
    let want = [
        "a and c: only their product is known",
        "b and e: only their ratio is known",
    ];
    assert_eq!(said(f, &[1.0, 1.5, 1.0, 0.7, 1.2], &five), want);
    let trade = |v: &[f64], x: f64| v[0] * v[1] * v[2] * x + v[1] * v[2] * v[3] * x * x + v[4];
    let found = said(trade, &[1.0, 1.5, 1.0, 0.7, 1.2], &five);
    assert_eq!(
        found[0],
        "a, b, c and d trade against each other: only 2 combinations of them are known"
    );
    // b and c are in both terms; d is in one term only, and acts almost as they do at these x.
    assert_eq!(
        found[1],
        "b and c act alike: nearly only their product is known"
    );
    assert!(
        found[2..]
            .iter()
            .all(|sentence| sentence.contains(" and d act alike")),
        "{found:?}"
    );
}

#[test]
fn sums_from_zero_trade() {
    let shifts = [
        parameter("first", 0.0, [-2.0, 2.0]),
        parameter("second", 0.0, [-2.0, 2.0]),
    ];
    let want = ["first and second trade against each other: only 1 combination of them is known"];
    assert_eq!(said(|v, x| x + v[0] + v[1], &[0.3, 0.2], &shifts), want);
}

#[test]
fn weak_and_dead_parameters_are_not_identified() {
    let three = several(&["strong", "weak", "dead"]);
    let model = noisy(|v, x| v[0] * x + 1e-4 * v[1] * x * x, &[1.0, 1.0]);
    let found = fitted(&model, &three);
    let worth = uncertainty(&found, &three);
    let sentences = not_identified(&found, &three);
    assert_eq!(sentences.len(), 2, "{sentences:?}");
    assert!(
        sentences[0]
            .starts_with("weak is not identified by these data: its standard deviation is "),
        "{sentences:?}"
    );
    assert_eq!(
        sentences[1],
        "dead is not identified by these data: it moves no residual at the solution"
    );
    assert_eq!(
        (
            &worth.dead[..],
            worth.standard_error[2],
            worth.degrees_of_freedom
        ),
        (&[2][..], None, X.len() - 2)
    );
    assert!(
        worth.covariance[(2, 0)].is_nan()
            && worth.correlation[(0, 2)].is_nan()
            && worth.covariance[(0, 1)].is_finite()
    );
    assert_eq!(worth.directions.len(), 3);
    assert!(
        worth.directions[2].singular_value < 1e-3 && worth.directions[2].weights[2].abs() > 0.999
    );
}

#[test]
fn a_prior_gives_errors_without_information_from_data() {
    let mut two = several(&["pump", "pressure"]);
    let product = |v: &[f64], x: f64| v[0] * v[1] * x;
    let alone = uncertainty(&fitted(&noisy(product, &[2.0, 1.0]), &two), &two);
    assert_eq!(
        (&alone.standard_error[..], alone.degrees_of_freedom),
        (&[None, None][..], X.len() - 1)
    );
    two[1] = with_prior(two[1].clone(), 1.25, 0.1);
    let found = fitted(&noisy(product, &[2.0, 1.0]), &two);
    let worth = uncertainty(&found, &two);
    // The pressure is determined by its prior, the pump by the product: both have a relative error of 0.08.
    for k in 0..2 {
        let relative = worth.standard_error[k].expect("by the prior") / found.values[k];
        assert!((relative - 0.08).abs() < 1e-4, "{relative}");
    }
    assert!(
        worth.correlation[(0, 1)] < -0.999
            && worth.prior_share[1].is_some_and(|share| (share - 1.0).abs() < 1e-6)
    );
    assert_eq!(
        not_identified(&found, &two),
        ["pump and pressure: only their product is known"]
    );
}

#[test]
fn noise_is_not_mistaken_for_information_with_precise_data() {
    let two = several(&["pump", "pressure"]);
    let found = fitted(&noisy_at(1e-6, |v, x| v[0] * v[1] * x, &[2.0, 1.0]), &two);
    let worth = uncertainty(&found, &two);
    // The unidentified direction changes the residuals by more than their standard deviation through noise alone.
    assert!(
        worth.directions[1].singular_value > 0.1 && worth.standard_error == [None, None],
        "{:?}",
        worth.directions
    );
    assert_eq!(
        not_identified(&found, &two),
        ["pump and pressure: only their product is known"]
    );
}
