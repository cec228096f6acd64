//! First values of the starts.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CA-9 | the first start as given; of the n others each parameter takes one value from each n-th part of its region, in an order drawn for it; region: the bounds, or mean -+ 2 sd of the prior as far as it lies inside them | source: McKay, Beckman and Conover 1979, doi 10.2307/1268522; the region ASSUMED |

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::bounded;
use super::types::Parameter;

/// Half the width of a region in standard deviations of the prior (CA-9).
const REACH: f64 = 2.0;

fn region(parameter: &Parameter) -> [f64; 2] {
    let bounds = [parameter.low, parameter.high];
    let Some(prior) = parameter.prior else {
        return bounds;
    };
    let near = [prior.mean - REACH * prior.sd, prior.mean + REACH * prior.sd]
        .map(|x| x.clamp(parameter.low, parameter.high));
    if near[0] < near[1] { near } else { bounds }
}

/// Starts, all inside the bounds (CA-4, CA-9).
pub(super) fn starts(parameters: &[Parameter], number: usize, seed: u64) -> Vec<Vec<f64>> {
    let others = number.saturating_sub(1);
    let mut draw = Pcg64::seed_from_u64(seed);
    let mut uniform = || (draw.next_u64() >> 12) as f64 / (1_u64 << 52) as f64;
    let given = parameters.iter().map(|p| bounded::inside(p, p.start));
    let mut all = vec![given.collect::<Vec<_>>()];
    all.resize(others + 1, Vec::with_capacity(parameters.len()));
    for parameter in parameters {
        let mut order: Vec<usize> = (0..others).collect();
        for i in (1..others).rev() {
            order.swap(i, ((i + 1) as f64 * uniform()) as usize);
        }
        let [low, high] = region(parameter);
        for (start, stratum) in all[1..].iter_mut().zip(order) {
            let share = (stratum as f64 + uniform()) / others as f64; // CA-9
            start.push(bounded::inside(parameter, low + (high - low) * share));
        }
    }
    all
}
