//! The physics checks (PX-1 to PX-8): they hold for shipped and random cars, and each sees an error over which the ledgers close.

use std::fmt::Write as _;

use cvtcycle_config::setup::{Options, load, load_lubricant};
use cvtcycle_model::drive::{
    Car, Conditions, Finding, Law, PhysicsCheck, Recorder, Row, Start, State, check_physics, drive,
    simulate,
};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::loss_factor::UNCHANGED;
use proptest::prelude::*;

use super::cars::recipes;
use super::hold;
use super::traces::traces;
use crate::common::{CARS, Keep, ZERO, at, car, cycle};

fn broken(findings: &[Finding]) -> Vec<&'static str> {
    let of = findings.iter().filter(|finding| !finding.holds());
    of.map(|finding| finding.law.label()).collect()
}

fn lines(findings: &[Finding]) -> String {
    findings.iter().fold(String::new(), |mut text, f| {
        let (label, unit) = (f.law.label(), f.law.unit());
        writeln!(
            text,
            "{label} {:e} of {:e} {unit} at {} s, {} rows",
            f.residual, f.bound, f.at_s, f.rows
        )
        .unwrap();
        text
    })
}

#[test]
fn shipped_cars_hold_every_law() {
    for name in CARS {
        for cycle_name in ["ece15_eudc", "ftp75", "us06"] {
            for ambient in [-30.0, -10.0, 25.0, 45.0] {
                let setup = car(name, &[]);
                let found = check_physics(&setup, &cycle(cycle_name), ZERO + ambient, 1.0);
                assert!(
                    broken(&found).is_empty(),
                    "{name} {cycle_name} {ambient} degC\n{}",
                    lines(&found)
                );
                let rows = |law: Law| found[law as usize].rows;
                let belt = if name == CARS[0] { 300 } else { 0 };
                assert!(rows(Law::Statics) >= belt && rows(Law::Rotation) > 100);
                assert!(rows(Law::Heat) > 500 && rows(Law::Air) > 100);
            }
        }
    }
}

/// Drive and overrun, standstill, slopes, gross slip, engine off, steps from a twentieth of a second to ten.
#[test]
fn every_law_over_random_cars() {
    let dt = prop_oneof![3 => Just(1.0), 1 => Just(0.1), 1 => Just(10.0), 1 => 0.05..5.0];
    hold(
        400,
        &(recipes(0.1), traces(), -40.0..60.0, dt),
        |(recipe, rows, ambient, dt)| {
            let setup = recipe.car().setup;
            let found = check_physics(&setup, &rows.cycle(), ZERO + ambient, dt);
            prop_assert!(broken(&found).is_empty(), "{}", lines(&found));
            Ok(())
        },
    );
}

/// Losses times 0 to 3 each: what is left of the laws holds, and both ledgers close; statics are those of a belt as it is (CV-7).
#[test]
fn ledgers_close_at_any_factor() {
    let factors =
        prop::collection::vec(prop_oneof![1 => Just(0.0), 3 => 0.0..3.0], Component::COUNT);
    let worst = std::cell::Cell::new(0.0_f64);
    hold(
        200,
        &(recipes(0.1), traces(), -40.0..60.0, factors),
        |(recipe, rows, ambient, factors)| {
            let setup = recipe.car().setup;
            let mut by_component = UNCHANGED;
            for (factor, given) in by_component.iter_mut().zip(&factors) {
                *factor = *given;
            }
            let changed = setup.with_losses_times(&by_component);
            let found = check_physics(&changed, &rows.cycle(), ZERO + ambient, 1.0);
            prop_assert!(broken(&found).is_empty(), "{}", lines(&found));
            prop_assert!(found[Law::Statics as usize].rows == 0 || !setup.transmission().is_cvt());
            let totals = drive(&changed, &rows.cycle(), &at(ambient, Start::Soak)).totals;
            prop_assert!(totals.ledger_error < 1e-12, "{:e}", totals.ledger_error);
            worst.set(worst.get().max(totals.ledger_error));
            Ok(())
        },
    );
    println!("worst ledger error {:e}", worst.get());
}

fn primary_rad_s(car: &Car, row: &Row) -> f64 {
    let Transmission::Cvt(cvt) = &car.transmission else {
        panic!("a CVT")
    };
    let secondary = cvt.final_drive.ratio * row.speed_m_s / car.road_load.wheel_radius_m;
    row.belt_ratio * secondary / (1.0 - row.slip)
}

/// Another loss of a part, and the torque at the primary that pays for it: power and heat balance as before.
fn paid(car: &Car, row: &mut Row, part: Component, factor: f64) {
    let more_w = (factor - 1.0) * row.loss_w[part];
    if more_w.abs() > 0.0 {
        row.loss_w[part] += more_w;
        row.to_air_w += more_w;
        row.primary_nm += more_w / primary_rad_s(car, row);
    }
}

