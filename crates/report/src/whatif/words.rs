//! Sentences of a page on limits left by the levers.

use cvtcycle_output::Flags;
use cvtcycle_output::summary::RunSummary;

use crate::live_section::{Control, ControlKind, State};
use crate::number::{Quantity, capital_first, words};

/// Flags of a car that does not work.
const BAD: [Flags; 6] = [
    Flags::MISSED_TRACE,
    Flags::GROSS_SLIP,
    Flags::LOW_CLAMP,
    Flags::FLOW_LIMITED,
    Flags::OVERSPEED,
    Flags::TOO_HOT,
];

/// Failed checks of the subject, and each flag that it has for longer than the car of the file, with its meaning.
pub(super) fn flags(run: &RunSummary, of_file: Option<&RunSummary>) -> Vec<String> {
    let failed = run.failures.iter();
    let failed = failed.map(|failure| capital_first(&run.failure_text(failure)) + ".");
    let seconds = |run: &RunSummary, name: &str| run.flags_s.get(name).unwrap_or(0.0);
    let bad = Flags::NAMES.iter().zip(Flags::MEANINGS);
    let bad = bad.filter(|((flag, name), _)| {
        BAD.contains(flag) && !run.failed_checks.iter().any(|check| check == name)
    });
    let bad = bad.filter_map(|((_, name), meaning)| {
        let own = seconds(run, name);
        let before = of_file.map_or(0.0, |run| seconds(run, name));
        (own > before).then(|| {
            let than = match of_file {
                Some(_) if before > 0.0 => {
                    format!(" (as its file has it: {})", Quantity::Seconds.text(before))
                }
                _ => String::new(),
            };
            format!(
                "{} for {}{than}: {meaning}.",
                capital_first(&words(name)),
                Quantity::Seconds.text(own)
            )
        })
    });
    failed.chain(bad).collect()
}

/// Levers outside their known range, a sentence each.
pub(super) fn beyond(controls: &[Control], state: &State) -> Vec<String> {
    let sentence = |control: &Control| {
        let ControlKind::Slider(slider) = &control.kind else {
            return None;
        };
        let value: f64 = state.levers.get(&control.name)?.parse().ok()?;
        (!slider.knows(value)).then(|| {
            format!(
                "{} {}: outside {}, the range of the shipped levers and of the plan of uncertainty; the model is not supported there.",
                control.title,
                slider.with_unit(value),
                slider.known_text()
            )
        })
    };
    controls.iter().filter_map(sentence).collect()
}

/// Requirements sentence the chosen changes, a sentence each.
pub(super) fn needs(controls: &[Control], state: &State) -> Vec<String> {
    let sentence = |control: &Control| {
        let ControlKind::Choice(changes) = &control.kind else {
            return None;
        };
        let name = state.levers.get(&control.name)?;
        let change = changes.iter().find(|change| change.name == *name)?;
        let needs = change.needs.trim_end_matches('.');
        (!needs.is_empty()).then(|| format!("{} takes: {needs}.", capital_first(&change.title)))
    };
    controls.iter().filter_map(sentence).collect()
}
