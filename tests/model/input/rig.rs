//! Overrides of the rig, and of the box that a car does not have.

use cvtcycle_config::rig::load;
use cvtcycle_config::setup::{self, Options};
use cvtcycle_config::{Override, Target};
use cvtcycle_model::bench::transmission::Speeds;

#[test]
fn speeds_hold_both_ends() {
    let (c, keys) = load(&[]).unwrap();
    let rpm = |s: Speeds| {
        let list = s.list();
        let rpm = list
            .iter()
            .map(|w| (w * 30.0 / std::f64::consts::PI).round());
        rpm.collect::<Vec<_>>()
    };
    let low = rpm(c.low_speeds);
    assert_eq!((low.len(), low[0], low[12]), (13, 1000.0, 4000.0));
    assert_eq!(rpm(c.high_speeds).len(), 10);
    let is_whole = |key: &str, status: &str| key.starts_with("rig.") && !status.is_empty();
    assert!(
        keys.iter()
            .all(|k| is_whole(&k.key, &k.status) && !k.doc.is_empty()),
        "{keys:?}"
    );
}

#[test]
fn every_problem_of_an_override_is_reported() {
    let set = Override::parse_all(&[
        "rig.transient.end_degc=10",
        "rig.ratio.low=9",
        "rig.speed.stepp_rpm=3",
        "road_load.mass_kg=3",
    ])
    .unwrap();
    let problems = load(&set).unwrap_err();
    assert_eq!(problems.len(), 3, "{problems:#?}");
    for problem in &problems {
        let of_rig = |key: &str| Target::of(key).0 == Target::Rig;
        assert!(of_rig(&problem.key) && problem.place.assignment().is_some_and(of_rig));
    }
    assert!(
        problems
            .iter()
            .any(|p| p.hint.contains("rig.speed.step_rpm")),
        "{problems:#?}"
    );
}

#[test]
fn a_manual_car_has_no_belt() {
    let problems = |car: &str, key: &str| {
        let set = vec![Override::number(key, 0.9)];
        let options = Options {
            set,
            ..Options::default()
        };
        setup::load(car, &options).unwrap_err()
    };
    let found = problems("rover_216_5mt", "transmission.cvt.belt.band_offset_mm");
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].message.contains("manual box and no CVT"),
        "{found:?}"
    );
    let found = problems("rover_216_cvt", "transmission.manual.mesh_efficiency");
    assert_eq!(found.len(), 1, "{found:?}");
}
