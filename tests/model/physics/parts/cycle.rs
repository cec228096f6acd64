//! Unit tests of `model::cycle`: commands of gears, phases, traces.
#![allow(clippy::float_cmp, reason = "division points are promised exactly")]

use GearCommand::{Change, Declutched, InGear, Neutral};
use cvtcycle_model::cycle::distance::{DistanceRow, stretches};
use cvtcycle_model::cycle::gears::{GearColumns, GearCommand, Note, commands};
use cvtcycle_model::cycle::{Cycle, Interval, Step, Trace, Weighting};

fn decode(rows: &[(u8, &str)]) -> Vec<GearCommand> {
    commands(
        rows.iter()
            .map(|&(gear, note)| (gear, Note::parse(note).unwrap())),
    )
}

#[test]
fn notes_become_commands() {
    let rows = [
        (0, "PM"),
        (0, "K1"),
        (1, "1"),
        (0, "GC"),
        (0, "GC"),
        (2, ""),
        (0, "K2"),
        (0, ""),
        (3, "pm"),
        (4, "k5"),
    ];
    let expected = [
        Neutral,
        Declutched(1),
        InGear(1),
        Change(2),
        Change(2),
        InGear(2),
        Declutched(2),
        Neutral,
        Neutral,
        Declutched(5),
    ];
    assert_eq!(decode(&rows), expected);
}

#[test]
fn a_change_goes_into_its_own_gear_then_into_the_next_engaged() {
    assert_eq!(decode(&[(3, "GC"), (2, "")]), [Change(3), InGear(2)]);
    assert_eq!(decode(&[(0, "GC"), (0, "K2")]), [Change(2), Declutched(2)]);
    assert_eq!(
        decode(&[(0, "GC"), (0, "PM"), (1, "")]),
        [Change(1), Neutral, InGear(1)]
    );
    assert_eq!(
        decode(&[(4, ""), (0, "GC"), (0, "PM")]),
        [InGear(4), Neutral, Neutral]
    );
}

#[test]
fn only_known_notes_are_taken() {
    for bad in [
        "K", "K0", "K11", "K+1", "KX", "P", "GCC", "K1 ", "é", "11", "-1", "+1",
    ] {
        assert_eq!(Note::parse(bad), None, "{bad}");
    }
}

#[test]
fn a_column_serves_the_gear_counts_it_was_made_for() {
    let columns = GearColumns::new(Some(vec![InGear(5)]), Some(vec![InGear(6)]), None);
    assert_eq!(columns.for_count(5), Some(&[InGear(5)][..]));
    assert_eq!(columns.for_count(6), Some(&[InGear(6)][..]));
    assert_eq!(columns.for_count(4), None);
    let columns = GearColumns::new(Some(vec![InGear(5)]), None, Some(vec![Change(4)]));
    assert_eq!(columns.for_count(3), None);
    assert_eq!(columns.for_count(4), Some(&[Change(4)][..]));
    assert_eq!(columns.for_count(5), Some(&[InGear(5)][..]));
    assert_eq!(columns.for_count(6), Some(&[Change(4)][..]));
}

fn cycle(phases: &[&str]) -> Cycle {
    Cycle {
        name: "town".into(),
        title: String::new(),
        phases: phases.iter().map(|&p| p.to_owned()).collect(),
        weighting: Weighting::None,
        manual: Trace::without_gears(Vec::new()),
        automatic: None,
        read_as: None,
        recording: None,
        is_wltc: false,
    }
}

#[test]
fn groups_merge_the_four_ece15_and_nothing_else() {
    let groups = cycle(&[
        "IDLE40", "ECE15_1", "ECE15_2", "ECE15_3", "ECE15_4", "EUDC", "ECE15_5",
    ])
    .phase_groups();
    let expected = [
        ("idle40", vec![0]),
        ("ece15", vec![1, 2, 3, 4]),
        ("eudc", vec![5]),
        ("ece15_5", vec![6]),
    ];
    let expected: Vec<_> = expected
        .into_iter()
        .map(|(name, list)| (name.to_owned(), list))
        .collect();
    assert_eq!(groups, expected);
}

