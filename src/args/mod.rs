//! Words of the command line to checked values. Problems are collected, never the first one only.

pub mod ranges;
pub mod sniff;

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use cvtcycle::config::cycle;
pub use cvtcycle::config::cycle::{bytes, find as cycle, is_csv};
use cvtcycle::config::setup::{Kind, is_path};
use cvtcycle::config::{Bound, Problem, Problems, near, unit_of};

/// Takes any text, but lets completions offer the known names: unknown ones are reported with all other problems.
#[derive(Clone, Copy, Debug)]
pub struct Offering(pub fn() -> Vec<&'static str>);

impl TypedValueParser for Offering {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.0)().into_iter().map(PossibleValue::new)))
    }
}

/// Names of the embedded cycles.
pub fn cycles() -> Vec<&'static str> {
    cycle::names().to_vec()
}

/// Names of the embedded vehicles.
pub fn vehicles() -> Vec<&'static str> {
    Kind::Vehicle.names()
}

/// Names of the embedded vehicles, and `none`.
pub fn baselines() -> Vec<&'static str> {
    vehicles().into_iter().chain(["none"]).collect()
}

/// Names of the embedded lubricants.
pub fn lubricants() -> Vec<&'static str> {
    Kind::Lubricant.names()
}

/// Names of the embedded rigs.
pub fn rigs() -> Vec<&'static str> {
    Kind::Rig.names()
}

/// A problem of an option's value.
pub fn bad_value(
    option: &str,
    value: &str,
    allowed: &str,
    message: String,
    hint: String,
) -> Problem {
    Problem::invalid(message)
        .in_file(option)
        .key(option)
        .value(value)
        .allowed(allowed)
        .hint(hint)
}

/// The value as a word between backquotes; an empty one is called so.
fn quoted(value: &str) -> String {
    if value.is_empty() {
        "an empty value".to_owned()
    } else {
        format!("`{value}`")
    }
}

/// A finite number within its range; `suffix` is that of a key with the same unit.
pub fn number(option: &str, value: &str, allowed: Bound, suffix: &str) -> Result<f64, Problems> {
    let unit = unit_of(suffix);
    let range = allowed.in_unit(unit);
    match value.trim().parse::<f64>() {
        Ok(x) if allowed.contains(x) => Ok(x),
        Ok(x) if x.is_finite() => {
            let message = format!("{} is out of range", quoted(value));
            Err(bad_value(option, value, &range, message, String::new()).into())
        }
        parsed => {
            let what = if parsed.is_ok() {
                "not a finite number"
            } else {
                "not a number"
            };
            let message = format!("{} is {what}", quoted(value));
            Err(bad_value(
                option,
                value,
                &range,
                message,
                number_hint(option, value, unit),
            )
            .into())
        }
    }
}

/// What people write behind a temperature in degC or a time in s.
const UNITS: [&str; 7] = ["c", "°c", "degc", "celsius", "s", "sec", "seconds"];

fn number_hint(option: &str, value: &str, unit: &str) -> String {
    let pointed = value.trim().replacen(',', ".", 1);
    if value.contains(',') && pointed.parse::<f64>().is_ok() {
        return format!("write a decimal point: {option} {pointed}");
    }
    // Only where what follows is a unit: a digit mistyped as a letter must not be cut off.
    let rest = value
        .trim()
        .trim_start_matches(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let figure = value.trim().trim_end_matches(rest);
    if UNITS.contains(&rest.trim().to_lowercase().as_str()) && figure.parse::<f64>().is_ok() {
        return format!("write the number alone, in {unit}: {option} {figure}");
    }
    format!("write a number in {unit}")
}

/// One of some words.
pub fn word<T: Copy>(
    option: &str,
    value: &str,
    known: &[(&'static str, T)],
) -> Result<T, Problems> {
    if let Some((_, found)) = known.iter().find(|(name, _)| *name == value) {
        return Ok(*found);
    }
    let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
    let hint = did_you_mean(value, &names).unwrap_or_default();
    Err(bad_value(
        option,
        value,
        &format!("one of {}", names.join(", ")),
        format!("{} is not known", quoted(value)),
        hint,
    )
    .into())
}

/// Question for the known names that are like the given one.
pub fn did_you_mean(value: &str, known: &[&str]) -> Option<String> {
    let close = near(value, known.iter().copied());
    (!close.is_empty()).then(|| format!("did you mean {}?", close.join(" or ")))
}

/// The file that a file names, seen from the current directory: its own folder is where its paths begin.
pub fn beside(file: &str, named: &str) -> String {
    let folder = std::path::Path::new(file)
        .parent()
        .filter(|_| is_path(file) && is_path(named));
    folder.map_or_else(
        || named.to_owned(),
        |folder| folder.join(named).to_string_lossy().into_owned(),
    )
}
