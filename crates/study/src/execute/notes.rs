//! What the results of a study do not show, a sentence each.

use super::cars::{Binding, StudyCar, words};
use crate::plan::Plan;

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
