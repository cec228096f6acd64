//! Values of the run options. The same checks hold for the head of a plan, for factors and for options of the command line.

use std::sync::Arc;

use cvtcycle_config::cycle;
use cvtcycle_config::setup::is_path;
use cvtcycle_config::{Problem, RawValue, did_you_mean};
use cvtcycle_model::keys::{Key, Kind};

use super::FactorValue;
use super::keys::{STUDY, known_words, numbers, run_option};

impl std::fmt::Display for FactorValue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FactorValue::Number(x) => write!(f, "{x}"),
            FactorValue::Word(word) => f.write_str(word),
        }
    }
}

impl FactorValue {
    /// The number; none of a word.
    pub fn number(&self) -> Option<f64> {
        match self {
            FactorValue::Number(x) => Some(*x),
            FactorValue::Word(_) => None,
        }
    }

    /// True for a number.
    pub fn is_number(&self) -> bool {
        self.number().is_some()
    }

    /// As a user would write it, words without quotes.
    pub fn text(&self) -> Arc<str> {
        match self {
            FactorValue::Number(x) => x.to_string().into(),
            FactorValue::Word(word) => word.clone(),
        }
    }

    /// The value of a run option, or else of `vehicle`, as written in the command line.
    ///
    /// ```
    /// use cvtcycle_study::plan::FactorValue;
    /// assert_eq!(FactorValue::of_option("ambient_degc", "-10"), Ok(FactorValue::Number(-10.0)));
    /// assert!(FactorValue::of_option("start", "warmed").is_err());
    /// ```
    ///
    /// # Errors
    /// A problem without a place: a word that is not known, or a number out of range.
    pub fn of_option(option: &str, written: &str) -> Result<Self, Problem> {
        let written = written.trim();
        let row = run_option(option).unwrap_or(&STUDY.vehicle);
        let found = match (numbers(&row.kind), written.parse::<f64>()) {
            (Some(range), Ok(x)) if range.contains(x) => Ok(FactorValue::Number(x)),
            (Some(_), Ok(_)) => Err(Problem::out_of_range(format!("`{option}` is out of range"))),
            (Some(_), Err(_)) if matches!(row.kind, Kind::Number(_)) => {
                Err(Problem::wrong_type(format!("`{written}` is no number")))
            }
            _ => word(row, written).map_err(|(why, hint)| Problem::unknown_name(why).hint(hint)),
        };
        found.map_err(|problem| problem.value(written).allowed(row.allowed()))
    }
}

/// The value of a row of the head as written; none, and reported, if it cannot be one.
pub(super) fn value(row: &Key, written: &RawValue) -> Option<FactorValue> {
    let range = numbers(&row.kind);
    if let Some(range) = range
        && (written.is_number() || matches!(row.kind, Kind::Number(_)))
    {
        return written.number(row.quantity, range).map(FactorValue::Number);
    }
    let Some(text) = written.word() else {
        match range {
            Some(_) => written.wrong_type(&format!("{} or a number", known_words(row).join(", "))),
            None => written.wrong_type("text"),
        }
        return None;
    };
    word(row, text)
        .map_err(|(why, hint)| written.unknown_name(&row.allowed(), &why, &hint))
        .ok()
}

/// A word that a row accepts; else what is wrong with it, and a hint.
fn word(row: &Key, word: &str) -> Result<FactorValue, (String, String)> {
    let is_name = matches!(row.kind, Kind::Name(_));
    let known = known_words(row);
    let good = || Ok(FactorValue::Word(Arc::from(word)));
    let question = || did_you_mean(word, known.iter().copied()).unwrap_or_default();
    let path = "a path needs a / or an ending";
    let hint = match (row.name, question()) {
        ("start", _) if word.trim().parse::<f64>().is_ok() => {
            format!("write {} without quotes", word.trim())
        }
        ("vehicle", _) if word == "none" => "write baselines = []".to_owned(),
        ("cycle", _) if word.starts_with("constant_") => {
            "write, for example, constant_90".to_owned()
        }
        (_, question) if !is_name => question,
        (_, question) if question.is_empty() => path.to_owned(),
        (_, question) => format!("{question} {path}"),
    };
    if row.name == "cycle"
        && !cycle::is_csv(word)
        && let Some(constant) = cycle::constant_speed(word)
    {
        return match constant {
            Ok(_) => good(),
            Err(problem) => Err((format!("`{word}`: {}", problem.message), hint)),
        };
    }
    if known.contains(&word) || (is_name && is_path(word)) {
        return good();
    }
    let kind = if row.name == "engine_oil" {
        "lubricant"
    } else {
        row.name
    };
    let why = match is_name {
        true => format!("there is no {kind} named `{word}`"),
        false => format!("`{word}` is not known for `{}`", row.name),
    };
    Err((why, hint))
}
