//! What a page says besides its figures: what the levers leave, and the command that gives the same numbers.

use cvtcycle_output::Flags;
use cvtcycle_output::number::fixed;
use cvtcycle_output::summary::RunSummary;

use super::answer::DRAWS;
use super::controls::{Control, Kind, Slider};
use super::scene::{Scene, State};
use crate::number::{Quantity, capital_first, words};

/// Flags that say that a number is not that of a car that works.
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

/// Levers beyond what is known, a sentence each.
pub(super) fn beyond(controls: &[Control], state: &State) -> Vec<String> {
    let of = |control: &Control| {
        let Kind::Slider(slider) = &control.kind else {
            return None;
        };
        let value: f64 = state.levers.get(&control.name)?.parse().ok()?;
        (!slider.knows(value)).then(|| {
            format!(
                "{} {}: outside {}, the range of the shipped levers and of the plan of uncertainty; the model is not supported there.",
                control.title,
                with_unit(slider, value),
                known(slider)
            )
        })
    };
    controls.iter().filter_map(of).collect()
}

/// What the chosen changes take, a sentence each.
pub(super) fn needs(controls: &[Control], state: &State) -> Vec<String> {
    let of = |control: &Control| {
        let Kind::Choice(changes) = &control.kind else {
            return None;
        };
        let name = state.levers.get(&control.name)?;
        let change = changes.iter().find(|change| change.name == *name)?;
        let needs = change.needs.trim_end_matches('.');
        (!needs.is_empty()).then(|| format!("{} takes: {needs}.", capital_first(&change.title)))
    };
    controls.iter().filter_map(of).collect()
}

/// A value of a slider with its unit.
pub fn with_unit(slider: &Slider, value: f64) -> String {
    let number = fixed(Some(value), slider.decimals());
    format!("{number} {}", slider.unit).trim_end().to_owned()
}

/// The range of a slider that something is known of, in words.
pub fn known(slider: &Slider) -> String {
    let [low, high] = slider.known.map(|x| fixed(Some(x), slider.decimals()));
    format!("{low} to {high} {}", slider.unit)
        .trim_end()
        .to_owned()
}

/// The command that prints the numbers of a state: overrides in the order in which the page has them, then the cars.
pub(super) fn command(
    scene: &Scene,
    state: &State,
    set: &[String],
    baselines: &[String],
) -> String {
    let mut list: Vec<&str> = vec!["cvtcycle", "run", "--vehicle", &scene.vehicle];
    let mut option = |name: &'static str, value| list.extend([name, value]);
    let ambient = state.ambient_degc.to_string();
    let (dt, draws) = (scene.dt_s.to_string(), DRAWS.to_string());
    option("--cycle", &state.cycle);
    option("--ambient", &ambient);
    option("--start", &scene.start);
    if (scene.dt_s - 1.0).abs() > 0.0 {
        option("--dt", &dt);
    }
    if scene.formulation().name() != "smooth" {
        option("--formulation", &scene.formulation);
    }
    for text in &scene.set_all {
        option("--set-all", text);
    }
    for text in set {
        option("--set", text);
    }
    if let Some(oil) = &state.lubricant {
        option("--lubricant", oil);
    }
    if let Some(oil) = &scene.engine_oil {
        option("--engine-oil", oil);
    }
    for name in baselines {
        option("--baseline", name);
    }
    match baselines.is_empty() {
        true => option("--baseline", "none"),
        false => option("--draws", &draws),
    }
    let quoted = list.into_iter().map(quoted);
    quoted.collect::<Vec<_>>().join(" ")
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-+=./:,%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}
