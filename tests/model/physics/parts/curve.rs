//! Unit tests of `model::math::curve`.
use cvtcycle_model::math::Curve;

#[test]
fn val_interpolates_by_hand() {
    let c = Curve::new(&[(0.0, 1.0), (2.0, 3.0), (4.0, 0.0)]).expect("valid");
    for (x, y) in [
        (-1.0, 1.0),
        (0.0, 1.0),
        (1.0, 2.0),
        (2.0, 3.0),
        (3.0, 1.5),
        (4.0, 0.0),
        (9.0, 0.0),
    ] {
        assert!(
            (c.at(x) - y).abs() < 1e-15,
            "at {x}: {} instead of {y}",
            c.at(x)
        );
    }
}

#[test]
fn refuses_points_that_do_not_rise() {
    assert!(Curve::new(&[(0.0, 1.0), (0.0, 3.0)]).is_err());
    assert!(Curve::new(&[(0.0, f64::NAN)]).is_err());
    assert!(Curve::new(&[]).is_err());
    let rising = |count: u32| (0..count).map(|k| (f64::from(k), 1.0)).collect::<Vec<_>>();
    assert!(Curve::new(&rising(65_535)).is_ok() && Curve::new(&rising(65_536)).is_err());
}
