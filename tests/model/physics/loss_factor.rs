//! Factors on losses: without a loss, with all of it, and with any part of it (CV-7, MB-6, LC-6).

use cvtcycle_config::cycle::read_csv;
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_config::{Override, render};
use cvtcycle_model::drive::{Conditions, Row, Start, drive};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::variator::{BeltAtRatio, BeltLoad, belt_state};
use cvtcycle_model::transmission::loss_factor::{LossFactors, UNCHANGED, changes};

use crate::common::{CARS, at, car, cycle, fuel_kg, soak_rows};

/// Key of the factor on a component of a car.
fn key(setup: &Setup, component: Component) -> String {
    let kind = if setup.transmission().is_cvt() {
        "cvt"
    } else {
        "manual"
    };
    format!("transmission.{kind}.loss_factor.{}", component.name())
}

fn only(component: Component, factor: f64) -> LossFactors {
    let mut factors = UNCHANGED;
    factors[component] = factor;
    factors
}

/// A shipped vehicle in a folder of its own, next to a map of no loss, and overrides.
fn with_zero_map(vehicle: &str, sets: &[String]) -> Setup {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("car.toml");
    let shipped = format!(
        "{}/../../vehicles/{vehicle}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::copy(shipped, &file).unwrap();
    let map = "input_speed_rpm,torque_loss_nm\n0,0\n9000,0\n";
    std::fs::write(folder.path().join("zero.csv"), map).unwrap();
    let options = Options {
        set: Override::parse_all(sets).unwrap(),
        ..Options::default()
    };
    load(file.to_str().unwrap(), &options).unwrap_or_else(|p| panic!("{}", render(&p, false)))
}

/// Two ways to a part without loss: a measured map of zero, and a factor of zero. A belt that is a map does not slip, and loads no bearing.
#[test]
fn a_zero_map_is_a_zero_factor() {
    let parts: [(&str, &[&str]); 6] = [
        ("pump", &["pump"]),
        ("input_shaft", &["input_shaft"]),
        ("clutch_drag", &["clutch_drag"]),
        ("seal_ring", &["seal_ring"]),
        ("final_drive", &["final_drive"]),
        (
            "belt",
            &[
                "belt_band",
                "belt_film",
                "belt_slip",
                "belt_wedge",
                "belt_penetration",
                "pulley_bearing",
            ],
        ),
    ];
    let cycle = cycle("ece15");
    for (map, factors) in parts {
        let map = vec![format!("transmission.cvt.maps.{map}=zero.csv")];
        let factors = factors
            .iter()
            .map(|name| format!("transmission.cvt.loss_factor.{name}=0"))
            .collect::<Vec<_>>();
        let [mapped, without] = [map, factors].map(|sets| {
            let car = with_zero_map(CARS[0], &sets);
            fuel_kg(&car, &cycle, &at(-10.0, Start::Soak))
        });
        // A circuit whose pump is a map holds any pressure; at idle the shipped pump does too.
        assert!((mapped / without - 1.0).abs() < 1e-12, "{mapped} {without}");
    }
}

/// A factor of 1, written or not, changes no bit of any row; one that is given by the library is that of the file.
#[test]
fn factor_one_is_no_change() {
    let cycle = cycle("ece15");
    for name in CARS {
        let plain = car(name, &[]);
        let rows = soak_rows(&plain, &cycle, -10.0).rows;
        let text = |rows: &[cvtcycle_model::drive::Row]| format!("{rows:?}");
        for component in plain.transmission().components() {
            let key = key(&plain, component);
            let one = car(name, &[&format!("{key}=1")]);
            assert_eq!(
                text(&rows),
                text(&soak_rows(&one, &cycle, -10.0).rows),
                "{key}"
            );
            for factor in [0.0, 0.5, 2.0] {
                let conditions = at(-10.0, Start::Soak);
                let file = car(name, &[&format!("{key}={factor}")]);
                let changed = plain.with_losses_times(&only(component, factor));
                let fuel = drive(&changed, &cycle, &conditions).totals.total().fuel_kg;
                let of_file = fuel_kg(&file, &cycle, &conditions);
                assert_eq!(of_file.to_bits(), fuel.to_bits(), "{key} {factor}");
                let twice = file.with_losses_times(&only(component, 1.0));
                let found: f64 = twice.transmission().loss_factors()[component];
                assert_eq!(found.to_bits(), factor.to_bits());
            }
        }
    }
}

/// Without a loss there is none in any row, and with it as it is there is.
#[test]
fn a_loss_that_is_removed_is_zero_in_every_row() {
    for name in CARS {
        let plain = car(name, &[]);
        for component in plain.transmission().components() {
            let rows = |factor: f64| {
                let conditions = Conditions {
                    keep_rows: true,
                    ..at(-10.0, Start::Soak)
                };
                let car = plain.with_losses_times(&only(component, factor));
                drive(&car, &cycle("ece15_eudc"), &conditions).rows
            };
            let lost = |factor: f64| {
                let rows = rows(factor);
                rows.iter()
                    .map(|row| row.loss_w[component])
                    .fold(0.0, f64::max)
            };
            assert!(
                lost(0.0) <= 0.0 && lost(1.0) > 0.0,
                "{name} {}",
                component.name()
            );
            if component == Component::BeltSlip {
                assert!(
                    rows(0.0)
                        .iter()
                        .all(|row| row.slip.is_nan() || row.slip.abs() <= 0.0)
                );
            }
        }
    }
}

/// Conservation: gross slip of both pulleys times the largest factor would leave no speed to the output (CV-1); it is bound before (CV-7). A clamp
/// that is too weak by half and a hard launch get there. An input of the fuzzer: the speed of the engine was infinite.
#[test]
fn the_largest_factor_on_gross_slip_leaves_a_speed() {
    let plain = car(
        "rover_216_cvt",
        &[
            "transmission.cvt.clamp=slip_limited",
            "transmission.cvt.clamp.slip_limited.safety_factor=0.5",
        ],
    );
    let launch = read_csv("launch.csv", b"time_s,speed_kmh\n0,0\n1.85,51\n4,51\n").unwrap();
    let conditions = Conditions {
        keep_rows: true,
        ..at(-3.5, Start::Soak)
    };
    let car = plain.with_losses_times(&only(Component::BeltSlip, 5.0));
    let rows = drive(&car, &launch, &conditions).rows;
    let most = rows.iter().map(|row| row.slip).fold(0.0, f64::max);
    assert!(most <= 0.8, "{most}");
    for row in &rows {
        let losses: f64 = Component::ALL.iter().map(|part| row.loss_w[*part]).sum();
        assert!(
            (row.engine_speed_rad_s + losses + row.fuel_kg_s).is_finite(),
            "{row:?}"
        );
    }
}

/// Hand calculation of a launch: the torque at the box times the slip speed is the loss that the car with a coupling of no loss does not have.
/// Both cars turn the engine alike, and the engine's fuel differs by the work that it does not do.
#[test]
fn launch_price_by_hand() {
    for name in CARS {
        let (plain, cycle) = (car(name, &[]), cycle("ece15"));
        let without = car(
            name,
            &[&format!("{}=0", key(&plain, Component::LaunchClutch))],
        );
        let [with, without] = [&plain, &without].map(|car| soak_rows(car, &cycle, 25.0).rows);
        // The first launch of the cycle, from its first moving row; both cars are as warm there.
        let first = with.iter().position(|row| row.speed_m_s > 0.0).unwrap();
        let (mut slipping, mut by_hand_j, mut engine_j) = (0, 0.0, 0.0);
        for (a, b) in with.iter().zip(&without).skip(first).take(4) {
            if !a.flags.contains(Flags::CLUTCH_SLIPPING) {
                continue;
            }
            slipping += 1;
            assert!(b.loss_w[Component::LaunchClutch] <= 0.0);
            let own = |row: &Row| row.engine_torque_nm * row.engine_speed_rad_s;
            by_hand_j += a.loss_w[Component::LaunchClutch] * a.dt_s;
            engine_j += (own(a) - own(b)) * a.dt_s;
        }
        assert!(
            slipping > 0 && by_hand_j > 100.0,
            "{name}: {slipping} {by_hand_j}"
        );
        assert!(
            (engine_j / by_hand_j - 1.0).abs() < 0.01,
            "{name}: {engine_j} {by_hand_j}"
        );
    }
}

/// A car is changed by a factor other than 1 on any one component, and by nothing else.
#[test]
fn any_factor_other_than_one_changes() {
    assert!(!changes(&UNCHANGED));
    for component in Component::ALL {
        for factor in [0.0, 0.999, 1.0 + f64::EPSILON, 2.0] {
            assert!(changes(&only(component, factor)), "{component:?} {factor}");
        }
    }
}

/// CV-7: twice the slip is twice the speeds and the losses of every part of it, on both pulleys, and pays by VA-1 at the input; what a factor of another
/// part leaves alone.
#[test]
fn a_factor_on_slip_is_one_on_all_of_its_parts() {
    let setup = car(CARS[0], &[]);
    let Transmission::Cvt(cvt) = setup.transmission() else {
        panic!("a CVT")
    };
    let oil = setup.car(353.15).oil;
    for (ratio, nm) in [(2.0, 120.0), (0.6, 40.0), (1.4, -30.0)] {
        let load = BeltLoad {
            output_torque_nm: nm,
            secondary_clamp_n: 15e3,
            ..BeltLoad::turning(&cvt.belt, &oil, 353.15, ratio, 200.0)
        };
        let at = BeltAtRatio::new(&cvt.belt, ratio);
        let plain = belt_state(&cvt.belt, &at, &load);
        let twice = plain.times(&only(Component::BeltSlip, 2.0), nm, ratio);
        for (name, a, b) in [
            ("primary", plain.slip.primary, twice.slip.primary),
            ("secondary", plain.slip.secondary, twice.slip.secondary),
            ("gap", plain.slip.gap, twice.slip.gap),
            ("idle", plain.slip.idle, twice.slip.idle),
            (
                "loss, primary",
                plain.slip.primary_loss_nm,
                twice.slip.primary_loss_nm,
            ),
            (
                "loss, secondary",
                plain.slip.secondary_loss_nm,
                twice.slip.secondary_loss_nm,
            ),
            ("loss", plain.losses.slip_nm, twice.losses.slip_nm),
            ("total", plain.losses.slip_total, twice.losses.slip_total),
        ] {
            assert!((b - 2.0 * a).abs() <= 1e-12 * a.abs(), "{name} {a} {b}");
        }
        assert!(plain.slip.primary.abs() > 0.0 && plain.losses.slip_total.abs() > 0.0);
        let more_nm = -nm / ratio * plain.losses.slip_total + plain.losses.slip_nm; // VA-1
        let paid_nm = twice.input_torque_nm - plain.input_torque_nm;
        assert!((paid_nm - more_nm).abs() < 1e-9, "{paid_nm} {more_nm}");
        let bands = plain.times(&only(Component::BeltBand, 2.0), nm, ratio);
        assert!(bands.slip == plain.slip, "{ratio}");
    }
}
