//! Unit tests of `model::cycle`.
use cvtcycle_model::cycle::{Cycle, Trace, Weighting};

fn cycle(phases: &[&str]) -> Cycle {
    Cycle {
        name: "town".into(),
        title: String::new(),
        phases: phases.iter().map(|&p| p.to_owned()).collect(),
        weighting: Weighting::None,
        manual: Trace::without_gears(Vec::new()),
        automatic: None,
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
