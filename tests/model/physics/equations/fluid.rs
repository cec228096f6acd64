//! Lubricant: LU-1 to LU-5, and viscosities of printed oils.

use super::same;
use crate::common::{ZERO, car};
use cvtcycle_model::lubricant::{BandFriction, FilmPowers, Friction, Lubricant, Viscosity};

fn friction() -> Friction {
    Friction {
        band: 0.12,
        band_rise_per_k: 0.004,
        segment: 0.125,
        capacity: 0.09,
        flank: 0.13,
        film: true,
        half_n_m: 0.02,
        film_exponent: 1.4,
        half_thickness_m: 8e-7,
        film_heating_w: 4000.0,
        micro_slip: None,
        macro_slip: None,
        log_gear_factor: 0.0,
    }
}

/// LU-1 through three points: its own form between each pair, the outer pieces beyond.
#[test]
fn val_walther_by_hand() {
    let points = [(263.15, 600e-6), (313.15, 36e-6), (373.15, 7.2e-6)];
    let v = Viscosity::new(&points).unwrap();
    let w = |nu: f64| (nu * 1e6 + 0.7).ln().ln();
    for (t, i) in [
        (233.15, 0),
        (255.0, 0),
        (290.0, 0),
        (313.15, 0),
        (314.0, 1),
        (350.0, 1),
        (373.15, 1),
        (420.0, 1),
    ] {
        let (a, b) = (points[i], points[i + 1]);
        let slope = (w(b.1) - w(a.1)) / (b.0 / a.0).ln();
        let line = w(a.1) + slope * (t / a.0).ln();
        same(v.kinematic_m2_s(t), (line.exp().exp() - 0.7) * 1e-6);
    }
}

/// Requirements of the viscosity's points, on both sides of each bound.
#[test]
fn refuses_what_is_no_oil() {
    let ok = |points: &[(f64, f64)]| Viscosity::new(points).is_ok();
    assert!(ok(&[(313.15, 36e-6), (373.15, 7.2e-6)]));
    assert!(!ok(&[(313.15, 36e-6)]) && !ok(&[]));
    assert!(!ok(&[(0.0, 36e-6), (373.15, 7.2e-6)]) && !ok(&[(-5.0, 36e-6), (373.15, 7.2e-6)]));
    assert!(!ok(&[(313.15, 36e-6), (313.15, 7.2e-6)]) && !ok(&[(313.15, 36e-6), (373.15, 36e-6)]));
    assert!(
        ok(&[(313.15, 0.7e-6), (373.15, 0.51e-6)])
            && !ok(&[(313.15, 0.7e-6), (373.15, 0.5e-6)])
            && !ok(&[(313.15, 0.7e-6), (373.15, 0.4e-6)])
    );
    assert!(
        !ok(&[(f64::NAN, 36e-6), (373.15, 7.2e-6)]) && !ok(&[(313.15, f64::NAN), (373.15, 7.2e-6)])
    );
    // Slope 5 of LU-1 is the steepest oil.
    let w0 = (36.7f64).ln().ln();
    for (slope, good) in [(4.99, true), (5.01, false)] {
        let nu = ((w0 - slope * (373.15f64 / 313.15).ln()).exp().exp() - 0.7) * 1e-6;
        assert_eq!(ok(&[(313.15, 36e-6), (373.15, nu)]), good, "{slope}");
    }
}

/// LU-2 and LU-3.
#[test]
fn val_density_and_heat_by_hand() {
    let setup = car("rover_216_cvt", &[]);
    let oil = Lubricant {
        density15_kg_m3: 860.0,
        ..setup.oils().0.clone()
    };
    for degc in [-20.0, 15.0, 90.0] {
        same(
            oil.density_kg_m3(degc + ZERO),
            860.0 * (1.0 - 0.00068 * (degc - 15.0)),
        );
        same(
            oil.dynamic_pa_s(degc + ZERO),
            oil.kinematic_m2_s(degc + ZERO) * 860.0 * (1.0 - 0.00068 * (degc - 15.0)),
        );
        same(
            oil.heat_capacity_j_kgk(degc + ZERO),
            1000.0 * (1.685 + 0.0034 * degc) / 0.86f64.sqrt(),
        );
    }
    same(
        oil.density_kg_m3(1040.0 + ZERO),
        860.0 * (1.0 - 0.00068 * 1025.0),
    );
    same(oil.density_kg_m3(3000.0 + ZERO), 860.0 * 0.3);
}

