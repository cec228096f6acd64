//! Unit tests of `model::fluid::viscosity`.
use cvtcycle_model::fluid::Viscosity;

/// A worked example of the standard: 32 mm2/s at 40 degC and 5.4 at 100 degC give 8.5 at 80 degC.
#[test]
fn val_d341_worked_example() {
    let v = Viscosity::new(&[(313.15, 32e-6), (373.15, 5.4e-6)]).expect("valid");
    assert!((v.kinematic_m2_s(353.15) * 1e6 - 8.5).abs() < 0.05);
    assert!((v.kinematic_m2_s(313.15) * 1e6 - 32.0).abs() < 1e-9);
}

/// The project's table of fluid facts: 36 / 7.2 mm2/s gives 519 at -10, 258 at 0, 84 at 20 and 11.0 at 80 degC.
#[test]
fn val_cvt_fluid_class() {
    let v = Viscosity::new(&[(313.15, 36e-6), (373.15, 7.2e-6)]).expect("valid");
    for (t_c, nu) in [(-10.0, 519.0), (0.0, 258.0), (20.0, 84.0), (80.0, 11.0)] {
        let got = v.kinematic_m2_s(t_c + 273.15) * 1e6;
        assert!(
            (got / nu - 1.0).abs() < 0.005,
            "{t_c} degC: {got} instead of {nu}"
        );
    }
}

#[test]
fn table_goes_through_its_points_and_falls_everywhere() {
    let points = [
        (233.15, 12000e-6),
        (263.15, 600e-6),
        (313.15, 36e-6),
        (373.15, 7.2e-6),
    ];
    let v = Viscosity::new(&points).expect("valid");
    for (t, nu) in points {
        assert!((v.kinematic_m2_s(t) / nu - 1.0).abs() < 1e-9);
    }
    let mut last = f64::INFINITY;
    for i in 0..400 {
        let nu = v.kinematic_m2_s(230.0 + 0.5 * f64::from(i));
        assert!(nu < last);
        last = nu;
    }
}

#[test]
fn refuses_rising_viscosity() {
    assert!(Viscosity::new(&[(313.15, 7e-6), (373.15, 36e-6)]).is_err());
    assert!(Viscosity::new(&[(313.15, 7e-6)]).is_err());
}