/// An error of the model, and the labels of the laws that it breaks.
type Mutation = (&'static str, fn(&Car, &mut Row), &'static [&'static str]);

/// Each error keeps the balances that it can keep; the laws named break, and no other.
const MUTATIONS: [Mutation; 9] = [
    ("as it is", |_, _| {}, &[]),
    (
        "bands lose 1 % more",
        |car, row| paid(car, row, Component::BeltBand, 1.01),
        &["PX-1", "PX-2"],
    ),
    (
        "slip lost twice",
        |car, row| paid(car, row, Component::BeltSlip, 2.0),
        &["PX-1"],
    ),
    (
        "fuel without air",
        |_, row| row.fuel_power_w *= 4.0,
        &["PX-3"],
    ),
    (
        "flywheel a tenth heavier",
        |_, row| row.kinetic_w *= 1.1,
        &["PX-4"],
    ),
    (
        "pump that drives",
        |_, row| {
            row.to_air_w -= row.loss_w[Component::Pump] + 1.0;
            row.loss_w[Component::Pump] = -1.0;
        },
        &["PX-5"],
    ),
    (
        "film that drags at rest",
        |_, row| {
            if row.speed_m_s <= 0.0 {
                row.loss_w[Component::BeltFilm] += 1.0;
                row.to_air_w += 1.0;
            }
        },
        &["PX-5"],
    ),
    (
        "heat that is lost",
        |_, row| row.to_air_w += 0.01,
        &["PX-7"],
    ),
    (
        "belt a thousandth shorter of torque",
        |_, row| row.primary_nm *= 0.999,
        &["PX-1", "PX-8"],
    ),
];

#[test]
fn each_law_sees_its_error() {
    let car = car(CARS[0], &[]).car(ZERO - 10.0);
    let cycle = cycle("ftp75");
    let start = State::at(ZERO - 10.0);
    let mut keep = Keep::default();
    simulate(&car, cycle.trace_for(true), 1.0, start, &mut keep);
    for (name, change, laws) in MUTATIONS {
        let mut check = PhysicsCheck::new(&car, &start);
        for (row, terms) in keep.rows.iter().zip(&keep.terms) {
            let mut row = *row;
            change(&car, &mut row);
            check.record(&row, terms);
        }
        let found = broken(check.findings());
        assert_eq!(found, laws, "{name}\n{}", lines(check.findings()));
    }
    let worst = |error: f64, terms: &cvtcycle_model::drive::EnergyTerms| {
        error.max(terms.power_error()).max(terms.heat_error())
    };
    assert!(keep.terms.iter().fold(0.0, worst) < 1e-12);
}

/// Without friction between bands and segments, at the flanks and in the film the belt is a ratio and nothing else, in drive and overrun.
#[test]
fn a_belt_without_friction_passes_torque_by_its_ratio() {
    let sets = [
        "lubricant.friction.band=0",
        "lubricant.friction.flank=0",
        "lubricant.friction.film.enabled=false",
    ];
    let conditions = Conditions {
        keep_rows: true,
        ..at(25.0, Start::Soak)
    };
    let rows = drive(&car(CARS[0], &sets), &cycle("ftp75"), &conditions).rows;
    let mut signs = [0, 0];
    for row in rows.iter().filter(|row| !row.primary_nm.is_nan()) {
        let apart_nm = row.primary_nm - row.secondary_nm / row.belt_ratio;
        assert!(apart_nm.abs() < 1e-9, "{apart_nm} Nm at {} s", row.time_s);
        signs[usize::from(row.secondary_nm < 0.0)] += 1;
    }
    assert!(signs[0] > 500 && signs[1] > 100, "{signs:?}");
}

/// PX-6: the data sheet of a shipped fluid, typed in, gives its friction and its fuel to the bit.
#[test]
fn the_same_data_sheet_is_the_same_fluid() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("typed.toml");
    let conditions = at(-10.0, Start::Soak);
    for name in ["cvtf_ezl799_class", "dexron_ii", "dexron_iii"] {
        let (shipped, keys) = load_lubricant(name).unwrap();
        let sheet = ["kv40_mm2_s", "kv100_mm2_s", "density15_kg_m3"];
        let lines: Vec<String> = sheet
            .iter()
            .map(|key| {
                let own = keys.iter().find(|info| info.key.ends_with(key)).unwrap();
                format!("{key} = {}", own.value)
            })
            .collect();
        std::fs::write(&path, lines.join("\n")).unwrap();
        let word = path.to_str().unwrap().to_owned();
        assert_eq!(load_lubricant(&word).unwrap().0.friction, shipped.friction);
        let fuel = |lubricant: &str| {
            let options = Options {
                lubricant: Some(lubricant.to_owned()),
                ..Options::default()
            };
            let setup = load(CARS[0], &options).unwrap();
            let total = drive(&setup, &cycle("ece15"), &conditions).totals.total();
            total.fuel_kg.to_bits()
        };
        assert_eq!(fuel(&word), fuel(name), "{name}");
        // The eye that sees it: a rise of friction with temperature that is another one in its ninth digit.
        let friction = format!(
            "\n[friction]\nband_rise_per_k = {}",
            shipped.friction.band_rise_per_k * (1.0 + 1e-9)
        );
        std::fs::write(&path, lines.join("\n") + &friction).unwrap();
        assert_ne!(fuel(&word), fuel(name), "{name}");
    }
}
