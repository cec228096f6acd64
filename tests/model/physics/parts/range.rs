//! Unit tests of `model::keys::range`.
use cvtcycle_model::keys::Bound;

#[test]
fn ends_belong_to_the_range_as_stated() {
    let closed = Bound::closed(0.5, 10.0);
    assert!(closed.contains(0.5) && closed.contains(10.0));
    assert!(!closed.contains(0.499) && !closed.contains(10.001));
    let open = Bound::open_low(0.0, 1.0);
    assert!(!open.contains(0.0) && open.contains(1e-300) && open.contains(1.0));
    assert!(!Bound::positive().contains(0.0) && Bound::positive().contains(1e300));
    assert!(Bound::any().contains(-1e300));
}

#[test]
fn what_is_not_a_number_is_never_allowed() {
    for bound in [Bound::any(), Bound::positive(), Bound::closed(0.0, 1.0)] {
        assert!(!bound.contains(f64::NAN));
        assert!(!bound.contains(f64::INFINITY));
        assert!(!bound.contains(f64::NEG_INFINITY));
    }
}

#[test]
fn ranges_in_words() {
    assert_eq!(Bound::closed(0.5, 10.0).in_unit("mm"), "0.5 to 10 mm");
    assert_eq!(Bound::open_low(0.0, 1.0).in_unit("-"), "above 0 up to 1");
    assert_eq!(Bound::positive().in_unit("kg"), "above 0 kg");
    assert_eq!(
        Bound::closed(f64::NEG_INFINITY, 3.0).in_unit("bar"),
        "at most 3 bar"
    );
    assert_eq!(
        Bound::closed(2.0, f64::INFINITY).in_unit("bar"),
        "at least 2 bar"
    );
    assert_eq!(Bound::any().in_unit("bar"), "any finite number");
}
