//! Unit tests of `model::math` and of the ranges and units of `model::keys`.

use cvtcycle_model::keys::{Bound, Quantity, stem};
use cvtcycle_model::math::{Curve, GRID_AXES, Grid, exp, exp_array, ln, ln_array};
use std::f64::consts::LN_2;

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

fn plane(x: [f64; GRID_AXES]) -> f64 {
    1.0 + 2.0 * x[0] - 3.0 * x[1] + 0.5 * x[4] + x[0] * x[1]
}

#[test]
fn val_reproduces_a_bilinear_function() {
    let mut rows = Vec::new();
    for a in [0.0, 1.0, 4.0] {
        for b in [-1.0, 2.0] {
            for e in [10.0, 20.0] {
                let x = [a, b, 7.0, 0.0, e];
                rows.push((x, plane(x)));
            }
        }
    }
    rows.reverse();
    let grid = Grid::from_rows(&rows).expect("full grid");
    for x in [
        [0.3, 0.1, 0.0, 0.0, 12.0],
        [3.9, 1.9, 5.0, 1.0, 19.0],
        [4.0, 2.0, 7.0, 0.0, 20.0],
    ] {
        let (y, inside) = grid.at(x);
        assert!(
            (y - plane(x)).abs() < 1e-12 && inside,
            "{x:?}: {y} {}",
            plane(x)
        );
    }
    assert!(!grid.at([5.0, 0.0, 0.0, 0.0, 12.0]).1);
}

#[test]
fn refuses_holes_and_doubles() {
    let row = |a: f64, b: f64| ([a, b, 0.0, 0.0, 0.0], 1.0);
    assert!(Grid::from_rows(&[row(0.0, 0.0), row(1.0, 1.0)]).is_err());
    assert!(
        Grid::from_rows(&[row(0.0, 0.0), row(1.0, 1.0), row(0.0, 1.0), row(0.0, 0.0)]).is_err()
    );
}

/// Largest relative distance to the standard library's function over many numbers.
fn worst(
    own: impl Fn(f64) -> f64,
    truth: impl Fn(f64) -> f64,
    numbers: impl Iterator<Item = f64>,
) -> f64 {
    numbers.fold(0.0, |most: f64, x| {
        most.max((own(x) / truth(x) - 1.0).abs())
    })
}

/// Outside truth: the standard library, itself within one unit of the last place.
#[test]
fn val_exp_and_ln_agree_with_the_standard_library() {
    let near = (-4_000_000..4_000_000).map(|k| f64::from(k) * 1.000_3e-5);
    assert!(worst(exp, f64::exp, near) <= 6e-16);
    assert!(worst(exp, f64::exp, (-6999..6999).map(|k| 0.1 * f64::from(k))) <= 6e-16);
    let absolute = |x: f64| (ln(x) - x.ln()).abs() / x.ln().abs().max(1.0);
    assert!(
        (1..4_000_000)
            .map(|k| absolute(1e-4 * f64::from(k)))
            .fold(0.0, f64::max)
            <= 6e-16
    );
    assert!(
        (-1000..1000)
            .map(|k| absolute(10f64.powf(0.3 * f64::from(k))))
            .fold(0.0, f64::max)
            <= 6e-16
    );
    let near_one = (1..39_000).flat_map(|k| [1.0 + 1e-7 * f64::from(k), 1.0 - 1e-7 * f64::from(k)]);
    assert!(worst(ln, f64::ln, near_one) <= 5e-16);
}

/// Together as alone, to the last bit, whichever of them leaves the short way.
#[test]
fn several_together_are_each_alone() {
    let bits = |x: [f64; 5]| x.map(f64::to_bits);
    for x in [
        [0.3, -2.0, 650.0, -12.5, 1e-9],
        [0.3, f64::NEG_INFINITY, 701.0, -12.5, 0.0],
        [f64::MIN_POSITIVE, 0.0, 3.0, 1e300, 0.7],
    ] {
        assert_eq!(bits(exp_array(x)), bits(x.map(exp)), "{x:?}");
        let positive = x.map(f64::abs);
        assert_eq!(
            bits(ln_array(positive)),
            bits(positive.map(ln)),
            "{positive:?}"
        );
    }
}

