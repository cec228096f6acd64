//! The catalogue of keys, the book of assumptions, overrides of the rig, and of the box that a car does not have.

use cvtcycle_config::rig;
use cvtcycle_config::setup::assumptions::book;
use cvtcycle_config::setup::catalogue::{self, ENGINE_OIL, OIL, files, known_keys};
use cvtcycle_config::setup::{self, Kind, Options};
use cvtcycle_config::{Override, Target};
use cvtcycle_model::rig::transmission::Speeds;

#[test]
fn options_that_no_file_chooses_are_known() {
    let keys = known_keys();
    for key in [
        "transmission.cvt.pump.kind.dual_cavity.share",
        "transmission.cvt.clamp.torque_following.safety_factor",
        "road_load.form.body.drag_coefficient",
        "transmission.cvt.belt.band_offset_mm",
        "lubricant.kv40_mm2_s",
        "vehicle.transmission_oil",
        "rig.pressure.second_box",
    ] {
        let info = keys.iter().find(|info| info.key == key);
        assert!(info.is_some_and(|info| !info.doc.is_empty()), "{key}");
    }
}

#[test]
fn the_catalogue_holds_what_loading_reports() {
    for file in files().iter().filter(|file| file.kind == Kind::Vehicle) {
        let setup = setup::load(file.name, &Options::default()).unwrap();
        let own = setup
            .keys
            .iter()
            .filter(|k| !k.key.starts_with(OIL) && !k.key.starts_with(ENGINE_OIL));
        assert_eq!(own.cloned().collect::<Vec<_>>(), file.keys, "{}", file.name);
    }
}

#[test]
fn the_book_names_every_assumed_value_and_label() {
    let book = book(cvtcycle_model::equations::EQUATIONS);
    for file in catalogue::files() {
        for info in file.keys.iter().filter(|info| info.status == "assumed") {
            assert!(
                book.contains(&format!("| `{}` |", info.key)),
                "{}",
                info.key
            );
        }
    }
    for label in ["SI-2", "TH-4", "EN-1"] {
        assert!(book.contains(&format!("| {label} |")), "{label}");
    }
}

#[test]
fn speeds_hold_both_ends() {
    let (c, keys) = rig::load(&[]).unwrap();
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
    let problems = rig::load(&set).unwrap_err();
    assert_eq!(problems.len(), 3, "{problems:#?}");
    for problem in &problems {
        let of_rig = |key: &str| Target::from_key(key).0 == Target::Rig;
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
