//! A car of changed values equals that of an ordinary load with the same overrides, and has the same problems at the same places.
//! Truth of all comparisons: `setup::load` with `--set KEY=NUMBER`, compared by the Debug text of the whole car, which contains every
//! number with all digits.
#![allow(clippy::unwrap_used, reason = "tests")]

mod refused;

use std::collections::BTreeSet;

use crate::common::CARS;
use cvtcycle::config::cycle::embedded;
use cvtcycle::config::setup::{Options, Param, ParamSet, Setup, load};
use cvtcycle::config::{KeyInfo, Override, Problem, Problems, render};
use cvtcycle::model::drive::{Conditions, Start, drive};
use proptest::prelude::*;

const AMBIENT_K: f64 = 263.15;

fn options(set: &[&str]) -> Options {
    Options {
        set: Override::parse_all(set).unwrap(),
        ..Options::default()
    }
}

fn params(word: &str, options: &Options) -> ParamSet {
    ParamSet::load(word, options)
        .unwrap_or_else(|problems| panic!("{word}: {}", render(&problems, false)))
}

fn param(base: &ParamSet, key: &str) -> Param {
    base.param(key)
        .unwrap_or_else(|problem| panic!("{key}: {}", problem.message))
}

/// Debug text of the whole car with its names.
fn text(setup: Setup) -> String {
    let names = format!(
        "{} {} {:?} {:?}",
        setup.name, setup.title, setup.baselines, setup.road_load
    );
    format!("{names} {:?}", setup.vehicle.into_car(AMBIENT_K))
}

/// Loads ordinarily, with numbers in addition to the options.
fn ordinary(word: &str, options: &Options, numbers: &[(&str, f64)]) -> Result<String, Problems> {
    let mut options = options.clone();
    let number = |(key, number): &(&str, f64)| {
        let text = format!("{key}={number}").replace("NaN", "nan");
        text.parse::<Override>().unwrap()
    };
    options.set.extend(numbers.iter().map(number));
    load(word, &options).map(text)
}

/// Text of the car with other numbers, all set at once.
fn built(base: &ParamSet, numbers: &[(&str, f64)]) -> Result<String, Problems> {
    let params: Vec<(Param, f64)> = numbers
        .iter()
        .map(|(key, number)| (param(base, key), *number))
        .collect();
    let numbers: Vec<(&Param, f64)> = params.iter().map(|(param, x)| (param, *x)).collect();
    let set = base.with_numbers(&numbers)?;
    let setup = Setup::from_params(&set);
    assert!(setup.keys.is_empty());
    Ok(text(setup))
}

/// Text of the car with other numbers, set one after the other; none where a step is no possible car.
fn built_in_steps(base: &ParamSet, numbers: &[(&str, f64)]) -> Option<String> {
    let mut set = base.clone();
    for (key, number) in numbers {
        set = set.with(key, *number).ok()?;
    }
    Some(text(Setup::from_params(&set)))
}

/// Sets numbers and compares with the ordinary load. Returns whether the car is valid.
fn same(word: &str, options: &Options, base: &ParamSet, numbers: &[(&str, f64)]) -> bool {
    let (quick, full) = (built(base, numbers), ordinary(word, options, numbers));
    assert!(
        quick == full,
        "{word} {numbers:?}:\n{quick:?}\ninstead of\n{full:?}"
    );
    if let Some(steps) = built_in_steps(base, numbers) {
        assert_eq!(Ok(&steps), full.as_ref(), "{word} {numbers:?} in steps");
    }
    quick.is_ok()
}

/// Value increased slightly, if the key allows it.
fn changed(info: &KeyInfo, base: f64) -> f64 {
    match base {
        _ if info.allowed.starts_with("integer") => base + 1.0,
        0.0 => 0.01,
        _ => base * 1.01,
    }
}

/// Compares every numeric key of a car. Returns the numbers of keys and of valid changes.
fn every_number(word: &str, options: &Options) -> (usize, usize) {
    let base = params(word, options);
    let unchanged = text(base.setup());
    assert_eq!(built(&base, &[]).as_ref(), Ok(&unchanged), "{word}");
    let (mut count, mut accepted) = (0, 0);
    for info in base.keys().iter().filter(|info| info.si.is_some()) {
        let param = param(&base, &info.key);
        assert_eq!(
            (param.base().to_string(), param.unit(), param.allowed()),
            (
                info.value.clone(),
                info.unit.as_str(),
                info.allowed.as_str()
            )
        );
        count += 1;
        let number = changed(info, param.base());
        accepted += usize::from(same(word, options, &base, &[(&info.key, number)]));
    }
    (count, accepted)
}

