//! Unit tests of `model::cycle::trace`.
#![allow(clippy::float_cmp, reason = "division points are promised exactly")]

use cvtcycle_model::cycle::{Interval, Step, Trace};

fn ramp(start_s: f64, end_s: f64, start_speed_m_s: f64, end_speed_m_s: f64) -> Interval {
    Interval {
        start_s,
        end_s,
        start_speed_m_s,
        end_speed_m_s,
        phase: 3,
        grade: 0.01,
        engine_off: false,
    }
}

#[test]
fn an_interval_is_cut_into_the_least_number_of_equal_parts() {
    let trace = Trace::without_gears(vec![
        ramp(0.0, 1.0, 0.0, 2.0),
        ramp(1.0, 1.05, 2.0, 2.0),
        ramp(1.05, 3.05, 2.0, 0.0),
    ]);
    for (max_dt_s, parts) in [
        (1.0, [1, 1, 2]),
        (0.5, [2, 1, 4]),
        (0.3, [4, 1, 7]),
        (0.1, [10, 1, 20]),
        (9.0, [1, 1, 1]),
    ] {
        let count = |number| {
            trace
                .steps(max_dt_s)
                .filter(|step| step.interval == number)
                .count()
        };
        assert_eq!([count(0), count(1), count(2)], parts, "{max_dt_s}");
        assert_eq!(trace.step_count(max_dt_s), parts.iter().sum::<usize>());
        let mut taken = Vec::new();
        trace.for_each_step(max_dt_s, |step| taken.push(step));
        assert!(trace.steps(max_dt_s).eq(taken));
        assert!(
            trace
                .steps(max_dt_s)
                .all(|step| step.dt_s <= max_dt_s * (1.0 + 1e-8))
        );
    }
}

#[test]
fn steps_join_without_gap_or_drift() {
    let trace = Trace::without_gears(vec![
        ramp(0.0, 700.0, 0.0, 20.0),
        ramp(700.0, 700.7, 20.0, 13.0),
    ]);
    let steps: Vec<Step> = trace.steps(0.1).collect();
    assert_eq!(steps.len(), 7007);
    assert_eq!(steps[2999].time_s, 700.0 * (3000.0 / 7000.0));
    assert_eq!(
        (steps[6999].time_s, steps[6999].end_speed_m_s),
        (700.0, 20.0)
    );
    assert_eq!(
        (steps[7006].time_s, steps[7006].end_speed_m_s),
        (700.7, 13.0)
    );
    assert!(
        steps
            .windows(2)
            .all(|pair| pair[0].end_speed_m_s == pair[1].start_speed_m_s)
    );
    assert!(
        steps
            .windows(2)
            .all(|pair| (pair[1].time_s - pair[0].time_s - pair[1].dt_s).abs() < 1e-12 * 700.0)
    );
    let distance: f64 = steps
        .iter()
        .map(|s| 0.5 * (s.start_speed_m_s + s.end_speed_m_s) * s.dt_s)
        .sum();
    assert!((distance / trace.distance_m() - 1.0).abs() < 1e-12);
    assert!(
        steps
            .iter()
            .all(|step| step.phase == 3 && step.grade == 0.01 && !step.engine_off)
    );
}

#[test]
fn a_senseless_step_limit_divides_nothing() {
    let trace = Trace::without_gears(vec![ramp(0.0, 10.0, 1.0, 1.0); 2]);
    for max_dt_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(trace.step_count(max_dt_s), 2);
    }
    assert_eq!(trace.step_count(f64::MIN_POSITIVE), usize::MAX);
}

#[test]
fn sums_by_hand() {
    let mut trace = Trace::without_gears(vec![ramp(0.0, 2.0, 0.0, 4.0), ramp(2.0, 5.0, 4.0, 4.0)]);
    trace.intervals[1].phase = 1;
    assert_eq!(
        (
            trace.duration_s(),
            trace.distance_m(),
            trace.max_speed_m_s()
        ),
        (5.0, 16.0, 4.0)
    );
    assert_eq!(
        (
            trace.phase_distance_m(3),
            trace.phase_distance_m(1),
            trace.phase_distance_m(0)
        ),
        (4.0, 12.0, 0.0)
    );
}
