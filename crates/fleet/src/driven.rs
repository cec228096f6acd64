//! Cars on tests, side by side.

use std::collections::BTreeMap;

use cvtcycle_config::Problems;
use cvtcycle_config::procedure::Procedure;
use cvtcycle_config::setup::{ParamSet, Setup};
use cvtcycle_model::drive::{Conditions, Start, drive as drive_car};
use cvtcycle_output::summary::{Driven, RunSummary, Settings, run_summary};

use crate::CarSets;

/// Measured over computed fuel from which its unit is doubted: the worst of 88 cars is off by a quarter.
const FAR: f64 = 2.0;
/// L/100 km times miles per US gallon: 3.785411784 l and 1.609344 km.
const L_PER_100KM_MPG: f64 = 235.214_583;

/// Figures of a car on all tests.
#[derive(Clone, Debug, Default)]
pub struct DrivenCar {
    /// Each test, in order.
    pub tests: Vec<TestFigures>,
    /// Each test with the twin, of a car that has one; not those of which the row has a road load of its own.
    pub twin: Vec<TestFigures>,
}

/// Figures of a car on a test.
#[derive(Clone, Debug)]
pub struct TestFigures {
    /// Name of the test.
    pub test: String,
    /// Fuel by column, L/100 km; of a test that was refused, none.
    pub fuel: BTreeMap<String, f64>,
    /// Checks of the run that failed.
    pub failed_checks: Vec<String>,
    /// Why the test could not be driven.
    pub refused: Option<String>,
    /// Work at the wheels in driving over distance, MJ/km.
    pub wheel_mj_km: f64,
}

impl DrivenCar {
    /// Computed fuel of a column, L/100 km.
    #[must_use]
    pub fn fuel(&self, column: &str) -> Option<f64> {
        self.tests
            .iter()
            .find_map(|test| test.fuel.get(column))
            .copied()
    }

    /// Doubts about the units of measured fuel, L/100 km by column.
    pub(crate) fn doubts(&self, measured: &BTreeMap<String, f64>) -> Vec<String> {
        let doubt = |(column, own): (&String, &f64)| {
            let computed = self.fuel(column).filter(|fuel| fuel.is_finite())?;
            let near = |x: f64| (1.0 / FAR..FAR).contains(&(x / computed));
            let hint = match near(L_PER_100KM_MPG / own) {
                true => format!(": as miles per gallon it is {:.2}", L_PER_100KM_MPG / own),
                false => String::new(),
            };
            let said = format!(
                "{column}: {own} L/100 km were measured and {computed:.2} computed{hint}; check its unit"
            );
            (!near(*own)).then_some(said)
        };
        measured.iter().filter_map(doubt).collect()
    }

    /// Computed fuel of the twin of a column, L/100 km.
    #[must_use]
    pub fn twin_fuel(&self, column: &str) -> Option<f64> {
        let mut tests = self.twin.iter();
        tests.find_map(|test| test.fuel.get(column)).copied()
    }

    /// Failed checks of all tests, each with the test.
    #[must_use]
    pub fn failed_checks(&self) -> Vec<String> {
        let of = |test: &TestFigures| -> Vec<String> {
            let refused = test
                .refused
                .iter()
                .map(|reason| format!("{}: {reason}", test.test));
            test.failed_checks
                .iter()
                .map(|check| format!("{}: {check}", test.test))
                .chain(refused)
                .collect()
        };
        self.tests.iter().flat_map(of).collect()
    }
}

/// Drives a car on every test, with steps of at most some time, s.
pub(crate) fn drive(car: &CarSets, tests_of: &[Procedure], max_dt_s: f64) -> DrivenCar {
    let tests = tests_of.iter();
    let tests = tests.map(|test| drive_test(car, test, max_dt_s));
    let twin = car.twin.as_ref().map_or_else(Vec::new, |twin| {
        // A test whose road load the row has for this car alone is none of the twin's.
        let own = |test: &&Procedure| !car.by_test.contains_key(&test.name);
        let drive = |test| drive_params(twin, test, max_dt_s);
        tests_of.iter().filter(own).map(drive).collect()
    });
    DrivenCar {
        tests: tests.collect(),
        twin,
    }
}

