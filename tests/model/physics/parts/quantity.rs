//! Unit tests of `model::keys::quantity`.
use cvtcycle_model::keys::{Quantity, stem};

/// Key, value, SI value worked out by hand, unit as shown.
const EXPECTED: [(&str, f64, f64, &str); 62] = [
    (
        "fall_per_1000_rpm",
        0.2,
        0.001_909_859_317_102_744,
        "1/1000 rpm",
    ),
    ("film_thickness_um", 0.5, 5e-7, "µm"),
    ("lift_n_per_m", 0.028, 0.028, "N/m"),
    ("ram_w_k_per_m_s", 40.0, 40.0, "W/K per m/s"),
    ("leakage_l_min_per_bar", 6.0, 1e-9, "l/min per bar"),
    ("inlet_bar_per_l_min", 0.01, 6e7, "bar per l/min"),
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
    // Names that end like a unit without being one of the pair `_unit`.
    ("nm", 1.0, 1.0, "-"),
    ("belts", 1.0, 1.0, "-"),
];

#[test]
fn every_unit_converts_as_worked_out_by_hand() {
    for (key, value, si, name) in EXPECTED {
        let quantity = Quantity::of(key);
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
            .any(|(key, ..)| Quantity::of(key).suffix() == unit.suffix());
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
