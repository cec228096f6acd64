//! Sobol indices: which factor makes how much of an output's variance.
//!
//! | label | statement | status |
//! |---|---|---|
//! | SO-1 | f = y - c, c the mean of all N (d + 2) outputs | derived: an index does not change with a shift of y, the error of SO-3 does |
//! | SO-2 | V = mean(f^2) - mean(f)^2 over the 2 N outputs of A and B | source: Saltelli et al. 2010, doi 10.1016/j.cpc.2009.09.018 |
//! | SO-3 | S_i = mean(f(B) (f(AB_i) - f(A))) / V | source: Saltelli et al. 2010, Table 2 (b) |
//! | SO-4 | T_i = mean((f(A) - f(AB_i))^2) / (2 V) | source: Jansen 1999, doi 10.1016/S0010-4655(98)00154-4 |
//! | SO-5 | interval: quantiles a and 1 - a (DS-3; a of IV-1) of the indices of resamples, each N samples drawn with replacement, all d + 2 outputs of a sample together | source: Efron 1979; Archer, Saltelli and Sobol 1997 |
//!
//! A and B are independent designs of N samples; AB_i is A with the column of factor i from B. S_i is the share of the variance that goes
//! with factor i alone, T_i the share that would be left if only factor i stayed unknown; T_i - S_i is what it does together with others.
//! An estimate of a small S_i can lie below 0.
//!
//! A sample in which any of the d + 2 outputs is missing is left out whole and counted. An output without variance (standard deviation
//! below 64 roundings of its largest value) has no indices: all are NaN, without intervals; a resample without variance is left out, and
//! `resamples` says how many are in. SO-5 is made for independent samples. For a Sobol sequence, whose true error is mostly smaller by
//! far, the intervals are mostly too wide; but in few samples a poor projection of the sequence can put an index of a factor that does next
//! to nothing outside of its interval (g function of 8 factors, 200 scramblings: S_6 = 7e-5 is missed by up to 0.003, 9 standard
//! errors, at N = 2048, and by no more than 2 standard errors from N = 4096 on; another generator of the sequence does the same). Hold the
//! answer against more samples. The same seed gives the same intervals on any number of threads.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::Serialize;

use super::describe::quantile_of_sorted;
use super::{Confidence, Estimate};

/// Outputs of a Saltelli design, sample by sample. Where a column is shorter than others, its outputs are missing.
#[derive(Clone, Debug, Default)]
pub struct Blocks<'a> {
    /// Outputs at the rows of A.
    pub a: &'a [f64],
    /// Outputs at the rows of B.
    pub b: &'a [f64],
    /// Outputs at the rows of A with one factor from B, by factor.
    pub ab: Vec<&'a [f64]>,
}

/// How intervals are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    /// Number of resamples.
    pub resamples: usize,
    /// Seed.
    pub seed: u64,
    /// Confidence of the intervals.
    pub confidence: Confidence,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Bootstrap {
            resamples: 1000,
            seed: 1,
            confidence: Confidence::default(),
        }
    }
}

/// Indices of one factor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FactorIndices {
    /// S_i.
    pub first: Estimate,
    /// T_i.
    pub total: Estimate,
}

/// Indices of all factors for one output.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SobolIndices {
    /// Number of samples used, N.
    pub samples: usize,
    /// Number of samples left out, for an output of them is missing.
    pub missing: usize,
    /// Variance of the output, V of SO-2.
    pub variance: f64,
    /// By factor, in the order of the blocks.
    pub factors: Vec<FactorIndices>,
    /// Sum of all S_i: 1 where factors only add up.
    pub sum_first: Estimate,
    /// Number of resamples behind the intervals.
    pub resamples: usize,
}

/// Indices from all samples.
pub fn sobol_indices(blocks: &Blocks, bootstrap: Bootstrap) -> SobolIndices {
    let table = Table::new(blocks);
    let Some(point) = table.indices(None) else {
        return table.without_indices();
    };
    let resample = |k| table.indices(Some(&table.draw(bootstrap.seed, k)));
    let resamples = (0..bootstrap.resamples).into_par_iter();
    let drawn: Vec<Indices> = resamples.filter_map(resample).collect();
    let estimate = |of: &(dyn Fn(&Indices) -> f64 + Sync)| Estimate {
        value: of(&point),
        interval: percentile(&drawn, bootstrap.confidence, of),
    };
    let factor = |i: usize| FactorIndices {
        first: estimate(&|d| d.first[i]),
        total: estimate(&|d| d.total[i]),
    };
    SobolIndices {
        samples: table.samples,
        missing: table.missing,
        variance: point.variance,
        factors: (0..table.factors).into_par_iter().map(factor).collect(),
        sum_first: estimate(&|d| d.first.iter().sum()),
        resamples: drawn.len(),
    }
}

/// Indices from the first N/16, N/8, N/4, N/2 and all N samples, to see whether they have settled. Sizes below two samples are left out.
pub fn sobol_convergence(blocks: &Blocks, bootstrap: Bootstrap) -> Vec<SobolIndices> {
    let sizes = [16, 8, 4, 2, 1].map(|part| blocks.samples() / part);
    let indices = |n| sobol_indices(&blocks.first(n), bootstrap);
    sizes.into_iter().filter(|n| *n >= 2).map(indices).collect()
}

