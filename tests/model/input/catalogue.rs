//! The catalogue of keys and the book of assumptions.

use cvtcycle_config::setup::assumptions::book;
use cvtcycle_config::setup::catalogue::{self, ENGINE_OIL, OIL, files, known_keys};
use cvtcycle_config::setup::{Kind, Options, load};

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
        let setup = load(file.name, &Options::default()).unwrap();
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
