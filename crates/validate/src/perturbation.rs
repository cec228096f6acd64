//! The changes of the cars under which rows are judged again: small and large factors on numbers, and choices made otherwise.

use std::collections::{BTreeSet, HashMap};

use cvtcycle_config::{KeyInfo, Override, Target};
use cvtcycle_model::keys::Kind;

/// Factors that all rows see.
const SMALL: [f64; 2] = [0.6, 1.5];
/// Factors for the rows whose verdict nothing else flips.
const LARGE: [f64; 2] = [0.1, 8.0];
/// Least change of a number that counts, as a share of it: a factor ends at the range of the key.
const LEAST: f64 = 0.02;

/// Numbers that are also changed together: one cause has several keys, or the program refuses one of them alone.
const TOGETHER: [(&str, &[&str]); 9] = [
    (
        "stiffness of both pulleys",
        &[
            "transmission.cvt.variator.primary_stiffness_n",
            "transmission.cvt.variator.secondary_stiffness_n",
        ],
    ),
    (
        "area of both pistons",
        &[
            "transmission.cvt.variator.primary_piston_cm2",
            "transmission.cvt.variator.secondary_piston_cm2",
        ],
    ),
    (
        "both ends of the ratio",
        &[
            "transmission.cvt.ratio.low",
            "transmission.cvt.ratio.high",
            "transmission.cvt.variator.stop_from_ratio",
            "transmission.cvt.variator.stop_to_ratio",
        ],
    ),
    (
        "ratios of the end stop",
        &[
            "transmission.cvt.variator.stop_from_ratio",
            "transmission.cvt.variator.stop_to_ratio",
        ],
    ),
    (
        "rate of all shifts",
        &[
            "transmission.cvt.ratio.up_per_s",
            "transmission.cvt.ratio.down_per_s",
        ],
    ),
    (
        "idle speeds",
        &["engine.idle.hot_rpm", "engine.idle.cold_rpm"],
    ),
    (
        "speeds of the fuel cut",
        &["engine.fuel.cut_above_rpm", "engine.fuel.fuel_back_rpm"],
    ),
    (
        "thermostat",
        &[
            "thermal.radiator.thermostat_from_degc",
            "thermal.radiator.thermostat_to_degc",
        ],
    ),
    (
        "viscosity of the transmission oil",
        &["lubricant.kv40_mm2_s", "lubricant.kv100_mm2_s"],
    ),
];

/// Choices that the cars have made otherwise: key and word.
const CHOICES: [(&str, &str); 9] = [
    ("lubricant.friction.film.enabled", "false"),
    ("road_load.surface", "road"),
    ("thermal.cooler.bypassed", "true"),
    ("transmission.cvt.belt.bands_carry_themselves", "true"),
    ("transmission.cvt.clamp", "slip_limited"),
    ("transmission.cvt.clamp", "torque_following"),
    ("transmission.cvt.pump.kind", "dual_cavity"),
    ("transmission.cvt.pump.kind", "variable"),
    ("transmission.cvt.variator.compensated", "false"),
];

/// How far a change goes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Size {
    /// Factor on the numbers.
    Factor(f64),
    /// Another word.
    Choice(&'static str),
}

/// A change of the cars: a name, a size, and the keys that are set.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Perturbation {
    pub(super) name: String,
    size: Size,
    keys: Vec<String>,
}

impl Perturbation {
    fn of_key(key: &str, size: Size) -> Self {
        Perturbation {
            name: key.to_owned(),
            size,
            keys: vec![key.to_owned()],
        }
    }

    pub(super) fn is_small(&self) -> bool {
        matches!(self.size, Size::Factor(factor) if SMALL.contains(&factor))
    }

    /// As people read it.
    pub(super) fn text(&self) -> String {
        match self.size {
            Size::Factor(factor) => format!("{} x{factor}", self.name),
            Size::Choice(word) => format!("{}={word}", self.name),
        }
    }

    /// Gives the overrides for a car with these keys.
    pub(super) fn overrides(&self, known: &[KeyInfo]) -> Vec<Override> {
        let of_key = |key: &String| {
            let info = known.iter().find(|info| info.key == *key)?;
            match self.size {
                Size::Factor(factor) => changed(info, factor),
                Size::Choice(word) => Override::new(key, word).ok(),
            }
        };
        self.keys.iter().filter_map(of_key).collect()
    }
}

