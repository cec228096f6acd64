//! Points of a design: from an index to a value of each factor.
//!
//! Everything here is a function of the seed, the point and the factor alone: points can be computed in any order and on any number of
//! threads, and memory does not grow with their number.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DE-5 | grid: the point's digits in the mixed radix of the factors' numbers of values, last factor fastest | derived |
//! | DE-6 | Latin hypercube: share = (stratum + jitter)/n, the stratum from a permutation of each factor's own (DE-3), the jitter a draw (DE-2) | source: McKay, Beckman, Conover 1979, doi 10.1080/00401706.1979.10489755 |
//! | DE-7 | Sobol sequence, Owen-scrambled, moved up by half of its resolution 2^-23 | source: Burley 2020, JCGT 9(4), by the crate sobol_burley; the half step derived |
//! | DE-8 | Saltelli: of one Sobol point in 2 d dimensions the first d are A_j, the others B_j; AB_j(i) is A_j with factor i from B_j. Points in the order A_j, B_j, AB_j(1) ... AB_j(d), then the next j | source: Saltelli et al. 2010, doi 10.1016/j.cpc.2009.09.018; order ours |
//! | DE-10 | forms: of n samples sample j has the form m with W_(m-1) <= (p(j) + 1/2)/n < W_m, p a permutation of its own (DE-3), W the sums of the weights over their total; a draw (DE-2) in Monte Carlo | derived |

mod draw;

use super::plan::{Design, Factor, FactorValues, within};
pub use super::plan::{Level, MAX_SOBOL_SAMPLES};
use draw::{Purpose, mix, permute, uniform};

/// Saltelli matrix that a point belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// First independent sample.
    A,
    /// Second independent sample.
    B,
    /// A, with this factor (counted from 0) from B.
    AB(usize),
}

/// Half of the resolution of the Sobol sequence (DE-7).
const HALF_STEP: f64 = 1.0 / (1_u64 << 24) as f64;

/// Steps of the jitter within a stratum: few enough that stratum and jitter are added without rounding.
const JITTER: f64 = (1_u64 << 20) as f64;

/// Draws that are looked through for the exact ends of a factor.
const LOOKED_THROUGH: u64 = 1 << 20;

/// Saltelli's role of a point among `factors` factors, and the sample it belongs to, which has `factors + 2` points in a row.
pub fn saltelli_role(factors: usize, point: u64) -> (u64, Role) {
    let block = factors as u64 + 2;
    let role = match point % block {
        0 => Role::A,
        1 => Role::B,
        column => Role::AB(column as usize - 2),
    };
    (point / block, role)
}

impl Design {
    /// Number of points; none where it is too large to be counted.
    pub fn points(&self, factors: &[Factor]) -> Option<u64> {
        let mut entries = factors.iter().map(|factor| self.entries(factor));
        match *self {
            Design::Grid => entries.try_fold(1_u64, u64::checked_mul),
            Design::OneAtATime { .. } => entries.try_fold(1_u64, u64::checked_add),
            Design::LatinHypercube { samples, .. }
            | Design::Sobol { samples, .. }
            | Design::MonteCarlo { samples, .. } => Some(samples),
            Design::Saltelli { samples, .. } => samples.checked_mul(factors.len() as u64 + 2),
        }
    }

    /// Position of one factor at a point below [`Design::points`].
    ///
    /// # Panics
    /// In a Sobol design if the factor's dimension is beyond [`super::plan::MAX_SOBOL_DIMENSIONS`], which no plan that was read has.
    pub fn level(&self, factors: &[Factor], point: u64, factor: usize) -> Level {
        let column = factor as u64;
        let span = factors.get(factor).and_then(|of| of.form.as_ref());
        let share = self.form_share(point, factors.len());
        if let (Some(of), Some(share)) = (span, share)
            && !within(of.span, share)
        {
            return Level::Base; // DE-10
        }
        match *self {
            Design::Grid => {
                let radix = |radix: u64, other| radix.saturating_mul(self.entries(other));
                let faster = factors.iter().skip(factor + 1).fold(1_u64, radix);
                let at = |factor: &Factor| factor.entry(point / faster % self.entries(factor), 0.5);
                factors.get(factor).map_or(Level::Base, at) // DE-5
            }
            Design::OneAtATime { quantile } => {
                let sum = |sum: u64, other| sum.saturating_add(self.entries(other));
                let before = factors.iter().take(factor).fold(1_u64, sum);
                match (point.checked_sub(before), factors.get(factor)) {
                    (Some(entry), Some(factor)) if entry < self.entries(factor) => {
                        factor.entry(entry, quantile)
                    }
                    _ => Level::Base,
                }
            }
            Design::LatinHypercube { samples, seed } => {
                let stratum = permute(point, samples, mix(seed, Purpose::Stratum, 0, column));
                let jitter = uniform(seed, Purpose::Jitter, point, column) * JITTER;
                let jitter = (jitter.floor() + 0.5) / JITTER;
                Level::Share((stratum as f64 + jitter) / samples as f64) // DE-6
            }
            Design::Sobol { seed, .. } => Level::Share(sobol(point, factor, seed)),
            Design::MonteCarlo { seed, .. } => {
                Level::Share(uniform(seed, Purpose::MonteCarlo, point, column))
            }
            Design::Saltelli { seed, .. } => {
                let (sample, role) = saltelli_role(factors.len(), point);
                let from_b = role == Role::B || role == Role::AB(factor);
                let first = if from_b { factors.len() } else { 0 };
                Level::Share(sobol(sample, first + factor, seed)) // DE-8
            }
        }
    }

