//! Comparability of baselines. Truth: the effect of each override, one at a time.

use cvtcycle::config::Override;
use cvtcycle::config::setup::{NamedBy, Options, Setup, TWIN, baseline_of, load};
use cvtcycle::output::summary::{differences, likeness};

fn car(word: &str, set: &[String]) -> Setup {
    let set = Override::parse_all(set).unwrap();
    load(
        word,
        &Options {
            set,
            ..Options::default()
        },
    )
    .unwrap()
}

fn keys(subject: &Setup, baseline: &Setup) -> Vec<String> {
    let list = differences(subject, baseline);
    list.into_iter().map(|found| found.key).collect()
}

#[test]
fn a_twin_is_like_for_like_and_the_shipped_pair_too() {
    let subject = car("rover_216_cvt", &[]);
    let options = Options::default().of_twin(NamedBy::Caller);
    let twin = load(&baseline_of("rover_216_cvt", TWIN), &options).unwrap();
    for baseline in [twin, car("rover_216_5mt", &[])] {
        let list = differences(&subject, &baseline);
        assert_eq!(list, []);
        assert!(likeness(&subject, &baseline, &list).starts_with("like for like"));
    }
}

/// Every number of road load, engine and engine oil in a file, changed by a thousandth, is named, and nothing else.
#[test]
fn each_value_that_differs_is_named() {
    let subject = car("rover_216_cvt", &[]);
    let same = [
        "road_load.",
        "engine.",
        "engine_oil.",
        "thermal.engine.",
        "thermal.radiator.",
    ];
    let numbers = subject.keys.iter().filter(|info| {
        info.is_number
            && info.key != "road_load.wheel_radius_m"
            && same.iter().any(|table| info.key.starts_with(table))
    });
    let mut count = 0;
    for info in numbers {
        let Ok(value) = info.value.parse::<f64>() else {
            continue;
        };
        let set = format!("{}={}", info.key, value * 1.001);
        let Ok(of) = Override::parse_all(&[&set]) else {
            continue;
        };
        // Some values cannot change: at the end of a range, or tied to another value.
        let Ok(baseline) = load(
            "rover_216_cvt",
            &Options {
                set: of,
                ..Options::default()
            },
        ) else {
            continue;
        };
        let moved = value * 1.001;
        let expected: &[&str] = if (moved - value).abs() > 0.0 {
            &[&info.key]
        } else {
            &[]
        };
        assert_eq!(keys(&subject, &baseline), expected, "{set}");
        count += expected.len();
    }
    assert!(count > 60, "{count}");
}

#[test]
fn transmission_and_similar_tyres_do_not_count_as_differences() {
    let subject = car("rover_216_cvt", &[]);
    let set = |text: &str| vec![text.to_owned()];
    for same in [
        "transmission.cvt.pump.displacement_cc_rev=9",
        "lubricant.kv40_mm2_s=30",
        "road_load.wheel_radius_m=0.2835",
    ] {
        assert_eq!(
            keys(&subject, &car("rover_216_cvt", &set(same))),
            [] as [&str; 0],
            "{same}"
        );
    }
    let other = car("rover_216_cvt", &set("road_load.wheel_radius_m=0.29"));
    assert_eq!(keys(&subject, &other), ["road_load.wheel_radius_m"]);
    // Another form of the road load has keys that the other car lacks.
    let body = [
        "road_load.form.body.drag_coefficient=0.3",
        "road_load.form.body.frontal_area_m2=2",
        "road_load.form.body.rolling_coefficient=0.01",
    ];
    let body = car("rover_216_cvt", &body.map(str::to_owned));
    let found = keys(&subject, &body);
    assert!(
        found
            .iter()
            .any(|key| key == "road_load.form.coefficients.f0_n"),
        "{found:?}"
    );
    assert!(
        found
            .iter()
            .any(|key| key == "road_load.form.body.drag_coefficient"),
        "{found:?}"
    );
}

#[test]
fn the_words_name_what_moves_the_fuel_first() {
    let subject = car("rover_216_cvt", &[]);
    let set = [
        "road_load.mass_kg=940",
        "engine.idle.hot_rpm=800",
        "engine.idle.cold_rpm=1100",
    ];
    let baseline = car("rover_216_cvt", &set.map(str::to_owned));
    let list = differences(&subject, &baseline);
    assert_eq!(
        likeness(&subject, &baseline, &list),
        "not like for like: mass -190 kg and 2 other values"
    );
    let baseline = car("rover_216_cvt", &["engine.idle.hot_rpm=800".to_owned()]);
    let list = differences(&subject, &baseline);
    assert_eq!(
        likeness(&subject, &baseline, &list),
        "not like for like: 1 value"
    );
}
