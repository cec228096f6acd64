//! Constant speeds as cycles.

use cvtcycle_config::cycle::constant_speed;

#[test]
fn a_constant_speed_is_600_s_with_flying_start() {
    for (name, metres) in [
        ("constant_90", 15_000.0),
        ("constant_120", 20_000.0),
        ("constant_88.5", 14_750.0),
        ("constant_250", 250_000.0 / 6.0),
    ] {
        let cycle = constant_speed(name).unwrap().unwrap();
        let trace = cycle.trace_for(true);
        assert!(
            (trace.distance_m() - metres).abs() < 1e-8
                && (trace.duration_s() - 600.0).abs() < 1e-12
        );
        assert!((trace.intervals[0].start_speed_m_s - metres / 600.0).abs() < 1e-12);
        assert_eq!(
            (
                cycle.name.as_str(),
                cycle.phase_groups()[0].0.as_str(),
                cycle.has_gears()
            ),
            (name, name, false)
        );
    }
}

#[test]
fn other_names_are_left_to_others_and_bad_speeds_explained() {
    assert!(constant_speed("ece15").is_none() && constant_speed("constant90").is_none());
    for bad in [
        "0", "", ".", "-5", "+5", "250.1", "1e2", "nan", "inf", "88,5", "9.0.0", "90kmh",
    ] {
        let problem = constant_speed(&format!("constant_{bad}"))
            .unwrap()
            .unwrap_err();
        assert!(
            problem.value.ends_with(bad)
                && problem.allowed.contains("250")
                && problem.hint.contains("constant_")
        );
    }
}