/// A number times a factor, within the range of its key; none where that is no change.
fn changed(info: &KeyInfo, factor: f64) -> Option<Override> {
    let value: f64 = info.value.parse().ok()?;
    let row = Override::number(&info.key, value).row()?;
    let range = row.range();
    let mut now = (value * factor).clamp(range.low(), range.high());
    if matches!(row.kind, Kind::Integer(..)) {
        now = now.round();
    }
    let counts = range.contains(now) && (now - value).abs() > LEAST * value.abs();
    counts
        .then(|| Override::new(&info.key, &now.to_string()).ok())
        .flatten()
}

/// Keys with their values of every car of the sources, by its name and options, before the overrides of the source.
pub(super) type KnownCars = HashMap<String, Vec<KeyInfo>>;

/// The changes that change a car: those that all rows see, then the large ones.
pub(super) fn lists(known: &KnownCars) -> [Vec<Perturbation>; 2] {
    let is_meant = |info: &&KeyInfo| {
        info.is_number
            && info.status != "choice"
            && matches!(
                Target::from_key(&info.key).0,
                Target::Vehicle | Target::Lubricant
            )
    };
    let numbers = known.values().flatten().filter(is_meant);
    let numbers: BTreeSet<&str> = numbers.map(|info| info.key.as_str()).collect();
    let of_factor = |factor: f64| -> Vec<Perturbation> {
        let size = Size::Factor(factor);
        let single = numbers.iter().map(|key| Perturbation::of_key(key, size));
        let together = TOGETHER.iter().map(|(name, keys)| Perturbation {
            name: (*name).to_owned(),
            size,
            keys: keys.iter().map(|key| (*key).to_owned()).collect(),
        });
        single.chain(together).collect()
    };
    let choices = CHOICES.iter();
    let choices = choices.map(|(key, word)| Perturbation::of_key(key, Size::Choice(word)));
    let small = SMALL.into_iter().flat_map(of_factor).chain(choices);
    let large = LARGE.into_iter().flat_map(of_factor);
    let is_change = |by: &Perturbation| known.values().any(|keys| !by.overrides(keys).is_empty());
    [
        small.filter(is_change).collect(),
        large.filter(is_change).collect(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(key: &str, value: &str) -> KeyInfo {
        KeyInfo {
            key: key.to_owned(),
            value: value.to_owned(),
            ..KeyInfo::default()
        }
    }

    #[test]
    fn a_factor_ends_at_the_range_of_the_key() {
        let share = key("engine.heat.friction_to_oil", "0.9");
        assert_eq!(
            changed(&share, 1.5),
            Override::new("engine.heat.friction_to_oil", "1").ok(),
            "a share is at most 1"
        );
        assert_eq!(changed(&key("engine.heat.friction_to_oil", "1"), 1.5), None);
        assert_eq!(
            changed(&key("transmission.cvt.belt.band_count", "9"), 0.6),
            Override::new("transmission.cvt.belt.band_count", "5").ok(),
            "5.4 bands"
        );
        assert_eq!(changed(&key("road_load.altitude_m", "0"), 8.0), None);
        assert_eq!(changed(&key("road_load.surface", "road"), 8.0), None);
    }

    #[test]
    fn a_change_goes_to_the_keys_that_a_car_has() {
        let by = Perturbation {
            name: "idle speeds".to_owned(),
            size: Size::Factor(1.5),
            keys: vec![
                "engine.idle.hot_rpm".to_owned(),
                "engine.idle.cold_rpm".to_owned(),
            ],
        };
        let set = by.overrides(&[key("engine.idle.hot_rpm", "800")]);
        let expected = Override::new("engine.idle.hot_rpm", "1200").ok();
        assert_eq!(set.first(), expected.as_ref());
        assert_eq!(set.len(), 1, "a car without the other key");
        assert_eq!(by.text(), "idle speeds x1.5");
        assert!(by.overrides(&[]).is_empty());
    }
}
