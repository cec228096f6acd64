//! A belt starter-generator. Truth: energy balances of the rows, the balance of the store, and what must save or cost fuel.

use crate::common::{Keep, ZERO, at, car, cycle, try_car};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{
    Conditions, Start, check_physics, drive, own_trace, simulate, start_state,
};

const ON: &str = "engine.start_stop";
const OWN: [(&str, &str); 6] = [
    ("delay_s", "0.5"),
    ("store_wh", "200"),
    ("charge_w", "2000"),
    ("starter_generator.recuperation_w", "10000"),
    ("starter_generator.assistance_w", "9000"),
    ("starter_generator.torque_nm", "150"),
];

fn with(vehicle: &str, more: &[(&str, &str)]) -> Result<Setup, String> {
    let own = OWN
        .iter()
        .filter(|(key, _)| !more.iter().any(|(other, _)| other == key));
    let each = own
        .chain(more)
        .map(|(key, value)| format!("{ON}.{key}={value}"));
    try_car(vehicle, &each.collect::<Vec<_>>())
}

fn fitted(vehicle: &str, more: &[(&str, &str)]) -> Setup {
    with(vehicle, more).unwrap_or_else(|problems| panic!("{problems}"))
}

/// A drive with its rows and energy terms.
fn kept(setup: &Setup, name: &str, start: Start) -> Keep {
    let conditions = at(25.0, start);
    let ready = setup.car(conditions.ambient_k);
    let cycle = cycle(name);
    let trace = setup.trace(&cycle).trace;
    let trace = own_trace(&ready, &trace);
    let mut keep = Keep::default();
    let state = start_state(&ready, &trace, &conditions);
    simulate(&ready, &trace, conditions.max_dt_s, state, &mut keep);
    keep
}

fn fuel(setup: &Setup, name: &str, start: Start) -> f64 {
    drive(setup, &cycle(name), &at(25.0, start))
        .totals
        .total()
        .fuel_kg
}

#[test]
fn books_close_and_the_laws_hold() {
    for vehicle in ["rover_216_cvt", "civic_20_cvt", "civic_20_6mt"] {
        let setup = fitted(vehicle, &[]);
        for name in ["ece15_eudc", "us06"] {
            for finding in check_physics(&setup, &cycle(name), 25.0 + ZERO, 1.0) {
                assert!(finding.holds(), "{vehicle} {name}: {finding:?}");
            }
            let drive = kept(&setup, name, Start::Soak);
            for row in &drive.rows {
                assert!(
                    row.power_ledger_error < 1e-9,
                    "{vehicle} {name} {} s",
                    row.time_s
                );
            }
        }
    }
}

/// SG-6: the store ends as it began, within 0.1 % of the fuel's energy; recuperation takes no more than the brakes had without it, and some of that.
#[test]
fn the_charge_is_balanced() {
    for vehicle in ["rover_216_cvt", "civic_20_6mt"] {
        let setup = fitted(vehicle, &[]);
        let without = fitted(vehicle, &[("starter_generator.recuperation_w", "0")]);
        for (name, start) in [
            ("wltc_class3b", Start::Soak),
            ("ftp75", Start::Soak),
            ("ece15_eudc", Start::Warm),
        ] {
            let sum = |drive: &Keep, of: &dyn Fn(usize) -> f64| -> f64 {
                (0..drive.rows.len())
                    .map(|k| of(k) * drive.rows[k].dt_s)
                    .sum()
            };
            let [own, bare] = [&setup, &without].map(|setup| kept(setup, name, start));
            let moved_j = sum(&own, &|k| own.terms[k].store);
            let fuel_j = sum(&own, &|k| own.terms[k].fuel);
            assert!(
                moved_j.abs() < 1e-3 * fuel_j,
                "{vehicle} {name}: {moved_j} of {fuel_j} J"
            );
            let into_j = -sum(&own, &|k| own.terms[k].store.min(0.0));
            let braked = |drive: &Keep| sum(drive, &|k| drive.terms[k].brake);
            let spared_j = braked(&bare) - braked(&own);
            assert!(
                spared_j > 0.1 * braked(&bare),
                "{vehicle} {name}: {spared_j} J"
            );
            assert!(
                into_j > 0.3 * spared_j && into_j < spared_j + 0.01 * fuel_j,
                "{vehicle} {name}: {into_j} of {spared_j} J"
            );
        }
    }
}

/// Recuperation saves, assistance without a better efficiency than that of the consumers' way saves little or costs; every number acts.
#[test]
fn no_number_of_the_machine_is_dead() {
    let burnt =
        |more: &[(&str, &str)]| fuel(&fitted("rover_216_cvt", more), "ece15_eudc", Start::Warm);
    let own = burnt(&[]);
    for more in [
        ("starter_generator.recuperation_w", "3000"),
        ("starter_generator.assistance_w", "500"),
        ("starter_generator.torque_nm", "15"),
        ("starter_generator.efficiency", "0.7"),
        ("starter_generator.least_rpm", "1600"),
        ("starter_generator.kept_share", "0.9"),
        ("starter_generator.assisted_share", "0.05"),
    ] {
        let moved = burnt(&[more]);
        assert!((moved / own - 1.0).abs() > 1e-6, "{more:?}: {own} {moved}");
    }
    let stops = car("rover_216_cvt", &["engine.start_stop.delay_s=0.5"]);
    let stops = fuel(&stops, "ece15_eudc", Start::Warm);
    assert!(own < 0.99 * stops, "{own} {stops}");
    let less = burnt(&[("starter_generator.recuperation_w", "0")]);
    assert!(own < less, "{own} {less}");
}

/// Truth: the same drive in steps of 0.05 s.
#[test]
fn fuel_does_not_depend_on_the_step() {
    let setup = fitted("rover_216_cvt", &[]);
    let [coarse, fine] = [1.0, 0.05].map(|max_dt_s| {
        let conditions = Conditions {
            max_dt_s,
            ..at(25.0, Start::Soak)
        };
        drive(&setup, &cycle("ece15_eudc"), &conditions)
            .totals
            .total()
            .fuel_kg
    });
    let percent = 100.0 * (coarse / fine - 1.0);
    assert!(percent.abs() < 0.3, "{percent} %");
}

#[test]
fn bad_machines_are_refused() {
    let half = try_car(
        "rover_216_cvt",
        &[format!("{ON}.starter_generator.torque_nm=50")],
    )
    .unwrap_err();
    assert!(
        half.contains("recuperation_w") && half.contains("missing"),
        "{half}"
    );
    let small = with("rover_216_cvt", &[("store_wh", "0.1")]).unwrap_err();
    assert!(small.contains("larger store"), "{small}");
    let wrong = with("rover_216_cvt", &[("starter_generator.efficiency", "1.2")]).unwrap_err();
    assert!(wrong.contains("efficiency"), "{wrong}");
}
