//! Limits of the results of a study, a sentence each.

use super::cars::{Binding, StudyCar, words};
use crate::plan::{Factor, Plan};
use cvtcycle_config::setup::contacts::NOT_MEASURED;
use cvtcycle_config::setup::is_twin;

/// Names of factors that a sentence lists.
const MAX_NAMES: usize = 10;

/// The factors that do not act on a car though they are of its kind, in a sentence; none where all act.
pub fn idle(vehicle: &str, car: &StudyCar, factors: &[Factor]) -> Option<String> {
    let names = car.idle.iter().map(|f| factors[*f].name.as_str());
    let first: Vec<&str> = names.take(MAX_NAMES).collect();
    let more = match car.idle.len().saturating_sub(MAX_NAMES) {
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

/// Lists inputs that no factor of a sampled study moves: factors without effect, and the shift speeds of a twin, which no file has.
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

/// Lists notes that hold for a car with every word of a factor but not without it: oils without a friction of their own. Contacts whose
/// friction was not measured are listed with the names of those oils.
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
            let said = said.filter(|note| !note.starts_with(NOT_MEASURED));
            let said = said.map(|note| format!("{}: {note}", factor.name));
            let fluids = (1..).zip(words(factor));
            let fluids = fluids.filter_map(|(k, word)| {
                let mut notes = of(k * stride).iter();
                let note = notes.find(|note| note.starts_with(NOT_MEASURED))?;
                Some((word.to_string(), note.as_str()))
            });
            let said = said.chain(by_note(&factor.name, fluids));
            list.extend(said.filter(|note| !list.contains(note)).collect::<Vec<_>>());
        }
    }
    list
}

/// Each note once, after the words for which it holds.
fn by_note<'n>(factor: &str, notes: impl Iterator<Item = (String, &'n str)>) -> Vec<String> {
    let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
    for (word, note) in notes {
        match groups.iter_mut().find(|(own, _)| *own == note) {
            Some((_, of)) => of.push(word),
            None => groups.push((note, vec![word])),
        }
    }
    let groups = groups.into_iter();
    let said = groups.map(|(note, of)| format!("{factor} {}: {note}", of.join(", ")));
    said.collect()
}
