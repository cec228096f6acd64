//! Shipped plan `plans/uncertainty_rover.toml` and its page `docs/uncertainty.md` against the cars: every uncertain value is a factor or
//! left out with its effect, and every range is valid. `tools/tables` makes the effects on the page.
//! Truth: the program's registry of keys with their status, and new drives.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::collections::{BTreeMap, BTreeSet};

use crate::common::{at, cycle, try_car};
use cvtcycle::config::KeyInfo;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::model::drive::{Start, drive, litres_per_100km};
use cvtcycle::output::Flags;

const PLAN: &str = include_str!("../../plans/uncertainty_rover.toml");
const PAGE: &str = include_str!("../../docs/uncertainty.md");
const CVT: &str = "rover_216_cvt";
const MANUAL: &str = "rover_216_5mt";

/// Factor of the plan.
struct Factor {
    key: String,
    name: String,
    cars: String,
    scale: bool,
    status: String,
    source: String,
    /// Values as on the page.
    values: String,
    /// Minimum and maximum, or every entry of a list, as `--set` takes them; two geometric standard deviations of a lognormal.
    ends: Vec<String>,
    /// Most likely value.
    middle: String,
}

/// Row of a table on the page.
struct Row {
    cells: Vec<String>,
}

impl Row {
    fn key(&self) -> &str {
        self.cells[0].trim_matches('`')
    }

    fn cars(&self) -> &str {
        &self.cells[1]
    }
}

fn plan() -> toml::Table {
    toml::from_str(PLAN).unwrap()
}

fn number(value: &toml::Value) -> f64 {
    value
        .as_float()
        .or_else(|| value.as_integer().map(|i| i as f64))
        .unwrap()
}

fn text(table: &toml::Table, key: &str) -> String {
    table
        .get(key)
        .and_then(toml::Value::as_str)
        .unwrap_or_default()
        .to_owned()
}

fn factors() -> Vec<Factor> {
    plan()["factor"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| factor(f.as_table().unwrap()))
        .collect()
}

fn factor(f: &toml::Table) -> Factor {
    let scale = text(f, "acts") == "scale";
    let (values, ends, middle) = match f.get("values") {
        Some(list) => {
            let entries: Vec<String> = list
                .as_array()
                .unwrap()
                .iter()
                .map(toml::Value::to_string)
                .collect();
            (
                format!("list of {}", entries.len()),
                entries.clone(),
                entries[0].clone(),
            )
        }
        None => distribution(f["distribution"].as_table().unwrap()),
    };
    let cars = if f.contains_key("cars") {
        text(f, "cars")
    } else {
        "subject".to_owned()
    };
    let values = if scale {
        format!("scale, {values}")
    } else {
        values
    };
    Factor {
        key: text(f, "key"),
        name: text(f, "name"),
        cars,
        scale,
        status: text(f, "status"),
        source: text(f, "source"),
        values,
        ends,
        middle,
    }
}

fn distribution(d: &toml::Table) -> (String, Vec<String>, String) {
    let (name, parameters) = d.iter().next().unwrap();
    let get = |key: &str| number(&parameters[key]);
    let (names, low, high, middle): (&[&str], f64, f64, f64) = match name.as_str() {
        "triangular" => (
            &["low", "mode", "high"],
            get("low"),
            get("high"),
            get("mode"),
        ),
        "uniform" => (&["low", "high"], get("low"), get("high"), get("low")),
        "truncated_normal" => (
            &["mean", "sd", "low", "high"],
            get("low"),
            get("high"),
            get("mean"),
        ),
        _ => {
            let g2 = get("geometric_sd").powi(2);
            (
                &["median", "geometric_sd"],
                get("median") / g2,
                get("median") * g2,
                get("median"),
            )
        }
    };
    let listed: Vec<String> = names.iter().map(|key| get(key).to_string()).collect();
    (
        format!("{name} {}", listed.join(", ")),
        vec![low.to_string(), high.to_string()],
        middle.to_string(),
    )
}

/// Rows of the tables below a heading of the second level.
fn rows(heading: &str) -> Vec<Row> {
    let section = PAGE
        .split("\n## ")
        .find(|section| section.starts_with(heading))
        .unwrap();
    let table = section.lines().filter(|line| line.starts_with("| `"));
    table
        .map(|line| Row {
            cells: line
                .trim_matches('|')
                .split('|')
                .map(|cell| cell.trim().to_owned())
                .collect(),
        })
        .collect()
}

