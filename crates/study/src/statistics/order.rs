//! Numbers at wanted places of an ascending order, without the order: bins around the wanted places become narrower pass by pass, until what is in
//! them can be held. The numbers are those that a sort of all would give, bit by bit.

use super::passes::{Numbers, each};
use super::spread::Spread;

/// Numbers that are held and sorted at most, and bins of a pass.
const HELD: usize = 1 << 17;

/// Numbers at some places, counted from 0.
#[derive(Clone, Debug, Default)]
pub(super) struct Ordered {
    n: usize,
    /// Ascending.
    found: Vec<(usize, f64)>,
}

/// A range of keys in which wanted places lie.
struct Range {
    low: u64,
    high: u64,
    /// Numbers below it.
    before: usize,
    /// Numbers in it.
    count: usize,
}

impl Range {
    /// The wanted places in it.
    fn select<'w>(&self, wanted: &'w [usize]) -> &'w [usize] {
        let from = wanted.partition_point(|place| *place < self.before);
        let to = wanted.partition_point(|place| *place < self.before + self.count);
        &wanted[from..to]
    }
}

impl Ordered {
    /// The finite numbers at some places of their order; places beyond the last number have none.
    pub(super) fn new<P: Numbers + ?Sized>(
        numbers: &P,
        spread: &Spread,
        places: impl IntoIterator<Item = usize>,
    ) -> Result<Self, P::Error> {
        Self::with(numbers, spread, places, HELD)
    }

    fn with<P: Numbers + ?Sized>(
        numbers: &P,
        spread: &Spread,
        places: impl IntoIterator<Item = usize>,
        held: usize,
    ) -> Result<Self, P::Error> {
        let n = spread.n;
        let mut wanted: Vec<usize> = places.into_iter().filter(|place| *place < n).collect();
        wanted.sort_unstable();
        wanted.dedup();
        let mut found = Vec::with_capacity(wanted.len());
        // One further on both sides: of zero and minus zero, whose keys are neighbours, the ends may be either.
        let all = Range {
            low: key(spread.min).saturating_sub(1),
            high: key(spread.max).saturating_add(1),
            before: 0,
            count: n,
        };
        let mut open = vec![all];
        while !wanted.is_empty() && !open.is_empty() {
            if open.iter().map(|range| range.count).sum::<usize>() <= held {
                found.extend(sorted(numbers, &open, &wanted)?);
                break;
            }
            open = narrowed(numbers, &open, &wanted, held)?;
            // Numbers of one key are known.
            for range in open.iter().filter(|range| range.low == range.high) {
                let places = range.select(&wanted).iter();
                found.extend(places.map(|place| (*place, number(range.low))));
            }
            open.retain(|range| range.low < range.high);
        }
        found.sort_unstable_by_key(|(place, _)| *place);
        Ok(Ordered { n, found })
    }

    /// The number at a place; none where there is none, or it was not wanted.
    pub(super) fn at(&self, place: usize) -> Option<f64> {
        let at = self.found.binary_search_by_key(&place, |(at, _)| *at);
        at.ok().map(|k| self.found[k].1)
    }

    /// Quantile by DS-3; NaN of none.
    pub(super) fn quantile(&self, p: f64) -> f64 {
        let Some((k, next, share)) = between(self.n, p) else {
            return f64::NAN;
        };
        let (Some(low), Some(high)) = (self.at(k), self.at(next)) else {
            return f64::NAN;
        };
        low + share * (high - low) // DS-3
    }
}

/// The two places, counted from 0, between which a quantile lies, and how far; none of no numbers.
pub(super) fn between(n: usize, p: f64) -> Option<(usize, usize, f64)> {
    let last = n.checked_sub(1)?;
    let h = last as f64 * p.clamp(0.0, 1.0); // DS-3, counted from 0
    let k = (h.floor() as usize).min(last);
    Some((k, (k + 1).min(last), h - h.floor()))
}

/// Where a number is in the order of [`f64::total_cmp`].
fn key(x: f64) -> u64 {
    const SIGN: u64 = 1 << 63;
    match x.to_bits() {
        bits if bits & SIGN == 0 => bits | SIGN,
        bits => !bits,
    }
}

/// The number of a key.
fn number(key: u64) -> f64 {
    const SIGN: u64 = 1 << 63;
    f64::from_bits(if key & SIGN == 0 { !key } else { key & !SIGN })
}

