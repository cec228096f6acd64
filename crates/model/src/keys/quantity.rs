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
/// rpm in one rad/s.
pub const RAD_S: f64 = 1.0 / RPM;
/// 0 degC in K.
pub const ZERO_DEGC_K: f64 = 273.15;

impl Quantity {
    /// A dimensionless number.
    pub const NONE: Quantity = unit("", "-", 1.0);

    /// Every unit with a suffix.
    pub const ALL: &[Quantity] = &UNITS;

    /// The end of a key that has this unit, such as `_mm`.
    pub const fn suffix(&self) -> &'static str {
        self.suffix
    }

    /// The quantity of a key: the unit whose suffix ends it, the longest one if several do.
    pub const fn from_key(key: &str) -> Quantity {
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
    pub const fn unit(&self) -> &'static str {
        self.name
    }

    /// A value in this unit, converted to SI (temperatures to kelvin).
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
    /// let speed = Quantity::from_key("speed_kmh");
    /// assert_eq!((speed.to_si(36.0), speed.from_si(10.0), speed.unit()), (10.0, 36.0, "km/h"));
    /// ```
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

const UNITS: [Quantity; 81] = [
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
    unit("_bar_per_nm", "bar per N m", 1e5),
    unit("_bar_per_m_s", "bar/(m/s)", 1e5),
    unit("_bar_per_m_s2", "bar/(m/s)²", 1e5),
    unit("_gpa", "GPa", 1e9),
    unit("_mpa_s", "mPa s", 1e-3),
    unit("_mm2_s", "mm²/s", 1e-6),
    Quantity {
        suffix: "_degc",
        name: "°C",
        factor: 1.0,
        offset: ZERO_DEGC_K,
    },
    unit("_k", "K", 1.0),
    unit("_per_k", "1/K", 1.0),
    unit("_s", "s", 1.0),
    unit("_min", "min", 60.0),
    unit("_per_s", "1/s", 1.0),
    unit("_per_rad", "1/rad", 1.0),
    unit("_rpm", "rpm", RPM),
    unit("_rpm_per_kmh", "rpm/(km/h)", RPM * 3.6),
    unit("_rad_s", "rad/s", 1.0),
    unit("_deg", "°", PI / 180.0),
    unit("_rad", "rad", 1.0),
    unit("_m_s", "m/s", 1.0),
    unit("_kmh", "km/h", 1.0 / 3.6),
    unit("_mph", "mph", 1609.344 / 3600.0),
    unit("_w", "W", 1.0),
    unit("_kw", "kW", 1e3),
    unit("_wh", "Wh", 3600.0),
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
    // Units of the tables of others. A pound is 0.453 592 37 kg, a foot 0.3048 m, standard gravity 9.806 65 m/s2, a horsepower 550 ft lbf/s.
    unit("_lbft", "lb-ft", LBF * FOOT),
    unit("_psi", "psi", LBF / (FOOT / 12.0 * (FOOT / 12.0))),
    unit("_kpa", "kPa", 1e3),
    unit("_mpa", "MPa", 1e6),
    unit("_hp", "hp", HP),
    unit("_g_h", "g/h", 1e-3 / 3600.0),
    unit("_kg_h", "kg/h", 1.0 / 3600.0),
    unit("_kg_s", "kg/s", 1.0),
    unit("_mg_s", "mg/s", 1e-6),
    unit("_lb_h", "lb/h", LB / 3600.0),
    unit("_g_kwh", "g/kWh", 1e-3 / 3.6e6),
    unit("_kg_kwh", "kg/kWh", 1.0 / 3.6e6),
    unit("_g_hph", "g/hp-h", 1e-3 / (HP * 3600.0)),
    unit("_lb_hph", "lb/hp-h", LB / (HP * 3600.0)),
    unit("_ug_j", "µg/J", 1e-9),
    unit("_mg_stroke", "mg/stroke", 1e-6),
];

/// kg in one lb.
const LB: f64 = 0.453_592_37;
/// N in one pound-force.
const LBF: f64 = LB * 9.806_65;
/// m in one foot.
const FOOT: f64 = 0.3048;
/// W in one mechanical horsepower.
const HP: f64 = 550.0 * LBF * FOOT;

/// The key without its unit, to recognise the same quantity in another unit.
pub fn stem(key: &str) -> &str {
    key.strip_suffix(Quantity::from_key(key).suffix)
        .unwrap_or(key)
}
