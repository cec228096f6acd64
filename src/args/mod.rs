//! The command line: groups of options that several commands share, and their texts as checked values.

pub mod groups;
pub mod input_kind;
pub mod output;
pub mod problems;
pub mod ranges;

pub use groups::{
    AmbientArgs, AmbientsArgs, ColumnsArgs, ComparisonArgs, ConfidenceArgs, CycleArgs, DriveArgs,
    DrivingArgs, FormulationArgs, ThreadArgs, VehicleArgs,
};
pub use output::{JsonArgs, OutArgs, OutputArgs, ResultArgs, TableOutputArgs};

use std::ops::RangeInclusive;
use std::path::absolute;

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use cvtcycle::config::bounded::Limit;
use cvtcycle::config::setup::is_path;
use cvtcycle::config::{Argument, Bound, Problem, Problems, cycle, unit_of};

use problems::{bad_value, cite, did_you_mean};

/// Takes any text, but offers known names to shell completions: an unknown name is reported with all other problems.
#[derive(Clone, Copy, Debug)]
pub struct Names(pub fn() -> Vec<&'static str>);

impl TypedValueParser for Names {
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

/// Names of the choices of an option.
pub fn choice_names<T>(list: &[(&'static str, T)]) -> Vec<&'static str> {
    list.iter().map(|(name, _)| *name).collect()
}

/// Names of the embedded cycles.
pub fn cycles() -> Vec<&'static str> {
    cycle::names().to_vec()
}

/// Puts the value in backquotes.
fn quoted(value: &str) -> String {
    if value.is_empty() {
        "an empty value".to_owned()
    } else {
        format!("`{value}`")
    }
}

/// Parses a finite number within its range; `suffix` is that of a key with the same unit.
pub fn number(option: &str, value: &str, range: Bound, suffix: &str) -> Result<f64, Problems> {
    let unit = unit_of(suffix);
    let bad = |what: &str, hint: &str| {
        let message = format!("{} is {what}", quoted(value));
        Err(bad_value(option, value, &range.in_unit(unit), &message, hint).into())
    };
    match value.trim().parse::<f64>() {
        Ok(x) if range.contains(x) => Ok(x),
        Ok(x) if x.is_finite() => bad("out of range", &nearest(range, x, unit)),
        Ok(_) => bad("not a finite number", &number_hint(option, value, unit)),
        Err(_) => bad("not a number", &number_hint(option, value, unit)),
    }
}

/// Hint for a number out of its range. Empty where the nearer end is excluded.
fn nearest(range: Bound, x: f64, unit: &str) -> String {
    let end = match x > range.high() {
        true => range.high(),
        false if range.includes_low() => range.low(),
        false => return String::new(),
    };
    let unit = if unit == "-" { "" } else { unit };
    format!(
        "the nearest allowed value is {}",
        format!("{end} {unit}").trim_end()
    )
}

/// Parses an integer within its range.
pub fn count(option: &str, value: &str, range: RangeInclusive<u64>) -> Result<u64, Problem> {
    let (low, high) = (*range.start(), *range.end());
    let bad = |what: &str, hint: &str| {
        let (message, allowed) = (
            format!("{} is {what}", quoted(value)),
            format!("{low} to {high}"),
        );
        Err(bad_value(option, value, &allowed, &message, hint))
    };
    let Ok(number) = value.trim().parse::<i128>() else {
        return bad(
            "not a whole number",
            &format!("write a whole number: {option} {low}"),
        );
    };
    match u64::try_from(number) {
        Ok(number) if range.contains(&number) => Ok(number),
        _ => {
            let end = if number < i128::from(low) { low } else { high };
            bad(
                "out of range",
                &format!("the nearest allowed value is {end}"),
            )
        }
    }
}

/// As [`count`], for an optional argument.
pub fn count_if_given(
    option: &str,
    value: Option<&String>,
    range: RangeInclusive<u64>,
    problems: &mut Problems,
) -> Option<u64> {
    value.and_then(|value| problems.take(count(option, value, range)))
}

/// Units that users write after a temperature in degC or a time in s.
const UNITS: [&str; 7] = ["c", "°c", "degc", "celsius", "s", "sec", "seconds"];

fn number_hint(option: &str, value: &str, unit: &str) -> String {
    let pointed = value.trim().replacen(',', ".", 1);
    if value.contains(',') && pointed.parse::<f64>().is_ok() {
        return format!("write a decimal point: {option} {pointed}");
    }
    // Cuts off known units only, so that a letter typed in place of a digit stays in the message.
    let rest = value
        .trim()
        .trim_start_matches(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let figure = value.trim().trim_end_matches(rest);
    if UNITS.contains(&rest.trim().to_lowercase().as_str()) && figure.parse::<f64>().is_ok() {
        return format!("write the number alone, in {unit}: {option} {figure}");
    }
    format!("write a number in {unit}")
}

/// Looks up a choice by name.
pub fn one_of<T: Copy>(
    option: &str,
    value: &str,
    known: &[(&'static str, T)],
) -> Result<T, Problems> {
    if let Some((_, found)) = known.iter().find(|(name, _)| *name == value) {
        return Ok(*found);
    }
    let names = choice_names(known);
    let allowed = format!("one of {}", names.join(", "));
    let message = format!("{} is not known", quoted(value));
    let hint = did_you_mean(value, &names);
    Err(bad_value(option, value, &allowed, &message, &hint).into())
}

/// Reads the bytes of a file named by an option.
pub fn bytes(option: &str, path: &str, limit: Limit) -> Result<Vec<u8>, Problems> {
    cycle::bytes(Argument::File, path, limit).map_err(|found| cite(option, found))
}

/// Converts a name or path of the command line for use in a plan. Relative paths start at the current folder there, and at the plan's own folder in a plan.
pub fn word_for_plan(word: &str) -> String {
    match is_path(word) {
        true => absolute(word).map_or_else(|_| word.to_owned(), |path| path.display().to_string()),
        false => word.to_owned(),
    }
}