#[test]
#[allow(clippy::float_cmp, reason = "promised exactly")]
fn exact_where_it_matters_and_never_a_surprise() {
    assert_eq!((exp(0.0), ln(1.0), ln(2.0)), (1.0, 0.0, LN_2));
    let same = |own: f64, truth: f64| own == truth || own.is_nan() && truth.is_nan();
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 710.0, -746.0] {
        assert!(same(exp(x), x.exp()), "{x}");
    }
    for x in [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        0.0,
        -0.0,
        -1.0,
        5e-324,
        f64::MIN_POSITIVE / 2.0,
    ] {
        assert!(same(ln(x), x.ln()), "{x}");
    }
    // Beyond the reach of the series; the least numbers have few digits.
    for x in [709.7, 700.0, -700.0, -708.0] {
        assert!((exp(x) / x.exp() - 1.0).abs() <= 2e-15, "{x}");
    }
    assert_eq!(exp(-745.0), 5e-324);
}

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

/// Key, value, SI value worked out by hand, unit as shown.
const EXPECTED: [(&str, f64, f64, &str); 85] = [
    (
        "fall_per_1000_rpm",
        0.2,
        0.001_909_859_317_102_744,
        "1/1000 rpm",
    ),
    ("half_thickness_um", 0.5, 5e-7, "µm"),
    ("half_n_per_m", 0.028, 0.028, "N/m"),
    ("ram_w_k_per_m_s", 40.0, 40.0, "W/K per m/s"),
    ("leakage_l_min_per_bar", 6.0, 1e-9, "l/min per bar"),
    ("inlet_bar_per_l_min", 0.01, 6e7, "bar per l/min"),
    ("clutch_bar_per_nm", 0.06, 6000.0, "bar per N m"),
    ("creep_per_rad", 0.02, 0.02, "1/rad"),
    ("ratio", 2.4, 2.4, "-"),
    ("gears", 5.0, 5.0, "-"),
    ("diameter_m", 0.6, 0.6, "m"),
    ("band_offset_mm", 3.0, 0.003, "mm"),
    ("frontal_area_m2", 2.1, 2.1, "m²"),
    ("cylinder_cm2", 100.0, 0.01, "cm²"),
    ("orifice_mm2", 4.0, 4e-6, "mm²"),
    ("displacement_cc", 1600.0, 0.0016, "cm³"),
    ("sump_l", 7.0, 0.007, "l"),
    ("mass_kg", 1200.0, 1200.0, "kg"),
    ("element_g", 1.5, 0.0015, "g"),
    ("belt_kg_m", 0.98, 0.98, "kg/m"),
    ("inertia_kg_m2", 0.2, 0.2, "kg m²"),
    ("density_kg_m3", 850.0, 850.0, "kg/m³"),
    ("density_kg_l", 0.85, 850.0, "kg/l"),
    ("fuel_g_s", 2.0, 0.002, "g/s"),
    ("pressure_pa", 3.0, 3.0, "Pa"),
    ("line_bar", 20.0, 2e6, "bar"),
    ("drag_bar_per_m_s", 0.05, 5000.0, "bar/(m/s)"),
    ("drag_bar_per_m_s2", 0.002, 200.0, "bar/(m/s)²"),
    ("young_gpa", 210.0, 2.1e11, "GPa"),
    ("viscosity_mpa_s", 20.0, 0.02, "mPa s"),
    ("viscosity_mm2_s", 35.0, 3.5e-5, "mm²/s"),
    ("start_degc", -7.0, 266.15, "°C"),
    ("start_k", 300.0, 300.0, "K"),
    ("expansion_per_k", 7e-4, 7e-4, "1/K"),
    ("step_s", 0.5, 0.5, "s"),
    ("soak_min", 2.0, 120.0, "min"),
    ("shift_per_s", 0.3, 0.3, "1/s"),
    ("idle_rpm", 900.0, 94.247_779_607_693_8, "rpm"),
    ("idle_rad_s", 90.0, 90.0, "rad/s"),
    ("half_angle_deg", 11.0, 0.191_986_217_719_376_2, "°"),
    ("half_angle_rad", 0.19, 0.19, "rad"),
    ("speed_m_s", 10.0, 10.0, "m/s"),
    ("speed_kmh", 36.0, 10.0, "km/h"),
    ("load_w", 200.0, 200.0, "W"),
    ("rated_kw", 75.0, 75_000.0, "kW"),
    ("store_wh", 20.0, 72_000.0, "Wh"),
    (
        "first_rpm_per_kmh",
        100.0,
        37.699_111_843_077_52,
        "rpm/(km/h)",
    ),
    ("conductance_w_k", 12.0, 12.0, "W/K"),
    ("capacity_j_k", 900.0, 900.0, "J/K"),
    ("capacity_kj_k", 20.0, 20_000.0, "kJ/K"),
    ("heat_j_kgk", 2000.0, 2000.0, "J/(kg K)"),
    ("heat_kj_kgk", 2.0, 2000.0, "kJ/(kg K)"),
    ("heating_value_mj_kg", 42.7, 4.27e7, "MJ/kg"),
    ("pump_cc_rev", 12.0, 1.909_859_317_102_744e-6, "cm³/rev"),
    ("pump_m3_rad", 2e-6, 2e-6, "m³/rad"),
    ("leakage_l_min", 6.0, 1e-4, "l/min"),
    ("force_n", 30.0, 30.0, "N"),
    ("drag_n_per_m_s", 5.0, 5.0, "N/(m/s)"),
    ("drag_n_per_m_s2", 0.4, 0.4, "N/(m/s)²"),
    ("f1_n_per_kmh", 0.5, 1.8, "N/(km/h)"),
    ("f2_n_per_kmh2", 0.03, 0.3888, "N/(km/h)²"),
    ("rated_nm", 140.0, 140.0, "N m"),
    ("viscous_nm_s", 0.01, 0.01, "N m s"),
    (
        "drag_nm_per_rpm",
        0.001,
        0.009_549_296_585_513_72,
        "N m/rpm",
    ),
    (
        "drag_nm_per_rpm2",
        1e-6,
        9.118_906_527_810_399e-5,
        "N m/rpm²",
    ),
    ("slip_percent", 2.5, 0.025, "%"),
    ("speed_mph", 60.0, 26.8224, "mph"),
    ("load_lbft", 100.0, 135.581_794_833_140_04, "lb-ft"),
    ("load_psi", 100.0, 689_475.729_316_836_1, "psi"),
    ("load_kpa", 3.0, 3000.0, "kPa"),
    ("load_mpa", 0.8, 800_000.0, "MPa"),
    ("rated_hp", 100.0, 74_569.987_158_227_01, "hp"),
    ("fuel_g_h", 3600.0, 0.001, "g/h"),
    ("fuel_kg_h", 36.0, 0.01, "kg/h"),
    ("fuel_kg_s", 0.002, 0.002, "kg/s"),
    ("fuel_mg_s", 500.0, 0.0005, "mg/s"),
    ("fuel_lb_h", 10.0, 0.001_259_978_805_555_555_6, "lb/h"),
    ("bsfc_g_kwh", 250.0, 6.944_444_444_444_444e-08, "g/kWh"),
    ("bsfc_kg_kwh", 0.25, 6.944_444_444_444_444e-08, "kg/kWh"),
    ("bsfc_g_hph", 200.0, 7.450_122_719_972_377e-08, "g/hp-h"),
    ("bsfc_lb_hph", 0.5, 8.448_297_053_357_792e-08, "lb/hp-h"),
    ("bsfc_ug_j", 70.0, 7.0e-08, "µg/J"),
    ("fuel_mg_stroke", 20.0, 2.0e-05, "mg/stroke"),
    // Names that end like a unit without being one of the pair `_unit`.
    ("nm", 1.0, 1.0, "-"),
    ("belts", 1.0, 1.0, "-"),
];

#[test]
fn every_unit_converts_as_worked_out_by_hand() {
    for (key, value, si, name) in EXPECTED {
        let quantity = Quantity::from_key(key);
        let found = quantity.to_si(value);
        assert!(
            (found - si).abs() <= 1e-12 * si.abs(),
            "{key}: {found} instead of {si}"
        );
        assert_eq!(quantity.unit(), name, "{key}");
        let back = quantity.from_si(found);
        assert!((back - value).abs() <= 1e-9 * value.abs(), "{key}: {back}");
    }
}

#[test]
fn the_table_above_leaves_no_unit_out() {
    for unit in Quantity::ALL {
        let tried = EXPECTED
            .iter()
            .any(|(key, ..)| Quantity::from_key(key).suffix() == unit.suffix());
        assert!(tried, "{} is not tried", unit.suffix());
        let same = |other: &&Quantity| other.suffix() == unit.suffix();
        assert_eq!(Quantity::ALL.iter().filter(same).count(), 1, "{unit:?}");
    }
}

#[test]
fn the_stem_is_the_quantity() {
    assert_eq!(stem("band_offset_mm"), "band_offset");
    assert_eq!(stem("drag_n_per_kmh2"), "drag");
    assert_eq!(stem("ratio"), "ratio");
}