#[test]
fn every_number_of_every_shipped_car() {
    for (word, least) in [(CARS[0], 160), (CARS[1], 1), (CARS[2], 1)] {
        let (count, accepted) = every_number(word, &Options::default());
        println!("{word}: {accepted} of {count} changes accepted");
        assert!(count >= least, "{word}: only {count} numbers");
        // Few ranges exclude an increase by a hundredth: efficiencies near 1, the ends of a ratio.
        assert!(
            accepted * 100 >= count * 95,
            "{word}: only {accepted} of {count}"
        );
    }
}

/// Options with other keys, other fluids, measured maps and a list of thrust ratios.
#[test]
fn every_number_of_other_options() {
    let fluid = Options {
        lubricant: Some("dexron_iii".into()),
        engine_oil: Some("engine_5w30".into()),
        ..Options::default()
    };
    every_number(CARS[0], &fluid);
    let rows = "transmission.cvt.belt.thrust_ratio=[[0.4, 1.2], [1, 1.1], [2.5, 0.9]]";
    let words = [
        "transmission.cvt.clamp=slip_limited",
        "transmission.cvt.pump.kind=dual_cavity",
        "road_load.surface=road",
        rows,
    ];
    every_number(CARS[0], &options(&words));
    let (count, accepted) = every_number(
        CARS[1],
        &options(&["engine.model.bsfc_map.file=si_1900_bsfc"]),
    );
    assert!(accepted * 100 >= count * 95);
}

/// Keys of the shipped CVT with a default in the program.
const WITH_DEFAULT: [&str; 22] = [
    "payload_kg",
    "rotating_factor",
    "altitude_m",
    "rolling_per_k",
    "inertia_torque_nm",
    "overrun_factor",
    "belt_heat_share",
    "piston_outer_mm",
    "band_count",
    "unity_width",
    "blend_n",
    "slip_bound_percent",
    "initial_gap_mm",
    "radius_exponent",
    "route_efficiency",
    "residual_bar",
    "lubrication_l_min",
    "leakage_l_min_per_bar",
    "creep_nm",
    "under_bonnet_rise",
    "exchanger_opens_degc",
    "fall_per_1000_rpm",
];

/// Shipped CVT with some lines changed or removed, as a file.
fn edited(folder: &tempfile::TempDir, edit: impl Fn(&str) -> Option<String>) -> String {
    let shipped = std::fs::read_to_string(format!(
        "{}/vehicles/{}.toml",
        env!("CARGO_MANIFEST_DIR"),
        CARS[0]
    ))
    .unwrap();
    let file = folder.path().join("car.toml");
    let text: Vec<String> = shipped.lines().filter_map(edit).collect();
    std::fs::write(&file, text.join("\n")).unwrap();
    file.to_str().unwrap().to_owned()
}

fn name_of(line: &str) -> &str {
    line.split(" = ").next().unwrap_or_default()
}

#[test]
fn numbers_that_the_file_leaves_out() {
    let folder = tempfile::tempdir().unwrap();
    let word = edited(&folder, |line| {
        (!WITH_DEFAULT.contains(&name_of(line))).then(|| line.to_owned())
    });
    let setup = params(&word, &Options::default()).setup();
    let defaults: BTreeSet<&str> = setup
        .keys
        .iter()
        .filter(|info| info.status == "default")
        .map(|info| info.key.as_str())
        .collect();
    for name in WITH_DEFAULT {
        assert!(defaults.iter().any(|key| key.ends_with(name)), "{name}");
    }
    every_number(&word, &Options::default());
}

