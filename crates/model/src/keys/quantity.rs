//! Units by the suffix of a key. Numbers are converted to and from SI here.
use std::f64::consts::PI;

/// A physical quantity in one unit: `si = value * factor + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    suffix: &'static str,
    name: &'static str,
    factor: f64,
    offset: f64,
}

/// rad/s in one rpm.
pub const RPM: f64 = PI / 30.0;

impl Quantity {
    /// A dimensionless number.
    pub const NONE: Quantity = unit("", "-", 1.0);

    /// The quantity of a key: the unit whose suffix ends it, the longest one if several do.
    #[must_use]
    pub const fn of(key: &str) -> Quantity {
        let mut found = Quantity::NONE;
        let mut i = 0;
        while i < UNITS.len() {
            if UNITS[i].suffix.len() > found.suffix.len() && ends_with(key, UNITS[i].suffix) {
                found = UNITS[i];
            }
            i += 1;
        }
        found
    }

    /// Unit as written for people, `-` for a dimensionless number.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        self.name
    }

    /// A value in this unit, converted to SI (temperatures to kelvin).
    #[must_use]
    pub fn to_si(&self, value: f64) -> f64 {
        if self.suffix.is_empty() {
            value
        } else {
            value * self.factor + self.offset
        }
    }

    /// A value in SI, converted to this unit.
    ///
    /// ```
    /// use cvtcycle_model::keys::Quantity;
    /// let speed = Quantity::of("speed_kmh");
    /// assert_eq!((speed.to_si(36.0), speed.from_si(10.0), speed.unit()), (10.0, 36.0, "km/h"));
    /// ```
    #[must_use]
    pub fn from_si(&self, si: f64) -> f64 {
        (si - self.offset) / self.factor
    }
}

const fn ends_with(key: &str, suffix: &str) -> bool {
    let (key, suffix) = (key.as_bytes(), suffix.as_bytes());
    if suffix.len() > key.len() {
        return false;
    }
    let mut i = suffix.len();
    while i > 0 {
        i -= 1;
        if key[key.len() - suffix.len() + i] != suffix[i] {
            return false;
        }
    }
    true
}

const fn unit(suffix: &'static str, name: &'static str, factor: f64) -> Quantity {
    Quantity {
        suffix,
        name,
        factor,
        offset: 0.0,
    }
}

const UNITS: [Quantity; 58] = [
    unit("_m", "m", 1.0),
    unit("_mm", "mm", 1e-3),
    unit("_um", "µm", 1e-6),
    unit("_n_per_m", "N/m", 1.0),
    unit("_w_k_per_m_s", "W/K per m/s", 1.0),
    unit("_l_min_per_bar", "l/min per bar", 1e-3 / 60.0 / 1e5),
    unit("_bar_per_l_min", "bar per l/min", 1e5 * 60.0 / 1e-3),
    unit("_m2", "m²", 1.0),
    unit("_cm2", "cm²", 1e-4),
    unit("_mm2", "mm²", 1e-6),
    unit("_cc", "cm³", 1e-6),
    unit("_l", "l", 1e-3),
    unit("_kg", "kg", 1.0),
    unit("_g", "g", 1e-3),
    unit("_kg_m", "kg/m", 1.0),
    unit("_kg_m2", "kg m²", 1.0),
    unit("_kg_m3", "kg/m³", 1.0),
    unit("_kg_l", "kg/l", 1e3),
    unit("_g_s", "g/s", 1e-3),
    unit("_pa", "Pa", 1.0),
    unit("_bar", "bar", 1e5),
    unit("_gpa", "GPa", 1e9),
    unit("_mpa_s", "mPa s", 1e-3),
    unit("_mm2_s", "mm²/s", 1e-6),
    Quantity {
        suffix: "_degc",
        name: "°C",
        factor: 1.0,
        offset: 273.15,
    },
    unit("_k", "K", 1.0),
    unit("_per_k", "1/K", 1.0),
    unit("_s", "s", 1.0),
    unit("_min", "min", 60.0),
    unit("_per_s", "1/s", 1.0),
    unit("_rpm", "rpm", RPM),
    unit("_rad_s", "rad/s", 1.0),
    unit("_deg", "°", PI / 180.0),
    unit("_rad", "rad", 1.0),
    unit("_m_s", "m/s", 1.0),
    unit("_kmh", "km/h", 1.0 / 3.6),
    unit("_w", "W", 1.0),
    unit("_kw", "kW", 1e3),
    unit("_w_k", "W/K", 1.0),
    unit("_j_k", "J/K", 1.0),
    unit("_kj_k", "kJ/K", 1e3),
    unit("_j_kgk", "J/(kg K)", 1.0),
    unit("_kj_kgk", "kJ/(kg K)", 1e3),
    unit("_mj_kg", "MJ/kg", 1e6),
    unit("_cc_rev", "cm³/rev", 1e-6 / (2.0 * PI)),
    unit("_m3_rad", "m³/rad", 1.0),
    unit("_l_min", "l/min", 1e-3 / 60.0),
    unit("_n", "N", 1.0),
    unit("_n_per_m_s", "N/(m/s)", 1.0),
    unit("_n_per_m_s2", "N/(m/s)²", 1.0),
    unit("_n_per_kmh", "N/(km/h)", 3.6),
    unit("_n_per_kmh2", "N/(km/h)²", 3.6 * 3.6),
    unit("_nm", "N m", 1.0),
    unit("_nm_s", "N m s", 1.0),
    unit("_nm_per_rpm", "N m/rpm", 1.0 / RPM),
    unit("_nm_per_rpm2", "N m/rpm²", 1.0 / (RPM * RPM)),
    unit("_per_1000_rpm", "1/1000 rpm", 1.0 / (1000.0 * RPM)),
    unit("_percent", "%", 0.01),
];

/// The key without its unit, to recognise the same quantity in another unit.
#[must_use]
pub fn stem(key: &str) -> &str {
    key.strip_suffix(Quantity::of(key).suffix).unwrap_or(key)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        for unit in &UNITS {
            let tried = EXPECTED
                .iter()
                .any(|(key, ..)| Quantity::of(key).suffix == unit.suffix);
            assert!(tried, "{} is not tried", unit.suffix);
            assert_eq!(
                UNITS
                    .iter()
                    .filter(|other| other.suffix == unit.suffix)
                    .count(),
                1,
                "{}",
                unit.suffix
            );
        }
    }

    #[test]
    fn the_stem_is_the_quantity() {
        assert_eq!(stem("band_offset_mm"), "band_offset");
        assert_eq!(stem("drag_n_per_kmh2"), "drag");
        assert_eq!(stem("ratio"), "ratio");
    }
}
