//! Value of information for functions with known indices, and under chance.

use super::{Known, USUAL, additive, ishigami};
use cvtcycle::study::statistics::{Column, Shares, sd_left, shares};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Independent draws of a function of the first columns, with inert columns after them.
fn drawn(known: &Known, n: usize, idle: usize, seed: u64) -> (Vec<Column>, Vec<f64>) {
    let mut random = Pcg64::seed_from_u64(seed);
    let d = known.first.len();
    let mut columns = vec![Vec::with_capacity(n); d + idle];
    let mut output = Vec::with_capacity(n);
    for _ in 0..n {
        let x: Vec<f64> = (0..d + idle).map(|_| random.random::<f64>()).collect();
        output.push((known.evaluate_at)(&x[..d]));
        columns
            .iter_mut()
            .zip(x)
            .for_each(|(column, x)| column.push(x));
    }
    (columns.into_iter().map(Column::Numbers).collect(), output)
}

/// Truth: the indices of Ishigami's function (0.314, 0.442, 0) and of a sum (9/14, 4/14, 1/14, 0), by hand.
#[test]
fn val_shares_of_known_functions() {
    for known in [ishigami(), additive()] {
        let (columns, output) = drawn(&known, 4096, 3, 7);
        let found = shares(&columns, &output, USUAL);
        assert_eq!((found.n, found.missing), (4096, 0));
        for (share, truth) in found.shares.iter().zip(known.first.iter().chain(&[0.0; 3])) {
            assert!(
                (share - truth).abs() < 0.03,
                "{}: {share} of {truth}",
                known.name
            );
        }
        // 64 groups of 4096: an inert factor has a deviation of sqrt(128)/4096 = 0.003, the largest of a few about twice that.
        assert!(
            (0.003..0.012).contains(&found.noise),
            "{}: {}",
            known.name,
            found.noise
        );
    }
    // Knowing half of the variance leaves 0.707 of the deviation.
    assert!((sd_left(2.0, 0.5) - 2.0 * 0.5_f64.sqrt()).abs() < 1e-12);
    assert!((sd_left(2.0, -0.1) - 2.0 * 1.1_f64.sqrt()).abs() < 1e-12 && sd_left(2.0, 1.2) == 0.0);
}

/// Truth: inert factors only. The largest of 30 exceeds the noise limit in about 5 of 100 samples (deviation 1.5 of 50 samples), and is well above 0 in
/// nearly all: without the limit one of them would be named as a cause.
#[test]
fn val_chance_names_no_cause() {
    let idle = Known {
        name: "idle",
        evaluate_at: Box::new(|x| x[0]),
        first: vec![1.0],
        total: vec![1.0],
    };
    let largest = |seed: u64| {
        let (columns, output) = drawn(&idle, 256, 30, seed);
        let Shares { shares, noise, .. } = shares(&columns[1..], &output, USUAL);
        (shares.into_iter().fold(f64::NAN, f64::max), noise)
    };
    let found: Vec<(f64, f64)> = (0..50).map(largest).collect();
    let above = found.iter().filter(|(share, noise)| share > noise).count();
    let seeming = found.iter().filter(|(share, _)| *share > 0.02).count();
    println!("{above} of 50 above the noise, {seeming} above 0.02");
    assert!(above <= 7 && seeming >= 35, "{above} {seeming}");
}

/// Truth: eta squared by hand, 2 levels of 8 draws each: R2 = 0.8 gives 1 - 0.2 * 15 / 14. Numbers with two values form the same groups.
#[test]
fn levels_are_groups() {
    // Means 1 and 3, deviations of 0.5 about them: 16 between, 4 within.
    let y: Vec<f64> = (0..16)
        .map(|k| if k < 8 { 1.0 } else { 3.0 } + if k % 2 == 0 { 0.5 } else { -0.5 })
        .collect();
    let words = Column::Words((0..16).map(|k| Some(k / 8 * 3 + 2)).collect());
    let numbers = Column::Numbers((0..16).map(|k| if k < 8 { -4.0 } else { 7.5 }).collect());
    let one = Column::Words(vec![Some(1); 16]);
    let gap = Column::Words((0..16).map(|k| (k != 3).then_some(k % 2)).collect());
    let found = shares(&[words, numbers, one, gap], &y, USUAL);
    for k in 0..2 {
        assert!(
            (found.shares[k] - (1.0 - 0.2 * 15.0 / 14.0)).abs() < 1e-12,
            "{:?}",
            found.shares
        );
    }
    assert!(found.shares[2].is_nan() && found.shares[3].is_nan());
}

#[test]
fn uninformative_factors_have_no_share() {
    let (columns, mut output) = drawn(&additive(), 40, 1, 3);
    let whole = shares(&columns, &output, USUAL);
    // The order of the factors and the unit of the output have no effect.
    let turned: Vec<Column> = columns.iter().rev().cloned().collect();
    let scaled: Vec<f64> = output.iter().map(|y| 1e6 - 250.0 * y).collect();
    let other = shares(&turned, &scaled, USUAL);
    let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
    assert!(whole.shares.iter().zip(other.shares.iter().rev()).all(near));
    assert!((whole.noise - other.noise).abs() < 1e-9);
    output[5] = f64::NAN;
    let gap = shares(&columns, &output, USUAL);
    assert_eq!((gap.n, gap.missing), (39, 1));
    assert!(gap.shares[0].is_finite());
    let few = shares(&columns, &output[..15], USUAL);
    assert!(few.noise.is_nan() && few.shares.iter().all(|s| s.is_nan()));
    let constant = shares(&columns, &[0.1; 40], USUAL);
    assert!(constant.noise.is_nan() && constant.shares.iter().all(|s| s.is_nan()));
}
