//! Value of information: how much of an output's spread would be left if one factor were known.
//!
//! | label | statement | status |
//! |---|---|---|
//! | IN-1 | E(Var(y \| x_i)) = V (1 - S_i); deviation left = sd sqrt(1 - S_i) | source: Saltelli et al. 2008, "Global sensitivity analysis", 1.2.3; Oakley 2009, doi 10.1287/opre.1090.0687 |
//! | IN-2 | S_i from draws: m = floor(sqrt n) groups of equal size in the order of x_i (or its values, if they are m or fewer); S_i = 1 - (1 - eta^2) (n - 1) / (n - m), eta^2 of GR-1 | source: Plischke, Borgonovo, Smith 2013, doi 10.1016/j.ejor.2012.11.047; adjusted for the number of groups as Ezekiel 1930 |
//! | IN-3 | noise: quantile c of the largest S_i of all factors over permutations of y | source: permutation of the largest statistic, Westfall and Young 1993; c of IV-1 |
//!
//! IN-2 needs no design of its own: any sample has it. A factor that does nothing has an S_i about 0, now above, now below; of many such
//! factors the largest is well above. So a factor counts as a cause only where its S_i is above IN-3, the noise of all of them together. Of
//! a Saltelli design SO-3 and its interval are better than both.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::Confidence;

/// Number of permutations.
const PERMUTATIONS: usize = 200;
/// Fewest draws of which groups say anything.
const FEWEST: usize = 16;

/// Values of a factor, draw by draw.
#[derive(Clone, Debug)]
pub enum Column {
    /// Numbers; those that are not finite have no place.
    Numbers(Vec<f64>),
    /// Indices of words; none where there is no word.
    Words(Vec<Option<usize>>),
}

/// Shares of an output's variance that go with one factor each.
#[derive(Clone, Debug, PartialEq)]
pub struct Shares {
    /// Number of draws used.
    pub n: usize,
    /// Number of draws left out, for they have no output.
    pub missing: usize,
    /// S_i by factor, IN-2; NaN of a factor that does not vary and of an output that does not.
    pub shares: Vec<f64>,
    /// IN-3: what the largest of as many idle factors reaches; NaN of fewer than 16 draws.
    pub noise: f64,
}

/// Shares of the variance of an output from any sample.
pub fn shares(factors: &[Column], output: &[f64], confidence: Confidence) -> Shares {
    let known: Vec<usize> = (0..output.len())
        .filter(|k| output[*k].is_finite())
        .collect();
    let n = known.len();
    let groups: Vec<Option<Groups>> = factors.iter().map(|x| Groups::new(x, &known)).collect();
    let y = standardized(known.iter().map(|k| output[*k]).collect()).filter(|_| n >= FEWEST);
    let Some(y) = y else {
        return Shares {
            n,
            missing: output.len() - n,
            shares: vec![f64::NAN; factors.len()],
            noise: f64::NAN,
        };
    };
    let share = |groups: &Option<Groups>, y: &[f64]| {
        groups.as_ref().map_or(f64::NAN, |groups| groups.share(y))
    };
    // Each permutation has its own generator: no thread's draws depend on another's.
    let largest = |k: usize| {
        let mut random = Pcg64::seed_from_u64(k as u64 + 1);
        let mut y = y.clone();
        for i in (1..n).rev() {
            y.swap(i, random.random_range(0..=i as u64) as usize);
        }
        let all = groups.iter().map(|groups| share(groups, &y));
        all.fold(f64::NAN, f64::max)
    };
    let mut largest: Vec<f64> = (0..PERMUTATIONS).into_par_iter().map(largest).collect();
    largest.sort_unstable_by(f64::total_cmp);
    Shares {
        n,
        missing: output.len() - n,
        shares: groups.iter().map(|groups| share(groups, &y)).collect(),
        noise: super::quantile_of_sorted(&largest, confidence.intervals), // IN-3
    }
}

/// Deviation that is left of `sd` when a factor with this share of the variance is known.
pub fn sd_left(sd: f64, share: f64) -> f64 {
    sd * (1.0 - share).max(0.0).sqrt() // IN-1
}

/// Mean 0 and sum of squares 1; `None` of an output that does not vary.
fn standardized(mut y: Vec<f64>) -> Option<Vec<f64>> {
    let n = y.len() as f64;
    let mean = y.iter().sum::<f64>() / n;
    let largest = y.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
    y.iter_mut().for_each(|y| *y -= mean);
    let length = y.iter().map(|y| y * y).sum::<f64>().sqrt();
    let varies = length > 64.0 * f64::EPSILON * largest * n.sqrt();
    varies.then(|| y.into_iter().map(|y| y / length).collect())
}

/// The group of each draw.
struct Groups {
    group: Vec<usize>,
    sizes: Vec<f64>,
}

impl Groups {
    /// Groups of the draws that are known; none of a factor that does not vary, or that has no value at some draw.
    fn new(column: &Column, known: &[usize]) -> Option<Self> {
        let n = known.len();
        let most = (n as f64).sqrt().floor() as usize; // IN-2
        let group: Vec<usize> = match column {
            Column::Words(words) => known
                .iter()
                .map(|k| words.get(*k).copied().flatten())
                .collect::<Option<_>>()?,
            Column::Numbers(numbers) => {
                let x = known.iter().map(|k| numbers.get(*k).copied());
                let x: Vec<f64> = x
                    .map(|x| x.filter(|x| x.is_finite()))
                    .collect::<Option<_>>()?;
                let mut order: Vec<usize> = (0..n).collect();
                order.sort_by(|i, j| x[*i].total_cmp(&x[*j]));
                let new = |k: usize| k == 0 || x[order[k]] > x[order[k - 1]];
                let values = (0..n).filter(|k| new(*k)).count();
                let (mut group, mut value) = (vec![0; n], 0);
                for (k, draw) in order.iter().enumerate() {
                    value += usize::from(new(k));
                    group[*draw] = match values <= most {
                        true => value - 1,
                        false => k * most / n,
                    };
                }
                group
            }
        };
        let count = group.iter().max().map_or(0, |last| last + 1);
        let mut sizes = vec![0.0; count];
        group.iter().for_each(|g| sizes[*g] += 1.0);
        let filled = sizes.iter().filter(|size| **size > 0.0).count();
        (1 < filled && filled < n).then_some(Groups { group, sizes })
    }

    /// S_i of a standardized output.
    fn share(&self, y: &[f64]) -> f64 {
        let mut sums = vec![0.0; self.sizes.len()];
        self.group.iter().zip(y).for_each(|(g, y)| sums[*g] += y);
        let filled = || {
            self.sizes
                .iter()
                .zip(&sums)
                .filter(|(size, _)| **size > 0.0)
        };
        let between: f64 = filled().map(|(size, sum)| sum * sum / size).sum(); // GR-1
        let (n, m) = (y.len() as f64, filled().count() as f64);
        1.0 - (1.0 - between) * (n - 1.0) / (n - m) // IN-2
    }
}