/// A table for an option may be missing, or replaced by a word; a number of the option then creates the table.
#[test]
fn numbers_of_options_given_as_a_word_or_missing() {
    let folder = tempfile::tempdir().unwrap();
    let launch = ["engage_rpm", "gain_nm_per_rpm2", "creep_nm", "release_rpm"];
    let word = edited(&folder, |line| match line {
        "[transmission.cvt.launch.friction_clutch]" | "[transmission.cvt.pump.kind.fixed]" => None,
        "[transmission.cvt.pump]" => Some(format!(
            "{line}\nkind = {{ value = \"variable\", status = \"assumed\" }}"
        )),
        _ => (!launch.contains(&name_of(line))).then(|| line.to_owned()),
    });
    let base = params(&word, &Options::default());
    let unchanged = built(&base, &[]);
    let (gain, share) = (
        "transmission.cvt.launch.friction_clutch.gain_nm_per_rpm2",
        "transmission.cvt.pump.kind.variable.least_share",
    );
    assert_eq!(param(&base, share).base().to_string(), "0.25");
    assert!(same(
        &word,
        &Options::default(),
        &base,
        &[(gain, 4e-5), (share, 0.4)]
    ));
    assert!(same(
        &word,
        &Options::default(),
        &base,
        &[("transmission.cvt.pump.kind.dual_cavity.share", 0.3)]
    ));
    let both = [
        (share, 0.4),
        ("transmission.cvt.pump.kind.dual_cavity.share", 0.3),
    ];
    assert!(!same(&word, &Options::default(), &base, &both));
    assert_eq!(built(&base, &[]), unchanged);
}

/// A number selects the option to which it belongs, as on the command line, and leaves no unread key.
#[test]
fn numbers_of_options_that_the_file_does_not_choose() {
    let base = params(CARS[0], &Options::default());
    let setup = base.setup();
    let none = Options::default();
    let share = param(&base, "transmission.cvt.pump.kind.dual_cavity.share");
    assert_eq!(
        (share.base().to_string(), share.unit(), share.allowed()),
        ("0.5".to_owned(), "-", "0.05 to 1")
    );
    let (cd, area, rolling) = (
        "road_load.form.body.drag_coefficient",
        "road_load.form.body.frontal_area_m2",
        "road_load.form.body.rolling_coefficient",
    );
    assert!(param(&base, cd).base().is_nan(), "no default");
    assert_eq!(param(&base, area).unit(), "m²");
    let good: [&[(&str, f64)]; 4] = [
        &[("transmission.cvt.pump.kind.dual_cavity.share", 0.6)],
        &[
            ("transmission.cvt.clamp.torque_following.safety_factor", 1.5),
            (
                "transmission.cvt.clamp.torque_following.least_torque_nm",
                30.0,
            ),
        ],
        &[(cd, 0.3), (area, 2.0), (rolling, 0.01)],
        &[
            ("transmission.cvt.clamp.map.base_bar", 30.0),
            ("lubricant.kv40_mm2_s", 34.0),
            ("engine_oil.kv100_mm2_s", 13.0),
        ],
    ];
    for numbers in good {
        assert!(same(CARS[0], &none, &base, numbers), "{numbers:?}");
        assert!(same(
            CARS[0],
            &none,
            &base,
            &numbers.iter().rev().copied().collect::<Vec<_>>()
        ));
    }
    // Missing parts of an option; mass_kg unused; two options at once.
    let bad: [&[(&str, f64)]; 4] = [
        &[(cd, 0.3)],
        &[("road_load.form.r83.reference_mass_kg", 1100.0)],
        &[
            ("transmission.cvt.clamp.slip_limited.slip_percent", 2.0),
            ("transmission.cvt.clamp.torque_following.safety_factor", 1.5),
        ],
        &[("engine.model.bsfc_map.l", 2.4)],
    ];
    for numbers in bad {
        assert!(!same(CARS[0], &none, &base, numbers), "{numbers:?}");
        // Repeated, and the same car twice: cached results of one car must not affect another.
        let more: Vec<(&str, f64)> = numbers
            .iter()
            .copied()
            .chain([(share.key(), 0.6)])
            .collect();
        for _ in 0..2 {
            assert!(!same(CARS[0], &none, &base, &more), "{numbers:?}");
        }
    }
    assert_eq!(built(&base, &[]), Ok(text(setup)));
}

