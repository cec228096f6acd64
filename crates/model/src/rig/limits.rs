//! Limits from the belt's geometry.

use crate::transmission::cvt::variator::{Belt, Geometry};

/// Ratios between which the search looks.
const FAR: (f64, f64) = (0.05, 20.0);

/// Lowest and highest ratio at which the belt fits around both pulleys and carries at least a segment on each, to three digits.
pub fn solvable_ratios(belt: &Belt) -> (f64, f64) {
    let fits = |ratio| {
        Geometry::new(ratio, belt.centre_distance_m, belt.length_m)
            .is_real(belt.length_m, belt.segment_thickness_m)
    };
    let edge = |mut good: f64, mut bad: f64| {
        if fits(bad) {
            return bad;
        }
        for _ in 0..60 {
            let middle = (good * bad).sqrt();
            if fits(middle) {
                good = middle;
            } else {
                bad = middle;
            }
        }
        good
    };
    (
        (edge(1.0, FAR.0) * 1e3).ceil() / 1e3,
        (edge(1.0, FAR.1) * 1e3).floor() / 1e3,
    )
}
