//! The order of factors and values has no effect: a grid in another order has the same rows.

use std::collections::{BTreeMap, BTreeSet};

use cvtcycle::config::{Problems, render};
use cvtcycle::output::progress::NoProgress;
use cvtcycle::study::plan::Plan;
use cvtcycle::study::store::Values;
use cvtcycle::study::{End, Study};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, RngSeed, TestRunner};

use crate::parts::MemorySink;

/// Keys of the CVT with values that are valid in any combination.
const KEYS: [(&str, &str, [f64; 2]); 9] = [
    ("road_load.mass_kg", "all", [900.0, 1500.0]),
    (
        "transmission.cvt.belt.band_offset_mm",
        "subject",
        [1.0, 5.0],
    ),
    (
        "transmission.cvt.pump.displacement_cc_rev",
        "subject",
        [6.0, 14.0],
    ),
    (
        "transmission.cvt.clamp.torque_following.safety_factor",
        "subject",
        [1.2, 2.0],
    ),
    ("engine.electrical_w", "all", [0.0, 900.0]),
    ("lubricant.kv40_mm2_s", "subject", [30.0, 60.0]),
    ("engine_oil.density15_kg_m3", "subject", [840.0, 900.0]),
    ("thermal.engine.block_kj_k", "all", [15.0, 60.0]),
    ("ambient_degc", "all", [-30.0, 40.0]),
];

#[derive(Clone, Debug)]
struct Factor {
    key: &'static str,
    cars: &'static str,
    values: Vec<f64>,
}

/// Two to three factors with two to three values, and another order of both.
fn grids() -> impl Strategy<Value = (Vec<Factor>, Vec<Factor>)> {
    let factor = |(key, cars, [low, high]): (&'static str, &'static str, [f64; 2])| {
        prop::collection::btree_set(1_u8..100, 2..4).prop_map(move |parts| {
            let values = parts
                .iter()
                .map(|part| low + (high - low) * f64::from(*part) / 100.0)
                .collect();
            Factor { key, cars, values }
        })
    };
    let chosen = prop::sample::subsequence(KEYS.to_vec(), 2..4);
    let factors =
        chosen.prop_flat_map(move |keys| keys.into_iter().map(factor).collect::<Vec<_>>());
    factors.prop_flat_map(|factors| {
        let values: Vec<_> = factors
            .iter()
            .map(|f| {
                let (key, cars) = (f.key, f.cars);
                Just(f.values.clone())
                    .prop_shuffle()
                    .prop_map(move |values| Factor { key, cars, values })
            })
            .collect();
        (Just(factors), values.prop_shuffle_of())
    })
}

/// Shuffles the list of a strategy.
trait Shuffled {
    fn prop_shuffle_of(self) -> BoxedStrategy<Vec<Factor>>;
}

impl<S: Strategy<Value = Factor> + 'static> Shuffled for Vec<S> {
    fn prop_shuffle_of(self) -> BoxedStrategy<Vec<Factor>> {
        self.prop_flat_map(|factors| Just(factors).prop_shuffle())
            .boxed()
    }
}

fn plan(factors: &[Factor]) -> String {
    let head = "[study]\ntitle = \"t\"\nbaselines = [\"rover_216_5mt\"]\ncycle = \"ece15\"\nset = [\"transmission.cvt.clamp=torque_following\"]\n\
        [study.design.grid]\n";
    let factor = |f: &Factor| {
        let cars = if f.key == "ambient_degc" {
            String::new()
        } else {
            format!("cars = \"{}\"\n", f.cars)
        };
        format!(
            "[[factor]]\nkey = \"{}\"\n{cars}values = {:?}\n",
            f.key, f.values
        )
    };
    head.to_owned() + &factors.iter().map(factor).collect::<String>()
}

fn cell(values: &Values, at: usize) -> String {
    match values {
        Values::Number(cells) => format!(
            "{:016x}",
            if cells[at].is_nan() {
                0
            } else {
                cells[at].to_bits()
            }
        ),
        Values::Count(cells) => cells[at].to_string(),
        Values::Text(cells) => cells[at].to_string(),
    }
}

/// Counts every row as text with its heads, without the number of its point. Rows repeat, since factors of the subject do not affect
/// a baseline.
fn rows(factors: &[Factor]) -> BTreeMap<String, u64> {
    let fail = |problems: Problems| -> String { panic!("{}", render(&problems, false)) };
    let plan = Plan::read("p.toml", &plan(factors)).map_err(fail).unwrap();
    let study = Study::prepare(plan).map_err(fail).unwrap();
    let shelf = MemorySink::default();
    assert_eq!(
        study
            .execute(&BTreeSet::new(), &shelf, &NoProgress)
            .unwrap(),
        End::Complete
    );
    let mut found = BTreeMap::new();
    for part in shelf.0.into_inner().unwrap().values() {
        for at in 0..part.len() {
            let cells = study.columns.iter().zip(&part.values).skip(1);
            let row: BTreeMap<&str, String> = cells
                .map(|(head, values)| (head.name.as_str(), cell(values, at)))
                .collect();
            *found.entry(format!("{row:?}")).or_default() += 1;
        }
    }
    assert_eq!(found.values().sum::<u64>(), study.runs());
    assert!(
        found.len() as u64 >= study.points,
        "the subject has a row of its own at every point"
    );
    found
}

/// The same points in another order give the same rows bit by bit.
#[test]
fn the_order_of_factors_does_not_matter() {
    let config = Config {
        cases: 25,
        failure_persistence: None,
        rng_algorithm: RngAlgorithm::ChaCha,
        rng_seed: RngSeed::Fixed(2001),
        ..Config::default()
    };
    let same = |(one, other): (Vec<Factor>, Vec<Factor>)| {
        let (a, b) = (rows(&one), rows(&other));
        prop_assert_eq!(a, b);
        Ok(())
    };
    if let Err(error) = TestRunner::new(config).run(&grids(), same) {
        panic!("{error}");
    }
}
