//! The manual twin of a car. The truth is the rule worked out here by hand, and the gear set of a car that the rule has not seen.

use cvtcycle_config::setup::{Kind, NamedBy, Options, Setup, TWIN, baseline_of, load, name_of};
use cvtcycle_config::{KeyInfo, Override};
use cvtcycle_model::transmission::Transmission;

fn twin(word: &str, set: &[&str]) -> Setup {
    let options = Options {
        set: Override::parse_all(set).unwrap(),
        ..Options::default()
    };
    load(&baseline_of(word, TWIN), &options.of_twin(NamedBy::Caller)).unwrap()
}

fn ratios(setup: &Setup) -> Vec<f64> {
    match setup.transmission() {
        Transmission::Manual(manual) => manual.overall.clone(),
        Transmission::Cvt(_) => Vec::new(),
    }
}

fn find<'s>(setup: &'s Setup, key: &str) -> &'s KeyInfo {
    let found = setup.keys.iter().find(|info| info.key == key);
    found.unwrap_or_else(|| panic!("{key}"))
}

/// A Honda Civic 2.0 of 2016 (gears 3.642 to 0.686, final drive 4.105, rolling radius 0.3095 m), which is none of the cars of the rule.
#[test]
fn the_rule_meets_the_gear_set_of_another_car_within_a_tenth() {
    let own = ratios(&twin("rover_216_cvt", &["road_load.wheel_radius_m=0.3095"]));
    let civic = [3.642, 2.080, 1.361, 1.023, 0.829, 0.686].map(|gear| gear * 4.105);
    for (own, civic) in own.iter().zip(civic) {
        assert!((own / civic - 1.0).abs() < 0.1, "{own} {civic}");
    }
    assert_eq!(own.len(), civic.len());
}

#[test]
fn ratios_and_shift_speeds_follow_the_rule() {
    // 60 2 pi r f/1000 with f = 126 rpm per km/h, and span 5.39; full load of the Rover has its highest power at 6000 rpm.
    let (r, f) = (0.2832, 126.0);
    let first = 60.0 * std::f64::consts::TAU * r * f / 1000.0;
    let shares: [f64; 6] = [0.0, 0.309, 0.542, 0.721, 0.863, 1.0];
    let setup = twin("rover_216_cvt", &[]);
    for (own, share) in ratios(&setup).iter().zip(shares) {
        let by_hand = first / 5.39_f64.powf(share);
        assert!((own - by_hand).abs() < 6e-4, "{own} {by_hand}");
    }
    let up = &find(&setup, "transmission.manual.upshift_kmh").value;
    let up: Vec<f64> = up
        .trim_matches(['[', ']'])
        .split(", ")
        .map(|x| x.parse().unwrap())
        .collect();
    for (k, (up, ratio)) in up.iter().zip(ratios(&setup)).enumerate() {
        let rpm = (0.47 - 0.03 * k as f64) * 6000.0;
        let by_hand = rpm * 60.0 * std::f64::consts::TAU * r / ratio / 1000.0;
        assert!((up - by_hand).abs() < 0.05, "{up} {by_hand}");
    }
    assert_eq!(up.len(), 5);
}

#[test]
fn all_but_the_box_is_the_car_s_own() {
    let (car, own) = (
        load("rover_216_cvt", &Options::default()).unwrap(),
        twin("rover_216_cvt", &[]),
    );
    assert_eq!(
        (own.name.as_str(), name_of("twin:a/b.toml").as_str()),
        ("rover_216_cvt_twin", "b_twin")
    );
    assert_eq!(
        own.title,
        "Twin of Rover 216, 1.6 L, pushing-belt CVT, 6-speed manual"
    );
    assert!(own.baselines.is_empty());
    let is_box = |key: &str| {
        [
            "transmission",
            "thermal.transmission",
            "thermal.cooler",
            "lubricant.",
            "vehicle.",
        ]
        .iter()
        .any(|table| key.starts_with(table))
    };
    let mut count = 0;
    for info in car.keys.iter().filter(|info| !is_box(&info.key)) {
        let twin = find(&own, &info.key);
        assert_eq!(
            (&twin.value, &twin.status, &twin.source),
            (&info.value, &info.status, &info.source),
            "{}",
            info.key
        );
        count += 1;
    }
    assert!(count > 80, "{count}");
    assert!(own.keys.iter().all(|info| !info.key.contains(".cvt")));
    let oil = find(&own, "vehicle.transmission_oil");
    assert_eq!(
        (oil.value.as_str(), oil.status.as_str()),
        ("gear_75w80", "class")
    );
}

#[test]
fn what_changes_the_car_changes_its_twin() {
    let set = [
        "road_load.mass_kg=1300",
        "lubricant.kv40_mm2_s=30",
        "transmission.cvt.pump.displacement_cc_rev=5",
    ];
    let setup = twin("rover_216_cvt", &set);
    assert!((setup.road_load.base.mass_kg - 1300.0).abs() < 1e-9);
    assert_eq!(find(&setup, "road_load.mass_kg").status, "set");
    // The oil is another one.
    assert_eq!(
        find(&setup, "lubricant.kv40_mm2_s").status,
        find(&twin("rover_216_cvt", &[]), "lubricant.kv40_mm2_s").status
    );
}

#[test]
fn the_table_of_the_twin_is_heard() {
    let five = twin(
        "rover_216_cvt",
        &["twin.gears=5", "twin.span=4", "twin.first_rpm_per_kmh=150"],
    );
    let own = ratios(&five);
    assert_eq!(own.len(), 5);
    assert!((own[0] / own[4] - 4.0).abs() < 1e-3);
    assert!((own[0] - 60.0 * std::f64::consts::TAU * 0.2832 * 150.0 / 1000.0).abs() < 1e-3);
    assert_eq!(
        five.title,
        "Twin of Rover 216, 1.6 L, pushing-belt CVT, 5-speed manual"
    );
    let given = twin(
        "rover_216_cvt",
        &[
            "twin.overall_ratios=[13.45, 7.67, 5.25, 4.15, 3.33]",
            "twin.shift_kmh=[15, 35, 50, 70]",
            "twin.box=rover_216_5mt",
        ],
    );
    let known = load("rover_216_5mt", &Options::default()).unwrap();
    assert_eq!(ratios(&given), ratios(&known));
    let loss = "transmission.manual.gears.churning_factor";
    assert_eq!(find(&given, loss).value, find(&known, loss).value);
    assert_eq!(find(&given, loss).status, "like");
}

#[test]
fn only_a_car_with_a_cvt_has_a_twin() {
    for name in Kind::Vehicle.names() {
        let word = baseline_of(name, TWIN);
        let found = load(&word, &Options::default());
        let car = load(name, &Options::default()).unwrap();
        assert_eq!(found.is_ok(), car.transmission().is_cvt(), "{name}");
    }
    assert!(load("twin:twin:rover_216_cvt", &Options::default()).is_err());
}
