//! A cycle by its name, or a file of the user.

use super::{Cycle, constant_speed, embedded, names, read_csv};
use crate::bounded::{self, Limit};
use crate::setup::is_path;
use crate::{Place, Problem, Problems, did_you_mean};

/// A cycle by name (`ece15_eudc`, `constant_90`), or from the CSV file at a path. `option` is cited where the word itself is bad.
///
/// # Errors
/// An unknown name with those like it, an unreadable file, or all problems of the file.
pub fn find(option: &str, value: &str) -> Result<Cycle, Problems> {
    if let Some(constant) = constant_speed(value).filter(|_| !is_csv(value)) {
        return constant.map_err(|problem| problem.at(place(option)).into());
    }
    if let Some(found) = embedded(value) {
        return Ok(found);
    }
    if is_path(value) {
        return read_csv(value, &bytes(option, value, bounded::TABLE)?);
    }
    let question = did_you_mean(value, names().iter().copied())
        .map_or_else(String::new, |question| question + " ");
    let quoted = if value.is_empty() {
        "an empty value".to_owned()
    } else {
        format!("`{value}`")
    };
    Err(Problem::unknown_name(format!("there is no cycle named {quoted}")).at(place(option)).key(option).value(value).allowed("a name of `cvtcycle list cycles`, constant_V with V in km/h, or the path of a CSV file").hint(format!("{question}`cvtcycle list cycles` shows all; a path needs a / or an ending")).into())
}

/// Whether a word is surely a file, though it may begin like the name of a constant speed.
#[must_use]
pub fn is_csv(word: &str) -> bool {
    word.contains(['/', '\\']) || word.to_lowercase().ends_with(".csv")
}

/// The bytes of a file that the user named.
///
/// # Errors
/// A problem of `option`: the words of the operating system, or more bytes than the limit.
pub fn bytes(option: &str, path: &str, limit: Limit) -> Result<Vec<u8>, Problems> {
    bounded::read(path, limit).map_err(|error| {
        let hint = match error.kind() {
            std::io::ErrorKind::NotFound => {
                "check the path; it is taken from the current directory"
            }
            std::io::ErrorKind::IsADirectory => "name a file in that directory",
            _ => "check the path and its permissions",
        };
        Problem::unreadable(format!("cannot read `{path}`: {error}"))
            .at(place(option))
            .key(option)
            .value(path)
            .allowed(error.allowed("a readable file"))
            .hint(error.hint(hint))
            .into()
    })
}

fn place(option: &str) -> Place {
    Place {
        file: option.to_owned(),
        ..Place::default()
    }
}
