//! Unit tests of `model::transmission::cvt::variator::geometry`.
use cvtcycle_model::transmission::cvt::variator::Geometry;

/// Outside truth: 200 ratios of an independent program, committed with the tests.
#[test]
fn val_golden_geometry() {
    let text = include_str!("../../../golden/belt_geometry.csv");
    let mut count = 0;
    for line in text.lines().skip(1) {
        let c: Vec<f64> = line
            .split(',')
            .map(|x| x.parse().expect("number"))
            .collect();
        let g = Geometry::new(c[0], 0.155, 0.6486);
        let got = [
            g.primary_radius_m,
            g.secondary_radius_m,
            g.primary_wrap_rad,
            g.secondary_wrap_rad,
            g.strut_m,
        ];
        for (got, want) in got.iter().zip(&c[1..6]) {
            assert!(
                (got - want).abs() <= 1e-9 * want.abs() + 1e-9,
                "I {}: {got} {want}",
                c[0]
            );
        }
        count += 1;
    }
    assert_eq!(count, 200);
}

#[test]
fn radius_slope_is_the_derivative() {
    for ratio in [0.42, 0.7, 1.0, 1.6, 2.4] {
        let r = |u: f64| Geometry::new(ratio * u.exp(), 0.155, 0.6486).secondary_radius_m;
        let numeric = (r(1e-5) - r(-1e-5)) / 2e-5;
        let slope = Geometry::new(ratio, 0.155, 0.6486).secondary_radius_slope_m();
        assert!(
            (slope / numeric - 1.0).abs() < 1e-6,
            "I {ratio}: {slope} {numeric}"
        );
    }
}

/// Dimension rescaling: all lengths twice as long give radii twice as large at the same angles.
#[test]
fn rescales_with_length() {
    let (a, b) = (
        Geometry::new(0.6, 0.155, 0.6486),
        Geometry::new(0.6, 0.31, 1.2972),
    );
    assert!((b.primary_radius_m / a.primary_radius_m - 2.0).abs() < 1e-12);
    assert!((b.primary_wrap_rad - a.primary_wrap_rad).abs() < 1e-12);
}