pub(crate) fn drive_test(car: &CarSets, test: &Procedure, max_dt_s: f64) -> TestFigures {
    let loaded = match car.by_test.get(&test.name) {
        // The road load is that of the test already.
        Some(own) => Procedure {
            load_factor: 1.0,
            ..test.clone()
        }
        .load(own),
        None => test.load(&car.params),
    };
    driven(loaded, test, max_dt_s)
}

/// A car whose road load is not that of the test yet.
fn drive_params(params: &ParamSet, test: &Procedure, max_dt_s: f64) -> TestFigures {
    driven(test.load(params), test, max_dt_s)
}

fn driven(loaded: Result<ParamSet, Problems>, test: &Procedure, max_dt_s: f64) -> TestFigures {
    match loaded {
        Ok(params) => figures(&Setup::from_params(&params), test, max_dt_s),
        Err(problems) => TestFigures {
            test: test.name.clone(),
            fuel: BTreeMap::new(),
            failed_checks: Vec::new(),
            refused: Some(first_message(&problems)),
            wheel_mj_km: f64::NAN,
        },
    }
}

fn first_message(problems: &Problems) -> String {
    problems
        .iter()
        .next()
        .map_or_else(String::new, |problem| problem.message.clone())
}

pub(crate) fn figures(setup: &Setup, test: &Procedure, max_dt_s: f64) -> TestFigures {
    let cycle = test.cycle_for(setup);
    let run = |conditions: Conditions| -> RunSummary {
        let outcome = drive_car(setup, &cycle, &conditions);
        let settings = Settings {
            dt_s: max_dt_s,
            ..Settings::default()
        };
        run_summary(
            &cycle,
            "subject",
            &settings,
            &Driven {
                name: &setup.name,
                setup,
                outcome: &outcome,
            },
        )
    };
    let own = test.conditions(max_dt_s);
    let first = run(own);
    let warm = (test.warm_share > 0.0).then(|| {
        run(Conditions {
            start: Start::Warm,
            ..own
        })
    });
    let mut fuel = BTreeMap::new();
    let stated = test.stated_share(setup);
    for result in &test.results {
        let of = |summary: &RunSummary| {
            if result.phases.is_empty() {
                return summary.headline_fuel().unwrap_or(f64::NAN);
            }
            let parts = summary
                .phases
                .iter()
                .filter(|phase| result.phases.contains(&phase.name));
            let (litre, km) = parts.fold((0.0, 0.0), |(litre, km), part| {
                (
                    litre + part.fuel_l_per_100km.unwrap_or(f64::NAN) * part.distance_km,
                    km + part.distance_km,
                )
            });
            litre / km
        };
        let cold = of(&first);
        let value = warm.as_ref().map_or(cold, |warm| {
            (1.0 - test.warm_share) * cold + test.warm_share * of(warm)
        }); // TE-1
        fuel.insert(result.column(), stated * value);
    }
    let mut failed_checks = first.failed_checks.clone();
    failed_checks.extend(warm.into_iter().flat_map(|warm| warm.failed_checks));
    failed_checks.dedup();
    TestFigures {
        test: test.name.clone(),
        fuel,
        failed_checks,
        refused: None,
        wheel_mj_km: first.wheel_work_positive_kj / 1e3 / first.distance_km,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: 47 miles per US gallon are 5.00 L/100 km.
    #[test]
    fn fuel_in_miles_per_gallon_is_doubted() {
        let driven = DrivenCar {
            tests: vec![TestFigures {
                test: "hwfet".to_owned(),
                fuel: BTreeMap::from([("hwfet_l_per_100km".to_owned(), 4.6)]),
                failed_checks: Vec::new(),
                refused: None,
                wheel_mj_km: 0.4,
            }],
            twin: Vec::new(),
        };
        let of = |litres: f64| {
            driven.doubts(&BTreeMap::from([("hwfet_l_per_100km".to_owned(), litres)]))
        };
        assert!(of(5.9).is_empty() && of(3.4).is_empty());
        let found = of(47.0);
        assert!(
            found[0].contains("as miles per gallon it is 5.00"),
            "{found:?}"
        );
        assert!(!of(1.2)[0].contains("gallon"));
    }
}
