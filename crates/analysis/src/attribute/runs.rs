//! The drives of a car with changed losses, and the fuel that they save.

use super::{Attribution, Fuel, shapley};
use cvtcycle_model::drive::{Conditions, MAX_TOGETHER, Outcome, Run, Vehicle, drive_each};
use cvtcycle_model::transmission::component::LossGroup;
use cvtcycle_model::transmission::loss_factor::LossFactors;
use cvtcycle_output::Component;
use cvtcycle_output::number::{finite, plain};
use cvtcycle_output::summary::{
    Driven, Failure, LossPrice, Named, PairPrice, RunSummary, Saving, run_summary,
};
use rayon::prelude::*;

/// A drive with changed losses.
pub(super) struct Burnt {
    pub(super) fuel: Fuel,
    /// Energy at the wheels, kJ.
    pub(super) wheels_kj: f64,
    failures: Vec<Failure>,
}

impl Burnt {
    fn from_run(run: &RunSummary) -> Self {
        let phases = run.phases.iter().map(|phase| phase.fuel_l_per_100km);
        let fuel = std::iter::once(run.headline_fuel()).chain(phases);
        Burnt {
            fuel: fuel.map(|litres| litres.unwrap_or(f64::NAN)).collect(),
            wheels_kj: run.ledger_kj.get("wheels").unwrap_or(f64::NAN),
            failures: run.failures.clone(),
        }
    }
}

pub(super) fn minus(a: &[f64], b: &[f64]) -> Fuel {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The drives of one car.
pub(super) struct Runs<'a> {
    of: &'a Attribution<'a>,
    pub(super) numbers: &'a RunSummary,
    pub(super) base: Burnt,
}

impl<'a> Runs<'a> {
    pub(super) fn new(of: &'a Attribution<'a>, numbers: &'a RunSummary) -> Self {
        let base = Burnt::from_run(numbers);
        Runs { of, numbers, base }
    }

    /// Drives with each of the factors on the losses; the results in their order.
    pub(super) fn drive<const LISTS: usize>(
        &self,
        changed: [Vec<LossFactors>; LISTS],
    ) -> [Vec<Burnt>; LISTS] {
        let of = self.of;
        let conditions = Conditions {
            keep_rows: false,
            ..of.conditions
        };
        // Some at a time, which are driven side by side.
        let some = |factors: &[LossFactors]| -> Vec<Burnt> {
            let cars: Vec<Vehicle> = (factors.iter())
                .map(|factors| of.setup.with_losses_times(factors))
                .collect();
            let runs: Vec<Run> = (cars.iter())
                .map(|vehicle| Run {
                    vehicle,
                    conditions,
                })
                .collect();
            let burnt = |outcome: &Outcome| {
                let driven = Driven {
                    name: &self.numbers.vehicle,
                    setup: of.setup,
                    outcome,
                };
                let role = &self.numbers.role;
                Burnt::from_run(&run_summary(of.cycle, role, of.settings, &driven))
            };
            drive_each(&runs, of.cycle).iter().map(burnt).collect()
        };
        let counts = changed.each_ref().map(Vec::len);
        let burnt: Vec<Vec<Burnt>> = (changed.concat())
            .par_chunks(MAX_TOGETHER)
            .map(some)
            .collect();
        let burnt: Vec<Burnt> = burnt.into_iter().flatten().collect();
        let mut burnt = burnt.into_iter();
        counts.map(|count| burnt.by_ref().take(count).collect())
    }

    /// Fuel saved by a change (AT-1, AT-2).
    pub(super) fn saved(&self, run: &Burnt) -> Fuel {
        minus(&self.base.fuel, &run.fuel) // AT-1, AT-2
    }

    pub(super) fn saving(&self, saved: &[f64]) -> Saving {
        let phases = self.numbers.phases.iter().zip(saved.iter().skip(1));
        Saving {
            l_per_100km: finite(saved[0]),
            percent: finite(100.0 * saved[0] / self.base.fuel[0]),
            phases: phases
                .map(|(phase, litres)| (&*phase.name, finite(*litres)))
                .collect::<Named>(),
        }
    }

    pub(super) fn loss(&self, own: Component, price: &[f64], alone: Option<Saving>) -> LossPrice {
        let loss_kj = self.numbers.loss_kj.get(own.name());
        let percent = |kj: f64| finite(100.0 * kj / self.numbers.fuel_energy_kj);
        LossPrice {
            group: own.group().name().to_owned(),
            loss_kj,
            energy_percent: loss_kj.and_then(percent),
            saved: self.saving(price),
            range: None,
            alone,
        }
    }

    /// Two losses with their own prices, from a drive with both changed (AT-4).
    pub(super) fn pair(
        &self,
        [(a, of_a), (b, of_b)]: [(Component, &[f64]); 2],
        both: &Burnt,
    ) -> PairPrice {
        let more = minus(&minus(&self.saved(both), of_a), of_b); // AT-4
        PairPrice {
            a: a.name().to_owned(),
            b: b.name().to_owned(),
            a_with_b: finite(of_a[0]),
            a_without_b: finite(of_a[0] + more[0]), // AT-4
            b_with_a: finite(of_b[0]),
            b_without_a: finite(of_b[0] + more[0]), // AT-4
            interaction: self.saving(&more),
        }
    }

    /// Shares of groups from the drives of all their sets, in the order of the bits of a set (AT-6).
    pub(super) fn shares(&self, groups: &[LossGroup], sets: &[Burnt]) -> Vec<(String, Saving)> {
        let worth: Vec<Fuel> = sets.iter().map(|run| self.saved(run)).collect();
        let shares = shapley(groups.len(), &worth);
        let named = groups.iter().zip(&shares);
        named
            .map(|(group, share)| (group.name().to_owned(), self.saving(share)))
            .collect()
    }

    /// Checks that the car fails without a loss only.
    pub(super) fn new_failures(
        &self,
        components: &[Component],
        single: &[Burnt],
        all: &[Burnt],
    ) -> Vec<String> {
        let with = match self.of.factor {
            factor if factor > 0.0 => format!("with {} times ", plain(factor)),
            _ => "without ".to_owned(),
        };
        let names = components.iter().map(|c| c.name()).chain(["all losses"]);
        let changed = names.zip(single.iter().chain(all));
        let new = |(name, run): (&str, &Burnt)| {
            let before = &self.base.failures;
            let is_new = |failure: &&Failure| before.iter().all(|own| own.check != failure.check);
            let found = run.failures.iter().filter(is_new);
            found
                .map(|failure| format!("{with}{name}: {}", failure.brief()))
                .collect::<Vec<_>>()
        };
        changed.flat_map(new).collect()
    }
}