#[test]
fn a_cycle_without_phases_is_one_group() {
    assert_eq!(
        cycle(&[]).phase_groups(),
        vec![("town".to_owned(), vec![0])]
    );
}

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
    let last = Interval {
        phase: 1,
        ..ramp(2.0, 5.0, 4.0, 4.0)
    };
    let trace = Trace::without_gears(vec![ramp(0.0, 2.0, 0.0, 4.0), last]);
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

/// Intervals of one phase make a cycle without phases, those of two a cycle with two names.
#[test]
fn phases_of_intervals_are_named_by_number() {
    let interval = |start_s: f64, phase| Interval {
        start_s,
        end_s: start_s + 10.0,
        start_speed_m_s: 5.0,
        end_speed_m_s: 5.0,
        phase,
        grade: 0.0,
        engine_off: false,
    };
    let names = |phases: [u16; 2]| {
        let [a, b] = phases;
        let made = Cycle::from_intervals("own", vec![interval(0.0, a), interval(10.0, b)]);
        made.unwrap().phases
    };
    assert_eq!(names([0, 0]), Vec::<String>::new());
    assert_eq!(names([0, 1]), ["phase_1", "phase_2"]);
}

/// Intervals are refused where they do not end after their beginning, at a time that is a number, or where the car goes backwards; a car may begin at rest.
#[test]
fn senseless_intervals_are_refused() {
    let from_rest = |end_s: f64, end_speed_m_s: f64| Interval {
        start_s: 0.0,
        end_s,
        start_speed_m_s: 0.0,
        end_speed_m_s,
        phase: 0,
        grade: 0.0,
        engine_off: false,
    };
    let made = |interval| Cycle::from_intervals("own", vec![interval]);
    assert!(made(from_rest(10.0, 15.0)).is_ok() && made(from_rest(10.0, 0.0)).is_ok());
    for end_s in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        let refused = made(from_rest(end_s, 15.0)).unwrap_err();
        assert!(refused.contains("interval 1 does not end"), "{refused}");
    }
    for end_m_s in [-1e-9, f64::INFINITY, f64::NAN] {
        let refused = made(from_rest(10.0, end_m_s)).unwrap_err();
        assert!(refused.contains("speed or grade"), "{refused}");
    }
}

/// CY-1: between two stops the car accelerates at 1.0 m/s2 and brakes at 1.5 m/s2; too near for its target it does nothing else, and the highest
/// speed is that at which both ways make the distance: v2 = 2 s a b/(a + b).
#[test]
fn a_drive_over_distance_accelerates_and_brakes() {
    let stop = |distance_m: f64, stop_s: f64| DistanceRow {
        distance_m,
        speed_m_s: if stop_s > 0.0 { 0.0 } else { 20.0 },
        stop_s,
    };
    for (length_m, kinds) in [(100.0, 2), (1000.0, 3)] {
        let drive = stretches(&[stop(0.0, 5.0), stop(1.0, 0.0), stop(length_m, 5.0)]);
        let moving: Vec<_> = drive
            .iter()
            .filter(|s| s.speed_m_s[0] + s.speed_m_s[1] > 0.0)
            .collect();
        let mut fastest = 0.0_f64;
        let mut way_m = 0.0;
        let mut found = Vec::new();
        for s in &moving {
            let [from, to] = s.speed_m_s;
            let dt_s = s.time_s[1] - s.time_s[0];
            let accel = (to - from) / dt_s;
            let allowed = [1.0, 0.0, -1.5]
                .iter()
                .position(|a| (accel - a).abs() < 1e-9);
            found.push(allowed.unwrap_or_else(|| panic!("{accel} m/s2 in {s:?}")));
            way_m += 0.5 * (from + to) * dt_s;
            fastest = fastest.max(to);
        }
        found.dedup();
        assert_eq!(found.len(), kinds, "{length_m} m: {moving:?}");
        assert!((way_m - length_m).abs() < 1e-9, "{way_m} m");
        let peak = (2.0 * length_m * 1.0 * 1.5 / (1.0 + 1.5_f64)).sqrt();
        let want = if kinds == 2 { peak } else { 20.0 };
        assert!((fastest - want).abs() < 1e-9, "{fastest} m/s, {want} m/s");
    }
}
