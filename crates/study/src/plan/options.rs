//! What the run options allow. The same checks hold for the head of a plan and for factors.

use std::sync::Arc;

use super::{FactorValue, RUN_OPTIONS};
use cvtcycle_config::cycle;
use cvtcycle_config::setup::{AMBIENT, embedded_lubricants, embedded_vehicles, is_path};
use cvtcycle_config::{Bound, RawValue, did_you_mean, unit_of};
use cvtcycle_model::keys::Quantity;
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// Range of start temperatures, degC.
const START: Bound = Bound::closed(-40.0, 130.0);
/// Range of the longest step, s.
const STEP: Bound = Bound::closed(0.01, 10.0);

/// Words of `start`.
const STARTS: [&str; 2] = ["soak", "warm"];

/// Whether a factor's key is a run option.
pub(super) fn is_option(key: &str) -> bool {
    RUN_OPTIONS.contains(&key)
}

/// Range of a run option's numbers; none for those that are words.
pub(super) fn bound(option: &str) -> Option<Bound> {
    match option {
        "ambient_degc" => Some(AMBIENT),
        "start" => Some(START),
        "dt_s" => Some(STEP),
        _ => None,
    }
}

/// A key that ends in the unit of an option's numbers.
pub(super) fn quantity(option: &str) -> &str {
    if option == "start" {
        "start_degc"
    } else {
        option
    }
}

/// What an option allows, in words.
pub(super) fn allowed(option: &str) -> String {
    let numbers = bound(option).map(|bound| bound.in_unit(unit_of(quantity(option))));
    match (option, numbers) {
        ("start", Some(numbers)) => format!("{}, or {numbers}", STARTS.join(", ")),
        (_, Some(numbers)) => numbers,
        ("formulation", None) => Formulation::NAMES.map(|(name, _)| name).join(", "),
        ("cycle", None) => {
            "a name of `cvtcycle list cycles`, constant_V with V in km/h, or the path of a CSV file"
                .to_owned()
        }
        ("vehicle", None) => format!(
            "{}, or the path of a TOML file",
            names(embedded_vehicles()).join(", ")
        ),
        _ => format!(
            "{}, or the path of a TOML file",
            names(embedded_lubricants()).join(", ")
        ),
    }
}

/// The value of an option (or of `vehicle`) as written; none, and reported, if it cannot be one.
pub(super) fn value(option: &str, written: &RawValue) -> Option<FactorValue> {
    if let Some(bound) = bound(option)
        && (option != "start" || written.is_number())
    {
        return written
            .number(Quantity::of(quantity(option)), bound)
            .map(FactorValue::Number);
    }
    let Some(word) = written.word() else {
        written.wrong_type(if option == "start" {
            "soak, warm or a number"
        } else {
            "text"
        });
        return None;
    };
    let known: Vec<&str> = match option {
        "start" => STARTS.to_vec(),
        "formulation" => Formulation::NAMES.map(|(name, _)| name).to_vec(),
        "cycle" => cycle::names().to_vec(),
        "vehicle" => names(embedded_vehicles()),
        _ => names(embedded_lubricants()),
    };
    if let Some(why) = unknown(option, word, &known) {
        written.complain(&allowed(option), &why, &hint(option, word, &known));
        return None;
    }
    Some(FactorValue::Word(Arc::from(word)))
}

/// Why a word is none that an option knows.
fn unknown(option: &str, word: &str, known: &[&str]) -> Option<String> {
    let names_file = !matches!(option, "start" | "formulation");
    if option == "cycle"
        && !cycle::is_csv(word)
        && let Some(constant) = cycle::constant_speed(word)
    {
        return constant
            .err()
            .map(|problem| format!("`{word}`: {}", problem.message));
    }
    if known.contains(&word) || (names_file && is_path(word)) {
        return None;
    }
    let kind = match option {
        "engine_oil" => "lubricant",
        other => other,
    };
    Some(if names_file {
        format!("there is no {kind} named `{word}`")
    } else {
        format!("`{word}` is not known for `{option}`")
    })
}

fn hint(option: &str, word: &str, known: &[&str]) -> String {
    let question = did_you_mean(word, known.iter().copied()).unwrap_or_default();
    match option {
        "start" if word.trim().parse::<f64>().is_ok() => {
            format!("write {} without quotes", word.trim())
        }
        "vehicle" if word == "none" => "write baselines = []".to_owned(),
        "cycle" if word.starts_with("constant_") => "write, for example, constant_90".to_owned(),
        "start" | "formulation" => question,
        _ if question.is_empty() => "a path needs a / or an ending".to_owned(),
        _ => format!("{question} a path needs a / or an ending"),
    }
}

fn names(embedded: &'static [(&'static str, &'static str)]) -> Vec<&'static str> {
    embedded.iter().map(|(name, _)| *name).collect()
}