/// LU-4 and LU-5: an exponential in temperature without bounds; no film, some, all.
#[test]
fn val_band_friction_by_hand() {
    let f = friction();
    for degc in [-40.0f64, -10.0, 25.0, 85.0, 160.0] {
        let warm = (0.004 * (degc - 85.0)).exp();
        for (eta, sliding) in [(0.01, 0.0), (0.01, 0.7), (0.02, 1.0), (0.5, 2.0f64)] {
            let got = f.band(degc + ZERO, eta, [sliding, 0.1 * sliding]);
            same(got.mu, 0.12 * warm);
            for (i, dv) in [sliding, 0.1 * sliding].into_iter().enumerate() {
                let x = eta * dv / 0.02;
                let share = x.powf(1.4) / (1.0 + x.powf(1.4));
                same(got.film_share[i], share);
                let thickness = 8e-7 * x.powf(0.6);
                let shear = if dv > 0.0 {
                    share * eta * dv / thickness
                } else {
                    0.0
                };
                same(got.shear_pa[i], shear);
                same(f.film_loads(eta, [sliding, 0.1 * sliding])[i], x);
            }
        }
    }
    let dry = Friction { film: false, ..f };
    let slides = [2.0, 0.2];
    assert!(dry.film_loads(0.5, slides) == [0.0; 2]);
    assert_eq!(dry.band(358.15, 0.5, slides), BandFriction::dry(0.12));
    // However thick the oil, the film carries all and no more.
    let thick = FilmPowers {
        carried: [f64::INFINITY; 2],
        sheared: [1.0; 2],
    };
    assert_eq!(f.band_on_film(358.15, thick).film_share, [1.0; 2]);
}

/// LU-5 and FI-2: friction over eta dv, boundary and film of one interface together, falls, has one minimum, and rises (Stribeck). Thickness, Pa of
/// shear and share at half the load are what the keys say.
#[test]
fn stribeck() {
    let f = friction();
    let pressure_pa = 2e5;
    let total = |k: i32| {
        let b = f.band(358.15, 0.02 * 1.1f64.powi(k), [1.0, 0.0]);
        b.mu * (1.0 - b.film_share[0]) + b.shear_pa[0] / pressure_pa
    };
    let all: Vec<f64> = (-60..60).map(total).collect();
    let turns = all
        .windows(3)
        .filter(|w| (w[1] - w[0]) * (w[2] - w[1]) < 0.0)
        .count();
    assert_eq!(turns, 1, "{all:?}");
    assert!(all[1] < all[0] && all[119] > all[118]);
    let half = f.band(358.15, 0.02, [1.0, 0.0]);
    same(half.film_share[0], 0.5);
    same(half.shear_pa[0], 0.5 * 0.02 / 8e-7);
}

/// Ramps in both orders of their ends, and the step that equal ends make.
#[test]
fn val_ramps_by_hand() {
    use cvtcycle_model::math::{clamp, ramp, smooth_ramp};
    for (x, from, to, want) in [
        (0.25, 0.0, 1.0, 0.25),
        (0.25, 1.0, 0.0, 0.75),
        (3.0, 1.0, 0.0, 0.0),
        (-3.0, 1.0, 0.0, 1.0),
        (2.0, 2.0, 2.0, 1.0),
        (1.9, 2.0, 2.0, 0.0),
    ] {
        same(ramp(x, from, to), want);
        same(smooth_ramp(x, from, to), want * want * (3.0 - 2.0 * want));
    }
    assert!(
        clamp(f64::NAN, 0.0, 1.0).is_nan()
            && clamp(2.0, 0.0, 1.0) == 1.0
            && clamp(-2.0, 0.0, 1.0) == 0.0
    );
}

/// A curve of one point has its value everywhere; one of two points is straight between them, wherever they lie.
#[test]
fn val_curves_by_hand() {
    let one = cvtcycle_model::math::Curve::constant(5.0);
    assert!(
        [-1e9, 0.0, 3.0, 1e9].iter().all(|x| one.at(*x) == 5.0)
            && one.at(f64::NAN).is_nan() == one.at(f64::NAN).is_nan()
    );
    for from in [-700.0, -3.0, 0.0, 250.0] {
        let points: Vec<(f64, f64)> = (0..9)
            .map(|i| (from + 10.0 * f64::from(i * i), f64::from(7 * i % 5)))
            .collect();
        let curve = cvtcycle_model::math::Curve::new(&points).unwrap();
        for p in points.windows(2) {
            for share in [0.0, 0.25, 0.5, 0.99] {
                let x = p[0].0 + share * (p[1].0 - p[0].0);
                assert!(
                    (curve.at(x) - (p[0].1 + share * (p[1].1 - p[0].1))).abs() < 1e-12,
                    "{x}"
                );
            }
        }
    }
}

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