/// Shipped cars selected by a word of `cars`.
fn meant(cars: &str) -> &'static [&'static str] {
    match cars {
        "all" => &[CVT, MANUAL],
        "subject" => &[CVT],
        "baselines" => &[MANUAL],
        other => panic!("no cars are named {other}"),
    }
}

fn keys(car: &str) -> BTreeMap<String, KeyInfo> {
    try_car(car, &[])
        .unwrap()
        .keys
        .into_iter()
        .map(|key| (key.key.clone(), key))
        .collect()
}

/// Override that sets a factor of a car.
fn set(factor: &Factor, value: &str, keys: &BTreeMap<String, KeyInfo>) -> String {
    let scaled = || value.parse::<f64>().unwrap() * keys[&factor.key].value.parse::<f64>().unwrap();
    let value = if factor.scale {
        scaled().to_string()
    } else {
        value.to_owned()
    };
    format!("{}={value}", factor.key)
}

/// Fuel in L/100 km after a soak at -10 degC, and seconds with a failing check.
fn litres(car: &str, sets: &[String], cycle: &Cycle) -> (f64, f64) {
    let setup = try_car(car, sets).unwrap_or_else(|problems| panic!("{car} {sets:?}: {problems}"));
    let density = setup
        .keys
        .iter()
        .find(|key| key.key == "engine.fuel.density_kg_m3")
        .unwrap()
        .si
        .unwrap();
    let outcome = drive(&setup, cycle, &at(-10.0, Start::Soak));
    let total = outcome.totals.total();
    let bad = [
        Flags::MISSED_TRACE,
        Flags::GROSS_SLIP,
        Flags::LOW_CLAMP,
        Flags::FLOW_LIMITED,
        Flags::NOT_CONVERGED,
    ];
    let bad_s = bad
        .into_iter()
        .map(|flag| outcome.totals.seconds(flag))
        .sum();
    (
        litres_per_100km(total.fuel_kg, density, total.distance_m),
        bad_s,
    )
}

/// Plan: cold soak, both Rovers, at least 10 000 pairs, few enough runs to start without `--yes`.
#[test]
fn the_design_has_its_ten_thousand_pairs() {
    let plan = plan();
    let study = plan["study"].as_table().unwrap();
    assert_eq!(
        (
            text(study, "vehicle"),
            text(study, "cycle"),
            text(study, "start")
        ),
        (CVT.into(), "ece15_eudc".into(), "soak".into())
    );
    assert_eq!(
        study["baselines"].as_array().unwrap(),
        &[toml::Value::from(MANUAL)]
    );
    assert!((number(&study["ambient_degc"]) + 10.0).abs() < 1e-12);
    let samples = number(&study["design"]["saltelli"]["samples"]);
    let pairs = samples * (factors().len() + 2) as f64;
    assert!((10_000.0..=50_000.0).contains(&pairs), "{pairs} pairs");
    assert!(
        (samples.log2() - samples.log2().round()).abs() < 1e-12,
        "{samples} is no power of two"
    );
}

#[test]
fn every_factor_says_how_its_range_is_known() {
    let mut names = BTreeSet::new();
    let mut taken = BTreeSet::new();
    for f in factors() {
        assert!(
            ["source", "derived", "fitted", "assumed"].contains(&f.status.as_str()),
            "{}: status `{}`",
            f.key,
            f.status
        );
        assert!(f.source.len() > 10, "{}: source `{}`", f.key, f.source);
        assert!(
            names.insert(f.name.clone()),
            "two factors are named {}",
            f.name
        );
        for car in meant(&f.cars) {
            assert!(
                taken.insert((f.key.clone(), *car)),
                "{car} has {} twice",
                f.key
            );
        }
    }
}

/// Both ends of each range are valid alone, and the most likely value is that of the file.
#[test]
fn ranges_are_possible_and_lie_about_the_shipped_values() {
    let shipped: BTreeMap<&str, _> = [CVT, MANUAL]
        .into_iter()
        .map(|car| (car, keys(car)))
        .collect();
    for f in factors() {
        for car in meant(&f.cars) {
            let keys = &shipped[car];
            let key = keys
                .get(&f.key)
                .unwrap_or_else(|| panic!("{car} has no key {}", f.key));
            let middle: f64 = if f.scale {
                1.0
            } else {
                key.si.map_or(f64::NAN, |_| key.value.parse().unwrap())
            };
            match f.middle.parse::<f64>() {
                Ok(mode) => assert!(
                    (mode - middle).abs() <= 1e-9 * middle.abs(),
                    "{car} {}: {mode} is not the file's {middle}",
                    f.key
                ),
                Err(_) => assert_eq!(
                    f.middle.replace(' ', ""),
                    key.value.replace(".0,", ",").replace(' ', ""),
                    "{car} {}",
                    f.key
                ),
            }
            for end in &f.ends {
                let set = set(&f, end, keys);
                let changed = try_car(car, std::slice::from_ref(&set))
                    .unwrap_or_else(|problems| panic!("{car} {set}: {problems}"));
                assert!(
                    changed
                        .keys
                        .iter()
                        .any(|key| key.key == f.key && key.status == "set"),
                    "{car}: {set} does not arrive"
                );
            }
        }
    }
}

