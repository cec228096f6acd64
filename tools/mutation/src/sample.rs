//! A sample of the mutants, spread over all files.

use crate::point::Point;

/// One mutant from each of `count` equal parts of the list, which is in the order of files and lines. The same seed draws the same ones.
#[must_use]
pub fn draw(points: Vec<Point>, count: usize, seed: u64) -> Vec<Point> {
    let all: usize = points.iter().map(|p| p.choices.len()).sum();
    if count >= all {
        return points;
    }
    let mut random = fastrand::Rng::with_seed(seed);
    let mut drawn =
        (0..count).map(|part| random.usize(part * all / count..(part + 1) * all / count));
    let mut next = drawn.next();
    let mut place = 0;
    let mut out = Vec::new();
    for mut point in points {
        point.choices.retain(|_| {
            let keep = next == Some(place);
            if keep {
                next = drawn.next();
            }
            place += 1;
            keep
        });
        if !point.choices.is_empty() {
            out.push(point);
        }
    }
    out
}
