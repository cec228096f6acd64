//! Failing checks of a run: impossible rows, energy balances, NaN.

use cvtcycle::config::cycle::{Cycle, read_csv};
use cvtcycle::config::setup::{Options, Setup, load};
use cvtcycle::model::drive::{Conditions, EnergyTerms, Outcome, Recorder, Start, drive};
use cvtcycle::output::summary::{Driven, Failure, RunSummary, Settings, run_summary};
use cvtcycle::output::{Flags, Row};

fn town() -> Cycle {
    let text = "time_s,speed_kmh,phase\n0,0,Out\n10,36,Out\n11,36,Back\n20,36,Back\n30,0,Back\n";
    read_csv("town.csv", text.as_bytes()).unwrap()
}

fn car() -> Setup {
    load("rover_216_5mt", &Options::default()).unwrap()
}

/// Summary of a drive through the town after a change.
fn changed(strict: bool, change: impl FnOnce(&mut Outcome)) -> RunSummary {
    let (setup, cycle) = (car(), town());
    let conditions = Conditions {
        ambient_k: 293.15,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    let mut outcome = drive(&setup, &cycle, &conditions);
    change(&mut outcome);
    let driven = Driven {
        name: "car",
        setup: &setup,
        outcome: &outcome,
    };
    let settings = Settings {
        strict,
        ..Settings::default()
    };
    run_summary(&cycle, "subject", &settings, &driven)
}

/// The same with additional rows of one second.
fn with_rows(rows: &[Row]) -> RunSummary {
    changed(false, |outcome| {
        for row in rows {
            let row = Row { dt_s: 1.0, ..*row };
            outcome.totals.record(&row, &EnergyTerms::default());
        }
    })
}

fn row(time_s: f64, flag: Flags) -> Row {
    Row {
        time_s,
        flags: flag,
        ..Row::default()
    }
}

fn texts(run: &RunSummary) -> Vec<String> {
    let names = run.failures.iter().map(|failure| &failure.check);
    assert!(names.eq(&run.failed_checks));
    let text = |failure: &Failure| format!("{} | {}", run.failure_text(failure), failure.brief());
    run.failures.iter().map(text).collect()
}

#[test]
fn a_valid_run_fails_no_check() {
    assert!(changed(true, |_| {}).failures.is_empty());
}

#[test]
fn impossible_rows_are_failures_with_the_worst_or_the_first_row() {
    let rpm = |rpm: f64| rpm * std::f64::consts::PI / 30.0;
    let fast = |time_s, speed| Row {
        engine_speed_rad_s: rpm(speed),
        ..row(time_s, Flags::OVERSPEED)
    };
    // The operating line and the maximum speed end at 6500 rpm; 1 % above is belt slip.
    assert_eq!(texts(&with_rows(&[fast(5.0, 6560.0)])), [""; 0]);
    assert_eq!(
        texts(&with_rows(&[
            fast(5.0, 6570.0),
            fast(12.0, 9000.0),
            fast(13.0, 8000.0)
        ])),
        [
            "turns the engine at 9000 rpm at 12.0 s in back, above 6500 rpm, for 3.0 s | \
          overspeed for 3 s, worst 9000.0 rpm at 12 s in back"
        ]
    );
    // Coolant 10 K above its limit, engine oil 12 K, transmission oil 11 K.
    let hot = |time_s, degc: [f64; 3]| {
        let [coolant_k, engine_oil_k, sump_k] = degc.map(|degc| degc + 273.15);
        Row {
            coolant_k,
            engine_oil_k,
            sump_k,
            ..row(time_s, Flags::TOO_HOT)
        }
    };
    assert_eq!(
        texts(&with_rows(&[
            hot(3.0, [140.0, 90.0, 20.0]),
            hot(4.0, [20.0, 172.0, 20.0]),
            hot(5.0, [20.0, 20.0, 171.0]),
        ])),
        [
            "heats the engine oil to 172.0 degC at 4.0 s in out, above 160 degC, for 3.0 s | \
          too_hot for 3 s, worst 172.0 degC at 4 s in out"
        ]
    );
    let found = with_rows(&[row(22.0, Flags::WRONG_GEAR), row(23.0, Flags::WRONG_GEAR)]);
    assert_eq!(
        texts(&found),
        [
            "is driven faster for 2.0 s in which the cycle prescribes no gear, first at 22.0 s in back | \
          wrong_gear for 2 s, first at 22 s in back"
        ]
    );
    let json = serde_json::to_value(&found.failures[0]).unwrap();
    assert_eq!(json["check"], "wrong_gear");
    assert_eq!(
        (&json["at_s"], &json["phase"]),
        (&22.0.into(), &"back".into())
    );
}

#[test]
fn nan_is_a_failure_of_its_own() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let normal = row(7.0, Flags::default());
        for found in [
            Row {
                engine_torque_nm: bad,
                ..normal
            },
            Row {
                engine_speed_rad_s: bad,
                ..normal
            },
            Row {
                fuel_kg_s: bad,
                ..normal
            },
            Row {
                coolant_k: bad,
                ..normal
            },
            Row {
                engine_oil_k: bad,
                ..normal
            },
            Row {
                sump_k: bad,
                ..normal
            },
            Row {
                metal_k: bad,
                ..normal
            },
        ] {
            let later = Row {
                time_s: 8.0,
                ..found
            };
            assert_eq!(
                texts(&with_rows(&[found, later])),
                [
                    "has a torque, speed, fuel flow or temperature that is no number for 2.0 s, first at 7.0 s in out | \
                  not_finite for 2 s, first at 7 s in out"
                ],
                "{found:?}"
            );
        }
    }
}

#[test]
fn a_flag_is_a_failure_of_a_strict_run() {
    let slip = |outcome: &mut Outcome| {
        outcome.totals.record(
            &Row {
                dt_s: 1.0,
                ..row(5.0, Flags::GROSS_SLIP)
            },
            &EnergyTerms::default(),
        );
    };
    assert_eq!(texts(&changed(false, slip)), [""; 0]);
    assert_eq!(
        texts(&changed(true, slip)),
        ["gross_slip for 1.0 s | gross_slip for 1 s"]
    );
}

/// A plain sum of n terms has a relative error up to n epsilon: 2.2e-8 for 1e8 rows.
#[test]
fn the_energy_balance_may_be_open_by_rounding() {
    let open = |share: f64, rows: u64| {
        let found = changed(false, |outcome| {
            let totals = &mut outcome.totals;
            totals.rows = rows;
            totals.phases[0].terms.fuel *= 1.0 + share;
        });
        texts(&found).len()
    };
    assert_eq!(open(2e-10, 30), 0);
    assert_eq!(open(2e-8, 30), 1);
    assert_eq!(open(2e-8, 100_000_000), 0);
    assert_eq!(open(1e-6, 100_000_000), 1);
    // The error of one row does not grow with their number.
    let row = changed(false, |outcome| {
        (outcome.totals.rows, outcome.totals.ledger_error) = (100_000_000, 1e-8);
    });
    assert_eq!(row.failed_checks, ["ledger_error"]);
    let none = changed(false, |outcome| outcome.totals.ledger_error = f64::NAN);
    assert_eq!(none.failed_checks, ["ledger_error"]);
}

/// Files of an earlier version have no list of failures.
#[test]
fn a_summary_without_failures_is_read() {
    let run = changed(false, |_| {});
    let mut json = serde_json::to_value(&run).unwrap();
    json.as_object_mut().unwrap().remove("failures").unwrap();
    assert_eq!(serde_json::from_value::<RunSummary>(json).unwrap(), run);
}
