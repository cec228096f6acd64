//! How much each single value of a car matters for its fuel: every number changed by itself, up and down, and the cycle driven again.
//!
//! An efficiency is changed through its loss: 5 % of 0.98 would be two and a half times the loss. A temperature in degC is changed by 5 K. The step is one for all, so the answer says how steep the fuel is in a value, not how uncertain the value is: that is what a study with
//! ranges of its own says (docs/uncertainty.md).

use rayon::prelude::*;

use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::{Options, Param, ParamSet, Setup};
use cvtcycle_config::{Problems, unit_of};
use cvtcycle_model::drive::{Conditions, MAX_TOGETHER, Outcome, Run, drive, drive_each};
use cvtcycle_model::transmission::loss_factor;
use cvtcycle_output::number::finite;
use cvtcycle_output::record::{Effect, Sensitivity};
use cvtcycle_output::summary::Driven;
use cvtcycle_output::summary::{Settings, run_summary};

/// Change of a value, per cent of it.
pub const STEP_PERCENT: f64 = 5.0;

/// Change of a temperature, K.
const STEP_K: f64 = 5.0;

/// A car as its words on the command line name it.
#[derive(Clone, Debug)]
pub struct Named {
    /// Name, unique within the run.
    pub name: String,
    /// Vehicle, name or path.
    pub word: String,
    /// Oils, overrides, formulation.
    pub options: Options,
}

/// Changes every number of every car by [`STEP_PERCENT`], down and up, and drives the cycle.
///
/// Numbers that are zero and those that the program reads as whole numbers, words or lists are left out. `None` on a side: the car is
/// refused with that value. The order is that of the cars and of their keys, whatever the number of threads.
///
/// # Errors
/// Problems of the cars' files, none where the cars have just been loaded.
pub fn sensitivity(
    cars: &[Named],
    cycle: &Cycle,
    conditions: &Conditions,
) -> Result<Sensitivity, Problems> {
    let conditions = Conditions {
        keep_rows: false,
        ..*conditions
    };
    let mut effects = Vec::new();
    for car in cars {
        let own = ParamSet::load(&car.word, &car.options)?;
        let base = fuel(&Setup::from_params(&own), cycle, &conditions);
        let keys = own.keys().into_iter();
        let keys = keys
            .filter(|info| info.si.is_some() && info.status != "choice")
            .filter(|info| !loss_factor::is_key(&info.key));
        let params: Vec<Param> = keys
            .filter_map(|info| own.param(&info.key).ok())
            .filter(|param| param.base().abs() > 0.0)
            .collect();
        let of_params = |params: &[Param]| -> Vec<Effect> {
            let changed_car = |param: &Param, sign: f64| {
                let number = changed(param.key(), param.base(), sign);
                let set = own.with_numbers(&[(param, number)]);
                set.ok().map(|set| Setup::from_params(&set))
            };
            let cars: Vec<Option<Setup>> = (params.iter())
                .flat_map(|param| [-1.0, 1.0].map(|sign| changed_car(param, sign)))
                .collect();
            let fuels = fuels(&cars, cycle, &conditions);
            let percent = |now: Option<f64>| finite(100.0 * (now? / base? - 1.0));
            let effect = |(param, sides): (&Param, &[Option<f64>])| Effect {
                car: car.name.clone(),
                key: param.key().to_owned(),
                lowered_percent: sides.first().copied().and_then(percent),
                raised_percent: sides.last().copied().and_then(percent),
            };
            params.iter().zip(fuels.chunks(2)).map(effect).collect()
        };
        // Both sides of some values are driven together.
        let found: Vec<Vec<Effect>> = params.par_chunks(MAX_TOGETHER / 2).map(of_params).collect();
        let found = found.into_iter().flatten();
        effects.extend(found);
    }
    Ok(Sensitivity {
        step_percent: STEP_PERCENT,
        effects,
    })
}

/// A value lowered (`sign` -1) or raised (+1) by the step; an efficiency through its loss.
fn changed(key: &str, value: f64, sign: f64) -> f64 {
    let step = STEP_PERCENT / 100.0;
    if unit_of(key) == "\u{b0}C" {
        return value + sign * STEP_K;
    }
    if key.ends_with("efficiency") && (0.0..1.0).contains(&value) {
        1.0 - (1.0 - value) * (1.0 - sign * step)
    } else {
        value * (1.0 + sign * step)
    }
}

/// Headline fuel of the car, L/100 km.
fn fuel(setup: &Setup, cycle: &Cycle, conditions: &Conditions) -> Option<f64> {
    headline(setup, cycle, &drive(setup, cycle, conditions))
}

/// Headline fuel of each car that there is, L/100 km; they are driven side by side.
fn fuels(cars: &[Option<Setup>], cycle: &Cycle, conditions: &Conditions) -> Vec<Option<f64>> {
    let run = |setup| Run {
        vehicle: setup,
        conditions: *conditions,
    };
    let runs: Vec<Run> = (cars.iter().flatten())
        .map(|setup| run(&setup.vehicle))
        .collect();
    let mut outcomes = drive_each(&runs, cycle).into_iter();
    let mut fuel = |setup: &Setup| headline(setup, cycle, &outcomes.next()?);
    cars.iter()
        .map(|setup| setup.as_ref().and_then(&mut fuel))
        .collect()
}

/// Headline fuel of a drive, L/100 km.
fn headline(setup: &Setup, cycle: &Cycle, outcome: &Outcome) -> Option<f64> {
    let driven = Driven {
        name: &setup.name,
        setup,
        outcome,
    };
    run_summary(cycle, "subject", &Settings::default(), &driven).headline_fuel()
}

#[cfg(test)]
mod tests {
    use super::changed;

    #[test]
    fn an_efficiency_changes_by_its_loss() {
        assert!((changed("a.mesh_efficiency", 0.98, -1.0) - 0.979).abs() < 1e-12);
        assert!((changed("a.mesh_efficiency", 0.98, 1.0) - 0.981).abs() < 1e-12);
        assert!((changed("a.opens_degc", 80.0, -1.0) - 75.0).abs() < 1e-12);
        assert!((changed("a.mass_kg", 1000.0, -1.0) - 950.0).abs() < 1e-9);
        assert!(
            (changed("a.efficiency", 1.0, -1.0) - 0.95).abs() < 1e-12,
            "without a loss there is nothing else to change"
        );
    }
}
