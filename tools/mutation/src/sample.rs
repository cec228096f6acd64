//! A sample of the mutants of all files.

use crate::point::Point;

/// Draws `count` mutants: those with the smallest numbers, drawn for each by its name and the seed. A changed line changes the sample there only.
#[must_use]
pub fn draw(points: Vec<Point>, count: usize, seed: u64) -> Vec<Point> {
    let mut numbers: Vec<u64> = points
        .iter()
        .flat_map(|p| p.choices.iter().map(|c| number(&p.key(c), seed)))
        .collect();
    numbers.sort_unstable();
    let Some(limit) = numbers.get(count) else {
        return points;
    };
    let mut out = Vec::new();
    for mut point in points {
        let keys: Vec<String> = point.choices.iter().map(|c| point.key(c)).collect();
        let mut keys = keys.iter();
        point
            .choices
            .retain(|_| keys.next().is_some_and(|key| number(key, seed) < *limit));
        if !point.choices.is_empty() {
            out.push(point);
        }
    }
    out
}

/// FNV-1a of a name, mixed with the seed.
fn number(key: &str, seed: u64) -> u64 {
    let hash = key.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    fastrand::Rng::with_seed(hash ^ seed).u64(..)
}
