//! A cycle by its name, or a file of the user.

use super::{Cycle, constant_speed, embedded, names, read_csv};
use crate::bounded::{self, Limit};
use crate::embedded::is_path;
use crate::{Argument, Problem, Problems, near, suggestion};

/// A cycle by name (`ece15_eudc`, `constant_90`), or from the CSV file at a path.
///
/// # Errors
/// An unknown name with those like it, an unreadable file, or all problems of the file.
///
/// ```
/// use cvtcycle_config::cycle::find;
/// assert_eq!(find("ece15")?.trace_for(true).duration_s(), 195.0);
/// assert_eq!(find("ece15_euc").unwrap_err()[0].suggested[0], "ece15_eudc");
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn find(word: &str) -> Result<Cycle, Problems> {
    if let Some(constant) = constant_speed(word).filter(|_| !is_csv(word)) {
        return constant.map_err(Problems::from);
    }
    if let Some(found) = embedded(word) {
        return Ok(found);
    }
    if is_path(word) {
        return read_csv(word, &bytes(Argument::Cycle, word, bounded::TABLE)?);
    }
    let near = near(word, names().iter().copied());
    let question = suggestion(&near).map_or_else(String::new, |question| question + " ");
    let quoted = match word {
        "" => "an empty value".to_owned(),
        _ => format!("`{word}`"),
    };
    let allowed =
        "a name of `cvtcycle list cycles`, constant_V with V in km/h, or the path of a CSV file";
    let hint = "`cvtcycle list cycles` shows all; a path needs a / or an ending";
    let problem = Problem::unknown_name(format!("there is no cycle named {quoted}"))
        .at(Argument::Cycle)
        .value(word)
        .allowed(allowed)
        .suggest(&near);
    Err(problem.hint(question + hint).into())
}

/// Whether a word is surely a file, though it may begin like the name of a constant speed.
#[must_use]
pub fn is_csv(word: &str) -> bool {
    word.contains(['/', '\\']) || word.to_lowercase().ends_with(".csv")
}

/// The bytes of a file that the user named.
///
/// # Errors
/// A problem of the argument: the words of the operating system, or more bytes than the limit.
pub fn bytes(argument: Argument, path: &str, limit: Limit) -> Result<Vec<u8>, Problems> {
    bounded::read(path, limit).map_err(|error| {
        let hint = match error.kind() {
            std::io::ErrorKind::NotFound => {
                "check the path; it is taken from the current directory"
            }
            std::io::ErrorKind::IsADirectory => "name a file in that directory",
            _ => "check the path and its permissions",
        };
        Problem::unreadable(format!("cannot read `{path}`: {error}"))
            .at(argument)
            .value(path)
            .allowed(error.allowed("a readable file"))
            .hint(error.hint(hint))
            .into()
    })
}
