//! Statistics of studies against analytic functions, other programs and hand calculations, and their pictures.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::print_stdout,
    reason = "tables of tests; tests print the numbers they found"
)]

mod describe;
mod drawn;
mod effects;
mod information;
mod pictures;
mod sobol;
mod titles;

use cvtcycle::study::statistics::{Blocks, Confidence};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;

/// Default confidence of all tables of statistics.
pub const USUAL: Confidence = Confidence {
    intervals: 0.95,
    draws: 0.9,
};

/// Function on the unit cube.
pub type Function = Box<dyn Fn(&[f64]) -> f64>;

/// Function with its indices.
pub struct Known {
    pub name: &'static str,
    pub evaluate_at: Function,
    pub first: Vec<f64>,
    pub total: Vec<f64>,
}

/// Ishigami and Homma 1990 with a = 7, b = 0.1. Indices: variances of its terms by hand.
pub fn ishigami() -> Known {
    let (a, b) = (7.0, 0.1);
    let v1 = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
    let v2 = a * a / 8.0;
    let v13 = b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
    let v = v1 + v2 + v13;
    let evaluate_at = move |x: &[f64]| {
        let z: Vec<f64> = x.iter().map(|u| PI * (2.0 * u - 1.0)).collect();
        z[0].sin() + a * z[1].sin().powi(2) + b * z[2].powi(4) * z[0].sin()
    };
    Known {
        name: "Ishigami",
        evaluate_at: Box::new(evaluate_at),
        first: vec![v1 / v, v2 / v, 0.0],
        total: vec![(v1 + v13) / v, v2 / v, v13 / v],
    }
}

/// The product of (|4 x - 2| + a) / (1 + a) of Sobol, eight factors.
pub fn sobol_g() -> Known {
    let a = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0];
    let part = a.map(|a: f64| 1.0 / (3.0 * (1.0 + a).powi(2)));
    let all = part.iter().map(|v| 1.0 + v).product::<f64>();
    let v = all - 1.0;
    Known {
        name: "g",
        evaluate_at: Box::new(move |x: &[f64]| {
            x.iter()
                .zip(a)
                .map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a))
                .product()
        }),
        first: part.iter().map(|p| p / v).collect(),
        total: part.iter().map(|p| p * all / (1.0 + p) / v).collect(),
    }
}

/// 100 + 3 x + 2 y + z + 0 w: far from zero, additive, the last factor inert.
pub fn additive() -> Known {
    let c = [3.0, 2.0, 1.0, 0.0];
    let share: Vec<f64> = c.iter().map(|c| c * c / 14.0).collect();
    let evaluate_at = move |x: &[f64]| 100.0 + x.iter().zip(c).map(|(x, c)| x * c).sum::<f64>();
    Known {
        name: "additive",
        evaluate_at: Box::new(evaluate_at),
        first: share.clone(),
        total: share,
    }
}

/// Outputs by column: A, B, AB_1 ...
pub struct Outputs(pub Vec<Vec<f64>>);

impl Outputs {
    pub fn blocks(&self) -> Blocks<'_> {
        Blocks {
            a: &self.0[0],
            b: &self.0[1],
            ab: self.0[2..].iter().map(Vec::as_slice).collect(),
        }
    }

    /// Evaluates points of 2 d numbers: those of A, then those of B.
    pub fn evaluate(known: &Known, points: impl Iterator<Item = Vec<f64>>) -> Self {
        let d = known.first.len();
        let mut columns = vec![Vec::new(); d + 2];
        for point in points {
            let (a, b) = point.split_at(d);
            columns[0].push((known.evaluate_at)(a));
            columns[1].push((known.evaluate_at)(b));
            for i in 0..d {
                let mut mixed = a.to_vec();
                mixed[i] = b[i];
                columns[i + 2].push((known.evaluate_at)(&mixed));
            }
        }
        Outputs(columns)
    }

    /// Evaluates an Owen-scrambled Sobol sequence.
    pub fn sobol(known: &Known, n: u32, seed: u32) -> Self {
        let d = known.first.len() as u32;
        Self::evaluate(
            known,
            (0..n).map(|i| {
                (0..2 * d)
                    .map(|k| f64::from(sobol_burley::sample(i, k, seed)))
                    .collect()
            }),
        )
    }

    /// Evaluates independent draws.
    pub fn random(known: &Known, n: usize, seed: u64) -> Self {
        let mut random = Pcg64::seed_from_u64(seed);
        let d = known.first.len();
        Self::evaluate(
            known,
            (0..n).map(|_| (0..2 * d).map(|_| random.random::<f64>()).collect()),
        )
    }
}
