//! Names that a mistyped one may have meant.

use cvtcycle_config::near;

#[test]
fn a_slip_of_the_finger_is_found() {
    let known = ["band_offset_mm", "band_width_mm", "pitch_mm", "mass_kg"];
    assert_eq!(
        near("band_ofset_mm", known.into_iter())[0],
        "band_offset_mm"
    );
    assert_eq!(near("mass", known.into_iter()), ["mass_kg"]);
    assert_eq!(near("Mass_Kg", known.into_iter()), ["mass_kg"]);
}

#[test]
fn nothing_is_suggested_for_something_else() {
    assert!(near("zebra", ["band_offset_mm", "mass_kg"].into_iter()).is_empty());
    assert!(near("", ["a"].into_iter()).is_empty());
}

#[test]
fn at_most_three_and_the_best_first() {
    let known = ["abcd1", "abcd2", "abcd3", "abcde", "abcd5"];
    let found = near("abcde", known.into_iter());
    assert_eq!(found.len(), 3);
    assert_eq!(found[0], "abcde");
}