/// The range in which a number is.
fn place(open: &[Range], key: u64) -> Option<usize> {
    let k = open.partition_point(|range| range.high < key);
    open.get(k).filter(|range| range.low <= key).map(|_| k)
}

/// Sorts what is in the ranges.
fn sorted<P: Numbers + ?Sized>(
    numbers: &P,
    open: &[Range],
    wanted: &[usize],
) -> Result<Vec<(usize, f64)>, P::Error> {
    let mut held = Vec::new();
    each(numbers, |x| {
        if x.is_finite() && place(open, key(x)).is_some() {
            held.push(x);
        }
    })?;
    held.sort_unstable_by(f64::total_cmp);
    let (mut found, mut start) = (Vec::new(), 0);
    for range in open {
        let places = range.select(wanted).iter();
        found.extend(places.map(|place| (*place, held[start + place - range.before])));
        start += range.count;
    }
    Ok(found)
}

/// The bins of the ranges in which wanted places are.
fn narrowed<P: Numbers + ?Sized>(
    numbers: &P,
    open: &[Range],
    wanted: &[usize],
    bins: usize,
) -> Result<Vec<Range>, P::Error> {
    let bins = (bins / open.len()).max(2);
    // A bin has 2^shift keys.
    let shift = |range: &Range| {
        let within = |shift: &u32| ((range.high - range.low) >> shift) < bins as u64;
        (0..u64::BITS).find(within).unwrap_or(u64::BITS - 1)
    };
    let shifts: Vec<u32> = open.iter().map(shift).collect();
    let mut counts = vec![0_usize; bins * open.len()];
    each(numbers, |x| {
        let key = key(x);
        if let Some(k) = place(open, key).filter(|_| x.is_finite()) {
            counts[k * bins + ((key - open[k].low) >> shifts[k]) as usize] += 1;
        }
    })?;
    let mut narrow = Vec::new();
    for ((range, shift), counts) in open.iter().zip(shifts).zip(counts.chunks_exact(bins)) {
        let mut before = range.before;
        for (bin, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let low = range.low + ((bin as u64) << shift);
            let last = low.saturating_add((1 << shift) - 1);
            let own = Range {
                low,
                high: last.min(range.high),
                before,
                count: *count,
            };
            before += count;
            if !own.select(wanted).is_empty() {
                narrow.push(own);
            }
        }
    }
    Ok(narrow)
}

#[cfg(test)]
mod tests {
    use super::super::passes::Moments;
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Truth: a sort of all numbers. Held are 7, so that every path is taken.
    #[test]
    fn val_places_are_those_of_a_sort() {
        let mut random = Pcg64::seed_from_u64(5);
        let spread_out: Vec<f64> = (0..3000)
            .map(|_| (random.random::<f64>() - 0.5) * 10f64.powi(random.random_range(-300..300)))
            .collect();
        let close: Vec<f64> = (0..3000)
            .map(|_| 7.0 + 1e-13 * random.random::<f64>())
            .collect();
        let ties: Vec<f64> = (0..3000).map(|k| f64::from(k % 3) - 1.0).collect();
        let zeros = vec![
            0.0,
            -0.0,
            f64::NAN,
            -0.0,
            0.0,
            0.0,
            -0.0,
            0.0,
            -0.0,
            0.0,
            f64::INFINITY,
        ];
        let lone = vec![f64::MAX; 40];
        for numbers in [spread_out, close, ties, zeros, lone, vec![3.0], Vec::new()] {
            let mut sorted: Vec<f64> = numbers.iter().copied().filter(|x| x.is_finite()).collect();
            sorted.sort_unstable_by(f64::total_cmp);
            let Ok(spread) = Moments::compute(numbers.as_slice());
            let places = (0..sorted.len() + 3).step_by(1 + sorted.len() / 50);
            for held in [7, 64, HELD] {
                let Ok(found) = Ordered::with(numbers.as_slice(), &spread, places.clone(), held);
                for place in places.clone() {
                    let (found, truth) = (found.at(place), sorted.get(place));
                    assert_eq!(
                        found.map(f64::to_bits),
                        truth.map(|x| x.to_bits()),
                        "{place}"
                    );
                }
            }
        }
    }
}
