//! Intervals from resampled blocks of time.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CL-1 | 90 % interval: 5 and 95 % quantiles of a statistic over 400 draws of as many blocks, with replacement; a block is 30 s of a log, or an event, whose lower and upper values give the ends | source: moving blocks, Kuensch 1989; neighbouring seconds of a drive are not independent, 30 s ASSUMED |

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// Length of a block, s.
pub const BLOCK_S: f64 = 30.0;
/// Draws.
const DRAWS: usize = 400;
/// Fewest blocks that have an interval.
const MIN_BLOCKS: usize = 4;
/// Most values that are drawn again: of more every so many is taken.
const MAX_VALUES: usize = 20_000;

/// A statistic with its interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    /// Ends of 90 % of the draws (CL-1).
    pub range: Option<[f64; 2]>,
    /// Values that it is from.
    pub count: usize,
}

/// Median of events of which each lies between two values: the middles, and the ends of 90 % of the draws of the lower and of the upper ones.
pub fn between(events: &[[f64; 2]]) -> Option<Estimate> {
    let of = |of: fn(&[f64; 2]) -> f64| {
        let list: Vec<(usize, f64)> = events.iter().map(of).enumerate().collect();
        median(&list)
    };
    let (low, high) = (of(|own| own[0].min(own[1]))?, of(|own| own[0].max(own[1]))?);
    let middle = of(|own| 0.5 * (own[0] + own[1]))?;
    let range = low
        .range
        .zip(high.range)
        .map(|(low, high)| [low[0], high[1]]);
    Some(Estimate { range, ..middle })
}

/// Median of values in blocks.
pub fn median(values: &[(usize, f64)]) -> Option<Estimate> {
    estimate(values, |list| quantile(list, 0.5))
}

/// A statistic of values in blocks; none where it has no number.
pub fn estimate<T: Copy>(
    values: &[(usize, T)],
    statistic: impl Fn(&mut [T]) -> Option<f64>,
) -> Option<Estimate> {
    let value = statistic(&mut values.iter().map(|(_, own)| *own).collect::<Vec<T>>())?;
    let mut blocks: BTreeMap<usize, Vec<T>> = BTreeMap::new();
    let every = values.len().div_ceil(MAX_VALUES).max(1);
    for (block, own) in values.iter().step_by(every) {
        blocks.entry(*block).or_default().push(*own);
    }
    let blocks: Vec<Vec<T>> = blocks.into_values().collect();
    let range = (blocks.len() >= MIN_BLOCKS).then(|| {
        let mut random = Pcg64::seed_from_u64(1);
        let mut draw = || {
            let mut list = Vec::with_capacity(values.len() / every + 1);
            for _ in 0..blocks.len() {
                list.extend_from_slice(&blocks[random.random_range(0..blocks.len())]);
            }
            statistic(&mut list)
        };
        let mut draws: Vec<f64> = (0..DRAWS).filter_map(|_| draw()).collect(); // CL-1
        let ends = [0.05, 0.95].map(|share| quantile(&mut draws, share));
        ends.map(|end| end.unwrap_or(value))
    });
    Some(Estimate {
        value,
        range,
        count: values.len(),
    })
}

/// Quantile, between two neighbours by the line.
pub fn quantile(list: &mut [f64], share: f64) -> Option<f64> {
    let last = list.len().checked_sub(1)?;
    let at = share * last as f64;
    let low = (at.floor() as usize).min(last);
    let (_, first, above) = list.select_nth_unstable_by(low, f64::total_cmp);
    let first = *first;
    let next = above.iter().copied().fold(f64::INFINITY, f64::min);
    let weight = at - low as f64;
    Some(match weight > 0.0 && next.is_finite() {
        true => first + weight * (next - first),
        false => first,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: quantiles by hand; the interval of a mean of independent blocks is 1.645 standard deviations of the mean on either side.
    #[test]
    fn quantiles_and_intervals_are_those_of_the_textbook() {
        assert_eq!(quantile(&mut [3.0, 1.0, 2.0, 4.0], 0.5), Some(2.5));
        assert_eq!(quantile(&mut [5.0], 0.95), Some(5.0));
        assert_eq!(quantile(&mut [], 0.5), None);
        let mut random = Pcg64::seed_from_u64(7);
        // 100 blocks of 5 equal values: the seconds of a block tell nothing new.
        let blocks: Vec<f64> = (0..100).map(|_| random.random_range(-1.0..1.0)).collect();
        let values: Vec<(usize, f64)> = (0..500).map(|k| (k / 5, blocks[k / 5])).collect();
        let mean = |list: &mut [f64]| Some(list.iter().sum::<f64>() / list.len() as f64);
        let found = estimate(&values, mean).unwrap();
        let [low, high] = found.range.unwrap();
        let own = blocks.iter().sum::<f64>() / 100.0;
        let variance = blocks.iter().map(|x| (x - own).powi(2)).sum::<f64>() / 100.0;
        let half = 1.645 * (variance / 100.0).sqrt();
        assert!(
            ((high - low) / (2.0 * half) - 1.0).abs() < 0.15,
            "{low} {high} {half}"
        );
        assert!(
            median(&values[..15]).unwrap().range.is_none(),
            "three blocks"
        );
    }
}