/// Measured maps are read once: cars stay the same after the file is deleted.
#[test]
fn maps_are_read_once() {
    let folder = tempfile::tempdir().unwrap();
    let word = edited(&folder, |line| Some(line.to_owned()));
    let map = folder.path().join("pump.csv");
    std::fs::write(
        &map,
        "input_speed_rpm,oil_temp_degc,torque_loss_nm\n0,0,2\n7000,0,2.5\n0,90,1\n7000,90,1.5\n",
    )
    .unwrap();
    let options = options(&[
        "transmission.cvt.maps.pump=pump.csv",
        "engine.model.bsfc_map.file=si_1900_bsfc",
    ]);
    every_number(&word, &options);
    let base = params(&word, &options);
    let mass = [("road_load.mass_kg", 1200.0)];
    let want = ordinary(&word, &options, &mass);
    std::fs::remove_file(map).unwrap();
    assert!(ordinary(&word, &options, &mass).is_err());
    assert_eq!(built(&base, &mass), want);
}

fn is_shared<T: Send + Sync>(_: &T) {}

/// Problems without their place, which depends on the way.
fn words(problems: &Problems) -> Vec<[String; 3]> {
    let words = |problem: &Problem| {
        [&problem.message, &problem.allowed, &problem.hint].map(String::to_owned)
    };
    problems.iter().map(words).collect()
}

/// Property: each number of a car, set by a file that inherits the rest, by `--set` and by a set of values, gives the same car or the same
/// problem; by the latter two, and by a factor on the value, at the same place.
#[test]
fn every_way_to_set_a_number_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    for car in [CARS[0], CARS[1]] {
        let base = params(car, &Options::default());
        let file = folder.path().join(format!("{car}.toml"));
        let word = file.to_str().unwrap();
        let vehicle = |setup: Setup| format!("{:?}", setup.vehicle.into_car(AMBIENT_K));
        let mut refused = 0;
        for info in base.keys().iter().filter(|info| info.si.is_some()) {
            let of_fluid = ["lubricant.", "engine_oil."];
            if of_fluid.iter().any(|prefix| info.key.starts_with(prefix)) {
                continue;
            }
            let (table, name) = info.key.rsplit_once('.').unwrap();
            let own: f64 = info.value.parse().unwrap();
            for number in [changed(info, own), -1e7, 1e11] {
                let text = format!("[vehicle]\nlike = \"{car}\"\n[{table}]\n{name} = {number}\n");
                std::fs::write(&file, text).unwrap();
                let by_file = load(word, &Options::default());
                let by_override = load(car, &options(&[&format!("{}={number}", info.key)]));
                let by_set = base.with(&info.key, number).map(|set| set.setup());
                match (by_file, by_override, by_set) {
                    (Ok(file), Ok(set), Ok(with)) => {
                        assert_eq!(set.keys, with.keys, "{car} {} {number}", info.key);
                        let [file, set, with] = [file, set, with].map(vehicle);
                        assert!(file == set && set == with, "{car} {} {number}", info.key);
                    }
                    (Err(file), Err(set), Err(with)) => {
                        refused += 1;
                        assert_eq!(words(&file), words(&set), "{car} {} {number}", info.key);
                        assert_eq!(set, with, "{car} {} {number}", info.key);
                    }
                    other => panic!("{car} {} {number}: {other:?}", info.key),
                }
            }
            let by_factor = load(car, &options(&[&format!("{}*=1.01", info.key)]));
            match (by_factor, base.with(&info.key, own * 1.01)) {
                (Ok(factor), Ok(with)) => assert_eq!(vehicle(factor), vehicle(with.setup())),
                (Err(factor), Err(with)) => assert_eq!(words(&factor), words(&with)),
                other => panic!("{car} {}: {other:?}", info.key),
            }
        }
        assert!(refused > 150, "{car}: {refused}");
    }
}

