//! Prices of losses: differences of runs, sums, signs with their causes, threads.

use cvtcycle::analysis::attribute::{Attribution, Depth, Pairs, attribute};
use cvtcycle::config::Override;
use cvtcycle::config::cycle::{Cycle, embedded};
use cvtcycle::config::setup::{Options, Setup, load};
use cvtcycle::model::drive::{Conditions, Start, drive};
use cvtcycle::output::Component;
use cvtcycle::output::summary::{Driven, PriceSummary, RunSummary, Settings, run_summary};

const CVT: &str = "rover_216_cvt";
const MANUAL: &str = "rover_216_5mt";

fn car(name: &str, sets: &[&str]) -> Setup {
    let set = sets.iter().map(|set| set.parse::<Override>().unwrap());
    let options = Options {
        set: set.collect(),
        ..Options::default()
    };
    load(name, &options).unwrap()
}

fn at(ambient_degc: f64, start: Start) -> Conditions {
    Conditions {
        ambient_k: ambient_degc + 273.15,
        start,
        max_dt_s: 1.0,
        keep_rows: false,
    }
}

fn driven(setup: &Setup, cycle: &Cycle, conditions: Conditions) -> RunSummary {
    let outcome = drive(setup, cycle, &conditions);
    let driven = Driven {
        name: &setup.name,
        setup,
        outcome: &outcome,
    };
    run_summary(cycle, "subject", &Settings::default(), &driven)
}

fn priced(
    setup: &Setup,
    cycle: &Cycle,
    conditions: Conditions,
    factor: f64,
    depth: Depth,
) -> PriceSummary {
    let attribution = Attribution {
        setup,
        cycle,
        conditions,
        settings: &Settings::default(),
        factor,
        depth,
    };
    attribute(&attribution, &driven(setup, cycle, conditions))
}

const ALONE: Depth = Depth {
    alone: true,
    pairs: Pairs::None,
    shapley: false,
};

/// AT-1 to AT-5 by hand: each number is a difference of runs of cars with the factor in their files.
#[test]
fn every_number_is_a_difference_of_runs() {
    let conditions = at(-10.0, Start::Soak);
    for (name, kind, cycle) in [(CVT, "cvt", "ftp75"), (MANUAL, "manual", "ece15_eudc")] {
        let cycle = embedded(cycle).unwrap();
        let base = car(name, &[]);
        let fuel = |sets: &[String]| {
            let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
            let run = driven(&car(name, &sets), &cycle, conditions);
            let phases = run.phases.iter().map(|phase| phase.fuel_l_per_100km);
            std::iter::once(run.headline_fuel())
                .chain(phases)
                .collect::<Vec<_>>()
        };
        let off = |c: &str| format!("transmission.{kind}.loss_factor.{c}=0");
        let depth = Depth {
            pairs: Pairs::All,
            ..ALONE
        };
        let price = priced(&base, &cycle, conditions, 0.0, depth);
        let names: Vec<&String> = price.losses.keys().collect();
        let components = base.transmission().components();
        assert_eq!(
            names,
            components.iter().map(|c| c.name()).collect::<Vec<_>>()
        );
        let (b, all) = (
            fuel(&[]),
            names.iter().map(|name| off(name)).collect::<Vec<_>>(),
        );
        let none = fuel(&all);
        let same = |a: Option<f64>, x: Option<f64>, y: Option<f64>| {
            let by_hand = x.zip(y).map(|(x, y)| x - y);
            assert_eq!(a.map(f64::to_bits), by_hand.map(f64::to_bits), "{name}");
        };
        same(price.together.l_per_100km, b[0], none[0]);
        let mut sum = 0.0;
        for (k, (component, loss)) in price.losses.iter().enumerate() {
            let without = fuel(&[off(component)]);
            same(loss.saved.l_per_100km, b[0], without[0]);
            for (phase, (_, litres)) in loss.saved.phases.iter().enumerate() {
                same(litres, b[phase + 1], without[phase + 1]);
            }
            let mut others = all.clone();
            others.remove(k);
            let alone = loss.alone.as_ref().unwrap().l_per_100km;
            same(alone, fuel(&others)[0], none[0]);
            sum += loss.saved.l_per_100km.unwrap();
        }
        let interaction = price.interaction.l_per_100km.unwrap();
        assert!((price.together.l_per_100km.unwrap() - sum - interaction).abs() < 1e-12);
        assert_eq!(price.pairs.len(), names.len() * (names.len() - 1) / 2);
        for pair in price.pairs.iter().step_by(7) {
            let [fa, fb] = [&pair.a, &pair.b].map(|own| fuel(&[off(own)])[0].unwrap());
            let both = fuel(&[off(&pair.a), off(&pair.b)])[0].unwrap();
            let near = |x: Option<f64>, want: f64| assert!((x.unwrap() - want).abs() < 1e-12);
            near(pair.interaction.l_per_100km, fa + fb - b[0].unwrap() - both);
            near(pair.a_with_b, b[0].unwrap() - fa);
            near(pair.a_without_b, fb - both);
            near(pair.b_without_a, fa - both);
        }
    }
}

