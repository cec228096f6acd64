//! Wheel work over a whole cycle.

use cvtcycle_config::cycle::embedded;
use cvtcycle_model::road::RoadLoad;

fn rover() -> RoadLoad {
    RoadLoad {
        f0_n: 6.3,
        f1_n_per_m_s: 0.0,
        f2_n_per_m_s2: 0.0433 * 12.96,
        mass_kg: 1130.0,
        inertia_kg: 1130.0 * 1.015,
        wheel_radius_m: 0.2832,
    }
}

fn work(automatic: bool, dt: f64) -> (f64, f64) {
    let cycle = embedded("ece15_eudc").expect("embedded");
    let car = rover();
    cycle
        .trace_for(automatic)
        .steps(dt)
        .fold((0.0, 0.0), |(p, n), s| {
            let w = car.wheel(&s, 0.0);
            (p + w.positive_j, n + w.negative_j)
        })
}

/// Outside truth: the project's independent calculation, within 1e-4, at any step.
#[test]
fn val_wheel_work() {
    for (automatic, want) in [(true, 3403.32e3), (false, 3413.28e3)] {
        for dt in [1.0, 0.25] {
            let (p, n) = work(automatic, dt);
            assert!((p / want - 1.0).abs() < 1e-4, "{p}");
            assert!((n / -1103.40e3 - 1.0).abs() < 1e-4, "{n}");
        }
    }
}