/// Words and truth values, and a relation between two values, by `--set` and by a set.
#[test]
fn words_and_relations_have_the_problems_of_the_command_line() {
    let base = params(CARS[0], &Options::default());
    for (key, value) in [
        ("road_load.surface", "road"),
        ("road_load.surface", "rood"),
        ("transmission.cvt.pump.kind", "variable"),
        ("transmission.cvt.clamp", "slip_limited"),
        ("transmission.cvt.variator.compensated", "false"),
        ("transmission.cvt.variator.compensated", "maybe"),
        ("transmission.cvt.belt.length_m", "0,7"),
        ("transmission.manual.final_ratio", "4"),
        ("engine.full_load", "[[850, 100], [800, 90]]"),
        ("engine.idle.warm_degc", "20"),
        ("engine.idle.warm_degree", "20"),
        ("vehicle.title", "Other"),
        ("engine..idle", "1"),
    ] {
        let ordinary = Override::parse_all(&[format!("{key}={value}")]).and_then(|set| {
            let options = Options {
                set,
                ..Options::default()
            };
            load(CARS[0], &options)
        });
        let with = base.with(key, value).map(|set| set.setup());
        let parts = |setup: Setup| (setup.keys.clone(), text(setup));
        assert_eq!(with.map(parts), ordinary.map(parts), "{key}={value}");
    }
    let flag = base.with("transmission.cvt.variator.compensated", false);
    assert!(flag.is_ok());
}

/// Two threads drive the same cars with the same bits as one thread.
#[test]
fn threads_agree() {
    let base = params(CARS[0], &Options::default());
    is_shared(&base);
    let cycle = embedded("ece15").unwrap();
    let params = [
        "transmission.cvt.belt.band_offset_mm",
        "lubricant.kv40_mm2_s",
        "engine.rated_kw",
    ]
    .map(|key| param(&base, key));
    let drives = || {
        let run = |k: u32| {
            let factor = 1.0 + 0.01 * f64::from(k);
            let numbers = params.each_ref().map(|of| (of, of.base() * factor));
            let set = base.with_numbers(&numbers).unwrap();
            let conditions = Conditions {
                ambient_k: AMBIENT_K,
                start: Start::Soak,
                max_dt_s: 1.0,
                keep_rows: false,
            };
            format!("{:?}", drive(set.vehicle(), &cycle, &conditions).totals)
        };
        (0..6).map(run).collect::<Vec<String>>()
    };
    let (one, two) = std::thread::scope(|scope| {
        let other = scope.spawn(drives);
        (drives(), other.join().unwrap())
    });
    assert_eq!(one, two);
    let key = |k: usize, factor: f64| format!("{}={}", params[k].key(), params[k].base() * factor);
    let set = [key(0, 1.05), key(1, 1.05), key(2, 1.05)];
    let conditions = Conditions {
        ambient_k: AMBIENT_K,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    let setup = load(CARS[0], &options(&set.each_ref().map(String::as_str))).unwrap();
    assert_eq!(
        one[5],
        format!("{:?}", drive(&setup, &cycle, &conditions).totals)
    );
    assert_eq!(
        one.iter().collect::<BTreeSet<_>>().len(),
        6,
        "each car is another one"
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// Property: only the last set values count, whatever was set before.
    #[test]
    fn any_order_of_setting_and_taking_back(steps in prop::collection::vec((0..9_usize, 0.2..1.8_f64, any::<bool>()), 1..24)) {
        const KEYS: [&str; 9] = [
            "road_load.mass_kg",
            "transmission.cvt.variator.stop_from_ratio",
            "transmission.cvt.variator.stop_to_ratio",
            "transmission.cvt.belt.band_count",
            "lubricant.friction.band",
            "engine_oil.kv40_mm2_s",
            "transmission.cvt.pump.kind.dual_cavity.share",
            "transmission.cvt.clamp.torque_following.safety_factor",
            "transmission.cvt.clamp.map.base_bar",
        ];
        let base = params(CARS[0], &Options::default());
        let mut in_force: Vec<(&str, f64)> = Vec::new();
        let mut set = Some(base.clone());
        for (k, factor, restart) in steps {
            let own = param(&base, KEYS[k]).base();
            if restart && factor < 0.6 {
                in_force.clear();
                set = Some(base.clone());
            }
            let number = if k == 3 { (own * factor).round() } else { own * factor };
            set = set.and_then(|set| set.with(KEYS[k], number).ok());
            match in_force.iter_mut().find(|(key, _)| *key == KEYS[k]) {
                Some(entry) => entry.1 = number,
                None => in_force.push((KEYS[k], number)),
            }
        }
        let full = ordinary(CARS[0], &Options::default(), &in_force);
        prop_assert_eq!(&built(&base, &in_force), &full);
        if let Some(set) = set {
            prop_assert_eq!(Ok(text(Setup::from_params(&set))), full);
        }
    }
}
