//! Sensitivity from any sample: rank correlation, and regression on ranks.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RK-1 | rho_i = correlation of rank(x_i) and rank(y); equal values share the mean of their ranks | source: Spearman 1904 |
//! | RK-2 | interval of rho: tanh(atanh(rho) -+ z sqrt((1 + rho^2 / 2) / (n - 3))), z of IV-1, 1.96 of 95 % | source: Fisher 1921; variance for ranks of Bonett and Wright 2000 |
//! | RK-3 | b = R^-1 rho, least squares on standardized ranks; R correlations of the ranks of the factors; R2 = b rho | source: Iman and Conover 1979 |
//! | RK-4 | interval of b: b_i -+ t(n - d - 1) sqrt((1 - R2) (R^-1)_ii / (n - d - 1)) | source: linear least squares; for ranks an approximation, ASSUMED good enough |
//!
//! A row in which the output or any factor is missing is left out whole and counted. A factor that does not vary has neither coefficient and
//! takes no part in the regression; where factors follow from each other (one inflates another's variance beyond 1e8) no factor has an RK-3.
//! A Saltelli design may give only the rows of A and B. Both coefficients see what rises or falls throughout; R2 says how much of the
//! ranks of the output they explain. Where it is low, ask for Sobol indices.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

use super::intervals::{normal, student};
use super::{Confidence, Estimate};

/// Largest inflation of a variance up to which factors are counted as independent.
const MAX_INFLATION: f64 = 1e8;

/// One factor against an output.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RankFactor {
    /// Spearman's rank correlation, RK-1.
    pub spearman: Estimate,
    /// Standardized rank regression coefficient, RK-3.
    pub regression: Estimate,
}

/// All factors against an output.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RankSensitivity {
    /// Number of rows used.
    pub n: usize,
    /// Number of rows left out, for a value of them is missing.
    pub missing: usize,
    /// Share of the variance of the output's ranks that the regression explains; NaN without a regression.
    pub r_squared: f64,
    /// By factor.
    pub factors: Vec<RankFactor>,
}

/// Rank correlation and rank regression of an output on factors that are numbers. Where a column is shorter, its values are missing.
pub fn rank_sensitivity(
    factors: &[&[f64]],
    output: &[f64],
    confidence: Confidence,
) -> RankSensitivity {
    let columns = || factors.iter().chain([&output]);
    let all = columns().map(|x| x.len()).max().unwrap_or(0);
    let is_known = |i: usize| columns().all(|x| x.get(i).is_some_and(|x| x.is_finite()));
    let kept: Vec<usize> = (0..all).filter(|&i| is_known(i)).collect();
    let n = kept.len();
    let pick = |column: &[f64]| kept.iter().map(|&i| column[i]).collect::<Vec<_>>();
    let standard = |column: &[f64]| standardized(&ranks(&pick(column)));
    let y = standard(output);
    let x: Vec<Option<Vec<f64>>> = factors.par_iter().map(|column| standard(column)).collect();
    let rho = |x: &Option<Vec<f64>>| match (x, &y) {
        (Some(x), Some(y)) => dot(x, y).clamp(-1.0, 1.0), // RK-1
        _ => f64::NAN,
    };
    let rho: Vec<f64> = x.iter().map(rho).collect();
    let varied: Vec<usize> = (0..x.len()).filter(|&i| !rho[i].is_nan()).collect();
    let columns: Vec<&Vec<f64>> = varied.iter().filter_map(|&i| x[i].as_ref()).collect();
    let with_output = DVector::from_iterator(varied.len(), varied.iter().map(|&i| rho[i]));
    let (r_squared, found) = regression(&columns, &with_output, n, confidence)
        .unwrap_or((f64::NAN, vec![Estimate::NONE; varied.len()]));
    let mut regression = vec![Estimate::NONE; x.len()];
    for (i, estimate) in varied.into_iter().zip(found) {
        regression[i] = estimate;
    }
    let factor = |(rho, regression)| RankFactor {
        spearman: Estimate {
            value: rho,
            interval: fisher(rho, n, confidence),
        },
        regression,
    };
    RankSensitivity {
        n,
        missing: all - n,
        r_squared,
        factors: rho.into_iter().zip(regression).map(factor).collect(),
    }
}

/// Ranks from 1; equal values share the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_unstable_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut ranks = vec![0.0; values.len()];
    let mut before = 0;
    // Zero and minus zero are one value.
    for tied in order.chunk_by(|&i, &j| values[i] >= values[j]) {
        let mean = before as f64 + 0.5 * (tied.len() + 1) as f64;
        tied.iter().for_each(|&i| ranks[i] = mean);
        before += tied.len();
    }
    ranks
}

/// Shifted to mean 0 and scaled to length 1; `None` of a constant.
fn standardized(ranks: &[f64]) -> Option<Vec<f64>> {
    let mean = 0.5 * (ranks.len() + 1) as f64;
    let length = ranks.iter().map(|r| (r - mean).powi(2)).sum::<f64>().sqrt();
    (length > 0.0).then(|| ranks.iter().map(|r| (r - mean) / length).collect())
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// R2 and coefficients with intervals; `None` where there are too few rows or the factors are not independent.
fn regression(
    x: &[&Vec<f64>],
    rho: &DVector<f64>,
    n: usize,
    confidence: Confidence,
) -> Option<(f64, Vec<Estimate>)> {
    let d = x.len();
    let freedom = n.checked_sub(d + 1).filter(|f| *f > 0 && d > 0)? as f64;
    let pair = |k: usize| dot(x[k / d], x[k % d]);
    let pairs: Vec<f64> = (0..d * d).into_par_iter().map(pair).collect();
    let inverse = DMatrix::from_vec(d, d, pairs).cholesky()?.inverse();
    let is_independent = |inflation: &f64| *inflation <= MAX_INFLATION;
    if !inverse.diagonal().iter().all(is_independent) {
        return None;
    }
    let b = &inverse * rho; // RK-3
    let r_squared = b.dot(rho).clamp(0.0, 1.0); // RK-3
    let t = student(freedom, confidence.tail());
    let estimate = |i: usize| {
        let half = t * ((1.0 - r_squared) * inverse[(i, i)] / freedom).sqrt(); // RK-4
        Estimate {
            value: b[i],
            interval: Some([b[i] - half, b[i] + half]),
        }
    };
    Some((r_squared, (0..d).map(estimate).collect()))
}

fn fisher(rho: f64, n: usize, confidence: Confidence) -> Option<[f64; 2]> {
    if n < 4 || rho.is_nan() {
        return None;
    }
    let half = normal(confidence.tail()) * ((1.0 + 0.5 * rho * rho) / (n as f64 - 3.0)).sqrt();
    Some([-half, half].map(|shift| (rho.atanh() + shift).tanh())) // RK-2
}
