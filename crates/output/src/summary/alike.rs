//! Compares a baseline with the subject: same car with another transmission, or other differences.

use serde::{Deserialize, Serialize};

use crate::number::signed;
use cvtcycle_config::KeyInfo;
use cvtcycle_config::setup::Setup;

/// Tables whose values are equal in a like-for-like comparison.
const SAME: [&str; 5] = [
    "road_load.",
    "engine.",
    "engine_oil.",
    "thermal.engine.",
    "thermal.radiator.",
];
/// Maximum relative difference of equal values: rounding.
const EQUAL: f64 = 1e-9;
/// Maximum relative difference of a wheel radius, whose measurements scatter by this much.
const RADIUS: (&str, f64) = ("road_load.wheel_radius_m", 0.01);

/// Value of the subject that a baseline does not share; empty where a car lacks it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Difference {
    /// Dotted key.
    pub key: String,
    /// Unit, `-` for none.
    pub unit: String,
    /// Value of the subject.
    pub subject: String,
    /// Value of the baseline.
    pub baseline: String,
}

/// Name, unit, decimals and value of a difference named first.
type NamedQuantity = (&'static str, &'static str, usize, fn(&Setup) -> f64);

/// Quantities with the largest effect on fuel.
const NAMED: [NamedQuantity; 7] = [
    ("mass", "kg", 0, |car| car.road_load.base.mass_kg),
    ("rated power", "kW", 0, |car| car.engine().rated_w / 1e3),
    ("displacement", "cm3", 0, |car| {
        car.engine().displacement_m3 * 1e6
    }),
    ("f0", "N", 1, |car| car.road_load.base.f0_n),
    ("f2", "N/(km/h)2", 5, |car| {
        car.road_load.base.f2_n_per_m_s2 / 12.96
    }),
    ("f1", "N/(km/h)", 3, |car| {
        car.road_load.base.f1_n_per_m_s / 3.6
    }),
    ("wheel radius", "mm", 0, |car| {
        car.road_load.base.wheel_radius_m * 1e3
    }),
];
/// Maximum number of named differences, so that the words fit on a line.
const MAX_NAMED: usize = 3;

/// Lists differences other than the transmission and its oil.
#[must_use]
pub fn differences(subject: &Setup, baseline: &Setup) -> Vec<Difference> {
    let watched = |info: &&KeyInfo| {
        let is_name = info.key.ends_with(".title");
        !is_name && SAME.iter().any(|table| info.key.starts_with(table))
    };
    let find = |car: &'_ Setup, key: &str| car.keys.iter().find(|info| info.key == key).cloned();
    let mut list = Vec::new();
    for info in subject.keys.iter().filter(watched) {
        let other = find(baseline, &info.key);
        if !other
            .as_ref()
            .map_or(info.value.is_empty(), |other| same(info, other))
        {
            list.push(difference(
                info,
                &info.value,
                other.as_ref().map_or("", |o| &o.value),
            ));
        }
    }
    let missing = |info: &&KeyInfo| !info.value.is_empty() && find(subject, &info.key).is_none();
    let more = baseline.keys.iter().filter(watched).filter(missing);
    list.extend(more.map(|info| difference(info, "", &info.value)));
    list
}

fn difference(info: &KeyInfo, subject: &str, baseline: &str) -> Difference {
    Difference {
        key: info.key.clone(),
        unit: info.unit.clone(),
        subject: subject.to_owned(),
        baseline: baseline.to_owned(),
    }
}

fn same(a: &KeyInfo, b: &KeyInfo) -> bool {
    let width = if a.key == RADIUS.0 { RADIUS.1 } else { EQUAL };
    match (a.si, b.si) {
        (Some(a), Some(b)) => (a - b).abs() <= width * a.abs(),
        _ => a.value == b.value,
    }
}

/// Words for a comparison: "like for like", or "not like for like: mass -190 kg, rated power -22 kW and 12 other values".
#[must_use]
pub fn words(subject: &Setup, baseline: &Setup, differences: &[Difference]) -> String {
    if differences.is_empty() {
        return "like for like: road load, tyres and engine are the same".to_owned();
    }
    let named = NAMED.iter().filter_map(|(name, unit, decimals, value)| {
        let by = value(baseline) - value(subject);
        let text = signed(by, *decimals);
        let is_zero = text.chars().all(|c| !c.is_ascii_digit() || c == '0');
        (!is_zero).then(|| format!("{name} {text} {unit}"))
    });
    let named: Vec<String> = named.take(MAX_NAMED).collect();
    let rest = differences.len().saturating_sub(named.len());
    let rest = match (rest, named.len()) {
        (0, _) => String::new(),
        (1, 0) => "1 value".to_owned(),
        (n, 0) => format!("{n} values"),
        (1, _) => " and 1 other value".to_owned(),
        (n, _) => format!(" and {n} other values"),
    };
    format!("not like for like: {}{rest}", named.join(", "))
}