    /// Share at which a point draws its form, within 0 and 1 (DE-10); none in a design that draws nothing.
    pub fn form_share(&self, point: u64, factors: usize) -> Option<f64> {
        let (sample, n, seed) = match *self {
            Design::Grid | Design::OneAtATime { .. } => return None,
            Design::MonteCarlo { seed, .. } => return Some(uniform(seed, Purpose::Form, point, 0)),
            Design::LatinHypercube { samples, seed } | Design::Sobol { samples, seed } => {
                (point, samples, seed)
            }
            Design::Saltelli { samples, seed } => (saltelli_role(factors, point).0, samples, seed),
        };
        let place = permute(sample, n, mix(seed, Purpose::Form, 0, 0));
        Some((place as f64 + 0.5) / n as f64)
    }

    /// The same design with other samples or another seed; none for a design that has neither.
    pub fn with(mut self, new_samples: Option<u64>, new_seed: Option<u64>) -> Option<Self> {
        match &mut self {
            Design::Grid | Design::OneAtATime { .. } => return None,
            Design::LatinHypercube { samples, seed }
            | Design::Sobol { samples, seed }
            | Design::MonteCarlo { samples, seed }
            | Design::Saltelli { samples, seed } => {
                *samples = new_samples.unwrap_or(*samples);
                *seed = new_seed.unwrap_or(*seed);
            }
        }
        Some(self)
    }

    /// True if the factors are drawn rather than taken one by one.
    pub fn is_sampled(&self) -> bool {
        !matches!(self, Design::Grid | Design::OneAtATime { .. })
    }

    /// Number of values that are taken of a factor where they are taken one by one. A distribution has its median in a grid, which the
    /// reader of plans refuses.
    fn entries(&self, factor: &Factor) -> u64 {
        match (&factor.values, self) {
            (FactorValues::List(values), _) => values.len().max(1) as u64,
            (FactorValues::Distribution(_), Design::OneAtATime { .. }) => 2,
            (FactorValues::Distribution(_), _) => 1,
        }
    }

    /// Least and largest share at which a factor's distribution is read: exact for up to 2^20 samples; beyond, ends that one study in a
    /// thousand passes.
    pub fn share_span(&self, factors: &[Factor], factor: usize) -> (f64, f64) {
        let wider = |(low, high): (f64, f64), share| (low.min(share), high.max(share));
        let span = |shares: &mut dyn Iterator<Item = f64>| shares.fold((1.0, 0.0), wider);
        let share = |point: u64, column: usize| match self.level(factors, point, column) {
            Level::Share(share) => share,
            Level::Base | Level::Entry(_) => 0.5,
        };
        let samples = match *self {
            Design::Grid => return (0.5, 0.5),
            Design::OneAtATime { quantile } => return (quantile, 1.0 - quantile),
            Design::Saltelli { samples, .. } => {
                let block = factors.len() as u64 + 2;
                let firsts = (0..samples).map(|sample| sample * block);
                let points = firsts.flat_map(|first| [first, first + 1]);
                return span(&mut points.map(|point| share(point, factor)));
            }
            Design::LatinHypercube { samples, .. }
            | Design::Sobol { samples, .. }
            | Design::MonteCarlo { samples, .. } => samples,
        };
        if samples <= LOOKED_THROUGH {
            return span(&mut (0..samples).map(|point| share(point, factor)));
        }
        let end = 5e-4 / samples as f64;
        (end, 1.0 - end)
    }
}

impl Factor {
    /// One of the values that are taken one by one.
    fn entry(&self, entry: u64, quantile: f64) -> Level {
        match &self.values {
            FactorValues::List(_) => Level::Entry(entry as usize),
            FactorValues::Distribution(_) => {
                Level::Share(if entry == 0 { quantile } else { 1.0 - quantile })
            }
        }
    }
}

/// A coordinate of a point of the Sobol sequence (DE-7).
fn sobol(sample: u64, dimension: usize, seed: u64) -> f64 {
    // The crate's seeds have 32 bits; its index 16.
    let seed = mix(seed, Purpose::Sobol, 0, 0) as u32;
    let index = (sample % MAX_SOBOL_SAMPLES) as u32;
    f64::from(sobol_burley::sample(index, dimension as u32, seed)) + HALF_STEP // DE-7
}
