//! Problems of files of results.

use std::path::Path;

use cvtcycle_config::Problem;
use cvtcycle_config::bounded::ReadError;

/// A problem of a file.
pub(crate) fn problem(path: &Path, message: &str, hint: &str) -> Problem {
    Problem::invalid(message)
        .in_file(path.display().to_string())
        .hint(hint)
}

/// A file or directory that cannot be read.
pub(crate) fn unreadable(path: &Path, error: &ReadError) -> Problem {
    let hint = match error.kind() {
        std::io::ErrorKind::NotFound => "check the path; it is taken from the current directory",
        std::io::ErrorKind::NotADirectory => "name the directory, not a file in it",
        _ => "check the path and its permissions",
    };
    let allowed = error.allowed("");
    problem(
        path,
        &format!("cannot read {}: {error}", path.display()),
        error.hint(hint),
    )
    .allowed(allowed)
}
