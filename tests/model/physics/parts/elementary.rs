//! Unit tests of `model::math::elementary`.
use std::f64::consts::LN_2;

use cvtcycle_model::math::{exp, exp_each, ln, ln_each};

/// Largest relative distance to the standard library's function over many numbers.
fn worst(
    own: impl Fn(f64) -> f64,
    truth: impl Fn(f64) -> f64,
    numbers: impl Iterator<Item = f64>,
) -> f64 {
    numbers.fold(0.0, |most: f64, x| {
        most.max((own(x) / truth(x) - 1.0).abs())
    })
}

/// Outside truth: the standard library, itself within one unit of the last place.
#[test]
fn val_exp_and_ln_agree_with_the_standard_library() {
    let near = (-4_000_000..4_000_000).map(|k| f64::from(k) * 1.000_3e-5);
    assert!(worst(exp, f64::exp, near) <= 6e-16);
    assert!(worst(exp, f64::exp, (-6999..6999).map(|k| 0.1 * f64::from(k))) <= 6e-16);
    let absolute = |x: f64| (ln(x) - x.ln()).abs() / x.ln().abs().max(1.0);
    assert!(
        (1..4_000_000)
            .map(|k| absolute(1e-4 * f64::from(k)))
            .fold(0.0, f64::max)
            <= 6e-16
    );
    assert!(
        (-1000..1000)
            .map(|k| absolute(10f64.powf(0.3 * f64::from(k))))
            .fold(0.0, f64::max)
            <= 6e-16
    );
    let near_one = (1..39_000).flat_map(|k| [1.0 + 1e-7 * f64::from(k), 1.0 - 1e-7 * f64::from(k)]);
    assert!(worst(ln, f64::ln, near_one) <= 5e-16);
}

/// Together as alone, to the last bit, whichever of them leaves the short way.
#[test]
fn several_together_are_each_alone() {
    let bits = |x: [f64; 5]| x.map(f64::to_bits);
    for x in [
        [0.3, -2.0, 650.0, -12.5, 1e-9],
        [0.3, f64::NEG_INFINITY, 701.0, -12.5, 0.0],
        [f64::MIN_POSITIVE, 0.0, 3.0, 1e300, 0.7],
    ] {
        assert_eq!(bits(exp_each(x)), bits(x.map(exp)), "{x:?}");
        let positive = x.map(f64::abs);
        assert_eq!(
            bits(ln_each(positive)),
            bits(positive.map(ln)),
            "{positive:?}"
        );
    }
}

#[test]
#[allow(clippy::float_cmp, reason = "promised exactly")]
fn exact_where_it_matters_and_never_a_surprise() {
    assert_eq!((exp(0.0), ln(1.0), ln(2.0)), (1.0, 0.0, LN_2));
    for x in [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        709.0,
        710.0,
        -745.0,
        -746.0,
        700.0,
        -700.0,
    ] {
        assert!(exp(x) == x.exp() || exp(x).is_nan() && x.is_nan(), "{x}");
    }
    for x in [
        f64::NAN,
        f64::INFINITY,
        0.0,
        -0.0,
        -1.0,
        5e-324,
        f64::MIN_POSITIVE / 2.0,
    ] {
        assert!(ln(x) == x.ln() || ln(x).is_nan() && x.ln().is_nan(), "{x}");
    }
}
