//! Plans that the program carries, and those that the user names by their path.

use super::options::did_you_mean;
use cvtcycle_config::setup::is_path;
use cvtcycle_config::{Place, Problem, Problems, bounded, decode};

/// Embedded plans: name and TOML text.
#[must_use]
pub fn embedded_plans() -> &'static [(&'static str, &'static str)] {
    &[
        (
            "oil_at_minus_10",
            include_str!("../../../../plans/oil_at_minus_10.toml"),
        ),
        (
            "pump_and_offset",
            include_str!("../../../../plans/pump_and_offset.toml"),
        ),
        (
            "uncertainty_rover",
            include_str!("../../../../plans/uncertainty_rover.toml"),
        ),
    ]
}

/// The name under which problems cite a plan, and its text.
///
/// # Errors
/// Unknown name (with the near ones), unreadable path, binary or empty file.
pub(super) fn text_of(word: &str, option: &str) -> Result<(String, String), Problems> {
    let problem = |allowed: String, message: String, hint: String| {
        let place = Place {
            file: option.to_owned(),
            ..Place::default()
        };
        Problem::invalid(message)
            .at(place)
            .key(option)
            .value(word)
            .allowed(allowed)
            .hint(hint)
            .into()
    };
    if is_path(word) {
        let bytes = bounded::read(word, bounded::TOML).map_err(|error| {
            let hint = error.hint("check the path and its permissions");
            problem(
                error.allowed("a readable file"),
                format!("cannot read `{word}`: {error}"),
                hint.into(),
            )
        })?;
        return Ok((word.to_owned(), decode(word, &bytes)?));
    }
    if let Some((name, text)) = embedded_plans().iter().find(|(name, _)| *name == word) {
        return Ok((format!("embedded:{name}.toml"), (*text).to_owned()));
    }
    let names: Vec<&str> = embedded_plans().iter().map(|(name, _)| *name).collect();
    let question = did_you_mean(word, names.iter().copied(), "");
    Err(problem(
        format!("{}, or the path of a TOML file", names.join(", ")),
        format!("there is no plan named `{word}`"),
        format!("{question} a path needs a / or an ending")
            .trim()
            .to_owned(),
    ))
}