/// AT-6: shares add up to the price of all losses, and those of a group without partners are near its own price.
#[test]
fn shares_of_groups_add_up() {
    let cycle = embedded("ece15_eudc").unwrap();
    for (name, count) in [(CVT, 5), (MANUAL, 4)] {
        let depth = Depth {
            shapley: true,
            ..Depth::default()
        };
        let price = priced(&car(name, &[]), &cycle, at(-10.0, Start::Soak), 0.0, depth);
        assert_eq!(price.groups.len(), count, "{:?}", price.groups.keys());
        let sum: f64 = price
            .groups
            .values()
            .filter_map(|share| share.l_per_100km)
            .sum();
        assert!((sum - price.together.l_per_100km.unwrap()).abs() < 1e-12);
        for (k, (phase, all)) in price.together.phases.iter().enumerate() {
            let attribution =
                |share: &cvtcycle::output::summary::Saving| share.phases.iter().nth(k).unwrap().1;
            let sum: f64 = price.groups.values().filter_map(attribution).sum();
            assert!((sum - all.unwrap()).abs() < 1e-12, "{phase}");
        }
        assert!(price.pairs.is_empty() && price.losses.values().all(|loss| loss.alone.is_none()));
    }
}

/// The engine's fuel line is nearly straight, so half of a loss costs half of its price.
#[test]
fn half_removal_is_half() {
    let cycle = embedded("ece15_eudc").unwrap();
    let pump = |factor: f64| {
        let price = priced(
            &car(CVT, &[]),
            &cycle,
            at(-10.0, Start::Soak),
            factor,
            Depth::default(),
        );
        price.losses["pump"].saved.l_per_100km.unwrap()
    };
    let share = 2.0 * pump(0.5) / pump(0.0);
    assert!((0.97..1.03).contains(&share), "{share}");
    assert!(pump(2.0) < 0.0, "more of a loss costs fuel");
}

/// A loss costs fuel in any climate, in the unchanged car and as the only loss. In the cold a film between the bands carries load: with the other losses
/// removed it may replace friction that is cheaper, so its price alone has a lower bound of minus a thousandth.
#[test]
fn a_price_is_positive() {
    for name in [CVT, MANUAL, "mondeo_20_5mt"] {
        for cycle in ["ece15_eudc", "ftp75", "wltc_class3b"] {
            for ambient in [-30.0, -10.0, 25.0, 40.0] {
                let cycle = embedded(cycle).unwrap();
                let price = priced(
                    &car(name, &[]),
                    &cycle,
                    at(ambient, Start::Soak),
                    0.0,
                    ALONE,
                );
                for (component, loss) in &price.losses {
                    let alone = loss.alone.as_ref().unwrap().percent.unwrap();
                    let saved = loss.saved.percent.unwrap();
                    let least = if component == Component::BeltFilm.name() {
                        -0.1
                    } else {
                        0.0
                    };
                    let place = format!(
                        "{name} {} {ambient} {component}: {saved} {alone}",
                        cycle.name
                    );
                    assert!(saved > least && alone > least, "{place}");
                }
                assert!(price.failures.is_empty(), "{:?}", price.failures);
            }
        }
    }
}

/// J > 0 is caused by heat, and vanishes with constant oil temperatures. The rest is J <= 0: less load lowers the clamping pressure.
#[test]
fn the_interaction_has_the_sign_of_its_cause() {
    let cycle = embedded("ece15_eudc").unwrap();
    let interaction = |sets: &[&str], conditions| {
        let price = priced(&car(CVT, sets), &cycle, conditions, 0.0, Depth::default());
        price.interaction.percent.unwrap()
    };
    // Maximum heat capacities, with all oil coupled to them.
    let held = [
        "thermal.transmission.metal_kj_k=1000",
        "thermal.transmission.belt_kj_k=1000",
        "thermal.transmission.oil_metal_w_k=5000",
        "thermal.transmission.spray_w_k=1000",
        "thermal.engine.block_kj_k=1000",
        "thermal.engine.oil_kj_k=1000",
    ];
    let cold = at(-10.0, Start::Soak);
    let [free, held_cold] = [&[][..], &held].map(|sets| interaction(sets, cold));
    assert!(free > 0.2 && held_cold < 0.0, "{free} {held_cold}");
    let warm = interaction(&held, at(25.0, Start::At(353.15)));
    assert!(warm < -0.2, "{warm}");
}

#[test]
fn same_numbers_on_one_and_four_threads() {
    let cycle = embedded("ece15").unwrap();
    let depth = Depth {
        alone: true,
        pairs: Pairs::All,
        shapley: true,
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| priced(&car(CVT, &[]), &cycle, at(-10.0, Start::Soak), 0.0, depth))
    };
    let text = |price: PriceSummary| serde_json::to_string(&price).unwrap();
    assert_eq!(text(on(1)), text(on(4)));
}

/// Without distance there is no fuel per distance, and the message gives the reason.
#[test]
fn a_car_at_rest_has_no_price() {
    let text = "time_s,speed_kmh\n0,0\n60,0\n";
    let cycle = cvtcycle::config::cycle::read_csv("rest.csv", text.as_bytes()).unwrap();
    let price = priced(&car(CVT, &[]), &cycle, at(25.0, Start::Soak), 0.0, ALONE);
    assert!(price.losses.contains_key("pump") && price.together.percent.is_none());
    assert!(
        price
            .losses
            .values()
            .all(|loss| loss.saved.l_per_100km.is_none())
    );
    assert!(
        price.notes[0].contains("does not move"),
        "{:?}",
        price.notes
    );
}