/// Combined ends: every factor at one of its ends by a fixed sequence of bits. Such corners are far rarer than any draw of the plan.
#[test]
fn corners_of_the_ranges_go_together() {
    let (factors, cycle) = (factors(), cycle("ece15_eudc"));
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
    for corner in 0..40 {
        for car in [CVT, MANUAL] {
            let keys = keys(car);
            let own = factors.iter().filter(|f| meant(&f.cars).contains(&car));
            let sets: Vec<String> = own
                .map(|f| {
                    state = state
                        .wrapping_mul(6_364_136_223_846_793_005)
                        .wrapping_add(1_442_695_040_888_963_407);
                    let pick = if corner < 2 {
                        corner * (f.ends.len() - 1)
                    } else {
                        (state >> 33) as usize % f.ends.len()
                    };
                    set(f, &f.ends[pick], &keys)
                })
                .collect();
            let (fuel, bad_s) = litres(car, &sets, &cycle);
            assert!(
                fuel > 4.0 && fuel < 14.0,
                "{car}, corner {corner}: {fuel} L/100 km"
            );
            assert!(
                bad_s < 0.5,
                "{car}, corner {corner}: a check fails for {bad_s} s"
            );
        }
    }
}

/// Every assumed or fitted number of the two cars and their fluids is a factor, or has a row with its effect.
#[test]
fn every_uncertain_value_is_a_factor_or_listed() {
    let left = rows("Left out");
    let factors = factors();
    for car in [CVT, MANUAL] {
        for key in keys(car)
            .into_values()
            .filter(|key| key.si.is_some() && ["assumed", "fitted"].contains(&key.status.as_str()))
        {
            let varied = factors
                .iter()
                .filter(|f| f.key == key.key && meant(&f.cars).contains(&car))
                .count();
            let listed = left
                .iter()
                .filter(|row| row.key() == key.key && meant(row.cars()).contains(&car))
                .count();
            assert_eq!(
                varied + listed,
                1,
                "{car}: {} ({}) is {varied} times a factor and {listed} times left out",
                key.key,
                key.status
            );
        }
    }
}

#[test]
fn the_page_lists_the_factors_of_the_plan() {
    let said: Vec<Vec<String>> = rows("Factors").into_iter().map(|row| row.cells).collect();
    let planned = factors();
    assert_eq!(said.len(), planned.len());
    for (row, f) in said.iter().zip(&planned) {
        let here = [
            format!("`{}`", f.key),
            f.cars.clone(),
            f.values.clone(),
            f.status.clone(),
            f.source.clone(),
        ];
        assert_eq!([0, 1, 2, 6, 7].map(|k| row[k].clone()), here);
    }
}

/// A value left out despite an effect names the factor that carries it, or a reason.
#[test]
fn omitted_values_have_a_reason() {
    let factors: BTreeSet<String> = factors().into_iter().map(|f| f.key).collect();
    for row in rows("Left out") {
        let largest = |cell: &str| {
            numbers(cell)
                .into_iter()
                .fold(0.0, |a: f64, b| if b.abs() > a { b.abs() } else { a })
        };
        let small = largest(&row.cells[3]) <= 0.065
            && largest(&row.cells[4]) <= 0.25
            && largest(&row.cells[5]) <= 0.25;
        let carried = row.cells[6]
            .split('`')
            .skip(1)
            .step_by(2)
            .any(|key| factors.contains(key));
        let stated = ["cancels", "measured"]
            .iter()
            .any(|word| row.cells[6].contains(word));
        assert!(
            small || carried || stated,
            "{}: {}",
            row.key(),
            row.cells[6]
        );
    }
}

fn numbers(cell: &str) -> Vec<f64> {
    cell.split(" / ")
        .map(|x| {
            x.parse()
                .unwrap_or_else(|_| panic!("`{cell}` is no pair of numbers"))
        })
        .collect()
}
