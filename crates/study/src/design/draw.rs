//! Numbers from (seed, point, factor) alone: uniform draws and a permutation, without any state.
//!
//! | label | statement | status |
//! |---|---|---|
//! | DE-1 | mix: finalizer of splitmix64, chained over seed, point and factor | source: Steele, Lea, Flood 2014, doi 10.1145/2660193.2660195 |
//! | DE-2 | draw: first output of PCG64 seeded with the mix, (its upper 52 bits + 1/2) / 2^52: within 0 and 1, both excluded | source: O'Neill 2014 (PCG); the half step derived |
//! | DE-3 | permutation of 0..n: balanced Feistel network over the least 4^h >= n, the finalizer of DE-1 as its round function | source: Luby, Rackoff 1988, doi 10.1137/0217022 |
//! | DE-4 | repeated until the number is below n | source: Black, Rogaway 2002, doi 10.1007/3-540-45760-7_9 |
//! | DE-9 | then 0 and 1 exchanged for half of the keys: from four bits on the network gives even permutations only | derived |

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Rounds of the network; four make a good permutation of a large set, small ones need more to make all orders equally likely.
const ROUNDS: u64 = 16;

/// Purpose of a draw. Each has its own stream, so that draws for different purposes are independent.
#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose {
    MonteCarlo = 1,
    Stratum = 2,
    Jitter = 3,
    Sobol = 4,
    Form = 5,
}

/// Finalizer of splitmix64 (DE-1): a one-to-one map of 64 bits.
fn scatter(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15); // DE-1
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// 64 bits that depend on every bit of the seed, the purpose, the point and the factor.
pub(super) fn mix(seed: u64, purpose: Purpose, point: u64, factor: u64) -> u64 {
    [purpose as u64, point, factor]
        .into_iter()
        .fold(scatter(seed), |hash, word| scatter(hash ^ scatter(word))) // DE-1
}

/// Uniform within 0 and 1, both excluded (DE-2).
pub(super) fn uniform(seed: u64, purpose: Purpose, point: u64, factor: u64) -> f64 {
    let bits = Pcg64::seed_from_u64(mix(seed, purpose, point, factor)).next_u64() >> 12; // DE-2
    (bits as f64 + 0.5) / (1_u64 << 52) as f64
}

/// Place of `x` in a permutation of `0..n` that depends on `key`; `x` below `n`, `n` at most 2^62.
pub(super) fn permute(x: u64, n: u64, key: u64) -> u64 {
    let half = (1..=31).find(|half| 1_u64 << (2 * half) >= n).unwrap_or(31);
    let mut x = x;
    loop {
        x = network(x, half, key);
        // DE-4: the walk stays on the cycle of a number below n, so it comes back to one.
        if x < n {
            break;
        }
    }
    if n > 1 && x < 2 {
        x ^ (scatter(!key) & 1)
    } else {
        x
    } // DE-9
}

/// One-to-one map of the numbers of `2 half` bits (DE-3).
fn network(x: u64, half: u32, key: u64) -> u64 {
    let mask = (1_u64 << half) - 1;
    let (mut left, mut right) = (x >> half, x & mask);
    for round in 0..ROUNDS {
        (left, right) = (right, left ^ (scatter(key ^ right ^ (round << 48)) & mask)); // DE-3
    }
    left << half | right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_permutation_meets_every_number_once() {
        for n in (1..200).chain([255, 256, 257, 1000, 1023, 1024, 1025, 4097, 65_536, 100_003]) {
            for key in [0, 1, u64::MAX] {
                let mut hit = vec![false; n as usize];
                (0..n).for_each(|x| hit[permute(x, n, key) as usize] = true);
                assert!(hit.iter().all(|hit| *hit), "n {n}, key {key}");
            }
        }
    }

    /// Truth: all orders of a few are equally likely. The bounds are the 99.9 % quantiles of chi-squared for 5, 23, 119 and 719.
    #[test]
    fn val_small_permutations_are_equally_likely() {
        for (n, orders, bound) in [
            (3_u64, 6.0, 20.5),
            (4, 24.0, 49.7),
            (5, 120.0, 173.6),
            (6, 720.0, 844.0),
        ] {
            let tries = 48_000_u32;
            let mut counts = std::collections::BTreeMap::new();
            for seed in 0..tries {
                let key = mix(u64::from(seed), Purpose::Stratum, 0, 0);
                let order: Vec<u64> = (0..n).map(|x| permute(x, n, key)).collect();
                *counts.entry(order).or_insert(0_u32) += 1;
            }
            let expected = f64::from(tries) / orders;
            assert_eq!(counts.len(), orders as usize);
            let chi2: f64 = counts
                .values()
                .map(|&count| (f64::from(count) - expected).powi(2) / expected)
                .sum();
            assert!(chi2 < bound, "n {n}: chi2 {chi2}");
        }
    }

    /// Truth: the first outputs of the published generator from state 0.
    #[test]
    fn val_scatter_is_splitmix64() {
        let state = |k: u64| 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(k);
        let outputs: Vec<u64> = (0..3).map(|k| scatter(state(k))).collect();
        assert_eq!(
            outputs,
            [
                0xe220_a839_7b1d_cdaf,
                0x6e78_9e6a_a1b9_65f4,
                0x06c4_5d18_8009_454f
            ]
        );
    }

    #[test]
    fn a_draw_is_never_0_or_1() {
        for point in 0..10_000 {
            let u = uniform(1, Purpose::MonteCarlo, point, 0);
            assert!(0.0 < u && u < 1.0);
        }
        let least = 0.5 / (1_u64 << 52) as f64;
        let largest = ((u64::MAX >> 12) as f64 + 0.5) / (1_u64 << 52) as f64;
        assert!(least > 0.0 && largest < 1.0);
    }
}
