//! What the results of a study do not show, a sentence each.

use super::cars::{Binding, StudyCar, words};
use crate::plan::{Factor, Plan};
use cvtcycle_config::setup::is_twin;

/// Names of factors that a sentence lists.
const MOST_NAMES: usize = 10;

/// The factors that do not act on a car though they are of its kind, in a sentence; none where all act.
pub fn idle(vehicle: &str, car: &StudyCar, factors: &[Factor]) -> Option<String> {
    let names = car.idle.iter().map(|f| factors[*f].name.as_str());
    let first: Vec<&str> = names.take(MOST_NAMES).collect();
    let more = match car.idle.len().saturating_sub(MOST_NAMES) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    (!first.is_empty()).then(|| {
        format!(
            "{vehicle}: {} of {} factors do not act on it, which has no such key, a list of another length, or 0 of which a share is drawn: {}{more}",
            car.idle.len(),
            factors.len(),
            first.join("; ")
        )
    })
}

/// What no factor of a study of draws moves in its cars: factors that do not act, and the shift speeds of a twin, which no file has.
pub(super) fn not_drawn(plan: &Plan, cars: &[StudyCar]) -> Vec<String> {
    if !plan.design.is_sampled() {
        return Vec::new();
    }
    let of_car = |car: &StudyCar| {
        let shifts = is_twin(&car.word).then(|| {
            format!(
                "{}: its shift speeds (TW-3, assumed) are in no factor; the key twin.shift_kmh sets them",
                car.name
            )
        });
        [idle(&car.name, car, &plan.factors), shifts]
            .into_iter()
            .flatten()
    };
    cars.iter().flat_map(of_car).collect()
}

/// What is to be said of a car with every word of a factor, and not of the car without: of oils, that none has a friction of its own.
pub(super) fn notes(plan: &Plan, cars: &[StudyCar]) -> Vec<String> {
    let mut list: Vec<String> = Vec::new();
    for car in cars {
        for (index, binding) in car.bindings.iter().enumerate() {
            let Binding::Words { stride } = binding else {
                continue;
            };
            let factor = &plan.factors[index];
            let of = |variant: usize| {
                let variant = car.variant(variant, &plan.factors);
                variant.map_or(&[][..], |variant| variant.setup.notes.as_slice())
            };
            let all = (1..=words(factor).len()).map(|k| of(k * stride));
            let by_each = |note: &&String| {
                !of(0).contains(note) && all.clone().all(|notes| notes.contains(note))
            };
            let said = of(*stride).iter().filter(by_each);
            let said = said.map(|note| format!("{}: {note}", factor.name));
            list.extend(said.filter(|note| !list.contains(note)).collect::<Vec<_>>());
        }
    }
    list
}