impl<'a> Blocks<'a> {
    /// Number of samples, with and without outputs.
    pub fn samples(&self) -> usize {
        let columns = self.ab.iter().chain([&self.a, &self.b]);
        columns.map(|column| column.len()).max().unwrap_or(0)
    }

    /// The first samples of a design.
    pub fn first(&self, samples: usize) -> Self {
        let cut = |column: &'a [f64]| &column[..samples.min(column.len())];
        Blocks {
            a: cut(self.a),
            b: cut(self.b),
            ab: self.ab.iter().map(|column| cut(column)).collect(),
        }
    }
}

/// Outputs of the samples without gaps, shifted by their mean (SO-1): a row is a sample, f(A), f(B), f(AB_1) ...
struct Table {
    rows: Vec<f64>,
    factors: usize,
    samples: usize,
    missing: usize,
    /// Variance up to which an output is constant.
    constant: f64,
}

/// Indices from one draw of samples.
struct Indices {
    first: Vec<f64>,
    total: Vec<f64>,
    variance: f64,
}

impl Table {
    fn new(blocks: &Blocks) -> Self {
        let first = [blocks.a, blocks.b].into_iter();
        let columns: Vec<&[f64]> = first.chain(blocks.ab.iter().copied()).collect();
        let (all, width) = (blocks.samples(), columns.len());
        let mut rows = Vec::with_capacity(all * width);
        for i in 0..all {
            let start = rows.len();
            let row = columns.iter().filter_map(|column| column.get(i));
            rows.extend(row.filter(|y| y.is_finite()));
            if rows.len() < start + width {
                rows.truncate(start);
            }
        }
        let samples = rows.len() / width;
        let centre = rows.iter().sum::<f64>() / (rows.len().max(1)) as f64; // SO-1
        let largest = rows.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        rows.iter_mut().for_each(|y| *y -= centre); // SO-1
        let constant = (64.0 * f64::EPSILON * largest).powi(2);
        Table {
            rows,
            factors: width - 2,
            samples,
            missing: all - samples,
            constant,
        }
    }

    /// Number of times that each sample occurs in a resample.
    fn draw(&self, seed: u64, resample: usize) -> Vec<u32> {
        // Every resample has its own generator, so that no thread's draws depend on another's. The factor spreads the seeds out.
        let mut random =
            Pcg64::seed_from_u64(seed ^ (resample as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let mut counts = vec![0; self.samples];
        for _ in 0..self.samples {
            let at = random.random_range(0..self.samples as u64);
            counts[at as usize] += 1;
        }
        counts
    }

    /// Indices of the samples, each as often as it is counted; once without counts. `None` without variance.
    fn indices(&self, counts: Option<&[u32]>) -> Option<Indices> {
        let (d, n) = (self.factors, self.samples as f64);
        let (mut all, mut ab, mut squares) = (0.0, 0.0, 0.0);
        // Sums of f(B) e, e and e^2 by factor, with e = f(AB) - f(A).
        let mut sums = vec![[0.0; 3]; d];
        for (j, row) in self.rows.chunks_exact(d + 2).enumerate() {
            let w = f64::from(counts.map_or(1, |counts| counts[j]));
            let (a, b) = (row[0], row[1]);
            all += w * row.iter().sum::<f64>();
            ab += w * (a + b);
            squares += w * (a * a + b * b);
            for (sum, y) in sums.iter_mut().zip(&row[2..]) {
                let e = y - a;
                sum[0] += w * b * e;
                sum[1] += w * e;
                sum[2] += w * e * e;
            }
        }
        let variance = squares / (2.0 * n) - (ab / (2.0 * n)).powi(2); // SO-2
        let varies = variance > self.constant && variance.is_finite();
        if self.samples < 2 || !varies {
            return None;
        }
        let centre = all / (n * (d + 2) as f64); // SO-1, of these samples
        let first = |s: &[f64; 3]| (s[0] - centre * s[1]) / n / variance; // SO-3
        let total = |s: &[f64; 3]| s[2] / n / (2.0 * variance); // SO-4
        Some(Indices {
            first: sums.iter().map(first).collect(),
            total: sums.iter().map(total).collect(),
            variance,
        })
    }

    /// Gives indices of NaN for a constant or too few samples.
    fn without_indices(&self) -> SobolIndices {
        let none = FactorIndices {
            first: Estimate::NONE,
            total: Estimate::NONE,
        };
        SobolIndices {
            samples: self.samples,
            missing: self.missing,
            variance: if self.samples < 2 { f64::NAN } else { 0.0 },
            factors: vec![none; self.factors],
            sum_first: Estimate::NONE,
            resamples: 0,
        }
    }
}

/// Interval of an index over the resamples (SO-5).
fn percentile(
    drawn: &[Indices],
    confidence: Confidence,
    of: &(dyn Fn(&Indices) -> f64 + Sync),
) -> Option<[f64; 2]> {
    if drawn.len() < 2 {
        return None;
    }
    let mut values: Vec<f64> = drawn.iter().map(of).collect();
    values.sort_unstable_by(f64::total_cmp);
    let tail = confidence.tail();
    Some([tail, 1.0 - tail].map(|p| quantile_of_sorted(&values, p)))
}
