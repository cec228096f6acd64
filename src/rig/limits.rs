//! What the belt's geometry allows.

use crate::transmission::cvt::variator::{Belt, Geometry};

/// Ratios between which the search looks.
const FAR: (f64, f64) = (0.05, 20.0);

/// Lowest and highest ratio at which the belt fits around both pulleys and carries at least a segment on each, to three digits.
#[must_use]
pub fn solvable_ratios(belt: &Belt) -> (f64, f64) {
    let fits = |ratio: f64| {
        let g = Geometry::new(ratio, belt.centre_distance_m, belt.length_m);
        let arcs = [g.primary_radius_m * g.primary_wrap_rad, g.secondary_radius_m * g.secondary_wrap_rad];
        let left = arcs[0] + arcs[1] + 2.0 * g.strut_m - belt.length_m; // GE-3
        arcs.iter().all(|arc| *arc >= belt.segment_thickness_m) && left.abs() <= 1e-9 * belt.length_m
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
    ((edge(1.0, FAR.0) * 1e3).ceil() / 1e3, (edge(1.0, FAR.1) * 1e3).floor() / 1e3)
}
