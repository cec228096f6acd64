//! Bounds by transformation: a variable without bounds in place of each parameter.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-2 | x = low + (high - low) sin^2(u / 2); u = 2 asin(sqrt((x - low) / (high - low))) | source: sine transformation of MINUIT (James and Roos 1975, doi 10.1016/0010-4655(75)90039-9), shifted |
//! | CA-3 | dx/du = (high - low) sin(u) / 2 | derived from CA-2 |
//! | CA-4 | a start beyond a bound, or nearer to it than 1e-9 of the range, is moved inside by 0.01 of the range | ASSUMED |
//!
//! A sine reaches its bound at a finite u, where a logistic function would send u to infinity. The shift makes u run from 0 to pi, so that the
//! length of u, by which steps are measured, is nowhere 0 inside. On a bound dx/du is 0: from there a parameter does not move (`search` tests
//! whether it should). Bounds are finite.

use super::types::Parameter;

/// Share of the range within which a start counts as being at the bound.
const AT_BOUND: f64 = 1e-9;
/// Share of the range by which it is moved inside.
const INSIDE: f64 = 0.01;

/// Value of a parameter (CA-2).
pub(super) fn outer(parameter: &Parameter, u: f64) -> f64 {
    let (low, high) = (parameter.low, parameter.high);
    let (sine, cosine) = (0.5 * u).sin_cos();
    // From the nearer bound, so that both are met exactly.
    let x = if sine.abs() < cosine.abs() {
        low + (high - low) * sine * sine
    } else {
        high - (high - low) * cosine * cosine
    }; // CA-2
    x.clamp(low, high)
}

/// The variable of a value inside the bounds (CA-2).
pub(super) fn inner(parameter: &Parameter, x: f64) -> f64 {
    let root = |distance: f64| (distance / parameter.range()).clamp(0.0, 1.0).sqrt();
    2.0 * root(x - parameter.low).atan2(root(parameter.high - x)) // CA-2
}

/// Change of the value with the variable (CA-3), from the value itself, so that it is exactly 0 on a bound.
pub(super) fn slope(parameter: &Parameter, u: f64, x: f64) -> f64 {
    let product = ((x - parameter.low) * (parameter.high - x)).max(0.0);
    product.sqrt().copysign(u.sin()) // CA-3: |sin(u)| / 2 = sin(u / 2) cos(u / 2)
}

/// A start inside the bounds (CA-4).
pub(super) fn inside(parameter: &Parameter, x: f64) -> f64 {
    let range = parameter.range();
    if x <= parameter.low + AT_BOUND * range {
        parameter.low + INSIDE * range // CA-4
    } else if x >= parameter.high - AT_BOUND * range {
        parameter.high - INSIDE * range // CA-4
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back_and_the_slope_between() {
        let p = Parameter::new("p", 0.0, -2.0, 5.0);
        for x in [-2.0, -1.999_999, -1.0, 0.0, 1.5, 4.0, 4.999_999, 5.0] {
            let u = inner(&p, x);
            assert!(
                (outer(&p, u) - x).abs() < 1e-14 && (0.0..=std::f64::consts::PI).contains(&u),
                "{x} {u}"
            );
            let h = 1e-5;
            for u in [u, -u] {
                let change = (outer(&p, u + h) - outer(&p, u - h)) / (2.0 * h);
                assert!(
                    (slope(&p, u, x) - change).abs() < 1e-8,
                    "{x} {u}: {change} {}",
                    slope(&p, u, x)
                );
            }
        }
        // Any number lies inside.
        assert!((-2000..2000).all(|i| (-2.0..=5.0).contains(&outer(&p, f64::from(i) * 0.37))));
    }
}
