//! Pairs of values of which one bounds the other, at equality: refused where the two have to differ, read where they need not.

use cvtcycle_config::setup::{Options, load};
use cvtcycle_config::{Override, render};

fn read(sets: &[&str]) -> Result<(), String> {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    let options = Options {
        set: Override::parse_all(&sets).unwrap(),
        ..Options::default()
    };
    load("rover_216_cvt", &options)
        .map(|_| ())
        .map_err(|problems| render(&problems, false))
}

/// Fuel that is back at the speed at which it is cut, and a thermostat that opens within no degree, have no meaning; both are refused with the key.
#[test]
fn values_that_have_to_differ() {
    for (key, below, pair) in [
        (
            "engine.fuel.fuel_back_rpm",
            "1199",
            "engine.fuel.cut_above_rpm=1200",
        ),
        (
            "thermal.radiator.thermostat_from_degc",
            "87",
            "thermal.radiator.thermostat_to_degc=88",
        ),
    ] {
        let equal = pair.split_once('=').unwrap().1;
        let set = |value: &str| read(&[&format!("{key}={value}"), pair]);
        assert_eq!(set(below), Ok(()));
        let refused = set(equal).unwrap_err();
        let name = pair.split_once('=').unwrap().0;
        let is_named = |key: &str| refused.contains(key.rsplit('.').next().unwrap());
        assert!(is_named(key) && is_named(name), "{refused}");
    }
}

/// A range of temperatures in which the engine may stop can be a single one.
#[test]
fn values_that_may_be_equal() {
    for node in ["coolant", "sump"] {
        let set = |least: &str| {
            let [least, most] = [("min", least), ("max", "60")]
                .map(|(end, value)| format!("engine.start_stop.{node}_{end}_degc={value}"));
            read(&[&least, &most])
        };
        assert_eq!(set("60"), Ok(()));
        let refused = set("60.1").unwrap_err();
        assert!(refused.contains(&format!("{node}_max_degc")), "{refused}");
    }
}
