//! Vehicle files from catalogue numbers. The truth is the arithmetic of each rule, worked out here, and the geometry of the belt in the model.

use cvtcycle_config::setup::new_car::{
    Answers, ClassOf, NewCar, named_engines, technologies, write,
};
use cvtcycle_config::setup::{Kind, Options, Setup, load};
use cvtcycle_config::{KeyInfo, Problems};
use cvtcycle_model::keys::rad_s;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::variator::Geometry;

const ENGINE: [(&str, &str); 2] = [("displacement", "1.8l"), ("power", "104kW@6400")];

fn new(class: &str, gearbox: &str, numbers: &[(&'static str, &str)]) -> Result<NewCar, Problems> {
    let numbers = ENGINE.iter().chain(numbers);
    write(&Answers {
        file: "mycar.toml".to_owned(),
        title: "My car".to_owned(),
        class: Some(class.to_owned()),
        gearbox: Some(gearbox.to_owned()),
        numbers: numbers
            .map(|(name, text)| (*name, (*text).to_owned()))
            .collect(),
        ..Answers::default()
    })
}

fn cvt(numbers: &[(&'static str, &str)]) -> Setup {
    new("compact_2020", "box_cvt_clutch", numbers)
        .unwrap()
        .setup
}

fn find<'s>(setup: &'s Setup, key: &str) -> &'s KeyInfo {
    let found = setup.keys.iter().find(|info| info.key == key);
    found.unwrap_or_else(|| panic!("{key}"))
}

fn number(setup: &Setup, key: &str) -> f64 {
    find(setup, key).value.parse().unwrap()
}

#[test]
fn every_class_makes_a_car_that_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mycar.toml");
    for class in ClassOf::Body.names() {
        for gearbox in ClassOf::Box.names() {
            let car = new(class, gearbox, &[])
                .unwrap_or_else(|found| panic!("{class} {gearbox}: {found:?}"));
            std::fs::write(&path, &car.text).unwrap();
            let again = load(path.to_str().unwrap(), &Options::default()).unwrap();
            assert_eq!(again.keys, car.setup.keys, "{class} {gearbox}");
            assert_eq!(again.baselines.is_empty(), !again.transmission().is_cvt());
            let doubts = car.setup.doubts();
            assert!(doubts.is_empty(), "{class} {gearbox}: {doubts:?}");
        }
    }
}

#[test]
fn what_is_given_is_the_user_s_and_the_rest_of_a_class() {
    let numbers = [
        ("mass", "2910lb"),
        ("f0", "17.45lbf"),
        ("f1", "0.1608lbf"),
        ("f2", "0.01586lbf"),
        ("idle", "650"),
    ];
    let setup = cvt(&numbers);
    let mass = find(&setup, "road_load.mass_kg");
    assert_eq!(
        (mass.status.as_str(), mass.source.as_str()),
        ("user", "given: 2910lb")
    );
    // By the definitions of pound, pound-force and mile.
    for (key, value) in [
        ("road_load.mass_kg", 2910.0 * 0.453_592_37),
        ("road_load.form.coefficients.f0_n", 77.621),
        ("road_load.form.coefficients.f1_n_per_kmh", 0.444_45),
        ("road_load.form.coefficients.f2_n_per_kmh2", 0.027_239),
        ("engine.idle.hot_rpm", 650.0),
        ("engine.displacement_cc", 1800.0),
        ("engine.rated_kw", 104.0),
    ] {
        let got = number(&setup, key);
        assert!((got / value - 1.0).abs() < 1e-4, "{key}: {got}");
    }
    for info in setup
        .keys
        .iter()
        .filter(|info| !info.key.starts_with("lubricant.") && !info.key.starts_with("engine_oil."))
    {
        let status = info.status.as_str();
        assert!(
            [
                "user", "derived", "assumed", "class", "choice", "default", ""
            ]
            .contains(&status),
            "{info:?}"
        );
    }
}

#[test]
fn the_rules_are_their_arithmetic() {
    let setup = cvt(&[("tyre", "215/55 R16")]);
    // NC-1: (16 in + 2 x 215 x 0.55) x 3.05 / 2 pi
    let diameter = 16.0 * 25.4 + 2.0 * 215.0 * 0.55;
    let radius = diameter * 3.05 / std::f64::consts::TAU / 1e3;
    assert!((number(&setup, "road_load.wheel_radius_m") - radius).abs() < 6e-5);
    assert_eq!(find(&setup, "road_load.wheel_radius_m").status, "derived");
    // NC-3 and NC-9 of 1.8 l: four cylinders of 450 cm3 with bore = stroke.
    assert!((number(&setup, "engine.inertia_kg_m2") - 0.23).abs() < 1e-9);
    let stroke = number(&setup, "engine.stroke_mm") / 10.0;
    assert!((std::f64::consts::FRAC_PI_4 * stroke.powi(3) / 450.0 - 1.0).abs() < 2e-3);
    // Truth: strokes of sold engines of those sizes. Suzuki R06A and K10B, Toyota 1NZ and 2AR, Nissan VQ35, GM L84.
    for (litres, sold_mm) in [
        ("0.658l", 68.2),
        ("0.998l", 79.5),
        ("1.497l", 84.7),
        ("2.494l", 98.0),
        ("3.498l", 81.4),
        ("5.328l", 92.0),
    ] {
        let stroke_mm = number(&cvt(&[("displacement", litres)]), "engine.stroke_mm");
        assert!(
            (stroke_mm / sold_mm - 1.0).abs() < 0.12,
            "{litres}: {stroke_mm}"
        );
    }
}

/// The shipped Rover's line, which is the CO2MPAS shape through 145 Nm at 3000 rpm and 82 kW at 6000 rpm.
#[test]
fn full_load_meets_the_shape_that_it_was_fitted_to() {
    let rover = load("rover_216_cvt", &Options::default()).unwrap();
    let numbers = [
        ("idle", "850"),
        ("torque", "145@3000"),
        ("power", "82kW@6000"),
        ("displacement", "1588"),
        ("highest", "6500"),
    ];
    let own = cvt(&numbers);
    for rpm in [1000.0, 1500.0, 2000.0, 3000.0, 4000.0, 5000.0, 6000.0] {
        let at = rpm * std::f64::consts::PI / 30.0;
        let [own, shipped] = [&own, &rover].map(|car| car.engine().full_load.at(at));
        assert!(
            (own - shipped).abs() < 5.0,
            "{rpm} rpm: {own} and {shipped} Nm"
        );
    }
}

#[test]
fn the_belt_runs_at_thirty_millimetres_in_low() {
    for (low, centre) in [("2.526", "172"), ("2.2", "160")] {
        let setup = cvt(&[
            ("ratio-low", low),
            ("ratio-high", "0.42"),
            ("centre-distance", centre),
        ]);
        let Transmission::Cvt(cvt) = setup.transmission() else {
            unreachable!("a CVT")
        };
        let at_low = Geometry::new(cvt.ratio.low, cvt.belt.centre_distance_m, cvt.belt.length_m);
        assert!((at_low.primary_radius_m - 0.030).abs() < 5e-5, "{at_low:?}");
    }
    let setup = cvt(&[("span", "6"), ("ratio-high", "0.4")]);
    assert!((number(&setup, "transmission.cvt.ratio.low") - 2.4).abs() < 1e-9);
}

#[test]
fn a_manual_box_has_its_gears() {
    let numbers = [
        ("gears", "3.642,2.08,1.361,1.023,0.829,0.686"),
        ("final-drive", "4.105"),
        ("wheel-radius", "309.5"),
    ];
    let car = new("compact_2020", "box_manual_6", &numbers).unwrap();
    let Transmission::Manual(manual) = car.setup.transmission() else {
        unreachable!("a manual box")
    };
    assert_eq!(manual.overall.len(), 6);
    assert!((manual.overall[0] - 3.642 * 4.105).abs() < 1e-3);
    assert!(car.text.contains("TW-3") && !car.text.contains("baselines"));
}

/// NC-11 to NC-15: the arithmetic of the rules, a box that grips what the engine gives, and no doubt about any of them.
#[test]
fn a_box_of_a_class_fits_its_engine() {
    for (gearbox, stall_rpm) in [("box_cvt_converter", 2400.0), ("box_cvt_clutch", 2500.0)] {
        for kw in [36.0, 55.0, 75.0, 104.0, 150.0, 200.0] {
            let power = format!("{kw}kW@6200");
            let litres = format!("{}l", kw / 60.0);
            let numbers = [("power", power.as_str()), ("displacement", litres.as_str())];
            let setup = new("compact_2020", gearbox, &numbers).unwrap().setup;
            let engine = setup.engine();
            let highest_nm = engine
                .full_load
                .points()
                .map(|(_, nm)| nm)
                .fold(0.0, f64::max);
            let pump_cc = number(&setup, "transmission.cvt.pump.displacement_cc_rev");
            assert!(
                (pump_cc - (8.0 * highest_nm / 130.0).max(6.0)).abs() < 0.06,
                "{pump_cc}"
            );
            // Full load holds the engine at the speed of the rule.
            let nm = engine.full_load.at(rad_s(stall_rpm));
            let held_nm = if gearbox == "box_cvt_converter" {
                let capacity = number(
                    &setup,
                    "transmission.cvt.launch.torque_converter.capacity_nm",
                );
                capacity * (stall_rpm / 1e3).powi(2)
            } else {
                let key = |name: &str| {
                    number(
                        &setup,
                        &format!("transmission.cvt.launch.friction_clutch.{name}"),
                    )
                };
                key("gain_nm_per_rpm2") * (stall_rpm - key("engage_rpm")).powi(2)
            };
            assert!((held_nm / nm - 1.0).abs() < 2e-3, "{held_nm} of {nm}");
            assert_eq!(setup.doubts(), Vec::<String>::new(), "{gearbox} {kw} kW");
        }
    }
    let own = cvt(&[("pump", "9.5cc/rev")]);
    let pump = find(&own, "transmission.cvt.pump.displacement_cc_rev");
    assert_eq!((pump.value.as_str(), pump.status.as_str()), ("9.5", "user"));
}

/// NC-16: the speed that the number says, whatever the tyre, the box and its gears; with a final drive it is refused.
#[test]
fn engine_over_road_speed_is_the_reduction() {
    let gears = ("gears", "3.6,2.1,1.4,1.0,0.8");
    for (gearbox, numbers) in [
        ("box_cvt_converter", vec![("n-over-v", "26.4rpm/mph")]),
        (
            "box_cvt_clutch",
            vec![("n-over-v", "16.404"), ("ratio-high", "0.45")],
        ),
        (
            "box_cvt_clutch",
            vec![("n-over-v", "16.404rpm/(km/h)"), ("tyre", "185/65 R15")],
        ),
        ("box_manual_5", vec![("n-over-v", "26.4 rpm/mph")]),
        ("box_manual_5", vec![("n-over-v", "26.4rpm/mph"), gears]),
    ] {
        let setup = new("compact_2020", gearbox, &numbers).unwrap().setup;
        let overall = match setup.transmission() {
            Transmission::Cvt(cvt) => cvt.ratio.high * cvt.final_drive.ratio,
            Transmission::Manual(manual) => *manual.overall.last().unwrap(),
        };
        let at_100 = overall * (100.0 / 3.6) / setup.road_load.base.wheel_radius_m;
        // 26.4 rpm per mph by the mile of 1.609344 km.
        assert!(
            (at_100 / rad_s(26.4 / 1.609_344 * 100.0) - 1.0).abs() < 5e-4,
            "{gearbox} {numbers:?}"
        );
        let both = [numbers.as_slice(), &[("final-drive", "4.1")]].concat();
        let refused = new("compact_2020", gearbox, &both).unwrap_err();
        assert!(refused.iter().any(|problem| problem.key == "n-over-v"));
    }
    assert!(new("compact_2020", "box_cvt_clutch", &[("n-over-v", "0")]).is_err());
    // NC-17 at 80 km/h: 0.8 of 26.4/1.609344 x 80 = 1312.3 rpm.
    let setup = cvt(&[("n-over-v", "26.4rpm/mph")]);
    let gentle_rpm = number(&setup, "transmission.cvt.ratio.gentle_rpm");
    assert!((gentle_rpm - 1050.0).abs() < 1e-9, "{gentle_rpm}");
}

/// NC-16: another final drive without gears multiplies all overall ratios by new over old.
#[test]
fn a_final_drive_acts_on_the_gears_of_the_class() {
    let of = |numbers: &[(&'static str, &str)]| {
        new("compact_2020", "box_manual_6", numbers).unwrap().setup
    };
    let (usual, own) = (of(&[]), of(&[("final-drive", "5")]));
    let factor = 5.0 / number(&usual, "transmission.manual.final_ratio");
    let (Transmission::Manual(usual), Transmission::Manual(own)) =
        (usual.transmission(), own.transmission())
    else {
        unreachable!("manual boxes")
    };
    for (before, after) in usual.overall.iter().zip(&own.overall) {
        assert!(
            (after / before / factor - 1.0).abs() < 1e-3,
            "{before} {after}"
        );
    }
}

#[test]
fn all_that_is_missing_or_wrong_is_said_at_once() {
    let keys = |found: Problems| {
        found
            .iter()
            .map(|problem| problem.key.clone())
            .collect::<Vec<_>>()
    };
    let none = write(&Answers {
        file: "a.toml".to_owned(),
        ..Answers::default()
    });
    assert_eq!(keys(none.unwrap_err()), ["displacement", "power"]);
    for (name, text) in [
        ("mass", "heavy"),
        ("mass", "1320 stone"),
        ("f0", "17,4"),
        ("tyre", "55/215 R16"),
        ("power", "158hp@6500@7000"),
        ("power", "104hp@-5"),
        ("power", "104kW@0"),
        ("torque", "172@4400-3800"),
        ("torque", "100@4000"),
        ("span", "6"),
        ("gears", "3,2,1"),
        ("ratio-low", "2.5x"),
    ] {
        let found = new("compact_2020", "box_cvt_clutch", &[(name, text)]);
        let found = found.err().unwrap_or_else(|| panic!("{name} {text}"));
        let expected = if name == "torque" && text.starts_with("100") {
            "power"
        } else {
            name
        };
        assert_eq!(keys(found.clone()), [expected], "{name} {text}: {found:?}");
        assert!(
            !found[0].allowed.is_empty() || !found[0].hint.is_empty(),
            "{found:?}"
        );
    }
    let manual = new(
        "compact_2020",
        "box_manual_6",
        &[("pump", "8"), ("span", "6"), ("gears", "1,2")],
    );
    assert_eq!(keys(manual.unwrap_err()), ["span", "pump", "gears"]);
    assert!(new("box_manual_6", "compact_2020", &[]).is_err());
}

#[test]
fn numbers_in_the_wrong_unit_are_doubted() {
    let doubts = |numbers: &[(&'static str, &str)]| {
        let car = new("compact_2020", "box_cvt_clutch", numbers).unwrap();
        car.setup.doubts()
    };
    for (numbers, words) in [
        (
            &[("f0", "17.45"), ("f1", "0.1608"), ("f2", "0.01586")][..],
            "lbf?",
        ),
        (&[("mass", "3000")], "the mass is 3000 kg: is it in lb?"),
        (&[("displacement", "500")], "208 kW per litre"),
        // Low and high confused: 2.53 over 2.48.
        (&[("ratio-high", "2.48")], "a span of 1.02"),
    ] {
        let found = doubts(numbers);
        let is_said = found.iter().any(|doubt| doubt.contains(words));
        assert!(is_said && found.len() <= 2, "{words}: {found:?}");
    }
}

/// One function doubts whatever is read: the cars that are shipped and every car of a class give it no reason
/// (`every_class_makes_a_car_that_is_read_again`), a change of one value does.
#[test]
fn a_car_that_is_read_is_doubted_as_a_new_one() {
    for name in Kind::Vehicle.names() {
        let doubts = load(name, &Options::default()).unwrap().doubts();
        assert!(doubts.is_empty(), "{name}: {doubts:?}");
    }
    // The Rover's engine has its fuel cut above 1400 rpm and none below 1300 rpm, and 82 kW.
    for (change, words) in [
        ("transmission.cvt.ratio.overrun_rpm=1100", "it is never cut"),
        (
            "transmission.cvt.ratio.overrun_rpm=1350",
            "it is only in part cut",
        ),
        (
            "engine.rated_kw=110",
            "full load has 82 kW at 6000 rpm, the rated power is 110 kW",
        ),
        ("engine.rated_kw=60", "the rated power is 60 kW"),
        ("road_load.mass_kg=2491", "the mass is 2491"),
    ] {
        let options = Options {
            set: vec![change.parse().unwrap()],
            ..Options::default()
        };
        let doubts = load("rover_216_cvt", &options).unwrap().doubts();
        let is_doubted = change != "road_load.mass_kg=2491";
        let is_said = doubts.iter().any(|doubt| doubt.contains(words));
        assert_eq!(is_said, is_doubted, "{change}: {doubts:?}");
    }
}

/// A power without a unit may be kW, hp or PS; a torque has no more power at its own speed than the rated one.
#[test]
fn power_has_its_unit_and_is_the_most_that_the_torque_gives() {
    let refused = |numbers: &[(&'static str, &str)]| {
        let found = new("compact_2020", "box_cvt_clutch", numbers);
        found.err().unwrap_or_else(|| panic!("{numbers:?}"))[0].clone()
    };
    let bare = refused(&[("power", "140@6400")]);
    assert_eq!(
        (bare.key.as_str(), bare.message.as_str()),
        ("power", "the number has no unit")
    );
    assert!(bare.hint.contains("140hp@6400"), "{bare:?}");
    // 300 Nm at 4400 rpm are 138.2 kW, 132 hp 98.4 kW.
    let strong = refused(&[("power", "132hp@6000"), ("torque", "300@4400")]);
    let words = "300 Nm at 4400 rpm are 138 kW, more than the rated power of 98 kW";
    assert_eq!(
        (strong.key.as_str(), strong.message.as_str()),
        ("power", words)
    );
    // 215 Nm at 4400 rpm are 99.1 kW, within rounding.
    let numbers = [("power", "132hp@6000"), ("torque", "215@4400")];
    assert!(new("compact_2020", "box_cvt_clutch", &numbers).is_ok());
}

/// NC-10: an engine of the 1990s has its fuel cut above 1400 rpm, where the class of the box expects 1000.
#[test]
fn a_box_keeps_an_engine_that_cuts_late_above_its_cut() {
    for (class, rpm, status) in [
        ("compact_1995", 1500.0, "derived"),
        ("compact_2020", 1100.0, "class"),
    ] {
        let setup = new(class, "box_cvt_converter", &[]).unwrap().setup;
        let key = "transmission.cvt.ratio.overrun_rpm";
        assert!((number(&setup, key) - rpm).abs() < 1e-9, "{class}");
        assert_eq!(find(&setup, key).status, status, "{class}");
    }
}

/// NC-2 above the speed of rated power: the rated power is the greatest one, so the line of a flat torque is no doubt of its own.
#[test]
fn no_more_power_above_the_speed_of_rated_power() {
    let numbers = [
        ("displacement", "1.49l"),
        ("power", "54kW@4800"),
        ("torque", "111@3600"),
    ];
    let setup = cvt(&numbers);
    let points = setup.engine().full_load.points();
    let (most_kw, at_rad_s) =
        points
            .map(|(rad_s, nm)| (rad_s * nm / 1e3, rad_s))
            .fold(
                (0.0, 0.0),
                |most, here| if here.0 > most.0 { here } else { most },
            );
    // Torque is written to 0.1 Nm.
    assert!((most_kw - 54.0).abs() < 0.05e-3 * at_rad_s, "{most_kw}");
    assert!((at_rad_s - rad_s(4800.0)).abs() < 1e-9, "{at_rad_s}");
    assert_eq!(setup.doubts(), Vec::<String>::new());
}

/// NC-2 of charged engines: between the plateau and the speed of rated power there is no more power than at its ends, and the line goes through both.
#[test]
fn the_full_load_line_holds_the_rated_power() {
    for (displacement, torque, power, nm, [from, to], kw, rated_rpm) in [
        (
            "1.0l",
            "200@1400-4500",
            "92kW@6000",
            200.0,
            [1400.0, 4500.0],
            92.0,
            6000.0,
        ),
        (
            "1.5l",
            "250@1500-3500",
            "110kW@6000",
            250.0,
            [1500.0, 3500.0],
            110.0,
            6000.0,
        ),
        (
            "1.8l",
            "172@4000",
            "104kW@6400",
            172.0,
            [4000.0, 4000.0],
            104.0,
            6400.0,
        ),
    ] {
        let numbers = [
            ("displacement", displacement),
            ("torque", torque),
            ("power", power),
        ];
        let car = new("compact_2020", "box_cvt_clutch", &numbers).unwrap();
        let line = &car.setup.engine().full_load;
        let kw_at = |at_rpm: f64| line.at(rad_s(at_rpm)) * rad_s(at_rpm) / 1e3;
        for at in [from, to] {
            assert!((line.at(rad_s(at)) - nm).abs() < 0.06, "{torque} at {at}");
        }
        assert!((kw_at(rated_rpm) / kw - 1.0).abs() < 1e-3);
        let most = kw.max(kw_at(to));
        let mut before = f64::INFINITY;
        for k in 0..200 {
            let at = to + (rated_rpm - to) * f64::from(k) / 200.0;
            assert!(
                kw_at(at) < 1.002 * most,
                "{torque}: {} kW at {at}",
                kw_at(at)
            );
            let now = line.at(rad_s(at));
            assert!(now <= before + 1e-9, "{torque}: rises at {at}");
            before = now;
        }
        let doubts = car.setup.doubts();
        assert!(
            !doubts.iter().any(|doubt| doubt.contains("rated")),
            "{doubts:?}"
        );
    }
}

/// A torque without a unit that is too small for the power in N m, and fits it in lb ft.
#[test]
fn a_torque_in_lb_ft_is_recognised() {
    let refused = |torque: &str| {
        let numbers = [
            ("displacement", "2.0l"),
            ("power", "118kW@6500"),
            ("torque", torque),
        ];
        let found = new("compact_2020", "box_cvt_clutch", &numbers);
        found.err().unwrap_or_else(|| panic!("{torque}"))[0]
            .hint
            .clone()
    };
    assert_eq!(
        refused("138@4200"),
        "is the torque in lb ft? then write 138lbft@4200"
    );
    assert!(refused("138Nm@4200").starts_with("check both"));
    assert!(refused("20@4200").starts_with("check both"));
}

/// Values of a car that look like slips, each by one change.
#[test]
fn slips_across_keys_are_doubted() {
    let doubts = |body: &str, gearbox: &str, numbers: &[(&'static str, &str)]| {
        new(body, gearbox, numbers).unwrap().setup.doubts()
    };
    let diesel: &[(&'static str, &str)] = &[
        ("displacement", "2.0l"),
        ("torque", "340@1750-2500"),
        ("power", "110kW@3800"),
    ];
    for (numbers, words) in [
        (diesel, "are those of a diesel"),
        (diesel, "full load is 21.4 bar"),
        (&[("mass", "2400")], "is the mass in lb?"),
        (&[("f2", "0.3")], "N per kg"),
        (&[("idle", "400")], "idles at 400 rpm"),
        (&[("wheel-radius", "600")], "roll on 600 mm"),
        (
            &[("final-drive", "1.5")],
            "an axle ratio is often not the whole",
        ),
        (&[("final-drive", "15")], "in the highest gear"),
        (&[("pump", "3")], "the pump is too small"),
    ] {
        let found = doubts("compact_2020", "box_cvt_clutch", numbers);
        assert!(
            found.iter().any(|doubt| doubt.contains(words)),
            "{words}: {found:?}"
        );
        assert!(
            !found.iter().any(|doubt| doubt.contains("lbf?")),
            "{found:?}"
        );
    }
    let changed = |name: &str, change: &str| {
        let options = Options {
            set: vec![change.parse().unwrap()],
            ..Options::default()
        };
        load(name, &options).unwrap().doubts()
    };
    for (name, change, words) in [
        (
            "civic_20_cvt",
            "transmission.cvt.pressure.cap_bar=8",
            "the belt slips at full load",
        ),
        (
            "rover_216_cvt",
            "transmission.cvt.belt.length_m=0.575",
            "runs down to a radius",
        ),
        (
            "rover_216_5mt",
            "road_load.wheel_radius_m=0.2",
            "roll on 200 mm",
        ),
    ] {
        let found = changed(name, change);
        assert!(
            found.iter().any(|doubt| doubt.contains(words)),
            "{words}: {found:?}"
        );
    }
}

/// A car of a class with an engine, by its options.
fn engine(options: [&str; 3], numbers: &[(&'static str, &str)]) -> Result<NewCar, Problems> {
    let given = |text: &str| (!text.is_empty()).then(|| text.to_owned());
    let [engine, year, like] = options.map(given);
    write(&Answers {
        file: "mycar.toml".to_owned(),
        title: "My car".to_owned(),
        engine,
        engine_year: year,
        engine_like: like,
        numbers: numbers
            .iter()
            .map(|(name, text)| (*name, (*text).to_owned()))
            .collect(),
        ..Answers::default()
    })
}

/// The newest set of a technology that is not newer than the year; body, engine, box in this order.
#[test]
fn an_engine_is_of_its_technology_and_year() {
    for (technology, year, class, notes) in [
        ("pfi", "2018", "engine_pfi_2013", 0),
        ("pfi", "2012", "engine_pfi_2010", 0),
        ("pfi", "1990", "engine_pfi_1990", 0),
        ("pfi", "1985", "engine_pfi_1990", 1),
        ("pfi", "", "engine_pfi_2013", 1),
        ("di", "2018", "engine_di_2012", 0),
        ("di", "2005", "engine_di_2012", 1),
        (
            "di_high_compression",
            "2015",
            "engine_di_high_compression_2012",
            0,
        ),
        ("turbo", "2014", "engine_turbo_2010", 0),
        ("turbo", "2015", "engine_turbo_2015", 0),
        ("atkinson", "2020", "engine_atkinson_2017", 0),
        ("diesel", "2015", "engine_diesel_2015", 0),
        ("turbo", "2025", "engine_turbo_2015", 0),
        ("turbo", "2026", "engine_turbo_2015", 1),
        ("di", "2030", "engine_di_2012", 1),
    ] {
        let car = engine([technology, year, ""], &ENGINE).unwrap();
        let like =
            format!("like = [\"class:compact_2020\", \"class:{class}\", \"class:box_cvt_clutch\"]");
        assert!(
            car.text.contains(&like),
            "{technology} {year}: {}",
            car.text
        );
        assert_eq!(
            car.notes.len(),
            notes,
            "{technology} {year}: {:?}",
            car.notes
        );
        assert!(
            find(&car.setup, "engine.model.willans.l")
                .from
                .contains(class)
        );
    }
    // With another car, its engine alone is replaced.
    let car = write(&Answers {
        file: "mycar.toml".to_owned(),
        like: Some("rover_216_cvt".to_owned()),
        engine: Some("pfi".to_owned()),
        engine_year: Some("2010".to_owned()),
        ..Answers::default()
    });
    let car = car.unwrap();
    assert!(
        car.text
            .contains("like = [\"rover_216_cvt\", \"class:engine_pfi_2010\"]")
    );
    assert!(car.setup.engine().motored.is_some());
    assert_eq!(
        technologies(),
        [
            "pfi",
            "di",
            "di_high_compression",
            "atkinson",
            "turbo",
            "diesel"
        ]
    );
}

/// A measured engine alone is whole; with a power its line is scaled, with a size its map goes by litre (NC-11).
#[test]
fn a_measured_engine_has_its_own_line() {
    for name in named_engines() {
        let car = engine(["", "", name], &[]).unwrap().setup;
        let class = format!("class engine_{name}");
        assert_eq!(find(&car, "engine.full_load").from, class);
        assert_eq!(find(&car, "engine.displacement_cc").from, class);
    }
    let own = engine(["", "", "honda_l15b7"], &[]).unwrap().setup;
    let numbers = [("displacement", "2.0l"), ("power", "150kW@6500")];
    let scaled = engine(["", "", "honda_l15b7"], &numbers).unwrap().setup;
    let line = |car: &Setup, rpm: f64| car.engine().full_load.at(rad_s(rpm));
    // 130.0 kW at 6000 rpm: speeds times 6500/6000, torques so that 150 kW are there.
    assert!((line(&scaled, 6500.0) * rad_s(6500.0) / 150e3 - 1.0).abs() < 1e-3);
    for rpm in [1500.0, 2500.0, 4000.0] {
        let ratio = line(&scaled, rpm * 6.5 / 6.0) / line(&own, rpm);
        assert!(
            (ratio - 150.0 / 130.0 * 6.0 / 6.5).abs() < 2e-3,
            "{rpm}: {ratio}"
        );
    }
    let stroke_mm = 89.4 * (2000.0_f64 / 1496.0).cbrt();
    assert!((number(&scaled, "engine.stroke_mm") - stroke_mm).abs() < 0.06);
    // A torque is the user's: NC-2 as with any engine.
    let numbers = [("power", "130kW@6000"), ("torque", "240@2000-4500")];
    let nc2 = engine(["", "", "honda_l15b7"], &numbers).unwrap().setup;
    assert!((line(&nc2, 3000.0) - 240.0).abs() < 0.06);
    assert!(find(&nc2, "engine.full_load").source.contains("NC-2"));
}

#[test]
fn engines_that_are_none_are_refused() {
    for (options, numbers, key, words) in [
        (["steam", "", ""], &ENGINE[..], "engine", "pfi, di, "),
        (["di", "20l8", ""], &ENGINE, "engine-year", "1980 to 2030"),
        (["di", "1950", ""], &ENGINE, "engine-year", "1980 to 2030"),
        (["di", "2031", ""], &ENGINE, "engine-year", "1980 to 2030"),
        (["", "2015", ""], &ENGINE, "engine-year", "pfi, di, "),
        (["di", "", "gm_lv3"], &ENGINE, "engine-like", ""),
        (
            ["", "", "honda_l15b"],
            &ENGINE,
            "engine-like",
            "honda_l15b7",
        ),
        // In another size it needs another power.
        (
            ["", "", "honda_l15b7"],
            &[("displacement", "2.0l")],
            "power",
            "",
        ),
    ] {
        let found = engine(options, numbers).unwrap_err();
        assert_eq!(found.len(), 1, "{options:?}: {found:?}");
        assert_eq!(found[0].key, key, "{options:?}");
        assert!(found[0].allowed.contains(words), "{found:?}");
        assert!(!found[0].hint.is_empty(), "{found:?}");
    }
    let near = engine(["", "", "honda_l15b"], &ENGINE).unwrap_err();
    assert_eq!(near[0].hint, "did you mean `honda_l15b7`?");
    // Engines are no bodies and no boxes.
    assert!(new("engine_di_2012", "box_cvt_clutch", &[]).is_err());
    assert!(new("compact_2020", "engine_di_2012", &[]).is_err());
}

/// The three words in the file of answers, with the year as a number.
#[test]
fn answers_name_an_engine() {
    let mut answers = Answers {
        file: "mycar.toml".to_owned(),
        ..Answers::default()
    };
    let text =
        "engine = \"turbo\"\nengine_year = 2012\ndisplacement = \"1.6l\"\npower = \"120kW\"\n";
    answers.add_file("answers.toml", text).unwrap();
    assert!(
        write(&answers)
            .unwrap()
            .text
            .contains("class:engine_turbo_2010")
    );
    let mut answers = Answers::default();
    answers
        .add_file("answers.toml", "engine_like = \"gm_lv3\"\n")
        .unwrap();
    assert!(
        write(&answers)
            .unwrap()
            .text
            .contains("class:engine_gm_lv3")
    );
}
